//! Records in, model out.
//!
//! ```text
//! record ─▶ kinematics ─▶ least squares with the declared effects ─▶ residual
//!                               ▲                                       │
//!                               └── refit ◀── accept ◀── candidates on held-out blocks
//! ```
//!
//! The model is inverse dynamics: effort = Σ coefficient · column. Both sides go through the same
//! zero-phase low-pass, and only moving samples are fitted. A candidate is judged on blocks of the
//! training record that were left out of its fit. Candidates are accepted one at a time, largest
//! first, where what they remove is relevant, matters and is certain.
//!
//! What acts at reversals (presliding, backlash) is judged on the effort about reversals and on the
//! position of a simulation in closed loop. What acts between motor and load (backlash, compliance,
//! pitch error) is judged on the difference of the two positions.
//!
//! Rooms, each of which uses those before it and none after it: `record`, `motion`, `model`, `fit`,
//! `simulate`, `evidence`, `report`. [`identify()`] is the list of the steps. Method, limits and
//! figures: docs/identification.md.
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
pub use identify::{declared_coulomb, fit_declared, identify};
pub use progress::Step;
pub use record::dataset::Dataset;
pub use record::units::{AxisKind, Effort, EffortHold};
pub use report::figures;
pub use report::forms::{
    AfterReversal, EffectCurve, Errors, ForceNoise, FreeRun, FreeRunErrors, Identification,
    ParameterTable, PreslidingCurve, Report, SlipElement, UnknownParameter,
};
