//! Simulated seconds per wall second of one axis on one core: the plant alone, and the closed loop
//! (plant, servo, workbench, every frame encoded and decoded) on the in-process bus. `cargo bench
//! -p hil-tests --bench axis`.

use std::time::Instant;

use hil_tests::rig::{enabled, one_axis};
use plant_sim::Axis;

fn main() {
    let machine = one_axis();
    let load = machine.bus_load_per_mille();
    let path = |t: f64| 0.02 * (std::f64::consts::TAU * 0.5 * t).sin();

    let mut axis = Axis::new(machine.axes[0].actual.clone(), 1);
    let seconds = 200.0;
    let begun = Instant::now();
    for cycle in 0..200_000 {
        axis.advance(
            3000.0 * path(1.0e-3 * f64::from(cycle)) / 0.02,
            machine.period_s,
        );
    }
    let plant = seconds / begun.elapsed().as_secs_f64();

    let mut master = enabled(&machine).expect("the reference machine comes up");
    let begun = Instant::now();
    for cycle in 0..200_000 {
        master
            .cycle(&[path(1.0e-3 * f64::from(cycle))])
            .expect("the in-process bus takes every frame");
    }
    let closed = seconds / begun.elapsed().as_secs_f64();

    println!("one axis, one core                simulated s per wall s   wanted");
    println!("plant alone                       {plant:>20.0}");
    println!("closed loop over in-process CAN   {closed:>20.0}        200");
    println!("computed bus load: {}.{} %", load / 10, load % 10);
}
