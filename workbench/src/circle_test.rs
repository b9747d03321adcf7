//! One reference circle over the bus, and what it shows.

use std::f64::consts::TAU;
use std::path::Path;

use plant_sim::Machine;
use serde::Serialize;

use crate::ballbar::{self, BothDirections, Cause, Causes, CircleAxis, CircleFigures, Point};
use crate::compensation::{self, AxisCompensation, Compensation};
use crate::error::Outcome;
use crate::progress;
use crate::session::{AT_TABLE, Session, Stand};
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
    /// What of the circle was seen.
    #[serde(flatten)]
    pub whole: Whole,
    /// Whether that is all of it but for single cycles.
    pub is_whole: bool,
    /// What drives that refine themselves have made of the levels of friction: a factor on each.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub refined_levels: Option<Vec<f64>>,
    /// Figures of the counter-clockwise turns.
    #[serde(flatten)]
    pub figures: CircleFigures,
    /// Circular deviation G of each counter-clockwise turn, of the clockwise one, and of both
    /// directions about one centre.
    #[serde(flatten)]
    pub roundness: Roundness,
    /// Bursts without what the axes do wrong elsewhere, the largest of both directions, at 0°, 90°,
    /// 180° and 270° of the circle.
    pub spikes_um: [f64; 4],
    /// What the deviation comes from, the largest first.
    pub causes: Vec<Cause>,
}

impl CircleReport {
    /// The largest spike, µm.
    #[must_use]
    pub fn spike_um(&self) -> f64 {
        self.spikes_um.into_iter().fold(0.0, ballbar::larger)
    }
}

/// How much of a circle was seen.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Whole {
    /// Points of both directions, of those that a cycle each would have given.
    pub points: [u64; 2],
    /// Largest way between two points, degrees.
    pub largest_hole_deg: f64,
}

/// With fewer points than this share of all a circle is not whole.
const LEAST_POINTS: f64 = 0.995;
/// Nor with a hole larger than this, degrees, and than so many cycles.
const LARGEST_HOLE_DEG: f64 = 0.5;
const LARGEST_HOLE_CYCLES: f64 = 3.5;

impl Whole {
    fn is_all(&self, circle: &Circle, period_s: f64) -> bool {
        let [there, wanted] = self.points.map(|count| count as f64);
        let step_deg = (circle.feed_m_per_s / circle.radius_m * period_s).to_degrees();
        let largest_deg = LARGEST_HOLE_DEG.max(LARGEST_HOLE_CYCLES * step_deg);
        there >= LEAST_POINTS * wanted && self.largest_hole_deg <= largest_deg
    }
}

/// Circular deviations beside that of all counter-clockwise turns.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Roundness {
    /// Of each counter-clockwise turn.
    pub circular_deviation_g_turns_um: Vec<f64>,
    /// Of the clockwise turn.
    pub circular_deviation_g_clockwise_um: f64,
    /// Of both directions at once.
    pub circular_deviation_g_both_um: f64,
}

/// A circle that was run.
pub struct CircleRun {
    /// Its report.
    pub report: CircleReport,
    /// Turns that count, counter-clockwise.
    pub points: Vec<Point>,
    /// The clockwise turn.
    pub clockwise: Vec<Point>,
}

impl CircleRun {
    /// The first of the counter-clockwise turns that count.
    #[must_use]
    pub fn one_turn(&self) -> &[Point] {
        turn(&self.points, 0)
    }
}

/// One of the turns that count, by the angle travelled: a cycle may have been lost.
fn turn(points: &[Point], number: u32) -> &[Point] {
    let begin = |number: u32| {
        let from_rad = MEASURE_FROM_RAD + TAU * f64::from(number);
        points.partition_point(|point| point.angle_rad < from_rad)
    };
    &points[begin(number)..begin(number + 1)]
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
        let [points, clockwise] = turns_of(session, circle)?;
        let seen = Seen {
            machine: stand.machine,
            circle,
            points: &points,
            clockwise: &clockwise,
            is_at_table: session.sees() == AT_TABLE,
        };
        let (figures, roundness, found) = session.meanwhile(|| seen.evaluated())?;
        let whole = seen.whole();
        let report = CircleReport {
            machine: stand.machine.name.clone(),
            radius_mm: rounded(1.0e3 * circle.radius_m),
            feed_mm_min: rounded(6.0e4 * circle.feed_m_per_s),
            compensation: compensation::method(compensation).to_owned(),
            deviation_of: session.sees(),
            bus_load_percent: f64::from(stand.machine.bus_load_per_mille()) / 10.0,
            missed_cycles: session.missed(),
            is_whole: whole.is_all(circle, stand.machine.period_s),
            whole,
            refined_levels: refines.then(|| session.refined_levels()).transpose()?,
            figures,
            roundness,
            spikes_um: found.spikes_um,
            causes: found.list,
        };
        Ok(CircleRun {
            report,
            points,
            clockwise,
        })
    })
}

/// A value of the command line as it was said: without what 0.001 adds in the last place.
fn rounded(value: f64) -> f64 {
    (1.0e6 * value).round() / 1.0e6
}

fn refines(axis: &AxisCompensation) -> bool {
    matches!(&axis.reversal, Compensation::Model(model) if model.self_tuning > 0.0)
}

/// The turns that count, counter-clockwise and clockwise.
fn turns_of(session: &mut Session<'_>, circle: &Circle) -> Outcome<[Vec<Point>; 2]> {
    let back = Circle {
        turns: 1,
        counter_clockwise: false,
        ..*circle
    };
    progress::step(&format!(
        "circle R {} mm, F {} mm/min, {:.0} s of the machine's time",
        rounded(1.0e3 * circle.radius_m),
        rounded(6.0e4 * circle.feed_m_per_s),
        circle.duration_s() + back.duration_s()
    ));
    let points = session.circle(circle)?;
    let clockwise = session.circle(&back)?;
    Ok([points, clockwise])
}

/// A circle in both directions.
struct Seen<'a> {
    machine: &'a Machine,
    circle: &'a Circle,
    points: &'a [Point],
    clockwise: &'a [Point],
    is_at_table: bool,
}

impl Seen<'_> {
    fn evaluated(&self) -> (CircleFigures, Roundness, Causes) {
        let (radius_m, backlash_m) = (self.circle.radius_m, backlash_m(self.machine));
        let figures = ballbar::figures(self.points, radius_m, backlash_m, MEASURE_FROM_RAD);
        let hysteresis_um = ballbar::hysteresis_um(self.points, self.clockwise, radius_m);
        let causes = ballbar::causes(&BothDirections {
            counter_clockwise: self.points,
            clockwise: self.clockwise,
            radius_m,
            feed_m_per_s: self.circle.feed_m_per_s,
            axes: [0, 1].map(|axis| CircleAxis {
                name: self.machine.axes[axis].name.clone(),
                lead_m: self.machine.axes[axis].actual.lead_m_per_rev,
            }),
            window_rad: ballbar::window_rad(radius_m, backlash_m),
            settling_s: settling_s(self.machine),
            is_at_table: self.is_at_table,
        });
        let figures = CircleFigures {
            circular_hysteresis_h_um: Some(hysteresis_um),
            ..figures
        };
        (figures, self.roundness(), causes)
    }

    fn whole(&self) -> Whole {
        let turns = f64::from(self.circle.turns + 1);
        let turn_s = TAU * self.circle.radius_m / self.circle.feed_m_per_s;
        let wanted = (turns * turn_s / self.machine.period_s).round();
        let there = (self.points.len() + self.clockwise.len()) as u64;
        let hole = |points: &[Point]| {
            let ways = points
                .windows(2)
                .map(|pair| pair[1].angle_rad - pair[0].angle_rad);
            ways.fold(0.0, f64::max)
        };
        Whole {
            points: [there, wanted as u64],
            largest_hole_deg: hole(self.points).max(hole(self.clockwise)).to_degrees(),
        }
    }

    fn roundness(&self) -> Roundness {
        let turns = (0..self.circle.turns)
            .map(|number| ballbar::circular_deviation_um(turn(self.points, number)));
        let both = [self.points, self.clockwise].concat();
        Roundness {
            circular_deviation_g_turns_um: turns.collect(),
            circular_deviation_g_clockwise_um: ballbar::circular_deviation_um(self.clockwise),
            circular_deviation_g_both_um: ballbar::circular_deviation_um(&both),
        }
    }
}

/// A burst decays with the position loop; after so many of its time constants nothing of it is
/// left.
const TIME_CONSTANTS: f64 = 12.0;

fn settling_s(machine: &Machine) -> f64 {
    let gains = machine
        .axes
        .iter()
        .map(|axis| axis.gains.position_gain_per_s);
    TIME_CONSTANTS / gains.fold(f64::INFINITY, f64::min)
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
