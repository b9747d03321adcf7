//! LSB weights: what one count on the wire is worth.
//!
//! Each quantity on the wire is a type with its weight beside it, so that a count cannot be taken
//! for another. Weights are decimal, `mantissa · 10^exponent`, because the cores carry no float and
//! the DBC wants decimals.

use core::fmt;

/// What one count is worth: `mantissa · 10^exponent` of `unit`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Weight {
    /// Decimal mantissa.
    pub mantissa: u32,
    /// Power of ten.
    pub exponent: i8,
    /// Unit after scaling, as in the DBC.
    pub unit: &'static str,
}

impl Weight {
    /// A count that is just a number.
    pub const ONE: Self = Self {
        mantissa: 1,
        exponent: 0,
        unit: "",
    };

    const fn new(mantissa: u32, exponent: i8, unit: &'static str) -> Self {
        Self {
            mantissa,
            exponent,
            unit,
        }
    }
}

impl fmt::Display for Weight {
    /// As a DBC factor: `1`, `1e-08`, `390625e-16`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.exponent == 0 {
            write!(f, "{}", self.mantissa)
        } else {
            write!(f, "{}E{}", self.mantissa, self.exponent)
        }
    }
}

/// Motor position, in increments of the motor encoder (object 608Fh tells how many make a
/// revolution).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Default)]
pub struct MotorIncrements(pub i32);

impl MotorIncrements {
    /// One increment.
    pub const WEIGHT: Weight = Weight::new(1, 0, "inc");
}

/// Load position modulo 2^24 increments of 10 nm (0.168 m); the receiver unwraps it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub struct LoadIncrements24(u32);

impl LoadIncrements24 {
    /// 10 nm.
    pub const WEIGHT: Weight = Weight::new(1, -8, "m");
    const MASK: u32 = 0x00FF_FFFF;
    const HALF: u32 = 0x0080_0000;

    /// The low 24 bits of a load position in 10 nm.
    #[must_use]
    pub fn from_counts(counts: i64) -> Self {
        let [a, b, c, ..] = counts.to_le_bytes();
        Self(u32::from_le_bytes([a, b, c, 0]))
    }

    /// The raw 24 bits.
    #[must_use]
    pub const fn bits(self) -> u32 {
        self.0
    }

    /// The signed way from `self` to `later`, in 10 nm, right while the axis moves less than 84 mm
    /// between the two.
    #[must_use]
    pub const fn step_to(self, later: Self) -> i32 {
        let forward = later.0.wrapping_sub(self.0) & Self::MASK;
        if forward >= Self::HALF {
            forward.cast_signed().wrapping_sub(0x0100_0000)
        } else {
            forward.cast_signed()
        }
    }
}

/// Position setpoint, INTEGER40 in 10 nm / 256: fine enough that its second difference carries the
/// acceleration of a slow circle (10 nm at 1 ms would resolve 10 mm/s²; R 100 mm at F 500 mm/min
/// needs 0.7 mm/s²).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Default)]
pub struct SetpointFine(i64);

impl SetpointFine {
    /// 10 nm / 256 = 3.90625·10⁻¹¹ m.
    pub const WEIGHT: Weight = Weight::new(390_625, -16, "m");
    /// Largest magnitude of an INTEGER40.
    pub const LIMIT: i64 = (1 << 39) - 1;

    /// A setpoint, saturated at ±[`Self::LIMIT`] (21.5 m).
    #[must_use]
    pub const fn saturating(counts: i64) -> Self {
        if counts > Self::LIMIT {
            Self(Self::LIMIT)
        } else if counts < -Self::LIMIT {
            Self(-Self::LIMIT)
        } else {
            Self(counts)
        }
    }

    /// Counts of 10 nm / 256.
    #[must_use]
    pub const fn counts(self) -> i64 {
        self.0
    }

    pub(crate) const fn to_bytes(self) -> [u8; 5] {
        let [a, b, c, d, e, ..] = self.0.to_le_bytes();
        [a, b, c, d, e]
    }

    pub(crate) const fn from_bytes([a, b, c, d, e]: [u8; 5]) -> Self {
        let sign = if e & 0x80 == 0 { 0x00 } else { 0xFF };
        Self(i64::from_le_bytes([a, b, c, d, e, sign, sign, sign]))
    }
}

/// Motor torque in µN·m: ±2147 N·m.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Default)]
pub struct TorqueMicroNm(pub i32);

impl TorqueMicroNm {
    /// 1 µN·m.
    pub const WEIGHT: Weight = Weight::new(1, -6, "Nm");
}

/// Following error, INTEGER24 in 10 nm, saturated at ±84 mm.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Default)]
pub struct FollowingError24(i32);

impl FollowingError24 {
    /// 10 nm.
    pub const WEIGHT: Weight = Weight::new(1, -8, "m");
    const LIMIT: i32 = 0x007F_FFFF;

    /// A following error, saturated at the 24 bits of the status frame.
    #[must_use]
    pub const fn saturating(counts: i32) -> Self {
        if counts > Self::LIMIT {
            Self(Self::LIMIT)
        } else if counts < -Self::LIMIT {
            Self(-Self::LIMIT)
        } else {
            Self(counts)
        }
    }

    /// Counts of 10 nm.
    #[must_use]
    pub const fn counts(self) -> i32 {
        self.0
    }

    pub(crate) const fn to_bytes(self) -> [u8; 3] {
        let [a, b, c, _] = self.0.to_le_bytes();
        [a, b, c]
    }

    pub(crate) const fn from_bytes([a, b, c]: [u8; 3]) -> Self {
        Self(i32::from_le_bytes([
            a,
            b,
            c,
            if c & 0x80 == 0 { 0x00 } else { 0xFF },
        ]))
    }
}

/// Torque in per mille of rated torque, as object 6077h.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Default)]
pub struct TorquePerMille(pub i16);

impl TorquePerMille {
    /// 0.1 % of rated torque (object 6076h).
    pub const WEIGHT: Weight = Weight::new(1, -3, "rated");
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn the_receiver_unwraps_any_step_below_half_the_range(start in any::<i32>(), step in -8_388_607_i32..8_388_607) {
            let before = LoadIncrements24::from_counts(i64::from(start));
            let after = LoadIncrements24::from_counts(i64::from(start) + i64::from(step));
            prop_assert_eq!(before.step_to(after), step);
        }

        #[test]
        fn a_setpoint_survives_its_forty_bits(counts in -SetpointFine::LIMIT..=SetpointFine::LIMIT) {
            let setpoint = SetpointFine::saturating(counts);
            prop_assert_eq!(SetpointFine::from_bytes(setpoint.to_bytes()), setpoint);
        }

        #[test]
        fn a_following_error_survives_its_twenty_four_bits(counts in any::<i32>()) {
            let error = FollowingError24::saturating(counts);
            prop_assert_eq!(FollowingError24::from_bytes(error.to_bytes()), error);
        }
    }

    #[test]
    fn the_second_difference_of_the_setpoint_resolves_a_slow_circle() {
        // R 100 mm at F 500 mm/min turns with 0.694 mm/s²; one count of second difference at 1 ms
        // is 0.039 mm/s².
        let lsb_um_per_s2 = 390_625_u64 * 1_000_000 * 1_000_000 / 10_000_000_000_000_000;
        assert_eq!(lsb_um_per_s2, 39);
    }
}
