//! The cycles about one reversal of the first axis, which moves as X does on a circle.

use std::f64::consts::TAU;

use plant_sim::Machine;

use crate::compensation::AxisCompensation;
use crate::error::Outcome;
use crate::network::master::AxisCycle;
use crate::session::{Session, Stand};
use crate::trajectory::Circle;

/// Noise of this run is another than that of records and circles.
const REVERSAL_RUN: u64 = 2;
/// The second reversal of X is at three quarters of a turn.
const REVERSAL_RAD: f64 = 0.75 * TAU;
/// What is kept to either side: a quarter of a radian of the circle, but no more than this.
const LONGEST_S: f64 = 0.6;
const KEPT_RAD: f64 = 0.25;

/// A cycle, and its time since the reversal, s.
pub type ReversalRow = (f64, AxisCycle);

/// Cycles about one reversal of the first axis on a sine with the path of a circle.
///
/// # Errors
/// Where the machine cannot run it.
pub fn reversal_rows(
    stand: &Stand<'_>,
    compensation: &[AxisCompensation],
    circle: &Circle,
) -> Outcome<Vec<ReversalRow>> {
    // One turn is enough, and it ends at rest.
    let circle = Circle {
        turns: 1,
        ..*circle
    };
    let session = stand.connect(REVERSAL_RUN)?;
    session.perform(compensation, None, |session| {
        about_reversal(session, stand.machine, &circle)
    })
}

fn about_reversal(
    session: &mut Session<'_>,
    machine: &Machine,
    circle: &Circle,
) -> Outcome<Vec<ReversalRow>> {
    let rest = vec![0.0; machine.axes.len() - 1];
    let setpoints = |time_s: f64| [vec![circle.at(time_s)[0]], rest.clone()].concat();
    let reversal_s = time_of(circle, REVERSAL_RAD);
    let omega = circle.feed_m_per_s / circle.radius_m;
    let window_s = (KEPT_RAD / omega).min(LONGEST_S);
    let mut rows = Vec::new();
    session.go_to(&setpoints(0.0))?;
    session.follow(circle.duration_s(), setpoints, |time_s, axes| {
        if (time_s - reversal_s).abs() <= window_s {
            rows.push((time_s - reversal_s, axes[0]));
        }
    })?;
    Ok(rows)
}

/// The first millisecond at which an angle has been travelled; zero where it never is.
fn time_of(circle: &Circle, angle_rad: f64) -> f64 {
    let mut milliseconds = (0_u32..1_000_000).map(|i| 1.0e-3 * f64::from(i));
    milliseconds
        .find(|time_s| circle.angle_rad(*time_s) > angle_rad)
        .unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_setpoint_turns_round_at_the_time_of_the_reversal() {
        let circle = Circle {
            radius_m: 0.1,
            feed_m_per_s: 2.0 / 60.0,
            turns: 1,
            counter_clockwise: true,
        };
        let at = time_of(&circle, REVERSAL_RAD);
        let [before, there, after] = [at - 0.1, at, at + 0.1].map(|time_s| circle.at(time_s)[0]);
        // A millisecond at the feed is 0.33 mrad: R·φ²/2 from the turning point at most.
        assert!((there + circle.radius_m).abs() < 1.0e-8, "{there}");
        assert!(before > there && after > there, "{before} {there} {after}");
    }
}
