//! Levels of the elements over the speed, and how they fall behind it.
//!
//! Factors on the levels are never negative and below 4; shares are at most 1, and what has come is
//! never less than the ramp, so that a level that lags lies between those that it comes from and
//! goes to. Sums and products of them cannot overflow.

use fixed::types::{I8F24, U3F29};

use crate::units::Velocity;

/// Intervals of a level curve.
const INTERVALS: usize = 16;
/// Points of a level curve.
pub const LEVELS: usize = INTERVALS + 1;

/// Levels over the speed: a factor at 17 speeds from standstill to the end of the curve, straight
/// between them, and the last one beyond.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LevelCurve {
    /// Intervals per speed.
    pub intervals_per_velocity: I8F24,
    /// Factor on all levels, 0 to 3.9.
    pub factors: [I8F24; LEVELS],
}

impl Default for LevelCurve {
    fn default() -> Self {
        Self {
            intervals_per_velocity: I8F24::ZERO,
            factors: [I8F24::ONE; LEVELS],
        }
    }
}

impl LevelCurve {
    /// The factor at standstill.
    pub(super) fn at_rest(&self) -> I8F24 {
        let [first, ..] = self.factors;
        first
    }

    pub(super) fn at(&self, velocity: Velocity) -> I8F24 {
        // The whole part is the interval.
        let place = velocity.size().over(self.intervals_per_velocity);
        let interval = usize::try_from(place.to_bits().wrapping_shr(24)).unwrap_or(INTERVALS);
        let points = self.factors.get(interval..).unwrap_or_default();
        let Some([from, to]) = points.first_chunk() else {
            return self.at_end();
        };
        let share = I8F24::from_bits(place.to_bits() & 0x00FF_FFFF);
        from.wrapping_add(times(to.wrapping_sub(*from), share))
    }

    fn at_end(&self) -> I8F24 {
        let [.., last] = self.factors;
        last
    }
}

/// How the levels fall behind the speed within a time, as those of generalised Maxwell slip do:
/// `τ L' = aim − L`, exactly, for an aim that changes evenly over some cycles.
///
/// ```text
/// L + come (aim₀ − L) + ramp (aim₁ − aim₀)
/// come = 1 − e      ramp = 1 − come τ / t      e = exp(−t / τ)
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LevelLag {
    /// Share of what the level is off that has come in the end.
    pub come: I8F24,
    /// Share of the change of what it comes to.
    pub ramp: I8F24,
}

impl LevelLag {
    /// The level is what it comes to.
    pub const NONE: Self = Self {
        come: I8F24::ONE,
        ramp: I8F24::ONE,
    };

    fn after(self, level: I8F24, [from, to]: [I8F24; 2]) -> I8F24 {
        let come = from.wrapping_sub(level).wide_mul(self.come);
        let ramp = to.wrapping_sub(from).wide_mul(self.ramp);
        level.wrapping_add(I8F24::wrapping_from_num(come.wrapping_add(ramp)))
    }
}

impl Default for LevelLag {
    fn default() -> Self {
        Self::NONE
    }
}

/// Factor on the levels on its way to that of the speed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Factor {
    /// That of the speed.
    aim: I8F24,
    /// Behind it by the time.
    level: I8F24,
    /// Behind that by the way: bristles come to another level within their deflection (Canudas de
    /// Wit et al., IEEE TAC 40 (1995) 419).
    pub(super) acting: I8F24,
}

impl Factor {
    /// One that has been there for long.
    pub(super) fn at(factor: I8F24) -> Self {
        Self {
            aim: factor,
            level: factor,
            acting: factor,
        }
    }

    /// As it acts on elements.
    pub(super) fn on_levels(self) -> U3F29 {
        U3F29::wrapping_from_num(self.acting.clamp(I8F24::ZERO, HIGHEST))
    }

    /// The same on its way to `aim`, the cycles of a lag and a way later.
    pub(super) fn passed(self, lag: LevelLag, way: LevelLag, aim: I8F24) -> Self {
        let level = lag.after(self.level, [self.aim, aim]);
        Self {
            aim,
            level,
            acting: way.after(self.acting, [self.level, level]),
        }
    }
}

/// How a level lags within a way, after x times that way: come is `1 − exp(−x)` to the second
/// order, `x − x²/2 + x³/8`, and all of it from 2 on; ramp is `1 − come / x`, from 2 on by a
/// straight line that ends at 6. What looks ahead by two cycles has to come to what two cycles
/// bring.
pub(super) fn within_way(way: Velocity, per_way: I8F24) -> LevelLag {
    const TWO: I8F24 = I8F24::from_bits(2 << 24);
    if per_way == I8F24::ZERO {
        return LevelLag::NONE;
    }
    let x = way.size().over(per_way);
    let part = |bits: u32| I8F24::from_bits(x.to_bits().wrapping_shr(bits));
    if x >= TWO {
        // 1/2 + (x − 2) / 8
        let ramp = part(3).wrapping_add(I8F24::from_bits(1 << 22));
        return LevelLag {
            come: I8F24::ONE,
            ramp: ramp.min(I8F24::ONE),
        };
    }
    let ramp = times(part(1), I8F24::ONE.wrapping_sub(part(2)));
    LevelLag {
        come: times(x, I8F24::ONE.wrapping_sub(ramp)),
        ramp,
    }
}

/// Above all factors on levels.
pub(super) const HIGHEST: I8F24 = I8F24::from_bits((4 << 24) - 1);

/// Product of two factors, or of a factor and a share; each below 4, so that it stays below 16.
pub(super) fn times(one: I8F24, other: I8F24) -> I8F24 {
    I8F24::wrapping_from_num(one.wide_mul(other))
}

#[cfg(test)]
mod tests {
    use super::*;
    use fixed::types::I20F12;

    /// The shares of a lag of so many cycles over some.
    fn lag(cycles: f64, over: f64) -> LevelLag {
        let x = over / cycles;
        let come = 1.0 - (-x).exp();
        LevelLag {
            come: I8F24::from_num(come),
            ramp: I8F24::from_num(1.0 - come / x),
        }
    }

    #[test]
    fn two_cycles_at_once_bring_what_two_bring_one_after_the_other() {
        let begin = Factor {
            aim: I8F24::from_num(1.0),
            level: I8F24::from_num(1.0),
            acting: I8F24::from_num(0.95),
        };
        let at = |aim: f64| I8F24::from_num(aim);
        // Ways of a cycle in ways of the lag, and what the level may be off of its change by 0.2.
        for (ways, most) in [
            (0.05, 1.0e-3),
            (0.5, 6.0e-3),
            (1.0, 8.0e-3),
            (2.0, 4.0e-2),
            (20.0, 0.0),
        ] {
            let way = |cycles: f64| {
                within_way(Velocity(I20F12::from_num(100.0 * cycles)), at(0.01 * ways))
            };
            let one = begin.passed(lag(2.1, 1.0), way(1.0), at(1.1));
            let other = one.passed(lag(2.1, 1.0), way(1.0), at(1.2));
            let both = begin.passed(lag(2.1, 2.0), way(2.0), at(1.2));
            let apart = |a: I8F24, b: I8F24| (a - b).to_num::<f64>().abs();
            assert!(apart(other.level, both.level) < 1.0e-6);
            let off = apart(other.acting, both.acting);
            assert!(off <= most + 1.0e-6, "{ways}: {off}");
        }
    }

    #[test]
    fn a_long_way_has_no_lag_and_none_is_the_limit_of_a_short_one() {
        let long = within_way(Velocity(I20F12::from_num(700)), I8F24::from_num(0.01));
        assert_eq!(long, LevelLag::NONE);
        assert_eq!(
            within_way(Velocity(I20F12::ONE), I8F24::ZERO),
            LevelLag::NONE
        );
        assert_eq!(
            within_way(Velocity::ZERO, I8F24::from_num(0.01)),
            LevelLag {
                come: I8F24::ZERO,
                ramp: I8F24::ZERO
            }
        );
    }

    #[test]
    fn a_level_without_a_lag_is_that_of_the_speed() {
        let begin = Factor::at(I8F24::from_num(1.3));
        let after = begin.passed(LevelLag::NONE, LevelLag::NONE, I8F24::from_num(1.1));
        assert_eq!(after, Factor::at(I8F24::from_num(1.1)));
    }
}
