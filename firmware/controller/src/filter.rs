//! Optional second-order filter on the torque command: low-pass or notch.
//!
//! `y0 = b0 x0 + b1 x1 + b2 x2 + a1 y1 + a2 y2` (a's with the sign of this equation), direct form 1, coefficients in Q29 computed on the host. What rounding
//! cuts off is carried into the next cycle (first-order error feedback), so that the gain at rest is exact and small torques do not stick.
//! Headroom: inputs and outputs stay within [`TORQUE_LIMIT_MICRO_NM`] < 2²⁸, and [`FilterConfig::new`] takes no set whose magnitudes add up to more than
//! 7 < 2³, so the accumulator stays below 2⁶⁰.

use crate::units::Torque;

/// Largest torque limit that the drive takes: 250 N·m.
pub const TORQUE_LIMIT_MICRO_NM: i32 = 250_000_000;

/// Fractional bits of a coefficient.
pub const COEFFICIENT_FRACTION_BITS: u32 = 29;

/// Coefficients of the filter: `[b0, b1, b2, a1, a2]` in Q29.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FilterConfig([i32; 5]);

/// The coefficients add up to more than the headroom of the filter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CoefficientsTooLarge {
    /// Sum of the magnitudes, in Q29.
    pub sum: u64,
}

impl FilterConfig {
    /// Passes the torque through.
    pub const OFF: Self = Self([1 << COEFFICIENT_FRACTION_BITS, 0, 0, 0, 0]);

    /// `[b0, b1, b2, a1, a2]` in Q29.
    ///
    /// # Errors
    /// [`CoefficientsTooLarge`] above a sum of magnitudes of 7.
    pub fn new(coefficients: [i32; 5]) -> Result<Self, CoefficientsTooLarge> {
        let sum = coefficients.iter().fold(0_u64, |sum, c| sum.saturating_add(u64::from(c.unsigned_abs())));
        if sum > 7 << COEFFICIENT_FRACTION_BITS {
            return Err(CoefficientsTooLarge { sum });
        }
        Ok(Self(coefficients))
    }
}

/// Memory of the filter: `[x1, x2, y1, y2]` in µN·m, and what rounding cut off.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FilterState {
    past: [i32; 4],
    rest: i64,
}

impl FilterState {
    /// Filters one torque; both sides within `±limit`.
    pub fn step(&mut self, config: &FilterConfig, torque: Torque, limit: Torque) -> Torque {
        let limit = limit.to_micro_nm_lossy().clamp(0, TORQUE_LIMIT_MICRO_NM);
        let x0 = torque.to_micro_nm_lossy().max(limit.saturating_neg()).min(limit);
        let [x1, x2, y1, y2] = self.past;
        let products = config.0.into_iter().zip([x0, x1, x2, y1, y2]);
        // 32 times 32 bits in 64 cannot wrap; the sum has the headroom above and saturates all the same.
        let sum = products.fold(self.rest, |sum, (c, v)| sum.saturating_add(i64::from(c).wrapping_mul(i64::from(v))));
        let whole = i32::try_from(sum.wrapping_shr(COEFFICIENT_FRACTION_BITS)).unwrap_or(if sum < 0 {
            i32::MIN
        } else {
            i32::MAX
        });
        let y0 = whole.max(limit.saturating_neg()).min(limit);
        self.rest = sum & REST_MASK;
        self.past = [x0, x1, y0, y1];
        Torque::from_micro_nm(y0)
    }
}

const REST_MASK: i64 = (1 << COEFFICIENT_FRACTION_BITS) - 1;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn off_passes_every_torque_within_the_limit() {
        let mut state = FilterState::default();
        let limit = Torque::from_micro_nm(1_000_000);
        for torque in [0, 1, -1, 999_999, -1_000_000] {
            let out = state.step(&FilterConfig::OFF, Torque::from_micro_nm(torque), limit);
            assert_eq!(out.to_micro_nm_lossy(), torque);
        }
        assert_eq!(state.step(&FilterConfig::OFF, Torque::from_micro_nm(2_000_000), limit), limit);
    }

    #[test]
    fn a_one_pole_low_pass_has_gain_one_at_rest() {
        // y += 0.25 (x − y), in Q29.
        let config = FilterConfig::new([1 << 27, 0, 0, 3 << 27, 0]).unwrap();
        let (mut state, limit) = (FilterState::default(), Torque::from_micro_nm(TORQUE_LIMIT_MICRO_NM));
        let mut out = Torque::ZERO;
        (0..100).for_each(|_| out = state.step(&config, Torque::from_micro_nm(1_000_000), limit));
        assert!((out.to_micro_nm_lossy() - 1_000_000).abs() <= 1);
    }

    #[test]
    fn coefficients_beyond_the_headroom_are_refused() {
        assert!(FilterConfig::new([i32::MAX, i32::MAX, 0, 0, 0]).is_err());
    }
}
