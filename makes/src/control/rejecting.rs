//! PD with an observer of the disturbance: no integral.
//!
//! d̂ = Q·(u − M·s·v) with Q = g/(s + g), which needs no derivative: with z = Q·(u + M·g·v) it is
//! d̂ = z − M·g·v (Ohnishi, Shibata and Murakami, IEEE/ASME Trans. Mechatronics 1, 1996). The
//! effort is M·(w²·e + 2w·e') + d̂, both poles at w.

use std::f64::consts::TAU;

use crate::control::pi::Lag;

/// How many times as fast as the loop its observer is.
const AHEAD: f64 = 2.0;

/// A PD controller with an observer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rejecting {
    /// M of the model.
    pub inertia: f64,
    /// w, rad/s.
    pub bandwidth_rad_s: f64,
    /// g, rad/s.
    pub observer_rad_s: f64,
}

impl Rejecting {
    /// By its bandwidth, Hz.
    #[must_use]
    pub fn of(inertia: f64, bandwidth_hz: f64) -> Self {
        let bandwidth_rad_s = TAU * bandwidth_hz;
        Self {
            inertia,
            bandwidth_rad_s,
            observer_rad_s: AHEAD * bandwidth_rad_s,
        }
    }

    /// The effort for the next period without feedforward, by the effort of the last one and the
    /// velocity that came of it; `filtered` is z.
    #[must_use]
    pub fn effort(
        &self,
        filtered: &mut f64,
        lag: &Lag,
        (last, velocity): (f64, f64),
        period_s: f64,
    ) -> f64 {
        let carried = self.inertia * self.observer_rad_s * velocity;
        let share = 1.0 - libm::exp(-self.observer_rad_s * period_s);
        *filtered += share * (last + carried - *filtered);
        let w = self.bandwidth_rad_s;
        let wish = w * w * lag.position + 2.0 * w * lag.velocity;
        self.inertia * wish + *filtered - carried
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_needed_at_rest_is_taken_up_whole() {
        let rejecting = Rejecting::of(2.0, 5.0);
        let (mut filtered, mut last) = (0.0, 30.0);
        let still = Lag {
            position: 0.0,
            velocity: 0.0,
            wanted_velocity: 0.0,
        };
        for _ in 0..1000 {
            last = rejecting.effort(&mut filtered, &still, (30.0, 0.0), 1.0e-3);
        }
        assert!((last - 30.0).abs() < 1.0e-6, "{last}");
    }

    #[test]
    fn the_inertia_of_the_model_is_no_disturbance() {
        let rejecting = Rejecting::of(2.0, 5.0);
        let (mut filtered, mut left) = (0.0, 0.0);
        for k in 1..2000 {
            // 3 m/s² under 6 N: what is wanted is what is there.
            let velocity = 3.0e-3 * f64::from(k);
            let there = Lag {
                position: 0.0,
                velocity: 0.0,
                wanted_velocity: velocity,
            };
            left = rejecting.effort(&mut filtered, &there, (6.0, velocity), 1.0e-3);
        }
        // Half a period of the observer's own: g·T/2 of 6 N.
        assert!(left.abs() < 0.2, "{left}");
    }
}
