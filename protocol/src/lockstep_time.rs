//! Bus time in lock-step: what a node takes for the time while everybody waits for everybody.
//!
//! It moves on in two ways only. A SYNC that begins a cycle moves it to when that SYNC was due: one
//! period per cycle, however long the cycle took by the clock. The end of the leaf's patience moves
//! it to when the node is due next: to the deadline of a cycle whose frame was lost, or to the
//! node's own timer where SYNC was. A SYNC that begins nothing (a double, or one that comes after
//! its cycle was begun without it) moves nothing, so the leaf follows SYNC by its counter as the
//! node does.

use crate::cob::AxisIds;
use crate::message::{self, Decoded};
use crate::{CanFrame, Message, Station, SyncCounter, SyncEvent, SyncTracker};

/// What a station does at one time before its port is looked at again: heartbeat, deadline, own
/// timer and timeouts, with room for as many again.
const DUE_AT_ONCE: u8 = 8;

/// Bus time of one node, µs.
#[derive(Clone, Copy, Debug, Default)]
pub struct LockstepTime {
    now_us: u64,
    sync: SyncTracker,
}

impl LockstepTime {
    /// The present time.
    #[must_use]
    pub const fn now_us(&self) -> u64 {
        self.now_us
    }

    /// Time has come at least so far.
    pub fn reach(&mut self, at_us: u64) {
        self.now_us = self.now_us.max(at_us);
    }

    /// A frame came for a station.
    pub fn deliver(
        &mut self,
        station: &mut dyn Station,
        frame: &CanFrame,
        send: &mut dyn FnMut(CanFrame),
    ) {
        let due_us = station.sync_due_us();
        let sync = sync(station.ids(), frame);
        if let Some(counter) = sync {
            self.sync(counter, due_us);
        }
        station.take(frame, self.now_us, send);
        if sync.is_none() {
            self.without_sync(due_us, station.sync_due_us());
        }
    }

    /// Patience ended: time reaches what is due next, and the station does everything that is due
    /// then.
    pub fn wake(&mut self, station: &mut dyn Station, send: &mut dyn FnMut(CanFrame)) {
        let Some(due_us) = station.wake_at_us() else {
            return;
        };
        self.reach(due_us);
        for _ in 0..DUE_AT_ONCE {
            let sync_due_us = station.sync_due_us();
            station.time(self.now_us, send);
            self.without_sync(sync_due_us, station.sync_due_us());
            if station
                .wake_at_us()
                .is_none_or(|due_us| due_us > self.now_us)
            {
                break;
            }
        }
    }

    /// For how many deadlines it may be silent: one where a frame of the present cycle is missing,
    /// two where SYNC is. In bus time the own timer (1.3 periods) comes at about twice the deadline
    /// of a cycle (0.6) too. With one deadline for both, a plant that waits for a servo which waits
    /// for a lost frame would begin the next cycle while the servo closes the present one, and run
    /// ahead from there on.
    #[must_use]
    pub fn deadlines_to_wait(station: &dyn Station) -> u8 {
        let due = station.wake_at_us().zip(station.sync_due_us());
        if due.is_some_and(|(wake_us, sync_us)| wake_us > sync_us) {
            2
        } else {
            1
        }
    }

    /// A SYNC came; `due_us` is when the node waits for one ([`Station::sync_due_us`]).
    fn sync(&mut self, counter: SyncCounter, due_us: Option<u64>) {
        let Some(due_us) = due_us else {
            // The first SYNC of a node that has just been started.
            self.sync = SyncTracker::default();
            self.sync.take(counter);
            return;
        };
        match self.sync.take(counter) {
            SyncEvent::Begin(_) | SyncEvent::BeginStale(_) => self.reach(due_us),
            SyncEvent::Confirmed | SyncEvent::Doubled | SyncEvent::Late => {}
        }
    }

    /// The node did something without SYNC, and may have begun a cycle: the next SYNC is due later
    /// then.
    fn without_sync(&mut self, due_before_us: Option<u64>, due_after_us: Option<u64>) {
        if due_before_us
            .zip(due_after_us)
            .is_some_and(|(before, after)| after > before)
        {
            self.sync.begin_without_sync();
        }
    }
}

/// The counter, where a frame is SYNC.
fn sync(ids: AxisIds, frame: &CanFrame) -> Option<SyncCounter> {
    match message::decode(ids, frame) {
        Ok(Decoded::Message(Message::Sync(counter))) => Some(counter),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    extern crate std;
    use std::vec::Vec;

    fn count(value: u8) -> SyncCounter {
        SyncCounter::new(value).unwrap()
    }

    /// Times after each of these SYNC counters, for a node that expects each cycle 1000 µs after
    /// the one before.
    fn times(counters: &[u8]) -> Vec<u64> {
        let mut time = LockstepTime::default();
        let mut due = None;
        let step = |counter: &u8| {
            time.sync(count(*counter), due);
            due = Some(time.now_us() + 1000);
            time.now_us()
        };
        counters.iter().map(step).collect()
    }

    #[test]
    fn every_cycle_is_one_period_from_the_first_sync_on() {
        assert_eq!(times(&[238, 239, 240, 1, 2]), [0, 1000, 2000, 3000, 4000]);
    }

    #[test]
    fn a_doubled_sync_moves_nothing_and_a_stale_one_is_a_cycle() {
        assert_eq!(times(&[20, 21, 21, 22]), [0, 1000, 1000, 2000]);
        assert_eq!(times(&[20, 21, 15, 23]), [0, 1000, 2000, 3000]);
    }

    #[test]
    fn a_sync_whose_cycle_was_begun_without_it_moves_nothing() {
        let mut time = LockstepTime::default();
        time.sync(count(1), None);
        time.reach(1300);
        time.without_sync(Some(1000), Some(2000));
        time.sync(count(2), Some(2000));
        assert_eq!(time.now_us(), 1300, "confirmed");
        time.sync(count(3), Some(2000));
        assert_eq!(time.now_us(), 2000);
    }

    #[test]
    fn closing_a_cycle_at_its_deadline_does_not_hide_the_next_sync() {
        let mut time = LockstepTime::default();
        time.sync(count(1), None);
        time.reach(600);
        time.without_sync(Some(1000), Some(1000));
        time.sync(count(2), Some(1000));
        assert_eq!(time.now_us(), 1000);
    }
}
