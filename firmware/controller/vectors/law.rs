//! The law of the golden vectors: its configuration and one cycle of it. Part of the test that
//! writes the vectors (`tests/twin.rs`) and of the image that runs them on an emulated Cortex-M4.
#![allow(
    unreachable_pub,
    dead_code,
    reason = "part of two programs, of which each uses what it needs"
)]

use controller::cascade::CascadeConfig;
use controller::compensation::Compensation;
use controller::filter::FilterConfig;
use controller::pulse::{PulseConfig, Shape};
use controller::reference::{Ramp, ReferenceConfig, ReferenceInput, ReferenceState};
use controller::units::{
    AccelerationGain, Position, PositionError, PositionGain, Torque, TorqueLimit, Velocity,
    VelocityGain,
};
use controller::{Config, Input, PositionSource, State};
use fixed::types::{I2F30, I8F24, I20F12, I24F8, I56F8};

const POSITION_GAIN: f64 = 0.040;
const VELOCITY_GAIN: f64 = 2794.0;
const INTEGRAL_GAIN: f64 = 131.6;
const ACCELERATION_GAIN: f64 = 14_827.0;
const FILTER_SHARE: f64 = 0.6;
/// Torque limit, µN·m.
pub const LIMIT: f64 = 14_323_944.0;
const PULSE_HEIGHT: f64 = 178.0;
const PULSE_DECAY: f64 = 0.988_5;
const COULOMB: f64 = 636_620.0;

/// The motions of these tests are those of no axis: every setpoint passes, and every change of
/// acceleration is jerk.
const UNLIMITED: ReferenceConfig = ReferenceConfig {
    velocity_limit: Velocity(I20F12::MAX),
    acceleration_limit: Velocity(I20F12::MAX),
    step: Velocity(I20F12::MAX),
    position_min: Position(I56F8::MIN),
    position_max: Position(I56F8::MAX),
    quick_stop: Ramp {
        deceleration: Velocity(I20F12::MAX),
        jerk: Velocity::ZERO,
    },
    slow_down: Ramp {
        deceleration: Velocity(I20F12::MAX),
        jerk: Velocity::ZERO,
    },
    filter_log2: 0,
    setpoint_cycles: 1,
    middle: ReferenceConfig::NOWHERE,
};

/// Every part of the base law on, and pulse and Coulomb feedforward.
pub fn config(source: PositionSource) -> Config {
    Config {
        reference: UNLIMITED,
        position_source: source,
        cascade: CascadeConfig {
            position_gain: PositionGain(I8F24::from_num(POSITION_GAIN)),
            velocity_gain: VelocityGain(I20F12::from_num(VELOCITY_GAIN)),
            integral_gain: VelocityGain(I20F12::from_num(INTEGRAL_GAIN)),
            acceleration_gain: AccelerationGain(I24F8::from_num(ACCELERATION_GAIN)),
            velocity_filter: I2F30::from_num(FILTER_SHARE),
            torque_limit: TorqueLimit::from_micro_nm(LIMIT as i32),
        },
        compensation: Some(Compensation {
            pulse: PulseConfig {
                shape: Shape {
                    amplitude: Velocity(I20F12::from_num(PULSE_HEIGHT)),
                    decay: I2F30::from_num(PULSE_DECAY),
                    start_delay_cycles: 0,
                },
                schedule: None,
                shortest_way: PositionError::ZERO,
                stop_cycles: u16::MAX,
            },
            coulomb: Torque::from_micro_nm(COULOMB as i32),
            ..Compensation::default()
        }),
        filter: FilterConfig::OFF,
    }
}

/// One cycle of stage and law: the preview is the setpoint of the next cycle.
pub fn torque(
    config: &Config,
    stage: &mut ReferenceState,
    law: &mut State,
    preview: Position,
    at: [Position; 2],
) -> i32 {
    let input = ReferenceInput {
        preview: Some(preview),
        ..ReferenceInput::default()
    };
    let [motor, load] = at;
    let reference = stage.step(&config.reference, &input);
    controller::step(
        config,
        law,
        &Input {
            reference,
            motor,
            load,
        },
    )
    .micro_nm
}
