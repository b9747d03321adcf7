//! The velocity that a drive measured, beside the derivative of the position.
//!
//! `v(t) = s · dx/dt (t − τ)`: a unit or a gear makes the slope s, a filter or a bus the delay τ.
//! Of the two signals the position is the truth in size and in time, because the setpoints, the
//! load and every effect over the position go by it. The derivative is the one with noise in it, so
//! s and τ are those with which the measured velocity gives the derivative, and not the other way
//! round:
//!
//! ```text
//! dx/dt = c1 v + c2 dv/dt,   s = 1/c1,   τ = c2/c1
//! ```
//!
//! That holds for small τ. So the velocity is shifted by what was found, and asked again.

use crate::motion::derivatives::Derivatives;
use crate::motion::filter::{LowPass, cutoff_hz};
use crate::motion::mask::is_inside;
use crate::motion::shift::shifted;
use crate::record::samples::Record;
use crate::record::units::EffortHold;

/// Both are compared below this frequency: even a jittered clock leaves a good velocity there.
const CUTOFF_HZ: f64 = 20.0;
/// Rounds of shifting and asking again.
const ROUNDS: usize = 8;
/// A longer delay is not looked for, s: what comes later is no velocity for a controller.
const LONGEST_S: f64 = 0.1;

/// How a measured velocity stands to the derivative of the position.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Relation {
    /// How many times as large it is.
    pub slope: f64,
    /// How much later it comes, s.
    pub late_s: f64,
    /// Correlation of both, the delay taken out.
    pub correlation: f64,
}

/// Two low-passed velocities, and the rows that count.
struct Compared {
    derivative: Vec<f64>,
    measured: Vec<f64>,
    counts: Vec<bool>,
    period_s: f64,
}

impl Relation {
    /// Of a record; `None` where it has no velocity or leaves no room for the low-pass. A velocity
    /// that stands still has a slope of zero.
    #[must_use]
    pub(crate) fn of(record: &Record) -> Option<Self> {
        let compared = Compared::of(record)?;
        let mut late_s = 0.0;
        for _ in 0..ROUNDS {
            let more_s = compared.later_by(late_s);
            late_s = (late_s + more_s).clamp(-LONGEST_S, LONGEST_S);
        }
        Some(compared.relation(late_s))
    }

    /// The velocity of a record in the size and at the time of its position.
    #[must_use]
    pub(crate) fn aligned(&self, velocity: &[f64], period_s: f64) -> Vec<f64> {
        let in_time = shifted(velocity, self.late_s / period_s);
        in_time.into_iter().map(|v| v / self.slope).collect()
    }
}

impl Compared {
    fn of(record: &Record) -> Option<Self> {
        let period_s = record.period_s;
        let filter = LowPass::new(period_s, CUTOFF_HZ.min(cutoff_hz(period_s)))?;
        let (velocity, pieces) = (record.velocity.as_deref()?, record.pieces());
        let of = |x: &[f64]| Derivatives::new(x, period_s, EffortHold::Instant).velocity;
        let derivative = pieces.iter().cloned().flat_map(|piece| {
            let own = of(&record.position[piece]);
            filter.apply(&own)
        });
        let derivative = derivative.collect();
        let measured = pieces.iter().cloned();
        let measured = measured.flat_map(|piece| filter.apply(&velocity[piece]));
        let counts = |row: usize| is_inside(&pieces, row) && !record.interpolated[row];
        Some(Self {
            derivative,
            measured: measured.collect(),
            counts: (0..record.len()).map(counts).collect(),
            period_s,
        })
    }

    /// How much later than a delay the measured velocity comes, to first order.
    fn later_by(&self, late_s: f64) -> f64 {
        let rows = late_s / self.period_s;
        let [before, at, after] = [-1.0, 0.0, 1.0].map(|by| shifted(&self.measured, rows + by));
        let mut sums = [0.0; 5];
        for row in (0..at.len()).filter(|row| self.counts[*row]) {
            let slope = (after[row] - before[row]) / (2.0 * self.period_s);
            let (v, wanted) = (at[row], self.derivative[row]);
            let products = [v * v, v * slope, slope * slope, v * wanted, slope * wanted];
            sums.iter_mut()
                .zip(products)
                .for_each(|(sum, one)| *sum += one);
        }
        let [vv, vs, ss, vw, sw] = sums;
        // c2/c1 of the two normal equations; their determinant cancels.
        let (first, second) = (vw * ss - sw * vs, sw * vv - vw * vs);
        if first == 0.0 { 0.0 } else { second / first }
    }

    fn relation(&self, late_s: f64) -> Relation {
        let measured = shifted(&self.measured, late_s / self.period_s);
        let mut sums = [0.0; 3];
        for row in (0..measured.len()).filter(|row| self.counts[*row]) {
            let (v, wanted) = (measured[row], self.derivative[row]);
            sums = [
                sums[0] + v * v,
                sums[1] + v * wanted,
                sums[2] + wanted * wanted,
            ];
        }
        let [vv, vw, ww] = sums;
        if vw == 0.0 {
            return Relation::default();
        }
        Relation {
            slope: vv / vw,
            late_s,
            correlation: vw / (vv * ww).sqrt(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulate::made::{record, two_sines};

    /// Two sines with positions in counts, and a velocity that is so large and so late.
    fn made(slope: f64, late_s: f64, count: f64) -> Record {
        let velocity = |t: f64| 0.06 * (3.0 * t).cos() + 0.044 * (11.0 * t).cos();
        let late = (0..6000).map(|row| slope * velocity(1.0e-3 * f64::from(row) - late_s));
        let counted = |x: f64| count * (x / count).round();
        Record {
            velocity: Some(late.collect()),
            ..record(1.0e-3, two_sines(6000).into_iter().map(counted).collect())
        }
    }

    #[test]
    fn slope_and_delay_are_found_with_their_signs_even_from_coarse_positions() {
        for (slope, late_s, count) in [
            (1.0, 0.0, 1.0e-9),
            (1.1, 0.4e-3, 1.0e-6),
            (-9.549, -2.5e-3, 1.0e-5),
            (1000.0, 30.0e-3, 1.0e-4),
        ] {
            let found = Relation::of(&made(slope, late_s, count)).unwrap();
            assert!((found.slope / slope - 1.0).abs() < 2.0e-3, "{found:?}");
            assert!((found.late_s - late_s).abs() < 5.0e-5, "{found:?}");
            assert!((found.correlation.abs() - 1.0).abs() < 1.0e-3, "{found:?}");
        }
    }

    #[test]
    fn a_velocity_of_something_else_has_no_correlation_and_one_at_rest_no_slope() {
        let with = |velocity: Vec<f64>| Record {
            velocity: Some(velocity),
            ..made(1.0, 0.0, 1.0e-7)
        };
        let other = (0..6000).map(|row| 0.05 * (0.0071 * f64::from(row)).sin());
        let other = Relation::of(&with(other.collect())).unwrap();
        assert!(other.correlation.abs() < 0.5, "{other:?}");
        assert_eq!(
            Relation::of(&with(vec![0.0; 6000])),
            Some(Relation::default())
        );
        assert_eq!(Relation::of(&record(1.0e-3, two_sines(6000))), None);
    }

    #[test]
    fn an_aligned_velocity_is_the_derivative_of_its_position() {
        let record = made(1.1, 0.4e-3, 1.0e-9);
        let velocity = record.velocity.as_deref().unwrap();
        let aligned = Relation::of(&record).unwrap().aligned(velocity, 1.0e-3);
        let exact = made(1.0, 0.0, 1.0e-9).velocity.unwrap();
        let apart = aligned[10..5990].iter().zip(&exact[10..5990]);
        let apart = apart.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(apart < 1.0e-4, "{apart}");
    }
}
