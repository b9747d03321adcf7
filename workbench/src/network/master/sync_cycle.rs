//! One cycle k in lock-step: SYNC k on every bus, setpoints k + 1 (one cycle early), then wait for
//! the torque k of every axis.
//!
//! A wait ends with the torques, with the patience of the link (in process and at clock pace the
//! end of the cycle, in lock-step over interfaces one and a half deadlines of the nodes), or with
//! evidence that a node has begun the next cycle by its own timer.
//!
//! An axis that has been silent for `SILENT_CYCLES` is waited for no longer than a period: the
//! others must not starve while they are being stopped, and the cycle keeps its pace where nobody
//! answers at all.

use protocol::counter::SYNC_OVERFLOW;
use protocol::message::{Decoded, Setpoint, decode};
use protocol::{CanFrame, Message, SyncCounter};

use super::Master;
use super::axis_link::AxisLink;
use super::way::{Hold, is_down};
use crate::error::Outcome;
use crate::network::link::{Link, axis_ids};

/// Frames that may pass in a cycle: other people's traffic must not prolong it.
const MOST_FRAMES: u32 = 4000;

/// Whose torques are still missing in a cycle.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Missing {
    /// Those of axes that have been silent for long already.
    OnlySilent,
    /// That of an axis that answered until now.
    Expected,
}

impl<L: Link> Master<L> {
    /// One cycle; `next_m` are the setpoints of the cycle after it.
    ///
    /// # Errors
    /// Where an interface is gone.
    pub fn cycle(&mut self, next_m: &[f64]) -> Outcome<()> {
        self.cycle_at(|_| next_m).map(|_| ())
    }

    /// The same with setpoints that go with the clock: they are asked for when it is known how many
    /// cycles it has passed over, which is given. Those count as missed where a drive is not at
    /// rest.
    ///
    /// # Errors
    /// Where an interface is gone.
    pub fn cycle_at<S: AsRef<[f64]>>(&mut self, next: impl FnOnce(u32) -> S) -> Outcome<u32> {
        let skipped = self.link.pass(self.period);
        let next_m = next(skipped);
        let counter = later(self.counter, skipped);
        let sync = Message::Sync(counter).encode(axis_ids(0)?);
        (0..self.link.buses()).try_for_each(|bus| self.link.send(bus, sync))?;
        self.axes
            .iter_mut()
            .zip(next_m.as_ref())
            .for_each(|(axis, next)| axis.begin(*next, skipped));
        self.send_setpoints(counter.next())?;
        (0..self.link.buses()).try_for_each(|bus| self.collect(bus, counter))?;
        for (index, axis) in self.axes.iter_mut().enumerate() {
            axis.end(self.link.truth(index));
        }
        self.counter = counter.next();
        self.cycles += 1 + u64::from(skipped);
        // Drives without torque wait for SYNC as long as it takes.
        if !self.is_at_rest {
            self.missed = self.missed.saturating_add(skipped);
        }
        self.is_at_rest = self.axes.iter().all(|axis| axis.state.is_some_and(is_down));
        Ok(skipped)
    }

    /// A cycle with the setpoints that were sent last, where the clock asks for one: whoever talks
    /// to drives that are being cycled does this between any two questions.
    pub(super) fn keep_pace(&mut self) -> Outcome<()> {
        if self.cycles == 0 || !self.link.is_due() {
            return Ok(());
        }
        self.hold()
    }

    /// A cycle with the setpoints that were sent last.
    ///
    /// # Errors
    /// Where an interface is gone.
    pub fn hold(&mut self) -> Outcome<()> {
        let last = self.held(Hold::Last);
        self.cycle(&last)
    }

    /// The setpoints of a cycle to come, with the present control word.
    pub(super) fn send_setpoints(&mut self, counter: SyncCounter) -> Outcome<()> {
        (0..self.axes.len()).try_for_each(|index| {
            let position = self.axes[index].next;
            self.send(
                index,
                Message::Setpoint(Setpoint {
                    control: self.control,
                    counter,
                    position,
                }),
            )
        })
    }

    fn collect(&mut self, bus: usize, counter: SyncCounter) -> Outcome<()> {
        for _ in 0..MOST_FRAMES {
            let Some(missing) = self.missing(bus) else {
                return Ok(());
            };
            let most = (missing == Missing::OnlySilent).then_some(self.period);
            let Some(frame) = self.link.receive_in_cycle(bus, most)? else {
                break;
            };
            if self.hear(bus, &frame, counter) {
                break;
            }
        }
        self.missed += u32::from(self.missing(bus).is_some());
        Ok(())
    }

    /// Whose torques are still missing on a bus; `None` where all have come.
    fn missing(&self, bus: usize) -> Option<Missing> {
        let mut missing = self
            .axes
            .iter()
            .filter(|axis| axis.bus == bus && !axis.has_answered())
            .peekable();
        missing.peek()?;
        Some(if missing.all(AxisLink::is_silent) {
            Missing::OnlySilent
        } else {
            Missing::Expected
        })
    }

    /// Takes a frame; tells whether it shows that the next cycle is on already: a node goes on by
    /// its own timer, and SYNC is overdue.
    fn hear(&mut self, bus: usize, frame: &CanFrame, counter: SyncCounter) -> bool {
        let mut is_overdue = false;
        for axis in self.axes.iter_mut().filter(|axis| axis.bus == bus) {
            // Frames that cannot be decoded are the nodes' business; the workbench only listens
            // here.
            if let Ok(Decoded::Message(message)) = decode(axis.ids, frame) {
                is_overdue |= cycle_of(&message) == Some(counter.next());
                axis.take(message, counter);
            }
        }
        is_overdue
    }
}

/// The counter so many cycles later.
fn later(counter: SyncCounter, cycles: u32) -> SyncCounter {
    (0..cycles % u32::from(SYNC_OVERFLOW)).fold(counter, |counter, _| counter.next())
}

/// The cycle that a node says is on.
const fn cycle_of(message: &Message) -> Option<SyncCounter> {
    match message {
        Message::Feedback(feedback) => Some(feedback.counter),
        Message::Torque(torque) => Some(torque.counter),
        _ => None,
    }
}
