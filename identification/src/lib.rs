//! Records in, model out.
//!
//! ```text
//! record ─▶ kinematics ─▶ least squares with the declared effects ─▶ residual
//!                               ▲                                       │
//!                               └── refit ◀── accept ◀── candidates on held-out blocks
//! ```
//!
//! The model is inverse dynamics: force = Σ coefficient · column. Both sides go through the same
//! zero-phase low-pass; only moving samples are fitted. A candidate is judged on blocks of the
//! training record that were left out of its fit, and accepted one at a time, largest first, where
//! it removes enough of the held-out error, by more than its uncertainty. Displacement effects that
//! act at reversal only (presliding) are judged on the samples about reversals; those between motor
//! and load (backlash, compliance, pitch error) on the difference of the two positions.
//!
//! Nothing here knows the simulator or its parameters.

pub mod actuator;
pub mod bench;
mod bus_log;
pub mod difference;
pub mod effects;
pub mod error;
pub mod excitation;
pub mod filter;
pub mod free_run;
pub mod kinematics;
pub mod load;
pub mod outcome;
mod pictures;
pub mod plausibility;
pub mod protocols;
mod ranking;
pub mod record;
pub mod regression;
pub mod report;
pub mod residual;
pub mod reversal;
pub mod search;
pub mod selection;
pub mod slow_ripple;
mod table;

pub use error::IdentificationError;
pub use outcome::identify;
pub use record::{Dataset, Record};
pub use report::Identification;
