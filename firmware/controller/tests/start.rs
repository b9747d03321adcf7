//! The law starts without a kick: at standstill with a torque that holds the axis, and out of
//! motion.

use controller::cascade::CascadeConfig;
use controller::filter::FilterConfig;
use controller::reference::{Mode, Ramp, ReferenceConfig, ReferenceInput, ReferenceState};
use controller::units::{
    AccelerationGain, Position, PositionGain, Torque, TorqueLimit, Velocity, VelocityGain,
};
use controller::{Config, Input, PositionSource, State};
use fixed::types::{I2F30, I8F24, I20F12, I24F8};

fn per_cycle(counts: i32) -> Velocity {
    Velocity(I20F12::from_num(counts))
}

/// The reference axis' gains at 1 kHz; a low-pass of one pole in the torque.
fn config() -> Config {
    let ramp = Ramp {
        deceleration: per_cycle(500),
        jerk: per_cycle(100),
    };
    Config {
        reference: ReferenceConfig {
            velocity_limit: per_cycle(50_000),
            acceleration_limit: per_cycle(500),
            step: per_cycle(50),
            position_min: Position::from_counts(-100_000_000),
            position_max: Position::from_counts(100_000_000),
            quick_stop: ramp,
            slow_down: ramp,
            filter_log2: 0,
            setpoint_cycles: 1,
            middle: ReferenceConfig::NOWHERE,
        },
        position_source: PositionSource::Load,
        cascade: CascadeConfig {
            position_gain: PositionGain(I8F24::from_num(0.04)),
            velocity_gain: VelocityGain(I20F12::from_num(2794)),
            integral_gain: VelocityGain(I20F12::from_num(131.6)),
            acceleration_gain: AccelerationGain(I24F8::from_num(14_827)),
            velocity_filter: I2F30::from_num(0.6),
            torque_limit: TorqueLimit::from_micro_nm(14_323_944),
        },
        compensation: None,
        filter: FilterConfig::new([1 << 27, 0, 0, 3 << 27, 0]).unwrap(),
    }
}

#[test]
fn at_standstill_the_first_torque_is_the_one_that_holds() {
    let (config, here) = (config(), Position::from_counts(123_456));
    let holding = Torque::from_micro_nm(3_978_873);
    let (mut stage, mut law) = (
        ReferenceState::at(here, Velocity::ZERO),
        State::holding(holding),
    );
    for _ in 0..10 {
        let reference = stage.step(
            &config.reference,
            &ReferenceInput {
                preview: Some(here),
                ..Default::default()
            },
        );
        let output = controller::step(
            &config,
            &mut law,
            &Input {
                reference,
                motor: here,
                load: here,
            },
        );
        assert!(
            (output.micro_nm - 3_978_873).abs() <= 1,
            "{}",
            output.micro_nm
        );
    }
}

/// First torque of a stop from 0.4 m/s, µN·m: the axis goes on as measured in that cycle.
fn first_torque_of_a_stop(begun: &State) -> i32 {
    let (config, here, speed) = (config(), Position::from_counts(123_456), per_cycle(40_000));
    let (mut stage, mut law) = (ReferenceState::at(here, speed), *begun);
    let input = ReferenceInput {
        mode: Mode::QuickStop,
        ..Default::default()
    };
    let reference = stage.step(&config.reference, &input);
    controller::step(
        &config,
        &mut law,
        &Input {
            reference,
            motor: here,
            load: here,
        },
    )
    .micro_nm
}

#[test]
fn out_of_motion_the_first_torque_is_that_of_the_ramp_alone() {
    let here = Position::from_counts(123_456);
    // The ramp begins with −100 counts per cycle², a step for the feedforward (above 50): Ja · 100,
    // of which the filter passes a quarter at once.
    let torque = first_torque_of_a_stop(&State::default().moving(here, per_cycle(40_000)));
    assert!((torque + 14_827 * 100 / 4).abs() <= 2, "{torque} µN·m");
    // Without the measured velocity the loop believes that the axis stands, and kicks with the
    // limit.
    assert_eq!(first_torque_of_a_stop(&State::default()), 14_323_944 / 4);
}
