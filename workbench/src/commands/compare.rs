//! `quadrant compare`: several runs of `commission` beside each other.

use std::collections::BTreeSet;
use std::path::Path;

use serde::Serialize;

use crate::cli::{self, Circles};
use crate::commissioning::run_folder::{RunAxis, RunCircle, RunFolder, RunParameter};
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
    let runs = named(runs.collect::<Outcome<Vec<_>>>()?);
    let (unlike, changes) = (unlike(&runs), changes(&runs));
    print_table(&runs_table(&runs));
    say!("");
    for sentence in &unlike {
        say!("{sentence}");
    }
    if changes.is_empty() {
        say!("{UNCHANGED}");
    } else {
        print_table(&changes_table(&changes));
    }
    if let Some(path) = &arguments.json {
        let comparison = Comparison {
            runs: runs.iter().map(RunRow::of).collect(),
            unlike: &unlike,
            changed: &changes,
        };
        write(path, &json(&comparison)?)?;
    }
    if let Some(path) = &arguments.plot {
        write(path, &standalone(&circles(&runs, arguments.circles)?))?;
    }
    let page = arguments.out.as_deref();
    page.map_or(Ok(()), |path| write_page(path, &runs, &unlike, &changes))
}

const UNCHANGED: &str = "Since the first run no effect has come or gone, and no parameter has changed by more than its intervals.";

/// The names of the folders, where these are all different; their paths otherwise.
fn named(mut runs: Vec<RunFolder>) -> Vec<RunFolder> {
    let short = |run: &RunFolder| {
        run.path
            .file_name()
            .map(|name| name.to_string_lossy().into_owned())
    };
    let names: Vec<Option<String>> = runs.iter().map(short).collect();
    let all: BTreeSet<&Option<String>> = names.iter().collect();
    if all.len() == names.len() {
        for (run, name) in runs.iter_mut().zip(names) {
            run.name = name.unwrap_or_else(|| run.path.display().to_string());
        }
    }
    runs
}

/// Runs whose figures cannot be compared with those of the first one.
fn unlike(runs: &[RunFolder]) -> Vec<String> {
    let mut sentences = Vec::new();
    let Some((first, others)) = runs.split_first() else {
        return sentences;
    };
    for run in others {
        let of = |run: &RunFolder| {
            let simulated = if run.summary.simulation {
                "simulated "
            } else {
                ""
            };
            let machine = format!("{simulated}{}", run.summary.machine);
            (machine, run.summary.circle_after.conditions())
        };
        let (was, now) = (of(first), of(run));
        if was != now {
            sentences.push(format!(
                "Note: {} is machine {}, circle {}; {} is machine {}, circle {}: their figures do not compare.",
                run.name, now.0, now.1, first.name, was.0, was.1
            ));
        }
    }
    sentences
}

fn write_page(
    path: &Path,
    runs: &[RunFolder],
    unlike: &[String],
    changes: &[Change],
) -> Outcome<()> {
    let mut page = Page::new("Comparison of runs");
    page.table(&runs_table(runs));
    for sentence in unlike {
        page.key(sentence);
    }
    page.pictures(&[
        circles(runs, Circles::Before)?,
        circles(runs, Circles::After)?,
    ]);
    page.pictures(&[trend(runs)]);
    page.heading(
        "Effects and parameters that changed since the first run by more than their intervals",
    );
    if changes.is_empty() {
        page.paragraph(UNCHANGED);
    } else {
        page.table(&changes_table(changes));
    }
    write(path, &page.finish())
}

/// What `compare --json` says.
#[derive(Serialize)]
struct Comparison<'a> {
    runs: Vec<RunRow>,
    unlike: &'a [String],
    changed: &'a [Change],
}

#[derive(Serialize)]
struct RunRow {
    run: String,
    machine: String,
    date: String,
    program: String,
    method: String,
    spike_before_um: f64,
    spike_after_um: f64,
    circular_deviation_g_before_um: f64,
    circular_deviation_g_after_um: f64,
    circular_hysteresis_h_after_um: Option<f64>,
}

impl RunRow {
    fn of(run: &RunFolder) -> Self {
        let own = &run.summary;
        Self {
            run: run.name.clone(),
            machine: own.machine.clone(),
            date: own.date.clone(),
            program: own.program.clone(),
            method: own.method.clone(),
            spike_before_um: own.circle_before.spike_um(),
            spike_after_um: own.circle_after.spike_um(),
            circular_deviation_g_before_um: own.circle_before.circular_deviation_g_both_um,
            circular_deviation_g_after_um: own.circle_after.circular_deviation_g_both_um,
            circular_hysteresis_h_after_um: own.circle_after.circular_hysteresis_h_um,
        }
    }
}

/// An effect that came or went, or a parameter whose interval holds nothing of that of the first
/// run.
#[derive(Clone, Debug, PartialEq, Serialize)]
struct Change {
    run: String,
    axis: String,
    what: String,
    unit: String,
    /// None where it was not there, or unknown.
    first: Option<f64>,
    now: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    by_percent: Option<f64>,
}

fn changes(runs: &[RunFolder]) -> Vec<Change> {
    let Some((first, others)) = runs.split_first() else {
        return Vec::new();
    };
    let since = |run: &RunFolder| changed_since(first, run);
    others.iter().flat_map(since).collect()
}

fn changed_since(first: &RunFolder, run: &RunFolder) -> Vec<Change> {
    let mut changes = Vec::new();
    for axis in &run.summary.axes {
        let earlier = first.summary.axes.iter().find(|own| own.name == axis.name);
        let Some(earlier) = earlier else {
            continue;
        };
        let mut add = |what: String, unit: &str, [first, now]: [Option<f64>; 2]| {
            let ratio = first.zip(now).filter(|(first, _)| *first != 0.0);
            changes.push(Change {
                run: run.name.clone(),
                axis: axis.name.clone(),
                what,
                unit: unit.to_owned(),
                first,
                now,
                by_percent: ratio.map(|(first, now)| 100.0 * (now / first - 1.0)),
            });
        };
        let missing = |of: &RunAxis, from: &RunAxis| -> Vec<String> {
            let gone = of.found.iter().filter(|name| !from.found.contains(name));
            gone.cloned().collect()
        };
        for name in missing(axis, earlier) {
            add(format!("{name} is new"), "", [None, None]);
        }
        for name in missing(earlier, axis) {
            add(format!("{name} is gone"), "", [None, None]);
        }
        let names: BTreeSet<&String> = earlier
            .parameters
            .keys()
            .chain(axis.parameters.keys())
            .collect();
        for name in names {
            let [was, now] = [earlier, axis].map(|own| own.parameters.get(name));
            let values = [was, now].map(|own| own.and_then(|own| own.value));
            let has_changed = match (was, now) {
                (Some(was), Some(now)) if was.value.is_some() && now.value.is_some() => {
                    is_apart(was, now)
                }
                _ => values[0].is_some() != values[1].is_some(),
            };
            if has_changed {
                let unit = was.or(now).map_or("", |own| own.unit.as_str());
                add(name.clone(), unit, values);
            }
        }
    }
    changes
}

/// Whether the intervals say that it is another value: one without ends says nothing.
fn is_apart(one: &RunParameter, other: &RunParameter) -> bool {
    let below = |high: Option<f64>, low: Option<f64>| high.zip(low).is_some_and(|(h, l)| h < l);
    below(one.high, other.low) || below(other.high, one.low)
}

fn runs_table(runs: &[RunFolder]) -> TextTable {
    let mut rows = vec![head([
        "run",
        "date",
        "circle",
        "method",
        "spike before, µm",
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
            figures::error(row.spike_before_um),
            figures::error(row.spike_after_um),
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
        "what",
        "first run",
        "now",
        "unit",
        "change, %",
    ])];
    let or = |value: Option<f64>| value.map_or_else(|| "–".to_owned(), figures::error);
    rows.extend(changes.iter().map(|own| {
        let by = own.by_percent;
        vec![
            own.run.clone(),
            own.axis.clone(),
            own.what.clone(),
            or(own.first),
            or(own.now),
            own.unit.clone(),
            by.map_or_else(|| "–".to_owned(), |percent| format!("{percent:+.1}")),
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
                    name: format!("{} {direction}", run.name),
                    ink: Ink::Other(number),
                    is_dashed: place > 0,
                    points,
                    radius_m: 1.0e-3 * figures.radius_mm,
                }),
        );
    }
    let spike = |place: usize| {
        let each = read
            .iter()
            .map(|(figures, _)| format!("{:.2}", figures.spikes_um[place]));
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
        bursts: [0, 1, 2, 3].map(spike),
        zone: None,
    }))
}

/// Spike and G from run to run.
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
        over("spike before", Ink::Before, &|row| row.spike_before_um),
        over("spike after", Ink::After, &|row| row.spike_after_um),
        over("G before", Ink::Other(2), &|row| {
            row.circular_deviation_g_before_um
        }),
        over("G after", Ink::Other(3), &|row| {
            row.circular_deviation_g_after_um
        }),
    ];
    let plot = Plot::new(
        "Reversal spike and circular deviation from run to run",
        "run",
        "µm",
        (540.0, 340.0),
    );
    curves(&plot, &list)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::commissioning::run_folder::RunSummary;

    /// Name, effects that were found, parameters.
    type Axis<'a> = (&'a str, &'a [&'a str], &'a [(&'a str, Option<f64>)]);

    fn folder(name: &str, axes: &[Axis<'_>]) -> RunFolder {
        let circle = RunCircle {
            radius_mm: 100.0,
            feed_mm_min: 2000.0,
            deviation_of: "table".into(),
            spikes_um: [1.0; 4],
            circular_deviation_g_both_um: 2.0,
            circular_hysteresis_h_um: None,
        };
        let parameter = |(name, value): &(&str, Option<f64>)| {
            let of = value.unwrap_or(0.0);
            let own = RunParameter {
                value: *value,
                unit: "N".into(),
                low: Some(of - 1.0),
                high: Some(of + 1.0),
            };
            ((*name).to_owned(), own)
        };
        let axis = |(name, found, parameters): &Axis<'_>| RunAxis {
            name: (*name).to_owned(),
            found: found.iter().map(|own| (*own).to_owned()).collect(),
            parameters: parameters.iter().map(parameter).collect(),
        };
        RunFolder {
            path: name.into(),
            name: name.into(),
            summary: RunSummary {
                machine: "m".into(),
                date: String::new(),
                program: String::new(),
                simulation: true,
                method: "model".into(),
                circle_before: circle.clone(),
                circle_after: circle,
                axes: axes.iter().map(axis).collect(),
            },
        }
    }

    #[test]
    fn what_came_what_went_and_what_changed_is_told_and_nothing_else() {
        let first = folder(
            "a",
            &[(
                "X",
                &["stribeck"],
                &[
                    ("coulomb", Some(400.0)),
                    ("offset", Some(3.0)),
                    ("gap", None),
                ],
            )],
        );
        let later = folder(
            "b",
            &[
                (
                    "X",
                    &["backlash"],
                    &[
                        ("coulomb", Some(280.0)),
                        ("offset", Some(4.5)),
                        ("gap", Some(8.0)),
                    ],
                ),
                ("Z", &["delay"], &[("coulomb", Some(1.0))]),
            ],
        );
        let told: Vec<(String, Option<f64>)> = changes(&[first.clone(), later])
            .into_iter()
            .map(|own| (own.what, own.by_percent.map(f64::round)))
            .collect();
        let wanted = [
            ("backlash is new", None),
            ("stribeck is gone", None),
            ("coulomb", Some(-30.0)),
            ("gap", None),
        ]
        .map(|(what, by)| (what.to_owned(), by));
        assert_eq!(told, wanted);
        assert_eq!(changes(&[first.clone(), first]), []);
    }

    #[test]
    fn folders_of_one_name_are_told_apart_and_another_circle_is_noted() {
        let mut runs = vec![folder("a/out", &[]), folder("b/out", &[])];
        runs[1].summary.circle_after.feed_mm_min = 500.0;
        let runs = named(runs);
        assert_eq!(
            (runs[0].name.as_str(), runs[1].name.as_str()),
            ("a/out", "b/out")
        );
        let notes = unlike(&runs);
        assert!(
            notes.len() == 1 && notes[0].contains("F 500 mm/min"),
            "{notes:?}"
        );
    }

    #[test]
    fn a_parameter_has_changed_where_the_intervals_have_nothing_in_common() {
        let own = |low: f64, high: f64| RunParameter {
            value: Some(0.5 * (low + high)),
            unit: "N".into(),
            low: Some(low),
            high: Some(high),
        };
        let open = RunParameter {
            high: None,
            ..own(5.0, 6.0)
        };
        assert!(!is_apart(&open, &own(7.0, 8.0)));
        assert!(is_apart(&own(1.0, 2.0), &own(2.1, 3.0)));
        assert!(is_apart(&own(2.1, 3.0), &own(1.0, 2.0)));
        assert!(!is_apart(&own(1.0, 2.0), &own(1.9, 3.0)));
    }

    #[test]
    fn what_is_no_run_is_refused_with_its_file() {
        let folder = tempfile::tempdir().unwrap();
        let refusal = run(&cli::Compare {
            runs: vec![folder.path().to_path_buf(), folder.path().to_path_buf()],
            out: None,
            plot: None,
            circles: Circles::After,
            json: None,
        });
        let refusal = refusal.unwrap_err().to_string();
        assert!(
            refusal.contains("summary.json") && refusal.contains("quadrant commission --out"),
            "{refusal}"
        );
    }
}
