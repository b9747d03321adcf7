//! One node alone on a CAN interface, for a bus with other people's nodes on it.

use bus::{CanPort, FaultPlan, FaultyPort, RealTime};
use protocol::Station;
use protocol::cob::{AxisIds, FrameKind, NodeId};
use quadrant_host::Pace;
use quadrant_host::port::Port;
use quadrant_host::termination::Termination;

use crate::error::{Failure, Outcome};
use crate::progress;

/// The two nodes of an axis, from the numbers of a command line.
///
/// # Errors
/// Where they are no two different node ids.
pub fn ids(servo: u8, plant: u8) -> Outcome<AxisIds> {
    match (NodeId::new(servo), NodeId::new(plant)) {
        (Some(servo), Some(plant)) if servo != plant => Ok(AxisIds { servo, plant }),
        _ => Err(Failure::new(format!(
            "--node: servo {servo} and plant {plant} must be two different ids from 1 to 127"
        ))),
    }
}

/// Where a node listens, to what, and at whose pace.
#[derive(Debug)]
pub struct Post<'a> {
    /// CAN interface.
    pub interface: &'a str,
    /// The node itself.
    pub node: NodeId,
    /// The frames that it takes.
    pub heard: &'a [FrameKind],
    /// Who beats the time.
    pub pace: Pace,
    /// Faults of its receiving port, for tests.
    pub faults: Option<FaultPlan>,
}

impl Post<'_> {
    /// Runs a node until it is ended by SIGTERM or SIGINT: it says nothing more then, and its
    /// peer's watchdog acts. At clock pace it runs in real time, where the system permits it.
    ///
    /// # Errors
    /// Where the interface cannot be opened or goes away.
    pub fn run(&self, node: Box<dyn Station>) -> Outcome<()> {
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
        let faults = self
            .faults
            .map(|plan| FaultyPort::new(plan, ids, self.node.get()));
        let real_time = (self.pace == Pace::Clock).then(RealTime::begin);
        if let Some(granted) = real_time.as_ref().map(RealTime::granted) {
            progress::step(&format!("pace of the clock: {granted}"));
        }
        quadrant_host::run(node, Port::Can(port), faults, self.pace, &ended).map_err(gone)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn servo_and_plant_of_an_axis_are_two_nodes() {
        assert!(ids(1, 17).is_ok());
        for (servo, plant) in [(17, 17), (0, 17), (1, 128)] {
            assert!(ids(servo, plant).is_err(), "{servo} {plant}");
        }
    }
}
