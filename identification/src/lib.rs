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

mod error;
mod evidence;
mod fit;
mod identify;
mod model;
mod motion;
mod progress;
mod record;
mod report;
mod simulate;

pub use error::IdentificationError;
pub use identify::{declared_coulomb, identify};
pub use progress::Step;
pub use record::dataset::Dataset;
pub use record::units::{AxisKind, Effort, EffortHold};
pub use report::forms::{EffectCurve, Errors, FreeRunErrors, Identification, Report};
