//! The whole axis in closed loop, and its fit to the recorded position.

pub(crate) mod axis;
pub(crate) mod controller;
pub(crate) mod drive;
pub(crate) mod fit;
pub(crate) mod friction;
pub(crate) mod gap;
pub(crate) mod hold;
pub(crate) mod load;
#[cfg(test)]
pub(crate) mod made;
pub(crate) mod model;
pub(crate) mod parameters;
pub(crate) mod run;
