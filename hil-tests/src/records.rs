//! Seeded records of axes with known hidden effects, for judging the identification.
//!
//! The plant simulator under a floating-point position controller, at 1 kHz, recorded as a drive
//! would: encoders rounded down, the recorded effort with noise of its own. The identification
//! knows nothing of it but the CSV files and `dataset.toml`.
//!
//! ```text
//! Plan ─▶ axis    masses, friction, and what is hidden       ┐
//!      ─▶ motion  where the axis is sent                     ├─▶ record ─▶ train.csv, validate.csv
//!      ─▶ control position P, velocity PI with feedforward   ┘             dataset.toml
//! ```
//!
//! All randomness of a plan comes from one stream (`draws`), so that a seed is a record. The
//! order of the draws is part of it: axis, then for each file motion, force noise, recorded noise.

mod axis;
mod control;
mod draws;
mod hidden;
pub mod look_alike;
mod motion;
mod plan;
pub mod plans;
mod record;

pub use hidden::{Foreign, Hidden, UNEXPLAINED};
pub use plan::{Plan, Positions, Sensor};
pub use record::write;

/// Time between rows, s.
const PERIOD_S: f64 = 1.0e-3;
/// Way of the table per revolution of the motor, m.
const LEAD_M: f64 = 0.010;
/// Counts of the motor encoder per revolution: 17 bits.
const COUNTS_PER_REV: u32 = 131_072;
