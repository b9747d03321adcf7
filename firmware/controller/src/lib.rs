//! The control law of one axis: `step(&Config, &mut State, &Input) -> Output`.
//!
//! It sits between the feedback and the torque frame of one cycle. Fixed point throughout, no clock, no input or output, no
//! allocation, no float, no panic path. Configuration, state, input and output are four types; physical units meet machine
//! units on the host side only.
//!
//! ```text
//!            ┌─ direction ─ reversal ─▶ pulse ──────────┐
//! setpoint ──┼─ difference ───────────▶ velocity ───────┼──▶ cascade ──▶ filter ──▶ torque
//!            ├─ second difference ────▶ acceleration ───┤
//!            └─ backlash offset − position ─▶ error ────┘
//! ```
#![cfg_attr(not(test), no_std)]
#![forbid(unsafe_code)]
#![deny(
    clippy::float_arithmetic,
    clippy::indexing_slicing,
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::arithmetic_side_effects,
    clippy::as_conversions
)]
#![cfg_attr(
    test,
    allow(
        clippy::unwrap_used,
        clippy::panic,
        clippy::arithmetic_side_effects,
        clippy::indexing_slicing,
        clippy::float_arithmetic
    )
)]

pub mod backlash;
pub mod cascade;
pub mod direction;
pub mod filter;
pub mod pulse;
pub mod units;

use backlash::{BacklashConfig, BacklashState};
use cascade::{CascadeConfig, CascadeInput, CascadeState};
use direction::{Direction, DirectionMemory};
use filter::{FilterConfig, FilterState};
use pulse::{PulseConfig, PulseState};
use units::{Position, PositionError, Torque, Velocity};

/// Which encoder closes the position loop.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PositionSource {
    /// Motor encoder: the mechanics are outside the loop.
    Motor,
    /// Load scale: the mechanics are inside the loop.
    #[default]
    Load,
}

/// Everything that stays the same from cycle to cycle.
#[derive(Clone, Debug, PartialEq)]
pub struct Config {
    /// Which encoder closes the position loop.
    pub position_source: PositionSource,
    /// Gains and limits.
    pub cascade: CascadeConfig,
    /// The reversal unit.
    pub pulse: PulseConfig,
    /// Backlash compensation.
    pub backlash: BacklashConfig,
    /// Coulomb feedforward: this torque in the commanded direction; zero switches it off.
    pub coulomb: Torque,
    /// Torque filter.
    pub filter: FilterConfig,
}

/// Everything that the law remembers.
#[derive(Clone, Debug, Default)]
pub struct State {
    direction: DirectionMemory,
    pulse: PulseState,
    backlash: BacklashState,
    cascade: CascadeState,
    filter: FilterState,
    before: Option<Before>,
}

#[derive(Clone, Copy, Debug)]
struct Before {
    setpoint: Position,
    velocity: Velocity,
    motor: Position,
}

/// What comes in, once per cycle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Input {
    /// Position setpoint of this cycle.
    pub setpoint: Position,
    /// Motor encoder, as a position at the table.
    pub motor: Position,
    /// Load scale.
    pub load: Position,
}

/// What goes out, once per cycle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Output {
    /// Commanded torque.
    pub torque: Torque,
    /// Setpoint − measurement.
    pub following_error: PositionError,
    /// The torque stands at its limit.
    pub limited: bool,
}

/// One cycle of the control law.
///
/// The first step after a reset takes the present position as standstill: it has no velocity to difference.
pub fn step(config: &Config, state: &mut State, input: &Input) -> Output {
    let now = differences(state.before, input);
    state.before = Some(Before { setpoint: input.setpoint, velocity: now.velocity, motor: input.motor });

    let reversal = state.direction.reversal(now.velocity);
    let direction = state.direction.last();
    let pulse = state.pulse.step(&config.pulse, reversal);
    let (offset, offset_velocity) = state.backlash.step(&config.backlash, direction, now.velocity);

    let following_error = input.setpoint.error_from(measured(config.position_source, input));
    // With the load scale in the loop the table has to be at the setpoint itself; only the motor gets the offset's velocity.
    let offset = match config.position_source {
        PositionSource::Motor => offset,
        PositionSource::Load => PositionError::ZERO,
    };
    let proposal = state.cascade.propose(
        &config.cascade,
        &CascadeInput {
            error: following_error.plus(offset),
            velocity_setpoint: now.velocity.plus(offset_velocity).plus(pulse),
            acceleration: now.acceleration,
            motor_velocity: now.motor_velocity,
            friction: coulomb(config.coulomb, direction),
        },
    );
    let limit = config.cascade.torque_limit;
    let torque = state.filter.step(&config.filter, proposal.torque.limited(limit), limit);
    let limited = state.cascade.settle(&config.cascade, &proposal, torque);
    Output { torque, following_error, limited }
}

struct Differences {
    velocity: Velocity,
    acceleration: units::Acceleration,
    motor_velocity: Velocity,
}

fn differences(before: Option<Before>, input: &Input) -> Differences {
    let Some(before) = before else {
        return Differences {
            velocity: Velocity::ZERO,
            acceleration: units::Acceleration::default(),
            motor_velocity: Velocity::ZERO,
        };
    };
    let velocity = input.setpoint.step_from(before.setpoint);
    Differences {
        velocity,
        acceleration: velocity.step_from(before.velocity),
        motor_velocity: input.motor.step_from(before.motor),
    }
}

fn measured(source: PositionSource, input: &Input) -> Position {
    match source {
        PositionSource::Motor => input.motor,
        PositionSource::Load => input.load,
    }
}

fn coulomb(torque: Torque, direction: Option<Direction>) -> Torque {
    match direction {
        Some(Direction::Positive) => torque,
        Some(Direction::Negative) => torque.reversed(),
        None => Torque::ZERO,
    }
}
