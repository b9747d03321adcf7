//! A gap and bristles that make the same burst on a circle.
//!
//! Backlash and friction look alike on a circle: both leave a burst at the reversal. A pair has a
//! gap inside the loop with Coulomb friction, and an axis with presliding whose friction is chosen
//! so that the bursts agree.

use std::f64::consts::TAU;

use plant_sim::axis::{Axis, AxisParameters};

use super::PERIOD_S;
use super::axis::{self, Measured, mass_kg};
use super::control::Controller;
use super::draws::Draws;
use super::hidden::Hidden;
use super::plan::{Plan, Sensor};

/// Radius and feed of the circle on which bursts are compared.
const CIRCLE_M: f64 = 0.100;
const FEED_M_PER_S: f64 = 2.0 / 60.0;
/// Angle per time on the circle, rad/s.
const OMEGA_RAD_PER_S: f64 = FEED_M_PER_S / CIRCLE_M;
/// Bursts are looked for within this angle about a reversal, rad.
const BURST_WINDOW: f64 = 0.26;
/// Factors on the friction between which the equal burst is looked for.
const FRICTION_FACTORS: (f64, f64) = (0.1, 10.0);
/// Halvings of the ratio between them: it ends within 0.1 %.
const HALVINGS: usize = 12;

/// The pair of a seed: the gap, the bristles.
#[must_use]
pub fn pair(seed: u64) -> [Plan; 2] {
    let gap = Plan {
        hidden: vec![Hidden::Backlash {
            gap_m: 8.0e-6 + 1.0e-6 * seed as f64,
        }],
        closed_on: Sensor::Load,
        seed,
        ..Plan::default()
    };
    let deflection_m = 4.0e-6 + 0.5e-6 * seed as f64;
    let bristles = |friction_factor: f64| Plan {
        hidden: vec![Hidden::Presliding { deflection_m }],
        friction_factor,
        ..gap.clone()
    };
    let wanted_m = burst_m(&gap);
    let (mut low, mut high) = FRICTION_FACTORS;
    for _ in 0..HALVINGS {
        let middle = f64::sqrt(low * high);
        if burst_m(&bristles(middle)) < wanted_m {
            low = middle;
        } else {
            high = middle;
        }
    }
    let bristles = bristles(f64::sqrt(low * high));
    [gap, bristles]
}

/// The burst that the axis of a plan makes on a circle, m: the largest deviation of the table from
/// its setpoint about the reversals of the second turn, less the deviation in between.
#[must_use]
pub fn burst_m(plan: &Plan) -> f64 {
    let quiet = AxisParameters {
        force_noise_n: 0.0,
        ..axis::parameters(plan, &mut Draws::of(plan.seed))
    };
    let rows = (2.0 * TAU / OMEGA_RAD_PER_S / PERIOD_S) as usize;
    let path: Vec<f64> = (0..rows).map(|row| CIRCLE_M * angle(row).sin()).collect();
    let deviations = deviations_m(quiet, plan.closed_on, &path);
    let (mut largest, mut sum, mut count) = (0.0_f64, 0.0, 0.0);
    for (row, deviation) in deviations.into_iter().enumerate() {
        if angle(row) <= TAU {
            continue;
        }
        if angle(row).cos().abs() < BURST_WINDOW.sin() {
            largest = largest.max(deviation);
        } else {
            (sum, count) = (sum + deviation, count + 1.0);
        }
    }
    largest - sum / f64::max(count, 1.0)
}

fn angle(row: usize) -> f64 {
    OMEGA_RAD_PER_S * PERIOD_S * row as f64
}

/// How far the table is from its setpoint, by row.
fn deviations_m(parameters: AxisParameters, closed_on: Sensor, path: &[f64]) -> Vec<f64> {
    let mut controller = Controller::new(mass_kg(&parameters));
    let mut axis = Axis::new(parameters, 1);
    let mut step = |row: usize| {
        let position_m = Measured::of(&mut axis).at(closed_on);
        let deviation_m = (axis.motion().table_m - path[row]).abs();
        axis.advance(controller.step(path, row, position_m), PERIOD_S);
        deviation_m
    };
    (0..path.len()).map(&mut step).collect()
}
