//! Following SYNC by its counter, the same way in every node.
//!
//! A SYNC begins a cycle unless it is a double of the present one, or belongs to a cycle that the
//! node has begun without it: by its own timer, or because another frame showed that the cycle is
//! on. A stale counter begins the cycle that is due: the frame shows that a cycle began, whatever
//! its content says. Three stale counters in sequence show that it is this node that is off (a
//! master that paused, or started again); it follows them.

use crate::counter::{SYNC_OVERFLOW, SyncCounter};

/// What a SYNC frame means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SyncEvent {
    /// A cycle begins.
    Begin(SyncCounter),
    /// A cycle begins, but the counter in the frame was stale.
    BeginStale(SyncCounter),
    /// The SYNC of the present cycle, which the node had begun without it.
    Confirmed,
    /// The SYNC of the present cycle came twice.
    Doubled,
    /// The SYNC of an earlier cycle, which the node had begun without it.
    Late,
}

/// Follows the SYNC counter.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SyncTracker {
    now: Option<SyncCounter>,
    /// Which of the last 16 cycles were begun without SYNC and still wait for it; bit 0 is the
    /// present one.
    without_sync: u16,
    suspect: Option<(SyncCounter, u8)>,
}

/// Stale counters in sequence after which the node follows them.
const FOLLOW_AFTER: u8 = 3;

impl SyncTracker {
    /// Counter of the present cycle; `None` before the first SYNC.
    #[must_use]
    pub const fn now(&self) -> Option<SyncCounter> {
        self.now
    }

    /// A SYNC frame came.
    #[inline]
    pub fn take(&mut self, counter: SyncCounter) -> SyncEvent {
        let Some(now) = self.now else {
            return self.begin(counter);
        };
        if counter == now.next() {
            return self.begin_after(counter, 1);
        }
        let ahead = counter.cycles_since(now);
        if ahead == 0 {
            return self.present();
        }
        if ahead <= SYNC_OVERFLOW / 2 {
            return self.begin(counter);
        }
        self.take_stale(now, counter)
    }

    #[cold]
    fn take_stale(&mut self, now: SyncCounter, counter: SyncCounter) -> SyncEvent {
        let in_sequence = match self.suspect {
            Some((before, times)) if before.next() == counter => times.saturating_add(1),
            _ => 1,
        };
        if in_sequence >= FOLLOW_AFTER {
            return self.begin(counter);
        }
        self.suspect = Some((counter, in_sequence));
        if self.was_begun_without(now.cycles_since(counter)) {
            return SyncEvent::Late;
        }
        let suspect = self.suspect;
        self.begin(now.next());
        self.suspect = suspect;
        SyncEvent::BeginStale(now.next())
    }

    /// The next cycle begins without SYNC; its counter, if one was running.
    pub fn begin_without_sync(&mut self) -> Option<SyncCounter> {
        let next = self.now?.next();
        let suspect = self.suspect;
        self.begin(next);
        self.without_sync |= 1;
        self.suspect = suspect;
        Some(next)
    }

    fn present(&mut self) -> SyncEvent {
        self.suspect = None;
        if self.was_begun_without(0) {
            SyncEvent::Confirmed
        } else {
            SyncEvent::Doubled
        }
    }

    /// Whether the cycle so many before the present one was begun without SYNC; its SYNC is then no
    /// longer waited for.
    fn was_begun_without(&mut self, cycles_ago: u8) -> bool {
        let bit = 1_u16.checked_shl(u32::from(cycles_ago)).unwrap_or(0);
        let waited = self.without_sync & bit != 0;
        self.without_sync &= !bit;
        waited
    }

    fn begin(&mut self, counter: SyncCounter) -> SyncEvent {
        let cycles = self.now.map_or(16, |now| counter.cycles_since(now));
        self.begin_after(counter, cycles)
    }

    fn begin_after(&mut self, counter: SyncCounter, cycles: u8) -> SyncEvent {
        let without_sync = self
            .without_sync
            .checked_shl(u32::from(cycles))
            .unwrap_or(0);
        *self = Self {
            now: Some(counter),
            without_sync,
            suspect: None,
        };
        SyncEvent::Begin(counter)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn count(value: u8) -> SyncCounter {
        SyncCounter::new(value).unwrap()
    }

    fn tracker(at: u8) -> SyncTracker {
        let mut tracker = SyncTracker::default();
        tracker.take(count(at));
        tracker
    }

    #[test]
    fn the_usual_sequence_begins_cycle_after_cycle_and_wraps() {
        let mut tracker = tracker(239);
        assert_eq!(tracker.take(count(240)), SyncEvent::Begin(count(240)));
        assert_eq!(tracker.take(count(1)), SyncEvent::Begin(count(1)));
        assert_eq!(tracker.take(count(1)), SyncEvent::Doubled);
        assert_eq!(
            tracker.take(count(4)),
            SyncEvent::Begin(count(4)),
            "two frames lost"
        );
    }

    #[test]
    fn a_sync_that_comes_after_its_cycle_was_begun_without_it_begins_nothing() {
        let mut tracker = tracker(7);
        assert_eq!(tracker.begin_without_sync(), Some(count(8)));
        assert_eq!(tracker.take(count(8)), SyncEvent::Confirmed);
        assert_eq!(tracker.take(count(8)), SyncEvent::Doubled);
        assert_eq!(tracker.begin_without_sync(), Some(count(9)));
        assert_eq!(tracker.take(count(10)), SyncEvent::Begin(count(10)));
        assert_eq!(tracker.take(count(9)), SyncEvent::Late);
        assert_eq!(tracker.take(count(11)), SyncEvent::Begin(count(11)));
    }

    #[test]
    fn two_late_syncs_in_a_row_begin_nothing() {
        let mut tracker = tracker(7);
        tracker.begin_without_sync();
        tracker.begin_without_sync();
        assert_eq!(tracker.take(count(8)), SyncEvent::Late);
        assert_eq!(tracker.take(count(10)), SyncEvent::Begin(count(10)));
        assert_eq!(tracker.take(count(9)), SyncEvent::Late);
        assert_eq!(tracker.take(count(11)), SyncEvent::Begin(count(11)));
    }

    #[test]
    fn a_stale_counter_begins_the_cycle_that_is_due_and_three_in_sequence_are_followed() {
        let mut tracker = tracker(20);
        assert_eq!(tracker.take(count(15)), SyncEvent::BeginStale(count(21)));
        assert_eq!(tracker.take(count(22)), SyncEvent::Begin(count(22)));
        assert_eq!(tracker.take(count(11)), SyncEvent::BeginStale(count(23)));
        assert_eq!(tracker.take(count(12)), SyncEvent::BeginStale(count(24)));
        assert_eq!(tracker.take(count(13)), SyncEvent::Begin(count(13)));
    }

    #[test]
    fn a_master_that_paused_while_the_node_went_on_is_followed_after_three_of_its_syncs() {
        let mut tracker = tracker(7);
        for _ in 0..30 {
            tracker.begin_without_sync();
        }
        let events = [8, 9, 10, 11].map(|counter| tracker.take(count(counter)));
        assert_eq!(
            events[2..],
            [SyncEvent::Begin(count(10)), SyncEvent::Begin(count(11))]
        );
    }
}
