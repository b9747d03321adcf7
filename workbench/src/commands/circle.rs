//! `quadrant circle` and `quadrant tune`.

use std::path::Path;

use plant_sim::Machine;
use serde::Serialize;

use crate::axis_records::{self, Part};
use crate::ballbar::{self, CircleFigures, Point, REVERSALS};
use crate::cli::{self, MachineArguments, Method};
use crate::commands::identify::write;
use crate::compensation::{self, AxisCompensation, Compensation};
use crate::error::{Failure, Outcome};
use crate::interrupt::Interrupt;
use crate::network::nodes::refuse_overload;
use crate::presentation::plots::{self, Trace};
use crate::progress;
use crate::session::{Place, Session};
use crate::trajectory::{Circle, MEASURE_FROM_RAD};
use crate::tuning;

/// The machine of a command line.
///
/// # Errors
/// Where its file is wrong.
pub fn machine(arguments: &MachineArguments) -> Outcome<(Machine, Place)> {
    let machine = match &arguments.machine {
        Some(path) => Machine::read(path)?,
        None => Machine::reference(),
    };
    let pace = arguments.pace.chosen();
    let place = arguments
        .can
        .clone()
        .map_or(Place::InProcess, |names| Place::Can { names, pace });
    if arguments.can.is_some() {
        refuse_overload(&machine, pace)?;
    }
    Ok((machine, place))
}

/// A circle from the units of the command line.
///
/// # Errors
/// Where a value is not positive.
pub fn circle(radius_mm: f64, feed_mm_min: f64) -> Outcome<Circle> {
    for (option, value, unit) in [
        ("--radius-mm", radius_mm, "mm"),
        ("--feed-mm-min", feed_mm_min, "mm/min"),
    ] {
        if !(value.is_finite() && value > 0.0) {
            return Err(Failure::new(format!(
                "{option}: must be above zero {unit}, got {value}"
            )));
        }
    }
    Ok(Circle {
        radius_m: 1.0e-3 * radius_mm,
        feed_m_per_s: feed_mm_min / 6.0e4,
        turns: 3,
        counter_clockwise: true,
    })
}

/// What `circle --json` says.
#[derive(Clone, Debug, Serialize)]
pub struct CircleReport {
    /// Machine.
    pub machine: String,
    /// Radius.
    pub radius_mm: f64,
    /// Feed.
    pub feed_mm_min: f64,
    /// Compensation method.
    pub compensation: String,
    /// What saw the deviation: an instrument at the table, or the load scale.
    pub deviation_of: &'static str,
    /// Computed cyclic bus load.
    pub bus_load_percent: f64,
    /// Cycles whose torque did not come in time.
    pub missed_cycles: u32,
    /// Figures.
    #[serde(flatten)]
    pub figures: CircleFigures,
}

/// A circle that was run.
pub struct CircleRun {
    /// Its report.
    pub report: CircleReport,
    /// Turns that count, counter-clockwise.
    pub points: Vec<Point>,
}

/// Largest backlash of the machine's axes that its files tell of; it widens the window about the
/// reversals.
fn backlash_m(machine: &Machine) -> f64 {
    machine
        .axes
        .iter()
        .map(|axis| axis.actual.mechanics.backlash_m)
        .fold(0.0, f64::max)
}

/// Runs a circle counter-clockwise, and clockwise for the hysteresis; the frames go to `log`, also
/// where the circle breaks off.
///
/// # Errors
/// Where it cannot be run.
pub fn run(
    machine: &Machine,
    place: &Place,
    circle: &Circle,
    compensation: &[AxisCompensation],
    log: Option<&Path>,
    interrupt: &Interrupt,
) -> Outcome<CircleRun> {
    let session = Session::connect(machine, place, 0, interrupt)?;
    session.perform(compensation, log, |session| {
        let mut run = measured(session, machine, circle)?;
        run.report.compensation = name(compensation);
        Ok(run)
    })
}

fn measured(session: &mut Session<'_>, machine: &Machine, circle: &Circle) -> Outcome<CircleRun> {
    progress::step(&format!(
        "circle R {} mm, F {} mm/min",
        1.0e3 * circle.radius_m,
        6.0e4 * circle.feed_m_per_s
    ));
    let points = session.circle(circle)?;
    let clockwise = session.circle(&Circle {
        turns: 1,
        counter_clockwise: false,
        ..*circle
    })?;
    let mut figures = ballbar::figures(
        &points,
        circle.radius_m,
        backlash_m(machine),
        MEASURE_FROM_RAD,
    );
    figures.circular_hysteresis_h_um =
        Some(ballbar::hysteresis_um(&points, &clockwise, circle.radius_m));
    let report = CircleReport {
        machine: machine.name.clone(),
        radius_mm: 1.0e3 * circle.radius_m,
        feed_mm_min: 6.0e4 * circle.feed_m_per_s,
        compensation: String::new(),
        deviation_of: if session.sees_truth() {
            "table"
        } else {
            "load scale"
        },
        bus_load_percent: f64::from(machine.bus_load_per_mille()) / 10.0,
        missed_cycles: session.missed(),
        figures,
    };
    Ok(CircleRun { report, points })
}

fn name(compensation: &[AxisCompensation]) -> String {
    match compensation.first().map(|axis| axis.reversal) {
        None | Some(Compensation::None) => "none",
        Some(Compensation::Coulomb { .. }) => "coulomb",
        Some(Compensation::Pulse(_)) => "pulse",
    }
    .into()
}

/// `quadrant circle`.
///
/// # Errors
/// Where an argument, a file or the machine is wrong.
pub fn command(arguments: &cli::CircleArguments, interrupt: &Interrupt) -> Outcome<()> {
    let (machine, place) = machine(&arguments.machine)?;
    let circle = circle(arguments.radius_mm, arguments.feed_mm_min)?;
    crate::session::check_circle(&machine, &circle)?;
    let compensation = compensation_of(arguments, &machine, &place, interrupt)?;
    let run = run(
        &machine,
        &place,
        &circle,
        &compensation,
        arguments.candump.as_deref(),
        interrupt,
    )?;
    print(&run.report);
    if let Some(path) = &arguments.json {
        let text = serde_json::to_string_pretty(&run.report)
            .map_err(|error| Failure::new(error.to_string()))?;
        write(path, &(text + "\n"))?;
    }
    if let Some(path) = &arguments.plot {
        let title = format!(
            "R {} mm, F {} mm/min",
            arguments.radius_mm, arguments.feed_mm_min
        );
        let trace = Trace {
            name: run.report.compensation.clone(),
            points: &run.points,
            radius_m: circle.radius_m,
        };
        let svg = plots::polar(&title, &[trace])?;
        write(path, &plots::standalone(&svg))?;
    }
    Ok(())
}

fn compensation_of(
    arguments: &cli::CircleArguments,
    machine: &Machine,
    place: &Place,
    interrupt: &Interrupt,
) -> Outcome<Vec<AxisCompensation>> {
    let names: Vec<String> = machine.axes.iter().map(|axis| axis.name.clone()).collect();
    let none = vec![AxisCompensation::default(); names.len()];
    let (method, file) = (
        arguments.compensation,
        arguments.compensation_file.as_deref(),
    );
    match (method, file) {
        (Method::None, None) => Ok(none),
        (Method::None, Some(_)) => Err(Failure::new(
            "--compensation-file: needs --compensation pulse or coulomb; without it the file would not be used",
        )),
        (Method::Coulomb, None) => measured_coulomb(machine, place, interrupt),
        (Method::Pulse, None) => Err(Failure::new(
            "--compensation pulse: needs --compensation-file; make one with `quadrant tune --method pulse --out FILE`",
        )),
        (_, Some(path)) => {
            let read = compensation::read(path, &names)?;
            let fits = |c: &AxisCompensation| {
                matches!(
                    (method, c.reversal),
                    (Method::Pulse, Compensation::Pulse(_))
                        | (Method::Coulomb, Compensation::Coulomb { .. })
                )
            };
            if read.iter().all(fits) {
                Ok(read)
            } else {
                Err(Failure::new(format!(
                    "{}: the file holds another method than --compensation asks for",
                    path.display()
                )))
            }
        }
    }
}

/// Coulomb friction of every axis as its declared model sees it on a record, for the bare
/// feedforward.
fn measured_coulomb(
    machine: &Machine,
    place: &Place,
    interrupt: &Interrupt,
) -> Outcome<Vec<AxisCompensation>> {
    progress::step("recording the axes for their Coulomb friction");
    let none = vec![AxisCompensation::default(); machine.axes.len()];
    let mut records = Vec::new();
    Session::connect(machine, place, 1, interrupt)?.perform(&none, None, |session| {
        axis_records::record(session, machine, Part::Train, &mut records)
    })?;
    let folder = std::env::temp_dir().join(format!("quadrant-{}", std::process::id()));
    let of_axis =
        |(axis, record): (&plant_sim::machine::MachineAxis, &axis_records::AxisRecord)| {
            Part::BOTH.iter().try_for_each(|part| {
                axis_records::write_part(&folder, machine, axis, (*part, record), None)
            })?;
            let dataset = identification::Dataset::read(&folder, None, None)?;
            let force_n = identification::declared_coulomb(&dataset)?;
            Ok(AxisCompensation {
                reversal: Compensation::Coulomb { force_n },
                backlash_m: 0.0,
            })
        };
    let found = machine.axes.iter().zip(&records).map(of_axis).collect();
    // The folder is in the system's temporary directory: leaving it behind is untidy, not wrong.
    let _ = std::fs::remove_dir_all(&folder);
    found
}

/// Prints the figures of a circle.
pub fn print(report: &CircleReport) {
    let CircleReport {
        radius_mm,
        feed_mm_min,
        compensation,
        figures,
        bus_load_percent,
        ..
    } = report;
    println!(
        "circle R {radius_mm} mm, F {feed_mm_min} mm/min, compensation {compensation}; deviation of the {}",
        report.deviation_of
    );
    for ((_, _, name), peak) in REVERSALS.iter().zip(figures.peak_um) {
        println!("  burst, {name:<18}{peak:>10.2} µm");
    }
    println!(
        "  largest burst             {:>10.2} µm",
        figures.peak_max_um
    );
    println!(
        "  circular deviation G      {:>10.2} µm",
        figures.circular_deviation_g_um
    );
    if let Some(h) = figures.circular_hysteresis_h_um {
        println!("  circular hysteresis H     {h:>10.2} µm");
    }
    println!(
        "  radial deviation Fmax/Fmin{:>10.2} / {:.2} µm",
        figures.radial_deviation_fmax_um, figures.radial_deviation_fmin_um
    );
    println!(
        "  step X / Y                {:>10.2} / {:.2} µm",
        figures.step_um[0], figures.step_um[1]
    );
    println!(
        "  ellipse                   {:>10.2} µm",
        figures.ellipse_um
    );
    println!("  bus load, computed        {bus_load_percent:>10.1} %");
    if report.missed_cycles > 0 {
        println!("  missed cycles             {:>10}", report.missed_cycles);
    }
}

/// `quadrant tune`.
///
/// # Errors
/// Where an argument or the machine is wrong.
pub fn tune(arguments: &cli::Tune, interrupt: &Interrupt) -> Outcome<()> {
    let (machine, place) = machine(&arguments.machine)?;
    let circle = circle(arguments.radius_mm, arguments.feed_mm_min)?;
    crate::session::check_circle(&machine, &circle)?;
    if !(0.0..=1000.0).contains(&arguments.start_delay_ms) {
        return Err(Failure::new(format!(
            "--start-delay-ms: must be 0 to 1000 ms, got {}",
            arguments.start_delay_ms
        )));
    }
    let tuned = match arguments.method {
        cli::TuneMethod::Pulse => tuning::pulse(
            &machine,
            &place,
            &circle,
            1.0e-3 * arguments.start_delay_ms,
            interrupt,
        )?,
    };
    let names: Vec<String> = machine.axes.iter().map(|axis| axis.name.clone()).collect();
    let head = format!(
        "# Tuned at R {} mm, F {} mm/min in {} circles: best there, and only there.\n",
        arguments.radius_mm, arguments.feed_mm_min, tuned.circles
    );
    write(
        &arguments.out,
        &(head + &compensation::text(&names, &tuned.compensation)?),
    )?;
    print_tuned(&names, &tuned);
    println!("wrote {}", arguments.out.display());
    Ok(())
}

/// Prints what tuning found.
pub fn print_tuned(names: &[String], tuned: &tuning::Tuned) {
    for ((name, compensation), (before, after)) in names
        .iter()
        .zip(&tuned.compensation)
        .zip(tuned.before_um.iter().zip(tuned.after_um))
    {
        if let Compensation::Pulse(pulse) = compensation.reversal {
            println!(
                "axis {name}: {:.3} mm/s, {:.1} ms, start delay {:.1} ms: burst {before:.2} µm → {after:.2} µm ({:.0} % less)",
                1.0e3 * pulse.height_m_per_s,
                1.0e3 * pulse.time_constant_s,
                1.0e3 * pulse.start_delay_s,
                100.0 * (1.0 - after / before)
            );
        }
    }
    println!("{} circles", tuned.circles);
}
