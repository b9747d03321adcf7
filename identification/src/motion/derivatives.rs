//! Velocity and acceleration from positions, at the time at which the effort of a row acts.
//!
//! A zero-order-hold effort acts from its row to the next, so positions and their derivatives are
//! taken at the middle of that interval: the velocity is the difference quotient, the acceleration
//! the mean of two adjacent second differences (the triangle-weighted mean acceleration over the
//! hold). An instantaneous effort is paired with central differences.

use crate::record::units::EffortHold;

/// Position, velocity and acceleration of one body.
#[derive(Clone, Debug)]
pub(crate) struct Derivatives {
    pub(crate) position: Vec<f64>,
    pub(crate) velocity: Vec<f64>,
    pub(crate) acceleration: Vec<f64>,
}

/// Positions that go on beyond both ends, mirrored about the first and the last one, so that no row
/// is lost.
struct Mirrored<'a>(&'a [f64]);

impl Mirrored<'_> {
    fn at(&self, row: isize) -> f64 {
        let x = self.0;
        let last = x.len() as isize - 1;
        match row {
            row if row < 0 => 2.0 * x[0] - x[(-row).min(last) as usize],
            row if row > last => 2.0 * x[last as usize] - x[(2 * last - row).max(0) as usize],
            row => x[row as usize],
        }
    }

    /// Second difference about a row.
    fn second(&self, row: isize) -> f64 {
        self.at(row + 1) - 2.0 * self.at(row) + self.at(row - 1)
    }
}

impl Derivatives {
    /// Of positions that are `period_s` apart.
    #[must_use]
    pub(crate) fn new(positions: &[f64], period_s: f64, hold: EffortHold) -> Self {
        let (x, t) = (Mirrored(positions), period_s);
        let rows = 0..positions.len() as isize;
        let second = |i: isize| x.second(i) / (t * t);
        match hold {
            EffortHold::ZeroOrder => Self {
                position: rows
                    .clone()
                    .map(|i| 0.5 * (x.at(i) + x.at(i + 1)))
                    .collect(),
                velocity: rows.clone().map(|i| (x.at(i + 1) - x.at(i)) / t).collect(),
                acceleration: rows.map(|i| 0.5 * (second(i) + second(i + 1))).collect(),
            },
            EffortHold::Instant => Self {
                position: positions.to_vec(),
                velocity: rows
                    .clone()
                    .map(|i| (x.at(i + 1) - x.at(i - 1)) / (2.0 * t))
                    .collect(),
                acceleration: rows.map(second).collect(),
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HOLDS: [EffortHold; 2] = [EffortHold::Instant, EffortHold::ZeroOrder];

    /// 0.5 · 3 t² at 1 kHz.
    fn parabola() -> Vec<f64> {
        let at = |i: i32| 1.5 * (1.0e-3 * f64::from(i)).powi(2);
        (0..50).map(at).collect()
    }

    #[test]
    fn the_acceleration_of_a_parabola_is_exact_under_both_holds() {
        for hold in HOLDS {
            let derivatives = Derivatives::new(&parabola(), 1.0e-3, hold);
            let inside = &derivatives.acceleration[5..45];
            assert!(inside.iter().all(|a| (a - 3.0).abs() < 1.0e-6));
        }
    }

    #[test]
    fn an_effort_that_is_held_sees_the_middle_of_its_interval() {
        let [instant, held] = HOLDS.map(|hold| Derivatives::new(&parabola(), 1.0e-3, hold));
        // 3 t: at row 20, and half a row later.
        assert!((instant.velocity[20] - 60.0e-3).abs() < 1.0e-9);
        assert!((held.velocity[20] - 61.5e-3).abs() < 1.0e-9);
        assert_eq!(instant.position[20], parabola()[20]);
        assert_eq!(held.position[20], 0.5 * (parabola()[20] + parabola()[21]));
    }

    #[test]
    fn a_straight_line_goes_on_beyond_its_ends() {
        let line: Vec<f64> = (0..10).map(|i| 0.5 * f64::from(i)).collect();
        for hold in HOLDS {
            let derivatives = Derivatives::new(&line, 0.5, hold);
            assert!(
                derivatives
                    .velocity
                    .iter()
                    .all(|v| (v - 1.0).abs() < 1.0e-12)
            );
            assert!(derivatives.acceleration.iter().all(|a| a.abs() < 1.0e-12));
        }
    }
}
