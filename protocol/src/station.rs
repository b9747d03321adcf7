//! What every sans-I/O node looks like from a bus, and what its leaf owes it.
//!
//! Frames and time go in, frames come out through `send`. A node never waits: whoever drives it (a
//! leaf on a board, a host program, the in-process bus) delivers frames as they come and calls
//! [`Station::time`] at [`Station::wake_at_us`] unless a frame came before. Time is what the driver
//! passes in:
//!
//! - *clock pace*: the clock;
//! - *lock-step*: bus time, which moves on by one period per SYNC (to [`Station::sync_due_us`])
//!   and, where frames are lost, to the next [`Station::wake_at_us`] when the driver's patience
//!   ends; the wall clock only tells that a partner is gone;
//! - *in process*: virtual time, which jumps to the next wake of any station once nothing more can
//!   arrive.

use crate::cob::AxisIds;
use crate::frame::CanFrame;
use crate::leaf::{LeafReport, Timed};

/// A node: frames and time in, frames out.
pub trait Station {
    /// Node ids of its axis.
    fn ids(&self) -> AxisIds;
    /// The boot-up message.
    fn boot(&mut self, send: &mut dyn FnMut(CanFrame));
    /// Takes a frame. What was due before `now_us` happens first.
    fn take(&mut self, frame: &CanFrame, now_us: u64, send: &mut dyn FnMut(CanFrame));
    /// Lets time pass: does what is due at `now_us`, at most one cycle's worth; call again while
    /// [`Self::wake_at_us`] is not later.
    fn time(&mut self, now_us: u64, send: &mut dyn FnMut(CanFrame));
    /// When something is due next, unless a frame comes before: the deadline of the cycle, the
    /// node's own SYNC timer, a heartbeat.
    fn wake_at_us(&self) -> Option<u64>;
    /// When the next SYNC is due by the node's own count; `None` before the first one.
    fn sync_due_us(&self) -> Option<u64>;
    /// The leaf reports of itself, to a node that has objects for it.
    fn report(&mut self, _leaf: LeafReport) {}

    /// The leaf has timed something, ns.
    fn took(&mut self, _timed: Timed, _ns: u32) {}
}
