//! Golden tables: what was measured once, with bounds on both sides, so that an unexplained improvement fails too.
//!
//! A table is a text file of rows `name | value | tolerance | unit | note`. `QUADRANT_BLESS=1` rewrites the values and keeps tolerances and notes;
//! the change is then for a person to review.

use std::fmt::Write as _;
use std::path::PathBuf;

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
    Measured { name: name.into(), value, unit }
}

struct Row {
    name: String,
    value: f64,
    tolerance: f64,
    note: String,
}

fn path(table: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("golden").join(format!("{table}.md"))
}

fn parse(text: &str) -> Vec<Row> {
    let cells = |line: &str| line.trim_matches('|').split('|').map(|cell| cell.trim().to_owned()).collect::<Vec<_>>();
    text.lines()
        .filter(|line| line.starts_with('|'))
        .map(cells)
        .filter_map(|cells| {
            let [name, value, tolerance, _, note] = &cells[..] else { return None };
            Some(Row {
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
    let text = std::fs::read_to_string(path(table)).unwrap_or_default();
    let rows = parse(&text);
    if std::env::var_os("QUADRANT_BLESS").is_some() {
        std::fs::write(path(table), blessed(&text, &rows, measured)).expect("the golden folder is writable");
        return;
    }
    let mut wrong = String::new();
    for new in measured {
        match rows.iter().find(|row| row.name == new.name) {
            None => writeln!(wrong, "new row: {} = {}", new.name, new.value),
            Some(row) if (new.value - row.value).abs() <= row.tolerance => Ok(()),
            Some(row) => {
                writeln!(
                    wrong,
                    "{}: {} ± {} {} wanted, {} measured",
                    row.name, row.value, row.tolerance, new.unit, new.value
                )
            }
        }
        .expect("a String takes everything");
    }
    for row in rows.iter().filter(|row| !measured.iter().any(|new| new.name == row.name)) {
        writeln!(wrong, "row not measured: {}", row.name).expect("a String takes everything");
    }
    assert!(wrong.is_empty(), "golden/{table}.md (QUADRANT_BLESS=1 rewrites it):\n{wrong}");
}

fn blessed(text: &str, rows: &[Row], measured: &[Measured]) -> String {
    let head: String =
        text.lines().take_while(|line| !line.starts_with('|')).fold(String::new(), |head, line| head + line + "\n");
    let mut out = head + "| figure | value | tolerance | unit | note |\n|---|---|---|---|---|\n";
    for new in measured {
        let known = rows.iter().find(|row| row.name == new.name);
        let (tolerance, note) = known.map_or_else(|| (0.02 * new.value.abs(), ""), |row| (row.tolerance, &row.note));
        writeln!(out, "| {} | {:.3} | {tolerance:.3} | {} | {note} |", new.name, new.value, new.unit)
            .expect("a String takes everything");
    }
    out
}
