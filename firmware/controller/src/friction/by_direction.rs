//! Friction that differs by direction.

use fixed::types::I8F24;

use crate::units::{Coarse, Velocity, narrowed};

/// What differs by direction.
///
/// A bristle with the level `F (1 ± a)` comes to it within ways in the same proportion, so that
/// after a reversal `F(x)` is steeper towards the lower level (Canudas de Wit et al., IEEE TAC 40
/// (1995) 419, with g(v) by direction). Ways count `1 / (1 ± a)` times to its elements. Springs
/// that slip are as stiff either way, and ways count once.
///
/// What is the same at all speeds, `a F`, is a constant force; what goes with the factor on the
/// levels is fed forward.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ByDirection {
    /// Ways count so many times, forward and backward.
    pub ways: [I8F24; 2],
    /// How much higher the levels of all elements are forward than backward, halved, µN·m.
    pub level_micro_nm: i32,
}

impl Default for ByDirection {
    fn default() -> Self {
        Self {
            ways: [I8F24::ONE; 2],
            level_micro_nm: 0,
        }
    }
}

impl ByDirection {
    /// A way as the elements have it.
    pub(super) fn way(&self, way: Velocity) -> Velocity {
        way.scaled(of_direction(&self.ways, way))
    }

    /// The torque at a factor on the levels, beyond that at another; factors below 4.
    pub(super) fn torque(&self, factor: I8F24, beyond: I8F24) -> Coarse {
        // 31.0 bits times 8.24 bits.
        let change = i64::from(factor.wrapping_sub(beyond).to_bits());
        let product = i64::from(self.level_micro_nm).wrapping_mul(change);
        Coarse::from_bits(narrowed::<22>(product))
    }
}

/// Forward or backward.
pub(super) fn of_direction<T: Copy>([forward, backward]: &[T; 2], velocity: Velocity) -> T {
    if velocity.0.is_negative() {
        *backward
    } else {
        *forward
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fixed::types::I20F12;

    #[test]
    fn ways_and_levels_differ_by_direction_and_default_to_none() {
        let own = ByDirection {
            ways: [0.8, 1.25].map(I8F24::from_num),
            level_micro_nm: -60_000,
        };
        let way = |counts: f64| {
            own.way(Velocity(I20F12::from_num(counts)))
                .0
                .to_num::<f64>()
        };
        assert!((way(100.0) - 80.0).abs() < 1.0e-3, "{}", way(100.0));
        assert!((way(-100.0) + 125.0).abs() < 1.0e-3, "{}", way(-100.0));
        let torque = own.torque(I8F24::from_num(1.0), I8F24::from_num(1.25));
        assert_eq!(torque.to_num::<f64>(), 15_000.0);
        let none = ByDirection::default();
        for counts in [-7.0, 0.0, 1.0e5] {
            let way = Velocity(I20F12::from_num(counts));
            assert_eq!(none.way(way), way);
        }
        assert_eq!(none.torque(I8F24::from_num(3.9), I8F24::ZERO), Coarse::ZERO);
    }
}
