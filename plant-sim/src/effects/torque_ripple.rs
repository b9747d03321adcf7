//! A force on the motor that is periodic in its position: −A sin(2π·order·x / lead + φ).

use std::f64::consts::TAU;

use axis_model::TorqueRipple;

use super::{Instant, Simulated};

impl Simulated for TorqueRipple {
    fn refusal(&self) -> Option<&'static str> {
        (self.order.is_some() == self.period.is_some())
            .then_some("give order_per_rev or period_m, one of the two")
    }

    fn motor_n(&self, at: &Instant) -> f64 {
        let from_period = || self.period.map(|period| at.lead_m / period);
        let order = self.order.or_else(from_period).unwrap_or(0.0);
        let angle = TAU * order * at.motor_m / at.lead_m + self.phase.unwrap_or(0.0);
        -self.amplitude * angle.sin()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(motor_m: f64) -> Instant {
        Instant {
            motor_m,
            lead_m: 0.010,
            ..Instant::default()
        }
    }

    const RIPPLE: TorqueRipple = TorqueRipple {
        amplitude: 40.0,
        order: Some(5.0),
        period: None,
        phase: None,
    };

    #[test]
    fn a_ripple_of_order_five_pulls_five_times_a_revolution() {
        assert_eq!(RIPPLE.motor_n(&at(0.0)), 0.0);
        assert!(
            (RIPPLE.motor_n(&at(0.5e-3)) + 40.0).abs() < 1.0e-9,
            "a quarter"
        );
        assert!(
            (RIPPLE.motor_n(&at(2.5e-3)) + 40.0).abs() < 1.0e-9,
            "one and a quarter"
        );
        let turned = TorqueRipple {
            phase: Some(TAU / 4.0),
            ..RIPPLE
        };
        assert!((turned.motor_n(&at(0.0)) + 40.0).abs() < 1.0e-9);
    }

    #[test]
    fn a_period_says_the_same_as_an_order_and_one_of_them_is_needed() {
        let by_way = TorqueRipple {
            order: None,
            period: Some(2.0e-3),
            ..RIPPLE
        };
        assert!((by_way.motor_n(&at(0.3e-3)) - RIPPLE.motor_n(&at(0.3e-3))).abs() < 1.0e-9);
        assert_eq!((RIPPLE.refusal(), by_way.refusal()), (None, None));
        let (neither, both) = (
            TorqueRipple {
                order: None,
                ..RIPPLE
            },
            TorqueRipple {
                order: Some(5.0),
                ..by_way
            },
        );
        assert!(neither.refusal().is_some() && both.refusal().is_some());
    }
}
