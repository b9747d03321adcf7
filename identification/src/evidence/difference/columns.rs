//! Motor − load on a record, and the ways in which the two come apart.
//!
//! Both sides go through the low-pass of the effort: what flanks and masses do above it cannot be
//! compared with a force that has passed it.
//!
//! Wind-up is the transmitted force over a stiffness: `(F − M1·a) / K`, with two columns, because
//! the motor's own mass M1 is not known. Friction of the motor's own side, `Fc1·sign v + Fv1·v`, is
//! no part of the transmitted force either: two more columns, where they help.
//!
//! A gap has the lag of the load in it as its column: between rigid flanks that of a load that
//! coasts ([`Behind`]), beside wind-up the part of motor − load that the flanks leave ([`Flanks`]).
//! A pitch error is a cosine and a sine of position. It winds nothing up and is no way across a
//! gap: whatever depends on motor − load itself sees it without its pitch error
//! ([`Apart::cleared`]).

use std::borrow::Cow;
use std::f64::consts::TAU;

use axis_model::EffectName;

use super::edges::Flanks;
use super::load::Carried;
use crate::fit::blocks::{Blocks, Fit};
use crate::fit::rows::Rows;
use crate::model::name::Called;
use crate::motion::bodies::{add, minus};
use crate::motion::kinematics::Kinematics;
use crate::record::scale_error::{ScaleError, along};
use crate::record::units::EffortHold;
use crate::simulate::load::Behind;

/// What a record gives to the difference, besides its kinematics.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Path<'a> {
    /// Motor position at the rows.
    pub position: &'a [f64],
    /// What the motor gives to the load side, but for its own mass; low-passed.
    pub transmitted: &'a [f64],
    /// Over which time the effort of a row acts.
    pub hold: EffortHold,
}

impl Path<'_> {
    /// Values that go with the effort of each row, at the time of the row: an effort that is held
    /// acts from its row to the next, half a row late.
    fn at_rows(&self, values: &[f64]) -> Vec<f64> {
        match self.hold {
            EffortHold::Instant => values.to_vec(),
            EffortHold::ZeroOrder => {
                let before = values.iter().take(1).chain(values);
                let pairs = before.zip(values);
                pairs.map(|(before, at)| 0.5 * (before + at)).collect()
            }
        }
    }
}

/// A way in which motor and load come apart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Way {
    /// Both scales have a zero of their own.
    Constant,
    /// A spring between them, and whether the motor's own side has friction.
    WindUp { motor_friction: bool },
    /// The same with a motor of an assumed mass, where the effort goes so closely with the motion
    /// that the record does not tell the motor's own part of it.
    HalfOf { motor_mass: f64 },
    /// A spring between them, wound up by what moves the load.
    Carried(Carried),
    /// A gap, and the load behind it.
    Play(Behind),
    /// A gap between flanks that wind up.
    Flanks(Flanks),
    /// Periodic in position, with so many periods per length.
    Pitch { per_length: f64 },
}

impl Way {
    /// Of a pitch error.
    pub(super) const fn wave_number(&self) -> Option<f64> {
        match *self {
            Self::Pitch { per_length } => Some(per_length),
            _ => None,
        }
    }

    /// What it is called.
    pub(crate) const fn called(self) -> Called {
        match self {
            Self::Constant => Called::Structure("constant"),
            Self::WindUp { .. } | Self::HalfOf { .. } | Self::Carried(_) => {
                Called::Effect(EffectName::Compliance)
            }
            Self::Play(_) | Self::Flanks(_) => Called::Effect(EffectName::Backlash),
            Self::Pitch { .. } => Called::Effect(EffectName::PitchError),
        }
    }

    /// Number of its columns.
    pub(crate) const fn width(self) -> usize {
        match self {
            Self::Constant | Self::Play(_) | Self::Flanks(_) => 1,
            Self::WindUp { motor_friction } => {
                if motor_friction {
                    4
                } else {
                    2
                }
            }
            Self::HalfOf { .. } => 3,
            Self::Carried(carried) => carried.width(),
            Self::Pitch { .. } => 2,
        }
    }

    /// Its columns, low-passed, on a record with such a motor − load.
    fn columns(self, motion: &Kinematics, path: Path<'_>, apart: &[f64]) -> Vec<Vec<f64>> {
        let position = path.position;
        let low_passed = |column: Vec<f64>| motion.low_passed(&column);
        match self {
            Self::Constant => vec![vec![1.0; motion.len()]],
            Self::WindUp { motor_friction } => {
                let force = path.transmitted.to_vec();
                let held: Vec<Vec<f64>> = [force].into_iter().chain(of_motor(motion)).collect();
                let held = held.iter().take(if motor_friction { 4 } else { 2 });
                held.map(|column| path.at_rows(column)).collect()
            }
            Self::HalfOf { motor_mass } => {
                let [acceleration, direction, velocity] = of_motor(motion);
                let pairs = path.transmitted.iter().zip(&acceleration);
                let onward = pairs.map(|(force, a)| force - motor_mass * a).collect();
                let held = [onward, direction, velocity];
                held.iter().map(|column| path.at_rows(column)).collect()
            }
            Self::Carried(carried) => carried.columns(motion, position, apart),
            Self::Play(behind) => vec![low_passed(behind.follow(position, motion.period_s))],
            Self::Flanks(flanks) => vec![low_passed(flanks.lag(apart))],
            Self::Pitch { per_length } => {
                let angle = |x: &f64| TAU * per_length * x;
                let wave = |f: fn(f64) -> f64| position.iter().map(|x| f(angle(x))).collect();
                vec![low_passed(wave(f64::cos)), low_passed(wave(f64::sin))]
            }
        }
    }
}

/// What inertia and friction of the motor's own side go with: acceleration, direction and velocity
/// of the motor, low-passed.
pub(crate) fn of_motor(motion: &Kinematics) -> [Vec<f64>; 3] {
    let velocity = motion.low_passed(&motion.velocity);
    let direction: Vec<f64> = velocity.iter().map(|v| v.signum()).collect();
    [
        motion.low_passed(&motion.acceleration),
        motion.low_passed(&direction),
        velocity,
    ]
}

/// Ways with the coefficients of their columns.
#[derive(Clone, Debug, Default)]
pub(crate) struct FittedWays(Vec<(Way, Vec<f64>)>);

impl FittedWays {
    /// The coefficients of the way that an effect is, with it.
    pub(crate) fn of(&self, name: EffectName) -> Option<(Way, &[f64])> {
        let mut ways = self.0.iter();
        let own = ways.find(|(way, _)| way.called() == name)?;
        Some((own.0, &own.1))
    }

    /// The pitch errors among them.
    pub(crate) fn scale_errors(&self) -> Vec<ScaleError> {
        let error = |(way, own): &(Way, Vec<f64>)| {
            Some(ScaleError {
                per_length: way.wave_number()?,
                cos: own[0],
                sin: own[1],
            })
        };
        self.0.iter().filter_map(error).collect()
    }

    /// What its effects are called, in their order.
    pub(crate) fn names(&self) -> impl Iterator<Item = EffectName> {
        self.0.iter().filter_map(|(way, _)| way.called().name())
    }

    /// A way by its place, with its coefficients.
    pub(crate) fn at(&self, place: usize) -> Option<(Way, &[f64])> {
        self.0.get(place).map(|(way, own)| (*way, own.as_slice()))
    }

    /// All ways.
    pub(crate) fn ways(&self) -> Vec<Way> {
        self.0.iter().map(|(way, _)| *way).collect()
    }

    /// The way that came in last, with its coefficients.
    pub(crate) fn last(&self) -> Option<(Way, &[f64])> {
        self.0.last().map(|(way, own)| (*way, own.as_slice()))
    }
}

/// Motor − load on a record.
pub(crate) struct Apart<'a> {
    /// The motion.
    pub motion: &'a Kinematics,
    /// Position and transmitted force.
    pub path: Path<'a>,
    /// Motor − load at the rows, without what is known of its pitch error.
    pub raw: &'a [f64],
    /// Motor − load, low-passed, with its pitch error.
    pub target: Vec<f64>,
    /// The samples that are judged: moving ones and those about reversals.
    pub mask: Vec<bool>,
}

impl<'a> Apart<'a> {
    /// The difference of a record; `None` where there is no load scale.
    pub(crate) fn on(motion: &'a Kinematics, path: Path<'a>) -> Option<Self> {
        let pairs = motion.moving.iter().zip(&motion.slow);
        let raw = motion.difference.as_deref()?;
        Some(Self {
            motion,
            path,
            raw,
            target: motion.low_passed(raw),
            mask: pairs.map(|(moving, slow)| *moving || *slow).collect(),
        })
    }

    /// Motor − load at the rows without the pitch error of fitted ways.
    pub(super) fn cleared(&self, fitted: &FittedWays) -> Cow<'a, [f64]> {
        let errors = fitted.scale_errors();
        if errors.is_empty() {
            return Cow::Borrowed(self.raw);
        }
        minus(self.raw, &along(&errors, self.path.position)).into()
    }

    /// The same with such a motor − load at the rows.
    pub(super) fn seen<'b>(&self, raw: &'b [f64]) -> Apart<'b>
    where
        'a: 'b,
    {
        Apart {
            raw,
            target: self.target.clone(),
            mask: self.mask.clone(),
            motion: self.motion,
            path: self.path,
        }
    }

    /// The same, judged where the motor moves: at rest its friction is whatever holds.
    pub(super) fn where_moving(&self) -> Self {
        Self {
            target: self.target.clone(),
            mask: self.moving(&self.mask),
            ..*self
        }
    }

    /// Rate of the transmitted force at the rows.
    pub(super) fn rate_of_force(&self) -> Vec<f64> {
        let force = self.path.at_rows(self.path.transmitted);
        let last = force.len() - 1;
        let rows = 0..=last;
        let rate = rows.map(|row| force[(row + 1).min(last)] - force[row.saturating_sub(1)]);
        rate.map(|over| over / (2.0 * self.motion.period_s))
            .collect()
    }

    /// The rows of a mask in which the motor moves.
    fn moving(&self, mask: &[bool]) -> Vec<bool> {
        let pairs = mask.iter().zip(&self.motion.fitted);
        pairs.map(|(inside, moving)| *inside && *moving).collect()
    }

    /// The same, judged where the states of such ways are known.
    pub(super) fn where_known(&self, ways: &[Way]) -> Self {
        let mut mask = self.mask.clone();
        for way in ways {
            match way {
                Way::Carried(carried) => {
                    mask = carried.known(self.motion, self.path.position, self.raw, &mask);
                }
                Way::HalfOf { .. } => mask = self.moving(&mask),
                _ => {}
            }
        }
        Self {
            target: self.target.clone(),
            mask,
            ..*self
        }
    }

    /// The columns of a way.
    pub(crate) fn columns(&self, way: Way) -> Vec<Vec<f64>> {
        way.columns(self.motion, self.path, self.raw)
    }

    /// The columns of several ways.
    pub(super) fn design(&self, ways: &[Way]) -> Vec<Vec<f64>> {
        ways.iter().flat_map(|way| self.columns(*way)).collect()
    }

    /// Gram matrices over the samples that are judged.
    pub(crate) fn blocks(&self, ways: &[Way]) -> Blocks {
        self.blocks_of(&self.design(ways), &self.target)
    }

    /// The same of any columns and target.
    pub(super) fn blocks_of(&self, columns: &[Vec<f64>], target: &[f64]) -> Blocks {
        let columns: Vec<&[f64]> = columns.iter().map(Vec::as_slice).collect();
        Blocks::new(&columns, target, &self.mask, self.motion.period_s)
    }

    /// Any columns at the samples that are judged.
    pub(super) fn rows_of(&self, columns: &[Vec<f64>]) -> Rows {
        let columns: Vec<&[f64]> = columns.iter().map(Vec::as_slice).collect();
        Rows::new(&columns, &self.target, &self.mask, self.motion.period_s)
    }

    /// Errors on blocks that were held out of the fit.
    pub(crate) fn cross_validate(&self, ways: &[Way]) -> Fit {
        self.blocks(ways).cross_validate()
    }

    /// Ways with the coefficients that leave least.
    pub(crate) fn fit(&self, ways: &[Way]) -> FittedWays {
        let coefficients = self.blocks(ways).fit().coefficients;
        let mut rest = coefficients.into_iter();
        let mut own = |way: Way| rest.by_ref().take(way.width()).collect();
        FittedWays(ways.iter().map(|way| (*way, own(*way))).collect())
    }

    /// What a way with such coefficients makes of motor − load.
    pub(crate) fn predicted(&self, way: Way, own: &[f64]) -> Vec<f64> {
        let mut predicted = vec![0.0; self.target.len()];
        add(&mut predicted, &self.columns(way), own);
        predicted
    }

    /// What fitted ways leave of each sample.
    pub(crate) fn residual(&self, fitted: &FittedWays) -> Vec<f64> {
        let mut predicted = vec![0.0; self.target.len()];
        for (way, own) in &fitted.0 {
            let pairs = predicted.iter_mut().zip(self.predicted(*way, own));
            pairs.for_each(|(sum, value)| *sum += value);
        }
        let pairs = self.target.iter().zip(predicted);
        pairs
            .map(|(target, predicted)| target - predicted)
            .collect()
    }

    /// The same, judged where the states of such ways are known and no flanks strike.
    pub(super) fn without_strikes(&self, ways: &[Way]) -> Self {
        Self {
            target: self.target.clone(),
            mask: self.where_quiet(ways),
            ..*self
        }
    }

    /// The rows at which the states of such ways are known and no flanks strike.
    fn where_quiet(&self, ways: &[Way]) -> Vec<bool> {
        let mut mask = self.where_known(ways).mask;
        for way in ways {
            if let Way::Carried(carried) = way {
                mask = carried.quiet(self.motion, self.raw, &mask);
            }
        }
        mask
    }

    /// Rms of what fitted ways leave where their states are known and no flanks strike, µm (µrad).
    pub(crate) fn rms_um(&self, fitted: &FittedWays) -> f64 {
        let residual = self.residual(fitted);
        let quiet = self.where_quiet(&fitted.ways());
        let inside = residual.iter().zip(&quiet).filter(|(_, inside)| **inside);
        let (sum, count) = inside.fold((0.0, 0.0), |(sum, count), (left, _)| {
            (sum + left.powi(2), count + 1.0)
        });
        1.0e6 * (sum / f64::max(count, 1.0)).sqrt()
    }
}

#[cfg(test)]
impl FittedWays {
    /// Of these ways.
    pub(crate) fn made(ways: Vec<(Way, Vec<f64>)>) -> Self {
        Self(ways)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::made::{Axis, axis, usual};

    /// An axis with a difference that follows a law of the position.
    fn apart_by(law: impl Fn(f64) -> f64) -> Axis {
        let mut axis = axis(usual);
        let position = &axis.dataset.train.position;
        axis.motion.difference = Some(position.iter().map(|x| law(*x)).collect());
        axis
    }

    fn apart(axis: &Axis) -> Apart<'_> {
        let path = Path {
            position: &axis.dataset.train.position,
            transmitted: &axis.motion.effort_lp,
            hold: axis.dataset.hold,
        };
        Apart::on(&axis.motion, path).unwrap()
    }

    fn fitted(ways: &[(Way, &[f64])]) -> FittedWays {
        FittedWays(ways.iter().map(|(way, own)| (*way, own.to_vec())).collect())
    }

    #[test]
    fn moving_samples_and_those_about_reversals_are_judged() {
        let mut axis = apart_by(|x| x);
        let mut judged = |moving, slow| {
            axis.motion.moving[7] = moving;
            axis.motion.slow[7] = slow;
            apart(&axis).mask[7]
        };
        assert!(!judged(false, false) && judged(true, false) && judged(false, true));
        axis.motion.difference = None;
        let (position, transmitted) = (&[][..], &[][..]);
        let hold = EffortHold::Instant;
        let path = Path {
            position,
            transmitted,
            hold,
        };
        assert!(Apart::on(&axis.motion, path).is_none());
    }

    #[test]
    fn a_pitch_error_is_a_cosine_and_a_sine_with_a_wave_number() {
        let axis = apart_by(|x| x);
        let [cosine, sine] = &apart(&axis).columns(Way::Pitch { per_length: 5.0 })[..] else {
            panic!("two columns");
        };
        // A period of 200 mm: slow beside the low-pass.
        for row in (500..5500).step_by(500) {
            let angle = TAU * 5.0 * axis.dataset.train.position[row];
            assert!((cosine[row] - angle.cos()).abs() < 1.0e-6, "{row}");
            assert!((sine[row] - angle.sin()).abs() < 1.0e-6, "{row}");
        }
    }

    #[test]
    fn a_spring_is_wound_up_by_the_transmitted_force_less_the_motors_own() {
        let axis = apart_by(|x| x);
        let columns = |motor_friction| apart(&axis).columns(Way::WindUp { motor_friction });
        let force = vec![axis.motion.effort_lp.clone()];
        let all: Vec<Vec<f64>> = force.into_iter().chain(of_motor(&axis.motion)).collect();
        assert_eq!(columns(false), all[..2]);
        assert_eq!(columns(true), all);
        let ones = apart(&axis).columns(Way::Constant);
        assert_eq!(ones, [vec![1.0; axis.motion.len()]]);
        let gap = Behind {
            gap: 2.0e-6,
            coulomb: 1.0,
            ..Behind::default()
        };
        let lag = gap.follow(&axis.dataset.train.position, 1.0e-3);
        let lag = axis.motion.low_passed(&lag);
        assert_eq!(apart(&axis).columns(Way::Play(gap)), [lag]);
    }

    #[test]
    fn a_motor_of_an_assumed_mass_is_judged_where_it_moves() {
        let axis = apart_by(|x| x);
        let apart = apart(&axis);
        let half = Way::HalfOf { motor_mass: 30.0 };
        let [onward, direction, velocity] = &apart.columns(half)[..] else {
            panic!("force, direction and velocity");
        };
        let [acceleration, wanted_direction, wanted_velocity] = &of_motor(&axis.motion);
        assert_eq!((direction, velocity), (wanted_direction, wanted_velocity));
        let rows = onward.iter().zip(&axis.motion.effort_lp).zip(acceleration);
        assert!(
            rows.into_iter()
                .all(|((onward, u), a)| *onward == u - 30.0 * a)
        );
        assert!(
            apart
                .mask
                .iter()
                .zip(&axis.motion.fitted)
                .any(|(asked, moving)| *asked && !moving)
        );
        assert_eq!(apart.where_known(&[half]).mask, axis.motion.fitted);
    }

    #[test]
    fn what_goes_with_an_effort_that_is_held_stands_half_a_row_later_than_its_row() {
        let path = |hold| Path {
            position: &[],
            transmitted: &[],
            hold,
        };
        let held = path(EffortHold::ZeroOrder).at_rows(&[1.0, 3.0, 7.0]);
        assert_eq!(held, [1.0, 2.0, 5.0]);
        let instant = path(EffortHold::Instant).at_rows(&[1.0, 3.0, 7.0]);
        assert_eq!(instant, [1.0, 3.0, 7.0]);
    }

    #[test]
    fn a_fit_gives_each_way_its_own_coefficients() {
        let pitch = Way::Pitch { per_length: 500.0 };
        let axis = apart_by(|x| 3.0e-6 + 2.0e-6 * (TAU * 500.0 * x).sin());
        let apart = apart(&axis);
        let ways = apart.fit(&[Way::Constant, pitch]);
        let (last, own) = ways.last().unwrap();
        assert_eq!(last, pitch);
        assert!(own[0].abs() < 1.0e-10 && (own[1] - 2.0e-6).abs() < 1.0e-10);
        assert!((ways.0[0].1[0] - 3.0e-6).abs() < 1.0e-10);
        assert!(apart.rms_um(&ways) < 1.0e-4);
        assert_eq!(ways.of(EffectName::PitchError).unwrap().1, own);
        assert!(ways.of(EffectName::Backlash).is_none());
        assert_eq!(ways.names().collect::<Vec<_>>(), [EffectName::PitchError]);
    }

    #[test]
    fn what_is_left_is_the_difference_less_what_was_fitted_in_micrometres_over_the_mask() {
        let axis = apart_by(|_| 5.0e-6);
        let mut apart = apart(&axis);
        apart.mask.fill(false);
        apart.mask[..4].fill(true);
        let ways = fitted(&[(Way::Constant, &[2.0e-6])]);
        let left = apart.residual(&ways);
        assert!(left.iter().all(|left| (left - 3.0e-6).abs() < 1.0e-18));
        assert!((apart.rms_um(&ways) - 3.0).abs() < 1.0e-9);
        let target: Vec<f64> = (0..axis.motion.len())
            .map(|row| [3.0e-6, -3.0e-6, 5.0e-6, 5.0e-6, 1.0][row.min(4)])
            .collect();
        apart.target = target;
        // √((9 + 9 + 25 + 25)/4) µm; the rows of a metre are outside.
        let rms = apart.rms_um(&FittedWays::default());
        assert!((rms - 17.0_f64.sqrt()).abs() < 1.0e-9, "{rms}");
        apart.mask.fill(false);
        assert_eq!(apart.rms_um(&FittedWays::default()), 0.0);
    }
}
