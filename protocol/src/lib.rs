//! The interface control document of Quadrant, in code.
//!
//! Servo, plant and workbench meet only in the frames that this crate defines: identifiers after
//! CANopen's predefined connection set ([`cob`]), raw frames ([`frame`]), LSB weights in types
//! ([`weight`]), typed messages with a total decoder ([`message`]), the table from which bus load,
//! DBC and docs are made ([`table`], [`load`], [`dbc`]).
//!
//! No float, no allocation, no panic path: a frame that is not one of ours is an error value that
//! names the field, what was wanted and what came.
#![no_std]
#![forbid(unsafe_code)]
#![deny(
    clippy::float_arithmetic,
    clippy::indexing_slicing,
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::arithmetic_side_effects,
    clippy::as_conversions
)]
#![cfg_attr(
    test,
    allow(
        clippy::unwrap_used,
        clippy::panic,
        clippy::arithmetic_side_effects,
        clippy::indexing_slicing
    )
)]

pub mod cob;
pub mod counter;
pub mod dbc;
pub mod fault;
pub mod frame;
pub mod leaf;
pub mod load;
pub mod lockstep_time;
pub mod message;
pub mod sdo;
pub mod states;
pub mod station;
pub mod sync;
pub mod table;
pub mod weight;

pub use cob::{AxisIds, FrameKind, NodeId};
pub use counter::SyncCounter;
pub use fault::Fault;
pub use frame::CanFrame;
pub use lockstep_time::LockstepTime;
pub use message::{DecodeError, Message};
pub use station::Station;
pub use sync::{SyncEvent, SyncTracker};
