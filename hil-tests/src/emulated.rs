//! The servo node as ARM code on an emulated Cortex-M4: what it heard on the host is played to it
//! again ([`recorded`], [`report`]), or it takes the host's place on a bus ([`node`]).
//!
//! QEMU has neither an STM32G4 nor an FDCAN, so it is the core that is emulated here and not the
//! board ([`machine`]).

pub mod machine;
pub mod node;
pub mod recorded;
pub mod report;

// Formats that are part of the images too.
#[path = "../../firmware/emulated/src/cycle/recording.rs"]
pub mod recording;
#[path = "../../firmware/emulated/src/node/rig.rs"]
mod rig;
#[path = "../../firmware/emulated/src/node/slcan.rs"]
mod slcan;
