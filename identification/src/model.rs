//! The inverse model: names, effects, and the model as a list of parts.

pub(crate) mod effects;
pub(crate) mod inverse;
pub(crate) mod name;
