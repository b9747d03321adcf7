//! Watchdogs: how often in a row something was missing, and what that amounts to.
//!
//! All but one count cycles. The one on the wall clock notices that SYNC itself is gone.

use protocol::Fault;

use crate::inbox::Miss;

/// Counters of everything that can be missing.
#[derive(Clone, Copy, Debug, Default)]
pub struct Watchdog {
    setpoint_misses: u16,
    feedback_misses: u16,
    heartbeat_cycles: u16,
    last_sync_us: Option<u64>,
    lost: u32,
    stale: u32,
    malformed: u32,
    implausible: u32,
    doubled: u32,
}

impl Watchdog {
    /// A cycle's setpoint; a fault when too many in a row were missing.
    pub fn setpoint(&mut self, miss: Option<Miss>, allowed: u16) -> Option<Fault> {
        over(&mut self.setpoint_misses, miss, allowed).map(|_| Fault::SetpointMissing)
    }

    /// A cycle's feedback; a fault when too many in a row were missing, named after the last miss.
    pub fn feedback(&mut self, miss: Option<Miss>, allowed: u16) -> Option<Fault> {
        if miss == Some(Miss::Implausible) {
            self.implausible = self.implausible.saturating_add(1);
        }
        over(&mut self.feedback_misses, miss, allowed).map(|miss| match miss {
            Miss::Absent => Fault::FeedbackMissing,
            Miss::Stale => Fault::StaleCounter,
            Miss::Malformed => Fault::MalformedFrame,
            Miss::Implausible => Fault::EncoderJump,
        })
    }

    /// Setpoints and feedbacks that were missing in a row.
    #[must_use]
    pub const fn misses(&self) -> (u16, u16) {
        (self.setpoint_misses, self.feedback_misses)
    }

    /// The plant is alive.
    pub fn heartbeat(&mut self) {
        self.heartbeat_cycles = 0;
    }

    /// Counts a cycle without heartbeat.
    pub fn heartbeat_is_gone(&mut self, allowed: u16) -> bool {
        self.heartbeat_cycles = self.heartbeat_cycles.saturating_add(1);
        self.heartbeat_cycles > allowed
    }

    /// SYNC came.
    pub fn sync(&mut self, now_us: u64) {
        self.last_sync_us = Some(now_us);
    }

    /// When SYNC came last.
    #[must_use]
    pub const fn last_sync_us(&self) -> Option<u64> {
        self.last_sync_us
    }

    /// Whether SYNC is gone, by wall clock.
    #[must_use]
    pub fn sync_is_gone(&self, now_us: u64, timeout_us: u64) -> bool {
        self.last_sync_us.is_some_and(|last| now_us.saturating_sub(last) > timeout_us)
    }

    /// A lost-frame token came.
    pub fn lost(&mut self) {
        self.lost = self.lost.saturating_add(1);
    }

    /// A frame with an old counter came.
    pub fn stale(&mut self) {
        self.stale = self.stale.saturating_add(1);
    }

    /// A frame came that cannot be decoded.
    pub fn malformed(&mut self) {
        self.malformed = self.malformed.saturating_add(1);
    }

    /// A frame came twice.
    pub fn doubled(&mut self) {
        self.doubled = self.doubled.saturating_add(1);
    }

    /// Forgets what led to a fault; the diagnostic counts stay.
    pub fn forgive(&mut self) {
        self.setpoint_misses = 0;
        self.feedback_misses = 0;
        self.heartbeat_cycles = 0;
    }

    /// Lost, stale, malformed, implausible, doubled since reset.
    #[must_use]
    pub const fn diagnostics(&self) -> [u32; 5] {
        [self.lost, self.stale, self.malformed, self.implausible, self.doubled]
    }
}

fn over(count: &mut u16, miss: Option<Miss>, allowed: u16) -> Option<Miss> {
    let Some(miss) = miss else {
        *count = 0;
        return None;
    };
    *count = count.saturating_add(1);
    (*count > allowed).then_some(miss)
}
