//! `quadrant plant` and `quadrant servo`: one node each, for a bus with other people's nodes on it.

use std::time::{Duration, Instant};

use embedded_can::Frame;

use bus::{CanPort, FaultPlan, FaultyPort, Received, Station};
use plant_sim::{Machine, PlantNode};
use protocol::cob::{AxisIds, FrameKind, NodeId};
use quadrant_host::port::Port;

use crate::cli;
use crate::error::{Failure, Outcome};
use crate::link::plant_seed;

/// A node runs until its process is ended.
const fn never() -> bool {
    false
}

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
    let port = open(&arguments.can, &quadrant_host::accepted(ids))?;
    let servo = servo::Servo::new(ids).with_sync_timeout_us(arguments.pace.sync_timeout_us());
    quadrant_host::run(servo, Port::Can(port), arguments.faults, never).map_err(|error| gone(&arguments.can, &error))
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
    refuse_overload(&machine, arguments.pace)?;
    let servo = arguments.node - 0x10;
    let ids = ids(servo, arguments.node)?;
    let accepted = [FrameKind::Nmt, FrameKind::Sync, FrameKind::Torque].map(|kind| ids.identifier(kind));
    let port = open(&arguments.can, &accepted)?;
    let timeout_us = u64::from(arguments.pace.sync_timeout_us());
    let node = PlantNode::new(ids, axis.actual.clone(), machine.period_s, plant_seed(machine.seed, 0, index));
    run(node.with_sync_timeout_us(timeout_us), &port, arguments.faults)
        .map(|never| match never {})
        .map_err(|error| gone(&arguments.can, &error))
}

/// On a clock, a bus that cannot carry the cycle misses deadlines; vcan would not show it, so the computed load decides.
fn refuse_overload(machine: &Machine, pace: cli::Pace) -> Outcome<()> {
    let load = machine.bus_load_per_mille();
    if pace == cli::Pace::Clock && load > protocol::load::CLOCK_PACED_LIMIT_PER_MILLE {
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

fn open(interface: &str, accepted: &[embedded_can::StandardId]) -> Outcome<CanPort> {
    CanPort::open(interface, accepted).map_err(|error| Failure::new(error.to_string()))
}

fn gone(interface: &str, error: &std::io::Error) -> Failure {
    Failure::new(format!("CAN interface {interface}: {error}"))
}

/// The node notices time this often when the bus is quiet…
const TICK: Duration = Duration::from_millis(5);
/// … and after so many frames when it is not.
const FRAMES_PER_TICK: u32 = 32;

fn run(mut node: PlantNode, port: &CanPort, faults: Option<FaultPlan>) -> std::io::Result<std::convert::Infallible> {
    let ids = node.ids();
    let mut faults = faults.map(|plan| FaultyPort::new(plan, ids, ids.plant.get()));
    let begun = Instant::now();
    let now_us = || u64::try_from(begun.elapsed().as_micros()).unwrap_or(u64::MAX);
    let (mut received, mut out) = (Vec::new(), Vec::new());
    Station::boot(&mut node, &mut out);
    // Reading the clock may be a system call: once per SYNC, and when the bus is quiet.
    let (mut now, mut since_tick) = (0, 0_u32);
    let sync = ids.identifier(FrameKind::Sync);
    loop {
        out.drain(..).try_for_each(|frame| port.send(&frame))?;
        let frame = port.receive(TICK)?;
        let is_quiet = frame.is_none();
        if let Some(frame) = frame {
            if frame.id() == embedded_can::Id::Standard(sync) {
                now = now_us();
            }
            match &mut faults {
                None => received.push(Received::Frame(frame)),
                Some(faults) => faults.receive(frame, &mut received),
            }
        }
        received.drain(..).for_each(|received| node.take(received, now, &mut out));
        since_tick += 1;
        if is_quiet || since_tick >= FRAMES_PER_TICK {
            since_tick = 0;
            now = now_us();
            node.tick(now, &mut out);
        }
    }
}
