//! What is said about an identification.

pub(crate) mod forms;
pub(crate) mod free_run;
pub(crate) mod pictures;
pub(crate) mod protocols;
pub(crate) mod ranking;
