//! The control law of one axis: `step(&Config, &mut State, &Input) -> Output`.
//!
//! It sits between the feedback and the torque frame of one cycle. Fixed point throughout, no
//! clock, no input or output, no allocation, no float, no panic path. Configuration, state, input
//! and output are four types; physical units meet machine units on the host side only.
//!
//! ```text
//!              ┌─ next position ─▶ reversal that counts ─▶ pulse ──┐
//!              ├─ velocity ────────────────────────────────────────┤
//! [reference] ─┼─ acceleration ────────────────────────────────────┼▶ cascade ─▶ filter ─▶ torque
//!              ├─ all of it ─▶ friction model ─▶ torque, wind-up ──┤
//!              ├─ next position ─▶ ripple ─▶ torque ───────────────┤
//!              └─ position + backlash offset − measurement ─▶ error ┘
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
pub mod direction;
pub mod filter;
pub mod friction;
pub mod pulse;
pub mod reference;
pub mod ripple;
mod root;
pub mod units;

use backlash::{BacklashConfig, BacklashState};
use cascade::{CascadeConfig, CascadeInput, CascadeState};
use direction::{Direction, DirectionMemory, Turns};
use filter::{FilterConfig, FilterState};
use fixed::types::I8F24;
use friction::{Ahead, Feedforward, FrictionConfig, FrictionState, Progress};
use pulse::{PulseConfig, PulseState, Setpoint};
use reference::{Reference, ReferenceConfig};
use ripple::RippleConfig;
use units::{Acceleration, Position, PositionError, Torque, Velocity};

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
    /// The reversal unit.
    pub pulse: PulseConfig,
    /// Backlash compensation.
    pub backlash: BacklashConfig,
    /// Coulomb feedforward: this torque in the commanded direction; zero switches it off.
    pub coulomb: Torque,
    /// Friction model: what it says is fed forward.
    pub friction: Option<FrictionConfig>,
    /// Ripple of the torque over the position.
    pub ripple: RippleConfig,
    /// Torque filter.
    pub filter: FilterConfig,
}

impl Config {
    /// The model of friction whose level is refined at turns.
    fn refined(&self) -> Option<&FrictionConfig> {
        let model = self.friction.as_ref();
        model.filter(|model| model.tuning.per_micro_nm != 0)
    }

    fn asks_for_turns(&self) -> bool {
        !self.pulse.is_off() || self.refined().is_some()
    }
}

/// Everything that the law remembers.
#[derive(Clone, Copy, Debug, Default)]
pub struct State {
    direction: DirectionMemory,
    turns: Turns,
    pulse: PulseState,
    backlash: BacklashState,
    friction: FrictionState,
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
        self.friction
    }

    /// The same with what is known of the friction: it is a state of the axis, and stays when
    /// torque goes and comes. The integral holds what the model does not.
    #[must_use]
    pub fn with_friction(self, friction: FrictionState) -> Self {
        Self {
            cascade: self.cascade.taking(friction.held().reversed()),
            friction,
            ..self
        }
    }

    /// One cycle without torque: friction goes along with what is measured.
    pub fn follow(&mut self, config: &Config, measured: Position) {
        match &config.friction {
            Some(model) => self.friction.follow(model, measured),
            None => self.friction.forget(),
        }
    }

    /// What the friction model adds. Where it was switched off the integral takes over what the
    /// elements held.
    fn model(&mut self, config: &Config, reference: &Reference) -> Feedforward {
        let friction = &mut self.friction;
        if let Some(model) = &config.friction {
            return friction.step(model, reference);
        }
        if friction.is_known() {
            self.cascade = self.cascade.taking(friction.held());
            friction.forget();
        }
        Feedforward::default()
    }

    /// What the setpoint does, as far as somebody asks for its turns.
    fn setpoint(&mut self, config: &Config, reference: &Reference) -> Setpoint {
        let turns = &mut self.turns;
        if !config.asks_for_turns() {
            *turns = Turns::default();
            return Setpoint::Moves;
        }
        let config = &config.pulse;
        let to = reference.position.after(reference.next_velocity);
        match turns.reversal(config.shortest_way, to) {
            Some(direction) => Setpoint::Turns(direction),
            None if turns.has_stood(config.stop_cycles) => Setpoint::Stopped,
            None => Setpoint::Moves,
        }
    }

    /// Refines the model's level by what the loop did in a cycle.
    fn refine(
        &mut self,
        config: &Config,
        (setpoint, position): (Setpoint, Position),
        limited: bool,
    ) {
        let Some(model) = config.refined() else {
            return;
        };
        let turned = match setpoint {
            Setpoint::Turns(direction) => Some(direction),
            Setpoint::Moves | Setpoint::Stopped => None,
        };
        let progress = Progress {
            turned,
            position,
            has_stopped: setpoint == Setpoint::Stopped,
            is_limited: limited,
            integral: self.cascade.integral(),
        };
        self.friction.refine(model, &progress);
    }

    /// The parameters are other ones: what was refined of the model's level is not known of them.
    pub fn forget_level(&mut self) {
        self.friction.forget_level();
    }

    /// The refined factor on the levels of the friction model.
    #[must_use]
    pub fn level(&self) -> I8F24 {
        self.friction.level()
    }

    /// The reference begins anew, where the axis is: it has not come from anywhere, and no turn
    /// before this tells anything.
    pub fn begin_anew(&mut self) {
        self.turns = Turns::default();
        self.friction.break_off();
    }

    /// Nobody knows any more where the axis is.
    pub fn forget_friction(&mut self) {
        self.friction.forget();
    }

    /// Where the backlash unit has the motor, beside the setpoint.
    #[must_use]
    pub const fn backlash_offset(&self) -> PositionError {
        self.backlash.offset()
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
    /// Commanded torque.
    pub torque: Torque,
    /// Setpoint − measurement.
    pub following_error: PositionError,
    /// The torque stands at its limit.
    pub limited: bool,
}

/// One cycle of the control law.
///
/// The first step after a reset takes the motor to stand still: there is nothing to difference yet
/// ([`State::moving`] says otherwise).
///
/// The backlash unit turns round with the *next* velocity, as early as a reversal is known, but
/// adds its offset to the velocity of *this* cycle: position, velocity and offset go into the same
/// error, and the limits hold for their sum.
pub fn step(config: &Config, state: &mut State, input: &Input) -> Output {
    let reference = &input.reference;
    let motor_velocity = state
        .motor
        .map_or(Velocity::ZERO, |before| input.motor.step_from(before));
    state.motor = Some(input.motor);

    let direction = state.direction.after(reference.next_velocity);
    let setpoint = state.setpoint(config, reference);
    let change = reference.next_velocity.minus(reference.velocity);
    let change = (!reference.bridged).then_some(change);
    let pulse = state.pulse.step(&config.pulse, setpoint, change);
    let (offset, offset_velocity) =
        state
            .backlash
            .step(&config.backlash, direction, reference.velocity);

    let following_error = reference
        .position
        .error_from(measured(config.position_source, input));
    let model = state.model(config, reference);
    // With a model the motor is expected to have a velocity; without one its setpoint is that of
    // the table.
    let (expected, unexpected) = if config.friction.is_some() {
        (reference.velocity.plus(model.velocity), Velocity::ZERO)
    } else {
        (Velocity::ZERO, reference.velocity)
    };
    // With the load scale in the loop the table has to be at the setpoint itself; only the motor
    // gets the offset's velocity.
    let offset = match config.position_source {
        PositionSource::Motor => offset.plus(model.offset),
        PositionSource::Load => PositionError::ZERO,
    };
    let proposal = state.cascade.propose(
        &config.cascade,
        &CascadeInput {
            error: following_error.plus(offset),
            velocity_setpoint: unexpected.plus(offset_velocity).plus(pulse),
            expected_velocity: expected,
            acceleration: accelerated(config, reference),
            motor_velocity,
            friction: coulomb(config.coulomb, direction)
                .with(model.torque)
                .with(config.ripple.torque(reference)),
        },
    );
    let limit = config.cascade.torque_limit;
    let micro_nm = state.filter.step(&config.filter, proposal.torque, limit);
    let limited = state.cascade.settle(&config.cascade, &proposal, micro_nm);
    state.refine(config, (setpoint, reference.position), limited);
    Output {
        torque: Torque::from_micro_nm(micro_nm),
        following_error,
        limited,
    }
}

/// The acceleration of the setpoint when the torque acts: that of the middle of the torque's cycle,
/// and with a model of friction, which tells the lag of the current loop, so much later; a cycle at
/// most, since a step of the acceleration looks like jerk.
fn accelerated(config: &Config, reference: &Reference) -> Acceleration {
    let Some(model) = &config.friction else {
        return reference.acceleration;
    };
    let jerk = Velocity(reference.jerk.0);
    // x(k+1) is half a cycle before that middle.
    let lag = model.torque.cycles.wrapping_sub(Ahead::HALF_A_CYCLE);
    let lag = lag.min(I8F24::ONE);
    Acceleration(Velocity(reference.acceleration.0).plus(jerk.scaled(lag)).0)
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
