//! Axes that hang, and axes whose encoders disagree about zero: they come up where they stand, and
//! stay there.
//!
//! The workbench tells the drive the brake's times, the relation of both encoders (2103h) and the
//! torque that carries the axis (2141h); these are the ways of the table with them, and without the
//! torque.

use hil_tests::rig::{absolute_scale, enabled, set, vertical, vertical_axes};
use plant_sim::machine::PositionSensor;
use protocol::states::{BrakeState, DriveState};
use servo::objects::Parameter;
use workbench::network::in_process::InProcess;
use workbench::network::master::Master;

fn table_m(master: &mut Master<InProcess>) -> f64 {
    master.link_mut().plant(0).borrow().truth().table_m
}

/// Beginning with the first cycle after `enable` or `disable`: where the table was furthest from
/// `from_m` in some cycles with the setpoint held, m; upwards is positive.
fn furthest_m(master: &mut Master<InProcess>, cycles: u32, from_m: f64) -> f64 {
    let hold = master.axis(0).reference_m;
    let mut furthest = 0.0_f64;
    for _ in 0..cycles {
        master.cycle(&[hold]).unwrap();
        let way = table_m(master) - from_m;
        furthest = if way.abs() > furthest.abs() {
            way
        } else {
            furthest
        };
    }
    furthest
}

#[test]
fn a_vertical_axis_comes_up_is_held_and_goes_back_into_its_brake() {
    for (name, machine) in vertical_axes() {
        let mut master = enabled(&machine).unwrap_or_else(|error| panic!("{name}: {error}"));
        assert_eq!(
            master.state(0),
            Some(DriveState::OperationEnabled),
            "{name}"
        );
        let held_um = 1.0e6 * furthest_m(&mut master, 1000, 0.0);
        let truth = master.link_mut().plant(0).borrow().truth();
        master.disable().unwrap();
        let braked_um = 1.0e6 * furthest_m(&mut master, 500, 0.0);
        println!("{name}: {held_um:.2} µm while held, {braked_um:.2} µm in the brake");
        assert!(held_um.abs() < 0.5, "{name}: {held_um} µm while held");
        assert_eq!(truth.brake, BrakeState::Open, "{name}");
        assert!(
            (2400.0..2600.0).contains(&truth.force_n),
            "{name}: the motor carries it, friction some of it: {truth:?}"
        );
        assert!(braked_um.abs() < 1.0, "{name}: {braked_um} µm in the brake");
        assert_eq!(
            (master.fault(0), master.state(0)),
            (None, Some(DriveState::SwitchOnDisabled)),
            "{name}"
        );
    }
}

#[test]
fn a_machine_whose_scale_stands_at_100_mm_comes_up_there_with_either_loop() {
    for (sensor, wanted_m) in [(PositionSensor::Load, 0.1), (PositionSensor::Motor, 0.0)] {
        let mut machine = absolute_scale(0.1);
        machine.axes[0].gains.position_sensor = sensor;
        let mut master = enabled(&machine).unwrap_or_else(|error| panic!("{sensor:?}: {error}"));
        let (axis, way) = (master.axis(0), furthest_m(&mut master, 200, 0.1));
        println!(
            "{sensor:?}: setpoint {:.6} m, {:.2} µm",
            axis.reference_m,
            1.0e6 * way
        );
        assert!(
            (axis.reference_m - wanted_m).abs() < 1.0e-6,
            "{sensor:?}: {axis:?}"
        );
        assert!((axis.load_m - 0.1).abs() < 1.0e-6, "{sensor:?}: {axis:?}");
    }
}

#[test]
fn without_the_preset_the_axis_sags_until_the_integral_carries_it() {
    let machine = vertical();
    let mut master = Master::start(InProcess::new(&machine, 0).unwrap(), &machine).unwrap();
    master.configure(&machine, &[]).unwrap();
    set(&mut master, 0, &[(Parameter::PresetTorque, 0)]).unwrap();
    master.enable().unwrap();
    let sag_m = furthest_m(&mut master, 200, 0.0);
    assert!((-150.0e-6..-115.0e-6).contains(&sag_m), "{sag_m} m");
}
