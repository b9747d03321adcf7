//! Following SYNC by its counter, the same way in every node.
//!
//! A SYNC begins a cycle unless it is a double of the present one or the late one of a cycle that was begun by its lost-frame
//! token. A stale counter begins the cycle that is due: the frame shows that a cycle began, whatever its content says. Three stale counters in
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
    /// The present cycle, and the one before it, were begun by a token; their SYNC may still come.
    begun_by_token: bool,
    before_by_token: bool,
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
    pub fn take(&mut self, counter: SyncCounter) -> SyncEvent {
        let Some(now) = self.now else { return self.begin(counter) };
        let ahead = counter.cycles_since(now);
        if ahead == 0 {
            return SyncEvent::Doubled;
        }
        if ahead <= SYNC_OVERFLOW / 2 {
            return self.begin(counter);
        }
        if counter.next() == now && core::mem::take(&mut self.before_by_token) {
            return SyncEvent::Late;
        }
        let in_sequence = match self.suspect {
            Some((before, times)) if before.next() == counter => times.saturating_add(1),
            _ => 1,
        };
        if in_sequence >= FOLLOW_AFTER {
            return self.begin(counter);
        }
        self.begin(now.next());
        self.suspect = Some((counter, in_sequence));
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
        *self = Self { now: Some(counter), begun_by_token: false, before_by_token: self.begun_by_token, suspect: None };
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
    fn two_late_syncs_in_a_row_begin_nothing() {
        let mut tracker = tracker(7);
        assert_eq!(tracker.lost(), Some(count(8)));
        assert_eq!(tracker.lost(), Some(count(9)));
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
}
