//! What is too small to be told of.

/// The smallest that is told of a load's motion.
#[derive(Clone, Copy, Debug)]
pub(super) struct Smallest {
    /// Count of the load's scale.
    pub count: f64,
    /// Count of the motor's encoder.
    pub motor_count: f64,
    /// Velocity from which on an axis counts as moving.
    pub velocity: f64,
}
