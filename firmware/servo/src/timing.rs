//! When a cycle closes, and when the next one begins without SYNC.
//!
//! ```text
//! SYNC k                    deadline k             SYNC k+1 due      own timer
//!   ├──────────────────────────┼──────────────────────┼─────────────────┤
//!  began                 began + 0.6 P           began + P        began + 1.3 P
//! ```
//!
//! P is the period of the active parameter set (1006h). The deadline leaves 0.4 P for the torque to
//! reach the plant before the next SYNC; the own timer of a node comes 0.3 P after a SYNC that was
//! due, so that a plant that missed SYNC still delivers its feedback before the servo's deadline
//! (0.3 P before it). All times are bus times in µs, passed in from outside.

use protocol::SyncCounter;

/// Times of the cycles.
#[derive(Clone, Copy, Debug)]
pub struct Timing {
    spans: Spans,
    /// When the present cycle began.
    began_us: Option<u64>,
    /// Nothing is due before this, whatever the drive does; zero: not known.
    quiet_until_us: u64,
    sync: Option<(u64, SyncCounter)>,
    odd_intervals: u8,
}

/// What follows from a period, taken once for all cycles; from the beginning of a cycle on.
#[derive(Clone, Copy, Debug)]
#[expect(clippy::struct_field_names, reason = "what they share is their unit")]
struct Spans {
    period_us: u32,
    deadline_us: u32,
    own_timer_us: u32,
}

impl Spans {
    const fn of(period_us: u32) -> Self {
        Self {
            period_us,
            deadline_us: tenths(period_us, DEADLINE_TENTHS),
            own_timer_us: period_us.saturating_add(tenths(period_us, PATIENCE_TENTHS)),
        }
    }
}

/// Share of the period after which a cycle closes without its frames, in tenths.
const DEADLINE_TENTHS: u32 = 6;
/// Share of the period by which SYNC may be late before the node goes on without it, in tenths.
const PATIENCE_TENTHS: u32 = 3;
/// SYNC intervals in a row that differ from the period by more than a quarter before the node
/// believes that the master has another one: one is a lost or late SYNC, and three in a row are a
/// bus that is not fit for a closed loop anyway.
const ODD_INTERVALS: u8 = 3;

impl Timing {
    /// A node that has not seen SYNC yet.
    #[must_use]
    pub const fn new(period_us: u32) -> Self {
        Self {
            spans: Spans::of(period_us),
            began_us: None,
            quiet_until_us: 0,
            sync: None,
            odd_intervals: 0,
        }
    }

    /// The same node with the period of another parameter set.
    pub const fn set_period(&mut self, period_us: u32) {
        self.spans = Spans::of(period_us);
        self.odd_intervals = 0;
        self.quiet_until_us = 0;
    }

    const fn begin(&mut self, at_us: u64) {
        self.began_us = Some(at_us);
        self.quiet_until_us = 0;
    }

    /// The present cycle waits for its frames: nothing is due before its deadline.
    pub fn open(&mut self) {
        self.quiet_until_us = self.deadline_us().unwrap_or(0);
    }

    /// The present cycle is closed: nothing is due before the next begins by itself.
    pub fn close(&mut self) {
        self.quiet_until_us = self.own_timer_us().unwrap_or(0);
    }

    /// Whether it is known that nothing was due until now.
    #[must_use]
    pub const fn is_quiet(&self, now_us: u64) -> bool {
        now_us < self.quiet_until_us
    }

    /// A cycle begins with a SYNC frame.
    pub fn begin_by_sync(&mut self, now_us: u64, counter: SyncCounter) {
        self.note_sync(now_us, counter);
        self.begin(now_us);
    }

    /// A cycle begins without its SYNC: when it was due.
    pub fn begin_without_sync(&mut self, now_us: u64) {
        self.begin(self.sync_due_us().map_or(now_us, |due| due.min(now_us)));
    }

    /// The SYNC of a cycle that was begun without it came after all; it sets the phase where it
    /// belongs to this cycle by its time.
    pub fn confirm(&mut self, now_us: u64, counter: SyncCounter) {
        self.note_sync(now_us, counter);
        let half = u64::from(self.spans.period_us >> 1);
        if self
            .began_us()
            .is_none_or(|began| now_us.saturating_sub(began) < half)
        {
            self.begin(now_us);
        }
    }

    fn note_sync(&mut self, now_us: u64, counter: SyncCounter) {
        if let Some((last_us, last)) = self.sync {
            let period_us = self.spans.period_us;
            let wanted_us = if counter == last.next() {
                period_us
            } else {
                u32::from(counter.cycles_since(last)).saturating_mul(period_us)
            };
            let got_us = u32::try_from(now_us.wrapping_sub(last_us)).unwrap_or(u32::MAX);
            let odd = got_us.abs_diff(wanted_us) > period_us >> 2;
            self.odd_intervals = if odd {
                self.odd_intervals.saturating_add(1)
            } else {
                0
            };
        }
        self.sync = Some((now_us, counter));
    }

    /// Whether SYNC comes at another period than the parameter set was made for.
    #[must_use]
    pub const fn period_is_off(&self) -> bool {
        self.odd_intervals >= ODD_INTERVALS
    }

    /// When the present cycle began.
    #[must_use]
    pub const fn began_us(&self) -> Option<u64> {
        self.began_us
    }

    /// When the present cycle closes without its frames.
    #[must_use]
    pub fn deadline_us(&self) -> Option<u64> {
        self.after(self.spans.deadline_us)
    }

    /// When the next SYNC is due.
    #[must_use]
    pub fn sync_due_us(&self) -> Option<u64> {
        self.after(self.spans.period_us)
    }

    /// When the node goes on without it.
    #[must_use]
    pub fn own_timer_us(&self) -> Option<u64> {
        self.after(self.spans.own_timer_us)
    }

    fn after(&self, span_us: u32) -> Option<u64> {
        let began_us = self.began_us?;
        // 2⁶⁴ µs are 580 000 years.
        Some(began_us.wrapping_add(u64::from(span_us)))
    }

    /// Whether the last SYNC frame is longer ago than a timeout.
    #[must_use]
    pub fn sync_is_gone(&self, now_us: u64, timeout_us: u64) -> bool {
        self.sync
            .is_some_and(|(last, _)| now_us.saturating_sub(last) > timeout_us)
    }

    /// So many periods, µs.
    #[must_use]
    pub fn periods_us(&self, periods: u16) -> u64 {
        u64::from(self.spans.period_us).saturating_mul(u64::from(periods))
    }

    /// Forgets the phase: the next SYNC is the first.
    pub const fn stop(&mut self) {
        *self = Self::new(self.spans.period_us);
    }
}

/// Tenths of a period; a period is at most 20 000 µs, so the product fits.
const fn tenths(period_us: u32, tenths: u32) -> u32 {
    period_us.saturating_mul(tenths) / 10
}

#[cfg(test)]
mod tests {
    use super::*;

    fn count(value: u8) -> SyncCounter {
        SyncCounter::new(value).unwrap()
    }

    #[test]
    fn the_cycle_closes_at_six_tenths_and_the_next_begins_by_itself_at_thirteen() {
        let mut timing = Timing::new(1000);
        timing.begin_by_sync(5000, count(1));
        assert_eq!(timing.deadline_us(), Some(5600));
        assert_eq!(timing.own_timer_us(), Some(6300));
        timing.begin_without_sync(6300);
        assert_eq!(
            timing.deadline_us(),
            Some(6600),
            "the phase is that of the SYNC that did not come"
        );
    }

    #[test]
    fn a_late_sync_sets_the_phase_only_within_half_a_period() {
        let mut timing = Timing::new(1000);
        timing.begin_by_sync(0, count(1));
        timing.begin_without_sync(1300);
        timing.confirm(1400, count(2));
        assert_eq!(timing.sync_due_us(), Some(2400));
        timing.begin_without_sync(2700);
        timing.confirm(3300, count(3));
        assert_eq!(timing.sync_due_us(), Some(3400));
    }

    #[test]
    fn another_period_is_noticed_and_single_losses_are_not() {
        let mut timing = Timing::new(1000);
        for (at, counter) in [(0, 1), (1000, 2), (3000, 4), (4200, 5), (5000, 6)] {
            timing.begin_by_sync(at, count(counter));
        }
        assert!(!timing.period_is_off());
        for cycle in 1..=4_u8 {
            timing.begin_by_sync(5000 + 2000 * u64::from(cycle), count(6 + cycle));
        }
        assert!(timing.period_is_off());
    }
}
