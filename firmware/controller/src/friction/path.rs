//! Looking ahead: how far, and along which path; the axis may turn round on it.

use fixed::types::{I8F24, I20F12};

use super::by_direction::ByDirection;
use super::levels::LevelLag;
use crate::units::{Acceleration, Velocity};

/// How far the look ahead goes from x(k+1), in cycles τ: `v τ + a τ (τ + 1) / 2` farther, and there
/// the reference has the velocity `v + a (τ + 1/2)`, where v is the way of the last cycle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Ahead {
    /// τ.
    pub cycles: I8F24,
    /// τ (τ + 1) / 2.
    pub way_by_acceleration: I8F24,
    /// τ + 1/2.
    pub velocity_by_acceleration: I8F24,
    /// How the levels fall behind the speed on the way there.
    pub lag: LevelLag,
}

impl Ahead {
    /// From the begin of a cycle to its middle.
    pub const HALF_A_CYCLE: I8F24 = I8F24::from_bits(1 << 23);

    /// How far it is at such a velocity and acceleration.
    pub(crate) fn way(&self, velocity: Velocity, acceleration: Acceleration) -> Velocity {
        let turned = Velocity(acceleration.0).scaled(self.way_by_acceleration);
        velocity.scaled(self.cycles).plus(turned)
    }

    /// The velocity there.
    pub(super) fn velocity(&self, velocity: Velocity, acceleration: Acceleration) -> Velocity {
        velocity.plus(Velocity(acceleration.0).scaled(self.velocity_by_acceleration))
    }
}

/// A way within which the axis may turn round: so far on, and so far back.
#[derive(Clone, Copy, Debug)]
pub(super) struct Path {
    pub(super) on: Velocity,
    pub(super) back: Option<Velocity>,
}

impl Path {
    pub(super) fn straight(on: Velocity) -> Self {
        Self { on, back: None }
    }

    /// A way at constant acceleration, between two velocities, as elements have it that differ by
    /// direction. Where the velocities differ in sign it turns round: so far on, and the rest back.
    pub(super) fn between(
        direction: &ByDirection,
        begin: Velocity,
        end: Velocity,
        cycles: I8F24,
        way: Velocity,
    ) -> Self {
        if (begin.0 ^ end.0).is_negative() && begin.0 != I20F12::ZERO && end.0 != I20F12::ZERO {
            let on = way_on(begin, end, cycles);
            Self {
                on: direction.way(on),
                back: Some(direction.way(way.minus(on))),
            }
        } else {
            Self::straight(direction.way(way))
        }
    }

    /// How far it goes in all.
    pub(super) fn length(&self) -> Velocity {
        let on = self.on.size();
        self.back.map_or(on, |back| on.plus(back.size()))
    }
}

/// How far it goes on before it turns round, after the share `r = |v₁| / (|v₁| + |v₂|)` of the
/// time: `r v₁ τ / 2`.
#[inline(never)]
fn way_on(begin: Velocity, end: Velocity, cycles: I8F24) -> Velocity {
    let [begin_size, end_size] = [begin, end].map(|velocity| velocity.0.to_bits().unsigned_abs());
    let share = I8F24::from_bits(share(begin_size, end_size).wrapping_shl(SHARE_SHIFT));
    begin.scaled(cycles).scaled(share).halved()
}

/// Bits of a share of the time.
const SHARE_BITS: u32 = 6;
/// From such a share to 24 fractional bits.
const SHARE_SHIFT: u32 = 24 - SHARE_BITS;

/// `one / (one + other)` in 64ths, rounded down, digit by digit; each counts as 2³⁰ at most,
/// 2.6 m/s at 1 kHz, so that twice their sum has room.
fn share(one: u32, other: u32) -> i32 {
    let [mut rest, other] = [one, other].map(|size| size.min(1 << 30));
    let all = rest.wrapping_add(other);
    let mut share = 0_i32;
    for _ in 0..SHARE_BITS {
        rest = rest.wrapping_shl(1);
        share = share.wrapping_shl(1);
        if rest >= all {
            rest = rest.wrapping_sub(all);
            share |= 1;
        }
    }
    share
}

#[cfg(test)]
mod tests {
    use super::*;

    fn velocity(counts: f64) -> Velocity {
        Velocity(I20F12::from_num(counts))
    }

    #[test]
    fn a_path_that_turns_goes_on_first_and_then_back() {
        // 100 counts per cycle, −50 per cycle²: turns after two cycles, 100 counts on; half a cycle
        // later 6.25 back.
        let path = Path::between(
            &ByDirection::default(),
            velocity(100.0),
            velocity(-25.0),
            I8F24::from_num(2.5),
            velocity(93.75),
        );
        let on: f64 = path.on.0.to_num();
        let back: f64 = path.back.unwrap().0.to_num();
        // The time of the turn is good to a 64th of the 2.5 cycles.
        assert!((on - 100.0).abs() < 100.0 * 2.5 / 64.0, "{on}");
        assert!((on + back - 93.75).abs() < 1.0e-3, "{on} {back}");
    }

    #[test]
    fn a_path_that_only_begins_or_ends_at_rest_is_straight() {
        for (begin, end) in [(0.0, 5.0), (5.0, 0.0), (0.0, 0.0), (2.0, 7.0), (-2.0, -7.0)] {
            let [begin, end] = [begin, end].map(velocity);
            let alike = ByDirection::default();
            let path = Path::between(&alike, begin, end, I8F24::ONE, velocity(3.0));
            assert_eq!((path.on, path.back), (velocity(3.0), None));
            assert_eq!(path.length(), velocity(3.0));
        }
    }

    #[test]
    fn a_share_is_rounded_down_to_a_64th() {
        assert_eq!((share(1, 1), share(1, 3), share(0, 7)), (32, 16, 0));
        assert_eq!((share(2, 1), share(u32::MAX, 1)), (42, 63));
    }
}
