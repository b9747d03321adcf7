//! Motor and load of a record, each with its velocity and acceleration.
//!
//! The motor's are those of its position, or of the velocity that the drive measured where the
//! record has one: a velocity that is not to be used was taken out before. The load was measured as
//! a position alone. What a jittered clock does to its derivatives it does to those of the motor's
//! position too: so the load's motion is the motor's and what the two positions differ by.

use crate::motion::derivatives::Derivatives;
use crate::record::dataset::Dataset;
use crate::record::samples::Record;
use crate::record::scale_error::along;

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
    pub(crate) fn of(dataset: &Dataset, record: &Record) -> Self {
        let hold = dataset.hold;
        let by_position = |positions: &[f64]| {
            let plain = Derivatives::new(positions, record.period_s, hold);
            if dataset.is_sharpened {
                plain.sharpened(hold)
            } else {
                plain
            }
        };
        let motor = by_position(&record.position);
        let load = record.load.as_deref().map(by_position);
        let apart = |load: &Derivatives| minus(&load.acceleration, &motor.acceleration);
        let mut load_acceleration = load.as_ref().map(apart);
        if !dataset.scale_errors.is_empty() {
            let never_was = by_position(&along(&dataset.scale_errors, &record.position));
            let apart = load_acceleration.iter_mut().flatten();
            let rows = apart.zip(never_was.acceleration);
            rows.for_each(|(apart, never_was)| *apart += never_was);
        }
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

/// Adds weighted signals to a sum.
pub(crate) fn add(sum: &mut [f64], signals: &[Vec<f64>], weights: &[f64]) {
    for (signal, weight) in signals.iter().zip(weights) {
        sum.iter_mut()
            .zip(signal)
            .for_each(|(sum, value)| *sum += weight * value);
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
    use crate::record::scale_error::ScaleError;
    use crate::record::units::EffortHold;
    use crate::simulate::made::{dataset, record, two_sines};

    fn bodies(record: Record, scale_errors: Vec<ScaleError>) -> Bodies {
        let dataset = Dataset {
            hold: EffortHold::Instant,
            scale_errors,
            ..dataset(record, None)
        };
        Bodies::of(&dataset, &dataset.train)
    }

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
        let own = Derivatives::new(record.load.as_deref().unwrap(), 1.0e-3, EffortHold::Instant);
        let bodies = bodies(record, Vec::new());
        assert_eq!(bodies.with_friction().velocity, own.velocity);
        assert_eq!(bodies.with_friction().acceleration, own.acceleration);
    }

    #[test]
    fn with_it_the_jitter_of_both_positions_is_gone_from_both_but_for_their_difference() {
        let exact = Derivatives::new(&two_sines(3000), 1.0e-3, EffortHold::Instant);
        let bodies = bodies(jittered(Some(exact.velocity.clone())), Vec::new());
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

    #[test]
    fn a_scale_that_is_off_makes_no_acceleration_of_its_load() {
        let error = ScaleError {
            per_length: 100.0,
            cos: 2.0e-6,
            sin: -1.0e-6,
        };
        let apart = |scale_errors: Vec<ScaleError>| {
            let path = two_sines(3000);
            let seen = minus(&path, &along(&[error], &path));
            let off = Record {
                load: Some(seen),
                ..record(1.0e-3, path)
            };
            let apart = bodies(off, scale_errors).load_acceleration.unwrap();
            apart[5..2990]
                .iter()
                .fold(0.0_f64, |most, a| most.max(a.abs()))
        };
        let seen = apart(Vec::new());
        assert!(seen > 1.0e-3, "{seen}");
        assert!(apart(vec![error]) < 1.0e-6 * seen);
    }
}
