//! What the workbench asks of the buses of a machine, wherever they are: in this process
//! ([`in_process`]) or on CAN interfaces ([`interfaces`]).
//!
//! [`in_process`]: super::in_process
//! [`interfaces`]: super::interfaces

use std::time::Duration;

use bus::BusLog;
use plant_sim::node::Truth;
use protocol::CanFrame;
use protocol::cob::AxisIds;

use crate::error::{Failure, Outcome};

/// The buses of a machine, seen by the workbench.
pub trait Link {
    /// Number of buses.
    fn buses(&self) -> usize;
    /// Bus of an axis.
    fn bus_of(&self, axis: usize) -> usize;
    /// Sends a frame on a bus.
    ///
    /// # Errors
    /// Where the interface does not take it.
    fn send(&mut self, bus: usize, frame: CanFrame) -> Outcome<()>;
    /// Waits for a frame on a bus; `None` after the timeout.
    ///
    /// # Errors
    /// Where the interface is gone.
    fn receive(&mut self, bus: usize, timeout: Duration) -> Outcome<Option<CanFrame>>;
    /// Waits for a frame of the present cycle; `None` when the cycle does not wait any longer: in
    /// process and at clock pace at its end, in lock-step over interfaces after some time.
    /// Where nobody but silent nodes is waited for, `most` ends the wait earlier.
    ///
    /// # Errors
    /// Where the interface is gone.
    fn receive_in_cycle(&mut self, bus: usize, most: Option<Duration>)
    -> Outcome<Option<CanFrame>>;
    /// The next cycle begins; gives how many before it the clock has passed over.
    fn pass(&mut self, cycle: Duration) -> u32;
    /// Whether a clock beats the time: it does not wait for the workbench.
    fn follows_clock(&self) -> bool {
        false
    }
    /// What the system granted to a workbench that follows the clock.
    fn scheduling(&self) -> Option<String> {
        None
    }
    /// Whether the clock asks for the next cycle by now.
    fn is_due(&self) -> bool {
        false
    }
    /// How much later than due the present cycle began; `None` where no clock beats the time.
    fn lateness(&self) -> Option<Duration> {
        None
    }
    /// What the axis truly does, where an instrument can see it; `None` over a cable.
    fn truth(&self, axis: usize) -> Option<Truth>;
    /// Starts logging all frames.
    fn start_log(&mut self);
    /// Ends logging; one log per bus.
    fn take_logs(&mut self) -> Vec<BusLog>;
}

/// Node ids of axis `index`.
///
/// # Errors
/// Beyond 16 axes.
pub fn axis_ids(index: usize) -> Outcome<AxisIds> {
    let ids = u8::try_from(index).ok().and_then(AxisIds::of_axis);
    ids.ok_or_else(|| Failure::new("a machine has at most 16 axes"))
}

impl Link for Box<dyn Link> {
    fn buses(&self) -> usize {
        self.as_ref().buses()
    }

    fn bus_of(&self, axis: usize) -> usize {
        self.as_ref().bus_of(axis)
    }

    fn send(&mut self, bus: usize, frame: CanFrame) -> Outcome<()> {
        self.as_mut().send(bus, frame)
    }

    fn receive(&mut self, bus: usize, timeout: Duration) -> Outcome<Option<CanFrame>> {
        self.as_mut().receive(bus, timeout)
    }

    fn receive_in_cycle(
        &mut self,
        bus: usize,
        most: Option<Duration>,
    ) -> Outcome<Option<CanFrame>> {
        self.as_mut().receive_in_cycle(bus, most)
    }

    fn pass(&mut self, cycle: Duration) -> u32 {
        self.as_mut().pass(cycle)
    }

    fn follows_clock(&self) -> bool {
        self.as_ref().follows_clock()
    }

    fn scheduling(&self) -> Option<String> {
        self.as_ref().scheduling()
    }

    fn is_due(&self) -> bool {
        self.as_ref().is_due()
    }

    fn lateness(&self) -> Option<Duration> {
        self.as_ref().lateness()
    }

    fn truth(&self, axis: usize) -> Option<Truth> {
        self.as_ref().truth(axis)
    }

    fn start_log(&mut self) {
        self.as_mut().start_log();
    }

    fn take_logs(&mut self) -> Vec<BusLog> {
        self.as_mut().take_logs()
    }
}

/// Microseconds of a duration; beyond half a million years the largest number.
#[must_use]
pub fn micros(duration: Duration) -> u64 {
    u64::try_from(duration.as_micros()).unwrap_or(u64::MAX)
}
