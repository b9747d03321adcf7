//! When the plant's cycles begin: by SYNC, or by its own timer where SYNC does not come.
//!
//! ```text
//!   t_k             t_k + P          t_k + P + W                       P  the cycle time
//!   ├───────────────┼────────────────┤                                 W  30 % of P
//!   SYNC k          SYNC k + 1 due   own timer: cycle k + 1 begins, as of t_k + P
//! ```
//!
//! All times are those that the driver passes in, µs. A cycle that the timer began counts from when
//! its SYNC was due, not from the late moment of noticing, so that a row of lost SYNCs does not
//! stretch the period. A SYNC that comes after all, within half a period of that, sets the phase
//! anew.

use protocol::table::HEARTBEAT_EVERY_CYCLES;

/// How long after SYNC was due the own timer begins the cycle, % of the period. Longer than a bus
/// at 80 % load delays a frame, and early enough that feedback still comes well before the deadline
/// of the servo at 60 %.
const TIMER_PERCENT: u64 = 30;
/// Periods without SYNC after which it counts as gone, where nothing else is asked for.
const SYNC_TIMEOUT_PERIODS: u64 = 5;

/// The plant's time.
#[derive(Clone, Copy, Debug)]
#[expect(clippy::struct_field_names, reason = "the unit belongs to the name")]
pub struct BusTime {
    period_us: u64,
    timeout_us: u64,
    began_us: Option<u64>,
    last_sync_us: Option<u64>,
    heartbeat_due_us: u64,
}

impl BusTime {
    /// Time before the first SYNC; the first heartbeat is due at once.
    #[must_use]
    pub const fn new(period_us: u64, timeout_us: u64) -> Self {
        Self {
            period_us,
            timeout_us,
            began_us: None,
            last_sync_us: None,
            heartbeat_due_us: 0,
        }
    }

    /// The same with another SYNC timeout; 0 means five periods.
    pub fn set_timeout_us(&mut self, timeout_us: u64) {
        self.timeout_us = timeout_us;
    }

    /// When the next SYNC is due.
    #[must_use]
    pub fn sync_due_us(&self) -> Option<u64> {
        self.began_us.map(|began| began + self.period_us)
    }

    /// When the own timer begins the next cycle.
    #[must_use]
    pub fn timer_us(&self) -> Option<u64> {
        self.sync_due_us()
            .map(|due| due + self.period_us * TIMER_PERCENT / 100)
    }

    /// A SYNC frame came, whatever it meant.
    pub fn note_sync(&mut self, now_us: u64) {
        self.last_sync_us = Some(now_us);
    }

    /// A cycle begins with its SYNC.
    pub fn begin(&mut self, now_us: u64) {
        self.began_us = Some(now_us);
    }

    /// A cycle begins without its SYNC.
    pub fn begin_without_sync(&mut self) {
        self.began_us = self.sync_due_us();
    }

    /// The SYNC of a cycle that was begun without it.
    pub fn confirm(&mut self, now_us: u64) {
        if self
            .began_us
            .is_some_and(|began| began.abs_diff(now_us) <= self.period_us / 2)
        {
            self.began_us = Some(now_us);
        }
    }

    /// Whether SYNC stayed away for longer than the timeout when the present cycle began.
    #[must_use]
    pub fn sync_is_gone(&self) -> bool {
        let timeout = if self.timeout_us == 0 {
            SYNC_TIMEOUT_PERIODS * self.period_us
        } else {
            self.timeout_us
        };
        match (self.began_us, self.last_sync_us) {
            (Some(began), Some(last)) => began.saturating_sub(last) >= timeout,
            (None, _) | (_, None) => false,
        }
    }

    /// The own timer stops until the next SYNC.
    pub fn stop(&mut self) {
        self.began_us = None;
    }

    /// When the next heartbeat is due.
    #[must_use]
    pub const fn heartbeat_due_us(&self) -> u64 {
        self.heartbeat_due_us
    }

    /// The next heartbeat is due now.
    pub fn beat_now(&mut self, now_us: u64) {
        self.heartbeat_due_us = now_us;
    }

    /// A heartbeat (or boot-up) was sent; the grid stays unless more than one was missed.
    pub fn beaten(&mut self, now_us: u64) {
        let interval = u64::from(HEARTBEAT_EVERY_CYCLES) * self.period_us;
        let next = self.heartbeat_due_us + interval;
        self.heartbeat_due_us = if next > now_us {
            next
        } else {
            now_us + interval
        };
    }
}
