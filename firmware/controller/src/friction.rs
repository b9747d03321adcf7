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
//! way in addition, and across the gap where there is one ([`Screw`]): its change belongs to the
//! speed setpoint, in time with the encoders, and its acceleration takes torque.
//!
//! **Time.** The elements stand at x(k+1), the newest setpoint. What acts later, from k + 1 to
//! k + 2 and after the lag of the current loop, is taken from a look ahead along the reference's
//! velocity and acceleration ([`Ahead`]), which leaves the elements where they are.

use fixed::types::{I8F24, I20F12, I24F8, I30F2, I40F24};

use crate::reference::Reference;
use crate::units::{
    Acceleration, AccelerationGain, Position, PositionError, Torque, Velocity, VelocityGain,
};

mod by_direction;
mod element;
mod levels;
mod path;
mod place;
mod screw;
mod tuning;

pub use by_direction::ByDirection;
pub use element::Element;
use element::Strain;
use levels::{Factor, times, within_way};
pub use levels::{LEVELS, LevelCurve, LevelLag};
pub use path::Ahead;
use path::Path;
pub use place::LevelPlace;
pub use screw::Screw;
use tuning::Tuner;
pub use tuning::{LevelTuning, Progress};

/// Elements of the model.
pub const ELEMENTS: usize = 10;

/// What the model says of the axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FrictionConfig {
    /// Elements; the sum of their levels is the Coulomb torque.
    pub elements: [Element; ELEMENTS],
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
    /// Viscous torque per velocity.
    pub viscous: VelocityGain,
    /// How much more of it there is forward than backward, halved.
    pub viscous_asymmetry: VelocityGain,
    /// From x(k+1) to when the torque acts.
    pub torque: Ahead,
    /// The same one cycle later.
    pub torque_after: Ahead,
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
    fn viscous_torque(&self, velocity: Velocity) -> Torque {
        let speed = Velocity(velocity.0.saturating_abs());
        let alike = self.viscous.times(velocity);
        alike.plus(self.viscous_asymmetry.times(speed))
    }
}

type Strains = [Strain; ELEMENTS];

/// Where the elements stand.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FrictionState {
    /// Where they were last; `None`: nothing is known of them, and they begin where the axis is.
    at: Option<Position>,
    strains: Strains,
    /// What they hold.
    held: Force,
    /// Factor on the levels; `None`: that of the speed.
    factor: Option<Factor>,
    recent: Option<Recent>,
    tuner: Tuner,
}

/// Friction of both sides of the screw, and what of it is the table's.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Force {
    all: Torque,
    table: Torque,
}

/// Friction of both sides, and how much farther than the table the motor stands with it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Push {
    all: Torque,
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
        let next_position = reference.position.after(velocity);
        let at_next = velocity.plus(half(acceleration));
        let begin = velocity.minus(half(acceleration));
        let way = self
            .at
            .map_or(Velocity::ZERO, |before| next_position.step_from(before));
        let path = Path::between(begin, at_next, I8F24::ONE, way).by(config.by_direction);
        let scale = self.scale(config, next_position);
        self.move_along(config, &path, next_position, (at_next, scale));
        let next = self.held.plus(config.viscous_torque(at_next));
        let next = config.screw.way(next.table, acceleration);
        let [acting, after] = [&config.torque, &config.torque_after].map(|ahead| {
            let force = self.ahead(config, ahead, (velocity, acceleration), scale);
            Push {
                all: force.all,
                ahead: config.screw.way(force.table, acceleration),
            }
        });
        let before = self.recent.unwrap_or(Recent {
            before: next,
            present: next,
            next,
            acting: acting.before(after),
            turn: Velocity::ZERO,
        });
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
        let turn = turn.plus(advanced(config.windup_cycles, turning.plus(turning)));
        let turn = config.screw.within_limit(turn);
        let inertia = config.motor_inertia.times(Acceleration(turn.0));
        let rate = after.all.minus(before.acting.all);
        Feedforward {
            torque: acting
                .all
                .plus(damping(config.damping_cycles, rate))
                .plus(inertia),
            velocity: change.plus(advanced(config.windup_cycles, bend)),
            offset: PositionError(I24F8::saturating_from_num(before.next.0)),
        }
    }

    /// One cycle of an axis that is moved by others: the elements go along with what is measured.
    pub fn follow(&mut self, config: &FrictionConfig, measured: Position) {
        let velocity = self
            .at
            .map_or(Velocity::ZERO, |before| measured.step_from(before));
        let scale = self.scale(config, measured);
        // A count that flickers would let ways that differ by direction creep.
        let path = Path::straight(velocity);
        self.move_along(config, &path, measured, (velocity, scale));
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

    /// The factor on the levels at a position.
    fn scale(&self, config: &FrictionConfig, position: Position) -> I8F24 {
        times(config.place.at(position), self.tuner.factor())
    }

    fn move_along(
        &mut self,
        config: &FrictionConfig,
        path: &Path,
        to: Position,
        pace: (Velocity, I8F24),
    ) {
        let factor = self.factor_after(config, path.length(), pace, config.lag);
        self.strains = self.strained(config, path, factor);
        self.held = force(config, &self.strains, factor, pace.1);
        (self.at, self.factor) = (Some(to), Some(factor));
    }

    /// The factor on the levels a way and the cycles of a lag later, at a velocity there and with a
    /// factor on those of that velocity.
    fn factor_after(
        &self,
        config: &FrictionConfig,
        way: Velocity,
        (velocity, scale): (Velocity, I8F24),
        lag: LevelLag,
    ) -> Factor {
        let aim = times(config.levels.at(velocity), scale);
        let before = self.factor.unwrap_or(Factor::at(aim));
        before.passed(lag, within_way(way, config.lag_per_way), aim)
    }

    /// Whether anything is known of the elements.
    #[must_use]
    pub const fn is_known(&self) -> bool {
        self.at.is_some()
    }

    /// The strains after a path.
    fn strained(&self, config: &FrictionConfig, path: &Path, factor: Factor) -> Strains {
        let limit = element::limit(factor.acting);
        let mut strains = self.strains;
        for way in [Some(path.on), path.back].into_iter().flatten() {
            for (strain, element) in strains.iter_mut().zip(&config.elements) {
                *strain = element.moved(*strain, way, limit);
            }
        }
        strains
    }

    /// What the elements hold.
    #[must_use]
    pub const fn held(&self) -> Torque {
        self.held.all
    }

    fn ahead(
        &self,
        config: &FrictionConfig,
        ahead: &Ahead,
        (velocity, acceleration): (Velocity, Acceleration),
        scale: I8F24,
    ) -> Force {
        let way = ahead.way(velocity, acceleration);
        let there = velocity
            .0
            .saturating_add(scaled(acceleration.0, ahead.velocity_by_acceleration));
        let there = Velocity(there);
        let begin = velocity.plus(half(acceleration));
        let path = Path::between(begin, there, ahead.cycles, way).by(config.by_direction);
        let factor = self.factor_after(config, path.length(), (there, scale), ahead.lag);
        let strains = self.strained(config, &path, factor);
        force(config, &strains, factor, scale).plus(config.viscous_torque(there))
    }
}

impl Force {
    /// With a torque that the table has too.
    fn plus(self, torque: Torque) -> Self {
        Self {
            all: self.all.plus(torque),
            table: self.table.plus(torque),
        }
    }
}

impl Push {
    /// What was before this, where it changes evenly to another.
    fn before(self, after: Self) -> Self {
        Self {
            all: self.all.plus(self.all).minus(after.all),
            ahead: self.ahead.plus(self.ahead).minus(after.ahead),
        }
    }
}

/// The force of all elements, and what their levels have by direction beyond that at rest; from 29
/// to 24 fractional bits.
fn force(config: &FrictionConfig, strains: &Strains, factor: Factor, scale: I8F24) -> Force {
    let strains = strains.iter().zip(&config.elements);
    let [all, table] = strains.fold([0_i64, 0_i64], |[all, table], (strain, element)| {
        let [own, of_table] = element.torque(*strain);
        [all.wrapping_add(own), table.wrapping_add(of_table)]
    });
    let [all, table] = [all, table].map(|sum| Torque(I40F24::from_bits(sum.wrapping_shr(5))));
    let at_rest = times(config.levels.at_rest(), scale);
    let by_direction = config.by_direction.torque(factor.acting, at_rest);
    Force {
        all: all.plus(by_direction),
        table,
    }
}

/// A velocity or its change times a factor, saturated.
fn scaled(value: I20F12, factor: I8F24) -> I20F12 {
    I20F12::saturating_from_num(value.wide_mul(factor))
}

fn half(acceleration: Acceleration) -> Velocity {
    Velocity(I20F12::from_bits(acceleration.0.to_bits().wrapping_shr(1)))
}

/// A torque in a quarter of µN·m.
fn coarse(torque: Torque) -> I30F2 {
    I30F2::saturating_from_num(torque.0)
}

/// The change over two cycles times a number of them.
fn damping(cycles: I8F24, change: Torque) -> Torque {
    // 30.2 bits times 8.24 bits: 38.26 bits, exact; one bit less is half of it.
    let product = coarse(change).wide_mul(cycles).to_bits();
    Torque(I40F24::from_bits(product.wrapping_shr(3)))
}

/// Half of a change over two cycles times a number of them.
fn advanced(cycles: I8F24, change: Velocity) -> Velocity {
    Velocity(I20F12::from_bits(
        scaled(change.0, cycles).to_bits().wrapping_shr(1),
    ))
}
