//! What has come in for the present cycle, told by counter and never by arrival order.
//!
//! A slot is waiting, fresh or missed. The cycle is complete when no slot waits. A frame that is lost (a token from the port), malformed
//! or stale closes its slot as missed, so that lock-step cannot stand still; the one late frame that fills a hole of the
//! cycle before does not.

use protocol::SyncCounter;
use protocol::message::{Feedback, Setpoint};

/// Why a frame is missing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Miss {
    /// It did not come.
    Absent,
    /// One came with an old counter.
    Stale,
    /// One came that cannot be decoded.
    Malformed,
    /// One came with a value that the axis cannot have reached.
    Implausible,
}

/// A frame that is expected in a cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Slot<T> {
    /// Not yet there.
    Waiting,
    /// There.
    Fresh(T),
    /// Will not come.
    Missed(Miss),
}

impl<T: Copy> Slot<T> {
    /// Closes the slot if it still waits.
    pub fn close(&mut self, miss: Miss) {
        if matches!(self, Self::Waiting) {
            *self = Self::Missed(miss);
        }
    }

    /// What came, or why not; a slot that still waits counts as absent.
    ///
    /// # Errors
    /// The reason why nothing came.
    pub fn outcome(&self) -> Result<T, Miss> {
        match *self {
            Self::Fresh(value) => Ok(value),
            Self::Missed(miss) => Err(miss),
            Self::Waiting => Err(Miss::Absent),
        }
    }

    const fn waits(&self) -> bool {
        matches!(self, Self::Waiting)
    }

    const fn is_missed(&self) -> bool {
        matches!(self, Self::Missed(_))
    }
}

/// How a frame was taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Taken {
    /// Used.
    Used,
    /// Its slot was filled already.
    Doubled,
    /// Its counter is old.
    Stale,
}

/// The slots of the present cycle and of the next setpoint.
#[derive(Clone, Debug)]
pub struct Inbox {
    counter: Option<SyncCounter>,
    closed: bool,
    setpoint: Slot<Setpoint>,
    next_setpoint: Slot<Setpoint>,
    feedback: Slot<Feedback>,
    feedback_hole: bool,
}

impl Default for Inbox {
    fn default() -> Self {
        Self {
            counter: None,
            closed: true,
            setpoint: Slot::Waiting,
            next_setpoint: Slot::Waiting,
            feedback: Slot::Waiting,
            feedback_hole: false,
        }
    }
}

impl Inbox {
    /// Counter of the present cycle; `None` before the first SYNC.
    #[must_use]
    pub const fn counter(&self) -> Option<SyncCounter> {
        self.counter
    }

    /// Whether SYNC began a cycle that is not computed yet.
    #[must_use]
    pub const fn is_open(&self) -> bool {
        !self.closed
    }

    /// Whether everything is in, or known to be missing.
    #[must_use]
    pub const fn is_complete(&self) -> bool {
        !self.closed && !self.next_setpoint.waits() && !self.feedback.waits()
    }

    /// The setpoint of the next cycle.
    ///
    /// # Errors
    /// The reason why it is not there.
    pub fn preview(&self) -> Result<Setpoint, Miss> {
        self.next_setpoint.outcome()
    }

    /// Begins the cycle of a counter.
    pub fn begin(&mut self, counter: SyncCounter) {
        self.feedback_hole = self.feedback.is_missed();
        self.counter = Some(counter);
        self.closed = false;
        self.feedback = Slot::Waiting;
        self.setpoint = match self.next_setpoint {
            Slot::Fresh(early) if early.counter == counter => Slot::Fresh(early),
            Slot::Fresh(_) => Slot::Missed(Miss::Stale),
            // Setpoints come one cycle early: at SYNC it is there, or it was lost without a token.
            Slot::Waiting => Slot::Missed(Miss::Absent),
            Slot::Missed(miss) => Slot::Missed(miss),
        };
        self.next_setpoint = Slot::Waiting;
    }

    /// Ends the present cycle.
    pub fn end(&mut self) -> (Result<Setpoint, Miss>, Result<Feedback, Miss>) {
        self.closed = true;
        self.feedback.close(Miss::Absent);
        self.next_setpoint.close(Miss::Absent);
        (self.setpoint.outcome(), self.feedback.outcome())
    }

    /// Takes a setpoint: for this cycle, or one cycle early.
    pub fn setpoint(&mut self, setpoint: Setpoint) -> Taken {
        let now = self.counter;
        if now == Some(setpoint.counter) {
            return if self.setpoint.waits() && !self.closed {
                fill(&mut self.setpoint, setpoint)
            } else {
                Taken::Doubled
            };
        }
        if now.is_none_or(|now| now.next() == setpoint.counter) {
            return match self.next_setpoint {
                Slot::Missed(_) if self.closed && now.is_some() => Taken::Stale,
                // Before the first SYNC there is no cycle to belong to: the newest counts.
                Slot::Fresh(_) if now.is_some() => Taken::Doubled,
                Slot::Fresh(_) => fill(&mut self.next_setpoint, setpoint),
                Slot::Waiting | Slot::Missed(_) => fill(&mut self.next_setpoint, setpoint),
            };
        }
        self.next_setpoint.close(Miss::Stale);
        Taken::Stale
    }

    /// Takes a feedback of this cycle.
    pub fn feedback(&mut self, feedback: Feedback) -> Taken {
        if self.counter == Some(feedback.counter) {
            return if self.feedback.waits() { fill(&mut self.feedback, feedback) } else { Taken::Doubled };
        }
        let fills_hole = self.feedback_hole && self.counter == Some(feedback.counter.next());
        if fills_hole {
            self.feedback_hole = false;
        } else {
            self.feedback.close(Miss::Stale);
        }
        Taken::Stale
    }

    /// The setpoint on its way (one cycle early) will not come.
    pub fn miss_setpoint(&mut self, miss: Miss) {
        self.next_setpoint.close(miss);
    }

    /// The feedback of this cycle will not come.
    pub fn miss_feedback(&mut self, miss: Miss) {
        self.feedback.close(miss);
    }
}

fn fill<T>(slot: &mut Slot<T>, value: T) -> Taken {
    *slot = Slot::Fresh(value);
    Taken::Used
}
