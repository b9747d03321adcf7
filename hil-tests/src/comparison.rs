//! Two identifications of the same record, number by number.
//!
//! A folder holds one folder for each record with `report.json` and `model.toml`, as
//! `scripts/compare-identification` lays them out. Numbers are compared relative to the larger of
//! the two, everything else exactly. What only one report has is a difference; what only one
//! machine file has is counted, because its form may change where its values do not.

use std::collections::BTreeSet;
use std::io;
use std::path::Path;

use serde_json::Value;

/// Numbers may differ by this share: 1e-6 is far above the rounding of a sum in another order, and
/// far below the interval of any parameter.
pub const TOLERANCE: f64 = 1.0e-6;

/// What a comparison found.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Comparison {
    /// Numbers that both have.
    pub numbers: usize,
    /// Values of machine files that only one of them has.
    pub only_in_one: usize,
    /// The largest relative difference of two numbers.
    pub worst: f64,
    /// Where it was.
    pub worst_at: String,
    /// A line for each difference: path, before, after.
    pub differences: Vec<String>,
}

/// Whether a value that only one side has is a difference.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Missing {
    /// It is.
    Differs,
    /// It is counted.
    Counts,
}

/// Compares two values below a path.
pub struct Comparer {
    /// Share by which numbers may differ.
    pub tolerance: f64,
    /// What was found so far.
    pub found: Comparison,
}

impl Comparer {
    /// Begins a comparison.
    #[must_use]
    pub fn new(tolerance: f64) -> Self {
        Self {
            tolerance,
            found: Comparison::default(),
        }
    }

    /// Compares all records of two folders. Returns how many there are.
    ///
    /// # Errors
    /// Where a folder or a file cannot be read.
    pub fn folders(&mut self, before: &Path, after: &Path) -> io::Result<usize> {
        let records: BTreeSet<String> = &names(before)? | &names(after)?;
        for record in &records {
            let (before, after) = (before.join(record), after.join(record));
            let [a, b] = [&before, &after].map(|folder| json(&folder.join("report.json")));
            self.values(record, &a?, &b?, Missing::Differs);
            let [a, b] = [&before, &after].map(|folder| machine(&folder.join("model.toml")));
            let path = format!("{record}/model.toml");
            self.values(&path, &a?, &b?, Missing::Counts);
        }
        Ok(records.len())
    }

    /// Compares two values.
    pub fn values(&mut self, path: &str, before: &Value, after: &Value, missing: Missing) {
        match (before, after) {
            (Value::Number(a), Value::Number(b)) => {
                self.numbers(path, a.as_f64(), b.as_f64());
            }
            (Value::Object(a), Value::Object(b)) => {
                let keys: BTreeSet<&String> = a.keys().chain(b.keys()).collect();
                for key in keys {
                    self.members(&format!("{path}/{key}"), a.get(key), b.get(key), missing);
                }
            }
            (Value::Array(a), Value::Array(b)) => {
                for place in 0..a.len().max(b.len()) {
                    let path = format!("{path}[{place}]");
                    self.members(&path, a.get(place), b.get(place), missing);
                }
            }
            (a, b) if a == b => {}
            (a, b) => self.differ(path, a, b),
        }
    }

    fn members(&mut self, path: &str, a: Option<&Value>, b: Option<&Value>, missing: Missing) {
        match (a, b, missing) {
            (Some(a), Some(b), _) => self.values(path, a, b, missing),
            (a, b, Missing::Differs) => {
                let text = |value: Option<&Value>| value.map_or("missing".into(), Value::to_string);
                self.differ(path, &text(a), &text(b));
            }
            (_, _, Missing::Counts) => self.found.only_in_one += 1,
        }
    }

    fn numbers(&mut self, path: &str, before: Option<f64>, after: Option<f64>) {
        let (before, after) = (before.unwrap_or(f64::NAN), after.unwrap_or(f64::NAN));
        let share = relative(before, after);
        self.found.numbers += 1;
        if share > self.found.worst {
            (self.found.worst, self.found.worst_at) = (share, path.to_owned());
        }
        if share > self.tolerance || share.is_nan() {
            self.differ(path, &before, &after);
        }
    }

    fn differ(
        &mut self,
        path: &str,
        before: &dyn std::fmt::Display,
        after: &dyn std::fmt::Display,
    ) {
        let line = format!("{path}: {before} before, {after} after");
        self.found.differences.push(line);
    }
}

/// The difference of two numbers as a share of the larger one.
fn relative(before: f64, after: f64) -> f64 {
    if before == after {
        return 0.0;
    }
    (before - after).abs() / f64::max(before.abs(), after.abs())
}

/// The folders in a folder.
fn names(folder: &Path) -> io::Result<BTreeSet<String>> {
    let entries = std::fs::read_dir(folder)?;
    let names = entries.map(|entry| Ok(entry?.file_name().to_string_lossy().into_owned()));
    names.collect()
}

/// A report; without one, what the program said instead.
fn json(path: &Path) -> io::Result<Value> {
    if path.exists() {
        return Ok(serde_json::from_str(&std::fs::read_to_string(path)?)?);
    }
    let said = path.with_file_name("stderr.txt");
    Ok(Value::String(
        std::fs::read_to_string(said).unwrap_or_default(),
    ))
}

/// A machine file; none where no machine can be made of what was identified.
fn machine(path: &Path) -> io::Result<Value> {
    if !path.exists() {
        return Ok(Value::Object(serde_json::Map::new()));
    }
    let table: toml::Table = std::fs::read_to_string(path)?
        .parse()
        .map_err(io::Error::other)?;
    Ok(serde_json::to_value(table)?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn compared(before: &Value, after: &Value, missing: Missing) -> Comparison {
        let mut comparer = Comparer::new(TOLERANCE);
        comparer.values("r", before, after, missing);
        comparer.found
    }

    #[test]
    fn a_number_may_be_off_by_a_millionth_and_not_by_more() {
        for (after, is_off) in [
            (1_000.0, false),
            (1_000.000_9, false),
            (999.999_1, false),
            (1_000.001_1, true),
            (999.998_9, true),
            (-1_000.0, true),
            (0.0, true),
        ] {
            let found = compared(
                &json!({"a": [1_000.0]}),
                &json!({"a": [after]}),
                Missing::Differs,
            );
            assert_eq!(!found.differences.is_empty(), is_off, "{after}");
        }
    }

    #[test]
    fn the_worst_number_is_told_with_its_place() {
        let before = json!({"a": 1.0, "b": 2.0, "c": 0.0});
        let after = json!({"a": 1.000_000_1, "b": 2.000_000_4, "c": 0.0});
        let found = compared(&before, &after, Missing::Differs);
        assert_eq!((found.numbers, found.worst_at.as_str()), (3, "r/b"));
        assert!((1.9e-7..2.1e-7).contains(&found.worst), "{}", found.worst);
        assert_eq!(found.differences, Vec::<String>::new());
    }

    #[test]
    fn another_name_verdict_kind_or_length_is_a_difference() {
        for (before, after) in [
            (json!({"found": ["delay"]}), json!({"found": ["backlash"]})),
            (json!({"found": ["delay"]}), json!({"found": []})),
            (
                json!({"verdict": "explained"}),
                json!({"verdict": "unexplained"}),
            ),
            (json!({"gap": null}), json!({"gap": 0.0})),
            (json!({"gap": 1.0}), json!({})),
        ] {
            let found = compared(&before, &after, Missing::Differs);
            assert_eq!(found.differences.len(), 1, "{before} {after}");
        }
    }

    #[test]
    fn a_machine_file_may_have_another_form_and_no_other_number() {
        let before = json!({"gap": 1.0, "old": 1.0});
        let renamed = compared(&before, &json!({"gap": 1.0, "new": 1.0}), Missing::Counts);
        assert_eq!((renamed.differences.len(), renamed.only_in_one), (0, 2));
        let changed = compared(&before, &json!({"gap": 2.0}), Missing::Counts);
        assert_eq!(changed.differences, ["r/gap: 1 before, 2 after"]);
    }
}
