//! The load's motion, and the wind-up that it asks for.
//!
//! ```text
//! K·w + C·ẇ = M2·a2 + Fc2·z + d·ż + Fv2·v2 + F0
//! ```
//!
//! w is the wind-up, z the bend of the load's friction ([`rubbing`](super::rubbing)): a bristle
//! whose level falls with the velocity (LuGre: Canudas de Wit et al., IEEE TAC 40, 1995), or
//! elements that slip. Everything but its deflections, rise and vs is linear.
//!
//! Units: m or rad, s, unit of the effort.

use std::ops::Range;

use super::between_rows::{Steps, without_small_turns};
use super::edges::Flanks;
use super::rubbing::{ALIKE, Law, LoadFriction};
use crate::model::effects::stribeck::GAUSS;
use crate::motion::bodies::{add, minus};
use crate::motion::kinematics::Kinematics;
use crate::motion::mask::{unless_few, widened, without};

/// Least share of the samples that has to be clear of strikes: else all are counted. Chosen: a loop
/// that rings between its flanks leaves a third, and a tenth of a record still is thousands.
const QUIET_SHARE: f64 = 0.1;

/// The load's motion at the rows.
pub(super) struct LoadMotion {
    /// By piece. Not low-passed: a load that rings faster than that turns over all the same.
    steps: Vec<Steps>,
    /// Low-passed.
    velocity: Vec<f64>,
    /// Low-passed.
    acceleration: Vec<f64>,
    /// Rate of the wind-up, low-passed.
    rate: Vec<f64>,
}

impl LoadMotion {
    /// Of a record with such a motion of its motor, and such a motor − load; turns of the load that
    /// are smaller than a size are none to its bristle.
    pub(super) fn of(
        motion: &Kinematics,
        position: &[f64],
        apart: &[f64],
        flanks: Option<Flanks>,
        smallest_turn: f64,
    ) -> Self {
        let wind_up = |d: &f64| flanks.map_or(*d, |flanks| flanks.wind_up(*d));
        let wound: Vec<f64> = apart.iter().map(wind_up).collect();
        let position = minus(position, apart);
        let steps_of = |piece: &Range<usize>| {
            let path = without_small_turns(&position[piece.clone()], smallest_turn);
            Steps::of(&path, &slope(&path, motion.period_s), motion.period_s)
        };
        Self {
            velocity: derived(motion, &position, slope),
            acceleration: derived(motion, &position, bow),
            rate: derived(motion, &wound, slope),
            steps: motion.pieces.iter().map(steps_of).collect(),
        }
    }

    /// Of the motor, as if it were the load.
    pub(super) fn of_motor(motion: &Kinematics, position: &[f64], smallest_turn: f64) -> Self {
        let nothing = vec![0.0; position.len()];
        Self::of(motion, position, &nothing, None, smallest_turn)
    }

    /// The bend and its rate, low-passed.
    pub(super) fn rubbed(&self, motion: &Kinematics, friction: LoadFriction) -> Vec<Vec<f64>> {
        with_rate(motion, &self.bent(friction, &self.fallen(friction)))
    }

    /// By how much bend and rate differ between two frictions, low-passed; with the fall of a third
    /// one, which is theirs where they fall as it does.
    pub(super) fn rubbed_apart(
        &self,
        motion: &Kinematics,
        [up, down]: [LoadFriction; 2],
        usual: &Fallen,
    ) -> Vec<Vec<f64>> {
        let bent = |friction: LoadFriction| {
            if friction.falls_as(usual.friction) {
                return self.bent(friction, usual);
            }
            self.bent(friction, &self.fallen(friction))
        };
        let pairs = bent(up).into_iter().zip(bent(down));
        let apart = pairs.map(|(up, down)| minus(&up, &down));
        with_rate(motion, &apart.collect::<Vec<_>>())
    }

    /// The fall of a friction.
    pub(super) fn fallen(&self, friction: LoadFriction) -> Fallen {
        let pieces = self.steps.iter();
        Fallen {
            friction,
            by_piece: pieces.map(|steps| friction.fall(steps)).collect(),
        }
    }

    /// The bend, piece by piece.
    fn bent(&self, friction: LoadFriction, fallen: &Fallen) -> Vec<Vec<f64>> {
        let pieces = self.steps.iter().zip(&fallen.by_piece);
        pieces
            .map(|(steps, fall)| friction.bend(steps, fall))
            .collect()
    }

    /// The bend of each element of a grid, under the level of a friction, low-passed.
    pub(super) fn slipped(
        &self,
        motion: &Kinematics,
        friction: LoadFriction,
        grid: &[f64],
    ) -> Vec<Vec<f64>> {
        let mut bends = vec![Vec::new(); grid.len()];
        for steps in &self.steps {
            let of_piece = friction.bends(steps, grid);
            for (bend, own) in bends.iter_mut().zip(of_piece) {
                bend.extend(own);
            }
        }
        motion.all_low_passed(&bends)
    }

    /// What does not depend on the friction's parameters.
    pub(super) fn plain(&self) -> [Vec<f64>; 3] {
        [&self.acceleration, &self.velocity, &self.rate].map(Clone::clone)
    }
}

/// The fall of a friction's level along a path, piece by piece: it takes most of the time of a
/// bend, and few of a friction's parameters change it.
pub(super) struct Fallen {
    friction: LoadFriction,
    by_piece: Vec<Vec<f64>>,
}

/// A bend and its rate, low-passed.
fn with_rate(motion: &Kinematics, by_piece: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let rates = by_piece.iter().map(|bend| slope(bend, motion.period_s));
    let rates: Vec<Vec<f64>> = rates.collect();
    motion.all_low_passed(&[by_piece.concat(), rates.concat()])
}

/// A derivative of a signal, piece by piece and low-passed.
fn derived(motion: &Kinematics, of: &[f64], derivative: fn(&[f64], f64) -> Vec<f64>) -> Vec<f64> {
    let pieces = motion.pieces.iter().cloned();
    let derived = pieces.flat_map(|piece| derivative(&of[piece], motion.period_s));
    motion.low_passed(&derived.collect::<Vec<f64>>())
}

/// The rows of a mask in which the load goes faster than a velocity. All of them where that leaves
/// few.
pub(super) fn where_it_moves(
    motion: &Kinematics,
    position: &[f64],
    apart: &[f64],
    mask: &[bool],
    slowest: f64,
) -> Vec<bool> {
    let velocity = derived(motion, &minus(position, apart), slope);
    let rows = mask.iter().zip(velocity);
    let moves = rows.map(|(inside, velocity)| *inside && velocity.abs() > slowest);
    unless_few(moves.collect(), mask, QUIET_SHARE)
}

/// First derivative at the rows by the central differences over two and four rows: within half a
/// percent up to a tenth of the sample rate. The ends stand still.
fn slope(x: &[f64], period_s: f64) -> Vec<f64> {
    at_rows(x, |x| {
        (8.0 * (x[3] - x[1]) - (x[4] - x[0])) / (12.0 * period_s)
    })
}

/// Second derivative, in the same way: within a fifth of a percent.
fn bow(x: &[f64], period_s: f64) -> Vec<f64> {
    at_rows(x, |x| {
        (16.0 * (x[1] + x[3]) - 30.0 * x[2] - x[0] - x[4]) / (12.0 * period_s.powi(2))
    })
}

/// A function of each row and two neighbours on either side; zero where they are not all there.
fn at_rows(x: &[f64], of_five: impl Fn(&[f64]) -> f64) -> Vec<f64> {
    let mut values = vec![0.0; x.len()];
    for (value, five) in values.iter_mut().skip(2).zip(x.windows(5)) {
        *value = of_five(five);
    }
    values
}

/// Wind-up that the load's motion asks for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Carried {
    /// Friction of the load.
    pub friction: LoadFriction,
    /// The flanks of a gap; without one everything that is between motor and load is wound up.
    pub flanks: Option<Flanks>,
    /// Motor − load that changes by so much within a row where flanks meet: a strike.
    pub strike: f64,
    /// Turns of the load that are smaller are none to its bristle; zero follows every count.
    pub smallest_turn: f64,
    /// What else its friction goes with.
    pub more: More,
}

/// What the load's friction goes with beside direction, velocity and displacement.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct More {
    /// Viscous friction is another one either way.
    pub by_direction: bool,
    /// The level changes along the travel.
    pub over_position: bool,
    /// A drag goes with the square of the velocity.
    pub squared: bool,
}

impl Carried {
    /// Number of its columns.
    pub(super) const fn width(self) -> usize {
        let More {
            by_direction,
            over_position,
            squared,
        } = self.more;
        let more = by_direction as usize + 2 * over_position as usize + squared as usize;
        Self::BENDING + 1 + more
    }

    /// Place of the coefficient of the load's acceleration in those of [`Self::columns`].
    pub(super) const MASS: usize = 0;
    /// Place of that of its velocity.
    pub(super) const VISCOUS: usize = 1;
    /// Place of that of the rate of the wind-up.
    pub(super) const DAMPING: usize = 2;
    /// Place of the bend's.
    pub(super) const FRICTION: usize = 3;
    /// Place of that of the rate of the bend.
    pub(super) const BENDING: usize = 4;

    /// Place of that of the size of the velocity, where that is asked.
    pub(super) const BY_DIRECTION: usize = 5;

    /// Its columns on a record, low-passed: acceleration and velocity of the load, rate of the
    /// wind-up, bend, rate of the bend; then what else its friction goes with: the size of the
    /// velocity, the bend times the way from the middle of the travel and times the square of that,
    /// the square of the velocity with its sign.
    pub(super) fn columns(
        self,
        motion: &Kinematics,
        position: &[f64],
        apart: &[f64],
    ) -> Vec<Vec<f64>> {
        let load = self.load(motion, position, apart);
        let rubbed = self.rubbed(motion, &load);
        load.plain().into_iter().chain(rubbed).collect()
    }

    /// Its columns without those that do not depend on its friction's parameters.
    pub(super) fn rubbed(self, motion: &Kinematics, load: &LoadMotion) -> Vec<Vec<f64>> {
        let mut rubbed = load.rubbed(motion, self.friction);
        let more = self.more.columns(motion, load, &rubbed[0]);
        rubbed.extend(more);
        rubbed
    }

    /// What changes with a bend and its rate, which are low-passed and change by so much; with the
    /// coefficients of its columns.
    pub(super) fn changed(
        self,
        motion: &Kinematics,
        mut rubbed: Vec<Vec<f64>>,
        own: &[f64],
    ) -> Vec<f64> {
        let along = self.more.along(motion, &rubbed[0]);
        rubbed.extend(along);
        let with_bend = [Self::FRICTION, Self::BENDING].into_iter();
        let places = with_bend.chain(self.more.along_from()..);
        let own = rubbed.iter().zip(places).map(|(_, place)| own[place]);
        let mut change = vec![0.0; motion.len()];
        add(&mut change, &rubbed, &own.collect::<Vec<_>>());
        change
    }

    /// Columns of a friction of the motor's own side, low-passed. It follows the law of the load's,
    /// with such a deflection in those of it: its bend, what else the load's friction goes with,
    /// which the motor's may as well, and the rate of the bend.
    pub(super) fn on_motor(
        self,
        motion: &Kinematics,
        motor: &LoadMotion,
        deflection: f64,
    ) -> Vec<Vec<f64>> {
        let friction = LoadFriction {
            deflection: deflection * self.friction.deflection,
            ..self.friction
        };
        let mut columns = motor.rubbed(motion, friction);
        let more = self.more.columns(motion, motor, &columns[0]);
        columns.splice(1..1, more);
        columns
    }

    /// Whether its friction is a bristle and nothing else.
    pub(super) fn rubs_as_a_bristle(self) -> bool {
        let LoadFriction {
            law,
            lag_s,
            exponent,
            forward,
            ..
        } = self.friction;
        let is_usual = lag_s == 0.0 && exponent == GAUSS && forward == ALIKE;
        law == Law::Dahl && is_usual && self.more == More::default()
    }

    /// The load's motion on a record.
    pub(super) fn load(self, motion: &Kinematics, position: &[f64], apart: &[f64]) -> LoadMotion {
        LoadMotion::of(motion, position, apart, self.flanks, self.smallest_turn)
    }

    /// The same with what is searched of its friction times factors.
    pub(super) fn scaled(self, factors: [f64; LoadFriction::MOST_SEARCHED]) -> Self {
        Self {
            friction: self.friction.scaled(factors),
            ..self
        }
    }

    /// The rows of a mask without those about strikes: nobody recorded when flanks struck between
    /// two rows, and the contact rings faster than the low-pass lets through. They stay where few
    /// others are left.
    pub(super) fn quiet(self, motion: &Kinematics, apart: &[f64], mask: &[bool]) -> Vec<bool> {
        let Some(flanks) = self.flanks else {
            return mask.to_vec();
        };
        let strikes = flanks.strikes(apart, self.strike).into_iter();
        let mixed_s = 1.0 / motion.filter.cutoff_hz;
        let quiet = without(mask, &widened(strikes, mixed_s, motion.period_s));
        unless_few(quiet, mask, QUIET_SHARE)
    }

    /// The rows of a mask at which the bend is known: nobody recorded it at the start of a piece.
    pub(super) fn known(
        self,
        motion: &Kinematics,
        position: &[f64],
        apart: &[f64],
        mask: &[bool],
    ) -> Vec<bool> {
        let travel = self.friction.settles_after();
        let of_piece = |piece: &Range<usize>| {
            let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
            let rows = piece.clone().map(move |row| {
                let x = position[row] - apart[row];
                (low, high) = (low.min(x), high.max(x));
                mask[row] && high - low >= travel
            });
            rows.collect::<Vec<bool>>()
        };
        motion.pieces.iter().flat_map(of_piece).collect()
    }
}

impl More {
    /// This with one thing more, each in turn.
    pub(super) fn others(self) -> Vec<Self> {
        let by_direction = Self {
            by_direction: true,
            ..self
        };
        let over_position = Self {
            over_position: true,
            ..self
        };
        let squared = Self {
            squared: true,
            ..self
        };
        let mut others = vec![by_direction, over_position, squared];
        others.retain(|other| *other != self);
        others
    }

    fn columns(self, motion: &Kinematics, load: &LoadMotion, bend: &[f64]) -> Vec<Vec<f64>> {
        let mut columns = Vec::new();
        if self.by_direction {
            columns.push(load.velocity.iter().map(|v| v.abs()).collect());
        }
        columns.extend(self.along(motion, bend));
        if self.squared {
            columns.push(load.velocity.iter().map(|v| v * v.abs()).collect());
        }
        columns
    }

    /// Those of them that go with a bend.
    fn along(self, motion: &Kinematics, bend: &[f64]) -> Vec<Vec<f64>> {
        if !self.over_position {
            return Vec::new();
        }
        let (low, high) = motion.span();
        let place = |x: &f64| 2.0 * (x - low) / (high - low) - 1.0;
        let along = |power: i32| {
            let rows = bend.iter().zip(&motion.position_lp);
            rows.map(|(bend, x)| bend * place(x).powi(power)).collect()
        };
        vec![along(1), along(2)]
    }

    /// Place of the first of these in the columns of [`Carried::columns`].
    const fn along_from(self) -> usize {
        Carried::BENDING + 1 + self.by_direction as usize
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evidence::difference::carried::tests::{FRICTION, apart, axis, rubbing_alone};
    use crate::simulate::made::two_sines;

    #[test]
    fn derivatives_are_those_of_a_sine_up_to_a_tenth_of_the_rate() {
        let rate = std::f64::consts::TAU * 100.0;
        let path: Vec<f64> = (0..50)
            .map(|row| (1.0e-3 * rate * f64::from(row)).sin())
            .collect();
        let (slope, bow) = (slope(&path, 1.0e-3), bow(&path, 1.0e-3));
        assert_eq!((slope[1], slope[48], bow[1], bow[48]), (0.0, 0.0, 0.0, 0.0));
        for row in 2..48 {
            let angle = 1.0e-3 * rate * row as f64;
            assert!((slope[row] / rate - angle.cos()).abs() < 5.1e-3, "{row}");
            assert!(
                (bow[row] / rate.powi(2) + angle.sin()).abs() < 2.0e-3,
                "{row}"
            );
        }
        assert!(
            super::slope(&path[..3], 1.0e-3)
                .iter()
                .all(|slope| *slope == 0.0)
        );
    }

    #[test]
    fn a_bristle_bends_to_the_level_of_its_velocity_and_back() {
        let there: Vec<f64> = (0..400).map(|row| 1.0e-6 * f64::from(row)).collect();
        let back = there.iter().rev().copied();
        let path: Vec<f64> = there.iter().copied().chain(back).collect();
        let bend = |period_s: f64| {
            let velocity = slope(&path, period_s);
            let steps = Steps::of(&path, &velocity, period_s);
            FRICTION.bend(&steps, &FRICTION.fall(&steps))
        };
        let (slow, fast) = (bend(1.0), bend(1.0e-6));
        assert!((slow[399] - 1.4).abs() < 1.0e-4 && (fast[399] - 1.0).abs() < 1.0e-4);
        assert!((slow[799] + 1.4).abs() < 1.0e-4 && (fast[799] + 1.0).abs() < 1.0e-4);
        // One deflection after the turn 2/e of both levels are left to go.
        let turned = -1.0 + 2.0 * (-1.0_f64).exp();
        assert!((fast[420] - turned).abs() < 0.01, "{}", fast[420]);
    }

    #[test]
    fn a_bend_is_known_once_the_bristle_has_given_way() {
        let axis = axis(|_| 0.0);
        let carried = rubbing_alone(FRICTION);
        let apart = apart(&axis);
        let mask = vec![true; 6000];
        let position = &axis.dataset.train.position;
        let known = carried.known(&axis.motion, position, apart.raw, &mask);
        let first = known.iter().position(|known| *known).unwrap();
        let load = two_sines(6000);
        let travel = FRICTION.settles_after();
        assert!((load[first] - load[0]).abs() >= travel);
        assert!((load[first - 1] - load[0]).abs() < travel);
        assert!(known[first..].iter().all(|known| *known));
    }

    #[test]
    fn a_load_moves_where_it_is_faster_than_it_rests_unless_that_leaves_few() {
        let axis = axis(|_| 0.0);
        let apart = apart(&axis);
        let mask = vec![true; 6000];
        let position = &axis.dataset.train.position;
        let moves =
            |slowest: f64| where_it_moves(&axis.motion, position, apart.raw, &mask, slowest);
        let speed: Vec<f64> = slope(&two_sines(6000), 1.0e-3);
        let fastest = speed.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
        for (row, moves) in moves(0.2 * fastest).iter().enumerate().skip(100).take(5800) {
            let share = speed[row].abs() / fastest;
            assert!(
                *moves == (share > 0.2) || (share - 0.2).abs() < 0.02,
                "{row}"
            );
        }
        assert_eq!(moves(0.999 * fastest), mask);
    }

    #[test]
    fn rows_about_strikes_are_not_quiet_unless_few_others_are_left() {
        let axis = axis(|_| 0.0);
        let carried = Carried {
            friction: FRICTION,
            flanks: Some(Flanks {
                low: -1.0e-5,
                high: 1.0e-5,
                ..Flanks::default()
            }),
            strike: 2.0e-6,
            smallest_turn: 0.0,
            more: More::default(),
        };
        let mask = vec![true; 6000];
        let left_out = |apart: &dyn Fn(usize) -> f64| {
            let apart: Vec<f64> = (0..6000).map(apart).collect();
            let quiet = carried.quiet(&axis.motion, &apart, &mask);
            quiet.iter().filter(|quiet| !**quiet).count()
        };
        // A period of 100 Hz on either side of the row; slower than a strike, nothing.
        let met = |by: f64| move |row: usize| if row < 3000 { 9.0e-6 } else { 9.0e-6 + by };
        assert_eq!(left_out(&met(2.1e-6)), 21);
        assert_eq!(left_out(&met(1.9e-6)), 0);
        assert_eq!(left_out(&|row| if row % 20 < 10 { 0.0 } else { 1.1e-5 }), 0);
        let rigid = Carried {
            flanks: None,
            ..carried
        };
        assert_eq!(rigid.quiet(&axis.motion, &vec![0.0; 6000], &mask), mask);
    }
}
