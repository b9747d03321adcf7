//! Friction on both sides of the screw: of the guide that carries the table, and of what turns with
//! the motor, as bearings and the nut do. Only the first winds the screw up.

use super::{Body, Friction, State};

/// Friction of the table, and of the motor where it has some.
#[derive(Clone, Debug)]
pub struct Sides {
    /// At the table.
    pub table: Friction,
    /// At the motor.
    pub motor: Option<Friction>,
}

impl From<Friction> for Sides {
    fn from(table: Friction) -> Self {
        Self { table, motor: None }
    }
}

impl Sides {
    /// Momentum that the motor's friction takes within a sub-step; advances its state.
    pub fn taken_of_motor(&mut self, motor: Body) -> f64 {
        let left = |friction: &mut Friction| friction.advance(motor);
        let velocity = self.motor.as_mut().map_or(motor.free_velocity, left);
        motor.mass_kg * (motor.free_velocity - velocity)
    }

    /// The internal states, to go back to with [`Self::restore`].
    #[must_use]
    pub fn state(&self) -> (State, Option<State>) {
        (self.table.state(), self.motor.as_ref().map(Friction::state))
    }

    /// Goes back to states.
    pub fn restore(&mut self, (table, motor): (State, Option<State>)) {
        self.table.restore(table);
        if let (Some(friction), Some(state)) = (&mut self.motor, motor) {
            friction.restore(state);
        }
    }
}
