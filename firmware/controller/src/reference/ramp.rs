//! The ramp to standstill: a deceleration that is led up, held, and led down so that velocity and
//! deceleration end together.
//!
//! With speed u and jerk J per cycle, leading a deceleration d down to zero takes off
//! `d + (d − J) + (d − 2 J) + … = d² / 2 J + d / 2` of speed (exact where d is a multiple of J).
//! So the deceleration of a cycle is the largest that still leaves that much:
//!
//! ```text
//! d = min(d_before + J, D, √(2 J u + J² / 4) − J / 2)
//! ```
//!
//! From u at constant velocity the way is u² / 2 D + u D / 2 J. In the last two cycles the change
//! may be up to an eighth above J, where the speed is no multiple of the grid. Where the axis
//! stands, or would turn, it is done: a ramp never turns round.

use super::track::{Track, Way};
use crate::root::root;

/// Velocity of the next cycle; `deceleration` within the axis' limit, `jerk` zero for none,
/// `velocity_limit` holds before the jerk does.
pub(super) fn next_velocity(
    track: Track,
    deceleration: Way,
    jerk: Way,
    velocity_limit: Way,
) -> Way {
    let forwards = track.velocity >= Way::ZERO;
    let (speed, against) = if forwards {
        (track.velocity, track.acceleration.saturating_neg())
    } else {
        (track.velocity.saturating_neg(), track.acceleration)
    };
    let taken = led(speed, against, deceleration, jerk);
    let next = speed
        .saturating_sub(taken.max(speed.saturating_sub(velocity_limit).min(deceleration)))
        .max(Way::ZERO);
    if forwards {
        next
    } else {
        next.saturating_neg()
    }
}

/// Speed that this cycle takes off; negative while an acceleration is still led down.
fn led(speed: Way, against: Way, deceleration: Way, jerk: Way) -> Way {
    if jerk <= Way::ZERO {
        return deceleration;
    }
    let up = against
        .saturating_add(jerk)
        .min(deceleration)
        .min(led_down(speed, jerk));
    up.max(against.saturating_sub(jerk)).min(deceleration)
}

/// √(2 J u + J² / 4) − J / 2: the deceleration from which the rest of the speed goes while it is
/// led down.
fn led_down(speed: Way, jerk: Way) -> Way {
    // 24.8 times 24.8 bits: 16 fractional bits; the root of that has 8. Speed and jerk are not
    // negative here.
    let [speed, bits] = [speed, jerk].map(|way| u64::from(way.to_bits().unsigned_abs()));
    let square = bits
        .wrapping_mul(speed)
        .wrapping_mul(2)
        .saturating_add(bits.wrapping_mul(bits).wrapping_shr(2));
    let root = Way::from_bits(i32::try_from(root(square)).unwrap_or(i32::MAX));
    // At least one bit, so that it ends.
    root.saturating_sub(Way::from_bits(jerk.to_bits().wrapping_shr(1)))
        .max(Way::DELTA)
}
