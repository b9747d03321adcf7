//! Friction as a state over displacement: what the model knows of it, fed forward.
//!
//! ```text
//! x(k+1) ─▶ elements ─▶ F(k+1) ─┬─▶ ahead of the reference ─▶ F when the torque acts ─▶ torque
//!                               └─▶ wind-up, gap ─▶ its change ─▶ speed of the motor
//! ```
//!
//! **Elements.** Friction is the sum of Maxwell-slip elements (springs that slip at a level), as in
//! Al-Bender, Lampaert, Swevers, "The generalized Maxwell-slip model", IEEE TAC 50 (2005) 1883. In
//! presliding they follow Masing's rules by themselves; sliding, their levels follow the speed
//! ([`LevelCurve`]), the place ([`LevelPlace`]), the direction ([`ByDirection`]) and what turns
//! have told ([`LevelTuning`]). Their only input is the way of the reference. There is no event, so
//! nothing chatters: a setpoint that flips one count moves a spring by one count.
//!
//! **Wind-up.** The screw transmits the friction of the table and is wound up by it, `F / K`; that
//! of the motor's own side winds nothing up. When friction changes sign the motor has to go that
//! way in addition, and across the gap where there is one ([`Screw`], [`Gap`]): its change belongs
//! to the speed setpoint, in time with the encoders, and its acceleration takes torque.
//!
//! **Time.** The elements stand at x(k+1), the newest setpoint. What acts later, from k + 1 to
//! k + 2 and after the lag of the current loop, is taken from a look ahead along the reference's
//! velocity and acceleration ([`Ahead`]), which leaves the elements where they are.

use fixed::types::{I8F24, I24F8, I40F24};

use crate::reference::Reference;
use crate::units::{
    Acceleration, AccelerationGain, Coarse, Position, PositionError, Torque, Velocity,
    VelocityGain, narrowed,
};

mod by_direction;
mod element;
mod gap;
mod levels;
mod path;
mod place;
mod screw;
mod tuning;

pub use by_direction::ByDirection;
use by_direction::of_direction;
use element::{Bends, Force};
pub use element::{ELEMENTS, Elements, STIFFNESS_BITS, SlipWays, Stiffnesses};
pub use gap::Gap;
use levels::{Factor, HIGHEST, times, within_way};
pub use levels::{LEVELS, LevelCurve, LevelLag};
pub use path::Ahead;
use path::Path;
pub use place::LevelPlace;
pub use screw::Screw;
use tuning::Tuner;
pub use tuning::{LevelTuning, Progress};

/// What the model says of the axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FrictionConfig {
    /// What holds the axis back.
    pub elements: Elements,
    /// Levels over the speed.
    pub levels: LevelCurve,
    /// How they fall behind it within a time, over a cycle.
    pub lag: LevelLag,
    /// One over the way within which they come after that, per 10 nm; zero: at once.
    pub lag_per_way: I8F24,
    /// Levels along the travel.
    pub place: LevelPlace,
    /// Levels and ways by direction.
    pub by_direction: ByDirection,
    /// How they are refined.
    pub tuning: LevelTuning,
    /// Viscous torque per velocity, forward and backward.
    pub viscous: [VelocityGain; 2],
    /// From x(k+1) to when the torque acts.
    pub torque: Ahead,
    /// How the levels fall behind one cycle farther; way and velocity there follow from that.
    pub lag_after: LevelLag,
    /// Friction has a damping in presliding: its rate of change counts so many cycles.
    pub damping_cycles: I8F24,
    /// How much farther than the table the motor stands.
    pub screw: Screw,
    /// The wind-up follows the rate of change of friction, so many cycles of it; the damping of
    /// presliding makes them more, that of the screw less.
    pub windup_cycles: I8F24,
    /// Torque per acceleration of the motor alone.
    pub motor_inertia: AccelerationGain,
}

impl FrictionConfig {
    fn viscous(&self, velocity: Velocity) -> Coarse {
        of_direction(&self.viscous, velocity).coarse(velocity)
    }
}

/// Where the elements stand.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FrictionState {
    /// Where they were last; `None`: nothing is known of them, and they begin where the axis is.
    at: Option<Position>,
    stand: Stand,
    recent: Option<Recent>,
    tuner: Tuner,
}

/// How the elements stand somewhere.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Stand {
    bends: Bends,
    /// What they hold.
    held: Force,
    /// Factor on the levels; `None`: that of the speed.
    factor: Option<Factor>,
}

/// Friction of both sides, and how much farther than the table the motor stands with it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Push {
    all: Coarse,
    ahead: Velocity,
}

/// The last cycles: how much farther than the table the motor stood, and what acted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Recent {
    before: Velocity,
    present: Velocity,
    next: Velocity,
    acting: Push,
    /// Second difference of the way that acted.
    turn: Velocity,
}

/// What a cycle is at, wherever it looks.
#[derive(Clone, Copy, Debug)]
struct Cycle {
    /// Factor on the levels of the place and of what turns have told.
    scale: I8F24,
    /// Factor on the levels at standstill.
    at_rest: I8F24,
    /// What the screw transmits beside friction.
    beside: Coarse,
}

/// A way from where the elements stand.
#[derive(Clone, Copy, Debug)]
struct Look {
    path: Path,
    /// Velocity at its end.
    end: Velocity,
    /// How the levels fall behind on it.
    lag: LevelLag,
}

/// What the model adds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Feedforward {
    /// Torque that overcomes friction and winds the screw up.
    pub torque: Torque,
    /// Velocity of the motor in addition to that of the table.
    pub velocity: Velocity,
    /// Way of the motor in addition to that of the table.
    pub offset: PositionError,
}

impl FrictionState {
    /// One cycle of an axis that follows a reference.
    pub fn step(&mut self, config: &FrictionConfig, reference: &Reference) -> Feedforward {
        let velocity = reference.next_velocity;
        let acceleration = reference.acceleration;
        let position = reference.position.after(velocity);
        let cycle = self.cycle(config, position, acceleration);
        let half = Velocity(acceleration.0).halved();
        let (begin, end) = (velocity.minus(half), velocity.plus(half));
        let way = self.way_to(position);
        let direction = &config.by_direction;
        let path = Path::between(direction, begin, end, I8F24::ONE, way);
        let lag = config.lag;
        self.at = Some(position);
        self.stand.go(config, &cycle, &Look { path, end, lag });
        let next = self.stand.push(config, &cycle, end).ahead;
        let look = |cycles: I8F24, lag: LevelLag, way: Velocity, there: Velocity| {
            let path = Path::between(direction, end, there, cycles, way);
            let (mut stand, end) = (self.stand, there);
            stand.go(config, &cycle, &Look { path, end, lag });
            stand.push(config, &cycle, end)
        };
        let ahead = &config.torque;
        let way = ahead.way(velocity, acceleration);
        let there = ahead.velocity(velocity, acceleration);
        let acting = look(ahead.cycles, ahead.lag, way, there);
        let way = way.plus(there).plus(half);
        let there = there.plus(Velocity(acceleration.0));
        let cycles = ahead.cycles.wrapping_add(I8F24::ONE);
        let after = look(cycles, config.lag_after, way, there);
        self.feedforward(config, next, [acting, after])
    }

    /// What is fed forward with the way of the motor in the next cycle, and what acts then and one
    /// cycle later.
    fn feedforward(
        &mut self,
        config: &FrictionConfig,
        next: Velocity,
        [acting, after]: [Push; 2],
    ) -> Feedforward {
        let before = self
            .recent
            .unwrap_or_else(|| Recent::steady(next, acting, after));
        let rise = acting.ahead.minus(before.acting.ahead);
        let turn = after.ahead.minus(acting.ahead).minus(rise);
        self.recent = Some(Recent {
            before: before.present,
            present: before.next,
            next,
            acting,
            turn,
        });
        let change = before.next.minus(before.present);
        let bend = next
            .minus(before.next)
            .minus(before.present.minus(before.before));
        // The wind-up is ahead of what acts.
        let turning = turn.minus(before.turn);
        let turn = turn.plus(turning.scaled(config.windup_cycles));
        let turn = config.screw.within_limit(turn);
        let inertia = config.motor_inertia.coarse(Acceleration(turn.0));
        let rate = after.all.saturating_sub(before.acting.all);
        let damping = damping(config.damping_cycles, rate);
        let torque = acting.all.saturating_add(damping).saturating_add(inertia);
        Feedforward {
            torque: Torque(I40F24::from_num(torque)),
            velocity: change.plus(bend.scaled(config.windup_cycles).halved()),
            offset: PositionError(I24F8::wrapping_from_num(before.next.0)),
        }
    }

    /// One cycle of an axis that is moved by others: the elements go along with what is measured.
    pub fn follow(&mut self, config: &FrictionConfig, measured: Position) {
        let cycle = self.cycle(config, measured, Acceleration::default());
        let way = self.way_to(measured);
        let look = Look {
            // A count that flickers would let ways that differ by direction creep.
            path: Path::straight(way),
            end: way,
            lag: config.lag,
        };
        self.at = Some(measured);
        self.stand.go(config, &cycle, &look);
        (self.recent, self.tuner) = (None, self.tuner.at_rest());
    }

    /// Nobody knows any more where the axis is: the elements are unknown, and grow into their
    /// levels as it moves. The level itself is what it was.
    pub fn forget(&mut self) {
        *self = Self {
            tuner: self.tuner.at_rest(),
            ..Self::default()
        };
    }

    /// The model is another one: what was refined of the level is not known of it.
    pub fn forget_level(&mut self) {
        self.tuner = Tuner::default();
    }

    /// What a turn before this would tell is not known.
    pub fn break_off(&mut self) {
        self.tuner = self.tuner.at_rest();
    }

    /// Refines the level by what the loop did.
    pub fn refine(&mut self, config: &FrictionConfig, progress: &Progress) {
        self.tuner.step(config.tuning, progress);
    }

    /// The refined factor on all levels.
    #[must_use]
    pub fn level(&self) -> I8F24 {
        self.tuner.factor()
    }

    fn way_to(&self, position: Position) -> Velocity {
        self.at
            .map_or(Velocity::ZERO, |before| position.step_from(before))
    }

    fn cycle(
        &self,
        config: &FrictionConfig,
        position: Position,
        acceleration: Acceleration,
    ) -> Cycle {
        let place = config.place.at(position).min(HIGHEST);
        let scale = times(place, self.tuner.factor()).min(HIGHEST);
        Cycle {
            scale,
            at_rest: times(config.levels.at_rest(), scale).min(HIGHEST),
            beside: config.screw.beside_friction(acceleration),
        }
    }

    /// Whether anything is known of the elements.
    #[must_use]
    pub const fn is_known(&self) -> bool {
        self.at.is_some()
    }

    /// What the elements hold.
    #[must_use]
    pub fn held(&self) -> Torque {
        Torque(I40F24::from_num(self.stand.held.all))
    }
}

impl Stand {
    /// It goes a way: the elements and what they hold, and what their levels have by direction
    /// beyond that at rest.
    #[inline(never)]
    fn go(&mut self, config: &FrictionConfig, cycle: &Cycle, look: &Look) {
        let aim = times(config.levels.at(look.end), cycle.scale).min(HIGHEST);
        let before = self.factor.unwrap_or(Factor::at(aim));
        let way = within_way(look.path.length(), config.lag_per_way);
        let factor = before.passed(look.lag, way, aim);
        self.factor = Some(factor);
        let times = factor.on_levels();
        self.bends.take(&config.elements.ways, &look.path, times);
        let held = self.bends.force(&config.elements);
        let by_direction = config.by_direction.torque(factor.acting, cycle.at_rest);
        self.held = Force {
            all: held.all.saturating_add(by_direction),
            ..held
        };
    }

    /// What it takes there at a velocity.
    fn push(&self, config: &FrictionConfig, cycle: &Cycle, velocity: Velocity) -> Push {
        let viscous = config.viscous(velocity);
        let table = self.held.table.saturating_add(viscous);
        Push {
            all: self.held.all.saturating_add(viscous),
            ahead: config.screw.way(table, cycle.beside, velocity),
        }
    }
}

impl Push {
    /// What was before this, where it changes evenly to another.
    fn before(self, after: Self) -> Self {
        let twice = self.all.saturating_add(self.all);
        Self {
            all: twice.saturating_sub(after.all),
            ahead: self.ahead.plus(self.ahead).minus(after.ahead),
        }
    }
}

impl Recent {
    /// What was where the motor stood still beside the table, and what acts changes evenly.
    fn steady(next: Velocity, acting: Push, after: Push) -> Self {
        Self {
            before: next,
            present: next,
            next,
            acting: acting.before(after),
            turn: Velocity::ZERO,
        }
    }
}

/// The change over two cycles times a number of them.
fn damping(cycles: I8F24, change: Coarse) -> Coarse {
    // 30.2 bits times 8.24 bits: 38.26 bits; one bit less is half of it.
    Coarse::from_bits(narrowed::<25>(change.wide_mul(cycles).to_bits()))
}
