//! Simulated seconds per wall second of one axis on one core: the plant alone, and the closed loop
//! (plant, servo, workbench, every frame encoded and decoded) on the in-process bus. `cargo bench
//! -p hil-tests --bench axis`.
//!
//! `-- plant CYCLES` and `-- loop CYCLES` do just that and print nothing: for
//! `scripts/host-instructions`, which counts what a cycle takes.

use std::f64::consts::TAU;
use std::time::Instant;

use hil_tests::rig::{enabled, one_axis};
use plant_sim::Axis;

/// Cycles of 1 ms that are timed.
const CYCLES: u32 = 200_000;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let named: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let count = |cycles: &str| cycles.parse().expect("a number of cycles");
    match named[..] {
        ["plant", cycles, ..] => plant(count(cycles)),
        ["loop", cycles, ..] => closed_loop(count(cycles)),
        _ => print_speeds(),
    }
}

/// To and fro over 40 mm at 0.5 Hz, from rest: one that begins in motion is refused by the drive.
fn path_m(cycle: u32) -> f64 {
    0.02 * (1.0 - (TAU * 0.5 * 1.0e-3 * f64::from(cycle)).cos())
}

/// The plant alone, pushed by ±3 kN.
fn plant(cycles: u32) {
    let machine = one_axis();
    let mut axis = Axis::new(machine.axes[0].actual.clone(), 1);
    for cycle in 0..cycles {
        axis.advance(3000.0 * (1.0 - path_m(cycle) / 0.02), machine.period_s);
    }
}

fn closed_loop(cycles: u32) {
    let mut master = enabled(&one_axis()).expect("the reference machine comes up");
    for cycle in 0..cycles {
        let held = master.cycle(&[path_m(cycle)]);
        held.expect("the in-process bus takes every frame");
    }
    let runs = master.expect_enabled();
    runs.expect("an axis that the drive has stopped is no closed loop");
}

fn print_speeds() {
    let speed = |run: fn(u32)| {
        let begun = Instant::now();
        run(CYCLES);
        1.0e-3 * f64::from(CYCLES) / begun.elapsed().as_secs_f64()
    };
    println!("one axis, one core                simulated s per wall s   wanted");
    println!("plant alone                       {:>20.0}", speed(plant));
    println!(
        "closed loop over in-process CAN   {:>20.0}        200",
        speed(closed_loop)
    );
    let load = one_axis().bus_load_per_mille();
    println!("computed bus load: {}.{} %", load / 10, load % 10);
}
