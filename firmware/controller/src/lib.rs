//! The control law of one axis: `step(&Config, &mut State, &Input) -> Output`.
//!
//! It sits between the feedback and the torque frame of one cycle. Fixed point throughout, no
//! clock, no input or output, no allocation, no float, no panic path. Configuration, state, input
//! and output are four types; physical units meet machine units on the host side only.
//!
//! ```text
//! [reference] ─┬─ all of it ─▶ compensations ─▶ torque, velocity, offset ─┐
//!              ├─ velocity, acceleration ────────────────────────────────┼▶ cascade ─▶ filter
//!              └─ position + offset − measurement ─▶ error ──────────────┘             │
//!                                                                         torque ◀─────┘
//! ```
//!
//! Errors use the reference in time with the encoders (cycle k), the acceleration is that of the
//! time when the torque acts (k + 1 to k + 2), and a reversal is known one cycle ahead, from the
//! next velocity.
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
pub mod compensation;
pub mod direction;
pub mod filter;
pub mod friction;
pub mod pulse;
pub mod reference;
pub mod ripple;
mod root;
pub mod units;

use cascade::{CascadeConfig, CascadeInput, CascadeState};
use compensation::{Added, Compensation, CompensationState};
use filter::{FilterConfig, FilterState};
use fixed::types::I8F24;
use friction::{FrictionConfig, FrictionState};
use reference::{Reference, ReferenceConfig};
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
    /// Limits, ramps and setpoints: for [`reference::ReferenceState::step`], which comes first.
    pub reference: ReferenceConfig,
    /// Which encoder closes the position loop.
    pub position_source: PositionSource,
    /// Gains and limits.
    pub cascade: CascadeConfig,
    /// What is known of the axis beside that; `None`: nothing is, and the law is the plain one.
    pub compensation: Option<Compensation>,
    /// Torque filter.
    pub filter: FilterConfig,
}

impl Config {
    /// The friction model, where there is one.
    #[must_use]
    pub fn friction(&self) -> Option<&FrictionConfig> {
        self.compensation.as_ref()?.friction.as_ref()
    }
}

/// Everything that the law remembers.
#[derive(Clone, Copy, Debug, Default)]
pub struct State {
    compensation: CompensationState,
    cascade: CascadeState,
    filter: FilterState,
    motor: Option<Position>,
}

impl State {
    /// At standstill with a torque that holds the axis, as a vertical one needs: the integral and
    /// the filter begin with it.
    #[must_use]
    pub fn holding(torque: Torque) -> Self {
        Self {
            cascade: CascadeState::holding(torque),
            filter: FilterState::at_rest(torque),
            ..Self::default()
        }
    }

    /// In motion: the motor's history begins with a measured velocity, so that a stop out of motion
    /// starts without a kick.
    #[must_use]
    pub fn moving(self, motor: Position, velocity: Velocity) -> Self {
        Self {
            cascade: self.cascade.moving(velocity),
            motor: Some(motor.after(velocity.reversed())),
            ..self
        }
    }

    /// What is known of the friction.
    #[must_use]
    pub const fn friction(&self) -> FrictionState {
        self.compensation.friction
    }

    /// The same with what is known of the friction: it is a state of the axis, and stays when
    /// torque goes and comes. The integral holds what the model does not.
    #[must_use]
    pub fn with_friction(self, friction: FrictionState) -> Self {
        let mut own = Self {
            cascade: self.cascade.taking(friction.held().reversed()),
            ..self
        };
        own.compensation.set_friction(friction);
        own
    }

    /// One cycle without torque: friction goes along with what is measured.
    pub fn follow(&mut self, config: &Config, measured: Position) {
        self.compensation.follow(config.friction(), measured);
    }

    /// The parameters are other ones: what was refined of the model's level is not known of them.
    pub fn forget_level(&mut self) {
        self.compensation.friction.forget_level();
    }

    /// The refined factor on the levels of the friction model.
    #[must_use]
    pub fn level(&self) -> I8F24 {
        self.compensation.friction.level()
    }

    /// The reference begins anew, where the axis is: it has not come from anywhere, and no turn
    /// before this tells anything.
    pub fn begin_anew(&mut self) {
        self.compensation.begin_anew();
    }

    /// What elements held whose model was switched off: the integral takes it over.
    fn take_over(&mut self, held: Option<Torque>) {
        if let Some(held) = held {
            self.cascade = self.cascade.taking(held);
        }
    }

    /// Nobody knows any more where the axis is.
    pub fn forget_friction(&mut self) {
        self.compensation.friction.forget();
    }

    /// Where the backlash unit has the motor, beside the setpoint.
    #[must_use]
    pub const fn backlash_offset(&self) -> PositionError {
        self.compensation.backlash_offset()
    }
}

/// What comes in, once per cycle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Input {
    /// What to follow.
    pub reference: Reference,
    /// Motor encoder, as a position at the table.
    pub motor: Position,
    /// Load scale.
    pub load: Position,
}

/// What goes out, once per cycle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Output {
    /// Commanded torque, µN·m.
    pub micro_nm: i32,
    /// Setpoint − measurement.
    pub following_error: PositionError,
    /// The torque stands at its limit.
    pub limited: bool,
}

/// One cycle of the control law.
///
/// The first step after a reset takes the motor to stand still: there is nothing to difference yet
/// ([`State::moving`] says otherwise).
pub fn step(config: &Config, state: &mut State, input: &Input) -> Output {
    let reference = &input.reference;
    if let Some(compensation) = &config.compensation {
        return compensated(config, compensation, state, input);
    }
    let held = state.compensation.rest(reference);
    state.take_over(held);
    law(config, state, input, &Added::nothing(reference))
}

fn compensated(
    config: &Config,
    compensation: &Compensation,
    state: &mut State,
    input: &Input,
) -> Output {
    let reference = &input.reference;
    let (added, held) = state
        .compensation
        .step(compensation, config.position_source, reference);
    state.take_over(held);
    let output = law(config, state, input, &added);
    let did = (state.cascade.integral(), output.limited);
    let at = (added.setpoint, reference.position);
    state.compensation.refine(compensation, at, did);
    output
}

#[expect(
    clippy::inline_always,
    reason = "twice, so that the plain one adds no zeros"
)]
#[inline(always)]
fn law(config: &Config, state: &mut State, input: &Input, added: &Added) -> Output {
    let motor_velocity = state
        .motor
        .map_or(Velocity::ZERO, |before| input.motor.step_from(before));
    state.motor = Some(input.motor);
    let measured = measured(config.position_source, input);
    let following_error = input.reference.position.error_from(measured);
    let proposal = state.cascade.propose(
        &config.cascade,
        &CascadeInput {
            error: following_error.plus(added.offset),
            velocity_setpoint: added.velocity,
            expected_velocity: added.expected_velocity,
            acceleration: added.acceleration,
            motor_velocity,
            friction: added.torque,
        },
    );
    let limit = config.cascade.torque_limit;
    let micro_nm = state.filter.step(&config.filter, proposal.micro_nm, limit);
    let limited = state.cascade.settle(&config.cascade, &proposal, micro_nm);
    Output {
        micro_nm,
        following_error,
        limited,
    }
}

fn measured(source: PositionSource, input: &Input) -> Position {
    match source {
        PositionSource::Motor => input.motor,
        PositionSource::Load => input.load,
    }
}
