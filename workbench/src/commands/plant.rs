//! `quadrant plant`: the plant node of one axis.

use plant_sim::{Machine, PlantNode};
use protocol::cob::HEARD_BY_PLANT;

use crate::cli;
use crate::error::{Failure, Outcome};
use crate::network::in_process::plant_seed;
use crate::network::place::refuse_overload;
use crate::network::single_node::{self, Post};

/// The plant of the first axis; those of the others follow.
const FIRST_PLANT: u8 = 0x11;
/// The servo of an axis is that far below its plant.
const SERVO_BELOW_PLANT: u8 = 0x10;

/// Runs the plant node of an axis until it is ended.
///
/// # Errors
/// Where the machine file is wrong, or the interface cannot be opened or goes away.
pub fn run(arguments: &cli::Plant) -> Outcome<()> {
    let machine = cli::machine_file(arguments.machine.as_deref())?;
    let index = axis_of(&machine, arguments.node)?;
    let pace = arguments.pace.chosen();
    refuse_overload(&machine, pace)?;
    let ids = single_node::ids(arguments.node - SERVO_BELOW_PLANT, arguments.node)?;
    let (actual, seed) = (
        machine.axes[index].actual.clone(),
        plant_seed(machine.seed, 0, index),
    );
    let post = Post {
        interface: &arguments.can,
        node: ids.plant,
        heard: &HEARD_BY_PLANT,
        pace,
        faults: arguments.faults,
    };
    post.run(Box::new(PlantNode::new(
        ids,
        actual,
        machine.period_s,
        seed,
    )))
}

/// The axis that has its plant at this node.
fn axis_of(machine: &Machine, node: u8) -> Outcome<usize> {
    let axes = machine.axes.len();
    node.checked_sub(FIRST_PLANT)
        .map(usize::from)
        .filter(|index| *index < axes)
        .ok_or_else(|| {
            Failure::new(format!(
                "--node {node:#04x}: machine {} has {axes} axes, with plants at 0x11 to {:#04x}",
                machine.name,
                0x10 + axes
            ))
        })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_plants_of_a_machine_stand_from_0x11_on_and_nowhere_else() {
        let machine = Machine::reference();
        assert_eq!(axis_of(&machine, 0x11), Ok(0));
        assert_eq!(axis_of(&machine, 0x12), Ok(1));
        for none in [0x01, 0x10, 0x13] {
            let refusal = axis_of(&machine, none).unwrap_err().to_string();
            assert!(refusal.contains("plants at 0x11 to 0x12"), "{refusal}");
        }
    }
}
