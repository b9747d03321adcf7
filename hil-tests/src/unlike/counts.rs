//! What rows of the golden page come to, by table and form.

use crate::unlike::truth::{Naming, Row};

/// Counts of rows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Rows.
    pub records: usize,
    /// Those that are named exactly.
    pub exact: usize,
    /// Those with a name that is not true.
    pub false_names: usize,
    /// Those with the right verdict.
    pub verdicts: usize,
    /// Those on which all is right.
    pub right: usize,
}

impl Counts {
    /// Counts the rows for which something holds.
    #[must_use]
    pub fn of(rows: &[Row], holds: impl Fn(&Row) -> bool) -> Self {
        let rows = rows.iter().filter(|row| holds(row));
        rows.fold(Self::default(), |sum, row| Self {
            records: sum.records + 1,
            exact: sum.exact + usize::from(row.naming == Naming::Exact),
            false_names: sum.false_names + usize::from(row.naming == Naming::False),
            verdicts: sum.verdicts + usize::from(row.verdict_is_right),
            right: sum.right + usize::from(row.is_right),
        })
    }
}

/// Tables with their forms, in the order of the rows.
#[must_use]
pub fn groups(rows: &[Row]) -> Vec<(String, String)> {
    let mut groups = Vec::new();
    for row in rows {
        let group = (row.table.clone(), form(row).to_owned());
        if !groups.contains(&group) {
            groups.push(group);
        }
    }
    groups
}

/// Form of a make's record; the other tables have none.
#[must_use]
pub fn form(row: &Row) -> &str {
    if row.table == "makes" { &row.form } else { "" }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::confusion::Names;
    use crate::unlike::truth::Said;

    fn row(form: &str, naming: Naming, is_right: bool) -> Row {
        Row {
            table: "makes".into(),
            record: String::new(),
            form: form.into(),
            hidden: Names::new(),
            said: Said::default(),
            naming,
            verdict_is_right: true,
            is_right,
        }
    }

    #[test]
    fn a_row_counts_in_its_form_only() {
        let rows = [
            row("hidden", Naming::Exact, true),
            row("empty", Naming::False, false),
            row("hidden", Naming::Missed, false),
        ];
        let hidden = Counts::of(&rows, |row| row.form == "hidden");
        let wanted = Counts {
            records: 2,
            exact: 1,
            false_names: 0,
            verdicts: 2,
            right: 1,
        };
        assert_eq!(hidden, wanted);
        assert_eq!(Counts::of(&rows, |row| row.form == "empty").false_names, 1);
        let groups = groups(&rows);
        assert_eq!(groups.len(), 2);
        assert_eq!(groups[1], ("makes".into(), "empty".into()));
    }
}
