//! The golden page of the records of unlike make: what they come to, and a row for each.
//!
//! Every row is held exactly, the force error within a share. A scope that runs some of the records
//! holds their rows; that the counts are those of the rows is held by every scope.
//! `QUADRANT_BLESS=1` rewrites the rows that ran.

use std::path::PathBuf;

use crate::confusion::{names, text};
use crate::unlike::claims::CLAIMS;
use crate::unlike::counts::{self, Counts};
use crate::unlike::truth::{Naming, Row, Said};

/// Force errors may differ by this share: above the last digit of the page, below any change that
/// matters.
const TOLERANCE: f64 = 0.02;
/// Longest sentence on the page.
const LONGEST: usize = 160;

const HEAD: &str = "# What is said of axes of unlike make\n\n\
    Made by `QUADRANT_BLESS=1 cargo certify -p hil-tests --test makes`. \
    Crate `makes` makes the records.\n";
const ROW_HEAD: &str = "| table | record | form | true | found | verdict | left, % | names | says | judged |\n\
    |---|---|---|---|---|---|---|---|---|---|\n";

/// A page as it stands: `makes`, or `makes-held-back`.
///
/// # Panics
/// Where the file is missing.
#[must_use]
pub fn golden(name: &str) -> String {
    std::fs::read_to_string(path(name)).expect("the golden page is there")
}

fn path(name: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("golden");
    folder.join(name).with_extension("md")
}

/// The rows of a page.
#[must_use]
pub fn rows(page: &str) -> Vec<Row> {
    page.lines().filter_map(row).collect()
}

fn row(line: &str) -> Option<Row> {
    let cells = line.strip_prefix("| ")?.strip_suffix(" |")?;
    let cells: Vec<&str> = cells.split(" | ").map(str::trim).collect();
    let [
        table,
        record,
        form,
        hidden,
        named,
        verdict,
        left,
        naming,
        words,
        judged,
    ] = cells[..]
    else {
        return None;
    };
    Some(Row {
        table: table.into(),
        record: record.into(),
        form: form.into(),
        hidden: names(hidden),
        said: Said {
            named: names(named),
            verdict: verdict.into(),
            left_percent: left.parse().ok(),
            words: words.into(),
        },
        naming: naming_of(naming)?,
        verdict_is_right: judged != WRONG,
        is_right: judged == RIGHT,
    })
}

const RIGHT: &str = "right";
const WRONG_NAMES: &str = "the verdict only";
const WRONG: &str = "wrong";

const fn judged(row: &Row) -> &'static str {
    match (row.is_right, row.verdict_is_right) {
        (true, _) => RIGHT,
        (_, true) => WRONG_NAMES,
        _ => WRONG,
    }
}

const NAMINGS: [(&str, Naming); 3] = [
    ("exact", Naming::Exact),
    ("false", Naming::False),
    ("missed", Naming::Missed),
];

fn naming_of(word: &str) -> Option<Naming> {
    let found = NAMINGS.iter().find(|(name, _)| *name == word);
    found.map(|(_, naming)| *naming)
}

fn line(row: &Row) -> String {
    let said = &row.said;
    let left = said.left_percent.map_or("—".into(), three_digits);
    let naming = NAMINGS.iter().find(|(_, naming)| *naming == row.naming);
    format!(
        "| {} | {} | {} | {} | {} | {} | {left} | {} | {} | {} |\n",
        row.table,
        row.record,
        row.form,
        text(&row.hidden),
        text(&said.named),
        said.verdict,
        naming.map_or("", |(word, _)| word),
        on_one_line(&said.words),
        judged(row)
    )
}

fn three_digits(value: f64) -> String {
    let digits = 2 - value.abs().max(1.0e-9).log10().floor() as i32;
    format!("{value:.*}", digits.clamp(0, 6) as usize)
}

/// A sentence as a cell shows it; a dash where there is none.
fn on_one_line(words: &str) -> String {
    let words = words.replace(['|', '\n'], "/");
    let short: String = words.trim().chars().take(LONGEST).collect();
    if short.is_empty() {
        "—".into()
    } else {
        short.trim().into()
    }
}

/// The whole page that follows from rows.
#[must_use]
pub fn page(rows: &[Row]) -> String {
    let lines: String = rows.iter().map(line).collect();
    let (counts, claims) = (count_table(rows), claim_table(rows));
    format!("{HEAD}\n{counts}\n{claims}\n## Record by record\n\n{ROW_HEAD}{lines}")
}

fn count_table(rows: &[Row]) -> String {
    let head = "| table | form | records | exact | false names | verdicts right | all right |\n\
                |---|---|---|---|---|---|---|\n";
    counts::groups(rows)
        .iter()
        .fold(head.into(), |page, (table, form)| {
            let of_group = |row: &Row| row.table == *table && counts::form(row) == form;
            let c = Counts::of(rows, of_group);
            page + &format!(
                "| {table} | {form} | {} | {} | {} | {} | {} |\n",
                c.records, c.exact, c.false_names, c.verdicts, c.right
            )
        })
}

fn claim_table(rows: &[Row]) -> String {
    let head = "| claim | records | of | wanted, % |\n|---|---|---|---|\n";
    CLAIMS.iter().fold(head.into(), |page, claim| {
        let (count, all) = claim.of(rows);
        page + &format!(
            "| {} | {count} | {all} | {} |\n",
            claim.what, claim.wanted_percent
        )
    })
}

/// Records that ran, and all that could have.
pub struct Run<'a> {
    /// Those that ran.
    pub rows: &'a [Row],
    /// All records, `table/record`, in the order of the page.
    pub order: &'a [String],
    /// Whether all of them should have run.
    pub is_complete: bool,
}

/// Compares the records that ran with their rows of a page.
///
/// # Panics
/// With every row that differs, and where the page is not what follows from its rows.
pub fn check(name: &str, run: &Run<'_>) {
    let ran: Vec<Row> = run.rows.iter().map(as_on_the_page).collect();
    let known = rows(&std::fs::read_to_string(path(name)).unwrap_or_default());
    if std::env::var_os("QUADRANT_BLESS").is_some() {
        let page = page(&blessed(&known, &ran, run.order));
        std::fs::write(path(name), page).expect("the golden folder is writable");
        return;
    }
    assert_eq!(
        page(&known),
        golden(name),
        "the page is not that of its rows"
    );
    let wrong = differences(&known, &ran, run.is_complete);
    assert!(
        wrong.is_empty(),
        "golden/{name}.md (QUADRANT_BLESS=1 rewrites it):\n{wrong}"
    );
}

/// A row as it comes back from the page.
fn as_on_the_page(new: &Row) -> Row {
    row(line(new).trim_end()).unwrap_or_else(|| new.clone())
}

fn find<'a>(rows: &'a [Row], other: &Row) -> Option<&'a Row> {
    rows.iter().find(|row| key(row) == key(other))
}

fn key(row: &Row) -> String {
    format!("{}/{}", row.table, row.record)
}

/// The rows that ran and those of other scopes, in the order of the records.
fn blessed(known: &[Row], ran: &[Row], order: &[String]) -> Vec<Row> {
    let by_key = |rows: &[Row], wanted: &String| {
        let found = rows.iter().find(|row| key(row) == *wanted);
        found.cloned()
    };
    order
        .iter()
        .filter_map(|wanted| by_key(ran, wanted).or_else(|| by_key(known, wanted)))
        .collect()
}

fn differences(known: &[Row], ran: &[Row], is_complete: bool) -> String {
    let off = ran.iter().filter_map(|new| {
        let old = find(known, new);
        let is_same = old.is_some_and(|old| is_same(old, new));
        let old = old.map_or("no row\n".into(), line);
        (!is_same).then(|| format!("wanted {old}have   {}", line(new)))
    });
    let missing = known
        .iter()
        .filter(|row| is_complete && find(ran, row).is_none());
    off.chain(missing.map(|row| format!("not run: {}\n", key(row))))
        .collect()
}

fn is_same(old: &Row, new: &Row) -> bool {
    let is_near = match (old.said.left_percent, new.said.left_percent) {
        (Some(old), Some(new)) => (new - old).abs() <= TOLERANCE * old.abs(),
        (old, new) => old == new,
    };
    let without = |row: &Row| {
        let mut row = row.clone();
        row.said.left_percent = None;
        row
    };
    is_near && without(old) == without(new)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn made(record: &str, named: &str, left: f64) -> Row {
        let hidden = names("delay");
        let named = names(named);
        let is_right = hidden == named;
        Row {
            table: "makes".into(),
            record: record.into(),
            form: "hidden".into(),
            naming: if is_right {
                Naming::Exact
            } else {
                Naming::False
            },
            hidden,
            said: Said {
                named,
                verdict: "explained".into(),
                left_percent: Some(left),
                words: "a | b".into(),
            },
            verdict_is_right: true,
            is_right,
        }
    }

    fn two() -> Vec<Row> {
        [made("a", "delay", 0.707), made("b", "stribeck", 41.2)]
            .iter()
            .map(as_on_the_page)
            .collect()
    }

    #[test]
    fn a_page_is_read_back_as_it_was_written() {
        let rows = two();
        assert_eq!(super::rows(&page(&rows)), rows);
        assert_eq!(rows[0].said.words, "a / b");
        assert!(page(&rows).contains("| makes | hidden | 2 | 1 | 1 | 2 | 1 |"));
    }

    #[test]
    fn a_figure_may_be_off_by_two_percent_and_nothing_else_may_be() {
        let known = two();
        let off = |change: fn(&mut Row)| {
            let mut new = known.clone();
            change(&mut new[0]);
            !differences(&known, &new, true).is_empty()
        };
        assert!(!off(|_| ()));
        assert!(!off(|row| row.said.left_percent = Some(0.72)));
        assert!(off(|row| row.said.left_percent = Some(0.73)));
        assert!(off(|row| row.said.left_percent = Some(0.69)));
        assert!(off(|row| row.said.left_percent = None));
        assert!(off(|row| row.said.verdict = "unexplained".into()));
        assert!(off(|row| row.said.words = "b".into()));
        assert!(off(|row| row.is_right = false));
    }

    #[test]
    fn a_row_that_did_not_run_is_missed_in_the_full_scope_only() {
        let known = two();
        assert_eq!(differences(&known, &known[..1], false), "");
        assert_eq!(differences(&known, &known[..1], true), "not run: makes/b\n");
    }

    #[test]
    fn a_blessing_keeps_the_rows_of_other_scopes_in_the_order_of_the_records() {
        let known = two();
        let order = ["makes/b", "makes/a"].map(String::from);
        let new = as_on_the_page(&made("a", "stribeck", 3.0));
        let blessed = blessed(&known, std::slice::from_ref(&new), &order);
        assert_eq!(blessed, [known[1].clone(), new]);
    }

    #[test]
    fn figures_have_three_digits() {
        let texts = [0.070_71, 0.707, 3.366, 41.25, 836.4, 19_300.0].map(three_digits);
        assert_eq!(texts, ["0.0707", "0.707", "3.37", "41.2", "836", "19300"]);
    }
}
