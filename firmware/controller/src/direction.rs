//! Commanded direction and its changes.
//!
//! Coulomb feedforward and backlash compensation act on the *commanded* direction: the sign of the
//! setpoint's velocity, held through standstill. The reversal unit acts on reversals that count
//! ([`Turns`]): those after a way of some length.

use core::cmp::Ordering;

use crate::units::{Position, PositionError, Velocity};

/// Direction of motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// Towards positive position.
    Positive,
    /// Towards negative position.
    Negative,
}

impl Direction {
    /// The other one.
    #[must_use]
    pub const fn opposite(self) -> Self {
        match self {
            Self::Positive => Self::Negative,
            Self::Negative => Self::Positive,
        }
    }

    /// The direction of a velocity; `None` at standstill.
    #[must_use]
    pub fn of(velocity: Velocity) -> Option<Self> {
        Self::by(velocity.cmp(&Velocity::ZERO))
    }

    /// The direction of a way; `None` of none.
    #[must_use]
    pub fn of_way(way: PositionError) -> Option<Self> {
        Self::by(way.cmp(&PositionError::ZERO))
    }

    const fn by(sign: Ordering) -> Option<Self> {
        match sign {
            Ordering::Greater => Some(Self::Positive),
            Ordering::Less => Some(Self::Negative),
            Ordering::Equal => None,
        }
    }
}

/// Remembers the commanded direction through standstill: by the last velocity that was one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct DirectionMemory(Velocity);

impl DirectionMemory {
    /// Takes the commanded velocity.
    pub fn take(&mut self, commanded: Velocity) {
        if commanded != Velocity::ZERO {
            self.0 = commanded;
        }
    }

    /// The direction last commanded, `None` before the first motion.
    #[must_use]
    pub fn last(self) -> Option<Direction> {
        Direction::of(self.0)
    }
}

/// Remembers where the setpoint comes from: which way, and how far.
///
/// A reversal counts after a way of some length. What goes to and fro within less is a jog or noise
/// of the setpoint, and does not turn friction round.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Turns {
    at: Option<Position>,
    direction: Option<Direction>,
    /// Way in that direction since the last turn, up to the one that counts.
    gone: PositionError,
    /// Cycles since it moved last.
    stood: u16,
}

impl Turns {
    /// Takes the next position; gives the new direction at a reversal that counts.
    ///
    /// The first motion after a reset is no reversal: friction has no sign to change yet.
    pub fn reversal(&mut self, shortest: PositionError, to: Position) -> Option<Direction> {
        let way = self.at.map_or(PositionError::ZERO, |at| to.error_from(at));
        self.at = Some(to);
        let Some(direction) = Direction::of_way(way) else {
            self.stood = self.stood.saturating_add(1);
            return None;
        };
        self.stood = 0;
        let way = way.magnitude();
        if self.direction.is_none_or(|own| own == direction) {
            self.direction = Some(direction);
            self.gone = self.gone.plus(way).min(shortest);
            return None;
        }
        let counts = self.gone >= shortest;
        let left = self.gone.minus(way);
        if counts {
            (self.direction, self.gone) = (Some(direction), way.min(shortest));
        } else if left < PositionError::ZERO {
            (self.direction, self.gone) = (Some(direction), left.magnitude().min(shortest));
        } else {
            self.gone = left;
        }
        counts.then_some(direction)
    }

    /// Whether the setpoint has not moved for so many cycles.
    #[must_use]
    pub const fn has_stood(&self, cycles: u16) -> bool {
        self.stood >= cycles
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fixed::types::{I20F12, I24F8};

    #[test]
    fn the_direction_is_held_through_a_dwell() {
        let mut memory = DirectionMemory::default();
        let held = [0, 1, 0, -1, 0].map(|v| {
            memory.take(Velocity(I20F12::from_num(v)));
            memory.last()
        });
        let [on, back] = [Direction::Positive, Direction::Negative].map(Some);
        assert_eq!(held, [None, on, on, back, back]);
    }

    /// The reversals that count along positions, after ways of 100 counts.
    fn reversals(positions: &[i64]) -> Vec<Option<Direction>> {
        let mut turns = Turns::default();
        let each = positions
            .iter()
            .map(|at| turns.reversal(SHORTEST, Position::from_counts(*at)));
        each.collect()
    }

    const SHORTEST: PositionError = PositionError(I24F8::const_from_int(100));
    const BACK: Option<Direction> = Some(Direction::Negative);
    const ON: Option<Direction> = Some(Direction::Positive);

    #[test]
    fn a_dwell_does_not_hide_a_reversal_and_makes_none() {
        assert_eq!(
            reversals(&[0, 150, 150, 149, 149, 20, 40]),
            [None, None, None, BACK, None, None, ON]
        );
        assert_eq!(reversals(&[0, 150, 150, 300]), [None; 4]);
    }

    #[test]
    fn to_and_fro_within_less_than_the_way_counts_once() {
        // After a way the first turn counts; what flips about it does not.
        assert_eq!(
            reversals(&[0, 150, 149, 151, 140, 160, 20, 300]),
            [None, None, BACK, None, None, None, None, ON]
        );
        // On from rest, 60 back, 120 on: never 100 one way before a turn.
        assert_eq!(
            reversals(&[0, 60, 0, 120, 90]),
            [None, None, None, None, BACK]
        );
    }

    #[test]
    fn a_way_back_that_was_too_short_to_count_is_a_way_all_the_same() {
        // 50 on, then 250 back: no reversal that counted, but the next one does.
        assert_eq!(reversals(&[0, 50, -200, -199]), [None, None, None, ON]);
    }

    #[test]
    fn a_setpoint_has_stood_for_the_cycles_in_which_it_did_not_move() {
        let mut turns = Turns::default();
        let stops = [0, 5, 5, 5, 5, 5, 6].map(|at| {
            turns.reversal(SHORTEST, Position::from_counts(at));
            turns.has_stood(4)
        });
        assert_eq!(stops, [false, false, false, false, false, true, false]);
    }
}
