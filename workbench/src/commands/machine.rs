//! `quadrant machine`: the built-in machine file, to start one's own from.

use plant_sim::Machine;

/// Prints the reference machine file.
pub fn run() {
    print!("{}", Machine::reference_text());
}
