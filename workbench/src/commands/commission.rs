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
use crate::commissioning::result::{Commissioned, burst_reduction_percent};
use crate::commissioning::trials::{self, Trials};
use crate::commissioning::unfit;
use crate::compensation::{self, AxisCompensation};
use crate::console;
use crate::error::{Failure, Outcome};
use crate::interrupt::Interrupt;
use crate::network::candump::dbc;
use crate::network::place::Place;
use crate::output_files::{make_folder, write};
use crate::progress;
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
    commission(&machine, place, &arguments.out, interrupt)
}

/// The same with a machine at its place.
///
/// # Errors
/// As [`run`].
pub fn commission(
    machine: &Machine,
    place: Place,
    out: &Path,
    interrupt: &Interrupt,
) -> Outcome<()> {
    let circle = fitting_circle(machine);
    check_circle(machine, &circle)?;
    make_folder(out)?;
    print_machine(machine);
    let stand = Stand {
        machine,
        place,
        interrupt: interrupt.clone(),
    };
    let oscillations = fitness::oscillations(&stand)?;
    for oscillation in &oscillations {
        println!("{}", oscillation.sentence());
    }
    if oscillations.iter().any(Oscillation::is_unfit) {
        return end_unfit(machine, &oscillations, out);
    }
    identified_axes::record(&stand, out)?;
    let kept =
        |failure: Failure| Failure::new(format!("{failure}; the records are in {}", out.display()));
    after_recording(&stand, &circle, &oscillations, out).map_err(kept)?;
    println!("report: {}", out.join("report.html").display());
    Ok(())
}

/// A machine that oscillates is not commissioned: the report says what to change first.
fn end_unfit(machine: &Machine, oscillations: &[Oscillation], out: &Path) -> Outcome<()> {
    unfit::report(machine, oscillations, out)?;
    println!(
        "not commissioned; report: {}",
        out.join("report.html").display()
    );
    Ok(())
}

/// The steps after the records.
fn after_recording(
    stand: &Stand<'_>,
    circle: &Circle,
    oscillations: &[Oscillation],
    out: &Path,
) -> Outcome<()> {
    write(&out.join("quadrant.dbc"), &dbc(stand.machine)?)?;
    let results = identify(stand, out)?;
    let before = circle_before(stand, circle, out)?;
    let trials = try_out(stand, circle, &results, out)?;
    let after = circle_after(stand, circle, &trials.taken, out)?;
    let reduction_percent = burst_reduction_percent(&before.report, &after.report);
    println!(
        "circle after, {}: largest burst {:.2} µm, {reduction_percent:.1} % less",
        trials.method, after.report.figures.peak_max_um
    );
    let commissioned = Commissioned {
        stand,
        circle,
        oscillations,
        results: &results,
        feeds: feeds::run(stand, [&before, &after], circle, &trials.taken)?,
        before: &before,
        trials: &trials,
        after: &after,
    };
    feeds::print(&commissioned.feeds);
    commissioned.write(out)
}

fn print_machine(machine: &Machine) {
    let load = machine.bus_load_per_mille();
    println!(
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
        println!("axis {}:", axis.name);
        console::print_identification(result);
    }
    let model = identified_axes::model(stand.machine, &results);
    write(&out.join("model.toml"), &model)?;
    Ok(results)
}

fn circle_before(stand: &Stand<'_>, circle: &Circle, out: &Path) -> Outcome<CircleRun> {
    progress::step("circle without compensation");
    let log = out.join("circle-before.candump.log");
    let run = circle_test::run(stand, circle, &stand.uncompensated(), Some(&log))?;
    let burst_um = run.report.figures.peak_max_um;
    println!("circle before: largest burst {burst_um:.2} µm");
    Ok(run)
}

fn try_out(
    stand: &Stand<'_>,
    circle: &Circle,
    results: &[Identification],
    out: &Path,
) -> Outcome<Trials> {
    let trials = trials::run(stand, circle, results)?;
    let text = compensation::text(&stand.axis_names(), &trials.taken)?;
    write(&out.join("compensation.toml"), &text)?;
    Ok(trials)
}

fn circle_after(
    stand: &Stand<'_>,
    circle: &Circle,
    compensation: &[AxisCompensation],
    out: &Path,
) -> Outcome<CircleRun> {
    progress::step("downloading the compensation; circle with it");
    let log = out.join("circle-after.candump.log");
    circle_test::run(stand, circle, compensation, Some(&log))
}
