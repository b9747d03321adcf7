//! `quadrant servo`: the servo node of one axis.

use protocol::cob::HEARD_BY_SERVO;
use servo::Servo;

use crate::cli;
use crate::error::Outcome;
use crate::network::single_node::{self, Post};

/// Runs the servo node until it is ended.
///
/// # Errors
/// Where the interface cannot be opened or goes away.
pub fn run(arguments: &cli::Servo) -> Outcome<()> {
    let ids = single_node::ids(arguments.node, arguments.plant_node)?;
    let post = Post {
        interface: &arguments.can,
        node: ids.servo,
        heard: &HEARD_BY_SERVO,
        pace: arguments.pace.chosen(),
        faults: arguments.faults,
    };
    post.run(Box::new(Servo::new(ids)))
}
