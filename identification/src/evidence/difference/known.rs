//! A value with its interval.

/// What is open of a value of which hardly anything is known, as a share of it.
const HARDLY: f64 = 0.8;

/// A value with the half width of its 95 % interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Known {
    /// Value.
    pub value: f64,
    /// Half width of its interval.
    pub half_width: f64,
}

impl Known {
    /// A value with its half width.
    pub(crate) const fn new(value: f64, half_width: f64) -> Self {
        Self { value, half_width }
    }

    /// So many times as large.
    pub(super) fn of(self, whole: f64) -> Self {
        Self::new(self.value * whole, self.half_width * whole.abs())
    }

    /// One over it.
    pub(crate) fn inverse(self) -> Self {
        Self::new(1.0 / self.value, self.half_width / self.value.powi(2))
    }

    /// The same, with a share of itself in its interval.
    pub(super) fn within_share(self, share: f64) -> Self {
        self.within(share * self.value)
    }

    /// The same, with a half width that comes from elsewhere in its interval.
    pub(super) fn within(self, half_width: f64) -> Self {
        let half_width = self.half_width.hypot(half_width);
        Self { half_width, ..self }
    }

    /// The same, as uncertain as another value of it is different.
    pub(super) fn beside(self, other: Self) -> Self {
        self.within(self.value - other.value)
    }

    /// The same, as hardly anything is known of it.
    pub(super) fn hardly(self) -> Self {
        Self::new(self.value, HARDLY * self.value)
    }

    /// The product with another.
    pub(super) fn times(self, other: Self) -> Self {
        let half_width = (self.half_width * other.value).hypot(other.half_width * self.value);
        Self::new(self.value * other.value, half_width)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_inverse_is_as_uncertain_in_shares_as_the_value() {
        let inverse = Known::new(-4.0, 0.2).inverse();
        assert_eq!(inverse.value, -0.25);
        assert!((inverse.half_width / 0.25 - 0.05).abs() < 1.0e-12);
    }

    #[test]
    fn another_value_makes_it_as_uncertain_as_it_is_different() {
        let beside = Known::new(5.0, 0.3).beside(Known::new(5.4, 7.0));
        assert_eq!(beside.value, 5.0);
        assert!((beside.half_width - 0.5).abs() < 1.0e-12, "{beside:?}");
    }

    #[test]
    fn a_product_is_as_uncertain_as_both_its_factors() {
        let product = Known::new(2.0, 0.03 * 2.0).times(Known::new(-5.0, 0.04 * 5.0));
        assert!((product.value + 10.0).abs() < 1.0e-12);
        assert!((product.half_width - 0.5).abs() < 1.0e-12, "{product:?}");
    }
}
