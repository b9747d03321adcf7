//! One reference circle over the bus, and what it shows.

use std::path::Path;

use plant_sim::Machine;
use serde::Serialize;

use crate::ballbar::{self, CircleFigures, Point};
use crate::compensation::{self, AxisCompensation, Compensation};
use crate::error::Outcome;
use crate::progress;
use crate::session::{Session, Stand};
use crate::trajectory::{Circle, MEASURE_FROM_RAD};

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
    /// What drives that refine themselves have made of the levels of friction: a factor on each.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub refined_levels: Option<Vec<f64>>,
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

/// Noise of the circles that are shown is another than that of records and of tuning.
const CIRCLE_RUN: u64 = 0;

/// Runs a circle counter-clockwise, and clockwise for the hysteresis; the frames go to `log`, also
/// where the circle breaks off.
///
/// # Errors
/// Where it cannot be run.
pub fn run(
    stand: &Stand<'_>,
    circle: &Circle,
    compensation: &[AxisCompensation],
    log: Option<&Path>,
) -> Outcome<CircleRun> {
    run_after(stand, circle, 0, compensation, log)
}

/// The same after so many turns, on which drives refine themselves that are told to.
///
/// # Errors
/// Where it cannot be run.
pub fn run_after(
    stand: &Stand<'_>,
    circle: &Circle,
    turns: u32,
    compensation: &[AxisCompensation],
    log: Option<&Path>,
) -> Outcome<CircleRun> {
    let session = stand.connect(CIRCLE_RUN)?;
    let refines = compensation.iter().any(refines);
    session.perform(compensation, log, |session| {
        if turns > 0 {
            progress::step(&format!(
                "{turns} circles on which the drives refine themselves"
            ));
            session.circle(&Circle { turns, ..*circle })?;
        }
        let (points, figures) = measured(session, stand.machine, circle)?;
        let report = CircleReport {
            machine: stand.machine.name.clone(),
            radius_mm: 1.0e3 * circle.radius_m,
            feed_mm_min: 6.0e4 * circle.feed_m_per_s,
            compensation: compensation::method(compensation).to_owned(),
            deviation_of: session.sees(),
            bus_load_percent: f64::from(stand.machine.bus_load_per_mille()) / 10.0,
            missed_cycles: session.missed(),
            refined_levels: refines.then(|| session.refined_levels()).transpose()?,
            figures,
        };
        Ok(CircleRun { report, points })
    })
}

fn refines(axis: &AxisCompensation) -> bool {
    matches!(&axis.reversal, Compensation::Model(model) if model.self_tuning > 0.0)
}

/// The turns that count, and the figures of both directions.
fn measured(
    session: &mut Session<'_>,
    machine: &Machine,
    circle: &Circle,
) -> Outcome<(Vec<Point>, CircleFigures)> {
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
    let radius_m = circle.radius_m;
    let figures = session.meanwhile(|| {
        let figures = ballbar::figures(&points, radius_m, backlash_m(machine), MEASURE_FROM_RAD);
        let hysteresis_um = ballbar::hysteresis_um(&points, &clockwise, radius_m);
        CircleFigures {
            circular_hysteresis_h_um: Some(hysteresis_um),
            ..figures
        }
    })?;
    Ok((points, figures))
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
