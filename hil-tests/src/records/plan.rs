//! What to record.

use super::hidden::Hidden;

/// The positions that a record holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Positions {
    /// The motor's alone.
    Motor,
    /// The motor's, and the load's from a scale at the table.
    MotorAndLoad,
}

/// Where the position is measured on which the loop is closed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sensor {
    /// At the motor: a gap is outside the loop.
    Motor,
    /// At the load: a gap is inside the loop.
    Load,
}

/// What to record.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// What the declared model lacks.
    pub hidden: Vec<Hidden>,
    /// The positions that are recorded.
    pub positions: Positions,
    /// What the position loop is closed on.
    pub closed_on: Sensor,
    /// Factor on the Coulomb friction of the seed's axis.
    pub friction_factor: f64,
    /// Noise of the recorded effort, N.
    pub noise_n: f64,
    /// Rows of each record, 1 ms apart.
    pub rows: usize,
    /// Chooses the axis, the motion and the noise.
    pub seed: u64,
}

impl Default for Plan {
    fn default() -> Self {
        Self {
            hidden: Vec::new(),
            positions: Positions::Motor,
            closed_on: Sensor::Motor,
            friction_factor: 1.0,
            noise_n: 3.0,
            rows: 30_000,
            seed: 1,
        }
    }
}
