//! The plant as a CAN node, sans-I/O: a CiA 402 torque drive with encoders.
//!
//! SYNC k: integrate up to now with the torque that is due, read the encoders, send feedback k. Torque k comes in during the cycle and becomes
//! active with SYNC k + 1, as a synchronous RPDO does; that is the one cycle of transport delay of the loop. The integration waits for SYNC, so
//! lock-step holds the plant still as long as anybody is late.
//!
//! When torque commands stay away for [`TORQUE_MISSES_ALLOWED`] cycles in a row the plant drops its own torque to zero, reports
//! `TorqueMissing` and stays there until the servo disables and enables it again.

use protocol::cob::{AxisIds, FrameKind, NodeId};
use protocol::counter::SYNC_OVERFLOW;
use protocol::message::{self, Decoded, EmergencyMessage, ErrorRegister, Feedback, NmtCommand, NmtState, Torque};
use protocol::states::{Command, ControlWord};
use protocol::table::HEARTBEAT_EVERY_CYCLES;
use protocol::weight::{LoadIncrements24, MotorIncrements};
use protocol::{CanFrame, Fault, Message, SyncCounter, SyncEvent, SyncTracker};

use crate::axis::{Axis, AxisParameters};

/// Cycles without a torque command of their own that the plant bridges with the last one.
pub const TORQUE_MISSES_ALLOWED: u16 = 3;
/// Wall-clock SYNC timeout of the plant unless [`PlantNode::with_sync_timeout_us`] says otherwise, µs.
pub const SYNC_TIMEOUT_US: u64 = 1_000_000;

/// Motion of one cycle as it truly was, for instruments that look at the machine from outside (a ballbar).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Truth {
    /// Position of the table, m.
    pub table_m: f64,
    /// Position of the motor at the table, m.
    pub motor_m: f64,
    /// Velocity of the motor, m/s.
    pub motor_m_per_s: f64,
    /// Force that the motor delivers, N.
    pub force_n: f64,
}

/// The plant node of one axis.
#[derive(Debug)]
pub struct PlantNode {
    ids: AxisIds,
    axis: Axis,
    seed: u64,
    period_s: f64,
    newton_per_micro_nm: f64,
    nmt: NmtState,
    cycle: u32,
    sync: SyncTracker,
    counter: Option<SyncCounter>,
    due: f64,
    staged: Option<f64>,
    armed: bool,
    enabled: bool,
    misses: u16,
    fault: Option<Fault>,
    last_sync_us: Option<u64>,
    sync_timeout_us: u64,
}

impl PlantNode {
    /// A plant at rest; [`Self::boot`] announces it.
    #[must_use]
    pub fn new(ids: AxisIds, parameters: AxisParameters, period_s: f64, seed: u64) -> Self {
        let newton_per_micro_nm = parameters.newton_per_micro_nm();
        Self {
            ids,
            axis: Axis::new(parameters, seed),
            seed,
            period_s,
            newton_per_micro_nm,
            nmt: NmtState::PreOperational,
            cycle: 0,
            sync: SyncTracker::default(),
            counter: None,
            due: 0.0,
            staged: None,
            armed: false,
            enabled: false,
            misses: 0,
            fault: None,
            last_sync_us: None,
            sync_timeout_us: SYNC_TIMEOUT_US,
        }
    }

    /// The same plant with another SYNC timeout.
    #[must_use]
    pub fn with_sync_timeout_us(mut self, timeout_us: u64) -> Self {
        self.sync_timeout_us = timeout_us;
        self
    }

    /// The boot-up message.
    #[must_use]
    pub fn boot(&self) -> Vec<CanFrame> {
        vec![Message::PlantHeartbeat(NmtState::Initialising).encode(self.ids)]
    }

    /// Node ids of the axis.
    #[must_use]
    pub const fn ids(&self) -> AxisIds {
        self.ids
    }

    /// What the axis truly does.
    #[must_use]
    pub fn truth(&self) -> Truth {
        let motion = self.axis.motion();
        Truth {
            table_m: motion.table_m,
            motor_m: motion.motor_m,
            motor_m_per_s: motion.motor_m_per_s,
            force_n: self.axis.force_n(),
        }
    }

    /// Latched fault of the plant.
    #[must_use]
    pub const fn fault(&self) -> Option<Fault> {
        self.fault
    }

    /// Torque commands in a row that the present force had to do without.
    #[must_use]
    pub const fn bridged(&self) -> u16 {
        self.misses
    }

    /// Force command that is active at present, N.
    #[must_use]
    pub const fn commanded_n(&self) -> f64 {
        self.due
    }

    /// Takes a frame from the bus.
    pub fn on_frame(&mut self, frame: &CanFrame, now_us: u64) -> Vec<CanFrame> {
        match message::decode(self.ids, frame) {
            Ok(Decoded::Message(message)) => self.on_message(message, now_us),
            Ok(Decoded::Foreign) => Vec::new(),
            // A torque frame that cannot be decoded is one that did not come.
            Err(error) => self.on_lost(error.kind),
        }
    }

    /// Takes the token of a frame that the port knows to be lost.
    pub fn on_lost(&mut self, kind: FrameKind) -> Vec<CanFrame> {
        if kind != FrameKind::Sync || self.nmt != NmtState::Operational {
            return Vec::new();
        }
        self.sync.begin_without_sync().map_or_else(Vec::new, |counter| self.on_sync(counter))
    }

    /// Lets time pass: notices that SYNC is gone.
    pub fn on_time(&mut self, now_us: u64) -> Vec<CanFrame> {
        let gone = self.last_sync_us.is_some_and(|last| now_us.saturating_sub(last) > self.sync_timeout_us);
        if gone && self.enabled { self.latch(Fault::SyncMissing) } else { Vec::new() }
    }

    /// When [`Self::on_time`] would notice that SYNC is gone.
    #[must_use]
    pub fn sync_gone_at_us(&self) -> Option<u64> {
        let last = self.last_sync_us.filter(|_| self.enabled)?;
        Some(last.saturating_add(self.sync_timeout_us).saturating_add(1))
    }

    fn on_message(&mut self, message: Message, now_us: u64) -> Vec<CanFrame> {
        match message {
            Message::Nmt(command, node) => self.on_nmt(command, node),
            Message::Sync(counter) => self.on_sync_frame(counter, now_us),
            Message::Torque(torque) => self.on_torque(torque),
            Message::Feedback(_)
            | Message::Setpoint(_)
            | Message::PlantStatus(_)
            | Message::Status(_)
            | Message::ServoHeartbeat(_)
            | Message::PlantHeartbeat(_)
            | Message::ServoEmergency(_)
            | Message::PlantEmergency(_)
            | Message::SdoRequest(_)
            | Message::SdoResponse(_) => Vec::new(),
        }
    }

    fn on_nmt(&mut self, command: NmtCommand, node: Option<NodeId>) -> Vec<CanFrame> {
        if node.is_some_and(|node| node != self.ids.plant) {
            return Vec::new();
        }
        match command {
            NmtCommand::StartRemoteNode => self.nmt = NmtState::Operational,
            NmtCommand::StopRemoteNode => self.disable(NmtState::Stopped),
            NmtCommand::EnterPreOperational => self.disable(NmtState::PreOperational),
            NmtCommand::ResetNode | NmtCommand::ResetCommunication => {
                let timeout_us = self.sync_timeout_us;
                *self = Self::new(self.ids, self.axis.parameters().clone(), self.period_s, self.seed)
                    .with_sync_timeout_us(timeout_us);
                return self.boot();
            }
        }
        Vec::new()
    }

    fn disable(&mut self, next: NmtState) {
        self.nmt = next;
        self.sync = SyncTracker::default();
        self.counter = None;
        self.armed = false;
        self.enabled = false;
        self.due = 0.0;
        self.staged = None;
    }

    fn on_sync_frame(&mut self, counter: SyncCounter, now_us: u64) -> Vec<CanFrame> {
        if self.nmt != NmtState::Operational {
            return Vec::new();
        }
        self.last_sync_us = Some(now_us);
        match self.sync.take(counter) {
            SyncEvent::Begin(counter) | SyncEvent::BeginStale(counter) => self.on_sync(counter),
            SyncEvent::Confirmed | SyncEvent::Doubled | SyncEvent::Late => Vec::new(),
        }
    }

    fn on_sync(&mut self, counter: SyncCounter) -> Vec<CanFrame> {
        let mut out = Vec::new();
        // A counter that goes back (a restarted SYNC producer) is one cycle, not 240 minus a few.
        let cycles = match self.counter.map(|before| counter.cycles_since(before)) {
            None => 0,
            Some(ahead) if ahead > SYNC_OVERFLOW / 2 => 1,
            Some(ahead) => ahead,
        };
        for _ in 0..cycles {
            self.axis.advance(self.due, self.period_s);
            out.extend(self.take_due());
        }
        self.counter = Some(counter);
        let reading = self.axis.read();
        let feedback = Feedback {
            motor: MotorIncrements(saturated(reading.motor_increments)),
            load: LoadIncrements24::from_counts(reading.load_10_nm),
            counter,
        };
        out.push(Message::Feedback(feedback).encode(self.ids));
        if self.cycle.is_multiple_of(u32::from(HEARTBEAT_EVERY_CYCLES)) {
            out.push(Message::PlantHeartbeat(self.nmt).encode(self.ids));
        }
        self.cycle = self.cycle.wrapping_add(1);
        out
    }

    /// The torque of the cycle that ends becomes active; a missing one is bridged for a while.
    fn take_due(&mut self) -> Vec<CanFrame> {
        if !self.enabled {
            self.due = 0.0;
            self.staged = None;
            return Vec::new();
        }
        match self.staged.take() {
            Some(force) => {
                self.due = force;
                self.misses = 0;
                Vec::new()
            }
            None => {
                self.misses += 1;
                if self.misses > TORQUE_MISSES_ALLOWED { self.latch(Fault::TorqueMissing) } else { Vec::new() }
            }
        }
    }

    fn on_torque(&mut self, torque: Torque) -> Vec<CanFrame> {
        if self.nmt != NmtState::Operational || self.counter != Some(torque.counter) {
            return Vec::new();
        }
        let command = torque.control.command();
        if command != Some(Command::EnableOperation) {
            // CiA 402: the way to operation goes through `switched on`.
            self.armed = command == Some(Command::SwitchOn);
            self.enabled = false;
            self.due = 0.0;
            self.staged = None;
            return self.forgive(torque.control);
        }
        if self.fault.is_none() && (self.armed || self.enabled) {
            self.enabled = true;
            self.staged = Some(f64::from(torque.torque.0) * self.newton_per_micro_nm);
        }
        Vec::new()
    }

    /// The servo disabled the plant on purpose (not because of its own fault): a latched fault is cleared.
    fn forgive(&mut self, control: ControlWord) -> Vec<CanFrame> {
        if self.fault.is_none() || control.command() == Some(Command::DisableVoltage) {
            return Vec::new();
        }
        self.fault = None;
        self.misses = 0;
        vec![Message::PlantEmergency(EmergencyMessage::error_reset()).encode(self.ids)]
    }

    fn latch(&mut self, fault: Fault) -> Vec<CanFrame> {
        self.armed = false;
        self.enabled = false;
        self.due = 0.0;
        self.staged = None;
        self.fault = Some(fault);
        let detail = [fault.code(), self.counter.map_or(0, SyncCounter::get), 0, 0, 0];
        let emergency = EmergencyMessage::new(fault.emergency_code(), ErrorRegister(ErrorRegister::GENERIC), detail);
        vec![Message::PlantEmergency(emergency).encode(self.ids)]
    }
}

fn saturated(increments: i64) -> i32 {
    i32::try_from(increments).unwrap_or(if increments < 0 { i32::MIN } else { i32::MAX })
}
