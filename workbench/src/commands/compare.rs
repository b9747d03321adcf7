//! `quadrant compare`: several runs of `commission` beside each other.

use std::path::Path;

use serde::Serialize;

use crate::cli::{self, Circles};
use crate::commissioning::run_folder::{RunCircle, RunFolder, RunParameter};
use crate::console::print_table;
use crate::error::Outcome;
use crate::output_files::{self, json, write};
use crate::presentation::page::Page;
use crate::presentation::plots::{Curve, Ink, Plot, Polar, Trace, curves, polar, standalone};
use crate::presentation::result_tables::{TextTable, head};
use crate::say;
use identification::figures;

/// Compares runs, prints the tables and writes what was asked for.
///
/// # Errors
/// Where a folder is not of a run, or a file cannot be written.
pub fn run(arguments: &cli::Compare) -> Outcome<()> {
    output_files::check([&arguments.out, &arguments.plot, &arguments.json].map(Option::as_ref))?;
    let runs = arguments.runs.iter().map(|path| RunFolder::read(path));
    let runs = runs.collect::<Outcome<Vec<_>>>()?;
    let changes = changes(&runs);
    print_table(&runs_table(&runs));
    say!("");
    if changes.is_empty() {
        say!("no parameter changed by more than its intervals since the first run");
    } else {
        print_table(&changes_table(&changes));
    }
    if let Some(path) = &arguments.json {
        let rows: Vec<RunRow> = runs.iter().map(RunRow::of).collect();
        let comparison = Comparison {
            runs: rows,
            changed: &changes,
        };
        write(path, &json(&comparison)?)?;
    }
    if let Some(path) = &arguments.plot {
        write(path, &standalone(&circles(&runs, arguments.circles)?))?;
    }
    arguments
        .out
        .as_deref()
        .map_or(Ok(()), |path| write_page(path, &runs, &changes))
}

fn write_page(path: &Path, runs: &[RunFolder], changes: &[Change]) -> Outcome<()> {
    let mut page = Page::new("Comparison of runs");
    page.table(&runs_table(runs));
    page.pictures(&[
        circles(runs, Circles::Before)?,
        circles(runs, Circles::After)?,
    ]);
    page.pictures(&[trend(runs)]);
    page.heading("Parameters that changed by more than their intervals");
    if changes.is_empty() {
        page.paragraph("None since the first run.");
    } else {
        page.table(&changes_table(changes));
    }
    write(path, &page.finish())
}

/// What `compare --json` says.
#[derive(Serialize)]
struct Comparison<'a> {
    runs: Vec<RunRow>,
    changed: &'a [Change],
}

#[derive(Serialize)]
struct RunRow {
    run: String,
    machine: String,
    date: String,
    program: String,
    method: String,
    burst_before_um: f64,
    burst_after_um: f64,
    circular_deviation_g_before_um: f64,
    circular_deviation_g_after_um: f64,
    circular_hysteresis_h_after_um: Option<f64>,
}

impl RunRow {
    fn of(run: &RunFolder) -> Self {
        let own = &run.summary;
        Self {
            run: run.name(),
            machine: own.machine.clone(),
            date: own.date.clone(),
            program: own.program.clone(),
            method: own.method.clone(),
            burst_before_um: own.circle_before.peak_max_um,
            burst_after_um: own.circle_after.peak_max_um,
            circular_deviation_g_before_um: own.circle_before.circular_deviation_g_both_um,
            circular_deviation_g_after_um: own.circle_after.circular_deviation_g_both_um,
            circular_hysteresis_h_after_um: own.circle_after.circular_hysteresis_h_um,
        }
    }
}

/// A parameter whose interval holds nothing of that of the first run.
#[derive(Clone, Debug, PartialEq, Serialize)]
struct Change {
    run: String,
    axis: String,
    parameter: String,
    unit: String,
    first: f64,
    now: f64,
    by_percent: f64,
}

fn changes(runs: &[RunFolder]) -> Vec<Change> {
    let Some((first, others)) = runs.split_first() else {
        return Vec::new();
    };
    others
        .iter()
        .flat_map(|run| changed_since(first, run))
        .collect()
}

fn changed_since(first: &RunFolder, run: &RunFolder) -> Vec<Change> {
    let mut changes = Vec::new();
    for axis in &run.summary.axes {
        let earlier = first.summary.axes.iter().find(|own| own.name == axis.name);
        for (name, now) in &axis.parameters {
            let was = earlier.and_then(|own| own.parameters.get(name));
            let pair = was.and_then(|was| Some((was, was.value?, now.value?)));
            let Some((was, first, value)) = pair.filter(|(was, ..)| is_apart(was, now)) else {
                continue;
            };
            changes.push(Change {
                run: run.name(),
                axis: axis.name.clone(),
                parameter: name.clone(),
                unit: was.unit.clone(),
                first,
                now: value,
                by_percent: 100.0 * (value / first - 1.0),
            });
        }
    }
    changes
}

fn is_apart(one: &RunParameter, other: &RunParameter) -> bool {
    one.high < other.low || other.high < one.low
}

fn runs_table(runs: &[RunFolder]) -> TextTable {
    let mut rows = vec![head([
        "run",
        "date",
        "circle",
        "method",
        "burst before, µm",
        "after, µm",
        "G before, µm",
        "after, µm",
        "H after, µm",
    ])];
    let circle = |own: &RunCircle| format!("R {} F {:.0}", own.radius_mm, own.feed_mm_min);
    rows.extend(runs.iter().map(|run| {
        let (row, after) = (RunRow::of(run), &run.summary.circle_after);
        let h = row.circular_hysteresis_h_after_um;
        vec![
            row.run,
            row.date,
            circle(after),
            row.method,
            figures::error(row.burst_before_um),
            figures::error(row.burst_after_um),
            figures::error(row.circular_deviation_g_before_um),
            figures::error(row.circular_deviation_g_after_um),
            h.map_or_else(|| "–".to_owned(), figures::error),
        ]
    }));
    rows
}

fn changes_table(changes: &[Change]) -> TextTable {
    let mut rows = vec![head([
        "run",
        "axis",
        "parameter",
        "first run",
        "now",
        "unit",
        "change, %",
    ])];
    rows.extend(changes.iter().map(|own| {
        vec![
            own.run.clone(),
            own.axis.clone(),
            own.parameter.clone(),
            figures::error(own.first),
            figures::error(own.now),
            own.unit.clone(),
            format!("{:+.1}", own.by_percent),
        ]
    }));
    rows
}

/// The circles over each other.
fn circles(runs: &[RunFolder], which: Circles) -> Outcome<String> {
    let is_after = which == Circles::After;
    let read = runs.iter().map(|run| run.circle(is_after));
    let read = read.collect::<Outcome<Vec<_>>>()?;
    let mut traces = Vec::new();
    for (number, (run, (figures, turns))) in runs.iter().zip(&read).enumerate() {
        let directions = ["counter-clockwise", "clockwise"].into_iter().zip(turns);
        traces.extend(
            directions
                .enumerate()
                .map(|(place, (direction, points))| Trace {
                    name: format!("{} {direction}", run.name()),
                    ink: Ink::Other(number),
                    is_dashed: place > 0,
                    points,
                    radius_m: 1.0e-3 * figures.radius_mm,
                }),
        );
    }
    let burst = |place: usize| {
        let each = read
            .iter()
            .map(|(figures, _)| format!("{:.2}", figures.peak_um[place]));
        format!("{} µm", each.collect::<Vec<_>>().join(" → "))
    };
    let axes = runs.first().map_or(&[][..], |run| &run.summary.axes);
    let axis = |place: usize| axes.get(place).map_or("", |axis| axis.name.as_str());
    let title = if is_after {
        "Circles with what each run has downloaded"
    } else {
        "Circles without compensation"
    };
    Ok(polar(&Polar {
        title,
        axes: [axis(0), axis(1)],
        traces: &traces,
        bursts: [0, 1, 2, 3].map(burst),
        tolerance_um: None,
    }))
}

/// Burst and G from run to run.
fn trend(runs: &[RunFolder]) -> String {
    let over = |name: &str, ink: Ink, value: &dyn Fn(&RunRow) -> f64| {
        let points = runs.iter().enumerate();
        Curve::line(
            name,
            ink,
            points.map(|(number, run)| (number as f64 + 1.0, value(&RunRow::of(run)))),
        )
    };
    let list = [
        over("burst before", Ink::Before, &|row| row.burst_before_um),
        over("burst after", Ink::After, &|row| row.burst_after_um),
        over("G before", Ink::Other(2), &|row| {
            row.circular_deviation_g_before_um
        }),
        over("G after", Ink::Other(3), &|row| {
            row.circular_deviation_g_after_um
        }),
    ];
    let plot = Plot {
        title: "Burst and circular deviation from run to run",
        x: "run",
        y: "µm",
        size_px: (540.0, 340.0),
        x_range: None,
        is_logarithmic: false,
    };
    curves(&plot, &list)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_parameter_has_changed_where_the_intervals_have_nothing_in_common() {
        let own = |low: f64, high: f64| RunParameter {
            value: Some(0.5 * (low + high)),
            unit: "N".into(),
            low,
            high,
        };
        assert!(is_apart(&own(1.0, 2.0), &own(2.1, 3.0)));
        assert!(is_apart(&own(2.1, 3.0), &own(1.0, 2.0)));
        assert!(!is_apart(&own(1.0, 2.0), &own(1.9, 3.0)));
    }
}
