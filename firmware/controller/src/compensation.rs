//! What is added to the law: the reversal unit, backlash compensation, Coulomb torque, the friction
//! model and ripple.
//!
//! ```text
//!              ┌─ next position ─▶ reversal that counts ─▶ pulse ──┐
//! [reference] ─┼─ velocity, direction ─▶ backlash offset ──────────┤
//!              ├─ all of it ─▶ friction model ─▶ torque, wind-up ──┼▶ Added
//!              └─ next position ─▶ ripple ─▶ torque ───────────────┘
//! ```
//!
//! The backlash unit turns round with the *next* velocity, as early as a reversal is known, but
//! adds its offset to the velocity of *this* cycle: position, velocity and offset go into the same
//! error, and the limits hold for their sum.

use fixed::types::I8F24;

use crate::PositionSource;
use crate::backlash::{BacklashConfig, BacklashState};
use crate::direction::{Direction, DirectionMemory, Turns};
use crate::friction::{Ahead, Feedforward, FrictionConfig, FrictionState, Progress};
use crate::pulse::{PulseConfig, PulseState, Setpoint};
use crate::reference::Reference;
use crate::ripple::RippleConfig;
use crate::units::{Acceleration, Position, PositionError, Torque, Velocity};

/// What is known of the axis beside its gains; each part is off by default.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Compensation {
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
}

impl Compensation {
    /// Whether every part is off.
    #[must_use]
    pub fn is_off(&self) -> bool {
        self.pulse.is_off()
            && self.backlash.is_off()
            && self.coulomb == Torque::ZERO
            && self.friction.is_none()
            && self.ripple.is_off()
    }

    /// The model of friction whose level is refined at turns.
    fn refined(&self) -> Option<&FrictionConfig> {
        let model = self.friction.as_ref();
        model.filter(|model| model.tuning.per_micro_nm != 0)
    }

    fn asks_for_turns(&self) -> bool {
        !self.pulse.is_off() || self.refined().is_some()
    }
}

/// What compensations remember.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct CompensationState {
    pub(crate) friction: FrictionState,
    direction: DirectionMemory,
    turns: Turns,
    pulse: PulseState,
    backlash: BacklashState,
    /// Where nothing is compensated there is nothing left to forget.
    is_at_rest: bool,
}

/// What is added in a cycle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Added {
    /// Way of the motor beside the setpoint, where the motor is what follows it.
    pub(crate) offset: PositionError,
    /// Velocity setpoint, but for the position loop's part.
    pub(crate) velocity: Velocity,
    /// Velocity that the motor is expected to have, where a model tells it; not in the setpoint.
    pub(crate) expected_velocity: Velocity,
    /// Acceleration of the setpoint when the torque acts.
    pub(crate) acceleration: Acceleration,
    /// Torque from friction and ripple feedforward.
    pub(crate) torque: Torque,
    /// What the setpoint does, as far as somebody asks for its turns.
    pub(crate) setpoint: Setpoint,
}

impl Added {
    /// Nothing is: the setpoint itself.
    pub(crate) const fn nothing(reference: &Reference) -> Self {
        Self {
            offset: PositionError::ZERO,
            velocity: reference.velocity,
            expected_velocity: Velocity::ZERO,
            acceleration: reference.acceleration,
            torque: Torque::ZERO,
            setpoint: Setpoint::Moves,
        }
    }
}

impl CompensationState {
    /// Where the backlash unit has the motor, beside the setpoint.
    pub(crate) const fn backlash_offset(&self) -> PositionError {
        self.backlash.offset()
    }

    /// The reference begins anew, where the axis is: it has not come from anywhere, and no turn
    /// before this tells anything.
    pub(crate) fn begin_anew(&mut self) {
        self.turns = Turns::default();
        self.friction.break_off();
    }

    /// Friction as it was known elsewhere.
    pub(crate) const fn set_friction(&mut self, friction: FrictionState) {
        self.friction = friction;
        self.is_at_rest = false;
    }

    /// One cycle without torque: friction goes along with what is measured.
    pub(crate) fn follow(&mut self, model: Option<&FrictionConfig>, measured: Position) {
        match model {
            Some(model) => self.friction.follow(model, measured),
            None => self.friction.forget(),
        }
        self.is_at_rest = false;
    }

    /// Nothing is compensated; gives what the elements held, once.
    pub(crate) fn rest(&mut self, reference: &Reference) -> Option<Torque> {
        self.direction.take(reference.next_velocity);
        self.backlash.pass(reference.velocity);
        if self.is_at_rest {
            return None;
        }
        self.forget()
    }

    #[cold]
    fn forget(&mut self) -> Option<Torque> {
        (self.turns, self.pulse) = (Turns::default(), PulseState::default());
        self.is_at_rest = true;
        self.let_go()
    }

    /// What the elements held where the model was switched off.
    fn let_go(&mut self) -> Option<Torque> {
        if !self.friction.is_known() {
            return None;
        }
        let held = self.friction.held();
        self.friction.forget();
        Some(held)
    }

    /// One cycle; gives what the elements held beside it, where their model was switched off.
    pub(crate) fn step(
        &mut self,
        config: &Compensation,
        source: PositionSource,
        reference: &Reference,
    ) -> (Added, Option<Torque>) {
        self.is_at_rest = false;
        self.direction.take(reference.next_velocity);
        let direction = self.direction.last();
        let setpoint = self.setpoint(config, reference);
        let change = reference.next_velocity.minus(reference.velocity);
        let change = (!reference.bridged).then_some(change);
        let pulse = self.pulse.step(&config.pulse, setpoint, change);
        let (offset, offset_velocity) =
            self.backlash
                .step(&config.backlash, direction, reference.velocity);
        let (model, held) = match &config.friction {
            Some(model) => (self.friction.step(model, reference), None),
            None => (Feedforward::default(), self.let_go()),
        };
        // With a model the motor is expected to have a velocity; without one its setpoint is that
        // of the table.
        let (expected, unexpected) = if config.friction.is_some() {
            (reference.velocity.plus(model.velocity), Velocity::ZERO)
        } else {
            (Velocity::ZERO, reference.velocity)
        };
        let added = Added {
            // With the load scale in the loop the table has to be at the setpoint itself; only the
            // motor gets the offset's velocity.
            offset: match source {
                PositionSource::Motor => offset.plus(model.offset),
                PositionSource::Load => PositionError::ZERO,
            },
            velocity: unexpected.plus(offset_velocity).plus(pulse),
            expected_velocity: expected,
            acceleration: accelerated(config, reference),
            torque: coulomb(config.coulomb, direction)
                .with(model.torque)
                .with(config.ripple.torque(reference)),
            setpoint,
        };
        (added, held)
    }

    /// What the setpoint does, as far as somebody asks for its turns.
    fn setpoint(&mut self, config: &Compensation, reference: &Reference) -> Setpoint {
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
    pub(crate) fn refine(
        &mut self,
        config: &Compensation,
        (setpoint, position): (Setpoint, Position),
        (integral, is_limited): (Torque, bool),
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
            is_limited,
            integral,
        };
        self.friction.refine(model, &progress);
    }
}

/// The acceleration of the setpoint when the torque acts: that of the middle of the torque's cycle,
/// and with a model of friction, which tells the lag of the current loop, so much later; a cycle at
/// most, since a step of the acceleration looks like jerk.
fn accelerated(config: &Compensation, reference: &Reference) -> Acceleration {
    let Some(model) = &config.friction else {
        return reference.acceleration;
    };
    let jerk = Velocity(reference.jerk.0);
    // x(k+1) is half a cycle before that middle.
    let lag = model.torque.cycles.wrapping_sub(Ahead::HALF_A_CYCLE);
    let lag = lag.min(I8F24::ONE);
    Acceleration(Velocity(reference.acceleration.0).plus(jerk.scaled(lag)).0)
}

fn coulomb(torque: Torque, direction: Option<Direction>) -> Torque {
    match direction {
        Some(Direction::Positive) => torque,
        Some(Direction::Negative) => Torque(torque.0.wrapping_neg()),
        None => Torque::ZERO,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pulse::Shape;
    use fixed::types::{I2F30, I20F12};

    fn velocity(counts: i32) -> Velocity {
        Velocity(I20F12::from_num(counts))
    }

    /// A cycle at such a position, and so far on to the next.
    fn at(position: i64, next: i32) -> Reference {
        Reference {
            position: Position::from_counts(position),
            next_velocity: velocity(next),
            ..Reference::default()
        }
    }

    #[test]
    fn a_pulse_is_gone_once_nothing_was_compensated() {
        let compensation = Compensation {
            pulse: PulseConfig {
                shape: Shape {
                    amplitude: velocity(100),
                    decay: I2F30::from_num(0.95),
                    start_delay_cycles: 0,
                },
                stop_cycles: u16::MAX,
                ..PulseConfig::default()
            },
            ..Compensation::default()
        };
        let added = |state: &mut CompensationState, reference: Reference| {
            let (added, held) = state.step(&compensation, PositionSource::Load, &reference);
            assert_eq!(held, None);
            added.velocity
        };
        let mut state = CompensationState::default();
        assert_eq!(added(&mut state, at(0, 50)), Velocity::ZERO);
        assert_eq!(added(&mut state, at(50, 50)), Velocity::ZERO);
        assert_eq!(added(&mut state, at(100, -50)), velocity(-100));
        assert!(added(&mut state, at(50, -50)) < velocity(-90));
        assert_eq!(state.rest(&at(0, -50)), None);
        assert_eq!(added(&mut state, at(-50, -50)), Velocity::ZERO);
        // The direction is known all the same, and where the setpoint came from is not.
        assert_eq!(state.direction.last(), Some(Direction::Negative));
        assert_eq!(added(&mut state, at(-100, 50)), Velocity::ZERO);
        assert_eq!(added(&mut state, at(-50, -50)), velocity(-100));
    }
}
