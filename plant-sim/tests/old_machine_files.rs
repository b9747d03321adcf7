//! Machine files that were written before the vocabulary of effects: each is read to the same
//! machine as then, and its axes move the same to the last bit.

use axis_model::{
    Delay, Effect, EffectName, FrictionDrift, Offset, PitchError, PositionDependentFriction,
    TorqueRipple, TorqueSaturation,
};
use plant_sim::axis::Mounting;
use plant_sim::brake::BrakeParameters;
use plant_sim::friction::{Law, Sliding};
use plant_sim::machine::{Bus, PositionSensor};
use plant_sim::stops::Stops;
use plant_sim::{Axis, Machine};

const REFERENCE: &str = include_str!("machines/reference.toml");
const GAP: &str = include_str!("machines/gap.toml");
const VERTICAL: &str = include_str!("machines/vertical.toml");

fn machine(text: &str) -> Machine {
    Machine::parse("old.toml", text).unwrap()
}

/// Where the axes stand after 2000 cycles of a force that turns round: table position and motor
/// velocity bit by bit, and the load scale.
fn run(machine: &Machine) -> Vec<(u64, u64, i64)> {
    let axis = |parameters: &plant_sim::machine::MachineAxis| {
        let mut axis = Axis::new(parameters.actual.clone(), machine.seed);
        axis.command_brake(true);
        for cycle in 0..2000 {
            let t_s = f64::from(cycle) * machine.period_s;
            axis.advance(1500.0 * (12.0 * t_s).sin() + 700.0, machine.period_s);
        }
        let motion = axis.motion();
        let load_10_nm = axis.read().load_10_nm;
        (
            motion.table_m.to_bits(),
            motion.motor_m_per_s.to_bits(),
            load_10_nm,
        )
    };
    machine.axes.iter().map(axis).collect()
}

/// The figures were printed by the simulator of 2026-11-21, commit c77b5c8, before it knew the
/// vocabulary.
#[test]
fn the_axes_of_old_files_move_as_they_did_to_the_last_bit() {
    let reference = (
        4_599_124_410_511_616_046,
        4_590_058_509_185_744_703,
        30_269_068,
    );
    assert_eq!(run(&machine(REFERENCE)), [reference, reference]);
    let gap = (
        4_599_825_728_738_017_700,
        4_582_359_046_478_412_065,
        34_162_434,
    );
    assert_eq!(run(&machine(GAP)), [gap]);
    let z = (
        13_820_973_675_594_063_783,
        13_827_563_144_956_596_761,
        -23_408_000,
    );
    let z2 = (
        13_822_463_833_638_504_990,
        4_584_722_791_526_245_810,
        -30_088_030,
    );
    assert_eq!(run(&machine(VERTICAL)), [z, z2]);
}

#[test]
fn the_reference_machine_is_the_one_of_then() {
    assert_eq!(machine(REFERENCE), Machine::reference());
}

#[test]
fn a_gap_with_every_further_effect_is_read_as_then() {
    let machine = machine(GAP);
    let axis = &machine.axes[0];
    let (actual, gains) = (&axis.actual, &axis.gains);
    assert_eq!(
        machine.bus,
        Bus::Classic {
            bit_rate: 1_000_000
        }
    );
    assert_eq!(axis.interface.as_deref(), Some("vcan0"));
    assert_eq!(gains.position_sensor, PositionSensor::Load);
    assert_eq!(
        (gains.torque_low_pass_hz, gains.torque_notch_hz),
        (Some(400.0), None)
    );
    assert_eq!(actual.mechanics.backlash_m, 8.0e-6);
    assert_eq!(
        (actual.sliding.coulomb_n, actual.sliding.static_n),
        (300.0, 390.0)
    );
    assert_eq!(actual.law.stiffness_n_per_m(), 3.0e7);
    let effects: [Effect; 7] = [
        Offset { offset: 25.0 }.into(),
        TorqueRipple {
            amplitude: 40.0,
            order: Some(6.0),
            period: None,
            phase: Some(0.3),
        }
        .into(),
        PitchError {
            amplitude: 3.0e-6,
            period: 0.005,
        }
        .into(),
        PositionDependentFriction {
            linear: 0.8,
            quadratic: None,
        }
        .into(),
        FrictionDrift {
            gain: 0.4,
            time_constant: 20.0,
            viscous_gain: None,
        }
        .into(),
        TorqueSaturation {
            torque_saturation: 1.5e-5,
        }
        .into(),
        Delay { delay: 3.0e-4 }.into(),
    ];
    assert_eq!(actual.effects.list(), effects);
    assert_eq!(axis.declared.last(), Some(&EffectName::Backlash));
    assert_eq!(axis.declared.len(), 6);
}

#[test]
fn a_vertical_axis_and_one_like_it_are_read_as_then() {
    let machine = machine(VERTICAL);
    let [z, z2] = machine.axes.as_slice() else {
        panic!("two axes");
    };
    assert_eq!((machine.seed, machine.period_s), (0, 0.5e-3));
    let mounting = Mounting {
        gravity_n: -2500.0,
        brake: Some(BrakeParameters {
            rated_force_n: 4000.0,
            open_s: 0.030,
            close_s: 0.040,
            rise_s: 0.01,
        }),
        stops: Some(Stops {
            position_m: 0.3,
            stiffness_n_per_m: 1.0e7,
            damping_n_s_per_m: 1.0e5,
        }),
        start_m: 0.1,
        motor_zero_m: 0.1,
        load_zero_m: 0.0,
    };
    assert_eq!(
        (z.actual.mounting, z2.actual.mounting),
        (mounting, mounting)
    );
    let sliding = Sliding {
        coulomb_n: 350.0,
        static_n: 420.0,
        stribeck_velocity_m_per_s: 2.0e-3,
        stribeck_exponent: 2.0,
        stribeck_lag_s: 0.0,
        stribeck_lag_growth: 0.0,
        viscous_n_s_per_m: 1800.0,
        coulomb_asymmetry: 0.1,
        viscous_asymmetry: -0.2,
        quadratic_drag_n_s2_per_m2: 900.0,
    };
    assert_eq!(z.actual.sliding, sliding);
    let elements = Law::MaxwellSlip {
        stiffness_n_per_m: vec![2.0e7, 1.0e7, 5.0e6],
        share: vec![0.5, 0.3, 0.2],
    };
    assert_eq!((&z.actual.law, &z2.actual.law), (&elements, &Law::Coulomb));
    assert_eq!(
        (z2.actual.sliding.coulomb_n, z2.actual.sliding.static_n),
        (200.0, 200.0)
    );
    assert_eq!((z2.limits, z2.gains), (z.limits, z.gains));
    assert!(z.actual.effects.list().is_empty() && z2.actual.effects.list().is_empty());
}
