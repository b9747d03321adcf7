//! Reference trajectories: functions of time, within the limits of the axes.

pub mod circle_limits;
mod contour;
mod excitation;
mod point_to_point;
mod reference_circle;
mod smoothstep;
mod windowed_sine;

pub use contour::{Contour, Place};
pub use excitation::Excitation;
pub use point_to_point::Move;
pub use reference_circle::{Circle, MEASURE_FROM_RAD};
