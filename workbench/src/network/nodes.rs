//! `quadrant plant` and `quadrant servo`: one node each, for a bus with other people's nodes on it.

use bus::{CanPort, FaultPlan, FaultyPort};
use plant_sim::{Machine, PlantNode};
use protocol::Station;
use protocol::cob::{AxisIds, FrameKind, HEARD_BY_PLANT, HEARD_BY_SERVO, NodeId};
use quadrant_host::Pace;
use quadrant_host::port::Port;
use quadrant_host::termination::Termination;

use crate::cli;
use crate::error::{Failure, Outcome};
use crate::network::link::plant_seed;

fn ids(servo: u8, plant: u8) -> Outcome<AxisIds> {
    match (NodeId::new(servo), NodeId::new(plant)) {
        (Some(servo), Some(plant)) if servo != plant => Ok(AxisIds { servo, plant }),
        _ => Err(Failure::new(format!(
            "--node: servo {servo} and plant {plant} must be two different ids from 1 to 127"
        ))),
    }
}

/// Runs the servo node until it is ended.
///
/// # Errors
/// Where the interface cannot be opened or goes away.
pub fn servo(arguments: &cli::Servo) -> Outcome<()> {
    let ids = ids(arguments.node, arguments.plant_node)?;
    let servo = servo::Servo::new(ids);
    let receiver = Receiver {
        interface: &arguments.can,
        node: ids.servo,
        heard: &HEARD_BY_SERVO,
    };
    receiver.run(Box::new(servo), arguments.pace.chosen(), arguments.faults)
}

/// Runs the plant node of an axis until it is ended.
///
/// # Errors
/// Where the machine file is wrong, or the interface cannot be opened or goes away.
pub fn plant(arguments: &cli::Plant) -> Outcome<()> {
    let machine = match &arguments.machine {
        Some(path) => Machine::read(path)?,
        None => Machine::reference(),
    };
    let index = usize::from(arguments.node).wrapping_sub(0x11);
    let Some(axis) = machine.axes.get(index) else {
        return Err(Failure::new(format!(
            "--node {:#04x}: machine {} has {} axes, with plants at 0x11 to {:#04x}",
            arguments.node,
            machine.name,
            machine.axes.len(),
            0x10 + machine.axes.len()
        )));
    };
    refuse_overload(&machine, arguments.pace.chosen())?;
    let ids = ids(arguments.node - 0x10, arguments.node)?;
    let plant = PlantNode::new(
        ids,
        axis.actual.clone(),
        machine.period_s,
        plant_seed(machine.seed, 0, index),
    );
    let receiver = Receiver {
        interface: &arguments.can,
        node: ids.plant,
        heard: &HEARD_BY_PLANT,
    };
    receiver.run(Box::new(plant), arguments.pace.chosen(), arguments.faults)
}

/// Where a node listens, and to what.
struct Receiver<'a> {
    interface: &'a str,
    node: NodeId,
    heard: &'a [FrameKind],
}

impl Receiver<'_> {
    /// Runs a node until it is ended by SIGTERM or SIGINT: it says nothing more then, and its
    /// peer's watchdog acts.
    fn run(&self, node: Box<dyn Station>, pace: Pace, faults: Option<FaultPlan>) -> Outcome<()> {
        let gone = |error| Failure::new(format!("CAN interface {}: {error}", self.interface));
        let ended = Termination::catch().map_err(gone)?;
        let ids = node.ids();
        let heard: Vec<_> = self
            .heard
            .iter()
            .map(|kind| ids.identifier(*kind))
            .collect();
        let port = CanPort::open(self.interface, &heard)
            .map_err(|error| Failure::new(error.to_string()))?;
        let faults = faults.map(|plan| FaultyPort::new(plan, ids, self.node.get()));
        quadrant_host::run(node, Port::Can(port), faults, pace, &ended).map_err(gone)
    }
}

/// On a clock, a bus that cannot carry the cycle misses deadlines; vcan would not show it, so the
/// computed load decides.
///
/// # Errors
/// The load, and what makes it less.
pub fn refuse_overload(machine: &Machine, pace: Pace) -> Outcome<()> {
    let load = machine.bus_load_per_mille();
    if pace == Pace::Clock && load > protocol::load::CLOCK_PACED_LIMIT_PER_MILLE {
        return Err(Failure::new(format!(
            "machine {}: {}.{} % computed bus load, a clock-paced run takes at most {} %; give each axis its own interface, a longer period_s or CAN FD",
            machine.name,
            load / 10,
            load % 10,
            protocol::load::CLOCK_PACED_LIMIT_PER_MILLE / 10
        )));
    }
    Ok(())
}
