//! The buses of a machine, seen from the workbench: one link to them, in process or over CAN
//! interfaces, the master that speaks on it, and single nodes for buses with other people's nodes.

pub mod link;
pub mod master;
pub mod nodes;
