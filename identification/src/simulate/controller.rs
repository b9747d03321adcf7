//! The controller of the recorded axis, as `dataset.toml` describes it.
//!
//! ```text
//! setpoints r ──▶ [ timing ] ── v_ref, a_ref ──▶ [ law ] ──▶ effort
//! position  q ─────────────────────────────────────▲
//! ```
//!
//! [`law`] computes the effort of a row from the setpoints and a measured position. [`timing`]
//! says when a drive takes the acceleration of its feedforward: no dataset says it. [`known`]
//! believes a law only where it gives the recorded effort.

pub(crate) mod known;
pub(crate) mod law;
pub(crate) mod timing;
