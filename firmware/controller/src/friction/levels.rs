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

/// How the levels fall behind the speed: first within a time (as those of generalised Maxwell slip
/// do), then within a way: bristles come to another level within their deflection (Canudas de Wit
/// et al., IEEE TAC 40 (1995) 419). Zero: at once.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LevelLag {
    /// Share of what the level is off that it makes up for per cycle.
    pub per_cycle: I8F24,
    /// The same per way of 10 nm.
    pub per_way: I8F24,
}

/// Factor on the levels on its way to that of the speed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Factor {
    /// Behind the speed by the time.
    level: I8F24,
    /// Behind that by the way.
    pub(super) acting: I8F24,
}

impl Factor {
    /// One that has been there for long.
    pub(super) fn at(factor: I8F24) -> Self {
        Self {
            level: factor,
            acting: factor,
        }
    }

    /// The same on its way to `aim`, a way and some cycles later.
    pub(super) fn passed(self, lag: LevelLag, aim: I8F24, way: Velocity, cycles: I8F24) -> Self {
        let level = if lag.per_cycle == I8F24::ZERO {
            aim
        } else {
            let share = I8F24::saturating_from_num(cycles.wide_mul(lag.per_cycle));
            between(self.level, aim, share)
        };
        let acting = if lag.per_way == I8F24::ZERO {
            level
        } else {
            let share = I8F24::saturating_from_num(way.0.saturating_abs().wide_mul(lag.per_way));
            between(self.acting, level, share)
        };
        Self { level, acting }
    }
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
