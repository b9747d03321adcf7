//! Golden tables with one row per scenario and one column per figure, for tables that a person
//! reads across.
//!
//! The same rules as in [`crate::golden`]: `QUADRANT_BLESS=1` rewrites the rows that ran, every row
//! that ran must stand in the file and the other way round, and a cell may be off by 2 % or by
//! 0.005 either way. Cells that depend on scheduling are printed, and bounded by their test only.

use std::path::PathBuf;

/// A row: its name, and a cell per column; `None` where the figure means nothing.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// Name.
    pub name: String,
    /// Figures.
    pub cells: Vec<Option<f64>>,
    /// Whether the figures have to repeat.
    pub repeats: bool,
}

impl Row {
    fn line(&self) -> String {
        let cell = |cell: &Option<f64>| match cell {
            None => "–".to_owned(),
            Some(whole) if whole.fract() == 0.0 && whole.abs() >= 1.0 || *whole == 0.0 => {
                format!("{whole:.0}")
            }
            Some(value) => format!("{value:.3}"),
        };
        format!(
            "| {} | {} |",
            self.name,
            self.cells.iter().map(cell).collect::<Vec<_>>().join(" | ")
        )
    }

    fn is_in(&self, line: &str) -> bool {
        let Some((_, cells)) = parts(line) else {
            return false;
        };
        let same = |(cell, text): (&Option<f64>, &&str)| match (cell, text.parse::<f64>()) {
            (None, Err(_)) => true,
            (Some(new), Ok(old)) => !self.repeats || (new - old).abs() <= 0.005 + 0.02 * old.abs(),
            _ => false,
        };
        cells.len() == self.cells.len() && self.cells.iter().zip(&cells).all(same)
    }
}

/// Name and cells of a line of the table.
fn parts(line: &str) -> Option<(&str, Vec<&str>)> {
    let mut cells = line
        .strip_prefix('|')?
        .strip_suffix('|')?
        .split('|')
        .map(str::trim);
    let name = cells.next()?;
    Some((name, cells.collect()))
}

/// Compares the rows that ran with the table of a name; `is_meant` tells of a row of the file
/// whether this scope runs it.
///
/// # Panics
/// With every row that is off, missing or new: this is the assertion of the tests.
pub fn check(table: &str, rows: &[Row], is_meant: &dyn Fn(&str) -> bool) {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR"))
        .join("golden")
        .join(format!("{table}.md"));
    let text = std::fs::read_to_string(&path).expect("the head of the table stands in the file");
    if std::env::var_os("QUADRANT_BLESS").is_some() {
        std::fs::write(path, blessed(&text, rows, is_meant))
            .expect("the golden folder is writable");
        return;
    }
    let wrong = differences(&text, rows, is_meant);
    assert!(
        wrong.is_empty(),
        "golden/{table}.md (QUADRANT_BLESS=1 rewrites it):\n{wrong}"
    );
}

/// The lines of the table's body.
fn body(text: &str) -> impl Iterator<Item = &str> {
    text.lines()
        .skip_while(|line| !line.starts_with("|---"))
        .skip(1)
        .filter(|line| line.starts_with('|'))
}

fn named<'a>(text: &'a str, name: &str) -> Option<&'a str> {
    body(text).find(|line| parts(line).is_some_and(|(found, _)| found == name))
}

fn differences(text: &str, rows: &[Row], is_meant: &dyn Fn(&str) -> bool) -> String {
    let off = rows.iter().filter_map(|row| match named(text, &row.name) {
        None => Some(format!("new row:  {}\n", row.line())),
        Some(line) if row.is_in(line) => None,
        Some(line) => Some(format!("wanted:   {line}\nmeasured: {}\n", row.line())),
    });
    let is_missed = |name: &str| is_meant(name) && !rows.iter().any(|row| row.name == name);
    let missing = body(text)
        .filter_map(parts)
        .filter(|(name, _)| is_missed(name));
    off.chain(missing.map(|(name, _)| format!("row not measured: {name}\n")))
        .collect()
}

/// The rows of the file in their order with the new figures, then the new ones; those that are
/// meant and did not run are gone.
fn blessed(text: &str, rows: &[Row], is_meant: &dyn Fn(&str) -> bool) -> String {
    let head = text
        .lines()
        .take_while(|line| !line.starts_with("|---"))
        .chain(text.lines().find(|line| line.starts_with("|---")));
    let kept = body(text).filter(|line| {
        parts(line)
            .is_some_and(|(name, _)| !is_meant(name) && !rows.iter().any(|row| row.name == name))
    });
    head.map(str::to_owned)
        .chain(rows.iter().map(Row::line))
        .chain(kept.map(str::to_owned))
        .map(|line| line + "\n")
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const TABLE: &str =
        "# Head\n\n| what | path | faults |\n|---|---|---|\n| one | 1.500 | 0 |\n| two | – | 3 |\n";

    fn row(name: &str, path: Option<f64>, faults: f64, repeats: bool) -> Row {
        Row {
            name: name.into(),
            cells: vec![path, Some(faults)],
            repeats,
        }
    }

    #[test]
    fn a_cell_that_is_off_either_way_and_a_row_that_is_new_or_missing_are_errors() {
        let two = row("two", None, 3.0, true);
        for (path, is_off) in [(1.46, true), (1.47, false), (1.53, false), (1.54, true)] {
            let rows = [row("one", Some(path), 0.0, true), two.clone()];
            assert_eq!(
                !differences(TABLE, &rows, &|_| true).is_empty(),
                is_off,
                "{path}"
            );
        }
        assert_eq!(
            differences(
                TABLE,
                &[row("one", Some(9.0), 7.0, false), two.clone()],
                &|_| true
            ),
            ""
        );
        assert_eq!(
            differences(TABLE, std::slice::from_ref(&two), &|_| true),
            "row not measured: one\n"
        );
        assert_eq!(
            differences(TABLE, std::slice::from_ref(&two), &|name| name != "one"),
            ""
        );
        assert!(
            differences(TABLE, &[two, row("three", None, 0.0, true)], &|_| false)
                .starts_with("new row")
        );
    }

    #[test]
    fn a_blessing_keeps_the_rows_of_other_scopes_and_is_then_what_was_measured() {
        let rows = [
            row("one", Some(2.0), 1.0, true),
            row("three", Some(0.25), 0.0, true),
        ];
        let new = blessed(TABLE, &rows, &|name| name != "two");
        assert_eq!(
            new,
            TABLE.replace(
                "| one | 1.500 | 0 |",
                "| one | 2 | 1 |\n| three | 0.250 | 0 |"
            )
        );
        assert_eq!(differences(&new, &rows, &|name| name != "two"), "");
    }
}
