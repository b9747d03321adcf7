//! Levels of friction along the travel.

use fixed::types::I8F24;

use crate::units::{Position, narrowed};

/// Levels along the travel: `1 + x (linear + x · quadratic)`, with x from position zero in units of
/// 2²⁴ counts (168 mm), never below zero. What it
/// does to a level is cut at four times it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LevelPlace {
    /// Per unit.
    pub linear: I8F24,
    /// Per square of a unit.
    pub quadratic: I8F24,
}

impl LevelPlace {
    /// The factor at a position; beyond 21 m as there.
    pub(super) fn at(self, position: Position) -> I8F24 {
        // 56.8 bits in units of 2²⁴ counts are 32 fractional bits; 24 of them stay.
        let x = I8F24::from_bits(narrowed::<8>(position.0.to_bits()));
        let slope = self.linear.saturating_add(product(self.quadratic, x));
        I8F24::ONE
            .saturating_add(product(slope, x))
            .max(I8F24::ZERO)
    }
}

/// Saturated.
fn product(one: I8F24, other: I8F24) -> I8F24 {
    I8F24::from_bits(narrowed::<24>(one.wide_mul(other).to_bits()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use fixed::types::I56F8;

    #[test]
    fn a_level_is_a_parabola_over_the_travel_and_never_negative() {
        let place = LevelPlace {
            linear: I8F24::from_num(0.5),
            quadratic: I8F24::from_num(-0.25),
        };
        let at = |unit: f64| {
            let counts = I56F8::saturating_from_num(unit * f64::from(1 << 24));
            place.at(Position(counts)).to_num::<f64>()
        };
        for unit in [-1.0, -0.1, 0.0, 0.3, 2.0] {
            let wanted: f64 = 1.0 + 0.5 * unit - 0.25 * unit * unit;
            assert!((at(unit) - wanted.max(0.0)).abs() < 1.0e-6, "{unit}");
        }
        assert_eq!((at(-4.0), at(100.0), at(-1.0e6)), (0.0, 0.0, 0.0));
    }
}
