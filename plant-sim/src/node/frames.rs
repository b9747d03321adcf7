//! What a frame does to the plant: torque, NMT commands, and what follows from the state of the
//! power stage.

use protocol::cob::NodeId;
use protocol::message::{EmergencyMessage, ErrorRegister, NmtCommand, NmtState, Torque};
use protocol::{Fault, Message, Station, SyncCounter, SyncTracker};

use super::torque::TorqueInput;
use super::{PlantNode, STANDING_S, Send};

impl PlantNode {
    pub(super) fn on_message(&mut self, message: Message, now_us: u64, send: Send<'_>) {
        match message {
            Message::Nmt(command, node) => self.on_nmt(command, node, now_us, send),
            Message::Sync(counter) => self.on_sync(counter, now_us, send),
            Message::Torque(torque) => self.on_torque(torque, now_us, send),
            Message::Feedback(_)
            | Message::Setpoint(_)
            | Message::PlantStatus(_)
            | Message::Status(_)
            | Message::ServoHeartbeat(_)
            | Message::PlantHeartbeat(_)
            | Message::ServoEmergency(_)
            | Message::PlantEmergency(_)
            | Message::SdoRequest(_)
            | Message::SdoResponse(_) => {}
        }
    }

    fn on_torque(&mut self, torque: Torque, now_us: u64, send: Send<'_>) {
        let Some(now) = self.sync.now().filter(|_| self.is_operational()) else {
            return;
        };
        if torque.counter == now.next() {
            self.begin_without_sync(now_us, send);
        }
        if self.sync.now() != Some(torque.counter) || !self.is_operational() {
            return self.torque.refuse();
        }
        self.notice_dropout(send);
        let fault = self.stage.fault();
        self.stage.obey(torque.control);
        self.torque.take(
            f64::from(torque.torque.0) * self.newton_per_micro_nm,
            self.stage.is_enabled(),
        );
        if fault.is_some() && self.stage.fault().is_none() {
            send(Message::PlantEmergency(EmergencyMessage::error_reset()).encode(self.ids));
        }
        self.settle(now_us, send);
    }

    /// What follows from the state of the power stage: brake, status, an NMT command that waited
    /// for it.
    pub(super) fn settle(&mut self, now_us: u64, send: Send<'_>) {
        self.axis.command_brake(self.stage.releases_brake());
        self.report(send);
        if !self.stage.is_enabled()
            && let Some(command) = self.deferred.take()
        {
            self.obey_nmt(command, now_us, send);
        }
    }

    pub(super) fn notice_dropout(&mut self, send: Send<'_>) {
        if self.stage.dropped_out() {
            self.latch(Fault::StageLost, send);
        }
    }

    pub(super) fn latch(&mut self, fault: Fault, send: Send<'_>) {
        self.stage.fail(fault);
        self.torque.zero();
        self.axis.command_brake(false);
        let detail = [
            fault.code(),
            self.sync.now().map_or(0, SyncCounter::get),
            0,
            0,
            0,
        ];
        let emergency = EmergencyMessage::new(
            fault.emergency_code(),
            ErrorRegister(ErrorRegister::GENERIC),
            detail,
        );
        send(Message::PlantEmergency(emergency).encode(self.ids));
    }

    fn on_nmt(&mut self, command: NmtCommand, node: Option<NodeId>, now_us: u64, send: Send<'_>) {
        if node.is_some_and(|node| node != self.ids.plant) {
            return;
        }
        self.deferred = None;
        if self.stage.is_enabled() && command != NmtCommand::StartRemoteNode {
            self.deferred = Some(command);
            return;
        }
        if matches!(
            command,
            NmtCommand::ResetNode | NmtCommand::ResetCommunication
        ) && !self.moves()
        {
            self.axis.start_over();
            self.slow_s = STANDING_S;
        }
        self.obey_nmt(command, now_us, send);
    }

    fn obey_nmt(&mut self, command: NmtCommand, now_us: u64, send: Send<'_>) {
        match command {
            NmtCommand::StartRemoteNode => self.start(send),
            NmtCommand::StopRemoteNode => self.leave_operational(NmtState::Stopped),
            NmtCommand::EnterPreOperational => self.leave_operational(NmtState::PreOperational),
            NmtCommand::ResetNode | NmtCommand::ResetCommunication => self.reset(now_us, send),
        }
    }

    fn start(&mut self, send: Send<'_>) {
        if !self.is_operational() {
            self.nmt = NmtState::Operational;
            self.sync = SyncTracker::default();
            self.torque.forget();
            self.cycle = 0;
            self.reported = None;
        }
        self.report(send);
    }

    fn leave_operational(&mut self, next: NmtState) {
        self.nmt = next;
        self.stage.switch_off();
        self.torque.zero();
        self.axis.command_brake(false);
    }

    /// The node starts again; the machine is where it is.
    fn reset(&mut self, now_us: u64, send: Send<'_>) {
        self.leave_operational(NmtState::PreOperational);
        self.stage.reset();
        self.sync = SyncTracker::default();
        self.torque = TorqueInput::default();
        if !self.moves() {
            self.time.stop();
        }
        self.boot(send);
        self.time.beat_now(now_us);
        self.time.beaten(now_us);
    }
}
