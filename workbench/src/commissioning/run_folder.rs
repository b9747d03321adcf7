//! An earlier run, read back from its folder: for comparisons, months later.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use serde::Deserialize;

use crate::ballbar::Point;
use crate::circle_test::CircleRun;
use crate::error::{Failure, Outcome};

/// What of `summary.json` is compared.
#[derive(Clone, Debug, Deserialize)]
pub struct RunSummary {
    /// Machine.
    pub machine: String,
    /// When it was, UTC.
    pub date: String,
    /// Version and commit.
    pub program: String,
    /// Whether a simulator stood in for the machine.
    pub simulation: bool,
    /// What was downloaded.
    pub method: String,
    /// The circle without it.
    pub circle_before: RunCircle,
    /// The circle with it.
    pub circle_after: RunCircle,
    /// Axes.
    pub axes: Vec<RunAxis>,
}

/// A circle of a run.
#[derive(Clone, Debug, Deserialize)]
pub struct RunCircle {
    /// Radius.
    pub radius_mm: f64,
    /// Feed.
    pub feed_mm_min: f64,
    /// What saw it.
    pub deviation_of: String,
    /// Spikes at 0°, 90°, 180° and 270°.
    pub spikes_um: [f64; 4],
    /// G of both directions.
    pub circular_deviation_g_both_um: f64,
    /// Hysteresis.
    pub circular_hysteresis_h_um: Option<f64>,
}

impl RunCircle {
    /// The largest spike, µm.
    #[must_use]
    pub fn spike_um(&self) -> f64 {
        self.spikes_um.into_iter().fold(0.0, f64::max)
    }

    /// What has to be the same for figures to be compared.
    #[must_use]
    pub fn conditions(&self) -> String {
        format!(
            "R {} mm, F {:.0} mm/min, seen by {}",
            self.radius_mm, self.feed_mm_min, self.deviation_of
        )
    }
}

/// An axis of a run.
#[derive(Clone, Debug, Deserialize)]
pub struct RunAxis {
    /// Its name.
    pub name: String,
    /// Effects that were found.
    pub found: Vec<String>,
    /// Parameters that are known, or are not.
    pub parameters: std::collections::BTreeMap<String, RunParameter>,
}

/// A parameter of a run; without a value where it was unknown.
#[derive(Clone, Debug, Deserialize)]
pub struct RunParameter {
    /// Value.
    #[serde(default)]
    pub value: Option<f64>,
    /// Unit.
    #[serde(default)]
    pub unit: String,
    /// Lower end of its interval; none where it was no number, as JSON has it.
    #[serde(default)]
    pub low: Option<f64>,
    /// Upper end.
    #[serde(default)]
    pub high: Option<f64>,
}

/// A folder of `commission`.
#[derive(Clone, Debug)]
pub struct RunFolder {
    /// Where it is.
    pub path: PathBuf,
    /// What it is called.
    pub name: String,
    /// Its summary.
    pub summary: RunSummary,
}

impl RunFolder {
    /// Reads the summary of a run.
    ///
    /// # Errors
    /// Where it is not there, or not of a run that ended with circles.
    pub fn read(path: &Path) -> Outcome<Self> {
        let file = path.join("summary.json");
        let text = std::fs::read_to_string(&file).map_err(|error| {
            Failure::new(format!(
                "{}: {error}; name a folder that `quadrant commission --out` has written",
                file.display()
            ))
        })?;
        let summary = serde_json::from_str(&text).map_err(|error| {
            Failure::new(format!(
                "{}: {error}; this is no summary of a run with circles before and after by this program",
                file.display()
            ))
        })?;
        Ok(Self {
            path: path.to_owned(),
            name: path.display().to_string(),
            summary,
        })
    }

    /// The circle without compensation, or with it: its figures, and its turns counter-clockwise
    /// and clockwise.
    ///
    /// # Errors
    /// Where its file is missing or wrong.
    pub fn circle(&self, is_after: bool) -> Outcome<(&RunCircle, [Vec<Point>; 2])> {
        let (file, figures) = if is_after {
            ("circle-after.csv", &self.summary.circle_after)
        } else {
            ("circle-before.csv", &self.summary.circle_before)
        };
        Ok((figures, read_circle(&self.path.join(file))?))
    }
}

/// The head of a circle's file.
const COLUMNS: &str = "direction,angle_rad,reference_x_m,reference_y_m,table_x_m,table_y_m";

/// One turn in each direction as CSV, to 0.1 nm.
#[must_use]
pub fn circle_csv(run: &CircleRun) -> String {
    let mut text = format!("{COLUMNS}\n");
    for (direction, points) in [("ccw", run.one_turn()), ("cw", &run.clockwise)] {
        for point in points {
            let ([x, y], [table_x, table_y]) = (point.reference_m, point.table_m);
            let _ = writeln!(
                text,
                "{direction},{:.7},{x:.10},{y:.10},{table_x:.10},{table_y:.10}",
                point.angle_rad
            );
        }
    }
    text
}

fn read_circle(path: &Path) -> Outcome<[Vec<Point>; 2]> {
    let wrong = |what: String| Failure::new(format!("{}: {what}", path.display()));
    let mut reader = csv::Reader::from_path(path).map_err(|error| wrong(error.to_string()))?;
    let mut turns = [Vec::new(), Vec::new()];
    for (number, row) in reader.deserialize().enumerate() {
        let row: (String, [f64; 5]) = row.map_err(|error| wrong(error.to_string()))?;
        let (direction, [angle_rad, x, y, table_x, table_y]) = row;
        let turn = match direction.as_str() {
            "ccw" => 0,
            "cw" => 1,
            other => {
                return Err(wrong(format!(
                    "line {}: direction ccw or cw, got {other}",
                    number + 2
                )));
            }
        };
        turns[turn].push(Point {
            angle_rad,
            table_m: [table_x, table_y],
            motor_m: [table_x, table_y],
            reference_m: [x, y],
        });
    }
    Ok(turns)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_no_number_is_read_as_unknown() {
        let text = r#"{ "value": null, "unit": "N", "low": null, "high": 7.0 }"#;
        let parameter: RunParameter = serde_json::from_str(text).unwrap();
        assert_eq!((parameter.value, parameter.low), (None, None));
        assert_eq!(parameter.high, Some(7.0));
    }
}
