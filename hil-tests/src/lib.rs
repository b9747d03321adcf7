//! Rigs that close the loop for tests, and golden tables that people review.
//!
//! Three gears: the in-process rig drives the nodes directly in virtual time (blind to the kernel
//! and to scheduling), the vcan scenarios run every node as a process of its own (blind to
//! bandwidth), the board image is linked and looked at (blind to booting).
//!
//! Each of them runs in three scopes: `cargo quick`, `cargo test` and `cargo certify` take one row,
//! some or all of the same tables ([`Scope`]). `golden::check_some` holds the part of a golden
//! table that a scope runs; long tables run on all cores ([`on_all_cores`]).

pub mod architecture;
pub mod blade;
pub mod comparison;
pub mod confusion;
pub mod drawn;
pub mod emulated;
pub mod exact;
pub mod gaps;
pub mod golden;
pub mod intervals;
pub mod losses;
pub mod matrix;
pub mod paths;
pub mod pictures;
pub mod program;
pub mod records;
pub mod rig;
pub mod stack;
pub mod targets;
pub mod unlike;

pub use scope::{Scope, on_all_cores};
