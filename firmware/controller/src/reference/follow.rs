//! Following within limits: the commanded track passes setpoints bit for bit while the axis can
//! follow them, and chases them where it cannot.
//!
//! - Velocity and acceleration: the change of velocity is limited last, so acceleration holds also
//!   where a velocity limit was lowered in motion.
//! - Position: with the way s left to the limit a velocity v is allowed where `v ≤ a` (the next
//!   cycle stands) or `(v − a / 2)² ≤ 2 a s`. Counted in cycles, the way of a full braking `(v − a)
//!   + (v − 2 a) + …` is at most that; so braking at a keeps it true from cycle to cycle.
//! - The chase: velocity of the setpoint plus `√(a s)`, the braking curve of half the acceleration,
//!   so that the other half is left for a setpoint that accelerates. It ends where the track can
//!   step onto the setpoint and go on with it in the next cycle.

use core::cmp::Ordering;

use fixed::types::I56F8;

use super::track::{Track, Way, limited, moved, way, within};
use crate::root::root;

/// Limits of the axis, per cycle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Limits {
    pub(super) velocity: Way,
    pub(super) acceleration: Way,
    pub(super) position_min: I56F8,
    pub(super) position_max: I56F8,
    pub(super) middle: [I56F8; 2],
}

/// Rounding of positions to 39 pm lets the velocity of a setpoint pass a limit by one bit, its
/// acceleration by two, and by ten more where one setpoint was extrapolated from three others (4
/// bits off, of which a second difference has twice as much). 12 bits are 0.5 mm/s² at 1 kHz.
const VELOCITY_ROUNDING: Way = Way::DELTA;
const ACCELERATION_ROUNDING: Way = Way::from_bits(12);

impl Limits {
    /// Whether the axis can be there, coming from the cycle before.
    #[inline]
    pub(super) fn allow(&self, track: &Track) -> bool {
        within(
            track.velocity,
            self.velocity.saturating_add(VELOCITY_ROUNDING),
        ) && within(
            track.acceleration,
            self.acceleration.saturating_add(ACCELERATION_ROUNDING),
        ) && (self.is_amid(track) || self.is_on_the_travel(track) && self.can_stop(track))
    }

    /// Within the velocity limit it stops from there.
    fn is_amid(&self, track: &Track) -> bool {
        let [from, to] = self.middle;
        track.position >= from && track.position <= to
    }

    fn is_on_the_travel(&self, track: &Track) -> bool {
        track.position >= self.position_min && track.position <= self.position_max
    }

    /// Whether the track stays within the position limits when it brakes from now on.
    #[inline]
    fn can_stop(&self, track: &Track) -> bool {
        let left = match track.velocity.cmp(&Way::ZERO) {
            Ordering::Greater => self.position_max.saturating_sub(track.position),
            Ordering::Less => track.position.saturating_sub(self.position_min),
            Ordering::Equal => return true,
        };
        let speed = track.velocity.saturating_abs();
        if speed <= self.acceleration || left < I56F8::ZERO {
            return left >= I56F8::ZERO;
        }
        // Whole counts, rounded down and at most 10 m: 2 a s stays within 62 bits with 8 of them
        // fractional, the square within 62 with 16.
        let counts = i32::try_from(left.to_bits().wrapping_shr(8))
            .unwrap_or(LONGEST_COUNTS)
            .min(LONGEST_COUNTS);
        let acceleration = self.acceleration.to_bits();
        let allowed = i64::from(acceleration)
            .wrapping_mul(i64::from(counts))
            .wrapping_mul(2);
        let mean = i64::from(speed.to_bits().wrapping_sub(acceleration.wrapping_shr(1)));
        mean.wrapping_mul(mean).wrapping_shr(8) <= allowed
    }

    /// Whether velocity or position is beyond a limit that acceleration does not let it keep.
    pub(super) fn is_overrun(&self, track: &Track) -> bool {
        let outwards = track.velocity > Way::ZERO && track.position > self.position_max
            || track.velocity < Way::ZERO && track.position < self.position_min;
        outwards
            || !within(
                track.velocity,
                self.velocity.saturating_add(VELOCITY_ROUNDING),
            )
    }

    /// The next cycle at a velocity, or as near to it as the limits let it be.
    pub(super) fn nearest(&self, track: Track, wanted: Way) -> Track {
        let change = limited(
            limited(wanted, self.velocity).saturating_sub(track.velocity),
            self.acceleration,
        );
        let next = track.moved_by(track.velocity.saturating_add(change));
        if self.can_stop(&next) {
            next
        } else {
            self.braking(track)
        }
    }

    fn braking(&self, track: Track) -> Track {
        track.moved_by(
            track
                .velocity
                .saturating_sub(limited(track.velocity, self.acceleration)),
        )
    }
}

/// 10 m in counts of 10 nm.
pub(super) const LONGEST_COUNTS: i32 = 1_000_000_000;

/// Where the setpoint is going.
#[derive(Clone, Copy, Debug)]
pub(super) struct Target {
    /// Its position in the next cycle.
    pub(super) position: I56F8,
    /// Its velocity.
    pub(super) velocity: Way,
}

/// The next cycle of the commanded track, and whether it is on the setpoint.
pub(super) fn follow(
    limits: &Limits,
    track: Track,
    target: Target,
    caught_up: bool,
) -> (Track, bool) {
    let passed = track.moved_to(target.position);
    let goes_on = caught_up
        || within(
            target.velocity.saturating_sub(passed.velocity),
            limits.acceleration,
        );
    if goes_on && limits.allow(&passed) {
        (passed, true)
    } else {
        (chase(limits, track, target), false)
    }
}

fn chase(limits: &Limits, track: Track, target: Target) -> Track {
    let aim = target
        .position
        .max(limits.position_min)
        .min(limits.position_max);
    let velocity = if aim == target.position {
        limited(target.velocity, limits.velocity)
    } else {
        Way::ZERO
    };
    let left = way(moved(track.position, velocity), aim);
    limits.nearest(
        track,
        velocity.saturating_add(braking_velocity(left, limits.acceleration)),
    )
}

/// √(a s), at most s: then it does not overshoot in the last cycle.
fn braking_velocity(left: Way, acceleration: Way) -> Way {
    // 24.8 times 24.8 bits: 16 fractional bits; the root of that has 8.
    let [way, limit] = [left.saturating_abs(), acceleration.max(Way::ZERO)]
        .map(|way| u64::from(way.to_bits().unsigned_abs()));
    let root = Way::from_bits(i32::try_from(root(way.wrapping_mul(limit))).unwrap_or(i32::MAX));
    let speed = root.min(left.saturating_abs());
    if left < Way::ZERO {
        speed.saturating_neg()
    } else {
        speed
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reference::ReferenceConfig;
    use crate::units::Position;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn amid_the_travel_an_axis_within_its_velocity_limit_can_stop(
            (limit, acceleration) in (1_i32..1 << 26, 1_i32..1 << 22),
            share in prop_oneof![Just(-1024_i64), Just(1024), -1024_i64..=1024],
            beyond in prop_oneof![Just(0_i64), 0_i64..1 << 20],
            at_max in any::<bool>(),
        ) {
            let fastest = limit + VELOCITY_ROUNDING.to_bits();
            let (square, twice) = (i64::from(fastest).pow(2), 512 * i64::from(acceleration));
            let Ok(counts) = i32::try_from((square + twice / 2) / twice) else {
                return Ok(());
            };
            let travel = [-1_i64, 1].map(|side| Position::from_counts(side * 5_000_000_000));
            let middle = ReferenceConfig::middle_of(travel, counts).map(|at| at.0);
            let [position_min, position_max] = travel.map(|at| at.0);
            let limits = Limits {
                velocity: Way::from_bits(limit),
                acceleration: Way::from_bits(acceleration),
                position_min,
                position_max,
                middle,
            };
            let inwards = I56F8::from_bits(beyond);
            prop_assume!(middle[0] < middle[1]);
            let position = if at_max { middle[1] - inwards } else { middle[0] + inwards };
            let velocity = Way::from_bits(i32::try_from(i64::from(fastest) * share / 1024).unwrap());
            let track = Track { position, velocity, acceleration: Way::ZERO };
            prop_assert!(!limits.is_amid(&track) || limits.can_stop(&track), "{track:?}");
        }
    }
}
