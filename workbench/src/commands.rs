//! The commands of the `quadrant` program: one file each, which lists its steps.

pub mod circle;
pub mod commission;
pub mod identify;
