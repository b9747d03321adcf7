//! The vocabulary of effects between simulator, identification and workbench.
//!
//! An [`Effect`] is what an axis has, with typed parameters. [`EffectName`] is its name alone.
//! [`vocabulary`] is the one table of them: names, words, parameters, units and ranges.
//!
//! ```text
//! identification ──▶ Effect<Estimate> ──▶ workbench ──▶ Effect<f64> ──▶ machine file ──▶ plant-sim
//! ```
//!
//! Parameters are numbers (`Effect<f64>`) where somebody states them, and estimates with interval
//! and unit ([`Effect<Estimate>`](Estimate)) where a record was asked. A number's unit stands in
//! its key (`coulomb_n`), an estimate carries its own, because identified axes may be rotary, and
//! their effort a torque or a current.
//!
//! The crate holds no equation. Simulator and identification each have their own, so that a fit
//! cannot be right because both share a mistake.

mod define;
mod dimension;
mod estimate;
mod serde_form;
pub mod vocabulary;

pub use dimension::Dimension;
pub use estimate::Estimate;
pub use serde_form::EffectTable;
pub use vocabulary::*;
