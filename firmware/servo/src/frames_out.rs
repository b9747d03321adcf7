//! Frames out: torque in every cycle, status on change and every tenth cycle, heartbeats by time in
//! every NMT state, EMCY for faults and refusals.

use controller::PositionSource;
use protocol::message::{self, EmergencyMessage, Status};
use protocol::states::StatusWord;
use protocol::table::{HEARTBEAT_EVERY_CYCLES, STATUS_EVERY_CYCLES};
use protocol::weight::{FollowingError24, TorqueMicroNm, TorquePerMille};
use protocol::{CanFrame, Fault, Message, SyncCounter};

use crate::axis::{Notice, Notices};
use crate::drive::Drive;
use crate::sdo_server::Readings;
use crate::stage::StageOutput;
use crate::{Servo, emergency};

/// What is sent, or expected, from time to time.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Periodic {
    /// Cycles until the next status.
    status_in: u16,
    said: Option<(StatusWord, Option<Fault>)>,
    heartbeat_due_us: Option<u64>,
    plant_heard_us: Option<u64>,
    /// When it counts as silent, unless it is heard before.
    plant_silent_us: u64,
}

impl Periodic {
    /// The first cycle carries a heartbeat, so that a run looks the same wherever it is made.
    pub(crate) const fn beat_now(&mut self, now_us: u64, allowed_us: u64) {
        self.heartbeat_due_us = Some(now_us);
        self.hear_plant(now_us, allowed_us);
    }

    pub(crate) const fn heartbeat_due_us(&self) -> Option<u64> {
        self.heartbeat_due_us
    }

    pub(crate) const fn hear_plant(&mut self, now_us: u64, allowed_us: u64) {
        self.plant_heard_us = Some(now_us);
        self.allow_silence(allowed_us);
    }

    /// The plant may be silent for so long.
    pub(crate) const fn allow_silence(&mut self, allowed_us: u64) {
        self.plant_silent_us = match self.plant_heard_us {
            Some(heard_us) => heard_us.saturating_add(allowed_us),
            None => u64::MAX,
        };
    }

    fn status_is_due(&mut self, now: (StatusWord, Option<Fault>)) -> bool {
        // A warning is no change: it would be said every cycle on a bad bus. It goes with the next
        // status.
        let without_warning = (StatusWord(now.0.0 & !StatusWord::WARNING), now.1);
        let due = self.status_in == 0 || self.said != Some(without_warning);
        self.status_in = if due {
            STATUS_EVERY_CYCLES.saturating_sub(1)
        } else {
            self.status_in.saturating_sub(1)
        };
        self.said = Some(without_warning);
        due
    }
}

impl Servo {
    pub(crate) fn send(&mut self, message: Message) {
        self.put(message.encode(self.ids));
    }

    fn put(&mut self, frame: CanFrame) {
        // The outbox holds more frames than one event can cause (see `Outbox`); a full one drops
        // the newest.
        let _ = self.outbox.push(frame);
    }

    pub(crate) fn send_torque(&mut self, stage: StageOutput) {
        let Some(counter) = self.inbox.counter() else {
            return;
        };
        let torque = TorqueMicroNm(stage.micro_nm);
        let torque = message::Torque {
            torque,
            control: stage.control,
            counter,
        };
        self.put(torque.encode(self.ids));
    }

    pub(crate) fn send_periodic(&mut self) {
        let (word, fault) = (self.status_word(), self.axis.drive.fault());
        if self.periodic.status_is_due((word, fault)) {
            let status = self.status(word, fault);
            self.put(status.encode(self.ids));
            self.axis.last.warning = false;
        }
        if let Some(now_us) = self.timing.began_us() {
            self.beat(now_us);
            self.watch_plant(now_us);
        }
    }

    /// Sends the heartbeat when it is due.
    pub(crate) fn beat(&mut self, now_us: u64) {
        if self
            .periodic
            .heartbeat_due_us
            .is_some_and(|due| due <= now_us)
        {
            self.periodic.heartbeat_due_us =
                Some(now_us.saturating_add(self.heartbeat_period_us()));
            self.send(Message::ServoHeartbeat(self.nmt));
        }
    }

    /// Starts the clock of the heartbeats, if this is the first event after reset.
    pub(crate) fn start_clock(&mut self, now_us: u64) {
        if self.periodic.heartbeat_due_us.is_none() {
            self.start_heartbeats(now_us);
        }
    }

    #[cold]
    fn start_heartbeats(&mut self, now_us: u64) {
        let first_us = now_us.saturating_add(self.heartbeat_period_us());
        self.periodic.heartbeat_due_us = Some(first_us);
    }

    fn heartbeat_period_us(&self) -> u64 {
        self.timing.periods_us(HEARTBEAT_EVERY_CYCLES)
    }

    /// How long the plant may be silent.
    pub(crate) fn silence_us(&self) -> u64 {
        self.active
            .as_ref()
            .map_or(0, |settings| settings.limits.heartbeat_us)
    }

    fn watch_plant(&mut self, now_us: u64) {
        if now_us > self.periodic.plant_silent_us && self.axis.drive.is_energised() {
            self.latch(Fault::HeartbeatLost);
        }
    }

    pub(crate) fn latch(&mut self, fault: Fault) {
        let mut notices = Notices::new();
        if let Some(settings) = self.active.as_ref() {
            self.axis.latch(fault, settings, &mut notices);
        }
        self.send_notices(&notices);
    }

    pub(crate) fn send_notices(&mut self, notices: &Notices) {
        if !notices.is_empty() {
            self.send_all(notices);
        }
    }

    #[cold]
    fn send_all(&mut self, notices: &Notices) {
        let counter = self.inbox.counter().map_or(0, SyncCounter::get);
        for notice in notices {
            let message = match notice {
                Notice::Latched(fault) | Notice::Refused(fault) => {
                    self.emergency = (fault.emergency_code(), counter);
                    emergency(*fault, counter)
                }
                Notice::Reset => EmergencyMessage::error_reset(),
            };
            self.send(Message::ServoEmergency(message));
        }
    }

    fn status(&self, word: StatusWord, fault: Option<Fault>) -> Status {
        let last = &self.axis.last;
        let rated_mnm = self
            .active
            .as_ref()
            .map_or(1, |settings| settings.rated_torque_mnm);
        let per_mille = last.micro_nm.checked_div(rated_mnm).unwrap_or(0);
        Status {
            status: word,
            following_error: FollowingError24::saturating(last.following_error.0.to_num()),
            torque: TorquePerMille(i16::try_from(per_mille).unwrap_or(if per_mille < 0 {
                i16::MIN
            } else {
                i16::MAX
            })),
            fault,
        }
    }

    fn status_word(&self) -> StatusWord {
        let drive = &self.axis.drive;
        let follows = matches!(drive, Drive::OperationEnabled) && !self.axis.is_halted();
        let stops = !follows && drive.is_energised();
        let bits = [
            (StatusWord::VOLTAGE_ENABLED, self.axis.stage.is_ready()),
            (StatusWord::WARNING, self.axis.last.warning),
            (StatusWord::REMOTE, self.pending_nmt.is_none()),
            (StatusWord::TARGET_REACHED, stops && self.axis.is_standing()),
            (StatusWord::INTERNAL_LIMIT, self.axis.last.limited),
            (StatusWord::FOLLOWS_SETPOINT, follows),
        ];
        // Without a branch for each.
        let word = StatusWord::of(drive.state());
        bits.into_iter().fold(word, |word, (bit, is_set)| {
            word.with(bit.wrapping_mul(u16::from(is_set)))
        })
    }

    pub(crate) fn readings(&self) -> Readings {
        let at = self.axis.encoders.position().unwrap_or_default();
        let source = self
            .active
            .as_ref()
            .map_or(PositionSource::Load, |settings| {
                settings.config.position_source
            });
        let (emergency_code, cycle) = self.emergency;
        Readings {
            error_register: u8::from(self.axis.drive.fault().is_some()),
            emergency_code,
            fault_detail: u32::from(cycle),
            status_word: self.status_word().0,
            position: at.of(source).0.saturating_to_num(),
            motor_position: at.motor.0.saturating_to_num(),
            load_position: at.load.0.saturating_to_num(),
            following_error: self.axis.last.following_error.0.to_num(),
            refined_level: self.axis.refined_level_millionths(),
            counts: self.counts(),
            leaf: self.leaf,
            times: self.times,
        }
    }
}
