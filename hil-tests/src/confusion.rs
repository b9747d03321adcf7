//! The golden table of what the identification names on the seeded records.
//!
//! `golden/identification.md` has one row for each record, and above them what follows from the
//! rows: the confusion matrix and the counts. Everything is whole, so everything is held exactly. A
//! scope that runs some of the records holds their rows; that the matrix is that of the rows is
//! held by every scope. `QUADRANT_BLESS=1` rewrites the rows that ran.

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;

use scope::Scope;

use crate::records::{Hidden, UNEXPLAINED};

/// Names of effects, and `unexplained`.
pub type Names = BTreeSet<String>;

/// What one record hides and what was named on it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Judged {
    /// The record.
    pub seed: u64,
    /// What should be named.
    pub hidden: Names,
    /// What was named.
    pub named: Names,
}

/// What an identification has to say of a plan that hides these.
#[must_use]
pub fn wanted(hidden: &[Hidden]) -> Names {
    hidden.iter().map(|one| one.word().to_owned()).collect()
}

/// Names as the table shows them.
#[must_use]
pub fn text(names: &Names) -> String {
    if names.is_empty() {
        return NOTHING.into();
    }
    names.iter().cloned().collect::<Vec<_>>().join(", ")
}

const NOTHING: &str = "nothing";

/// Names that a table shows.
#[must_use]
pub fn names(text: &str) -> Names {
    let words = text.split(", ").filter(|word| *word != NOTHING);
    words.map(str::to_owned).collect()
}

/// What the rows come to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Rows.
    pub records: usize,
    /// Those on which exactly what is hidden is named.
    pub exact: usize,
    /// Those that hide nothing.
    pub empty: usize,
    /// Those of them on which something is named.
    pub false_alarms: usize,
    /// Those that hide something without a name, and are said to be explained.
    pub explained_away: usize,
}

impl Counts {
    /// Counts rows.
    #[must_use]
    pub fn of(rows: &[Judged]) -> Self {
        let count = |holds: &dyn Fn(&Judged) -> bool| rows.iter().filter(|row| holds(row)).count();
        let is_empty = |row: &Judged| row.hidden.is_empty();
        let is_nameless = |names: &Names| names.contains(UNEXPLAINED);
        Self {
            records: rows.len(),
            exact: count(&|row| row.hidden == row.named),
            empty: count(&is_empty),
            false_alarms: count(&|row| is_empty(row) && !row.named.is_empty()),
            explained_away: count(&|row| is_nameless(&row.hidden) && !is_nameless(&row.named)),
        }
    }

    /// The counts in a sentence.
    #[must_use]
    pub fn sentence(self) -> String {
        format!(
            "{} of {} records are named exactly, {} of the {} that hide nothing give a false alarm",
            self.exact, self.records, self.false_alarms, self.empty
        )
    }
}

/// The golden table as it stands.
///
/// # Panics
/// Where the file is missing.
#[must_use]
pub fn golden() -> String {
    std::fs::read_to_string(path()).expect("golden/identification.md is there")
}

fn path() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("golden/identification.md")
}

/// The rows of a page, by record.
#[must_use]
pub fn rows(page: &str) -> Vec<Judged> {
    page.lines().filter_map(row).collect()
}

fn row(line: &str) -> Option<Judged> {
    let cells = line.strip_prefix("| ")?.strip_suffix(" |")?;
    let cells: Vec<&str> = cells.split(" | ").collect();
    let [seed, hidden, named] = cells[..] else {
        return None;
    };
    Some(Judged {
        seed: seed.parse().ok()?,
        hidden: names(hidden),
        named: names(named),
    })
}

/// The whole page that follows from rows.
#[must_use]
pub fn page(rows: &[Judged]) -> String {
    let line = |row: &Judged| {
        let (hidden, named) = (text(&row.hidden), text(&row.named));
        format!("| {} | {hidden} | {named} |\n", row.seed)
    };
    let lines: String = rows.iter().map(line).collect();
    format!(
        "{HEAD}\n{}.\n\n{}\n## Record by record\n\n| seed | hidden | named |\n|---|---|---|\n{lines}",
        Counts::of(rows).sentence(),
        matrix(rows)
    )
}

const HEAD: &str = "# What is named on the seeded records\n\n\
    Made by `QUADRANT_BLESS=1 cargo certify -p hil-tests --test identification`. \
    `hil-tests/src/records/plans.rs` has the sizes.\n";

/// How often which names came for which.
fn matrix(rows: &[Judged]) -> String {
    let mut counts: BTreeMap<(String, String), usize> = BTreeMap::new();
    for row in rows {
        *counts
            .entry((text(&row.hidden), text(&row.named)))
            .or_default() += 1;
    }
    let line = |((hidden, named), count): (&(String, String), &usize)| {
        format!("| {hidden} | {named} | {count} |\n")
    };
    let lines: String = counts.iter().map(line).collect();
    format!("| hidden | named | records |\n|---|---|---|\n{lines}")
}

/// Compares the records that ran with their rows of the golden table.
///
/// # Panics
/// With every row that differs, and where the page is not what follows from its rows.
pub fn check(ran: &[Judged]) {
    let known = rows(&std::fs::read_to_string(path()).unwrap_or_default());
    if std::env::var_os("QUADRANT_BLESS").is_some() {
        let page = page(&blessed(&known, ran, Scope::now().is_complete()));
        std::fs::write(path(), page).expect("the golden folder is writable");
        return;
    }
    assert_eq!(page(&known), golden(), "the page is not that of its rows");
    let wrong = differences(&known, ran, Scope::now().is_complete());
    assert!(
        wrong.is_empty(),
        "golden/identification.md (QUADRANT_BLESS=1 rewrites it):\n{wrong}"
    );
}

fn of_seed(rows: &[Judged], seed: u64) -> Option<&Judged> {
    rows.iter().find(|row| row.seed == seed)
}

/// The rows that ran, and those of other scopes.
fn blessed(known: &[Judged], ran: &[Judged], is_complete: bool) -> Vec<Judged> {
    let kept = known
        .iter()
        .filter(|row| !is_complete && of_seed(ran, row.seed).is_none());
    let mut rows: Vec<Judged> = kept.chain(ran).cloned().collect();
    rows.sort_by_key(|row| row.seed);
    rows
}

fn differences(known: &[Judged], ran: &[Judged], is_complete: bool) -> String {
    let off = ran.iter().filter_map(|new| {
        let old = of_seed(known, new.seed);
        (old != Some(new)).then(|| format!("wanted {old:?}\nhave   {new:?}\n"))
    });
    let missing = known
        .iter()
        .filter(|row| is_complete && of_seed(ran, row.seed).is_none());
    off.chain(missing.map(|row| format!("not run: {}\n", row.seed)))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn judged(seed: u64, hidden: &str, named: &str) -> Judged {
        Judged {
            seed,
            hidden: names(hidden),
            named: names(named),
        }
    }

    fn four() -> Vec<Judged> {
        vec![
            judged(1, "nothing", "nothing"),
            judged(2, "nothing", "delay"),
            judged(3, "stribeck, delay", "delay, stribeck"),
            judged(4, "unexplained", "delay"),
        ]
    }

    #[test]
    fn counts_tell_hits_false_alarms_and_what_was_explained_away() {
        let counts = Counts::of(&four());
        let wanted = Counts {
            records: 4,
            exact: 2,
            empty: 2,
            false_alarms: 1,
            explained_away: 1,
        };
        assert_eq!(counts, wanted);
    }

    #[test]
    fn a_page_gives_its_rows_back() {
        assert_eq!(rows(&page(&four())), four());
        assert!(page(&four()).contains("| delay, stribeck | delay, stribeck | 1 |\n"));
    }

    #[test]
    fn one_name_more_or_less_on_one_record_is_a_difference() {
        let known = four();
        assert_eq!(differences(&known, &known, true), "");
        assert_eq!(differences(&known, &known[..1], false), "");
        assert!(differences(&known, &known[..1], true).contains("not run: 2"));
        for named in ["delay", "nothing", "delay, stribeck, backlash"] {
            let ran = [judged(3, "stribeck, delay", named)];
            assert!(!differences(&known, &ran, false).is_empty(), "{named}");
        }
        assert!(!differences(&known, &[judged(5, "nothing", "nothing")], false).is_empty());
    }

    #[test]
    fn a_blessing_keeps_the_rows_of_other_scopes() {
        let ran = [judged(2, "nothing", "nothing")];
        let rows = blessed(&four(), &ran, false);
        assert_eq!(rows.len(), 4);
        assert_eq!(rows[1], ran[0]);
        assert_eq!(blessed(&four(), &ran, true), ran);
    }
}
