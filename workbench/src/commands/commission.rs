//! `quadrant commission`: the main job, from recording to the circle with compensation.

use std::path::{Path, PathBuf};
use std::thread::JoinHandle;
use std::time::Duration;

use identification::{Dataset, Identification, IdentificationError};
use plant_sim::Machine;
use plant_sim::machine::MachineAxis;
use serde::Serialize;

use crate::axis_records::{self, Part};
use crate::cli;
use crate::commands::circle::{self, CircleReport, CircleRun};
use crate::commands::identify::{self, write};
use crate::compensation::{self, AxisCompensation};
use crate::error::{Failure, Outcome};
use crate::interrupt::Interrupt;
use crate::model_file::{self, Known};
use crate::network::master::AxisCycle;
use crate::presentation::page::{self, Page};
use crate::presentation::plots::{self, Curve, Trace};
use crate::progress;
use crate::session::{Place, Session};
use crate::trajectory::Circle;
use crate::tuning::{self, Tuned};

/// The circle of commissioning: R 100 mm, F 2000 mm/min.
const CIRCLE: Circle = Circle {
    radius_m: 0.1,
    feed_m_per_s: 2.0 / 60.0,
    turns: 3,
    counter_clockwise: true,
};

#[derive(Serialize)]
struct Summary<'a> {
    machine: &'a str,
    axes: Vec<AxisSummary<'a>>,
    circle_before: &'a CircleReport,
    circle_after: &'a CircleReport,
    burst_reduction_percent: f64,
    tuning_circles: u32,
    bus_load_percent: f64,
}

#[derive(Serialize)]
struct AxisSummary<'a> {
    name: &'a str,
    #[serde(flatten)]
    report: &'a identification::Report,
}

/// Runs the main job.
///
/// # Errors
/// Where an argument, a file or the machine is wrong, or the operator interrupts. What was recorded
/// until then is in the folder.
pub fn command(arguments: &cli::Commission, interrupt: &Interrupt) -> Outcome<()> {
    let (machine, place) = circle::machine(&arguments.machine)?;
    let reference = fitting_circle(&machine);
    crate::session::check_circle(&machine, &reference)?;
    let out = &arguments.out;
    std::fs::create_dir_all(out).map_err(|error| Failure::file(out, &error))?;
    let load = machine.bus_load_per_mille();
    println!(
        "machine {}: {} axes, computed bus load {}.{} %",
        machine.name,
        machine.axes.len(),
        load / 10,
        load % 10
    );
    let bench = Bench {
        machine: &machine,
        place: &place,
        circle: &reference,
        out,
        interrupt,
    };
    bench.record()?;
    let kept =
        |failure: Failure| Failure::new(format!("{failure}; the records are in {}", out.display()));
    bench.compensate().map_err(kept)?;
    println!("report: {}", out.join("report.html").display());
    Ok(())
}

/// What the steps of the job share.
struct Bench<'a> {
    machine: &'a Machine,
    place: &'a Place,
    circle: &'a Circle,
    out: &'a Path,
    interrupt: &'a Interrupt,
}

impl Bench<'_> {
    /// Everything after the records: identify, circle, tune, circle again, report.
    fn compensate(&self) -> Outcome<()> {
        let names: Vec<String> = self
            .machine
            .axes
            .iter()
            .map(|axis| axis.name.clone())
            .collect();
        write(&self.out.join("quadrant.dbc"), &dbc(self.machine)?)?;
        let results = self.identify()?;
        write(
            &self.out.join("model.toml"),
            &model(self.machine, &names, &results),
        )?;
        let none = vec![AxisCompensation::default(); names.len()];
        progress::step("circle without compensation");
        let before = self.run_circle(&none, "circle-before.candump.log")?;
        println!(
            "circle before: largest burst {:.2} µm",
            before.report.figures.peak_max_um
        );
        progress::step("tuning the pulse on circles");
        let tuned = tuning::pulse(self.machine, self.place, self.circle, 0.0, self.interrupt)?;
        write(
            &self.out.join("compensation.toml"),
            &compensation::text(&names, &tuned.compensation)?,
        )?;
        circle::print_tuned(&names, &tuned);
        progress::step("downloading the compensation; circle with it");
        let after = self.run_circle(&tuned.compensation, "circle-after.candump.log")?;
        let reduction =
            100.0 * (1.0 - after.report.figures.peak_max_um / before.report.figures.peak_max_um);
        println!(
            "circle after: largest burst {:.2} µm, {reduction:.1} % less",
            after.report.figures.peak_max_um
        );
        Job {
            bench: self,
            results: &results,
            before: &before,
            after: &after,
            tuned: &tuned,
            reduction,
        }
        .write()
    }

    fn run_circle(&self, compensation: &[AxisCompensation], log: &str) -> Outcome<CircleRun> {
        let log = self.out.join(log);
        circle::run(
            self.machine,
            self.place,
            self.circle,
            compensation,
            Some(&log),
            self.interrupt,
        )
    }

    /// Training and validation record of all axes, each on disk as soon as it ends or breaks off.
    fn record(&self) -> Outcome<()> {
        let none = vec![AxisCompensation::default(); self.machine.axes.len()];
        let session = Session::connect(self.machine, self.place, 1, self.interrupt)?;
        session.perform(
            &none,
            Some(&self.out.join("records.candump.log")),
            |session| {
                Part::BOTH
                    .iter()
                    .try_for_each(|part| self.record_part(session, *part))
            },
        )
    }

    fn record_part(&self, session: &mut Session<'_>, part: Part) -> Outcome<()> {
        progress::step(match part {
            Part::Train => "recording: slow and fast runs, reversals",
            Part::Validate => "recording the validation record",
        });
        let mut records = Vec::new();
        let outcome = axis_records::record(session, self.machine, part, &mut records);
        for (axis, record) in self.machine.axes.iter().zip(&records) {
            let broke_off = outcome.as_ref().err();
            axis_records::write_part(
                &self.records(&axis.name),
                self.machine,
                axis,
                (part, record),
                broke_off,
            )?;
        }
        outcome.map_err(|failure| {
            let rows = records.first().map_or(0, |record| record.rows.len());
            let (file, out) = (part.file(), self.out.display());
            Failure::new(format!(
                "{failure}; {file} broke off after {rows} rows, what was recorded is in {out}"
            ))
        })
    }

    fn records(&self, axis: &str) -> PathBuf {
        self.out.join(format!("records-{axis}"))
    }

    /// Identifies every axis in a thread of its own: their records have nothing in common.
    fn identify(&self) -> Outcome<Vec<Identification>> {
        let begin = |axis: &MachineAxis| {
            Ok(begin(
                &axis.name,
                Dataset::read(&self.records(&axis.name), None, None)?,
            ))
        };
        let works = self
            .machine
            .axes
            .iter()
            .map(begin)
            .collect::<Outcome<Vec<_>>>()?;
        let results = works
            .into_iter()
            .map(|work| end(work, self.interrupt))
            .collect::<Outcome<Vec<_>>>()?;
        for (axis, result) in self.machine.axes.iter().zip(&results) {
            println!("axis {}:", axis.name);
            identify::print(result);
        }
        Ok(results)
    }
}

/// Records the axes of a machine and identifies them: the first half of the job. Writes the records
/// below `out`.
///
/// # Errors
/// Where a file or the machine is wrong, or the operator interrupts.
pub fn identify_axes(
    machine: &Machine,
    place: &Place,
    out: &Path,
    interrupt: &Interrupt,
) -> Outcome<Vec<Identification>> {
    let bench = Bench {
        machine,
        place,
        circle: &fitting_circle(machine),
        out,
        interrupt,
    };
    bench.record()?;
    bench.identify()
}

/// An identification that is being computed.
type Work = JoinHandle<Result<Identification, IdentificationError>>;

fn begin(axis: &str, dataset: Dataset) -> Work {
    progress::step(&format!("identifying axis {axis}"));
    let axis = axis.to_owned();
    std::thread::spawn(move || {
        identification::identify(&dataset, &mut |text| {
            progress::step(&format!("axis {axis}: {text}"));
        })
    })
}

/// How often the computation is asked whether it is done, and the operator whether he still wants
/// it.
const ASK_EVERY: Duration = Duration::from_millis(50);

/// Waits for a result. Nothing moves meanwhile, so an interruption need not wait for it.
fn end(work: Work, interrupt: &Interrupt) -> Outcome<Identification> {
    while !work.is_finished() {
        interrupt.check()?;
        std::thread::sleep(ASK_EVERY);
    }
    match work.join() {
        Ok(result) => Ok(result?),
        Err(panic) => std::panic::resume_unwind(panic),
    }
}

/// The identified models as a machine file.
fn model(machine: &Machine, names: &[String], results: &[Identification]) -> String {
    let known = machine
        .axes
        .iter()
        .map(|axis| Known::of_machine(axis, machine.period_s));
    let models: Vec<(String, Known, &Identification)> = names
        .iter()
        .zip(known)
        .zip(results)
        .map(|((name, known), r)| (name.clone(), known, r))
        .collect();
    model_file::text(&format!("{}, identified", machine.name), &models)
}

/// The DBC of a machine's nodes, for the candump logs beside it.
fn dbc(machine: &Machine) -> Outcome<String> {
    let axes = (0..machine.axes.len())
        .map(crate::network::link::axis_ids)
        .collect::<Outcome<Vec<_>>>()?;
    let mut text = String::new();
    protocol::dbc::write(&mut text, &axes).map_err(|error| Failure::new(error.to_string()))?;
    Ok(text)
}

/// The usual circle, or a smaller and slower one where the axes are short or slow.
fn fitting_circle(machine: &Machine) -> Circle {
    let travel = machine
        .axes
        .iter()
        .map(|axis| axis.limits.travel_m)
        .fold(f64::INFINITY, f64::min);
    let velocity = machine
        .axes
        .iter()
        .map(|axis| axis.limits.velocity_m_per_s)
        .fold(f64::INFINITY, f64::min);
    let acceleration = machine
        .axes
        .iter()
        .map(|axis| axis.limits.acceleration_m_per_s2)
        .fold(f64::INFINITY, f64::min);
    let radius_m = CIRCLE.radius_m.min(0.8 * travel);
    let feed_m_per_s = CIRCLE
        .feed_m_per_s
        .min(0.5 * velocity)
        .min((0.5 * acceleration * radius_m).sqrt());
    Circle {
        radius_m,
        feed_m_per_s,
        ..CIRCLE
    }
}

struct Job<'a> {
    bench: &'a Bench<'a>,
    results: &'a [Identification],
    before: &'a CircleRun,
    after: &'a CircleRun,
    tuned: &'a Tuned,
    reduction: f64,
}

impl Job<'_> {
    fn write(&self) -> Outcome<()> {
        let out = self.bench.out;
        write(&out.join("summary.json"), &self.summary()?)?;
        write(&out.join("circle.svg"), &plots::standalone(&self.polar()?))?;
        write(&out.join("report.html"), &self.page()?)
    }

    fn polar(&self) -> Outcome<String> {
        let title = format!(
            "Circle R {} mm, F {:.0} mm/min",
            self.before.report.radius_mm, self.before.report.feed_mm_min
        );
        let radius_m = 1.0e-3 * self.before.report.radius_mm;
        let traces = [("before", self.before), ("after", self.after)].map(|(name, run)| Trace {
            name: name.into(),
            points: one_turn(run),
            radius_m,
        });
        plots::polar(&title, &traces)
    }

    fn summary(&self) -> Outcome<String> {
        let axes = self.bench.machine.axes.iter().zip(self.results);
        let summary = Summary {
            machine: &self.bench.machine.name,
            axes: axes
                .map(|(axis, result)| AxisSummary {
                    name: &axis.name,
                    report: &result.report,
                })
                .collect(),
            circle_before: &self.before.report,
            circle_after: &self.after.report,
            burst_reduction_percent: self.reduction,
            tuning_circles: self.tuned.circles,
            bus_load_percent: f64::from(self.bench.machine.bus_load_per_mille()) / 10.0,
        };
        let text = serde_json::to_string_pretty(&summary)
            .map_err(|error| Failure::new(error.to_string()))?;
        Ok(text + "\n")
    }

    fn page(&self) -> Outcome<String> {
        let mut page = Page::new(&format!(
            "Commissioning of machine {}",
            self.bench.machine.name
        ));
        self.overview(&mut page)?;
        for (axis, result) in self.bench.machine.axes.iter().zip(self.results) {
            page::identification(
                &mut page,
                &format!("Axis {}: what the model lacks", axis.name),
                result,
            )?;
        }
        self.reversal(&mut page)?;
        Ok(page.finish())
    }

    fn overview(&self, page: &mut Page) -> Outcome<()> {
        let (before, after) = (&self.before.report.figures, &self.after.report.figures);
        let first = self
            .results
            .first()
            .map_or_else(String::new, |result| page::sentence(&result.report));
        page.key(&format!(
            "{first}. Largest burst on the circle: {:.2} µm before, {:.2} µm with the tuned pulse, {:.1} % less.",
            before.peak_max_um, after.peak_max_um, self.reduction
        ));
        page.table(&self.overview_table());
        page.pictures(&[self.polar()?]);
        Ok(())
    }

    fn overview_table(&self) -> Vec<Vec<String>> {
        let mut rows = vec![["", "before", "after", "unit"].map(String::from).to_vec()];
        for (axis, result) in self.bench.machine.axes.iter().zip(self.results) {
            let errors = &result.report.validate;
            rows.push(row(
                &format!(
                    "force error of the model, axis {}, validation record",
                    axis.name
                ),
                errors.force_error_before_percent,
                errors.force_error_after_percent,
                "%",
            ));
            rows.push(row(
                &format!(
                    "force not explained about reversals, axis {}, validation record",
                    axis.name
                ),
                errors.reversal_error_before,
                errors.reversal_error_after,
                result.effort_unit,
            ));
        }
        let (before, after) = (&self.before.report.figures, &self.after.report.figures);
        rows.push(row(
            "largest burst",
            before.peak_max_um,
            after.peak_max_um,
            "µm",
        ));
        rows.push(row(
            "circular deviation G",
            before.circular_deviation_g_um,
            after.circular_deviation_g_um,
            "µm",
        ));
        if let Some((b, a)) = before
            .circular_hysteresis_h_um
            .zip(after.circular_hysteresis_h_um)
        {
            rows.push(row("circular hysteresis H", b, a, "µm"));
        }
        rows.push(row(
            "radial deviation Fmax",
            before.radial_deviation_fmax_um,
            after.radial_deviation_fmax_um,
            "µm",
        ));
        rows.push(row(
            "radial deviation Fmin",
            before.radial_deviation_fmin_um,
            after.radial_deviation_fmin_um,
            "µm",
        ));
        rows
    }

    /// The six curves of the paper's Fig. 8(a), about one reversal of the first axis on a sine.
    fn reversal(&self, page: &mut Page) -> Outcome<()> {
        page.heading("One reversal in time");
        page.paragraph(
            "The six curves of the paper's Fig. 8(a) about a reversal of the first axis, before and after: setpoint, table, disturbance \
             (friction and other forces that the motor has to overcome), drive force, speed of the motor, error.",
        );
        let bench = self.bench;
        let none = vec![AxisCompensation::default(); bench.machine.axes.len()];
        for (name, compensation) in [("before", &none), ("after", &self.tuned.compensation)] {
            let rows = reversal_rows(
                bench.machine,
                bench.place,
                compensation,
                bench.circle,
                bench.interrupt,
            )?;
            page.pictures(&six_curves(bench.machine, name, &rows)?);
        }
        Ok(())
    }
}

fn row(name: &str, before: f64, after: f64, unit: &str) -> Vec<String> {
    vec![
        name.to_owned(),
        format!("{before:.2}"),
        format!("{after:.2}"),
        unit.to_owned(),
    ]
}

fn one_turn(run: &CircleRun) -> &[crate::ballbar::Point] {
    &run.points[..run.points.len() / 3]
}

/// Cycles about one reversal of the first axis on a sine with the path of a circle.
///
/// # Errors
/// Where the machine cannot run it.
pub fn reversal_rows(
    machine: &Machine,
    place: &Place,
    compensation: &[AxisCompensation],
    circle: &Circle,
    interrupt: &Interrupt,
) -> Outcome<Vec<(f64, AxisCycle)>> {
    let session = Session::connect(machine, place, 2, interrupt)?;
    session.perform(compensation, None, |session| {
        about_reversal(session, machine, circle)
    })
}

fn about_reversal(
    session: &mut Session<'_>,
    machine: &Machine,
    circle: &Circle,
) -> Outcome<Vec<(f64, AxisCycle)>> {
    // One turn is enough, and it ends at rest.
    let circle = Circle {
        turns: 1,
        ..*circle
    };
    let rest = vec![0.0; machine.axes.len() - 1];
    let setpoints = |x: f64| [vec![x], rest.clone()].concat();
    let omega = circle.feed_m_per_s / circle.radius_m;
    session.go_to(&setpoints(circle.at(0.0)[0]))?;
    // The second reversal of X is at three quarters of a turn.
    let mut milliseconds = (0_u32..1_000_000).map(|i| 1.0e-3 * f64::from(i));
    let reversal_s = milliseconds
        .find(|t| circle.angle_rad(*t) > 0.75 * std::f64::consts::TAU)
        .unwrap_or(0.0);
    let window_s = (0.25 / omega).min(0.6);
    let mut rows = Vec::new();
    session.follow(
        circle.duration_s(),
        |time_s| setpoints(circle.at(time_s)[0]),
        |time_s, axes| {
            if (time_s - reversal_s).abs() <= window_s {
                rows.push((time_s - reversal_s, axes[0]));
            }
        },
    )?;
    Ok(rows)
}

/// Setpoint and table; disturbance and drive force; speed; error.
///
/// # Errors
/// Where a plot cannot be drawn.
pub fn six_curves(
    machine: &Machine,
    name: &str,
    rows: &[(f64, AxisCycle)],
) -> Outcome<Vec<String>> {
    let period_s = machine.period_s;
    let inertia = machine.axes.first().map_or(0.0, |axis| {
        let mechanics = &axis.actual.mechanics;
        mechanics.motor_inertia_kg + mechanics.table_mass_kg
    });
    let turning_m = rows
        .iter()
        .map(|(_, axis)| axis.reference_m)
        .fold(f64::INFINITY, f64::min);
    let table = |axis: &AxisCycle| axis.truth.map_or(axis.load_m, |truth| truth.table_m);
    let curve = |name: &str, value: &dyn Fn(usize) -> f64| Curve {
        name: name.into(),
        points: (10..rows.len().saturating_sub(10))
            .map(|i| (1.0e3 * rows[i].0, value(i)))
            .collect(),
        dots: false,
    };
    // Over 10 cycles to either side: single encoder counts would be noise.
    let speed = |i: usize| (rows[i + 10].1.motor_m - rows[i - 10].1.motor_m) / (20.0 * period_s);
    let acceleration = |i: usize| {
        (rows[i + 10].1.motor_m - 2.0 * rows[i].1.motor_m + rows[i - 10].1.motor_m)
            / (100.0 * period_s * period_s)
    };
    let force = |i: usize| {
        rows[i]
            .1
            .truth
            .map_or(rows[i].1.force_n, |truth| truth.force_n)
    };
    let size = (540, 300);
    Ok(vec![
        plots::curves(
            &format!("Position, {name}"),
            "time from the reversal, ms",
            "µm from the turning point",
            size,
            &[
                curve("(1) setpoint", &|i| {
                    1.0e6 * (rows[i].1.reference_m - turning_m)
                }),
                curve("(2) table", &|i| 1.0e6 * (table(&rows[i].1) - turning_m)),
            ],
        )?,
        plots::curves(
            &format!("Force, {name}"),
            "time from the reversal, ms",
            "N",
            size,
            &[
                curve("(3) disturbance", &|i| force(i) - inertia * acceleration(i)),
                curve("(4) drive", &force),
            ],
        )?,
        plots::curves(
            &format!("(5) Speed of the motor, {name}"),
            "time from the reversal, ms",
            "mm/s",
            size,
            &[curve("speed", &|i| 1.0e3 * speed(i))],
        )?,
        plots::curves(
            &format!("(6) Error, {name}"),
            "time from the reversal, ms",
            "µm",
            size,
            &[curve("error", &|i| {
                1.0e6 * (rows[i].1.reference_m - table(&rows[i].1))
            })],
        )?,
    ])
}
