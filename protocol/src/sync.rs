//! Following SYNC by its counter, the same way in every node.
//!
//! A SYNC begins a cycle unless it is a double of the present one or the late one of a cycle that was begun by its lost-frame
//! token. A stale counter begins the cycle that is due: the frame shows that a cycle began, whatever its content says. Two stale counters in
//! sequence show that it is this node that is off; it follows them.

use crate::counter::{SYNC_OVERFLOW, SyncCounter};

/// What a SYNC frame means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SyncEvent {
    /// A cycle begins.
    Begin(SyncCounter),
    /// A cycle begins, but the counter in the frame was stale.
    BeginStale(SyncCounter),
    /// The SYNC of the present cycle came twice.
    Doubled,
    /// The SYNC of an earlier cycle came late.
    Late,
}

/// Follows the SYNC counter.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SyncTracker {
    now: Option<SyncCounter>,
    begun_by_token: bool,
    suspect: Option<SyncCounter>,
}

impl SyncTracker {
    /// Counter of the present cycle; `None` before the first SYNC.
    #[must_use]
    pub const fn now(&self) -> Option<SyncCounter> {
        self.now
    }

    /// A SYNC frame came.
    pub fn take(&mut self, counter: SyncCounter) -> SyncEvent {
        let Some(now) = self.now else { return self.begin(counter) };
        let ahead = counter.cycles_since(now);
        if ahead == 0 {
            return SyncEvent::Doubled;
        }
        if ahead <= SYNC_OVERFLOW / 2 {
            return self.begin(counter);
        }
        if self.suspect.is_some_and(|before| before.next() == counter) {
            return self.begin(counter);
        }
        if core::mem::take(&mut self.begun_by_token) && counter.next() == now {
            return SyncEvent::Late;
        }
        self.begin(now.next());
        self.suspect = Some(counter);
        SyncEvent::BeginStale(now.next())
    }

    /// The token of a lost SYNC came: the counter of the cycle that begins, if one is running.
    pub fn lost(&mut self) -> Option<SyncCounter> {
        let next = self.now?.next();
        self.begin(next);
        self.begun_by_token = true;
        Some(next)
    }

    fn begin(&mut self, counter: SyncCounter) -> SyncEvent {
        // A late SYNC of the cycle before can come during the cycle after it, so the mark outlives one begin.
        *self = Self { now: Some(counter), begun_by_token: self.begun_by_token, suspect: None };
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
        assert_eq!(tracker.take(count(4)), SyncEvent::Begin(count(4)), "frames lost without a token");
    }

    #[test]
    fn a_late_sync_after_its_token_begins_nothing() {
        let mut tracker = tracker(7);
        assert_eq!(tracker.lost(), Some(count(8)));
        assert_eq!(tracker.take(count(9)), SyncEvent::Begin(count(9)));
        assert_eq!(tracker.take(count(8)), SyncEvent::Late);
        assert_eq!(tracker.take(count(10)), SyncEvent::Begin(count(10)));
    }

    #[test]
    fn a_stale_counter_begins_the_cycle_that_is_due_and_two_of_them_are_followed() {
        let mut tracker = tracker(20);
        assert_eq!(tracker.take(count(15)), SyncEvent::BeginStale(count(21)));
        assert_eq!(tracker.take(count(22)), SyncEvent::Begin(count(22)));
        assert_eq!(tracker.take(count(11)), SyncEvent::BeginStale(count(23)));
        assert_eq!(tracker.take(count(12)), SyncEvent::Begin(count(12)));
    }
}
