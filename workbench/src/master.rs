//! The workbench on the bus: NMT master, SYNC producer, SDO client, source of setpoints.
//!
//! One cycle k in lock-step: SYNC k, setpoints k + 1, then wait until the torque k of every axis was seen. A cycle whose torque does not come
//! while the link waits counts as missed and the run goes on; what that means is the business of the nodes' watchdogs.

use std::time::Duration;

use plant_sim::Machine;
use plant_sim::node::Truth;
use protocol::cob::{AxisIds, FrameKind};
use protocol::message::{Decoded, NmtCommand, NmtState, Setpoint, decode};
use protocol::sdo::{AbortCode, Address, Expedited, Request, Response};
use protocol::states::{ControlWord, DriveState};
use protocol::weight::{LoadIncrements24, SetpointFine};
use protocol::{Fault, Message, SyncCounter};
use servo::objects;

use crate::compensation::AxisCompensation;
use crate::drive::{self, COUNT_M, FINE_PER_COUNT};
use crate::error::{Failure, Outcome};
use crate::link::{Link, axis_ids};

/// How long an answer may take before the node counts as absent.
const ANSWER: Duration = Duration::from_secs(1);
/// Frames that may pass while an answer is waited for: more than a full 1 Mbit/s bus carries in a second.
const FRAMES_PER_ANSWER: u32 = 20_000;
/// Frames that may pass in a cycle.
const FRAMES_PER_CYCLE: u32 = 4000;
/// Cycles that a brake may take to open: the longest opening time of a parameter set, 2 s, at 1 ms.
const CYCLES_TO_OPEN: u32 = 2000;
/// A servo that is silent for longer is gone.
const SILENT_CYCLES: u32 = 10;

/// What an axis did in one cycle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AxisCycle {
    /// Setpoint of the cycle, m.
    pub reference_m: f64,
    /// Motor encoder, as a position at the table, m.
    pub motor_m: f64,
    /// Load scale, m.
    pub load_m: f64,
    /// Force that is active from this cycle to the next: the torque command of the cycle before, at the table, N.
    pub force_n: f64,
    /// What an instrument at the machine saw.
    pub truth: Option<Truth>,
}

struct AxisLink {
    ids: AxisIds,
    bus: usize,
    name: String,
    way_m: f64,
    newton_per_micro_nm: f64,
    next: SetpointFine,
    now: AxisCycle,
    load: Option<(LoadIncrements24, i64)>,
    torque_n: f64,
    torque_seen: bool,
    silent_cycles: u32,
    state: Option<DriveState>,
    fault: Option<Fault>,
}

/// The workbench on the buses of a machine.
pub struct Master<L: Link> {
    link: L,
    axes: Vec<AxisLink>,
    counter: SyncCounter,
    period: Duration,
    control: ControlWord,
    missed: u32,
    cycles: u64,
}

impl<L: Link> Master<L> {
    /// Finds all nodes of the machine, resets them and waits until they have booted.
    ///
    /// # Errors
    /// Which node of which axis did not answer, and what to start.
    pub fn start(mut link: L, machine: &Machine) -> Outcome<Self> {
        let axes = machine.axes.iter().enumerate();
        let axes = axes.map(|(index, axis)| {
            let counts = f64::from(axis.actual.motor_encoder_counts_per_rev);
            Ok(AxisLink {
                ids: axis_ids(index)?,
                bus: link.bus_of(index),
                name: axis.name.clone(),
                way_m: axis.actual.lead_m_per_rev / counts,
                newton_per_micro_nm: axis.actual.newton_per_micro_nm(),
                next: SetpointFine::default(),
                now: AxisCycle::default(),
                load: None,
                torque_n: 0.0,
                torque_seen: false,
                silent_cycles: 0,
                state: None,
                fault: None,
            })
        });
        let axes = axes.collect::<Outcome<Vec<_>>>()?;
        link.start_log();
        let period = Duration::from_secs_f64(machine.period_s);
        let counter = SyncCounter::FIRST;
        let mut master =
            Self { link, axes, counter, period, control: ControlWord::DISABLE_VOLTAGE, missed: 0, cycles: 0 };
        master.reset_nodes()?;
        Ok(master)
    }

    /// Cycles whose torque did not come in time.
    #[must_use]
    pub const fn missed(&self) -> u32 {
        self.missed
    }

    /// Cycles so far.
    #[must_use]
    pub const fn cycles(&self) -> u64 {
        self.cycles
    }

    /// The link, for tests that pull plugs.
    pub fn link_mut(&mut self) -> &mut L {
        &mut self.link
    }

    /// Gives the link back.
    pub fn into_link(self) -> L {
        self.link
    }

    /// Last known state of an axis' drive.
    #[must_use]
    pub fn state(&self, axis: usize) -> Option<DriveState> {
        self.axes[axis].state
    }

    /// Last fault that an axis reported, by status or EMCY.
    #[must_use]
    pub fn fault(&self, axis: usize) -> Option<Fault> {
        self.axes[axis].fault
    }

    /// What an axis did in the cycle that has just ended.
    #[must_use]
    pub fn axis(&self, axis: usize) -> AxisCycle {
        self.axes[axis].now
    }

    fn reset_nodes(&mut self) -> Outcome<()> {
        for index in 0..self.axes.len() {
            // Somebody may have to be started by hand first; only then the reset is worth sending.
            let _ = self.upload(index, objects::DEVICE_TYPE)?;
        }
        for bus in 0..self.link.buses() {
            self.broadcast(bus, NmtCommand::ResetCommunication)?;
        }
        (0..self.link.buses()).try_for_each(|bus| self.wait_boot(bus))
    }

    /// Servo and plant of every axis on a bus boot after a reset.
    fn wait_boot(&mut self, bus: usize) -> Outcome<()> {
        let mut missing: Vec<(AxisIds, String, FrameKind)> = Vec::new();
        for axis in self.axes.iter().filter(|axis| axis.bus == bus) {
            missing.push((axis.ids, axis.name.clone(), FrameKind::PlantHeartbeat));
            missing.push((axis.ids, axis.name.clone(), FrameKind::ServoHeartbeat));
        }
        let mut frames = 0;
        while let Some((ids, name, kind)) = missing.first() {
            frames += 1;
            let received = if frames > FRAMES_PER_ANSWER { None } else { self.link.receive(bus, ANSWER)? };
            let Some(frame) = received else {
                let (node, what) = match kind {
                    FrameKind::PlantHeartbeat => (ids.plant.get(), "plant"),
                    _ => (ids.servo.get(), "servo"),
                };
                return Err(Failure::new(format!(
                    "axis {name}: no boot-up of the {what} (node {node}); is `quadrant {what}` for this node running on this interface?"
                )));
            };
            missing.retain(|(ids, _, kind)| !is_boot_up(*ids, *kind, &frame));
        }
        Ok(())
    }

    fn broadcast(&mut self, bus: usize, command: NmtCommand) -> Outcome<()> {
        let ids = axis_ids(0)?;
        self.link.send(bus, Message::Nmt(command, None).encode(ids))
    }

    fn send(&mut self, index: usize, message: Message) -> Outcome<()> {
        let axis = &self.axes[index];
        self.link.send(axis.bus, message.encode(axis.ids))
    }

    fn ask(&mut self, index: usize, request: Request) -> Outcome<Response> {
        self.send(index, Message::SdoRequest(request))?;
        let (bus, ids) = (self.axes[index].bus, self.axes[index].ids);
        let mut frames = 0;
        loop {
            frames += 1;
            let received = if frames > FRAMES_PER_ANSWER { None } else { self.link.receive(bus, ANSWER)? };
            let Some(frame) = received else {
                let (name, node) = (&self.axes[index].name, ids.servo.get());
                return Err(Failure::new(format!(
                    "axis {name}: the servo (node {node}) does not answer; is `quadrant servo --node {node} --plant-node {}` running on this interface?",
                    ids.plant.get()
                )));
            };
            if let Ok(Decoded::Message(Message::SdoResponse(response))) = decode(ids, &frame) {
                return Ok(response);
            }
        }
    }

    /// Reads an object of the servo.
    ///
    /// # Errors
    /// No answer, or an abort with its text.
    pub fn upload(&mut self, index: usize, address: Address) -> Outcome<Expedited> {
        match self.ask(index, Request::Upload(address))? {
            Response::Uploaded(_, data) => Ok(data),
            other => Err(self.refused(index, address, other)),
        }
    }

    /// Writes an object of the servo.
    ///
    /// # Errors
    /// No answer, or an abort with its text.
    pub fn download(&mut self, index: usize, address: Address, data: Expedited) -> Outcome<()> {
        match self.ask(index, Request::Download(address, data))? {
            Response::Downloaded(_) => Ok(()),
            other => Err(self.refused(index, address, other)),
        }
    }

    fn refused(&self, index: usize, address: Address, response: Response) -> Failure {
        let why = match response {
            Response::Aborted(_, code) => format!("{} (abort {code:#010x})", AbortCode::text(code)),
            other => format!("unexpected answer {other:?}"),
        };
        let Address { index: object, subindex } = address;
        Failure::new(format!("axis {}: object {object:04X}h:{subindex}: {why}", self.axes[index].name))
    }

    /// Downloads the parameters of all axes and makes each set active as a whole.
    ///
    /// # Errors
    /// Where a value does not fit or the drive refuses it.
    pub fn configure(&mut self, machine: &Machine, compensation: &[AxisCompensation]) -> Outcome<()> {
        for (index, axis) in machine.axes.iter().enumerate() {
            let own = compensation.get(index).copied().unwrap_or_default();
            for (entry, value) in drive::parameters(axis, machine.period_s, &own)? {
                self.download(index, entry.address, Expedited::i32(value))?;
            }
            self.download(index, objects::COMMIT, Expedited::u32(objects::COMMIT_KEY))?;
        }
        Ok(())
    }

    /// NMT start, and the drives up to `operation enabled` where they stand.
    ///
    /// # Errors
    /// Where a drive does not come up; with the fault that it reports.
    pub fn enable(&mut self) -> Outcome<()> {
        for bus in 0..self.link.buses() {
            self.broadcast(bus, NmtCommand::StartRemoteNode)?;
        }
        self.prime()?;
        for control in [
            ControlWord::DISABLE_VOLTAGE,
            ControlWord::FAULT_RESET,
            ControlWord::SHUTDOWN,
            ControlWord::SWITCH_ON,
            ControlWord::ENABLE_OPERATION,
        ] {
            self.control = control;
            for _ in 0..3 {
                let here: Vec<f64> = self.axes.iter().map(AxisLink::position_m).collect();
                self.cycle(&here)?;
            }
        }
        // A status comes every tenth cycle.
        let here: Vec<f64> = self.axes.iter().map(|axis| axis.now.reference_m).collect();
        for _ in 0..12 {
            self.cycle(&here)?;
        }
        self.wait_for_brakes(&here)?;
        self.expect_enabled()
    }

    /// A drive whose brake is still opening stays `switched on`; its own patience ends that with a fault.
    fn wait_for_brakes(&mut self, here: &[f64]) -> Outcome<()> {
        let mut cycles = 0;
        while cycles < CYCLES_TO_OPEN && self.axes.iter().any(AxisLink::is_coming_up) {
            self.cycle(here)?;
            cycles += 1;
        }
        Ok(())
    }

    /// Fails with what a drive reports, if it does not follow setpoints.
    ///
    /// # Errors
    /// Axis, state and fault.
    pub fn expect_enabled(&self) -> Outcome<()> {
        if let Some(axis) = self.axes.iter().find(|axis| axis.silent_cycles > SILENT_CYCLES) {
            let (name, node) = (&axis.name, axis.ids.servo.get());
            return Err(Failure::new(format!(
                "axis {name}: the servo (node {node}) sent no torque for {} cycles; is it still running and on this interface?",
                axis.silent_cycles
            )));
        }
        match self.axes.iter().find(|axis| axis.state != Some(DriveState::OperationEnabled)) {
            None => Ok(()),
            Some(axis) => {
                let why = axis
                    .fault
                    .map_or_else(|| "no fault reported".to_owned(), |fault| format!("{fault:?}: {}", fault.text()));
                let state = axis.state.map_or_else(|| "no status seen".to_owned(), |state| format!("{state:?}"));
                Err(Failure::new(format!("axis {}: the drive is not enabled ({state}; {why})", axis.name)))
            }
        }
    }

    /// Whether some servo has been silent for so long that going on makes no sense.
    #[must_use]
    pub fn has_lost_a_servo(&self) -> bool {
        self.axes.iter().any(|axis| axis.silent_cycles > SILENT_CYCLES)
    }

    /// Disables the drives.
    ///
    /// # Errors
    /// Where an interface is gone.
    pub fn disable(&mut self) -> Outcome<()> {
        self.control = ControlWord::DISABLE_VOLTAGE;
        let here: Vec<f64> = self.axes.iter().map(|axis| axis.now.reference_m).collect();
        for _ in 0..3 {
            self.cycle(&here)?;
        }
        Ok(())
    }

    /// Resets faults; the drives are disabled afterwards.
    ///
    /// # Errors
    /// Where an interface is gone.
    pub fn reset_fault(&mut self) -> Outcome<()> {
        for control in [ControlWord::DISABLE_VOLTAGE, ControlWord::FAULT_RESET, ControlWord::DISABLE_VOLTAGE] {
            self.control = control;
            for _ in 0..12 {
                let here: Vec<f64> = self.axes.iter().map(AxisLink::position_m).collect();
                self.cycle(&here)?;
            }
        }
        self.axes.iter_mut().for_each(|axis| axis.fault = None);
        Ok(())
    }

    /// Sets the control word that the next setpoints carry.
    pub fn command(&mut self, control: ControlWord) {
        self.control = control;
    }

    fn prime(&mut self) -> Outcome<()> {
        for index in 0..self.axes.len() {
            self.send_setpoint(index, self.counter)?;
        }
        Ok(())
    }

    fn send_setpoint(&mut self, index: usize, counter: SyncCounter) -> Outcome<()> {
        let setpoint = Setpoint { control: self.control, counter, position: self.axes[index].next };
        self.send(index, Message::Setpoint(setpoint))
    }

    /// One cycle; `next_m` are the setpoints of the cycle after it.
    ///
    /// # Errors
    /// Where an interface is gone.
    pub fn cycle(&mut self, next_m: &[f64]) -> Outcome<()> {
        self.link.pass(self.period);
        let counter = self.counter;
        for bus in 0..self.link.buses() {
            self.link.send(bus, Message::Sync(counter).encode(axis_ids(0)?))?;
        }
        for (axis, next) in self.axes.iter_mut().zip(next_m) {
            axis.begin(*next);
        }
        for index in 0..self.axes.len() {
            self.send_setpoint(index, counter.next())?;
        }
        for bus in 0..self.link.buses() {
            self.collect(bus, counter)?;
        }
        for index in 0..self.axes.len() {
            let axis = &mut self.axes[index];
            axis.now.truth = self.link.truth(index);
            axis.silent_cycles = if axis.torque_seen { 0 } else { axis.silent_cycles + 1 };
        }
        self.counter = counter.next();
        self.cycles += 1;
        Ok(())
    }

    fn collect(&mut self, bus: usize, counter: SyncCounter) -> Outcome<()> {
        // Other people's traffic must not prolong the waiting: so many frames, or so much time without any, end the cycle.
        let mut frames = 0;
        while self.axes.iter().any(|axis| axis.bus == bus && !axis.torque_seen) {
            frames += 1;
            let received = if frames > FRAMES_PER_CYCLE { None } else { self.link.receive_in_cycle(bus)? };
            let Some(frame) = received else {
                self.missed += 1;
                return Ok(());
            };
            for axis in self.axes.iter_mut().filter(|axis| axis.bus == bus) {
                // Frames that cannot be decoded are the nodes' business; the workbench only listens here.
                if let Ok(Decoded::Message(message)) = decode(axis.ids, &frame) {
                    axis.take(message, counter);
                }
            }
        }
        Ok(())
    }
}

impl AxisLink {
    fn begin(&mut self, next_m: f64) {
        self.now.reference_m = fine_m(self.next);
        self.now.force_n = self.torque_n;
        self.next = fine(next_m);
        self.torque_seen = false;
    }

    fn take(&mut self, message: Message, counter: SyncCounter) {
        match message {
            Message::Feedback(feedback) if feedback.counter == counter => {
                self.now.motor_m = f64::from(feedback.motor.0) * self.way_m;
                let counts = self.unwrap(feedback.load);
                self.load = Some((feedback.load, counts));
                #[expect(clippy::cast_precision_loss, reason = "counts of 10 nm below 2^53")]
                let load_m = counts as f64 * COUNT_M;
                self.now.load_m = load_m;
            }
            Message::Torque(torque) if torque.counter == counter => {
                self.torque_n = f64::from(torque.torque.0) * self.newton_per_micro_nm;
                self.torque_seen = true;
            }
            Message::Status(status) => {
                self.state = status.status.state();
                self.fault = status.fault.or(self.fault);
            }
            Message::ServoEmergency(emergency) | Message::PlantEmergency(emergency) => {
                self.fault = Fault::from_code(emergency.vendor_specific[0]).or(self.fault);
            }
            _ => {}
        }
    }

    /// The load scale tells its low 24 bits; the first reading is taken to stand nearest to the motor.
    #[expect(clippy::cast_possible_truncation, reason = "positions of metres in counts of 10 nm")]
    fn unwrap(&self, load: LoadIncrements24) -> i64 {
        let (raw, counts) = self.load.unwrap_or_else(|| {
            let counts = (self.now.motor_m / COUNT_M).round() as i64;
            (LoadIncrements24::from_counts(counts), counts)
        });
        counts + i64::from(raw.step_to(load))
    }

    fn is_coming_up(&self) -> bool {
        self.state == Some(DriveState::SwitchedOn) && self.fault.is_none() && self.silent_cycles <= SILENT_CYCLES
    }

    /// Where the axis stands, by the encoder that is nearest to the loop's; both agree to micrometres at rest.
    fn position_m(&self) -> f64 {
        self.now.load_m
    }
}

fn is_boot_up(ids: AxisIds, kind: FrameKind, frame: &protocol::CanFrame) -> bool {
    match decode(ids, frame) {
        Ok(Decoded::Message(message)) => {
            message.kind() == kind
                && matches!(
                    message,
                    Message::PlantHeartbeat(NmtState::Initialising) | Message::ServoHeartbeat(NmtState::Initialising)
                )
        }
        _ => false,
    }
}

/// Setpoint counts of a position.
#[must_use]
#[expect(clippy::cast_possible_truncation, reason = "saturates; SetpointFine saturates once more")]
pub fn fine(position_m: f64) -> SetpointFine {
    SetpointFine::saturating((position_m / COUNT_M * FINE_PER_COUNT).round() as i64)
}

#[expect(clippy::cast_precision_loss, reason = "40 bits")]
fn fine_m(setpoint: SetpointFine) -> f64 {
    setpoint.counts() as f64 * COUNT_M / FINE_PER_COUNT
}
