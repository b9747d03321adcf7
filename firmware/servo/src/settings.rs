//! What the drive runs on: one parameter set in machine units of its cycle time, fit to run as a
//! whole.
//!
//! [`crate::conversion`] makes it from a [`crate::parameters::ParameterSet`] when that is
//! committed; the cycle only reads it.

use controller::Config;
use controller::units::{PositionError, Torque, WayPerIncrement};

/// A parameter set that is fit to run.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Cycle time that all machine units are made for.
    pub period_us: u32,
    /// For the reference stage and the control law.
    pub config: Config,
    /// For the watchdogs.
    pub limits: Limits,
    /// What the drive does about commands and faults.
    pub options: Options,
    /// Times of the brake.
    pub brake: Brake,
    /// Torque at enable.
    pub preset: Preset,
    /// Where the load scale stands against the motor encoder.
    pub relation: Relation,
    /// Way per motor increment.
    pub way: WayPerIncrement,
    /// Rated torque, mN·m, at least 1.
    pub rated_torque_mnm: i32,
}

/// Limits of watchdogs and windows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Setpoints that may be missing in a row.
    pub setpoint_misses: u16,
    /// Feedbacks that may be missing in a row.
    pub feedback_misses: u16,
    /// Setpoints that may be refused in a row.
    pub refusals: u16,
    /// Following error window.
    pub following_error: PositionError,
    /// Way by which a feedback may differ from the expected one.
    pub encoder_jump: PositionError,
    /// Way by which the setpoint may differ from the axis at enable.
    pub enable_window: PositionError,
    /// Time without a plant heartbeat.
    pub heartbeat_us: u64,
    /// Time without SYNC.
    pub sync_timeout_us: u64,
    /// Cycles within which the power stage confirms.
    pub stage_cycles: u16,
}

/// What the drive does about commands and faults (objects 605Ah to 605Eh and 6007h).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Options {
    /// Quick stop, 605Ah.
    pub quick_stop: StopOption,
    /// Shutdown, 605Bh.
    pub shutdown: StopOption,
    /// Disable operation, 605Ch.
    pub disable_operation: StopOption,
    /// Halt, 605Dh: always one that stays.
    pub halt: StopOption,
    /// Fault reaction, 605Eh.
    pub fault_reaction: StopOption,
    /// Connection lost, 6007h.
    pub abort_connection: AbortConnectionOption,
}

/// A way to standstill.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StopOption {
    /// No torque at once.
    DisableAtOnce,
    /// Slow-down ramp, then no torque.
    SlowDown,
    /// Quick-stop ramp, then no torque.
    QuickStop,
    /// Slow-down ramp, then the loop holds the axis.
    SlowDownAndStay,
    /// Quick-stop ramp, then the loop holds the axis.
    QuickStopAndStay,
}

/// What the drive does when the connection to the master is lost. The standard's 0, nothing, is not
/// taken: an axis does not go on without its master.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AbortConnectionOption {
    /// It latches a fault.
    Fault,
    /// As on the command "disable voltage".
    DisableVoltage,
    /// As on the command "quick stop".
    QuickStop,
}

/// Times of the brake, rounded up to whole cycles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Brake {
    /// From the command until it is open.
    pub open_cycles: u16,
    /// From the command until it bites.
    pub close_cycles: u16,
}

/// Torque with which the loop starts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Preset {
    /// The torque.
    pub torque: Torque,
    /// Take the torque from before the last disable, where there is one.
    pub from_last: bool,
}

/// Where the load scale stands against the motor encoder.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Relation {
    /// Scale where the motor encoder is zero, 10 nm.
    pub offset: i32,
    /// Difference that is allowed.
    pub window: PositionError,
}
