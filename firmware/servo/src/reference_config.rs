//! What the reference stage is told, in machine units.
//!
//! The stage itself belongs to the control law; this is its configuration as the parameter set gives it.

use controller::units::{Position, Velocity};

/// A ramp to standstill.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Ramp {
    /// Deceleration, per cycle.
    pub deceleration: Velocity,
    /// Jerk, per cycle²; zero: not limited.
    pub jerk: Velocity,
}

/// Limits and ramps of the commanded reference.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ReferenceConfig {
    /// Velocity limit of the axis.
    pub velocity_limit: Velocity,
    /// Acceleration limit of the axis, per cycle.
    pub acceleration_limit: Velocity,
    /// Change of acceleration within a cycle that counts as a step.
    pub step: Velocity,
    /// Lower software limit.
    pub position_min: Position,
    /// Upper software limit.
    pub position_max: Position,
    /// Ramp of the quick stop.
    pub quick_stop: Ramp,
    /// Ramp of the slow-down.
    pub slow_down: Ramp,
    /// The setpoint filter averages over 2 to this power of cycles; zero: off.
    pub filter_log2: u8,
    /// Cycles from setpoint to setpoint, 1…20.
    pub setpoint_cycles: u8,
}
