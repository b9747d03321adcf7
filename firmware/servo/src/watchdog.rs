//! Watchdogs: how often in a row something was missing, and what that amounts to; and the counts of
//! everything that was odd.

use protocol::Fault;

use crate::inbox::{Miss, Taken};

/// What happened since reset. Computed + bridged + refused = cycles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Cycles with everything they needed.
    pub computed: u32,
    /// Cycles that went without a feedback or a setpoint, or whose SYNC did not come.
    pub bridged: u32,
    /// Cycles whose setpoint or feedback was there and refused.
    pub refused: u32,
    /// Cycles that were closed by the deadline or begun by the own timer.
    pub by_deadline: u32,
    /// Frames with an old counter.
    pub stale: u32,
    /// Frames that cannot be decoded.
    pub malformed: u32,
    /// Feedbacks that the axis cannot have reached.
    pub implausible: u32,
    /// Frames that came twice.
    pub doubled: u32,
    /// Readings of a load scale that cannot be true and that the loop does not need.
    pub scale_warnings: u32,
}

impl Counts {
    /// How many counts there are.
    pub const NUMBER: usize = 9;

    /// The counts in the order of the subindices from 1 on of 2200h.
    #[must_use]
    pub const fn in_order(&self) -> [u32; Self::NUMBER] {
        [
            self.computed,
            self.bridged,
            self.refused,
            self.by_deadline,
            self.stale,
            self.malformed,
            self.implausible,
            self.doubled,
            self.scale_warnings,
        ]
    }
}

/// Counters of everything that can be missing.
#[derive(Clone, Copy, Debug, Default)]
pub struct Watchdog {
    setpoint_misses: u16,
    feedback_misses: u16,
    /// Since reset.
    pub counts: Counts,
}

impl Watchdog {
    /// A cycle's setpoint; a fault when too many in a row were missing.
    pub fn setpoint(&mut self, miss: Option<Miss>, allowed: u16) -> Option<Fault> {
        over(&mut self.setpoint_misses, miss, allowed).map(|_| Fault::SetpointMissing)
    }

    /// A cycle's feedback; a fault when too many in a row were missing, named after the last miss.
    pub fn feedback(&mut self, miss: Option<Miss>, allowed: u16) -> Option<Fault> {
        if miss == Some(Miss::Implausible) {
            self.counts.implausible = self.counts.implausible.saturating_add(1);
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

    /// A frame with a counter was taken.
    pub const fn taken(&mut self, taken: Taken) {
        match taken {
            Taken::Used | Taken::NextCycle => {}
            Taken::Doubled => self.counts.doubled = self.counts.doubled.saturating_add(1),
            Taken::Stale => self.counts.stale = self.counts.stale.saturating_add(1),
        }
    }

    /// A cycle has ended.
    pub const fn cycle(&mut self, was_missed: bool, was_refused: bool) {
        let count = match (was_refused, was_missed) {
            (true, _) => &mut self.counts.refused,
            (false, true) => &mut self.counts.bridged,
            (false, false) => &mut self.counts.computed,
        };
        *count = count.saturating_add(1);
    }

    /// Forgets what led to a fault; the counts stay.
    pub const fn forgive(&mut self) {
        self.setpoint_misses = 0;
        self.feedback_misses = 0;
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn so_many_misses_in_a_row_are_a_fault_named_after_the_last() {
        let mut watchdog = Watchdog::default();
        for miss in [
            Some(Miss::Absent),
            Some(Miss::Absent),
            None,
            Some(Miss::Absent),
            Some(Miss::Stale),
        ] {
            assert_eq!(watchdog.feedback(miss, 2), None);
        }
        assert_eq!(
            watchdog.feedback(Some(Miss::Implausible), 2),
            Some(Fault::EncoderJump)
        );
        assert_eq!(watchdog.counts.implausible, 1);
    }

    #[test]
    fn every_cycle_is_counted_once() {
        let mut watchdog = Watchdog::default();
        for (missed, refused) in [(false, false), (true, false), (true, true), (false, true)] {
            watchdog.cycle(missed, refused);
        }
        let Counts {
            computed,
            bridged,
            refused,
            ..
        } = watchdog.counts;
        assert_eq!((computed, bridged, refused), (1, 1, 2));
    }
}
