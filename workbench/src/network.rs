//! The buses of a machine, seen from the workbench.
//!
//! ```text
//! master       NMT, SYNC, SDO, setpoints; the way up and down
//! place        in this process, or on CAN interfaces
//! link         what the master asks of the buses: in_process, interfaces
//! stopwatch    when the frames of each cycle went by
//! round_trip   a bare frame there and back
//! candump      logs of what went over them
//! single_node  one node alone, for a bus with other people's nodes on it
//! ```

pub mod candump;
pub mod in_process;
pub mod interfaces;
pub mod link;
pub mod master;
pub mod place;
pub mod round_trip;
pub mod single_node;
pub mod stopwatch;
