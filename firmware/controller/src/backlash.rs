//! Backlash compensation: a rate-limited offset on the setpoint.
//!
//! On a change of commanded direction the offset goes from −gap/2 to +gap/2 (or back), so that the table, not the
//! motor, follows the setpoint. The way there is a motion like any other: velocity and acceleration of *setpoint plus offset*
//! never pass the axis' limits, provided that the setpoint alone does not. The offset starts as fast as the headroom allows and brakes by
//! `v = √(2 a s)`. Where the setpoint itself breaks a limit (it stops at once), sum and offset cannot both keep theirs: then the offset wins and stays within half the
//! gap. Before that the axis' deceleration went on into the offset, 8.9 mm with half a gap of 20 µm.

use fixed::types::{I20F12, I24F8};

use crate::direction::Direction;
use crate::root::root;
use crate::units::{PositionError, Velocity};

/// Parameters of the compensation.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BacklashConfig {
    /// Half the gap; zero switches it off.
    pub half_gap: PositionError,
    /// Velocity limit of the axis.
    pub velocity_limit: Velocity,
    /// Acceleration limit of the axis, per cycle.
    pub acceleration_limit: Velocity,
}

/// Where the offset stands.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BacklashState {
    offset: PositionError,
    velocity: Velocity,
    total: Velocity,
}

impl BacklashState {
    /// Advances by one cycle; gives the offset and its velocity.
    pub fn step(
        &mut self,
        config: &BacklashConfig,
        direction: Option<Direction>,
        commanded: Velocity,
    ) -> (PositionError, Velocity) {
        if config.half_gap <= PositionError::ZERO {
            *self = Self { total: commanded, ..Self::default() };
            return (self.offset, self.velocity);
        }
        let left = remaining(config.half_gap, direction, self.offset);
        let wanted = commanded.plus(braking_velocity(left, config.acceleration_limit));
        let change = wanted.limited(config.velocity_limit).minus(self.total).limited(config.acceleration_limit);
        self.move_by(self.total.plus(change).minus(commanded), config.half_gap);
        self.total = commanded.plus(self.velocity);
        (self.offset, self.velocity)
    }

    /// Stops at half the gap, whatever the velocity was.
    fn move_by(&mut self, velocity: Velocity, half_gap: PositionError) {
        let before = self.offset;
        let there = before.plus(velocity.way_lossy());
        self.offset = PositionError(there.0.min(half_gap.0).max(half_gap.0.saturating_neg()));
        let is_cut = self.offset != there;
        self.velocity = if is_cut {
            Velocity(I20F12::saturating_from_num(self.offset.0.saturating_sub(before.0)))
        } else {
            velocity
        };
    }
}

fn remaining(half_gap: PositionError, direction: Option<Direction>, offset: PositionError) -> PositionError {
    let target = match direction {
        Some(Direction::Positive) => half_gap.0,
        Some(Direction::Negative) => half_gap.0.saturating_neg(),
        None => I24F8::ZERO,
    };
    PositionError(target.saturating_sub(offset.0))
}

/// √(2 a s) with half the axis' acceleration, so that the offset can brake while the setpoint accelerates; never more than what is
/// left, so that it does not overshoot in the last cycle.
fn braking_velocity(left: PositionError, acceleration_limit: Velocity) -> Velocity {
    let way = left.magnitude().0;
    // 24.8 times 20.12 bits: 20 fractional bits; the root of that has 10.
    let square = way.wide_mul(acceleration_limit.0.max(I20F12::ZERO)).to_bits().unsigned_abs();
    let root = i32::try_from(root(square)).unwrap_or(i32::MAX);
    let speed =
        I20F12::saturating_from_num(fixed::types::I22F10::from_bits(root)).min(I20F12::saturating_from_num(way));
    Velocity(if left.0 < I24F8::ZERO { speed.saturating_neg() } else { speed })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn config(gap: i32, velocity: i32, acceleration: f64) -> BacklashConfig {
        BacklashConfig {
            half_gap: PositionError(I24F8::from_num(gap) / 2),
            velocity_limit: Velocity(I20F12::from_num(velocity)),
            acceleration_limit: Velocity(I20F12::from_num(acceleration)),
        }
    }

    proptest! {
        /// Setpoints within the limits, in jumps of acceleration; the sum stays within them too.
        #[test]
        fn setpoint_plus_offset_never_passes_the_axis_limits(
            gap in 0_i32..40_000, changes in proptest::collection::vec((-1.0_f64..1.0, 1_usize..200), 1..20),
        ) {
            let (limit_v, limit_a) = (3000.0, 20.0);
            let config = config(gap, 3000, limit_a);
            let (mut state, mut commanded, mut before) = (BacklashState::default(), 0.0_f64, 0.0_f64);
            let mut direction = None;
            for (acceleration, cycles) in changes {
                for _ in 0..cycles {
                    commanded = (commanded + acceleration * limit_a).clamp(-limit_v, limit_v);
                    let setpoint = Velocity(I20F12::from_num(commanded));
                    direction = Direction::of(setpoint).or(direction);
                    let (_, extra) = state.step(&config, direction, setpoint);
                    let total: f64 = setpoint.plus(extra).0.to_num();
                    prop_assert!(total.abs() <= limit_v + 1e-3);
                    prop_assert!((total - before).abs() <= limit_a + 1e-3, "{before} to {total}");
                    before = total;
                }
            }
        }
    }

    proptest! {
        /// Paths that jump in velocity, which no axis can follow: the limits then cannot hold as well, and the offset wins.
        #[test]
        fn the_offset_is_never_beyond_half_the_gap(
            gap in 0_i32..40_000, changes in proptest::collection::vec((-3000_i32..3000, 1_usize..200), 1..20),
        ) {
            let config = config(gap, 3000, 20.0);
            let (mut state, mut direction) = (BacklashState::default(), None);
            for (velocity, cycles) in changes {
                let setpoint = Velocity(I20F12::from_num(velocity));
                direction = Direction::of(setpoint).or(direction);
                for _ in 0..cycles {
                    let (before, (offset, extra)) = (state.offset, state.step(&config, direction, setpoint));
                    prop_assert!(offset.magnitude() <= config.half_gap, "{offset:?}");
                    prop_assert!((extra.0.to_num::<f64>() - (offset.0 - before.0).to_num::<f64>()).abs() < 0.005);
                }
            }
        }
    }

    #[test]
    fn a_path_that_stops_at_once_leaves_the_offset_within_half_the_gap() {
        let config = config(4000, 3000, 5.0);
        let mut state = BacklashState::default();
        let fast = Velocity(I20F12::from_num(2900));
        (0..100).for_each(|_| drop(state.step(&config, Some(Direction::Positive), fast)));
        (0..2000).for_each(|_| drop(state.step(&config, Some(Direction::Positive), Velocity::ZERO)));
        assert!((state.offset.0.to_num::<f64>() - 2000.0).abs() < 1.0, "{:?}", state.offset);
    }

    #[test]
    fn the_offset_arrives_at_half_the_gap_and_stays_there() {
        let config = config(4000, 3000, 20.0);
        let mut state = BacklashState::default();
        let slow = Velocity(I20F12::from_num(10));
        let mut arrived = None;
        for cycle in 0..1000 {
            let (offset, _) = state.step(&config, Some(Direction::Positive), slow);
            assert!(offset <= PositionError(config.half_gap.0 + I24F8::from_num(0.01)), "overshoot at {cycle}");
            if arrived.is_none() && (offset.0.to_num::<f64>() - 2000.0).abs() < 1.0 {
                arrived = Some(cycle);
            }
        }
        // 2000 counts with 20 up and 10 down per cycle²: at least √(2·2000·(1/20 + 1/10)) = 24 cycles.
        assert!(matches!(arrived, Some(20..=60)), "{arrived:?}");
    }

    #[test]
    fn without_a_gap_the_setpoint_passes_untouched_even_beyond_the_limits() {
        let fast = Velocity(I20F12::from_num(5000));
        let (offset, extra) = BacklashState::default().step(&config(0, 3000, 20.0), Some(Direction::Positive), fast);
        assert_eq!((offset, extra), (PositionError::ZERO, Velocity::ZERO));
    }
}
