//! The `quadrant` program as a library: what its commands do, without the command line.

pub mod ballbar;
pub mod compensation;
pub mod drive;
pub mod error;
pub mod link;
pub mod master;
pub mod run;
pub mod trajectory;
