//! The law alone as ARM code on an emulated Cortex-M4: its golden vectors, which the host's tests
//! write (`firmware/controller/vectors`).
//!
//! An image of its own: a second caller of the law in the other one would change what is inlined
//! there, and with it the instructions that are counted.
//!
//! Report: `vectors R W`, `R` rows of which `W` differ.
#![no_std]
#![no_main]

#[path = "../host.rs"]
mod host;

use controller::reference::ReferenceState;
use controller::units::{Position, Velocity};
use controller::{PositionSource, State};
use cortex_m_rt::entry;
use cortex_m_semihosting::debug::EXIT_SUCCESS;
use fixed::types::I56F8;

use host::{exit, report};

#[path = "../../../controller/vectors/law.rs"]
mod law;

/// Rows of setpoint of the next cycle, motor, load (10 nm / 256), torque (µN·m).
const ROWS: &str = include_str!("../../../controller/vectors/reference.txt");

#[entry]
fn main() -> ! {
    let (rows, wrong) = rows_and_wrong();
    report(format_args!("vectors {rows} {wrong}"));
    exit(EXIT_SUCCESS)
}

/// How many rows there are, and how many of them the law answers otherwise here. A row that is no
/// row is wrong.
fn rows_and_wrong() -> (usize, usize) {
    let (config, mut state) = (law::config(PositionSource::Load), State::default());
    // At rest at zero before the first cycle.
    let mut stage = ReferenceState::at(Position::default(), Velocity::ZERO);
    let mut is_right = |row: &str| {
        let mut bits = row.split(' ').map(|bits| bits.parse::<i64>().ok());
        let mut next = || bits.next().flatten();
        let (Some(preview), Some(motor), Some(load), Some(torque)) =
            (next(), next(), next(), next())
        else {
            return false;
        };
        let [preview, motor, load] =
            [preview, motor, load].map(|bits| Position(I56F8::from_bits(bits)));
        let answer = law::torque(&config, &mut stage, &mut state, preview, [motor, load]);
        i64::from(answer) == torque
    };
    let rows = || ROWS.lines().filter(|row| !row.starts_with('#'));
    (rows().count(), rows().filter(|row| !is_right(row)).count())
}
