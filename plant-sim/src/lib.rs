//! Feed axes on the desktop, in SI units and `f64`: what the controller is tested against.
//!
//! - [`mechanics`]: two masses on a screw, with a gap; [`friction`]: exchangeable friction laws
//!   with a correct stick phase; [`effects`]: what real axes have besides; [`brake`] and [`stops`]:
//!   what holds an axis and where it ends; [`axis`]: actuator, encoders and one control cycle.
//! - [`machine`]: machine files in TOML, actual and declared effects apart.
//! - [`node`]: the plant as a CAN node, sans-I/O.
//!
//! Sign convention: positive force accelerates towards positive position; friction is positive
//! against motion.

pub mod axis;
pub mod brake;
pub mod effects;
pub mod friction;
mod lag;
pub mod machine;
pub mod mechanics;
pub mod node;
mod ranges;
pub mod stops;

pub use axis::{Axis, AxisParameters, MotorSide};
pub use machine::{Machine, MachineError};
pub use node::PlantNode;
