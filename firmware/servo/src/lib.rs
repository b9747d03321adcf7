//! The drive node of one axis, sans-I/O: frames, lost-frame tokens and time go in; frames come out.
//!
//! ```text
//! SYNC k ─┐
//! setpoint k ─┼─▶ inbox ─▶ encoders ─▶ watchdogs ─▶ drive state ─▶ controller ─▶ torque k (status, heartbeat, EMCY)
//! feedback k ─┘
//! ```
//!
//! The node acts by counter, never by arrival order: it computes cycle k when setpoint k and feedback k are both in or known
//! to be lost. Time is an argument and used for one thing only, to notice that SYNC itself is gone.
#![cfg_attr(not(test), no_std)]
#![forbid(unsafe_code)]
#![deny(
    clippy::float_arithmetic,
    clippy::indexing_slicing,
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::arithmetic_side_effects,
    clippy::as_conversions
)]
#![cfg_attr(
    test,
    allow(
        clippy::unwrap_used,
        clippy::panic,
        clippy::arithmetic_side_effects,
        clippy::indexing_slicing,
        clippy::as_conversions
    )
)]

pub mod conversion;
pub mod drive;
pub mod encoders;
pub mod inbox;
pub mod objects;
pub mod parameters;
pub mod physical;
pub mod reference_config;
pub mod sdo_server;
pub mod settings;
pub mod stop;
pub mod watchdog;

use controller::units::{Position, PositionError, Torque, Velocity};
use controller::{Input, Output, PositionSource, State};
use heapless::Vec;
use protocol::cob::{AxisIds, FrameKind, NodeId};
use protocol::message::{self, Decoded, EmergencyMessage, Feedback, NmtCommand, NmtState, Setpoint, Status};
use protocol::states::{Command, ControlWord, StatusWord};
use protocol::table::{HEARTBEAT_EVERY_CYCLES, STATUS_EVERY_CYCLES};
use protocol::weight::{FollowingError24, TorqueMicroNm, TorquePerMille};
use protocol::{CanFrame, Fault, Message, SyncCounter, SyncEvent, SyncTracker};

use drive::Drive;
use encoders::{Encoders, Measured};
use inbox::{Inbox, Miss, Taken};
use objects::Parameter;
use parameters::ParameterSet;
use sdo_server::{Diagnostics, Effect, Readings, SdoServer};
use settings::Settings;
use stop::Stop;
use watchdog::Watchdog;

/// Frames that one event can cause: EMCY, torque, status, heartbeat and an SDO response, with room for a second EMCY.
pub type Outbox = Vec<CanFrame, 6>;

/// The drive node of one axis.
#[derive(Clone, Debug)]
pub struct Servo {
    ids: AxisIds,
    nmt: NmtState,
    cycle: u32,
    sync: SyncTracker,
    inbox: Inbox,
    encoders: Encoders,
    drive: Drive,
    control: ControlWord,
    setpoint: Option<Track>,
    law: State,
    active: Option<Settings>,
    committed: Option<Settings>,
    server: SdoServer,
    watchdog: Watchdog,
    last: Last,
    sync_timeout_us: i32,
}

/// The setpoint of the present cycle: from the bus, or carried on from the last good one.
#[derive(Clone, Copy, Debug, Default)]
struct Track {
    position: Position,
    velocity: Velocity,
    good: Position,
    cycles_since_good: u16,
}

impl Track {
    fn begin(position: Position) -> Self {
        Self { position, velocity: Velocity::ZERO, good: position, cycles_since_good: 0 }
    }

    /// A good setpoint came: the velocity is the way since the last good one.
    fn take(self, position: Position) -> Self {
        let velocity = position.velocity_since(self.good, self.cycles_since_good.saturating_add(1));
        Self { position, velocity, good: position, cycles_since_good: 0 }
    }

    /// None came: it goes on as before.
    fn carry_on(self) -> Self {
        let position = self.position.after(self.velocity);
        Self { position, cycles_since_good: self.cycles_since_good.saturating_add(1), ..self }
    }
}

#[derive(Clone, Copy, Debug, Default)]
struct Last {
    torque: Torque,
    following_error: PositionError,
    limited: bool,
    warning: bool,
}

impl Servo {
    /// A node in its reset state; [`Self::boot`] announces it.
    #[must_use]
    pub fn new(ids: AxisIds) -> Self {
        Self {
            ids,
            nmt: NmtState::PreOperational,
            cycle: 0,
            sync: SyncTracker::default(),
            inbox: Inbox::default(),
            encoders: Encoders::default(),
            drive: Drive::default(),
            control: ControlWord::default(),
            setpoint: None,
            law: State::default(),
            active: ParameterSet::default().settings().ok(),
            committed: None,
            server: SdoServer::default(),
            watchdog: Watchdog::default(),
            last: Last::default(),
            sync_timeout_us: DEFAULT_SYNC_TIMEOUT_US,
        }
    }

    /// The same node with another SYNC timeout after reset (object 2131h).
    #[must_use]
    pub fn with_sync_timeout_us(mut self, timeout_us: u32) -> Self {
        self.sync_timeout_us = i32::try_from(timeout_us).unwrap_or(DEFAULT_SYNC_TIMEOUT_US);
        self.server.stage(Parameter::SyncTimeout, self.sync_timeout_us);
        self.active = self.server.activate().ok();
        self
    }

    /// The boot-up message.
    #[must_use]
    pub fn boot(&self) -> Outbox {
        let mut out = Outbox::new();
        self.send(&mut out, BOOT_UP);
        out
    }

    /// The node ids of the axis.
    #[must_use]
    pub const fn ids(&self) -> AxisIds {
        self.ids
    }

    /// State of the drive.
    #[must_use]
    pub const fn drive(&self) -> &Drive {
        &self.drive
    }

    /// Torque that is commanded at present.
    #[must_use]
    pub const fn torque(&self) -> Torque {
        self.last.torque
    }

    /// Setpoints and feedbacks in a row that the present torque had to do without.
    #[must_use]
    pub const fn bridged(&self) -> (u16, u16) {
        self.watchdog.misses()
    }

    /// Frames lost, stale, malformed, implausible and doubled since reset.
    #[must_use]
    pub const fn diagnostics(&self) -> [u32; 5] {
        self.watchdog.diagnostics()
    }

    /// Takes a frame from the bus.
    pub fn on_frame(&mut self, frame: &CanFrame, now_us: u64) -> Outbox {
        let mut out = Outbox::new();
        match message::decode(self.ids, frame) {
            Ok(Decoded::Foreign) => {}
            Ok(Decoded::Message(message)) => self.on_message(message, now_us, &mut out),
            Err(error) => {
                self.watchdog.malformed();
                self.miss(error.kind, Miss::Malformed, &mut out);
            }
        }
        self.compute_if_complete(&mut out);
        out
    }

    /// Takes the token of a frame that the port knows to be lost.
    pub fn on_lost(&mut self, kind: FrameKind) -> Outbox {
        let mut out = Outbox::new();
        self.watchdog.lost();
        self.miss(kind, Miss::Absent, &mut out);
        self.compute_if_complete(&mut out);
        out
    }

    /// Lets time pass; the caller does so at least every millisecond.
    pub fn on_time(&mut self, now_us: u64) -> Outbox {
        let mut out = Outbox::new();
        let Some(timeout) = self.active.as_ref().map(|active| active.limits.sync_timeout_us) else { return out };
        if self.drive.is_energised() && self.watchdog.sync_is_gone(now_us, timeout) {
            self.latch(Fault::SyncMissing, &mut out);
            self.drive_to_zero(&mut out);
        }
        out
    }

    fn on_message(&mut self, message: Message, now_us: u64, out: &mut Outbox) {
        match message {
            Message::Nmt(command, node) => self.on_nmt(command, node, out),
            Message::Sync(counter) => self.on_sync(counter, now_us, out),
            Message::Setpoint(setpoint) => self.on_setpoint(setpoint),
            Message::Feedback(feedback) => self.on_feedback(feedback),
            Message::PlantHeartbeat(_) => self.watchdog.heartbeat(),
            Message::PlantEmergency(emergency) => self.on_plant_emergency(emergency, out),
            Message::SdoRequest(request) => self.on_sdo(request, out),
            // Our own frames, or those of a second servo with our id: nothing to do with them.
            Message::Torque(_)
            | Message::PlantStatus(_)
            | Message::Status(_)
            | Message::ServoHeartbeat(_)
            | Message::ServoEmergency(_)
            | Message::SdoResponse(_) => {}
        }
    }

    fn on_nmt(&mut self, command: NmtCommand, node: Option<NodeId>, out: &mut Outbox) {
        if node.is_some_and(|node| node != self.ids.servo) {
            return;
        }
        match command {
            NmtCommand::StartRemoteNode => self.nmt = NmtState::Operational,
            NmtCommand::StopRemoteNode => self.leave_operational(NmtState::Stopped, out),
            NmtCommand::EnterPreOperational => self.leave_operational(NmtState::PreOperational, out),
            NmtCommand::ResetNode | NmtCommand::ResetCommunication => {
                let timeout_us = self.sync_timeout_us.unsigned_abs();
                *self = Self::new(self.ids).with_sync_timeout_us(timeout_us);
                self.send(out, BOOT_UP);
            }
        }
    }

    fn leave_operational(&mut self, next: NmtState, out: &mut Outbox) {
        // A fault reaction does not listen to commands, so it is ended first.
        self.drive = self.drive.stopped().commanded(Some(Command::DisableVoltage), false, self.stop());
        self.drive_to_zero(out);
        self.nmt = next;
        self.sync = SyncTracker::default();
        self.inbox = Inbox::default();
    }

    fn on_sync(&mut self, counter: SyncCounter, now_us: u64, out: &mut Outbox) {
        if self.nmt != NmtState::Operational {
            return;
        }
        self.watchdog.sync(now_us);
        match self.sync.take(counter) {
            SyncEvent::Begin(counter) => self.begin(counter, out),
            SyncEvent::BeginStale(counter) => {
                self.watchdog.stale();
                self.begin(counter, out);
            }
            SyncEvent::Confirmed => {}
            SyncEvent::Doubled => self.watchdog.doubled(),
            SyncEvent::Late => self.watchdog.stale(),
        }
    }

    fn begin(&mut self, counter: SyncCounter, out: &mut Outbox) {
        if self.inbox.is_open() {
            self.compute(out);
        }
        let cycles = self.inbox.counter().map_or(1, |before| counter.cycles_since(before));
        if cycles <= protocol::counter::SYNC_OVERFLOW / 2 {
            (1..cycles).for_each(|_| self.bridge_cycle(out));
        }
        if let Some(settings) = self.committed.take() {
            self.active = Some(settings);
        }
        self.inbox.begin(counter);
    }

    /// A cycle passed whose SYNC never came: everything in it counts as missing.
    fn bridge_cycle(&mut self, out: &mut Outbox) {
        let Some(settings) = self.active.clone() else { return };
        self.measure(Err(Miss::Absent), &settings, out);
        self.target(Err(Miss::Absent), &settings, out);
    }

    fn on_setpoint(&mut self, setpoint: Setpoint) {
        match self.inbox.setpoint(setpoint) {
            Taken::Used => {}
            Taken::Doubled => self.watchdog.doubled(),
            Taken::Stale => self.watchdog.stale(),
        }
    }

    fn on_feedback(&mut self, feedback: Feedback) {
        match self.inbox.feedback(feedback) {
            Taken::Used => {}
            Taken::Doubled => self.watchdog.doubled(),
            Taken::Stale => self.watchdog.stale(),
        }
    }

    fn on_plant_emergency(&mut self, emergency: EmergencyMessage, out: &mut Outbox) {
        if !emergency.is_error_reset() && self.drive.is_energised() {
            self.latch(Fault::PeerFault, out);
        }
    }

    fn on_sdo(&mut self, request: protocol::sdo::Request, out: &mut Outbox) {
        let readings = self.readings();
        let free = !self.drive.is_energised();
        let (response, effect) = self.server.handle(request, &readings, !free);
        match effect {
            Effect::None => {}
            // At rest at once; in motion with the next cycle, as a whole.
            Effect::Commit(settings) if free => self.active = Some(settings),
            Effect::Commit(settings) => self.committed = Some(settings),
        }
        if let Some(response) = response {
            self.send(out, Message::SdoResponse(response));
        }
    }

    fn readings(&self) -> Readings {
        let (motor, load) =
            self.encoders.position().map_or((Position::default(), Position::default()), |at| (at.motor, at.load));
        let [_, stale, malformed, implausible, doubled] = self.watchdog.diagnostics();
        let source = self.active.as_ref().map_or(PositionSource::Load, |active| active.config.position_source);
        let position = match source {
            PositionSource::Motor => motor,
            PositionSource::Load => load,
        };
        Readings {
            error_register: u8::from(self.drive.fault().is_some()),
            status_word: StatusWord::of(self.drive.state()).0,
            position: position.0.saturating_to_num(),
            following_error: self.last.following_error.0.to_num(),
            motor_position: motor.0.saturating_to_num(),
            load_position: load.0.saturating_to_num(),
            diagnostics: Diagnostics { stale, malformed, implausible, doubled, ..Diagnostics::default() },
            ..Readings::default()
        }
    }

    fn miss(&mut self, kind: FrameKind, miss: Miss, out: &mut Outbox) {
        match kind {
            FrameKind::Sync => {
                if self.nmt == NmtState::Operational
                    && let Some(counter) = self.sync.begin_without_sync()
                {
                    self.begin(counter, out);
                }
            }
            FrameKind::Setpoint => self.inbox.miss_setpoint(miss),
            FrameKind::Feedback => self.inbox.miss_feedback(miss),
            FrameKind::Nmt
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

    fn compute_if_complete(&mut self, out: &mut Outbox) {
        if self.inbox.is_complete() {
            self.compute(out);
        }
    }

    /// One control cycle.
    fn compute(&mut self, out: &mut Outbox) {
        let Some(settings) = self.active.clone() else { return };
        let (setpoint, feedback) = self.inbox.end();
        let stop = self.stop();
        let measured = self.measure(feedback, &settings, out);
        let target = self.target(setpoint, &settings, out);
        self.check_heartbeat(out);
        self.follow_control_word(setpoint, measured.is_some(), stop, out);
        self.last.torque = Torque::ZERO;
        self.last.limited = false;
        match measured.zip(target) {
            Some((measured, target)) if self.drive.is_energised() => self.control(&settings, measured, target, out),
            _ => self.law = State::default(),
        }
        self.send_torque(out);
        self.send_periodic(&settings, out);
        self.cycle = self.cycle.wrapping_add(1);
    }

    fn measure(&mut self, feedback: Result<Feedback, Miss>, settings: &Settings, out: &mut Outbox) -> Option<Measured> {
        let limit = settings.limits.encoder_jump;
        let accepted = feedback.and_then(|feedback| {
            let taken = self.encoders.accept(feedback, settings.way, limit);
            taken.ok_or(Miss::Implausible)
        });
        self.last.warning |= accepted.is_err();
        match self.watchdog.feedback(accepted.err(), settings.limits.feedback_misses) {
            Some(fault) if self.drive.is_energised() => self.latch(fault, out),
            // Without torque nothing is at stake: forget the old position, so that nobody enables on it.
            Some(_) => self.encoders = Encoders::default(),
            None => {}
        }
        accepted.ok().or_else(|| self.encoders.predict())
    }

    fn target(&mut self, setpoint: Result<Setpoint, Miss>, settings: &Settings, out: &mut Outbox) -> Option<Track> {
        self.last.warning |= setpoint.is_err();
        match self.watchdog.setpoint(setpoint.err(), settings.limits.setpoint_misses) {
            Some(fault) if self.drive.is_energised() => self.latch(fault, out),
            _ => {}
        }
        let before = self.setpoint;
        self.setpoint = match setpoint {
            Ok(setpoint) => {
                let position = Position::from_fine_counts(setpoint.position.counts());
                Some(before.map_or_else(|| Track::begin(position), |track| track.take(position)))
            }
            Err(_) => before.map(Track::carry_on),
        };
        self.setpoint
    }

    fn check_heartbeat(&mut self, out: &mut Outbox) {
        if self.watchdog.heartbeat_is_gone(HEARTBEAT_CYCLES) && self.drive.is_energised() {
            self.latch(Fault::HeartbeatLost, out);
        }
    }

    /// `stop` starts where the law stood before this cycle's setpoint, so that a stop begins without a step.
    fn follow_control_word(&mut self, setpoint: Result<Setpoint, Miss>, measured: bool, stop: Stop, out: &mut Outbox) {
        let Ok(Setpoint { control, .. }) = setpoint else { return };
        let reset_edge = (control.0 & !self.control.0) & ControlWord::FAULT_RESET.0 != 0;
        self.control = control;
        let command = control.command().filter(|command| measured || *command != Command::EnableOperation);
        let before = self.drive;
        self.drive = self.drive.commanded(command, reset_edge, stop);
        if before.fault().is_some() && self.drive.fault().is_none() {
            self.watchdog.forgive();
            self.send(out, Message::ServoEmergency(EmergencyMessage::error_reset()));
        }
    }

    fn control(&mut self, settings: &Settings, measured: Measured, target: Track, out: &mut Outbox) {
        let Some(setpoint) = self.reference(settings, target) else {
            self.drive = self.drive.stopped();
            self.law = State::default();
            return;
        };
        let input = Input { setpoint, motor: measured.motor, load: measured.load };
        let Output { torque, following_error, limited } = controller::step(&settings.config, &mut self.law, &input);
        self.last.following_error = following_error;
        self.last.limited = limited;
        self.last.torque = torque;
        if following_error.magnitude() > settings.limits.following_error {
            self.latch(Fault::FollowingError, out);
        }
        if !self.drive.is_energised() {
            self.last.torque = Torque::ZERO;
        }
    }

    /// The setpoint that the loop follows: from the bus, or from the controlled stop; `None` when the stop has ended.
    fn reference(&mut self, settings: &Settings, target: Track) -> Option<Position> {
        let deceleration = settings.reference.quick_stop.deceleration;
        match &mut self.drive {
            Drive::QuickStop(stop) | Drive::FaultReaction(_, stop) => stop.step(deceleration),
            Drive::SwitchOnDisabled
            | Drive::ReadyToSwitchOn
            | Drive::SwitchedOn
            | Drive::OperationEnabled
            | Drive::Faulted(_) => Some(target.position),
        }
    }

    fn stop(&self) -> Stop {
        let track = self.setpoint.unwrap_or_default();
        Stop::from(track.position, track.velocity, STOP_CYCLES)
    }

    fn latch(&mut self, fault: Fault, out: &mut Outbox) {
        let before = self.drive.fault();
        self.drive = self.drive.faulted(fault, self.stop());
        if before.is_none() {
            let detail = [fault.code(), self.inbox.counter().map_or(0, SyncCounter::get), 0, 0, 0];
            let emergency = EmergencyMessage::new(fault.emergency_code(), ERROR_REGISTER, detail);
            self.send(out, Message::ServoEmergency(emergency));
        }
    }

    fn drive_to_zero(&mut self, out: &mut Outbox) {
        self.last.torque = Torque::ZERO;
        self.law = State::default();
        self.send_torque(out);
    }

    fn send_torque(&self, out: &mut Outbox) {
        let Some(counter) = self.inbox.counter() else { return };
        if self.nmt != NmtState::Operational {
            return;
        }
        let torque = TorqueMicroNm(self.last.torque.to_micro_nm_lossy());
        let control = self.drive.plant_control();
        self.send(out, Message::Torque(message::Torque { torque, control, counter }));
    }

    fn send_periodic(&mut self, settings: &Settings, out: &mut Outbox) {
        if is_due(self.cycle, STATUS_EVERY_CYCLES) {
            self.send(out, Message::Status(self.status(settings)));
            self.last.warning = false;
        }
        if is_due(self.cycle, HEARTBEAT_EVERY_CYCLES) {
            self.send(out, Message::ServoHeartbeat(self.nmt));
        }
    }

    fn status(&self, settings: &Settings) -> Status {
        let mut word = StatusWord::of(self.drive.state());
        for (bit, is_set) in [
            (StatusWord::WARNING, self.last.warning),
            (StatusWord::INTERNAL_LIMIT, self.last.limited),
            (StatusWord::FOLLOWS_SETPOINT, matches!(self.drive, Drive::OperationEnabled)),
        ] {
            word = if is_set { word.with(bit) } else { word };
        }
        let per_mille = self.last.torque.to_micro_nm_lossy().checked_div(settings.rated_torque_mnm).unwrap_or(0);
        Status {
            status: word,
            following_error: FollowingError24::saturating(self.last.following_error.0.to_num()),
            torque: TorquePerMille(i16::try_from(per_mille).unwrap_or(if per_mille < 0 { i16::MIN } else { i16::MAX })),
            fault: self.drive.fault(),
        }
    }

    fn send(&self, out: &mut Outbox, message: Message) {
        // The outbox holds more frames than one event can cause (see `Outbox`); a full one drops the newest.
        let _ = out.push(message.encode(self.ids));
    }
}

const BOOT_UP: Message = Message::ServoHeartbeat(NmtState::Initialising);
/// The longest controlled stop, cycles.
const STOP_CYCLES: u16 = 200;
/// Cycles without a plant heartbeat.
const HEARTBEAT_CYCLES: u16 = 250;
const DEFAULT_SYNC_TIMEOUT_US: i32 = 1_000_000;
const ERROR_REGISTER: message::ErrorRegister = message::ErrorRegister(message::ErrorRegister::GENERIC);

/// Whether something that is sent every so many cycles is due; the period is a table constant above zero.
fn is_due(cycle: u32, every: u16) -> bool {
    cycle.checked_rem(u32::from(every)) == Some(0)
}
