//! Arithmetic from physical units to machine units: exact fractions, rounded once, and the
//! exponential.
//!
//! It runs when a parameter set is committed, in the SDO event, never in the control cycle. There
//! are no floats, and no 64-bit division of the compiler's library either: quotients are made digit
//! by digit, one digit for each bit of the result (at most 64 for a machine number).
//!
//! | what | error |
//! |---|---|
//! | [`Fraction::nearest`] | half a unit of the result and a 2⁻⁶⁰ part of it |
//! | [`Fraction::up`], [`Fraction::exact`] | none, for a denominator below 2⁶² |
//! | [`decay`] | 2⁻³⁰, one unit of the result |

/// The product of some numbers, over the product of others.
///
/// The callers keep both products below 2¹²⁸; beyond that they have no value, and neither has the
/// fraction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fraction {
    numerator: u128,
    denominator: u128,
}

/// What a division leaves: denominator · whole + rest is the numerator.
struct Quotient {
    whole: u64,
    rest: u64,
    denominator: u64,
}

/// Bits that a denominator keeps for the division, so that twice the rest has room in 64.
const DENOMINATOR_BITS: u32 = 62;

/// No machine number is as large.
const LARGEST_QUOTIENT: u64 = 1 << 63;

impl Fraction {
    /// The fraction; `None` where a product does not fit 128 bits or the denominator is zero.
    #[must_use]
    pub fn new(numerator: &[u64], denominator: &[u64]) -> Option<Self> {
        let fraction = Self {
            numerator: product(numerator)?,
            denominator: product(denominator)?,
        };
        (fraction.denominator > 0).then_some(fraction)
    }

    /// Rounded to nearest, halves up; `None` from 2⁶³ on.
    #[must_use]
    pub fn nearest(self) -> Option<u64> {
        let Quotient {
            whole,
            rest,
            denominator,
        } = self.divided()?;
        Some(whole.saturating_add(u64::from(rest >= denominator.saturating_sub(rest))))
    }

    /// Rounded up; `None` from 2⁶³ on.
    #[must_use]
    pub fn up(self) -> Option<u64> {
        let Quotient { whole, rest, .. } = self.divided()?;
        Some(whole.saturating_add(u64::from(rest > 0)))
    }

    /// The quotient where the division leaves no rest.
    #[must_use]
    pub fn exact(self) -> Option<u64> {
        let Quotient { whole, rest, .. } = self.divided()?;
        (rest == 0).then_some(whole)
    }

    /// The same fraction with a denominator of 62 bits at most; the bits that fall off are a 2⁻⁶¹
    /// part of it.
    fn shortened(self) -> (u128, u64) {
        let bits = u128::BITS.saturating_sub(self.denominator.leading_zeros());
        let off = bits.saturating_sub(DENOMINATOR_BITS);
        let denominator = self.denominator.wrapping_shr(off);
        (
            self.numerator.wrapping_shr(off),
            u64::try_from(denominator).unwrap_or(u64::MAX),
        )
    }

    /// Long division: the head of the numerator is as long as the denominator; its tail comes down
    /// digit by digit. `None` beyond 64 digits.
    // Once in the image, not at every conversion.
    #[inline(never)]
    fn divided(self) -> Option<Quotient> {
        let (numerator, denominator) = self.shortened();
        let digits = u128::from(denominator)
            .leading_zeros()
            .saturating_sub(numerator.leading_zeros());
        if digits >= u64::BITS {
            return None;
        }
        let mut rest = u64::try_from(numerator.wrapping_shr(digits)).ok()?;
        let mut tail = low(numerator.wrapping_shl(u64::BITS.saturating_sub(digits)));
        let mut whole = digit(&mut rest, denominator);
        for _ in 0..digits {
            rest = rest.wrapping_shl(1) | tail.wrapping_shr(63);
            tail = tail.wrapping_shl(1);
            whole = whole.wrapping_shl(1) | digit(&mut rest, denominator);
        }
        (whole < LARGEST_QUOTIENT).then_some(Quotient {
            whole,
            rest,
            denominator,
        })
    }
}

/// One binary digit of the quotient.
fn digit(rest: &mut u64, denominator: u64) -> u64 {
    match rest.checked_sub(denominator) {
        Some(left) => {
            *rest = left;
            1
        }
        None => 0,
    }
}

#[expect(clippy::as_conversions, reason = "the low half is meant")]
const fn low(value: u128) -> u64 {
    value as u64
}

#[inline(never)]
fn product(factors: &[u64]) -> Option<u128> {
    factors.iter().try_fold(1_u128, |product, factor| {
        product.checked_mul(u128::from(*factor))
    })
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
/// The exponent loses as many ln 2 as it holds (each halves the result); what is left, below 0.7,
/// goes into the series `1 − x(1 − x/2 (1 − x/3 (…)))` from its far end.
#[must_use]
pub fn decay(time_ns: u64, constant_ns: u64) -> u32 {
    let exponent = Fraction::new(&[time_ns, ONE], &[constant_ns]).and_then(Fraction::nearest);
    let Some(mut exponent) = exponent.filter(|exponent| *exponent < LARGEST) else {
        return 0;
    };
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

/// Product of two numbers with 32 fractional bits, the first below 1 and the second at most 1:
/// below 2⁶⁴.
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
        fn a_quotient_is_that_of_the_compiler(
            numerator in any::<u64>(), factor in any::<u64>(), denominator in 1..1_u64 << 62, shift in 0..62_u32,
        ) {
            let denominator = (denominator >> shift).max(1);
            let product = u128::from(numerator) * u128::from(factor);
            let (whole, rest) = (product / u128::from(denominator), product % u128::from(denominator));
            let fraction = Fraction::new(&[numerator, factor], &[denominator]).unwrap();
            let fits = u64::try_from(whole).ok().filter(|whole| *whole < LARGEST_QUOTIENT);
            prop_assert_eq!(fraction.nearest(), fits.map(|w| w + u64::from(2 * rest >= u128::from(denominator))));
            prop_assert_eq!(fraction.up(), fits.map(|whole| whole + u64::from(rest > 0)));
            prop_assert_eq!(fraction.exact(), fits.filter(|_| rest == 0));
        }

        #[test]
        fn a_long_denominator_costs_a_part_of_two_to_the_minus_sixty(
            numerators in any::<[u64; 2]>(), denominators in any::<[u64; 2]>(), shifts in any::<[u8; 2]>(),
        ) {
            let denominators = [denominators[0] >> (shifts[0] % 64) | 1, denominators[1] >> (shifts[1] % 64) | 1];
            let [numerator, denominator] =
                [numerators, denominators].map(|[a, b]| u128::from(a) * u128::from(b));
            let whole = numerator / denominator;
            match Fraction::new(&numerators, &denominators).unwrap().nearest() {
                Some(got) => prop_assert!(u128::from(got).abs_diff(whole) <= 1 + (whole >> 60), "{} {}", got, whole),
                None => prop_assert!(whole >= u128::from(LARGEST_QUOTIENT - 16), "{}", whole),
            }
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
        assert!(
            (0.4 / SCALE..=1.0 / SCALE).contains(&worst),
            "{} units",
            worst * SCALE
        );
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
        assert_eq!(
            Fraction::new(&[u64::MAX, u64::MAX], &[1]).and_then(Fraction::nearest),
            None
        );
    }
}
