//! What makes a cycle begin and close: SYNC, a frame that shows that the next cycle is on, the
//! deadline, the node's own timer.

use protocol::counter::SYNC_OVERFLOW;
use protocol::message::NmtState;
use protocol::{CanFrame, Fault, SyncCounter};

use crate::Servo;
use crate::axis::{Circumstances, Notices};
use crate::conversion::SYNC_TIMEOUT_PERIODS;
use crate::inbox::Contents;
use crate::stage::StageOutput;

impl Servo {
    /// Lets time pass: does what is due, at most one cycle's worth. Call again while
    /// [`Self::wake_at_us`] is not later.
    #[must_use = "the frames have to go on the bus"]
    pub fn on_time(&mut self, now_us: u64) -> &[CanFrame] {
        self.outbox.clear();
        self.step_time(now_us);
        &self.outbox
    }

    /// When something is due next, unless a frame comes before.
    #[must_use]
    pub fn wake_at_us(&self) -> Option<u64> {
        let heartbeat = self
            .timing
            .began_us()
            .is_none()
            .then(|| self.periodic.heartbeat_due_us())
            .flatten();
        let cycle = if self.inbox.is_open() {
            self.timing.deadline_us()
        } else {
            self.next_begin_us()
        };
        match (cycle, heartbeat) {
            (Some(cycle), Some(heartbeat)) => Some(cycle.min(heartbeat)),
            (cycle, heartbeat) => cycle.or(heartbeat),
        }
    }

    /// When the node begins a cycle without SYNC; without torque it rather waits until SYNC counts
    /// as gone.
    fn next_begin_us(&self) -> Option<u64> {
        let own = self.timing.own_timer_us()?;
        if self.axis.drive.is_energised() {
            Some(own)
        } else {
            own.checked_add(self.sync_timeout_us())
        }
    }

    fn sync_timeout_us(&self) -> u64 {
        self.active
            .as_ref()
            .map_or(0, |settings| settings.limits.sync_timeout_us)
    }

    /// Catches up with what was due strictly before a frame arrives; bounded, because a node that
    /// was held up for long has a fault to latch and not a past to live through.
    pub(crate) fn catch_up(&mut self, now_us: u64) {
        for _ in 0..CATCH_UP_EVENTS {
            match self.wake_at_us() {
                Some(due) if due < now_us => self.step_time(due),
                _ => return,
            }
        }
    }

    fn step_time(&mut self, now_us: u64) {
        self.start_clock(now_us);
        if self.inbox.is_open() {
            if self.timing.deadline_us().is_some_and(|due| due <= now_us) {
                self.close(true);
            }
        } else if self.next_begin_us().is_some_and(|due| due <= now_us) {
            self.go_on_without_sync(now_us);
        } else if self.timing.began_us().is_none() {
            self.beat(now_us);
        }
    }

    fn go_on_without_sync(&mut self, now_us: u64) {
        if !self.axis.drive.is_energised() {
            self.leave_the_cycle();
            return;
        }
        self.begin_without_sync(now_us);
    }

    /// The next cycle begins by the own timer, or because a frame shows that it is on although its
    /// SYNC did not come.
    pub(crate) fn begin_without_sync(&mut self, now_us: u64) {
        let Some(counter) = self.sync.begin_without_sync() else {
            return;
        };
        self.timing.begin_without_sync(now_us);
        self.open(counter, false);
        if self.axis.drive.is_energised()
            && self.timing.sync_is_gone(now_us, self.sync_timeout_us())
        {
            self.latch(Fault::SyncMissing);
        }
    }

    /// SYNC is not waited for any more; the next one is the first.
    pub(crate) fn leave_the_cycle(&mut self) {
        self.timing.stop();
        self.sync = protocol::SyncTracker::default();
        self.inbox = crate::inbox::Inbox::default();
        self.axis.encoders.forget();
    }

    pub(crate) fn begin_by_sync(&mut self, counter: SyncCounter, now_us: u64) {
        let first = self.timing.began_us().is_none();
        self.timing.begin_by_sync(now_us, counter);
        if first {
            self.periodic.beat_now(now_us, self.silence_us());
        }
        self.open(counter, true);
    }

    fn open(&mut self, counter: SyncCounter, in_sync: bool) {
        let follows = |before: SyncCounter| before.next() == counter;
        if self.inbox.is_open() || !self.inbox.counter().is_some_and(follows) {
            self.end_what_was(counter);
            if self.timing.began_us().is_none() {
                // A command of NMT waited for the end of that cycle: this one is not the node's.
                return;
            }
        }
        self.activate();
        self.inbox.begin(counter);
        self.timing.open();
        self.in_sync = in_sync;
    }

    /// The cycle before is still open, or cycles passed without a frame of theirs.
    #[cold]
    fn end_what_was(&mut self, counter: SyncCounter) {
        if self.inbox.is_open() {
            self.close(true);
        }
        let before = self.inbox.counter();
        let cycles = before.map_or(1, |before| counter.cycles_since(before));
        if self.timing.began_us().is_some() && cycles <= SYNC_OVERFLOW / 2 {
            (1..cycles).for_each(|_| self.skip());
        }
    }

    /// A committed set becomes active as a whole, between two cycles.
    pub(crate) fn activate(&mut self) {
        if self.committed.is_some() {
            self.activate_committed();
        }
    }

    #[cold]
    fn activate_committed(&mut self) {
        if let Some(settings) = self.committed.take() {
            self.timing.set_period(settings.period_us);
            self.axis.begin_set(self.active.as_ref(), &settings);
            self.periodic.allow_silence(settings.limits.heartbeat_us);
            self.active = Some(settings);
        }
    }

    pub(crate) fn close_if_complete(&mut self) {
        let wants_setpoint = || {
            let settings = self.active.as_ref();
            settings.is_none_or(|settings| self.axis.expects_setpoint(settings))
        };
        if self.inbox.is_complete(true) || self.inbox.is_complete(false) && !wants_setpoint() {
            self.close(false);
        }
    }

    /// Closes the cycle: steps the axis and answers.
    fn close(&mut self, by_deadline: bool) {
        self.inbox.close();
        self.timing.close();
        let stage = self.step_axis(None);
        let late = by_deadline || !self.in_sync;
        let counts = &mut self.axis.watchdog.counts;
        counts.by_deadline = counts.by_deadline.saturating_add(u32::from(late));
        self.send_torque(stage);
        self.send_periodic();
        if self.pending_nmt.is_some() {
            self.finish_nmt();
        }
    }

    /// A cycle passed whose time and SYNC never came: everything in it counts as missing.
    fn skip(&mut self) {
        self.in_sync = false;
        let _ = self.step_axis(Some(&Contents::NOTHING));
    }

    /// `instead` of what is in the inbox.
    fn step_axis(&mut self, instead: Option<&Contents>) -> StageOutput {
        let circumstances = Circumstances {
            period_fits: self.axis.drive.is_energised() || self.period_fits(),
            listens: self.nmt == NmtState::Operational && self.pending_nmt.is_none(),
            in_sync: self.in_sync,
        };
        let mut notices = Notices::new();
        let Some(settings) = self.active.as_ref() else {
            return StageOutput::default();
        };
        let contents = instead.unwrap_or_else(|| self.inbox.contents());
        let stage = self
            .axis
            .cycle(settings, contents, circumstances, &mut notices);
        self.send_notices(&notices);
        stage
    }

    /// The SYNC period that the master declares and the one that is measured are that of the active
    /// set.
    fn period_fits(&self) -> bool {
        let declared = self.server.declared_period_us();
        let set = self
            .active
            .as_ref()
            .map_or(0, |settings| settings.period_us);
        declared.is_none_or(|declared| declared == set) && !self.timing.period_is_off()
    }
}

/// Events of the past that a frame waits for: a deadline and an own timer for each of the cycles
/// until SYNC counts as gone.
const CATCH_UP_EVENTS: u64 = 2 * SYNC_TIMEOUT_PERIODS;
