//! Sliding mode with a boundary layer: no integral.
//!
//! s = ė + λ·e, effort = M·λ·ė + K·sat(s/φ) (Slotine and Li, Applied Nonlinear Control, 1991, ch.
//! 7). Within the layer φ it is a PD controller with both poles at λ when K = φ·M·λ; what it is
//! pushed off by a force F is F/(M·λ²).

use std::f64::consts::TAU;

use crate::control::pi::Lag;

/// A sliding mode.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sliding {
    /// M of the model.
    pub inertia: f64,
    /// λ, 1/s.
    pub slope_per_s: f64,
    /// K, N or N m.
    pub reach: f64,
    /// φ, velocity.
    pub layer: f64,
}

impl Sliding {
    /// By its bandwidth, Hz, and the effort that it may add.
    #[must_use]
    pub fn of(inertia: f64, bandwidth_hz: f64, reach: f64) -> Self {
        let slope_per_s = TAU * bandwidth_hz;
        Self {
            inertia,
            slope_per_s,
            reach,
            layer: reach / (inertia * slope_per_s),
        }
    }

    /// The effort by the lag behind what is wanted.
    #[must_use]
    pub fn effort(&self, lag: &Lag) -> f64 {
        let surface = lag.velocity + self.slope_per_s * lag.position;
        let pushed = self.reach * (surface / self.layer).clamp(-1.0, 1.0);
        self.inertia * self.slope_per_s * lag.velocity + pushed
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lag(position: f64, velocity: f64) -> Lag {
        Lag {
            position,
            velocity,
            wanted_velocity: 0.0,
        }
    }

    #[test]
    fn it_is_a_pd_controller_within_the_layer_and_reaches_no_further_outside() {
        let sliding = Sliding::of(2.0, 5.0, 100.0);
        let slope = TAU * 5.0;
        let inside = sliding.effort(&lag(1.0e-3, 2.0e-3));
        let expected = 2.0 * (slope * slope * 1.0e-3 + 2.0 * slope * 2.0e-3);
        assert!((inside - expected).abs() < 1.0e-9);
        assert!((sliding.effort(&lag(1.0, 0.0)) - 100.0).abs() < 1.0e-9);
    }
}
