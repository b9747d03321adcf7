//! What the golden page has to come to, and what it comes to today where that is less.

use crate::unlike::counts::Counts;
use crate::unlike::truth::Row;

/// A claim on a share of some rows.
#[derive(Clone, Copy)]
pub struct Claim {
    /// What is claimed.
    pub what: &'static str,
    /// Which rows it is about.
    pub about: fn(&Row) -> bool,
    /// Which of them count.
    pub count: fn(&Counts) -> usize,
    /// Least share that is wanted, percent.
    pub wanted_percent: usize,
    /// What holds today, percent; the wanted share where nothing falls short.
    pub today_percent: usize,
}

/// What an axis of unlike make has to give.
#[rustfmt::skip] // One line for each claim: the list is read across.
pub const CLAIMS: &[Claim] = &[
    Claim { what: "hidden: named exactly", about: |row| is_form(row, "hidden"), count: |c| c.exact, wanted_percent: 92, today_percent: 92 },
    Claim { what: "empty and declared: no name", about: |row| is_form(row, "empty") || is_form(row, "declared"), count: |c| c.exact, wanted_percent: 100, today_percent: 100 },
    Claim { what: "another day: named exactly", about: |row| is_form(row, "another-day"), count: |c| c.exact, wanted_percent: 90, today_percent: 90 },
    Claim { what: "makes: no false name", about: is_make, count: |c| c.records - c.false_names, wanted_percent: 98, today_percent: 98 },
    Claim { what: "makes: the verdict", about: is_make, count: |c| c.verdicts, wanted_percent: 95, today_percent: 95 },
    Claim { what: "another day: the verdict", about: |row| is_form(row, "another-day"), count: |c| c.verdicts, wanted_percent: 95, today_percent: 95 },
    Claim { what: "clean: no name, explained", about: |row| row.table == "clean", count: |c| c.right, wanted_percent: 100, today_percent: 95 },
    Claim { what: "outside: unexplained or its own name", about: is_outside, count: |c| c.right, wanted_percent: 100, today_percent: 100 },
    Claim { what: "spoilt: not explained", about: |row| row.table == "spoilt", count: |c| c.verdicts, wanted_percent: 100, today_percent: 100 },
    Claim { what: "spoilt: the cause as well", about: |row| row.table == "spoilt", count: |c| c.right, wanted_percent: 100, today_percent: 100 },
];

/// Whether a row is of a make, of this table or of one that is or was held back.
fn is_make(row: &Row) -> bool {
    let is_of_another = ["clean", "outside", "spoilt"].contains(&row.table.as_str());
    !is_of_another && !is_outside(row)
}

fn is_outside(row: &Row) -> bool {
    row.form == "outside"
}

fn is_form(row: &Row, form: &str) -> bool {
    is_make(row) && row.form == form
}

impl Claim {
    /// Counted and all rows that it is about.
    #[must_use]
    pub fn of(&self, rows: &[Row]) -> (usize, usize) {
        let counts = Counts::of(rows, self.about);
        ((self.count)(&counts), counts.records)
    }

    /// What the rows come to, and whether that is enough for today.
    ///
    /// # Errors
    /// With the sentence where it is not: also where the wanted share is reached and the claim
    /// still says less.
    pub fn check(&self, rows: &[Row]) -> Result<String, String> {
        let (count, all) = self.of(rows);
        let sentence = format!(
            "{}: {count} of {all}, {} % wanted, {} % claimed",
            self.what, self.wanted_percent, self.today_percent
        );
        let reaches = |percent: usize| all > 0 && 100 * count >= percent * all;
        let is_outdated = reaches(self.wanted_percent) && self.today_percent < self.wanted_percent;
        if reaches(self.today_percent) && !is_outdated {
            Ok(sentence)
        } else {
            Err(sentence)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::confusion::Names;
    use crate::unlike::truth::{Naming, Said};

    fn rows(right: usize, all: usize) -> Vec<Row> {
        let row = |place: usize| Row {
            table: "clean".into(),
            record: String::new(),
            form: String::new(),
            hidden: Names::new(),
            said: Said::default(),
            naming: Naming::Exact,
            verdict_is_right: true,
            is_right: place < right,
        };
        (0..all).map(row).collect()
    }

    fn claim(wanted_percent: usize, today_percent: usize) -> Claim {
        Claim {
            what: "",
            about: |row| row.table == "clean",
            count: |counts| counts.right,
            wanted_percent,
            today_percent,
        }
    }

    #[test]
    fn a_claim_fails_below_what_holds_today_and_where_it_says_less_than_is_reached() {
        for (right, wanted, today, is_kept) in [
            (9, 90, 90, true),
            (8, 90, 90, false),
            (8, 90, 80, true),
            (7, 90, 80, false),
            (9, 90, 80, false),
        ] {
            let kept = claim(wanted, today).check(&rows(right, 10)).is_ok();
            assert_eq!(kept, is_kept, "{right} {wanted} {today}");
        }
        assert!(claim(90, 90).check(&[]).is_err());
    }

    #[test]
    fn no_claim_wants_less_than_it_claims() {
        assert!(
            CLAIMS
                .iter()
                .all(|claim| claim.today_percent <= claim.wanted_percent)
        );
    }
}
