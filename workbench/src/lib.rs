//! The `quadrant` program as a library: what its commands do, without the command line.
//!
//! [`commands`] list the steps; everything else lies below them. The workbench is NMT master, SYNC
//! producer, SDO client and source of setpoints on any bus ([`network`]); it moves machines
//! ([`session`], [`trajectory`]), records them ([`axis_records`]), looks at circles ([`ballbar`]),
//! tunes ([`tuning`]) and shows what came out ([`presentation`]). Whoever moves axes gets an
//! [`interrupt`] token, so that the operator can stop them.

pub mod axis_records;
pub mod ballbar;
pub mod cli;
pub mod commands;
pub mod compensation;
pub mod drive_parameters;
pub mod error;
pub mod interrupt;
pub mod model_file;
pub mod network;
pub mod presentation;
pub mod progress;
pub mod session;
pub mod trajectory;
pub mod tuning;
