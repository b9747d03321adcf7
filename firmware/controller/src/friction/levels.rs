//! Levels of the elements over the speed, and how they fall behind it.

use fixed::types::I8F24;

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
    /// Factor on all levels.
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
    pub(super) fn at(&self, velocity: Velocity) -> I8F24 {
        // 20.12 times 8.24 bits: 28.36 bits. The whole part is the interval.
        let place = velocity
            .0
            .saturating_abs()
            .wide_mul(self.intervals_per_velocity)
            .to_bits();
        let interval = usize::try_from(place.wrapping_shr(36)).unwrap_or(INTERVALS);
        let [Some(from), Some(to)] =
            [interval, interval.saturating_add(1)].map(|place| self.factors.get(place).copied())
        else {
            return self.factors.last().copied().unwrap_or(I8F24::ONE);
        };
        // 24 of the 36 fractional bits.
        let share = I8F24::from_bits(
            i32::try_from(place.wrapping_shr(12) & 0x00FF_FFFF).unwrap_or_default(),
        );
        between(from, to, share)
    }
}

/// How the levels fall behind the speed within a time, as those of generalised Maxwell slip do:
/// `τ L' = aim − L`, exactly, for an aim that changes evenly over some cycles.
///
/// ```text
/// L + come (aim₀ − L) + ramp (aim₁ − aim₀)      come = 1 − e, ramp = 1 − (1 − e) τ / t, e = exp(−t / τ)
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
        between(level, from, self.come).saturating_add(times(to.saturating_sub(from), self.ramp))
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

    /// The same on its way to `aim`, the cycles of a lag later and after a way that brings a share;
    /// `None`: all of it at once.
    pub(super) fn passed(self, lag: LevelLag, way: Option<I8F24>, aim: I8F24) -> Self {
        let level = lag.after(self.level, [self.aim, aim]);
        let Some(share) = way else {
            return Self {
                aim,
                level,
                acting: level,
            };
        };
        let mean = I8F24::from_bits(
            self.level
                .to_bits()
                .wrapping_shr(1)
                .wrapping_add(level.to_bits().wrapping_shr(1)),
        );
        Self {
            aim,
            level,
            acting: between(self.acting, mean, share),
        }
    }
}

/// The share of a level that has come after a way, `1 − exp(−x)` to the second order, all of it
/// after two ways of the lag: x − x²/2 + x³/8. What looks ahead by two cycles has to come to what
/// two cycles bring.
pub(super) fn come_within(way: Velocity, per_way: I8F24) -> I8F24 {
    const TWO: I8F24 = I8F24::from_bits(2 << 24);
    let x = I8F24::saturating_from_num(way.0.saturating_abs().wide_mul(per_way));
    if x >= TWO {
        return I8F24::ONE;
    }
    let part = |bits: u32| I8F24::from_bits(x.to_bits().wrapping_shr(bits));
    let inner = times(part(1), I8F24::ONE.saturating_sub(part(2)));
    times(x, I8F24::ONE.saturating_sub(inner))
}

/// Product of two factors, saturated.
pub(super) fn times(one: I8F24, other: I8F24) -> I8F24 {
    I8F24::saturating_from_num(one.wide_mul(other))
}

/// Between two factors, at a share of the way, the whole of it at most.
fn between(from: I8F24, to: I8F24, share: I8F24) -> I8F24 {
    let step = to.saturating_sub(from).wide_mul(share.min(I8F24::ONE));
    from.saturating_add(I8F24::saturating_from_num(step))
}

#[cfg(test)]
mod tests {
    use super::*;

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
            level: I8F24::from_num(1.3),
            acting: I8F24::from_num(1.25),
        };
        let at = |aim: f64| I8F24::from_num(aim);
        let share = |ways: i32| {
            come_within(
                Velocity(fixed::types::I20F12::from_num(ways)),
                I8F24::from_num(0.05),
            )
        };
        let one = begin.passed(lag(2.1, 1.0), Some(share(1)), at(1.1));
        let other = one.passed(lag(2.1, 1.0), Some(share(1)), at(1.2));
        let both = begin.passed(lag(2.1, 2.0), Some(share(2)), at(1.2));
        let apart = |a: I8F24, b: I8F24| (a - b).to_num::<f64>().abs();
        assert!(apart(other.level, both.level) < 1.0e-6);
        let off = apart(other.acting, both.acting);
        assert!(off < 2.0e-3, "{off}");
    }

    #[test]
    fn a_level_without_a_lag_is_that_of_the_speed() {
        let begin = Factor::at(I8F24::from_num(1.3));
        let after = begin.passed(LevelLag::NONE, None, I8F24::from_num(1.1));
        assert_eq!(after, Factor::at(I8F24::from_num(1.1)));
    }
}
