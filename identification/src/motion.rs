//! What a record says about motion: derivatives, the one low-pass, which samples move.

pub(crate) mod bodies;
pub(crate) mod butterworth;
pub(crate) mod derivatives;
pub(crate) mod dot;
pub(crate) mod excitation;
pub(crate) mod filter;
pub(crate) mod kinematics;
pub(crate) mod lag;
pub(crate) mod mask;
pub(crate) mod measured_velocity;
pub(crate) mod motions;
pub(crate) mod shift;
