//! A motor whose torque constant varies with its position, as uneven magnets make it: of a
//! commanded force u it delivers u (1 + c sin(2π·order·x / lead + φ)).

use std::f64::consts::TAU;

use axis_model::TorqueConstantRipple;

use super::{Instant, Simulated};

impl Simulated for TorqueConstantRipple {
    fn refusal(&self) -> Option<&'static str> {
        (self.order.is_some() == self.period.is_some())
            .then_some("give order_per_rev or period_m, one of the two")
    }

    fn motor_n(&self, at: &Instant) -> f64 {
        let from_period = || self.period.map(|period| at.lead_m / period);
        let order = self.order.or_else(from_period).unwrap_or(0.0);
        let angle = TAU * order * at.motor_m / at.lead_m + self.phase.unwrap_or(0.0);
        self.torque_constant_ripple * angle.sin() * at.delivered_n
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MAGNETS: TorqueConstantRipple = TorqueConstantRipple {
        torque_constant_ripple: 0.1,
        order: Some(5.0),
        period: None,
        phase: None,
    };

    #[test]
    fn a_tenth_more_or_less_is_delivered_five_times_a_revolution_in_either_direction() {
        for (motor_m, delivered_n, more_n) in [
            (0.0, 300.0, 0.0),
            (0.5e-3, 300.0, 30.0),
            (1.5e-3, 300.0, -30.0),
            (2.5e-3, -300.0, -30.0),
            (0.5e-3, 0.0, 0.0),
        ] {
            let at = Instant {
                motor_m,
                delivered_n,
                lead_m: 0.010,
                ..Instant::default()
            };
            assert!((MAGNETS.motor_n(&at) - more_n).abs() < 1.0e-9, "{motor_m}");
        }
    }

    #[test]
    fn a_period_or_an_order_is_needed() {
        let neither = TorqueConstantRipple {
            order: None,
            ..MAGNETS
        };
        let by_way = TorqueConstantRipple {
            period: Some(2.0e-3),
            ..neither
        };
        assert_eq!((MAGNETS.refusal(), by_way.refusal()), (None, None));
        assert!(neither.refusal().is_some());
    }
}
