//! The workbench on the bus: NMT master, SYNC producer, SDO client, source of setpoints.
//!
//! ```text
//!          SYNC k, setpoint k + 1                  feedback k, torque k, status, EMCY
//! cycle ───────────────────────▶ servo, plant ─────────────────────────────────────▶ axis link
//!   ▲                                                                                    │
//!   └────────── way up and down, stop as one: which control word, which setpoint ◀───────┘
//! ```
//!
//! One cycle k in lock-step (`sync_cycle`): SYNC k, setpoints k + 1, then wait until the torque k
//! of every axis was seen. A cycle whose torque does not come while the link waits counts as missed
//! and the run goes on; what that means is the business of the nodes' watchdogs. `way` brings the
//! drives up and down, each step confirmed by their status. `halt` stops all axes where one has
//! trouble, or where the operator wants it.

mod axis_link;
mod halt;
mod sdo_client;
mod sync_cycle;
mod way;

use std::time::{Duration, Instant};

use plant_sim::Machine;
use protocol::cob::{AxisIds, FrameKind};
use protocol::message::{Decoded, NmtCommand, NmtState, decode};
use protocol::states::{ControlWord, DriveState};
use protocol::{Fault, Message, SyncCounter};
use servo::objects;

use crate::error::{Failure, Outcome};
use crate::interrupt::Interrupt;
use crate::network::link::{Link, axis_ids};
use axis_link::AxisLink;

pub use axis_link::{AxisCycle, SILENT_CYCLES, fine};

/// How long an answer may take before the node counts as absent.
const ANSWER: Duration = Duration::from_secs(1);
/// Frames that may pass while an answer is waited for: more than a full 1 Mbit/s bus carries in a
/// second.
const FRAMES_PER_ANSWER: u32 = 20_000;

/// Waiting for an answer while others talk: heartbeats never go quiet, so that no time without
/// frames ends it. It ends by the wall clock, or by the number of frames where time is virtual.
struct AnswerPatience {
    begun: Instant,
    frames: u32,
}

impl AnswerPatience {
    fn begin() -> Self {
        Self {
            begun: Instant::now(),
            frames: 0,
        }
    }

    fn lasts(&mut self) -> bool {
        self.frames += 1;
        self.frames <= FRAMES_PER_ANSWER && self.begun.elapsed() < ANSWER
    }
}

/// The workbench on the buses of a machine.
pub struct Master<L: Link> {
    link: L,
    axes: Vec<AxisLink>,
    counter: SyncCounter,
    period: Duration,
    control: ControlWord,
    interrupt: Interrupt,
    missed: u32,
    cycles: u64,
    /// Whether all drives were without torque when the last cycle ended.
    is_at_rest: bool,
}

impl<L: Link> Master<L> {
    /// Finds all nodes of the machine, resets them and waits until they have booted.
    ///
    /// # Errors
    /// Which node of which axis did not answer, and what to start.
    pub fn start(link: L, machine: &Machine) -> Outcome<Self> {
        let mut master = Self::on(link, machine)?;
        master.find_nodes()?;
        Ok(master)
    }

    /// A master that has sent nothing yet; [`Self::find_nodes`] comes next.
    ///
    /// # Errors
    /// Beyond 16 axes.
    pub fn on(link: L, machine: &Machine) -> Outcome<Self> {
        let axes = AxisLink::of_machine(machine, &link)?;
        Ok(Self {
            link,
            axes,
            counter: SyncCounter::FIRST,
            period: Duration::from_secs_f64(machine.period_s),
            control: ControlWord::DISABLE_VOLTAGE,
            interrupt: Interrupt::never(),
            missed: 0,
            cycles: 0,
            is_at_rest: true,
        })
    }

    /// The same master, which does not enable drives any more once the token is raised.
    #[must_use]
    pub fn until(mut self, interrupt: Interrupt) -> Self {
        self.interrupt = interrupt;
        self
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

    /// Whether a clock beats the time, which does not wait for the workbench.
    #[must_use]
    pub fn follows_clock(&self) -> bool {
        self.link.follows_clock()
    }

    /// The link.
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

    /// Sets the control word that the next setpoints carry.
    pub fn command(&mut self, control: ControlWord) {
        self.control = control;
    }

    /// Finds all nodes, resets them and waits until they have booted.
    ///
    /// # Errors
    /// Which node of which axis did not answer, and what to start.
    pub fn find_nodes(&mut self) -> Outcome<()> {
        for index in 0..self.axes.len() {
            // Somebody may have to be started by hand first; only then the reset is worth sending.
            let _ = self.upload(index, objects::DEVICE_TYPE)?;
        }
        self.broadcast(NmtCommand::ResetCommunication)?;
        (0..self.link.buses()).try_for_each(|bus| self.wait_boot(bus))
    }

    /// Servo and plant of every axis on a bus boot after a reset.
    fn wait_boot(&mut self, bus: usize) -> Outcome<()> {
        let mut missing: Vec<(AxisIds, String, FrameKind)> = Vec::new();
        for axis in self.axes.iter().filter(|axis| axis.bus == bus) {
            missing.push((axis.ids, axis.name.clone(), FrameKind::PlantHeartbeat));
            missing.push((axis.ids, axis.name.clone(), FrameKind::ServoHeartbeat));
        }
        let mut patience = AnswerPatience::begin();
        while let Some((ids, name, kind)) = missing.first() {
            let received = if patience.lasts() {
                self.link.receive(bus, ANSWER)?
            } else {
                None
            };
            let Some(frame) = received else {
                return Err(no_boot_up(*ids, name, *kind));
            };
            missing.retain(|(ids, _, kind)| !is_boot_up(*ids, *kind, &frame));
        }
        Ok(())
    }

    fn broadcast(&mut self, command: NmtCommand) -> Outcome<()> {
        let frame = Message::Nmt(command, None).encode(axis_ids(0)?);
        (0..self.link.buses()).try_for_each(|bus| self.link.send(bus, frame))
    }

    fn send(&mut self, index: usize, message: Message) -> Outcome<()> {
        let axis = &self.axes[index];
        self.link.send(axis.bus, message.encode(axis.ids))
    }
}

fn no_boot_up(ids: AxisIds, name: &str, kind: FrameKind) -> Failure {
    let (node, what) = match kind {
        FrameKind::PlantHeartbeat => (ids.plant.get(), "plant"),
        _ => (ids.servo.get(), "servo"),
    };
    Failure::new(format!(
        "axis {name}: no boot-up of the {what} (node {node}); is `quadrant {what}` for this node running on this interface?"
    ))
}

fn is_boot_up(ids: AxisIds, kind: FrameKind, frame: &protocol::CanFrame) -> bool {
    let Ok(Decoded::Message(message)) = decode(ids, frame) else {
        return false;
    };
    let boots = matches!(
        message,
        Message::PlantHeartbeat(NmtState::Initialising)
            | Message::ServoHeartbeat(NmtState::Initialising)
    );
    boots && message.kind() == kind
}
