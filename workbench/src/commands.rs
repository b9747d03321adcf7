//! The commands of the `quadrant` program: one file and one `run` each, which lists the steps. What
//! the steps are made of lies below.

mod asked_compensation;
pub mod circle;
pub mod commission;
pub mod compare;
pub mod completions;
pub mod contour;
pub mod identify;
pub mod machine;
pub mod plant;
pub mod servo;
pub mod timing;
pub mod tune;
