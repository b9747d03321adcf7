//! The controlled stop: a ramp of the setpoint from its last velocity to standstill.

use controller::units::{Position, Velocity};

/// Setpoint generator of a controlled stop.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stop {
    position: Position,
    velocity: Velocity,
    cycles_left: u16,
}

impl Stop {
    /// Starts from the last setpoint; takes at most `cycles`.
    #[must_use]
    pub const fn from(position: Position, velocity: Velocity, cycles: u16) -> Self {
        Self { position, velocity, cycles_left: cycles }
    }

    /// The next setpoint; `None` when the axis stands or the time is over.
    pub fn step(&mut self, deceleration: Velocity) -> Option<Position> {
        self.cycles_left = self.cycles_left.checked_sub(1)?;
        if self.velocity == Velocity::ZERO {
            return None;
        }
        self.velocity = self.velocity.minus(self.velocity.limited(deceleration));
        self.position = self.position.after(self.velocity);
        Some(self.position)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fixed::types::I20F12;

    fn cycles(velocity: i32, deceleration: i32, limit: u16) -> usize {
        let mut stop = Stop::from(Position::default(), Velocity(I20F12::from_num(velocity)), limit);
        std::iter::from_fn(|| stop.step(Velocity(I20F12::from_num(deceleration)))).count()
    }

    #[test]
    fn the_ramp_ends_at_standstill_or_at_its_time_limit() {
        assert_eq!(cycles(100, 10, 200), 10);
        assert_eq!(cycles(-95, 10, 200), 10);
        assert_eq!(cycles(100_000, 10, 200), 200);
        assert_eq!(cycles(0, 10, 200), 0);
    }
}
