//! Commanded direction and its changes.
//!
//! The reversal unit, Coulomb feedforward and backlash compensation all act on a change of
//! *commanded* direction: the sign of the setpoint's velocity, held through standstill.

use crate::units::Velocity;

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
        match velocity.0.cmp(&Velocity::ZERO.0) {
            core::cmp::Ordering::Greater => Some(Self::Positive),
            core::cmp::Ordering::Less => Some(Self::Negative),
            core::cmp::Ordering::Equal => None,
        }
    }
}

/// Remembers the commanded direction through standstill.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct DirectionMemory(Option<Direction>);

impl DirectionMemory {
    /// Takes the commanded velocity; gives the new direction where it has just reversed.
    ///
    /// The first motion after a reset is no reversal: friction has no sign to change yet.
    pub fn reversal(&mut self, commanded: Velocity) -> Option<Direction> {
        let now = Direction::of(commanded)?;
        let before = self.0.replace(now);
        (before.is_some() && before != Some(now)).then_some(now)
    }

    /// The direction last commanded; `None` before the first motion.
    #[must_use]
    pub const fn last(self) -> Option<Direction> {
        self.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fixed::types::I20F12;

    fn reversals(velocities: &[i32]) -> Vec<Option<Direction>> {
        let mut memory = DirectionMemory::default();
        velocities
            .iter()
            .map(|v| memory.reversal(Velocity(I20F12::from_num(*v))))
            .collect()
    }

    #[test]
    fn a_dwell_does_not_hide_a_reversal_and_makes_none() {
        assert_eq!(
            reversals(&[1, 0, 0, -1, 0, -1]),
            [None, None, None, Some(Direction::Negative), None, None]
        );
        assert_eq!(reversals(&[0, 1, 0, 1]), [None; 4]);
    }
}
