//! How servo, plant and workbench meet.
//!
//! - [`station`]: what every sans-I/O node looks like from the bus.
//! - [`in_process`]: a bus in one thread and virtual time; the default of the workbench.
//! - [`socketcan`](mod@socket): a port on a CAN interface of the kernel.
//! - [`faults`]: a wrapper around any receiving port that loses, delays, doubles and corrupts frames.
//! - [`log`]: candump logs.

pub mod faults;
pub mod in_process;
pub mod log;
pub mod socket;
pub mod station;

pub use faults::{FaultPlan, FaultyPort};
pub use in_process::InProcessBus;
pub use log::BusLog;
pub use socket::CanPort;
pub use station::{Received, Station};
