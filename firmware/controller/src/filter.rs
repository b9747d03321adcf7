//! Optional second-order filter on the torque command: low-pass or notch.
//!
//! `y0 = b0 x0 + b1 x1 + b2 x2 + a1 y1 + a2 y2` (a's with the sign of this equation), direct form
//! 1, coefficients in Q29 computed on the host. What rounding cuts off is carried into the next
//! cycle (first-order error feedback), so that the gain at rest is exact and small torques do not
//! stick. Headroom: inputs and outputs stay within [`TorqueLimit::LARGEST_MICRO_NM`] < 2²⁸, and
//! [`FilterConfig::new`] takes no set whose magnitudes add up to more than 7 < 2³, so the
//! accumulator stays below 2⁶⁰.

use crate::units::{Torque, TorqueLimit, narrowed};

/// Fractional bits of a coefficient.
pub const COEFFICIENT_FRACTION_BITS: u32 = 29;

/// Coefficients of the filter: `[b0, b1, b2, a1, a2]` in Q29.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FilterConfig {
    coefficients: [i32; 5],
    /// It passes the torque through.
    is_off: bool,
}

const THROUGH: [i32; 5] = [1 << COEFFICIENT_FRACTION_BITS, 0, 0, 0, 0];

/// Why coefficients are no filter that the drive can run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FilterError {
    /// They add up to more than the headroom.
    TooLarge {
        /// Sum of the magnitudes, in Q29.
        sum: u64,
    },
    /// A pole lies on or outside the unit circle.
    Unstable {
        /// Coefficient of the last output, in Q29.
        a1: i32,
        /// Coefficient of the output before it, in Q29.
        a2: i32,
    },
}

impl FilterConfig {
    /// Passes the torque through.
    pub const OFF: Self = Self {
        coefficients: THROUGH,
        is_off: true,
    };

    /// `[b0, b1, b2, a1, a2]` in Q29.
    ///
    /// # Errors
    /// [`FilterError`]: a sum of magnitudes above 7, or a filter that does not decay.
    pub fn new(coefficients: [i32; 5]) -> Result<Self, FilterError> {
        let sum = coefficients.iter().fold(0_u64, |sum, c| {
            sum.saturating_add(u64::from(c.unsigned_abs()))
        });
        if sum > 7 << COEFFICIENT_FRACTION_BITS {
            return Err(FilterError::TooLarge { sum });
        }
        let [_, _, _, a1, a2] = coefficients;
        if !decays(a1, a2) {
            return Err(FilterError::Unstable { a1, a2 });
        }
        Ok(Self {
            coefficients,
            is_off: coefficients == THROUGH,
        })
    }
}

/// Jury's criterion for the denominator z² − a1 z − a2: positive at z = 1 and, for the second
/// order, at z = −1, and the product of the poles, −a2, inside the circle. 1 − a1 − a2 > 0 and 1 +
/// a1 − a2 > 0 make |a1| < 1 − a2. In integers, exact.
fn decays(a1: i32, a2: i32) -> bool {
    let one = 1_i64 << COEFFICIENT_FRACTION_BITS;
    let [a1, a2] = [a1, a2].map(i64::from);
    a2.saturating_abs() < one && a1.saturating_abs() < one.saturating_sub(a2)
}

/// Memory of the filter: `[x1, x2, y1, y2]` in µN·m, and what rounding cut off.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FilterState {
    past: [i32; 4],
    rest: i64,
}

impl FilterState {
    /// As after a long time with one torque.
    #[must_use]
    pub fn at_rest(torque: Torque) -> Self {
        Self {
            past: [torque.to_micro_nm_lossy(); 4],
            rest: 0,
        }
    }

    /// Filters one torque in whole µN·m, cut to a limit before and after.
    pub fn step(&mut self, config: &FilterConfig, micro_nm: i32, limit: TorqueLimit) -> i32 {
        let x0 = limit.cut_micro_nm(micro_nm);
        let [x1, x2, y1, y2] = self.past;
        if config.is_off {
            // What the sum below comes to.
            self.past = [x0, x1, x0, y1];
            return x0;
        }
        let products = config.coefficients.into_iter().zip([x0, x1, x2, y1, y2]);
        // 32 times 32 bits in 64 cannot wrap, and the sum has the headroom above.
        let sum = products.fold(self.rest, |sum, (c, v)| {
            sum.wrapping_add(i64::from(c).wrapping_mul(i64::from(v)))
        });
        let y0 = limit.cut_micro_nm(narrowed::<COEFFICIENT_FRACTION_BITS>(sum));
        self.rest = sum & REST_MASK;
        self.past = [x0, x1, y0, y1];
        y0
    }
}

const REST_MASK: i64 = (1 << COEFFICIENT_FRACTION_BITS) - 1;

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn off_passes_every_torque_within_the_limit() {
        let mut state = FilterState::default();
        let limit = TorqueLimit::from_micro_nm(1_000_000);
        for torque in [0, 1, -1, 999_999, -1_000_000] {
            let out = state.step(&FilterConfig::OFF, torque, limit);
            assert_eq!(out, torque);
        }
        let beyond = state.step(&FilterConfig::OFF, 2_000_000, limit);
        assert_eq!(beyond, 1_000_000);
    }

    #[test]
    fn a_one_pole_low_pass_has_gain_one_at_rest() {
        // y += 0.25 (x − y), in Q29.
        let config = FilterConfig::new([1 << 27, 0, 0, 3 << 27, 0]).unwrap();
        let mut state = FilterState::default();
        let limit = TorqueLimit::from_micro_nm(TorqueLimit::LARGEST_MICRO_NM);
        let mut out = 0;
        (0..100).for_each(|_| out = state.step(&config, 1_000_000, limit));
        assert!((out - 1_000_000).abs() <= 1);
    }

    #[test]
    fn coefficients_beyond_the_headroom_are_refused() {
        let result = FilterConfig::new([i32::MAX, i32::MAX, 0, 0, 0]);
        assert_eq!(
            result,
            Err(FilterError::TooLarge {
                sum: 2 * u64::from(i32::MAX.unsigned_abs())
            })
        );
    }

    /// 1 in Q29.
    const ONE: i32 = 1 << COEFFICIENT_FRACTION_BITS;

    fn q29(a: f64) -> i32 {
        fixed::types::I3F29::from_num(a).to_bits()
    }

    #[test]
    fn a_pole_at_1_2_is_refused() {
        // (1 − 1.2 z⁻¹)(1 − 0.5 z⁻¹): a1 = 1.7, a2 = −0.6.
        let [a1, a2] = [1.7, -0.6].map(q29);
        assert_eq!(
            FilterConfig::new([ONE, 0, 0, a1, a2]),
            Err(FilterError::Unstable { a1, a2 })
        );
    }

    #[test]
    fn the_stability_bound_is_exact_to_the_bit() {
        for (a1, a2, stable) in [
            (ONE - 1, 0, true),
            (ONE, 0, false),
            (-ONE + 1, 0, true),
            (-ONE, 0, false),
            (0, -ONE + 1, true),
            (0, -ONE, false),
            (0, ONE - 1, true),
            (0, ONE, false),
            (ONE / 2 - 1, ONE / 2, true),
            (ONE / 2, ONE / 2, false),
        ] {
            assert_eq!(
                FilterConfig::new([ONE, 0, 0, a1, a2]).is_ok(),
                stable,
                "{a1} {a2}"
            );
        }
    }

    proptest! {
        /// The larger pole of z² − a1 z − a2, in f64.
        #[test]
        fn jurys_criterion_is_that_of_the_poles(a1 in -3.0_f64..3.0, a2 in -1.5_f64..1.5) {
            let root = a1 * a1 / 4.0 + a2;
            let largest = if root < 0.0 { (-a2).sqrt() } else { a1.abs() / 2.0 + root.sqrt() };
            prop_assume!((largest - 1.0).abs() > 1e-6);
            prop_assert_eq!(decays(q29(a1), q29(a2)), largest < 1.0);
        }
    }
}
