//! Golden tables: what was measured once, with bounds on both sides, so that an unexplained
//! improvement fails too.
//!
//! A table is a text file of rows `name | value | tolerance | unit | note`. `QUADRANT_BLESS=1`
//! rewrites the values and keeps tolerances and notes; the change is then for a person to review. A
//! scope that runs part of a table ([`check_some`]) checks, and rewrites, that part only.

use std::fmt::Write as _;
use std::path::PathBuf;

use scope::Scope;

/// A measured row.
#[derive(Clone, Debug, PartialEq)]
pub struct Measured {
    /// Name of the row.
    pub name: String,
    /// Value.
    pub value: f64,
    /// Unit.
    pub unit: &'static str,
}

/// A row.
pub fn row(name: impl Into<String>, value: f64, unit: &'static str) -> Measured {
    Measured {
        name: name.into(),
        value,
        unit,
    }
}

struct Row {
    /// As it stands in the file.
    line: String,
    name: String,
    value: f64,
    tolerance: f64,
    note: String,
}

fn path(table: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
        .join("golden")
        .join(format!("{table}.md"))
}

fn parse(text: &str) -> Vec<Row> {
    let cells = |line: &str| {
        line.trim_matches('|')
            .split('|')
            .map(|cell| cell.trim().to_owned())
            .collect::<Vec<_>>()
    };
    text.lines()
        .filter(|line| line.starts_with('|'))
        .filter_map(|line| {
            let [name, value, tolerance, _, note] = &cells(line)[..] else {
                return None;
            };
            Some(Row {
                line: line.to_owned(),
                name: name.clone(),
                value: value.parse().ok()?,
                tolerance: tolerance.parse().ok()?,
                note: note.clone(),
            })
        })
        .collect()
}

/// Compares what was measured with the golden table of a name, row by row and both ways.
///
/// # Panics
/// With every row that is off, missing or new: this is the assertion of the tests.
pub fn check(table: &str, measured: &[Measured]) {
    compare(table, measured, &|_| true);
}

/// The same where the scope ran some scenarios of the table only: the name of a row begins with its
/// scenario, then a comma or a colon.
///
/// Both ways still: a row of a scenario that ran must have been measured, and nothing else may have
/// been. In [`Scope::Certify`] the whole table must.
///
/// # Panics
/// As [`check`] does.
pub fn check_some(table: &str, measured: &[Measured], scenarios: &[impl AsRef<str>]) {
    let ran = |name: &str| {
        scenarios
            .iter()
            .any(|scenario| belongs(name, scenario.as_ref()))
    };
    let stray = measured.iter().find(|row| !ran(&row.name));
    assert!(
        stray.is_none(),
        "golden/{table}.md: {stray:?} belongs to none of the scenarios that ran"
    );
    compare(table, measured, &|name| {
        Scope::now().is_complete() || ran(name)
    });
}

/// Whether a row is one of a scenario.
fn belongs(name: &str, scenario: &str) -> bool {
    name.strip_prefix(scenario)
        .is_some_and(|rest| rest.is_empty() || rest.starts_with([',', ':']))
}

fn compare(table: &str, measured: &[Measured], is_meant: &dyn Fn(&str) -> bool) {
    let text = std::fs::read_to_string(path(table)).unwrap_or_default();
    let rows = parse(&text);
    if std::env::var_os("QUADRANT_BLESS").is_some() {
        std::fs::write(path(table), blessed(&text, &rows, measured, is_meant))
            .expect("the golden folder is writable");
        return;
    }
    let wrong = differences(&rows, measured, is_meant);
    assert!(
        wrong.is_empty(),
        "golden/{table}.md (QUADRANT_BLESS=1 rewrites it):\n{wrong}"
    );
}

/// A line for each row that is off, new, or was meant to be measured and was not.
fn differences(rows: &[Row], measured: &[Measured], is_meant: &dyn Fn(&str) -> bool) -> String {
    let off =
        measured
            .iter()
            .filter_map(|new| match rows.iter().find(|row| row.name == new.name) {
                None => Some(format!("new row: {} = {}\n", new.name, new.value)),
                Some(row) if (new.value - row.value).abs() <= row.tolerance => None,
                Some(Row {
                    name,
                    value,
                    tolerance,
                    ..
                }) => Some(format!(
                    "{name}: {value} ± {tolerance} {} wanted, {} measured\n",
                    new.unit, new.value
                )),
            });
    let missing = rows
        .iter()
        .filter(|row| is_meant(&row.name) && !measured.iter().any(|new| new.name == row.name));
    off.chain(missing.map(|row| format!("row not measured: {}\n", row.name)))
        .collect()
}

/// The table with the new values, in the order of the measured rows; rows that were not meant to be
/// measured follow as they were.
fn blessed(
    text: &str,
    rows: &[Row],
    measured: &[Measured],
    is_meant: &dyn Fn(&str) -> bool,
) -> String {
    let head: String = text
        .lines()
        .take_while(|line| !line.starts_with('|'))
        .fold(String::new(), |head, line| head + line + "\n");
    let mut out = head + "| figure | value | tolerance | unit | note |\n|---|---|---|---|---|\n";
    for new in measured {
        let known = rows.iter().find(|row| row.name == new.name);
        let (tolerance, note) = known.map_or_else(
            || (0.02 * new.value.abs(), ""),
            |row| (row.tolerance, &row.note),
        );
        writeln!(
            out,
            "| {} | {:.3} | {tolerance:.3} | {} | {note} |",
            new.name, new.value, new.unit
        )
        .expect("a String takes everything");
    }
    rows.iter()
        .filter(|row| !is_meant(&row.name))
        .fold(out, |out, row| out + &row.line + "\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    const TABLE: &str = "# Head\n| figure | value | tolerance | unit | note |\n|---|---|---|---|---|\n\
                         | gap 20, step | 1.000 | 0.100 | µm | why |\n| gap 200, step | 2.000 | 0.100 | µm |  |\n";

    fn gap_20(name: &str) -> bool {
        belongs(name, "gap 20")
    }

    #[test]
    fn in_part_of_a_table_a_row_that_was_meant_to_run_is_missed_and_the_others_are_not() {
        let rows = parse(TABLE);
        let measured = [row("gap 20, step", 1.05, "µm")];
        assert_eq!(differences(&rows, &measured, &gap_20), "");
        assert_eq!(
            differences(&rows, &[], &gap_20),
            "row not measured: gap 20, step\n"
        );
        assert_eq!(
            differences(&rows, &measured, &|_| true),
            "row not measured: gap 200, step\n"
        );
    }

    #[test]
    fn a_row_that_is_off_or_new_is_an_error_in_part_of_a_table_too() {
        let rows = parse(TABLE);
        for (value, is_off) in [(0.89, true), (0.91, false), (1.09, false), (1.11, true)] {
            assert_eq!(
                !differences(&rows, &[row("gap 20, step", value, "µm")], &gap_20).is_empty(),
                is_off,
                "{value}"
            );
        }
        let more = [
            row("gap 20, step", 1.0, "µm"),
            row("gap 20, burst", 3.0, "µm"),
        ];
        assert_eq!(
            differences(&rows, &more, &gap_20),
            "new row: gap 20, burst = 3\n"
        );
    }

    #[test]
    fn rows_that_did_not_run_survive_a_blessing() {
        let rows = parse(TABLE);
        let new = blessed(TABLE, &rows, &[row("gap 20, step", 1.5, "µm")], &gap_20);
        assert_eq!(new, TABLE.replace("1.000", "1.500"));
        assert!(
            !blessed(TABLE, &rows, &[row("gap 20, step", 1.5, "µm")], &|_| true)
                .contains("gap 200")
        );
    }

    #[test]
    #[should_panic(expected = "none of the scenarios")]
    fn a_row_of_a_scenario_that_did_not_run_is_refused() {
        check_some(
            "reference-machine",
            &[row("gap 200, step", 2.0, "µm")],
            &["gap 20"],
        );
    }
}
