//! Frames in: decode once, then only typed values.

use protocol::cob::{FrameKind, NodeId};
use protocol::leaf::Durations;
use protocol::message::{
    self, DecodeError, EmergencyMessage, Feedback, NmtCommand, NmtState, PlantStatus, Setpoint,
};
use protocol::sdo::{Request, Response};
use protocol::{CanFrame, Fault, Message, SyncCounter, SyncEvent};

use crate::Servo;
use crate::axis::Notices;
use crate::commit::Commit;
use crate::inbox::Taken;
use crate::sdo_server::Effect;
use crate::stage::StageInput;

impl Servo {
    /// The boot-up message.
    #[must_use = "the frames have to go on the bus"]
    pub fn boot(&mut self) -> &[CanFrame] {
        self.outbox.clear();
        self.send(BOOT_UP);
        &self.outbox
    }

    /// Takes a frame from the bus. What was due before it happens first. A commit is converted at
    /// once, which takes longer than a control cycle may on a board: [`Self::hear`].
    #[must_use = "the frames have to go on the bus"]
    pub fn on_frame(&mut self, frame: &CanFrame, now_us: u64) -> &[CanFrame] {
        self.outbox.clear();
        self.take_frame(frame, now_us);
        if self.commits.is_wanted() {
            self.commit_at_once();
        }
        &self.outbox
    }

    /// The same where somebody else converts: a commit is handed out with [`Self::begin_commit`]
    /// and answered with [`Self::end_commit`].
    #[must_use = "the frames have to go on the bus"]
    pub fn hear(&mut self, frame: &CanFrame, now_us: u64) -> &[CanFrame] {
        self.outbox.clear();
        self.take_frame(frame, now_us);
        &self.outbox
    }

    /// Hands out a set that is to be converted, once; tells whether there is one.
    #[must_use = "it has to be converted"]
    pub fn begin_commit(&mut self, commit: &mut Commit) -> bool {
        self.commits.hand_out(self.server.staged(), commit)
    }

    /// A set was converted. Nothing comes of it where the node was reset meanwhile.
    #[must_use = "the frames have to go on the bus"]
    pub fn end_commit(&mut self, commit: &Commit) -> &[CanFrame] {
        self.outbox.clear();
        self.take_over(commit);
        &self.outbox
    }

    #[cold]
    fn commit_at_once(&mut self) {
        let mut commit = Commit::default();
        if self.begin_commit(&mut commit) {
            commit.convert();
            self.take_over(&commit);
        }
    }

    #[cold]
    fn take_over(&mut self, commit: &Commit) {
        let Some(settings) = commit.settings() else {
            return;
        };
        if !self.commits.take_back(commit) {
            return;
        }
        let has_torque = self.axis.drive.is_energised();
        let fit = settings.as_ref().map(|_| ()).map_err(|error| *error);
        let response = self.server.end_commit(fit, has_torque);
        if let (Ok(settings), Response::Downloaded(_)) = (settings, response) {
            // At rest at once; in motion with the next cycle, as a whole.
            self.committed = Some(settings.clone());
            if !has_torque {
                self.activate();
                self.close_if_complete();
            }
        }
        self.send(Message::SdoResponse(response));
    }

    fn take_frame(&mut self, frame: &CanFrame, now_us: u64) {
        if !self.timing.is_quiet(now_us) {
            self.start_clock(now_us);
            self.catch_up(now_us);
        }
        if let Some(kind) = message::kind_of(self.ids, frame)
            && let Err(error) = self.on_known(kind, frame, now_us)
        {
            self.on_malformed(error.kind);
        }
        self.close_if_complete();
    }

    /// What comes in every cycle is taken as it is, and not as one of thirteen messages.
    fn on_known(
        &mut self,
        kind: FrameKind,
        frame: &CanFrame,
        now_us: u64,
    ) -> Result<(), DecodeError> {
        match kind {
            FrameKind::Sync => self.on_sync(SyncCounter::decode(frame)?, now_us),
            FrameKind::Setpoint => self.on_setpoint(Setpoint::decode(frame)?, now_us),
            FrameKind::Feedback => self.on_feedback(Feedback::decode(frame)?, now_us),
            FrameKind::Nmt
            | FrameKind::Torque
            | FrameKind::PlantStatus
            | FrameKind::Status
            | FrameKind::ServoHeartbeat
            | FrameKind::PlantHeartbeat
            | FrameKind::ServoEmergency
            | FrameKind::PlantEmergency
            | FrameKind::SdoRequest
            | FrameKind::SdoResponse => {
                self.on_message(message::decode_as(kind, frame)?, now_us);
            }
        }
        Ok(())
    }

    #[inline(never)]
    fn on_message(&mut self, message: Message, now_us: u64) {
        match message {
            Message::Nmt(command, node) => self.on_nmt(command, node),
            Message::PlantStatus(status) => self.on_plant_status(status),
            Message::PlantHeartbeat(state) => self.on_plant_heartbeat(state, now_us),
            Message::PlantEmergency(emergency) => self.on_plant_emergency(emergency),
            Message::SdoRequest(request) => self.on_sdo(request),
            // Taken before; our own frames, or those of a second servo with our id: nothing to do
            // with them.
            Message::Sync(_)
            | Message::Setpoint(_)
            | Message::Feedback(_)
            | Message::Torque(_)
            | Message::Status(_)
            | Message::ServoHeartbeat(_)
            | Message::ServoEmergency(_)
            | Message::SdoResponse(_) => {}
        }
    }

    fn on_malformed(&mut self, kind: FrameKind) {
        let counts = &mut self.axis.watchdog.counts;
        counts.malformed = counts.malformed.saturating_add(1);
        match kind {
            FrameKind::Setpoint => self.inbox.malformed_setpoint(),
            FrameKind::Feedback => self.inbox.malformed_feedback(),
            FrameKind::Nmt
            | FrameKind::Sync
            | FrameKind::Torque
            | FrameKind::PlantStatus
            | FrameKind::Status
            | FrameKind::ServoHeartbeat
            | FrameKind::PlantHeartbeat
            | FrameKind::ServoEmergency
            | FrameKind::PlantEmergency
            | FrameKind::SdoRequest
            | FrameKind::SdoResponse => {}
        }
    }

    fn on_sync(&mut self, counter: SyncCounter, now_us: u64) {
        if self.nmt != NmtState::Operational {
            return;
        }
        match self.sync.take(counter) {
            SyncEvent::Begin(counter) => self.begin_by_sync(counter, now_us),
            SyncEvent::BeginStale(counter) => {
                self.axis.watchdog.taken(Taken::Stale);
                self.begin_by_sync(counter, now_us);
            }
            SyncEvent::Confirmed => self.timing.confirm(now_us, counter),
            SyncEvent::Doubled => self.axis.watchdog.taken(Taken::Doubled),
            SyncEvent::Late => self.axis.watchdog.taken(Taken::Stale),
        }
    }

    fn on_setpoint(&mut self, setpoint: Setpoint, now_us: u64) {
        let mut taken = self.inbox.setpoint(setpoint);
        if taken == Taken::NextCycle {
            self.begin_without_sync(now_us);
            taken = self.inbox.setpoint(setpoint);
        }
        self.axis.watchdog.taken(taken);
    }

    fn on_feedback(&mut self, feedback: Feedback, now_us: u64) {
        let mut taken = self.inbox.feedback(feedback);
        if taken == Taken::NextCycle {
            self.begin_without_sync(now_us);
            taken = self.inbox.feedback(feedback);
        }
        self.axis.watchdog.taken(taken);
    }

    fn on_plant_status(&mut self, status: PlantStatus) {
        let mut notices = Notices::new();
        if let Some(settings) = self.active.as_ref() {
            self.axis
                .hear_stage(StageInput::from(status), settings, &mut notices);
        }
        self.send_notices(&notices);
    }

    fn on_plant_heartbeat(&mut self, state: NmtState, now_us: u64) {
        self.periodic.hear_plant(now_us, self.silence_us());
        if state == NmtState::Initialising {
            // A plant that starts anew delivers nothing until it says so.
            self.axis.stage = StageInput::default();
        }
    }

    fn on_plant_emergency(&mut self, emergency: EmergencyMessage) {
        if !emergency.is_error_reset() && self.axis.drive.is_energised() {
            let [code, ..] = emergency.vendor_specific;
            // A drop-out is said by EMCY before the status: the fault has the name of what
            // happened.
            let dropped_out = Fault::from_code(code) == Some(Fault::StageLost);
            self.latch(if dropped_out {
                Fault::StageLost
            } else {
                Fault::PeerFault
            });
        }
    }

    fn on_sdo(&mut self, request: Request) {
        let readings = self.readings();
        let has_torque = self.axis.drive.is_energised();
        let (response, effect) = self.server.handle(request, &readings, has_torque);
        match effect {
            Effect::None => {}
            Effect::Clear(timed) => *self.times.of_mut(timed) = Durations::default(),
            Effect::Convert => self.commits.ask(),
        }
        if let Some(response) = response {
            self.send(Message::SdoResponse(response));
        }
    }

    fn on_nmt(&mut self, command: NmtCommand, node: Option<NodeId>) {
        if node.is_some_and(|node| node != self.ids.servo) {
            return;
        }
        if command == NmtCommand::StartRemoteNode {
            self.pending_nmt = None;
            self.nmt = NmtState::Operational;
            return;
        }
        self.pending_nmt = Some(command);
        self.axis.drive = self.axis.drive.released();
        self.finish_nmt();
    }

    /// Leaves NMT operational, once there is no torque any more.
    pub(crate) fn finish_nmt(&mut self) {
        if self.axis.drive.is_energised() {
            return;
        }
        match self.pending_nmt.take() {
            None | Some(NmtCommand::StartRemoteNode) => {}
            Some(NmtCommand::StopRemoteNode) => self.leave_operational(NmtState::Stopped),
            Some(NmtCommand::EnterPreOperational) => {
                self.leave_operational(NmtState::PreOperational);
            }
            Some(NmtCommand::ResetNode | NmtCommand::ResetCommunication) => {
                self.reset();
                self.send(BOOT_UP);
            }
        }
    }

    fn leave_operational(&mut self, next: NmtState) {
        self.nmt = next;
        self.leave_the_cycle();
    }
}

const BOOT_UP: Message = Message::ServoHeartbeat(NmtState::Initialising);
