//! Backlash compensation: a rate-limited offset on the setpoint.
//!
//! On a change of commanded direction the offset goes from −gap/2 to +gap/2 (or back), so that the
//! table, not the motor, follows the setpoint. The way there is a motion like any other: velocity
//! and acceleration of *setpoint plus offset* never pass the axis' limits, provided that the
//! setpoint alone does not. The offset starts as fast as the headroom allows and brakes by `v = √(2
//! a s)` with half the acceleration.
//!
//! A setpoint that decelerates with more than the other half, or stops at once, leaves the offset
//! no acceleration to brake with. Then the sum passes the acceleration limit, by half of it at
//! most, and the offset keeps its braking curve: it is never beyond half the gap. (When the limit
//! won, the offset went on to 8.9 mm with half a gap of 20 µm.)

use fixed::types::{I20F12, I22F10, I24F8};

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

impl BacklashConfig {
    /// Whether there is no gap.
    #[must_use]
    pub fn is_off(&self) -> bool {
        self.half_gap <= PositionError::ZERO
    }
}

/// Where the offset stands.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BacklashState {
    offset: PositionError,
    velocity: Velocity,
    total: Velocity,
}

impl BacklashState {
    /// The offset of the last cycle.
    #[must_use]
    pub const fn offset(&self) -> PositionError {
        self.offset
    }

    /// A cycle without an offset.
    pub fn pass(&mut self, commanded: Velocity) {
        *self = Self {
            total: commanded,
            ..Self::default()
        };
    }

    /// Advances by one cycle; gives the offset and its velocity.
    pub fn step(
        &mut self,
        config: &BacklashConfig,
        direction: Option<Direction>,
        commanded: Velocity,
    ) -> (PositionError, Velocity) {
        if config.is_off() {
            self.pass(commanded);
            return (self.offset, self.velocity);
        }
        let left = remaining(config.half_gap, direction, self.offset);
        let brake = braking_velocity(left, config.acceleration_limit);
        let wanted = commanded.plus(brake);
        let change = wanted
            .limited(config.velocity_limit)
            .minus(self.total)
            .limited(config.acceleration_limit);
        let velocity = self.total.plus(change).minus(commanded);
        self.velocity = if same_way(velocity, brake) {
            velocity.limited(Velocity(brake.0.saturating_abs()))
        } else {
            self.limited_by_the_end_behind(config, velocity)
        };
        self.total = commanded.plus(self.velocity);
        self.offset = self.offset.plus(self.velocity.way_lossy());
        (self.offset, self.velocity)
    }

    /// It still moves away from where it should go: it brakes before the end on that side, and
    /// stops where a narrower gap has put it beyond that.
    fn limited_by_the_end_behind(&self, config: &BacklashConfig, velocity: Velocity) -> Velocity {
        let left = remaining(config.half_gap, Direction::of(velocity), self.offset);
        let brake = braking_velocity(left, config.acceleration_limit);
        let allowed = if same_way(velocity, brake) {
            brake.0.saturating_abs()
        } else {
            I20F12::ZERO
        };
        velocity.limited(Velocity(allowed))
    }
}

fn same_way(one: Velocity, other: Velocity) -> bool {
    one.0.signum() == other.0.signum()
}

fn remaining(
    half_gap: PositionError,
    direction: Option<Direction>,
    offset: PositionError,
) -> PositionError {
    let target = match direction {
        Some(Direction::Positive) => half_gap.0,
        Some(Direction::Negative) => half_gap.0.saturating_neg(),
        None => I24F8::ZERO,
    };
    PositionError(target.saturating_sub(offset.0))
}

/// The velocity that b = a / 2 brings to rest in the way that is left, `√(2 b s + b² / 4) − b / 2`:
/// half the axis' acceleration, so that the offset can brake while the setpoint accelerates.
/// Counted in cycles the sum `v + (v − b) + …` is v² / 2 b + v / 2, hence the terms in b. Never
/// more than what is left.
fn braking_velocity(left: PositionError, acceleration_limit: Velocity) -> Velocity {
    let way = left.magnitude().0;
    let limit = acceleration_limit.0.max(I20F12::ZERO);
    // 24.8 times 20.12 bits: 20 fractional bits; 20.12 squared has 24, and b² / 4 is a² / 16. The
    // root has 10.
    let square = way.wide_mul(limit).to_bits().unsigned_abs();
    let correction = limit
        .wide_mul(limit)
        .to_bits()
        .unsigned_abs()
        .wrapping_shr(8);
    let root = i32::try_from(root(square.saturating_add(correction))).unwrap_or(i32::MAX);
    let quarter = limit.to_bits().wrapping_shr(4);
    let braked = I20F12::saturating_from_num(I22F10::from_bits(root.saturating_sub(quarter)));
    let speed = braked
        .min(I20F12::saturating_from_num(way))
        .max(I20F12::ZERO);
    Velocity(if left.0 < I24F8::ZERO {
        speed.saturating_neg()
    } else {
        speed
    })
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

    /// Largest velocity and change of velocity of setpoint plus offset along a setpoint that
    /// accelerates in pieces, at most by a share of the limit.
    fn extremes(gap: i32, share: f64, changes: &[(f64, usize)]) -> (f64, f64) {
        let config = config(gap, 3000, 20.0);
        let (mut state, mut commanded, mut before, mut direction) =
            (BacklashState::default(), 0.0_f64, 0.0_f64, None);
        let mut largest = (0.0_f64, 0.0_f64);
        for acceleration in changes
            .iter()
            .flat_map(|(acceleration, cycles)| std::iter::repeat_n(acceleration, *cycles))
        {
            commanded = (commanded + acceleration * share * 20.0).clamp(-3000.0, 3000.0);
            let setpoint = Velocity(I20F12::from_num(commanded));
            direction = Direction::of(setpoint).or(direction);
            let (_, extra) = state.step(&config, direction, setpoint);
            let total: f64 = setpoint.plus(extra).0.to_num();
            largest = (
                largest.0.max(total.abs()),
                largest.1.max((total - before).abs()),
            );
            before = total;
        }
        largest
    }

    #[test]
    fn a_gap_made_narrower_on_the_way_never_lets_the_offset_grow_beyond_it() {
        // Half a gap of 50 µm, 5 m/s² at 1 kHz; narrower at each cycle of the way in turn.
        for narrower_at in 1..20 {
            let mut state = BacklashState::default();
            let (wide, narrow) = (config(10_000, 50_000, 500.0), config(1_000, 50_000, 500.0));
            for cycle in 0..60 {
                let before = state.offset.magnitude();
                let config = if cycle < narrower_at { &wide } else { &narrow };
                // The commanded direction turns as the gap is made narrower, or stays.
                for direction in [Direction::Positive, Direction::Negative] {
                    let turned = if cycle < narrower_at {
                        Direction::Positive
                    } else {
                        direction
                    };
                    let mut one = state;
                    one.step(config, Some(turned), Velocity::ZERO);
                    assert!(
                        one.offset.magnitude() <= before.max(config.half_gap),
                        "{narrower_at} {cycle}: {one:?}"
                    );
                }
                state.step(config, Some(Direction::Positive), Velocity::ZERO);
            }
            assert_eq!(state.offset, narrow.half_gap);
        }
    }

    proptest! {
        #[test]
        fn setpoint_plus_offset_keeps_the_limits_while_the_setpoint_uses_less_than_half_the_acceleration(
            gap in 0_i32..40_000, changes in proptest::collection::vec((-1.0_f64..1.0, 1_usize..200), 1..20),
        ) {
            let (velocity, acceleration) = extremes(gap, 0.43, &changes);
            prop_assert!(velocity <= 3000.0 + 1e-3 && acceleration <= 20.0 + 2e-3, "{velocity} {acceleration}");
        }

        /// Half the limit and the eighth of that by which the last cycle of a discrete braking
        /// differs.
        #[test]
        fn beyond_that_it_passes_the_acceleration_by_nine_sixteenths_at_most(
            gap in 0_i32..40_000, changes in proptest::collection::vec((-1.0_f64..1.0, 1_usize..200), 1..20),
        ) {
            let (velocity, acceleration) = extremes(gap, 1.0, &changes);
            prop_assert!(velocity <= 3000.0 + 1e-3 && acceleration <= 31.25 + 2e-3, "{velocity} {acceleration}");
        }
    }

    proptest! {
        /// Paths that jump in velocity, which no axis can follow: the limits then cannot hold as
        /// well, and the offset wins.
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
                    let before = state.offset;
                    let (offset, extra) = state.step(&config, direction, setpoint);
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
        for cycle in 0..2000 {
            let velocity = if cycle < 100 { fast } else { Velocity::ZERO };
            state.step(&config, Some(Direction::Positive), velocity);
            assert!(
                state.offset <= config.half_gap,
                "cycle {cycle}: {:?}",
                state.offset
            );
        }
        assert!(
            (state.offset.0.to_num::<f64>() - 2000.0).abs() < 1.0,
            "{:?}",
            state.offset
        );
    }

    #[test]
    fn the_offset_arrives_at_half_the_gap_and_stays_there() {
        let config = config(4000, 3000, 20.0);
        let mut state = BacklashState::default();
        let slow = Velocity(I20F12::from_num(10));
        let mut arrived = None;
        for cycle in 0..1000 {
            let (offset, _) = state.step(&config, Some(Direction::Positive), slow);
            assert!(
                offset <= PositionError(config.half_gap.0 + I24F8::from_num(0.01)),
                "overshoot at {cycle}"
            );
            if arrived.is_none() && (offset.0.to_num::<f64>() - 2000.0).abs() < 1.0 {
                arrived = Some(cycle);
            }
        }
        // 2000 counts with 20 up and 10 down per cycle²: at least √(2·2000·(1/20 + 1/10)) = 24
        // cycles.
        assert!(matches!(arrived, Some(20..=60)), "{arrived:?}");
    }

    #[test]
    fn without_a_gap_the_setpoint_passes_untouched_even_beyond_the_limits() {
        let fast = Velocity(I20F12::from_num(5000));
        let (offset, extra) =
            BacklashState::default().step(&config(0, 3000, 20.0), Some(Direction::Positive), fast);
        assert_eq!((offset, extra), (PositionError::ZERO, Velocity::ZERO));
    }
}
