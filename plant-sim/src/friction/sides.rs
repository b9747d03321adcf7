//! Friction on both sides of the screw: of the guide that carries the table, and of what turns with
//! the motor, as bearings and the nut do. Only the first winds the screw up.

use super::{Body, Friction};

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

    /// Keeps the internal states, to go back to with [`Self::go_back`]. There is room for one: who
    /// keeps within a sub-step keeps its begin.
    pub fn keep(&mut self) {
        self.table.keep();
        self.motor.iter_mut().for_each(Friction::keep);
    }

    /// Goes back to the states that were kept last.
    pub fn go_back(&mut self) {
        self.table.go_back();
        self.motor.iter_mut().for_each(Friction::go_back);
    }
}
