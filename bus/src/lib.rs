//! How the nodes meet.
//!
//! The crate knows frames and [`protocol::Station`], and nobody who implements it.
//!
//! - [`in_process`]: a bus in one thread and virtual time; the default of the workbench.
//! - [`socketcan`](mod@socket): a port on a CAN interface of the kernel.
//! - [`faults`]: a wrapper around any receiving port that loses, doubles, delays and corrupts
//!   frames.
//! - [`shared`]: a station that others can look at while it is on the bus.
//! - [`log`]: candump logs.
//! - [`real_time`]: for a thread that beats a clock.

pub mod faults;
pub mod in_process;
pub mod log;
pub mod real_time;
pub mod shared;
pub mod socket;

pub use faults::{Corruption, Damage, FaultPlan, FaultyPort};
pub use in_process::InProcessBus;
pub use log::BusLog;
pub use real_time::RealTime;
pub use shared::Shared;
pub use socket::CanPort;
