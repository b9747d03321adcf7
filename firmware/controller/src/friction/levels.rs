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
        let step = to.saturating_sub(from).wide_mul(share);
        from.saturating_add(I8F24::saturating_from_num(step))
    }
}

/// How the levels fall behind the speed: by a share per way and per cycle of what they are off.
/// Bristles come to another level within their deflection (Canudas de Wit et al., IEEE TAC 40
/// (1995) 419); generalised Maxwell slip within a time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LevelLag {
    /// Share per way of 10 nm.
    pub per_way: I8F24,
    /// Share per cycle.
    pub per_cycle: I8F24,
}

impl LevelLag {
    /// The factor that was `before`, on its way to `aim`, a way and some cycles later. Without any
    /// lag it is there at once.
    pub(super) fn passed(self, before: I8F24, aim: I8F24, way: Velocity, cycles: I8F24) -> I8F24 {
        if self.per_way == I8F24::ZERO && self.per_cycle == I8F24::ZERO {
            return aim;
        }
        let by_way = I8F24::saturating_from_num(way.0.saturating_abs().wide_mul(self.per_way));
        let by_time = I8F24::saturating_from_num(cycles.wide_mul(self.per_cycle));
        let share = by_way.saturating_add(by_time).min(I8F24::ONE);
        let step = aim.saturating_sub(before).wide_mul(share);
        before.saturating_add(I8F24::saturating_from_num(step))
    }
}
