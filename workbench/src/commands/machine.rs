//! `quadrant machine`: the built-in machine file, to start one's own from.

use plant_sim::Machine;

use crate::stdout;

/// Prints the reference machine file.
pub fn run() {
    stdout::text(format_args!("{}", Machine::reference_text()));
}
