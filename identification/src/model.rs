//! Effects of the inverse model.

pub(crate) mod effects;
