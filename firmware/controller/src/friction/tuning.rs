//! The level of friction, refined by what the integral makes up for.
//!
//! Friction changes by twice its level where the axis turns round. What the model does not bring
//! of that the integral of the velocity loop does, within its settling time: at the turn it holds
//! what the model lacks one way, afterwards what it lacks the other way. Half of the change is what
//! the level is off by, and a share of that goes into a factor on all levels.
//!
//! ```text
//! factor += share · (I(after) − I(turn)) · direction / (2 · level)
//! ```
//!
//! What is the same both ways (weight, an offset of the drive) falls out. A turn that does not
//! count or comes out of rest, a stop, or torque at its limit tells nothing.

use fixed::types::I8F24;

use crate::direction::Direction;
use crate::units::{Position, PositionError, Torque, narrowed};

/// How the level is refined.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LevelTuning {
    /// Change of the factor per change of the integral, per µN·m with 40 fractional bits; zero
    /// switches it off.
    pub per_micro_nm: i32,
    /// Cycles from the turn until the integral has settled.
    pub settling_cycles: u16,
    /// Way from the turn until friction has built up.
    pub settling_way: PositionError,
}

/// What the setpoint and the loop did in a cycle.
#[derive(Clone, Copy, Debug)]
pub struct Progress {
    /// It has just turned round.
    pub turned: Option<Direction>,
    /// Where it is.
    pub position: Position,
    /// It has stopped.
    pub has_stopped: bool,
    /// Torque is at its limit: nothing is told until the next turn.
    pub is_limited: bool,
    /// Integral of the velocity loop.
    pub integral: Torque,
}

/// The refined factor and what is being measured.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Tuner {
    /// Factor − 1.
    off: I8F24,
    since: Option<Turn>,
    /// It has stopped since the last turn: the next one comes out of rest, where friction is less
    /// than where it slides.
    rested: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Turn {
    direction: Direction,
    position: Position,
    integral: Torque,
    cycles: u16,
}

/// The factor is refined by so much at most, either way: friction that is gone, or twice as much.
const FARTHEST: I8F24 = I8F24::ONE;

impl Tuner {
    /// The factor on all levels.
    pub(super) fn factor(self) -> I8F24 {
        I8F24::ONE.saturating_add(self.off)
    }

    /// The same, with no turn behind it.
    pub(super) const fn at_rest(self) -> Self {
        Self {
            off: self.off,
            since: None,
            rested: true,
        }
    }

    /// Advances by one cycle.
    pub(super) fn step(&mut self, config: LevelTuning, progress: &Progress) {
        self.rested |= progress.has_stopped;
        if progress.has_stopped || progress.is_limited {
            self.since = None;
        }
        if let Some(direction) = progress.turned {
            let turn = Turn {
                direction,
                position: progress.position,
                integral: progress.integral,
                cycles: 0,
            };
            self.since = Some(turn).filter(|_| !self.rested);
            self.rested = false;
            return;
        }
        let Some(turn) = &mut self.since else {
            return;
        };
        turn.cycles = turn.cycles.saturating_add(1);
        let way = progress.position.error_from(turn.position).magnitude();
        if turn.cycles < config.settling_cycles || way < config.settling_way {
            return;
        }
        let change = progress.integral.minus(turn.integral);
        let lacking = match turn.direction {
            Direction::Positive => change,
            Direction::Negative => change.reversed(),
        };
        // 31 times 31 bits: 40 fractional ones, of which 24 stay.
        let product =
            i64::from(lacking.to_micro_nm_lossy()).wrapping_mul(i64::from(config.per_micro_nm));
        let step = I8F24::from_bits(narrowed::<16>(product));
        self.off = self
            .off
            .saturating_add(step)
            .clamp(FARTHEST.saturating_neg(), FARTHEST);
        self.since = None;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fixed::types::{I24F8, I40F24};

    /// A quarter of what an axis with a level of 600 000 µN·m tells, after 50 cycles.
    const CONFIG: LevelTuning = LevelTuning {
        // 2⁴⁰ / 4.8·10⁶.
        per_micro_nm: 229_065,
        settling_cycles: 50,
        settling_way: PositionError(I24F8::const_from_int(1000)),
    };

    /// Beyond the way or not, with such an integral.
    fn progress(counts: i64, integral: i32) -> Progress {
        Progress {
            turned: None,
            position: Position::from_counts(counts),
            has_stopped: false,
            is_limited: false,
            integral: Torque::from_micro_nm(integral),
        }
    }

    /// Turns round, the integral goes from one value to another.
    fn reversal(tuner: &mut Tuner, direction: Direction, [from, to]: [i32; 2]) {
        turn(tuner, direction, from);
        (0..50).for_each(|_| tuner.step(CONFIG, &progress(-1000, to)));
    }

    fn turn(tuner: &mut Tuner, direction: Direction, integral: i32) {
        let turned = Progress {
            turned: Some(direction),
            ..progress(0, integral)
        };
        tuner.step(CONFIG, &turned);
    }

    #[test]
    fn what_the_integral_makes_up_for_after_turns_goes_into_the_factor() {
        let mut tuner = Tuner::default();
        // A weight of 100 000, and levels that are short of 120 000: a fifth.
        let mut lacking = 0.2;
        for turn in 0..30 {
            let made_up = Torque(I40F24::from_num(6.0e5 * lacking)).to_micro_nm_lossy();
            let (low, high) = (100_000 - made_up, 100_000 + made_up);
            if turn % 2 == 0 {
                reversal(&mut tuner, Direction::Positive, [low, high]);
            } else {
                reversal(&mut tuner, Direction::Negative, [high, low]);
            }
            lacking = 1.2 - tuner.factor().to_num::<f64>();
        }
        let factor: f64 = tuner.factor().to_num();
        assert!((factor - 1.2).abs() < 1.0e-3, "{factor}");
    }

    #[test]
    fn a_turn_that_is_spoilt_or_not_over_tells_nothing() {
        let mut tuner = Tuner::default();
        turn(&mut tuner, Direction::Positive, 0);
        (0..1000).for_each(|_| tuner.step(CONFIG, &progress(999, 500_000)));
        let limited = Progress {
            is_limited: true,
            ..progress(999, 500_000)
        };
        tuner.step(CONFIG, &limited);
        (0..1000).for_each(|_| tuner.step(CONFIG, &progress(5000, 500_000)));
        assert_eq!(tuner.factor(), I8F24::ONE);
    }

    #[test]
    fn a_turn_out_of_rest_tells_nothing_and_the_next_one_does() {
        let mut tuner = Tuner::default();
        let stopped = Progress {
            has_stopped: true,
            ..progress(0, 0)
        };
        tuner.step(CONFIG, &stopped);
        reversal(&mut tuner, Direction::Positive, [0, 500_000]);
        assert_eq!(tuner.factor(), I8F24::ONE);
        reversal(&mut tuner, Direction::Negative, [0, -500_000]);
        assert!(tuner.factor() > I8F24::ONE);
    }

    #[test]
    fn the_factor_stays_between_none_and_twice() {
        for (integral, factor) in [(i32::MAX, 2.0), (i32::MIN, 0.0)] {
            let mut tuner = Tuner::default();
            (0..9).for_each(|_| reversal(&mut tuner, Direction::Positive, [0, integral]));
            assert_eq!(tuner.factor().to_num::<f64>(), factor);
        }
    }
}
