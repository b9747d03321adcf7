//! The balance of forces beside a friction of the motor's own side: what is seen of it by a law.
//!
//! It follows the law of the load's with a deflection and a rise of its own, has elements of its
//! own, or bends that are free beside each other.
//!
//! Units: m or rad, s, unit of the effort.

use std::ops::RangeInclusive;
use std::slice;

use super::columns::Apart;
use super::flanks::{Balance, OWN_WITHOUT_COULOMB};
use super::known::Known;
use super::load::{Carried, LoadMotion};
use super::rounding;
use super::rubbing::LoadFriction;
use crate::evidence::thresholds::{DIFFERENCE_T, MOTOR_SIDE_SHARE};
use crate::fit::blocks::{Blocks, Fit, Gain};
use crate::fit::rows::Rows;
use crate::fit::search::{descend, smallest};
use crate::motion::bodies::minus;

/// Deflections that are tried, in those of the load's friction.
const DEFLECTIONS: [f64; 8] = [0.1, 0.2, 0.35, 0.5, 0.7, 1.0, 1.4, 2.5];
/// Whether a deflection lies between the ends of those.
pub(super) fn is_between_ends(deflection: f64) -> bool {
    let [least, .., most] = DEFLECTIONS;
    deflection > least && deflection < most
}

/// Bends that are free beside each other, where the law of the load's friction does not fit that of
/// the motor's side. The middle one comes first.
const SHAPES: [f64; 5] = [0.6, 0.1, 0.25, 1.5, 4.0];
/// Rises of the motor's friction that are tried, in that of the load's.
const FALLS: [f64; 4] = [0.0, 0.5, 1.0, 2.0];
/// First step of the descent from the best of them, and over which they are linearised.
const FALL_STEP: f64 = 0.1;
/// First step of the descent from the best deflection, as a share of it.
const STEP: f64 = 0.1;
/// Deflections are linearised over such a share of them.
const LINEAR: f64 = 0.05;
/// What encoders round is in the bend of the motor's friction as well, and hides of it: of 150 N of
/// 400 the bend saw 76 where a stiffness beside it came out softer by a fifth, and the stiffness
/// was 49 % too large for it (1.2 µm a count, 2026-11-28). So many times that share are open.
pub(super) const HIDDEN_BY_ROUNDING: f64 = 2.0;
/// Shares of the friction that may be left to the table where some is the motor's.
const TABLE_SHARES: RangeInclusive<f64> = 0.05..=1.0;
/// Places of coefficients beside a friction of the motor's side: those of its mass, viscous
/// friction, offset, rate of the wind-up, wind-up, bend.
const VISCOUS: usize = 1;
pub(super) const STIFFNESS: usize = 4;
const COULOMB: usize = 5;

/// Friction of the motor's own side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct MotorSide {
    /// Coulomb friction.
    pub coulomb: Known,
    /// Deflection of its bristle, or that by which its elements are scaled: Coulomb level over
    /// stiffness at standstill. `None` where it turns over before anything is seen of it.
    pub deflection: Option<Known>,
    /// Its law, where that is not the load's.
    pub law: Option<LoadFriction>,
}

impl MotorSide {
    /// Elements of its own: where each slips, and its share. None where it follows the load's law.
    pub(crate) fn elements(&self) -> Vec<(f64, f64)> {
        self.law.map_or_else(Vec::new, LoadFriction::elements)
    }
}

/// A stiffness and a friction of the motor's side that are told apart to a share of the stiffness:
/// what that has less, the friction has more.
fn apart_by(share: f64, stiffness: Known, coulomb: Known, unrubbed: Known) -> (Known, Known) {
    let of_load = coulomb.value * stiffness.value / (unrubbed.value - stiffness.value);
    (
        stiffness.within_share(share),
        coulomb.within(share * of_load),
    )
}

/// What is seen of the motor's side.
#[derive(Clone, Copy)]
pub(super) struct Seen {
    /// Stiffness between motor and load.
    pub stiffness: Known,
    /// The friction.
    pub motor_side: MotorSide,
    /// Its rise at rest, in that of the load's friction.
    pub fall: Known,
}

impl Seen {
    /// Whether it is there, beside a stiffness that would be such without it.
    pub(super) fn can_be(&self, unrubbed: Known) -> bool {
        let coulomb = self.motor_side.coulomb;
        let table_share = self.stiffness.value / unrubbed.value;
        coulomb.value > coulomb.half_width && TABLE_SHARES.contains(&table_share)
    }

    /// The same, told apart to a share of the stiffness: what that has less, the friction has more.
    pub(super) fn apart_by(self, share: f64, unrubbed: Known) -> Self {
        let coulomb = self.motor_side.coulomb;
        let (stiffness, coulomb) = apart_by(share, self.stiffness, coulomb, unrubbed);
        self.with(stiffness, coulomb)
    }

    /// The same where friction has elements that slip: such a part of what the motor's does to the
    /// stiffness, and of the motor's itself, is open.
    pub(super) fn open_by_elements(self, share: f64, unrubbed: Known) -> Self {
        let open = share * (unrubbed.value - self.stiffness.value);
        let coulomb = self.motor_side.coulomb.within_share(share);
        self.with(self.stiffness.within(open), coulomb)
    }

    /// The same with such a stiffness and Coulomb friction.
    pub(super) fn with(self, stiffness: Known, coulomb: Known) -> Self {
        Self {
            stiffness,
            motor_side: MotorSide {
                coulomb,
                ..self.motor_side
            },
            ..self
        }
    }
}

/// What is told by a friction of the motor's side that follows a law.
pub(super) struct ByLaw {
    /// The fit.
    pub fit: Fit,
    /// Viscous friction of the motor's side.
    pub viscous: Known,
    /// The rest.
    pub seen: Seen,
}

impl ByLaw {
    /// Whether a friction of the motor's side is seen, beside a fit without.
    pub(super) fn is_clear(&self, without: &Fit) -> bool {
        let gain = Gain::of(without, &self.fit);
        let coulomb = self.seen.motor_side.coulomb;
        gain.share >= MOTOR_SIDE_SHARE
            && gain.t >= DIFFERENCE_T
            && self.viscous.value >= -self.viscous.half_width
            && coulomb.value > coulomb.half_width
    }
}

/// The balance beside a friction of the motor's side.
#[derive(Clone, Copy)]
pub(super) struct Rubbing<'a> {
    /// The motor's motion, as a load's.
    pub motor: &'a LoadMotion,
    /// What is judged.
    pub apart: &'a Apart<'a>,
    /// Columns of what is wound up: its rate, itself.
    pub wound: &'a [Vec<f64>; 2],
    /// Sum of squares of what encoders round of it.
    pub rounding: f64,
    /// All columns but those of the bend.
    pub rows: &'a Rows,
    /// The friction whose law it follows: the load's, or one with elements of its own.
    pub carried: Carried,
    /// Rise of the motor's at rest, in that of the load's.
    pub fall: f64,
    /// The balance.
    pub balance: &'a Balance<'a>,
}

impl Rubbing<'_> {
    /// Columns of the motor's own friction with such a deflection in those of the load's: the bend
    /// comes first.
    pub(super) fn bend(&self, deflection: f64) -> Vec<Vec<f64>> {
        let motion = self.apart.motion;
        let mut carried = self.carried;
        carried.friction.rise *= self.fall;
        let columns = carried.on_motor(motion, self.motor, deflection);
        self.balance.at_efforts(&columns)
    }

    /// With such a deflection, in that of the law that it follows.
    pub(super) fn blocks(&self, deflection: f64) -> Blocks {
        Blocks::with(self.rows, &self.bend(deflection))
    }

    /// By which share rounding makes a stiffness too small that is fitted beside some columns of
    /// the motor's own side and such bends.
    pub(super) fn softens(&self, own: &[usize], bends: &[Vec<f64>]) -> f64 {
        let [rate, wound] = self.wound;
        let others = [slice::from_ref(rate), bends].concat();
        let others = self.balance.rows(own, &others, &self.apart.mask);
        rounding::softens(self.rounding, wound, &others)
    }

    /// The deflection that leaves least.
    fn best(&self) -> f64 {
        let left = |deflection: f64| self.blocks(deflection).fit().sse;
        let begin = smallest(&DEFLECTIONS, &left).unwrap_or(1.0);
        let range = (DEFLECTIONS[0], DEFLECTIONS[DEFLECTIONS.len() - 1]);
        descend(begin, STEP * begin, range, &left)
    }

    /// The same with such a rise of the motor's friction as leaves least, and the deflection that
    /// does then; with that of the load's where hardly any is seen beside a fit without.
    pub(super) fn with_its_own_fall(self, without: &Fit) -> (Self, f64) {
        let best = self.best();
        let gain = Gain::of(without, &self.blocks(best).cross_validate());
        if gain.share < MOTOR_SIDE_SHARE || self.carried.friction.rise <= 0.0 {
            return (self, best);
        }
        let left = |fall: f64| {
            let own = self.falling(fall);
            own.blocks(own.best()).fit().sse
        };
        let begin = smallest(&FALLS, &left).unwrap_or(1.0);
        let range = (FALLS[0], FALLS[FALLS.len() - 1]);
        let own = self.falling(descend(begin, FALL_STEP, range, &left));
        (own, own.best())
    }

    /// The same with the rise of the motor's friction that leaves least by a law of its own.
    pub(super) fn with_the_best_fall(self) -> Self {
        if self.carried.friction.rise <= 0.0 {
            return self;
        }
        let left = |fall: f64| self.falling(fall).blocks(1.0).fit().sse;
        let range = (FALLS[0], FALLS[FALLS.len() - 1]);
        self.falling(descend(self.fall, FALL_STEP, range, &left))
    }

    /// The same with such a rise of the motor's friction, in that of the load's.
    const fn falling(self, fall: f64) -> Self {
        Self { fall, ..self }
    }

    /// Stiffness and Coulomb friction of the motor's side with free bends: the first column has the
    /// coefficients of all.
    pub(super) fn of_any_shape(&self, unrubbed: Known) -> (Known, Known) {
        // The first bend and all that goes with it.
        let mut columns = self.bend(SHAPES[0]);
        for shape in &SHAPES[1..] {
            let other = minus(&self.bend(*shape)[0], &columns[0]);
            columns.push(other);
        }
        let blocks = Blocks::with(self.rows, &columns);
        let (fit, half_widths) = (blocks.fit(), blocks.half_widths());
        let known = |place: usize| Known::new(fit.coefficients[place], half_widths[place]);
        let softer = self.softens(&OWN_WITHOUT_COULOMB, &columns);
        apart_by(softer, known(STIFFNESS), known(COULOMB), unrubbed)
    }

    /// The bend at a deflection and all that goes with it; what another rise changes of it, and
    /// what another deflection does, last.
    pub(super) fn linearised(&self, deflection: f64) -> Vec<Vec<f64>> {
        let [less, more] =
            [1.0 - LINEAR, 1.0 + LINEAR].map(|by| self.bend(by * deflection).swap_remove(0));
        let by_deflection = slope(&more, &less, 2.0 * LINEAR);
        let own = vec![self.by_fall(deflection), by_deflection];
        [self.bend(deflection), own].concat()
    }

    /// What another rise changes of the bend at a deflection.
    pub(super) fn by_fall(&self, deflection: f64) -> Vec<f64> {
        let [low, high] = [(self.fall - FALL_STEP).max(0.0), self.fall + FALL_STEP];
        let [less, more] =
            [low, high].map(|fall| self.falling(fall).bend(deflection).swap_remove(0));
        slope(&more, &less, high - low)
    }

    /// The fit at a deflection, and what is told by it, as uncertain as deflection and rise are.
    pub(super) fn at(&self, deflection: f64) -> ByLaw {
        let fit = self.blocks(deflection).cross_validate();
        let half_widths = Blocks::with(self.rows, &self.linearised(deflection)).half_widths();
        let known = |place: usize| Known::new(fit.coefficients[place], half_widths[place]);
        let [viscous, stiffness, coulomb] = [VISCOUS, STIFFNESS, COULOMB].map(known);
        let share = half_widths.last().map_or(0.0, |last| last / coulomb.value);
        let deflection = Known::new(deflection, deflection * share);
        let deflection = Some(deflection.of(self.carried.friction.deflection));
        let by_fall = half_widths.len() - 2;
        let fall = Known::new(self.fall, half_widths[by_fall] / coulomb.value);
        let motor_side = MotorSide {
            coulomb,
            deflection,
            law: None,
        };
        ByLaw {
            fit,
            viscous,
            seen: Seen {
                stiffness,
                motor_side,
                fall,
            },
        }
    }
}

/// What changes from one column to another over a step.
fn slope(more: &[f64], less: &[f64], step: f64) -> Vec<f64> {
    let pairs = more.iter().zip(less);
    pairs.map(|(more, less)| (more - less) / step).collect()
}
