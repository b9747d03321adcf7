//! The `quadrant` program as a library: what its commands do, without the command line.
//!
//! The workbench is NMT master, SYNC producer, SDO client and source of setpoints ([`master`]) on
//! any bus ([`link`]); it moves machines ([`run`], [`trajectory`], [`excitation`]), records them
//! ([`recording`]), looks at circles ([`ballbar`]), tunes ([`tune`]) and reports ([`report`],
//! [`plots`]). Whoever moves axes gets an [`interrupt`] token, so that the operator can stop them.

pub mod ballbar;
pub mod circle;
pub mod cli;
pub mod commission;
pub mod compensation;
pub mod drive;
pub mod error;
pub mod excitation;
pub mod identify;
pub mod interrupt;
pub mod link;
pub mod master;
pub mod model_file;
pub mod nodes;
pub mod plots;
pub mod progress;
pub mod recording;
pub mod report;
pub mod run;
pub mod trajectory;
pub mod tune;
