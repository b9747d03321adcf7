//! The pulse over the acceleration at which the setpoint turns round.
//!
//! On a circle that is v² / r. Friction turns round within a way, so the faster the setpoint leaves
//! a reversal the shorter and the higher its pulse has to be: with x ≈ a t² / 2 times go with 1/√a,
//! and heights and rates of decay about with √a. So points stand at accelerations of which each is
//! four times the one before, and between them everything is straight over √a. There is one root at
//! a reversal and no division.

use fixed::FixedI64;
use fixed::types::extra::U32;
use fixed::types::{I2F30, I20F12};

use super::Shape;
use crate::direction::Direction;
use crate::root::{root, root_of_word};
use crate::units::{Velocity, lower};

/// Points of a schedule: 4⁸ from the first acceleration to the last one.
pub const POINTS: usize = 9;

/// The pulse at one acceleration.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Point {
    /// Height where the axis turns towards positive position.
    pub forward: Velocity,
    /// And where it turns towards negative position.
    pub backward: Velocity,
    /// exp(−T_cycle / T_comp), 0…1.
    pub decay: I2F30,
    /// Cycles from the reversal to the start of the pulse.
    pub start_delay_cycles: u16,
}

/// Pulses over the acceleration.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Schedule {
    /// 1 / √a of the first point: 2³² over its root.
    per_root: u32,
    mean_log2: u32,
    points: [Point; POINTS],
}

impl Schedule {
    /// Points from a first acceleration on, which is given in 10 nm per cycle² with 32 fractional
    /// bits; accelerations are means of about 2ⁿ cycles. `None` where the first one is zero.
    #[must_use]
    pub fn new(first: u64, mean_log2: u8, points: [Point; POINTS]) -> Option<Self> {
        Some(Self {
            per_root: u32::MAX.checked_div(root(first))?,
            mean_log2: u32::from(mean_log2),
            points,
        })
    }

    /// The pulse of a reversal. Below the first point its height goes to zero with √a, beyond the
    /// last one it stays.
    pub(super) fn shape(&self, mean: MeanAcceleration, direction: Direction) -> Shape {
        let [first, .., last] = &self.points;
        let over_first = root_of(mean)
            .wrapping_mul(u64::from(self.per_root))
            .wrapping_shr(ONE_LOG2);
        let Some(place) = over_first.max(1).ilog2().checked_sub(ONE_LOG2) else {
            let nothing = Point {
                forward: Velocity::ZERO,
                backward: Velocity::ZERO,
                ..*first
            };
            return between(&nothing, first, share_of(over_first), direction);
        };
        let at = usize::try_from(place).unwrap_or(POINTS);
        let [from, to] = [at, at.saturating_add(1)].map(|at| self.points.get(at).unwrap_or(last));
        let within = over_first.wrapping_shr(place).wrapping_sub(1 << ONE_LOG2);
        between(from, to, share_of(within), direction)
    }
}

/// Fractional bits of a root over the first one, and of a share.
const ONE_LOG2: u32 = 16;

/// √a to the first 16 digits of the root.
fn root_of(mean: MeanAcceleration) -> u64 {
    let square = mean.0.to_bits().unsigned_abs();
    let pairs_off = 33_u32
        .saturating_sub(square.leading_zeros())
        .wrapping_shr(1);
    let head = u32::try_from(square.wrapping_shr(pairs_off.wrapping_mul(2)));
    u64::from(root_of_word(head.unwrap_or(u32::MAX))).wrapping_shl(pairs_off)
}

/// Below one.
fn share_of(bits: u64) -> i64 {
    i64::try_from(bits).unwrap_or_default()
}

fn between(from: &Point, to: &Point, share: i64, direction: Direction) -> Shape {
    let on = |from: i32, to: i32| {
        let way = i64::from(to)
            .wrapping_sub(i64::from(from))
            .wrapping_mul(share);
        // Between the two.
        from.wrapping_add(lower(way.wrapping_shr(ONE_LOG2)))
    };
    let height = |point: &Point| match direction {
        Direction::Positive => point.forward.0.to_bits(),
        Direction::Negative => point.backward.0.to_bits(),
    };
    let delay = |point: &Point| i32::from(point.start_delay_cycles);
    Shape {
        amplitude: Velocity(I20F12::from_bits(on(height(from), height(to)))),
        decay: I2F30::from_bits(on(from.decay.to_bits(), to.decay.to_bits())),
        start_delay_cycles: u16::try_from(on(delay(from), delay(to))).unwrap_or_default(),
    }
}

/// Acceleration of the setpoint, 10 nm per cycle²: mean of the last cycles, the older the less.
///
/// A slow circle's is less than the resolution of a setpoint: 0.003 counts at R 100 mm, 100 mm/min
/// and 1 kHz. Differences of velocities fall out of the mean, so that their rounding is divided by
/// its length.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MeanAcceleration(FixedI64<U32>);

impl MeanAcceleration {
    /// Takes the change of the velocity to the next cycle.
    pub(super) fn take(&mut self, schedule: &Schedule, change: Velocity) {
        // Below 2⁵² bits, and so is every mean of them.
        let off = FixedI64::<U32>::from(change.0).wrapping_sub(self.0);
        let step = FixedI64::from_bits(off.to_bits().wrapping_shr(schedule.mean_log2));
        self.0 = self.0.wrapping_add(step);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fixed::types::I32F32;
    use proptest::prelude::*;

    /// Heights go with √a from 100 counts per cycle on, backwards half of that; T_comp from 64
    /// cycles with 1 / √a; the delay of the first four points is 30, 20, 10 and 0 cycles.
    fn schedule() -> Schedule {
        let points = core::array::from_fn(|i| {
            let octaves = i32::try_from(i).unwrap();
            let height = 100.0 * 2.0_f64.powi(octaves);
            Point {
                forward: Velocity(I20F12::from_num(height)),
                backward: Velocity(I20F12::from_num(0.5 * height)),
                decay: I2F30::from_num((-2.0_f64.powi(octaves) / 64.0).exp()),
                start_delay_cycles: u16::try_from(3_usize.saturating_sub(i) * 10).unwrap(),
            }
        });
        Schedule::new(FIRST, 4, points).unwrap()
    }

    /// 0.003 counts per cycle².
    const FIRST: u64 = 12_884_902;

    fn at(times: f64, direction: Direction) -> Shape {
        let mean = I32F32::from_num(times) * I32F32::from_bits(i64::try_from(FIRST).unwrap());
        schedule().shape(MeanAcceleration(mean), direction)
    }

    fn height(times: f64, direction: Direction) -> f64 {
        at(times, direction).amplitude.0.to_num()
    }

    #[test]
    fn the_points_are_met_and_the_last_one_stays() {
        for i in 0..9_i32 {
            let wanted = 100.0 * 2.0_f64.powi(i);
            for sign in [1.0, -1.0] {
                let got = height(sign * 4.0_f64.powi(i), Direction::Positive);
                assert!((got / wanted - 1.0).abs() < 1.0e-3, "{i}: {got}");
            }
        }
        assert!((height(1.0e7, Direction::Positive) / 25_600.0 - 1.0).abs() < 1.0e-6);
        assert!((height(16.0, Direction::Negative) / 200.0 - 1.0).abs() < 1.0e-3);
        assert_eq!(
            at(4.0, Direction::Positive).start_delay_cycles,
            19,
            "20, rounded down"
        );
    }

    #[test]
    fn below_the_first_point_the_pulse_goes_to_nothing() {
        assert_eq!(height(0.0, Direction::Positive), 0.0);
        let quarter = at(0.25 * 0.25, Direction::Positive);
        let got: f64 = quarter.amplitude.0.to_num();
        assert!((got - 25.0).abs() < 0.1, "{got}");
        assert_eq!(quarter.decay, at(1.0, Direction::Positive).decay);
    }

    #[test]
    fn a_first_point_at_no_acceleration_is_refused() {
        assert_eq!(Schedule::new(0, 4, [Point::default(); POINTS]), None);
    }

    #[test]
    fn the_mean_of_a_slow_circle_is_its_acceleration_though_no_setpoint_shows_it() {
        // R 100 mm, 100 mm/min, 1 kHz; positions in 2⁻⁸ counts.
        let (radius, rate) = (1.0e7_f64, 1.0e-3 * 0.1 / 60.0 / 0.1);
        let position = |cycle: i32| (radius * (rate * f64::from(cycle)).cos() * 256.0).round();
        let velocity =
            |cycle: i32| I20F12::from_num((position(cycle) - position(cycle - 1)) / 256.0);
        let mut mean = MeanAcceleration::default();
        for cycle in -1000..=0 {
            mean.take(&schedule(), Velocity(velocity(cycle + 1) - velocity(cycle)));
        }
        let got: f64 = mean.0.to_num();
        assert!((got / (-radius * rate * rate) - 1.0).abs() < 0.1, "{got}");
    }

    proptest! {
        #[test]
        fn between_two_points_is_what_is_straight_over_the_root(times in 1.0_f64..65_000.0) {
            let got = height(times, Direction::Positive);
            prop_assert!((got / (100.0 * times.sqrt()) - 1.0).abs() < 1.0e-3, "{}", got);
        }

        #[test]
        fn whatever_the_table_says_a_pulse_is_within_it(
            heights in proptest::array::uniform9(any::<i32>()),
            first in 1_u64..,
            mean in any::<i64>(),
            cycles in any::<u16>(),
        ) {
            let points = heights.map(|bits| Point {
                forward: Velocity(I20F12::from_bits(bits)),
                backward: Velocity(I20F12::from_bits(bits)),
                decay: I2F30::from_bits(1 << 29),
                start_delay_cycles: cycles,
            });
            let Some(schedule) = Schedule::new(first, 7, points) else {
                return Ok(());
            };
            let mean = MeanAcceleration(FixedI64::from_bits(mean));
            let shape = schedule.shape(mean, Direction::Positive);
            let [low, high] = [
                heights.iter().copied().min().unwrap_or(0).min(0),
                heights.iter().copied().max().unwrap_or(0).max(0),
            ];
            prop_assert!((low..=high).contains(&shape.amplitude.0.to_bits()));
            prop_assert_eq!(shape.decay, I2F30::from_bits(1 << 29));
            prop_assert_eq!(shape.start_delay_cycles, cycles);
        }
    }
}
