//! `quadrant commission`: the main job, from recording to the circle with compensation.
//!
//! ```text
//! loops stable? ─▶ record ─▶ identify ─▶ circle ─▶ pulse, model ─▶ circles at feeds ─▶ report
//! ```

use std::path::Path;

use identification::Identification;
use plant_sim::Machine;

use crate::circle_test::{self, CircleRun};
use crate::cli;
use crate::commissioning::feeds;
use crate::commissioning::fitness::{self, Oscillation};
use crate::commissioning::identified_axes;
use crate::commissioning::program::now;
use crate::commissioning::result::{Commissioned, burst_reduction_percent};
use crate::commissioning::run_folder::circle_csv;
use crate::commissioning::steep_fall;
use crate::commissioning::trials::{self, Trials};
use crate::commissioning::unfit;
use crate::compensation::{self, AxisCompensation};
use crate::console;
use crate::error::{Failure, Outcome};
use crate::interrupt::Interrupt;
use crate::network::candump::dbc;
use crate::network::place::Place;
use crate::output_files::{claim_folder, remove_stale, write};
use crate::progress;
use crate::say;
use crate::session::Stand;
use crate::trajectory::Circle;
use crate::trajectory::circle_limits::{check_circle, fitting_circle};

/// Runs the main job.
///
/// # Errors
/// Where an argument, a file or the machine is wrong, or the operator interrupts. What was recorded
/// until then is in the folder.
pub fn run(arguments: &cli::Commission, interrupt: &Interrupt) -> Outcome<()> {
    let (machine, place) = arguments.machine.machine_and_place()?;
    let wanted = Wanted {
        out: &arguments.out,
        tolerance_um: arguments.tolerance_um,
        log: arguments.log,
        are_real_axes: arguments.real_axes,
    };
    if arguments.real_axes && arguments.machine.can.is_none() {
        return Err(Failure::new(
            "--real-axes: needs --can; in process there are simulated axes alone",
        ));
    }
    refuse_own_results(arguments, &machine)?;
    commission(&machine, place, &wanted, interrupt)
}

/// A machine file among the results would be gone before it is used again.
fn refuse_own_results(arguments: &cli::Commission, machine: &Machine) -> Outcome<()> {
    let whole = |path: &Path| path.canonicalize().ok();
    let Some(file) = arguments.machine.machine.as_deref().and_then(whole) else {
        return Ok(());
    };
    let results = stale(machine)
        .into_iter()
        .map(|name| arguments.out.join(name));
    if results
        .filter_map(|path| whole(&path))
        .any(|path| path == file)
    {
        return Err(Failure::new(format!(
            "--machine: is a result in {}, which is replaced; copy it or name another --out",
            arguments.out.display()
        )));
    }
    Ok(())
}

/// What is wanted of the job.
#[derive(Clone, Copy, Debug)]
pub struct Wanted<'a> {
    /// Folder for everything that it leaves.
    pub out: &'a Path,
    /// What circular deviation G may be, µm.
    pub tolerance_um: Option<f64>,
    /// Whether the frames of the circles are kept.
    pub log: bool,
    /// Whether real axes answer as plants on the bus.
    pub are_real_axes: bool,
}

impl<'a> Wanted<'a> {
    /// Everything in a folder, without tolerance and without the frames of circles.
    #[must_use]
    pub const fn into(out: &'a Path) -> Self {
        Self {
            out,
            tolerance_um: None,
            log: false,
            are_real_axes: false,
        }
    }
}

/// The same with a machine at its place.
///
/// # Errors
/// As [`run`].
pub fn commission(
    machine: &Machine,
    place: Place,
    wanted: &Wanted<'_>,
    interrupt: &Interrupt,
) -> Outcome<()> {
    let out = wanted.out;
    let circle = fitting_circle(machine);
    check_circle(machine, &circle)?;
    claim_folder(out, "commission", &stale(machine))?;
    print_machine(machine);
    let stand = Stand {
        machine,
        place,
        interrupt: interrupt.clone(),
    };
    let oscillations = fitness::oscillations(&stand)?;
    for oscillation in &oscillations {
        say!("{}", oscillation.sentence());
    }
    // The machine answers: what comes now takes the place of what an earlier run has left.
    remove_stale(out, &stale(machine))?;
    if oscillations.iter().any(Oscillation::is_unfit) {
        return end_unfit(&stand, &oscillations, wanted);
    }
    identified_axes::record(&stand, out)?;
    let kept =
        |failure: Failure| Failure::new(format!("{failure}; the records are in {}", out.display()));
    after_recording(&stand, &circle, &oscillations, wanted).map_err(kept)
}

/// What an earlier run may have left that would lie beside new records.
fn stale(machine: &Machine) -> Vec<String> {
    let files = [
        "report.html",
        "summary.json",
        "circle.svg",
        "circle-before.csv",
        "circle-after.csv",
        "circle-before.candump.log",
        "circle-after.candump.log",
        "records.candump.log",
        "compensation.toml",
        "model.toml",
    ];
    let records = machine.axes.iter().flat_map(|axis| {
        ["train.csv", "validate.csv"].map(|file| format!("records-{}/{file}", axis.name))
    });
    files.map(String::from).into_iter().chain(records).collect()
}

/// A machine that oscillates is not commissioned: the report says what to change first.
fn end_unfit(stand: &Stand<'_>, oscillations: &[Oscillation], wanted: &Wanted<'_>) -> Outcome<()> {
    let is_simulation = !wanted.are_real_axes;
    unfit::report(stand.machine, oscillations, is_simulation, wanted.out)?;
    say!(
        "not commissioned; report: {}",
        wanted.out.join("report.html").display()
    );
    Ok(())
}

/// The steps after the records.
fn after_recording(
    stand: &Stand<'_>,
    circle: &Circle,
    oscillations: &[Oscillation],
    wanted: &Wanted<'_>,
) -> Outcome<()> {
    let out = wanted.out;
    write(&out.join("quadrant.dbc"), &dbc(stand.machine)?)?;
    let results = identify(stand, out)?;
    let ringing = fitness::on_records(stand.machine, &results);
    if !ringing.is_empty() {
        for own in &ringing {
            say!("{}", own.sentence());
        }
        return end_unfit(stand, &[oscillations, &ringing].concat(), wanted);
    }
    let model = identified_axes::model(stand.machine, &results);
    write(&out.join("model.toml"), &model)?;
    let before = circle_before(stand, circle, wanted)?;
    let trials = try_out(stand, circle, &results, out)?;
    let after = circle_after(stand, circle, &trials.taken, wanted)?;
    let reduction_percent = burst_reduction_percent(&before.report, &after.report);
    say!(
        "circle after, {}: largest burst {:.2} µm, {reduction_percent:.1} % less",
        trials.method,
        after.report.figures.peak_max_um
    );
    let feeds = trials.feeds.clone().and([&before, &after]);
    let commissioned = Commissioned {
        stand,
        circle,
        oscillations,
        steep_falls: steep_fall::of(stand.machine, &trials.taken, &feeds),
        results: &results,
        feeds,
        before: &before,
        trials: &trials,
        after: &after,
        tolerance_um: wanted.tolerance_um,
        date: now(),
        is_simulation: !wanted.are_real_axes,
    };
    feeds::print(&commissioned.feeds);
    for own in &commissioned.steep_falls {
        say!("{}", own.sentence());
    }
    if let Some(verdict) = commissioned.verdict() {
        say!("{verdict}");
    }
    commissioned.write(out)?;
    say!("report: {}", out.join("report.html").display());
    Ok(())
}

fn print_machine(machine: &Machine) {
    let load = machine.bus_load_per_mille();
    say!(
        "machine {}: {} axes, computed bus load {}.{} %",
        machine.name,
        machine.axes.len(),
        load / 10,
        load % 10
    );
}

fn identify(stand: &Stand<'_>, out: &Path) -> Outcome<Vec<Identification>> {
    let results = identified_axes::identify(stand, out)?;
    for (axis, result) in stand.machine.axes.iter().zip(&results) {
        say!("axis {}:", axis.name);
        console::print_identification(result);
    }
    Ok(results)
}

fn circle_before(stand: &Stand<'_>, circle: &Circle, wanted: &Wanted<'_>) -> Outcome<CircleRun> {
    progress::step("circle without compensation");
    let run = kept_circle(
        stand,
        circle,
        &stand.uncompensated(),
        ("circle-before", wanted),
    )?;
    let burst_um = run.report.figures.peak_max_um;
    say!("circle before: largest burst {burst_um:.2} µm");
    Ok(run)
}

fn try_out(
    stand: &Stand<'_>,
    circle: &Circle,
    results: &[Identification],
    out: &Path,
) -> Outcome<Trials> {
    let lacks = results.iter().any(|result| !result.report.found.is_empty());
    let declared = if lacks {
        identified_axes::declared(stand, out)?
    } else {
        Vec::new()
    };
    let trials = trials::run(stand, circle, &declared, results)?;
    let text = compensation::text(&stand.axis_names(), &trials.taken)?;
    write(&out.join("compensation.toml"), &text)?;
    Ok(trials)
}

fn circle_after(
    stand: &Stand<'_>,
    circle: &Circle,
    compensation: &[AxisCompensation],
    wanted: &Wanted<'_>,
) -> Outcome<CircleRun> {
    progress::step("downloading the compensation; circle with it");
    kept_circle(stand, circle, compensation, ("circle-after", wanted))
}

/// A circle whose points are kept as CSV, and its frames where they are wanted.
fn kept_circle(
    stand: &Stand<'_>,
    circle: &Circle,
    compensation: &[AxisCompensation],
    (name, wanted): (&str, &Wanted<'_>),
) -> Outcome<CircleRun> {
    let log = wanted.out.join(format!("{name}.candump.log"));
    let log = wanted.log.then_some(log);
    let run = circle_test::run(stand, circle, compensation, log.as_deref())?;
    write(&wanted.out.join(format!("{name}.csv")), &circle_csv(&run))?;
    Ok(run)
}
