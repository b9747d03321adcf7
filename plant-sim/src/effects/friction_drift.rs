//! Friction that is higher (or lower) while the axis is cold: factor 1 + g exp(−t / τ).

use axis_model::FrictionDrift;

use super::{Instant, Simulated};

impl Simulated for FrictionDrift {
    fn refusal(&self) -> Option<&'static str> {
        self.viscous_gain
            .map(|_| "the simulator's viscous friction does not drift; leave viscous_gain out")
    }

    fn friction_factor(&self, at: &Instant) -> f64 {
        1.0 + self.gain * (-at.time_s / self.time_constant).exp()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const WARM_UP: FrictionDrift = FrictionDrift {
        gain: 0.4,
        time_constant: 20.0,
        viscous_gain: None,
    };

    #[test]
    fn the_surplus_falls_to_one_over_e_within_the_time_constant() {
        let factor = |time_s| {
            WARM_UP.friction_factor(&Instant {
                time_s,
                ..Instant::default()
            })
        };
        assert_eq!(factor(0.0), 1.4);
        assert!((factor(20.0) - (1.0 + 0.4 / std::f64::consts::E)).abs() < 1.0e-12);
    }

    #[test]
    fn a_drift_of_viscous_friction_is_refused() {
        let both = FrictionDrift {
            viscous_gain: Some(0.1),
            ..WARM_UP
        };
        assert_eq!(WARM_UP.refusal(), None);
        assert!(both.refusal().unwrap().contains("viscous_gain"));
    }
}
