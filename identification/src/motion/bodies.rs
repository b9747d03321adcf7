//! Motor and load of a record, each with its velocity and acceleration.
//!
//! The motor's are those of its position, or of the velocity that the drive measured where the
//! record has one: a velocity that is not to be used was taken out before. The load was measured as
//! a position alone. What a jittered clock does to its derivatives it does to those of the motor's
//! position too: so the load's motion is the motor's and what the two positions differ by.

use crate::motion::derivatives::Derivatives;
use crate::record::samples::Record;
use crate::record::units::EffortHold;

/// The bodies of a record.
pub(crate) struct Bodies {
    /// The motor.
    pub motor: Derivatives,
    /// The load, where it was measured.
    pub load: Option<Derivatives>,
    /// Load − motor acceleration, where both were measured.
    pub load_acceleration: Option<Vec<f64>>,
}

impl Bodies {
    /// Of one piece of a record.
    #[must_use]
    pub(crate) fn of(record: &Record, hold: EffortHold, is_sharpened: bool) -> Self {
        let by_position = |positions: &[f64]| {
            let plain = Derivatives::new(positions, record.period_s, hold);
            if is_sharpened {
                plain.sharpened(hold)
            } else {
                plain
            }
        };
        let motor = by_position(&record.position);
        let load = record.load.as_deref().map(by_position);
        let apart = |load: &Derivatives| minus(&load.acceleration, &motor.acceleration);
        let load_acceleration = load.as_ref().map(apart);
        let Some(measured) = record.velocity.as_deref() else {
            return Self {
                motor,
                load,
                load_acceleration,
            };
        };
        let by_velocity = motor.with_velocity(measured, record.period_s, hold);
        Self {
            load: load.map(|load| load.corrected_like(&motor, &by_velocity)),
            motor: by_velocity,
            load_acceleration,
        }
    }

    /// The body that friction acts on: the load where there is a scale, else the motor.
    #[must_use]
    pub(crate) fn with_friction(&self) -> &Derivatives {
        self.load.as_ref().unwrap_or(&self.motor)
    }
}

/// One signal without another.
#[must_use]
pub(crate) fn minus(one: &[f64], other: &[f64]) -> Vec<f64> {
    one.iter().zip(other).map(|(a, b)| a - b).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulate::made::{record, two_sines};

    /// Two sines with a load that follows at nine tenths, and positions that are off by a jitter.
    fn jittered(velocity: Option<Vec<f64>>) -> Record {
        let off = |row: usize| 1.0e-6 * (1.7 * (row * row % 997) as f64).sin();
        let path = two_sines(3000);
        let off_by = |share: f64| -> Vec<f64> {
            let rows = path.iter().enumerate();
            rows.map(|(row, x)| share * (x + off(row))).collect()
        };
        Record {
            load: Some(off_by(0.9)),
            velocity,
            ..record(1.0e-3, off_by(1.0))
        }
    }

    #[test]
    fn without_a_measured_velocity_both_bodies_are_those_of_their_positions() {
        let record = jittered(None);
        let hold = EffortHold::Instant;
        let bodies = Bodies::of(&record, hold, false);
        let own = Derivatives::new(record.load.as_deref().unwrap(), 1.0e-3, hold);
        assert_eq!(bodies.with_friction().velocity, own.velocity);
        assert_eq!(bodies.with_friction().acceleration, own.acceleration);
    }

    #[test]
    fn with_it_the_jitter_of_both_positions_is_gone_from_both_but_for_their_difference() {
        let exact = Derivatives::new(&two_sines(3000), 1.0e-3, EffortHold::Instant);
        let bodies = Bodies::of(
            &jittered(Some(exact.velocity.clone())),
            EffortHold::Instant,
            false,
        );
        let worst = |one: &[f64], other: &[f64]| {
            let apart = one[5..2990].iter().zip(&other[5..2990]);
            apart.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
        };
        // A jitter of 1 µm is 4 m/s² in a second difference; a tenth of it is in the difference.
        assert!(worst(&bodies.motor.acceleration, &exact.acceleration) < 1.0e-3);
        let slower: Vec<f64> = exact.acceleration.iter().map(|a| 0.9 * a).collect();
        let load = &bodies.with_friction().acceleration;
        assert!(
            (0.1..0.5).contains(&worst(load, &slower)),
            "{}",
            worst(load, &slower)
        );
    }
}
