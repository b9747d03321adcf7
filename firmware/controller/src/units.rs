//! Quantities of the control law in machine units, and the only arithmetic between them.
//!
//! | quantity | unit | type | range, resolution |
//! |---|---|---|---|
//! | [`Position`] | 10 nm | `I56F8` | ±360 km, 39 pm |
//! | [`PositionError`] | 10 nm | `I24F8` | ±84 mm, 39 pm |
//! | [`Velocity`] | 10 nm per cycle | `I20F12` | ±5.2 m/s at 1 kHz, 2.4 nm/s |
//! | [`Acceleration`] | 10 nm per cycle² | `I20F12` | ±5.2 km/s² at 1 kHz, 2.4 µm/s² |
//! | [`Torque`] | µN·m | `I40F24` | ±550 kN·m |
//!
//! Every sum saturates, but for those that have room: of the law's torques, whose terms are
//! bounded, and of positions, which have 2⁶³ of 39 pm to go (a way of a cycle is 2³¹ of them at
//! most, so that takes 50 days at 84 m/s). Products of two 32-bit fixed-point numbers are taken in
//! 64 bits, where they cannot overflow, and saturate only when they are brought back to 32 bits.

use fixed::types::{I4F28, I8F24, I20F12, I24F8, I30F2, I32F32, I40F24, I56F8};

/// Position at the table.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Position(pub I56F8);

/// Setpoint − measurement, or any other difference of positions.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct PositionError(pub I24F8);

/// Velocity at the table.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Velocity(pub I20F12);

/// Acceleration at the table.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Acceleration(pub I20F12);

/// Motor torque.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Torque(pub I40F24);

/// Torque of friction, in a quarter of µN·m: ±537 N·m in 32 bits.
pub(crate) type Coarse = I30F2;

/// Velocity per position error: `1/s` times the cycle time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PositionGain(pub I8F24);

/// Torque per velocity.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct VelocityGain(pub I20F12);

/// Torque per acceleration.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct AccelerationGain(pub I24F8);

impl Position {
    /// From counts of 10 nm / 256, as the setpoint frame carries them.
    #[must_use]
    pub const fn from_fine_counts(counts: i64) -> Self {
        Self(I56F8::from_bits(counts))
    }

    /// From whole counts of 10 nm; saturates beyond ±360 km.
    #[must_use]
    pub fn from_counts(counts: i64) -> Self {
        Self(I56F8::saturating_from_num(counts))
    }

    /// `self − other` as an error.
    #[must_use]
    pub fn error_from(self, other: Self) -> PositionError {
        let way = self.0.wrapping_sub(other.0);
        PositionError(I24F8::from_bits(saturated(way.to_bits())))
    }

    /// The same where it is within the range of an error.
    #[must_use]
    pub fn exact_error_from(self, other: Self) -> Option<PositionError> {
        let way = self.0.wrapping_sub(other.0).to_bits();
        let bits = lower(way);
        (upper(way) == bits.wrapping_shr(31)).then(|| PositionError(I24F8::from_bits(bits)))
    }

    /// Way from `earlier` to `self` within one cycle.
    #[must_use]
    pub fn step_from(self, earlier: Self) -> Velocity {
        let way = self.0.wrapping_sub(earlier.0);
        Velocity(I20F12::from_bits(sixteenfold(saturated(way.to_bits()))))
    }

    /// Mean velocity since an earlier position, so many cycles ago; zero cycles count as one.
    #[must_use]
    pub fn velocity_since(self, earlier: Self, cycles: u16) -> Velocity {
        let way = self.step_from(earlier);
        Velocity(way.0.checked_div_int(i32::from(cycles)).unwrap_or(way.0))
    }

    /// The position so many counts of 10 nm beyond `self`.
    #[must_use]
    pub fn moved_by_counts(self, counts: i32) -> Self {
        let way = i64::from(counts).wrapping_shl(8);
        Self(self.0.wrapping_add(I56F8::from_bits(way)))
    }

    /// The position that far beyond `self`, for ways of any length.
    #[must_use]
    pub fn moved(self, way: Self) -> Self {
        Self(self.0.wrapping_add(way.0))
    }

    /// Where a constant velocity leads within one cycle.
    #[must_use]
    pub fn after(self, velocity: Velocity) -> Self {
        Self(self.0.wrapping_add(I56F8::wrapping_from_num(velocity.0)))
    }
}

impl PositionError {
    /// No error.
    pub const ZERO: Self = Self(I24F8::ZERO);

    /// Sum, saturated.
    #[must_use]
    pub fn plus(self, other: Self) -> Self {
        Self(self.0.saturating_add(other.0))
    }

    /// Difference, saturated.
    #[must_use]
    pub fn minus(self, other: Self) -> Self {
        Self(self.0.saturating_sub(other.0))
    }

    /// As a way within one cycle, saturated.
    #[must_use]
    pub fn in_a_cycle(self) -> Velocity {
        Velocity(I20F12::from_bits(sixteenfold(self.0.to_bits())))
    }

    /// Magnitude, saturated.
    #[must_use]
    pub fn magnitude(self) -> Self {
        Self(self.0.saturating_abs())
    }

    /// Whether it is more than a limit, either way; a negative limit counts as zero.
    #[must_use]
    pub fn is_beyond(self, limit: Self) -> bool {
        let limit = limit.0.max(I24F8::ZERO).to_bits().cast_unsigned();
        self.0.to_bits().unsigned_abs() > limit
    }
}

impl Velocity {
    /// Standstill.
    pub const ZERO: Self = Self(I20F12::ZERO);

    /// Sum, saturated.
    #[must_use]
    pub fn plus(self, other: Self) -> Self {
        Self(self.0.saturating_add(other.0))
    }

    /// Difference, saturated.
    #[must_use]
    pub fn minus(self, other: Self) -> Self {
        Self(self.0.saturating_sub(other.0))
    }

    /// The same speed the other way, saturated.
    #[must_use]
    pub fn reversed(self) -> Self {
        Self(self.0.saturating_neg())
    }

    /// So many times that, rounded down and saturated.
    #[must_use]
    pub fn scaled(self, times: I8F24) -> Self {
        Self(I20F12::from_bits(narrowed::<24>(
            self.0.wide_mul(times).to_bits(),
        )))
    }

    /// How many times a way it is, with one over that way, rounded down and saturated.
    pub(crate) fn over(self, per_way: I8F24) -> I8F24 {
        // 20.12 times 8.24 bits: 28.36 bits.
        I8F24::from_bits(narrowed::<12>(self.0.wide_mul(per_way).to_bits()))
    }

    /// Its size in one instruction: a negative one is 2⁻¹² smaller than it is.
    pub(crate) fn size(self) -> Self {
        let bits = self.0.to_bits();
        Self(I20F12::from_bits(bits ^ bits.wrapping_shr(31)))
    }

    /// Half of it, rounded down.
    #[must_use]
    pub fn halved(self) -> Self {
        Self(I20F12::from_bits(self.0.to_bits().wrapping_shr(1)))
    }

    /// Change within one cycle.
    #[must_use]
    pub fn step_from(self, earlier: Self) -> Acceleration {
        Acceleration(self.0.saturating_sub(earlier.0))
    }

    /// Way within one cycle; loses the 4 bits below 39 pm.
    #[must_use]
    pub fn way_lossy(self) -> PositionError {
        PositionError(I24F8::wrapping_from_num(self.0))
    }

    /// Whether it is faster than a limit, either way.
    #[must_use]
    pub fn is_beyond(self, limit: Self) -> bool {
        self.0.saturating_abs() > limit.0
    }

    /// `self` limited to `±limit`; a negative limit counts as zero.
    #[must_use]
    pub fn limited(self, limit: Self) -> Self {
        let limit = limit.0.max(I20F12::ZERO);
        Self(self.0.min(limit).max(limit.saturating_neg()))
    }
}

impl Torque {
    /// No torque.
    pub const ZERO: Self = Self(I40F24::ZERO);

    /// From whole µN·m.
    #[must_use]
    pub fn from_micro_nm(torque: i32) -> Self {
        Self(I40F24::from_num(torque))
    }

    /// To whole µN·m, rounded to nearest and saturated.
    #[must_use]
    pub fn to_micro_nm_lossy(self) -> i32 {
        let bits = self.0.to_bits();
        narrowed::<24>(bits.saturating_add(half(bits)))
    }

    /// The same of a torque of the law, which has room ([`Self::with`]).
    pub(crate) fn nearest_micro_nm(self) -> i32 {
        let bits = self.0.to_bits();
        narrowed::<24>(bits.wrapping_add(half(bits)))
    }

    /// Sum, saturated.
    #[must_use]
    pub fn plus(self, other: Self) -> Self {
        Self(self.0.saturating_add(other.0))
    }

    /// Sum of torques of the law, which has room: a gain times a velocity is 2⁶² of the last bits
    /// at most, a gain times an acceleration 2⁶¹, everything else below 2⁵⁷.
    pub(crate) fn with(self, other: Self) -> Self {
        Self(self.0.wrapping_add(other.0))
    }

    /// Difference, saturated.
    #[must_use]
    pub fn minus(self, other: Self) -> Self {
        Self(self.0.saturating_sub(other.0))
    }

    /// The same torque the other way, saturated.
    #[must_use]
    pub fn reversed(self) -> Self {
        Self(self.0.saturating_neg())
    }
}

/// Largest torque either way, in whole µN·m: at most [`Self::LARGEST_MICRO_NM`], never negative.
/// What a cycle needs of it is made once.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TorqueLimit {
    micro_nm: i32,
    high: Torque,
    low: Torque,
}

impl TorqueLimit {
    /// The largest limit that the drive takes: 250 N·m, below 2²⁸.
    pub const LARGEST_MICRO_NM: i32 = 250_000_000;

    /// From µN·m; what is negative counts as zero, what is larger as the largest.
    #[must_use]
    pub fn from_micro_nm(limit: i32) -> Self {
        let micro_nm = limit.clamp(0, Self::LARGEST_MICRO_NM);
        Self {
            micro_nm,
            high: Torque::from_micro_nm(micro_nm),
            low: Torque::from_micro_nm(micro_nm.saturating_neg()),
        }
    }

    /// In µN·m.
    #[must_use]
    pub const fn micro_nm(self) -> i32 {
        self.micro_nm
    }

    /// A torque brought within it.
    #[must_use]
    pub fn cut(self, torque: Torque) -> Torque {
        torque.min(self.high).max(self.low)
    }

    /// Whole µN·m brought within it.
    pub(crate) fn cut_micro_nm(self, micro_nm: i32) -> i32 {
        micro_nm
            .min(self.micro_nm)
            .max(self.micro_nm.wrapping_neg())
    }

    /// Whether neither a command is at the limit nor a torque that is wanted beyond it.
    pub(crate) fn passes(self, commanded_micro_nm: i32, wanted_micro_nm: i32) -> bool {
        let limit = self.micro_nm.cast_unsigned();
        commanded_micro_nm.unsigned_abs() < limit && wanted_micro_nm.unsigned_abs() <= limit
    }

    /// Whether a command is at the limit, or a torque that is wanted beyond it: above, below.
    pub(crate) fn stops(self, commanded_micro_nm: i32, wanted_micro_nm: i32) -> (bool, bool) {
        let low = self.micro_nm.wrapping_neg();
        (
            commanded_micro_nm >= self.micro_nm || wanted_micro_nm > self.micro_nm,
            commanded_micro_nm <= low || wanted_micro_nm < low,
        )
    }
}

/// Half of 2⁻¹².
const HALF: I32F32 = I32F32::from_bits(1 << 19);

impl PositionGain {
    /// Gain · error, saturated.
    #[must_use]
    pub fn times(self, error: PositionError) -> Velocity {
        // 8.24 times 24.8 bits: 32.32 bits, exact, below 2⁶²; brought to 12 fractional bits by
        // rounding to nearest, since rounding down would be a bias that the velocity loop
        // integrates.
        let product = self.0.wide_mul(error.0).wrapping_add(HALF);
        Velocity(I20F12::from_bits(narrowed::<20>(product.to_bits())))
    }
}

impl VelocityGain {
    /// Sum, saturated.
    #[must_use]
    pub fn plus(self, other: Self) -> Self {
        Self(self.0.saturating_add(other.0))
    }

    /// Difference, saturated.
    #[must_use]
    pub fn minus(self, other: Self) -> Self {
        Self(self.0.saturating_sub(other.0))
    }

    /// Gain · velocity, exact.
    #[must_use]
    pub fn times(self, velocity: Velocity) -> Torque {
        // 20.12 times 20.12 bits: 40.24 bits, exact.
        Torque(self.0.wide_mul(velocity.0))
    }

    /// The same as friction has it, saturated.
    pub(crate) fn coarse(self, velocity: Velocity) -> Coarse {
        Coarse::from_bits(narrowed::<22>(self.times(velocity).0.to_bits()))
    }
}

impl AccelerationGain {
    /// Gain · acceleration, saturated at a quarter of the range of a torque.
    #[must_use]
    pub fn times(self, acceleration: Acceleration) -> Torque {
        // 24.8 times 20.12 bits: 44.20 bits, exact; brought to 40.24.
        let product = self.0.wide_mul(acceleration.0).to_bits();
        Torque(I40F24::from_bits(raised::<4>(product)))
    }

    /// The same as friction has it, saturated.
    pub(crate) fn coarse(self, acceleration: Acceleration) -> Coarse {
        let product = self.0.wide_mul(acceleration.0).to_bits();
        Coarse::from_bits(narrowed::<18>(product))
    }
}

/// A way per torque times a torque, rounded down and saturated.
pub(crate) fn way_by(per_torque: I4F28, torque: Coarse) -> Velocity {
    // 4.28 times 30.2 bits are 34.30 bits, of which 12 fractional ones stay.
    let product = per_torque.wide_mul(torque).to_bits();
    Velocity(I20F12::from_bits(narrowed::<18>(product)))
}

/// A product without its last 1 to 31 bits, rounded down and saturated: what the fixed crate's
/// saturating conversion gives, in half the instructions on a Cortex-M4, where the upper word alone
/// tells whether it fits.
pub(crate) fn narrowed<const BITS: u32>(product: i64) -> i32 {
    let upper = upper(product);
    let off = upper.wrapping_add(1_i32.wrapping_shl(BITS.wrapping_sub(1)));
    if off.cast_unsigned() < 1_u32.wrapping_shl(BITS) {
        lower(product.wrapping_shr(BITS))
    } else {
        upper.wrapping_shr(31) ^ i32::MAX
    }
}

/// A product with so many bits more below, saturated at a quarter of the range.
fn raised<const BITS: u32>(product: i64) -> i64 {
    let upper = upper(product);
    let off = upper.wrapping_add(1_i32.wrapping_shl(29_u32.wrapping_sub(BITS)));
    if off.cast_unsigned() < 1_u32.wrapping_shl(30_u32.wrapping_sub(BITS)) {
        product.wrapping_shl(BITS)
    } else {
        i64::from(upper.wrapping_shr(31)) ^ i64::MAX.wrapping_shr(2)
    }
}

/// As near as 32 bits come to it.
fn saturated(wide: i64) -> i32 {
    let (upper, lower) = (upper(wide), lower(wide));
    if upper == lower.wrapping_shr(31) {
        lower
    } else {
        upper.wrapping_shr(31) ^ i32::MAX
    }
}

/// Sixteen times that, saturated: from 8 to 12 fractional bits.
pub(crate) const fn sixteenfold(value: i32) -> i32 {
    let twofold = value.saturating_add(value);
    let fourfold = twofold.saturating_add(twofold);
    let eightfold = fourfold.saturating_add(fourfold);
    eightfold.saturating_add(eightfold)
}

/// Half of what 24 bits make: rounding down with it is to nearest, and what is amid two goes away
/// from zero.
const fn half(bits: i64) -> i64 {
    (1_i64 << 23).wrapping_add(bits.wrapping_shr(63))
}

#[expect(clippy::as_conversions, reason = "the upper word of two")]
pub(crate) const fn upper(wide: i64) -> i32 {
    (wide >> 32) as i32
}

#[expect(
    clippy::as_conversions,
    clippy::cast_possible_truncation,
    reason = "the lower word of two"
)]
pub(crate) const fn lower(wide: i64) -> i32 {
    wide as i32
}

/// Way per encoder increment, 10 nm with 32 fractional bits (never negative: the encoder's sense is
/// the plant's business).
///
/// At most 2⁻³² of 10 nm off per increment: 5 nm over the whole 31 bits of an encoder.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct WayPerIncrement {
    /// Whole 10 nm.
    pub whole: u16,
    /// 2⁻³² of 10 nm.
    pub fraction: u32,
}

impl WayPerIncrement {
    /// Position of an encoder count.
    #[must_use]
    pub const fn times(self, increments: i32) -> Position {
        let increments = widen(increments);
        // |increments| ≤ 2³¹: times whole (16 bits) below 2⁴⁷ and shifted by 8 below 2⁵⁵; times
        // fraction at most 2³¹ (2³² − 1), below 2⁶³. The sum stays below 2⁵⁶: nothing here wraps.
        let whole = increments
            .wrapping_mul(widen_u16(self.whole))
            .wrapping_shl(8);
        let fraction = increments
            .wrapping_mul(widen_u32(self.fraction))
            .wrapping_shr(24);
        Position(I56F8::from_bits(whole.wrapping_add(fraction)))
    }
}

#[expect(clippy::as_conversions, reason = "lossless; From is not const")]
const fn widen(value: i32) -> i64 {
    value as i64
}

#[expect(clippy::as_conversions, reason = "lossless; From is not const")]
const fn widen_u16(value: u16) -> i64 {
    value as i64
}

#[expect(clippy::as_conversions, reason = "lossless; From is not const")]
const fn widen_u32(value: u32) -> i64 {
    value as i64
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn the_way_of_an_encoder_count_is_exact_to_five_nanometres(
            increments in any::<i32>(), whole in 0_u16..300, fraction in any::<u32>(),
        ) {
            let way = WayPerIncrement { whole, fraction };
            let exact = f64::from(increments) * (f64::from(whole) + f64::from(fraction) / 4_294_967_296.0);
            let got: f64 = way.times(increments).0.to_num();
            // The result is rounded down to 2⁻⁸ of 10 nm; f64 itself is good to 2⁻¹³ here.
            prop_assert!((got - exact).abs() < 0.005, "{got} {exact}");
        }

        #[test]
        fn a_product_is_narrowed_as_the_fixed_crate_does(one in any::<i32>(), other in any::<i32>(), small in 0_u32..32) {
            let product = I8F24::from_bits(one.wrapping_shr(small)).wide_mul(I20F12::from_bits(other));
            prop_assert_eq!(narrowed::<24>(product.to_bits()), I20F12::saturating_from_num(product).to_bits());
            prop_assert_eq!(narrowed::<12>(product.to_bits()), I8F24::saturating_from_num(product).to_bits());
        }

        #[test]
        fn what_is_brought_to_other_bits_is_as_the_fixed_crate_brings_it(
            wide in any::<i64>(), value in any::<i32>(), small in 0_u32..64,
        ) {
            let wide = wide.wrapping_shr(small);
            let torque = I40F24::from_bits(wide);
            prop_assert_eq!(Torque(torque).to_micro_nm_lossy(), torque.saturating_round().saturating_to_num::<i32>());
            let position = Position::from_fine_counts(wide);
            let zero = Position::default();
            prop_assert_eq!(position.step_from(zero).0, I20F12::saturating_from_num(position.0));
            prop_assert_eq!(position.error_from(zero).0, I24F8::saturating_from_num(position.0));
            let way = I24F8::from_bits(value.wrapping_shr(small));
            prop_assert_eq!(sixteenfold(way.to_bits()), I20F12::saturating_from_num(way).to_bits());
            let product = fixed::types::I44F20::from_bits(wide);
            let quarter = 1_i64 << 61;
            let raised_product = I40F24::saturating_from_num(product).to_bits().clamp(-quarter, quarter - 1);
            prop_assert_eq!(raised::<4>(wide), raised_product);
        }

        #[test]
        fn a_cut_torque_is_rounded_as_the_fixed_crate_does(wide in any::<i64>(), small in 0_u32..64, limit in any::<i32>()) {
            let torque = Torque(I40F24::from_bits(wide.wrapping_shr(small)));
            let limit = TorqueLimit::from_micro_nm(limit);
            let within = I40F24::from_num(limit.micro_nm());
            prop_assert!((0..=TorqueLimit::LARGEST_MICRO_NM).contains(&limit.micro_nm()));
            let cut = torque.0.clamp(-within, within);
            prop_assert_eq!(limit.cut(torque).0, cut);
            if wide.wrapping_shr(small).unsigned_abs() < 7 << 60 {
                let nearest = torque.nearest_micro_nm();
                prop_assert_eq!(nearest, torque.to_micro_nm_lossy());
                prop_assert_eq!(limit.cut_micro_nm(nearest), cut.round().to_num::<i32>());
            }
        }

        #[test]
        fn gains_saturate_and_never_wrap(gain in any::<i32>(), value in any::<i32>()) {
            let exact = f64::from(gain) * f64::from(value);
            let velocity = PositionGain(I8F24::from_bits(gain)).times(PositionError(I24F8::from_bits(value)));
            let wanted = (exact / 2_f64.powi(32)).clamp(-524_288.0, 524_288.0);
            prop_assert!((velocity.0.to_num::<f64>() - wanted).abs() <= 1.0 / 4096.0);
            let torque = AccelerationGain(I24F8::from_bits(gain)).times(Acceleration(I20F12::from_bits(value)));
            let wanted = (exact / 2_f64.powi(20)).clamp(-2_f64.powi(37), 2_f64.powi(37));
            prop_assert!((torque.0.to_num::<f64>() - wanted).abs() <= wanted.abs() * 1e-15);
        }
    }
}
