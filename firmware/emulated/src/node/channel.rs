//! The node behind its serial line: lines in, lines out.
//!
//! Opening the channel resets the node, as connecting a drive to its supply does. Time is bus time
//! in lock-step ([`LockstepTime`]): SYNC moves it on, and where nothing is heard for a while, what
//! is due next. A bench that says the time itself ([`rig`]) takes that over.

use heapless::Vec;
use protocol::cob::AxisIds;
use protocol::{CanFrame, LockstepTime, Station};
use servo::Servo;

use crate::rig;
use crate::slcan::{self, BEL, CR};

/// Intervals of [`Channel::interval_passed`] in a deadline.
const INTERVALS: u16 = 1000;

/// The node, its time and the line that is coming in.
pub(crate) struct Channel {
    ids: AxisIds,
    servo: Servo,
    time: LockstepTime,
    is_open: bool,
    /// The time that the bench says.
    told_us: Option<u64>,
    line: Vec<u8, { slcan::LONGEST }>,
    is_too_long: bool,
    silent: u16,
}

/// Why a line is not taken.
struct Refused;

impl Channel {
    pub(crate) fn new(ids: AxisIds) -> Self {
        Self {
            ids,
            servo: Servo::new(ids),
            time: LockstepTime::default(),
            is_open: false,
            told_us: None,
            line: Vec::new(),
            is_too_long: false,
            silent: 0,
        }
    }

    /// A byte came.
    pub(crate) fn hear(&mut self, byte: u8, say: &mut dyn FnMut(&[u8])) {
        self.silent = 0;
        if byte != CR {
            self.is_too_long |= self.line.push(byte).is_err();
            return;
        }
        let line = core::mem::take(&mut self.line);
        let taken = if core::mem::take(&mut self.is_too_long) {
            Err(Refused)
        } else {
            self.take(&line, say)
        };
        if taken.is_err() {
            say(&[BEL]);
        }
    }

    /// An interval has passed. A deadline of them without a byte is all the patience there is for a
    /// frame of the cycle, two for SYNC. Meanwhile there is an empty line, which says nothing: a
    /// user-mode kernel misses some signals of its serial line, and what came last lies there until
    /// something else comes.
    pub(crate) fn interval_passed(&mut self, say: &mut dyn FnMut(&[u8])) {
        if !self.is_open || self.told_us.is_some() {
            return;
        }
        say(&[CR]);
        self.silent = self.silent.saturating_add(1);
        let deadlines = LockstepTime::deadlines_to_wait(&self.servo);
        if self.silent >= INTERVALS.saturating_mul(deadlines.into()) {
            self.silent = 0;
            self.time.wake(&mut self.servo, &mut |frame| {
                say(&slcan::line_of(&frame));
            });
        }
    }

    fn take(&mut self, line: &[u8], say: &mut dyn FnMut(&[u8])) -> Result<(), Refused> {
        match line.split_first() {
            // An empty line is how a host clears what may lie in an adapter.
            None => say(&[CR]),
            Some((b'S' | b'C', _)) => {
                self.is_open = false;
                say(&[CR]);
            }
            Some((b'O', [])) => {
                self.open(say);
                say(&[CR]);
            }
            Some((&rig::AT, digits)) => self.told_us = Some(slcan::hex(digits).ok_or(Refused)?),
            Some((&rig::PASSES, [])) => {
                let now_us = self.told_us.ok_or(Refused)?;
                self.servo
                    .time(now_us, &mut |frame| say(&slcan::line_of(&frame)));
                self.ready(say);
            }
            Some(_) => {
                let frame = slcan::frame_of(line)
                    .filter(|_| self.is_open)
                    .ok_or(Refused)?;
                self.deliver(&frame, say);
                self.ready(say);
            }
        }
        Ok(())
    }

    fn open(&mut self, say: &mut dyn FnMut(&[u8])) {
        *self = Self {
            is_open: true,
            told_us: self.told_us,
            ..Self::new(self.ids)
        };
        Station::boot(&mut self.servo, &mut |frame| say(&slcan::line_of(&frame)));
    }

    fn deliver(&mut self, frame: &CanFrame, say: &mut dyn FnMut(&[u8])) {
        let mut send = |frame: CanFrame| say(&slcan::line_of(&frame));
        match self.told_us {
            Some(now_us) => self.servo.take(frame, now_us, &mut send),
            None => self.time.deliver(&mut self.servo, frame, &mut send),
        }
    }

    /// What was heard is done.
    fn ready(&self, say: &mut dyn FnMut(&[u8])) {
        if self.told_us.is_some() {
            let times = [self.servo.wake_at_us(), self.servo.sync_due_us()];
            say(&rig::line_of(times));
        }
        say(b"z\r");
    }
}
