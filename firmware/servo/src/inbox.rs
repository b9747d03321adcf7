//! What has come in for the present cycle, told by counter and never by arrival order.
//!
//! Cycle k needs the feedback k and the setpoint of cycle k + 1, the preview. Each of them comes or
//! does not; the cycle is complete when both are in. What comes too late for its cycle is still
//! worth something: a setpoint that arrives one cycle late is the setpoint of the present cycle, in
//! the place of its extrapolation.

use protocol::SyncCounter;
use protocol::message::{Feedback, Setpoint};

/// Why a frame is missing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Miss {
    /// It did not come.
    #[default]
    Absent,
    /// One came with an old counter.
    Stale,
    /// One came that cannot be decoded.
    Malformed,
    /// One came with a value that the axis cannot have reached.
    Implausible,
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
    /// It shows that the next cycle is on; take it again after beginning that one.
    NextCycle,
}

/// What a cycle has to go by.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contents {
    /// Encoder positions of this cycle.
    pub feedback: Result<Feedback, Miss>,
    /// Setpoint of the next cycle.
    pub preview: Result<Setpoint, Miss>,
    /// Setpoint of this cycle, where it came too late to be its preview.
    pub present: Option<Setpoint>,
}

impl Contents {
    /// A cycle in which nothing came.
    pub const NOTHING: Self = Self {
        feedback: Err(Miss::Absent),
        preview: Err(Miss::Absent),
        present: None,
    };
}

/// What has come in for the present cycle.
#[derive(Clone, Debug)]
pub struct Inbox {
    counter: Option<SyncCounter>,
    open: bool,
    contents: Contents,
    /// The preview was there when its cycle was closed.
    preview_used: bool,
}

impl Default for Inbox {
    fn default() -> Self {
        Self {
            counter: None,
            open: false,
            contents: Contents::NOTHING,
            preview_used: false,
        }
    }
}

impl Inbox {
    /// Counter of the present cycle; `None` before the first SYNC.
    #[must_use]
    pub const fn counter(&self) -> Option<SyncCounter> {
        self.counter
    }

    /// Whether a cycle has begun that is not closed yet.
    #[must_use]
    pub const fn is_open(&self) -> bool {
        self.open
    }

    /// Whether everything is in; `wants_setpoint` is false in cycles in which none is due.
    #[must_use]
    pub const fn is_complete(&self, wants_setpoint: bool) -> bool {
        self.open
            && self.contents.feedback.is_ok()
            && (self.contents.preview.is_ok() || !wants_setpoint)
    }

    /// What the present cycle has to go by.
    #[must_use]
    pub const fn contents(&self) -> &Contents {
        &self.contents
    }

    /// Begins the cycle of a counter.
    pub fn begin(&mut self, counter: SyncCounter) {
        self.keep_what_is_due(counter);
        self.contents.feedback = Err(Miss::Absent);
        self.contents.preview = Err(Miss::Absent);
        self.counter = Some(counter);
        self.open = true;
        self.preview_used = false;
    }

    /// A preview that came after its cycle was closed is the setpoint of the cycle that begins;
    /// before the first SYNC the newest setpoint waits for the cycle that it names.
    fn keep_what_is_due(&mut self, counter: SyncCounter) {
        if self.counter.is_some() {
            self.contents.present = None;
            if self.preview_used {
                return;
            }
            self.contents.present = self.contents.preview.ok();
        }
        if self
            .contents
            .present
            .is_some_and(|setpoint| setpoint.counter != counter)
        {
            self.contents.present = None;
        }
    }

    /// Closes the present cycle.
    pub const fn close(&mut self) {
        self.open = false;
        self.preview_used = self.contents.preview.is_ok();
    }

    /// Takes a setpoint.
    pub fn setpoint(&mut self, setpoint: Setpoint) -> Taken {
        let Some(now) = self.counter else {
            self.contents.present = Some(setpoint);
            return Taken::Used;
        };
        if setpoint.counter == now.next() {
            return fill(&mut self.contents.preview, setpoint);
        }
        if setpoint.counter == now.next().next() {
            return Taken::NextCycle;
        }
        if setpoint.counter == now && self.open && self.contents.present.is_none() {
            self.contents.present = Some(setpoint);
        }
        miss(&mut self.contents.preview, Miss::Stale);
        Taken::Stale
    }

    /// Takes a feedback.
    pub fn feedback(&mut self, feedback: Feedback) -> Taken {
        if self.counter == Some(feedback.counter) {
            return if self.open {
                fill(&mut self.contents.feedback, feedback)
            } else {
                Taken::Doubled
            };
        }
        if self
            .counter
            .is_some_and(|now| now.next() == feedback.counter)
        {
            return Taken::NextCycle;
        }
        miss(&mut self.contents.feedback, Miss::Stale);
        Taken::Stale
    }

    /// A setpoint came that cannot be decoded.
    pub const fn malformed_setpoint(&mut self) {
        miss(&mut self.contents.preview, Miss::Malformed);
    }

    /// A feedback came that cannot be decoded.
    pub const fn malformed_feedback(&mut self) {
        miss(&mut self.contents.feedback, Miss::Malformed);
    }
}

const fn fill<T: Copy>(slot: &mut Result<T, Miss>, value: T) -> Taken {
    match slot {
        Ok(_) => Taken::Doubled,
        Err(_) => {
            *slot = Ok(value);
            Taken::Used
        }
    }
}

const fn miss<T: Copy>(slot: &mut Result<T, Miss>, why: Miss) {
    if slot.is_err() {
        *slot = Err(why);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use protocol::states::ControlWord;
    use protocol::weight::{LoadIncrements24, MotorIncrements, SetpointFine};

    fn count(value: u8) -> SyncCounter {
        SyncCounter::new(value).unwrap()
    }

    fn setpoint(counter: u8) -> Setpoint {
        Setpoint {
            control: ControlWord::default(),
            counter: count(counter),
            position: SetpointFine::default(),
        }
    }

    fn feedback(counter: u8) -> Feedback {
        Feedback {
            motor: MotorIncrements(0),
            load: LoadIncrements24::from_counts(0),
            counter: count(counter),
        }
    }

    fn at(counter: u8) -> Inbox {
        let mut inbox = Inbox::default();
        inbox.begin(count(counter));
        inbox
    }

    #[test]
    fn a_cycle_is_complete_with_its_feedback_and_the_setpoint_of_the_next() {
        let mut inbox = at(240);
        assert_eq!(inbox.feedback(feedback(240)), Taken::Used);
        assert!(!inbox.is_complete(true) && inbox.is_complete(false));
        assert_eq!(inbox.setpoint(setpoint(1)), Taken::Used);
        assert!(inbox.is_complete(true));
        inbox.close();
        assert_eq!(inbox.contents().preview, Ok(setpoint(1)));
        assert!(!inbox.is_open());
    }

    #[test]
    fn a_frame_of_the_next_cycle_says_so_and_an_old_one_is_stale() {
        let mut inbox = at(7);
        assert_eq!(inbox.feedback(feedback(8)), Taken::NextCycle);
        assert_eq!(inbox.setpoint(setpoint(9)), Taken::NextCycle);
        assert_eq!(inbox.feedback(feedback(3)), Taken::Stale);
        assert_eq!(inbox.setpoint(setpoint(2)), Taken::Stale);
        let contents = inbox.contents();
        assert_eq!(
            (contents.feedback, contents.preview),
            (Err(Miss::Stale), Err(Miss::Stale))
        );
    }

    #[test]
    fn a_setpoint_that_is_one_cycle_late_is_the_present_one() {
        let mut inbox = at(7);
        inbox.close();
        assert_eq!(inbox.setpoint(setpoint(8)), Taken::Used);
        inbox.begin(count(8));
        assert_eq!(inbox.contents().present, Some(setpoint(8)));
        let mut inbox = at(7);
        inbox.setpoint(setpoint(7));
        assert_eq!(inbox.contents().present, Some(setpoint(7)));
    }

    #[test]
    fn before_the_first_sync_the_newest_setpoint_waits_for_its_cycle() {
        let mut inbox = Inbox::default();
        inbox.setpoint(setpoint(5));
        inbox.setpoint(setpoint(1));
        inbox.begin(count(1));
        assert_eq!(inbox.contents().present, Some(setpoint(1)));
    }

    #[test]
    fn a_double_changes_nothing() {
        let mut inbox = at(7);
        inbox.setpoint(setpoint(8));
        assert_eq!(inbox.setpoint(setpoint(8)), Taken::Doubled);
        inbox.feedback(feedback(7));
        assert_eq!(inbox.feedback(feedback(7)), Taken::Doubled);
    }
}
