//! The controller of the records: position P, velocity PI, feedforward of velocity and
//! acceleration.
//!
//! ```text
//! e = Kp (r − x) + ṙ − v        v: low-passed difference quotient of x
//! u = K (e + ∫ Ki e dt) + M r̈   K = M · 2π · bandwidth
//! ```
//!
//! `identification` simulates the same law from `dataset.toml` with code of its own.

use std::f64::consts::TAU;

use super::PERIOD_S;

pub(super) const POSITION_GAIN_PER_S: f64 = 40.0;
pub(super) const INTEGRAL_PER_S: f64 = 30.0;
/// Weight of the newest quotient in the measured velocity.
pub(super) const VELOCITY_FILTER: f64 = 0.7;
const VELOCITY_BANDWIDTH_HZ: f64 = 25.0;

/// Force per velocity error of an axis, N·s/m.
pub(super) fn velocity_gain_n_s_per_m(mass_kg: f64) -> f64 {
    mass_kg * TAU * VELOCITY_BANDWIDTH_HZ
}

/// The controller with its state.
pub(super) struct Controller {
    mass_kg: f64,
    before_m: Option<f64>,
    velocity_m_per_s: f64,
    integral_m_per_s: f64,
}

impl Controller {
    /// The controller of an axis of this mass.
    pub(super) const fn new(mass_kg: f64) -> Self {
        Self {
            mass_kg,
            before_m: None,
            velocity_m_per_s: 0.0,
            integral_m_per_s: 0.0,
        }
    }

    /// The force for a row of a path, N, from the position on which the loop is closed.
    pub(super) fn step(&mut self, path: &[f64], row: usize, position_m: f64) -> f64 {
        let at = |row: usize| path[row.min(path.len() - 1)];
        let slope = |row: usize| (at(row) - at(row.saturating_sub(1))) / PERIOD_S;
        let quotient = (position_m - self.before_m.unwrap_or(position_m)) / PERIOD_S;
        self.before_m = Some(position_m);
        self.velocity_m_per_s += VELOCITY_FILTER * (quotient - self.velocity_m_per_s);
        let error =
            POSITION_GAIN_PER_S * (at(row) - position_m) + slope(row) - self.velocity_m_per_s;
        self.integral_m_per_s += PERIOD_S * INTEGRAL_PER_S * error;
        let jump = slope(row + 1) - slope(row.saturating_sub(1));
        velocity_gain_n_s_per_m(self.mass_kg) * (error + self.integral_m_per_s)
            + self.mass_kg * jump / (2.0 * PERIOD_S)
    }
}
