//! Arithmetic from physical units to machine units: exact fractions, rounded once, and the exponential.
//!
//! It runs when a parameter set is committed, in the SDO event, never in the control cycle. There are no floats, and no 64-bit division of the
//! compiler's library either: quotients are made digit by digit, one digit for each bit of the result (at most 64 for a machine number).
//!
//! | what | error |
//! |---|---|
//! | [`Fraction::nearest`] | half a unit of the result |
//! | [`Fraction::up`] | exact, rounded up |
//! | [`decay`] | 2⁻³⁰, one unit of the result |

/// The product of some numbers, over the product of others.
///
/// The callers keep both products below 2¹²⁸; beyond that they have no value, and neither has the fraction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fraction {
    numerator: u128,
    denominator: u128,
}

/// What a division leaves.
struct Quotient {
    whole: u128,
    rest: u128,
}

impl Fraction {
    /// The fraction; `None` where a product does not fit 128 bits or the denominator is zero.
    #[must_use]
    pub fn new(numerator: &[u64], denominator: &[u64]) -> Option<Self> {
        let fraction = Self { numerator: product(numerator)?, denominator: product(denominator)? };
        (fraction.denominator > 0).then_some(fraction)
    }

    /// Rounded to nearest, halves up; `None` where it does not fit.
    #[must_use]
    pub fn nearest(self) -> Option<u64> {
        let Quotient { whole, rest } = self.divided();
        let up = rest >= self.denominator.saturating_sub(rest);
        u64::try_from(whole.checked_add(u128::from(up))?).ok()
    }

    /// Rounded up; `None` where it does not fit.
    #[must_use]
    pub fn up(self) -> Option<u64> {
        let Quotient { whole, rest } = self.divided();
        u64::try_from(whole.checked_add(u128::from(rest > 0))?).ok()
    }

    /// The quotient where the division leaves no rest.
    #[must_use]
    pub fn exact(self) -> Option<u64> {
        let Quotient { whole, rest } = self.divided();
        if rest == 0 { u64::try_from(whole).ok() } else { None }
    }

    /// Long division: the denominator is shifted until its highest digit meets that of the numerator, and comes back digit by digit.
    fn divided(self) -> Quotient {
        let (mut rest, mut whole) = (self.numerator, 0_u128);
        let Some(digits) = self.denominator.leading_zeros().checked_sub(rest.leading_zeros()) else {
            return Quotient { whole, rest };
        };
        let mut part = self.denominator.wrapping_shl(digits);
        for _ in 0..=digits {
            whole = whole.wrapping_shl(1);
            if let Some(left) = rest.checked_sub(part) {
                rest = left;
                whole |= 1;
            }
            part = part.wrapping_shr(1);
        }
        Quotient { whole, rest }
    }
}

fn product(factors: &[u64]) -> Option<u128> {
    factors.iter().try_fold(1_u128, |product, factor| product.checked_mul(u128::from(*factor)))
}

/// One in the exponential's own format, 32 fractional bits.
const ONE: u64 = 1 << 32;
/// ln 2, 32 fractional bits.
const LN_2: u64 = 2_977_044_472;
/// Beyond this exponent the result is zero in 30 fractional bits: ln 2³¹ = 21.49.
const LARGEST: u64 = 22 << 32;
/// 1/13 to 1/1 with 32 fractional bits. The series ends there: 0.69¹⁴ / 14! is below 2⁻⁴³.
const RECIPROCALS: [u64; 13] = [
    330_382_100,
    357_913_941,
    390_451_572,
    429_496_730,
    477_218_588,
    536_870_912,
    613_566_757,
    715_827_883,
    858_993_459,
    1_073_741_824,
    1_431_655_765,
    2_147_483_648,
    4_294_967_296,
];

/// `exp(−time / constant)` with 30 fractional bits; zero where the constant is zero.
///
/// The exponent loses as many ln 2 as it holds (each halves the result); what is left, below 0.7, goes into the series
/// `1 − x(1 − x/2 (1 − x/3 (…)))` from its far end.
#[must_use]
pub fn decay(time_ns: u64, constant_ns: u64) -> u32 {
    let exponent = Fraction::new(&[time_ns, ONE], &[constant_ns]).and_then(Fraction::nearest);
    let Some(mut exponent) = exponent.filter(|exponent| *exponent < LARGEST) else { return 0 };
    // 30 of the 32 fractional bits are left in the end.
    let mut halvings = 2_u32;
    while let Some(left) = exponent.checked_sub(LN_2) {
        exponent = left;
        halvings = halvings.saturating_add(1);
    }
    let value = RECIPROCALS.iter().fold(ONE, |sum, reciprocal| {
        let part = times(times(exponent, *reciprocal), sum);
        ONE.saturating_sub(part)
    });
    let half = 1_u64.wrapping_shl(halvings.saturating_sub(1));
    u32::try_from(value.saturating_add(half).wrapping_shr(halvings)).unwrap_or(u32::MAX)
}

/// Product of two numbers with 32 fractional bits, the first below 1 and the second at most 1: below 2⁶⁴.
fn times(a: u64, b: u64) -> u64 {
    a.saturating_mul(b).wrapping_shr(32)
}

#[cfg(test)]
#[allow(clippy::float_arithmetic, reason = "the reference is a float")]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const SCALE: f64 = (1_u64 << 30) as f64;

    proptest! {
        #[test]
        fn a_quotient_is_that_of_the_compiler(numerator in any::<u64>(), factor in any::<u64>(), denominator in 1..=u64::MAX, shift in 0..64_u32) {
            let denominator = (denominator >> shift).max(1);
            let (whole, rest) = (u128::from(numerator) * u128::from(factor) / u128::from(denominator),
                u128::from(numerator) * u128::from(factor) % u128::from(denominator));
            let fraction = Fraction::new(&[numerator, factor], &[denominator]).unwrap();
            let nearest = whole + u128::from(2 * rest >= u128::from(denominator));
            prop_assert_eq!(fraction.nearest(), u64::try_from(nearest).ok());
            prop_assert_eq!(fraction.up(), u64::try_from(whole + u128::from(rest > 0)).ok());
            prop_assert_eq!(fraction.exact(), u64::try_from(whole).ok().filter(|_| rest == 0));
        }

        #[test]
        fn the_exponential_is_good_to_one_unit_of_its_thirty_bits(time in 1_u64..30_000_000, constant in 1_u64..2_147_483_647) {
            let exact = (-(time as f64) / constant as f64).exp();
            let got = f64::from(decay(time, constant)) / SCALE;
            prop_assert!((got - exact).abs() <= 1.0 / SCALE, "{got} {exact}");
        }
    }

    #[test]
    fn the_exponential_is_good_to_one_unit_over_its_whole_range() {
        let error = |hundredth: u64| {
            let exact = (-(hundredth as f64) / 1000.0).exp();
            (f64::from(decay(hundredth, 1000)) / SCALE - exact).abs()
        };
        let worst = (0..25_000).map(error).fold(0.0, f64::max);
        assert!((0.4 / SCALE..=1.0 / SCALE).contains(&worst), "{} units", worst * SCALE);
    }

    #[test]
    fn the_ends_of_the_exponential_are_one_and_zero() {
        assert_eq!(decay(0, 1), 1 << 30);
        assert_eq!(decay(22, 1), 0);
        assert_eq!(decay(1, 0), 0);
        assert_eq!(decay(u64::MAX, 1), 0);
    }

    #[test]
    fn a_fraction_without_a_value_is_none() {
        assert_eq!(Fraction::new(&[1], &[0]), None);
        assert_eq!(Fraction::new(&[u64::MAX, u64::MAX, 2], &[1]), None);
        assert_eq!(Fraction::new(&[u64::MAX, u64::MAX], &[1]).and_then(Fraction::nearest), None);
    }
}
