//! A track: position, velocity and acceleration of one cycle, in differences.
//!
//! Velocity is the way from the cycle before, acceleration the change of that: no cycle time
//! appears. Everything is in the resolution of a position (10 nm / 256 = 39 pm), so that positions
//! are the exact sum of velocities.

use fixed::types::{I20F12, I24F8, I56F8};

use crate::units::{Acceleration, Position, Velocity, sixteenfold};

/// Way within one cycle, 10 nm with 8 fractional bits: ±84 mm. Also its change from cycle to cycle.
pub(super) type Way = I24F8;

/// Where a track stands.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Track {
    /// Position of the cycle.
    pub(super) position: I56F8,
    /// Way from the cycle before.
    pub(super) velocity: Way,
    /// Change of the velocity from the cycle before.
    pub(super) acceleration: Way,
}

impl Track {
    /// The next cycle at constant acceleration.
    pub(super) fn ahead(self) -> Self {
        let velocity = self.velocity.saturating_add(self.acceleration);
        Self {
            position: moved(self.position, velocity),
            velocity,
            acceleration: self.acceleration,
        }
    }

    /// The next cycle at a given velocity.
    pub(super) fn moved_by(self, velocity: Way) -> Self {
        let acceleration = velocity.saturating_sub(self.velocity);
        Self {
            position: moved(self.position, velocity),
            velocity,
            acceleration,
        }
    }

    /// The next cycle at a given position.
    pub(super) fn moved_to(self, position: I56F8) -> Self {
        self.moved_there(position, way(self.position, position))
    }

    /// The same where the way to that position is known already.
    pub(super) fn moved_there(self, position: I56F8, velocity: Way) -> Self {
        Self {
            position,
            velocity,
            acceleration: velocity.saturating_sub(self.velocity),
        }
    }

    /// The cycle before; its own acceleration is not known any more.
    pub(super) fn before(self) -> Self {
        Self {
            position: moved(self.position, self.velocity.saturating_neg()),
            velocity: self.velocity.saturating_sub(self.acceleration),
            acceleration: self.acceleration,
        }
    }
}

/// `from` plus a way.
pub(super) fn moved(from: I56F8, way: Way) -> I56F8 {
    from.saturating_add(I56F8::from(way))
}

/// The way between two positions, saturated.
pub(super) fn way(from: I56F8, to: I56F8) -> Way {
    Way::saturating_from_num(to.saturating_sub(from))
}

/// The same where it is no farther than a way reaches. `from` is on the axis, within ±2⁵⁵ bits, so
/// the difference cannot wrap round to a short way.
pub(super) fn exact_way(from: I56F8, to: I56F8) -> Option<Way> {
    i32::try_from(to.to_bits().wrapping_sub(from.to_bits()))
        .ok()
        .map(Way::from_bits)
}

/// Whether a magnitude is within a bound; never within a negative one.
pub(super) fn within(value: Way, bound: Way) -> bool {
    value <= bound && value >= bound.wrapping_neg()
}

/// `value` brought into `±bound`; a negative bound counts as zero.
pub(super) fn limited(value: Way, bound: Way) -> Way {
    let bound = bound.max(Way::ZERO);
    value.min(bound).max(bound.saturating_neg())
}

/// A velocity as a way, rounded down to 39 pm.
pub(super) fn way_of(velocity: Velocity) -> Way {
    Way::wrapping_from_num(velocity.0)
}

/// A way as a velocity, saturated.
pub(super) fn velocity_of(way: Way) -> Velocity {
    Velocity(I20F12::from_bits(sixteenfold(way.to_bits())))
}

/// A change of a way as an acceleration, saturated.
pub(super) fn acceleration_of(way: Way) -> Acceleration {
    Acceleration(I20F12::from_bits(sixteenfold(way.to_bits())))
}

/// Positions beyond ±180 000 km / 256 are cut: sums of 256 of them stay within 64 bits, and no axis
/// is that long.
pub(super) fn on_the_axis(position: Position) -> I56F8 {
    position
        .0
        .max(I56F8::from_bits(-REACH_BITS))
        .min(I56F8::from_bits(REACH_BITS))
}

/// 2⁵⁴ of 39 pm: 700 km.
const REACH_BITS: i64 = 1 << 54;
