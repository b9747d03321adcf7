//! Motor − load on a record, and the ways in which the two come apart.
//!
//! Wind-up is the transmitted force over a stiffness: `(F − M1·a) / K`, with two columns, because
//! the motor's own mass M1 is not known. A gap has the lag of the load in it as its column. A pitch
//! error is a cosine and a sine of position.

use std::f64::consts::TAU;

use axis_model::EffectName;

use crate::fit::blocks::{Blocks, Fit};
use crate::model::name::Called;
use crate::motion::kinematics::Kinematics;
use crate::simulate::load::Behind;

/// What a record gives to the difference, besides its kinematics.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Path<'a> {
    /// Motor position at the rows.
    pub position: &'a [f64],
    /// What the motor gives to the load side, but for its own mass; low-passed.
    pub transmitted: &'a [f64],
}

/// A way in which motor and load come apart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Way {
    /// Both scales have a zero of their own.
    Constant,
    /// A spring between them.
    WindUp,
    /// A gap, and the load behind it.
    Play(Behind),
    /// Periodic in position, with so many periods per length.
    Pitch { per_length: f64 },
}

impl Way {
    /// What it is called.
    pub(crate) const fn called(self) -> Called {
        match self {
            Self::Constant => Called::Structure("constant"),
            Self::WindUp => Called::Effect(EffectName::Compliance),
            Self::Play(_) => Called::Effect(EffectName::Backlash),
            Self::Pitch { .. } => Called::Effect(EffectName::PitchError),
        }
    }

    fn columns(self, motion: &Kinematics, path: Path<'_>) -> Vec<Vec<f64>> {
        let position = path.position;
        match self {
            Self::Constant => vec![vec![1.0; motion.len()]],
            Self::WindUp => vec![
                path.transmitted.to_vec(),
                motion.low_passed(&motion.acceleration),
            ],
            Self::Play(behind) => vec![behind.follow(position, motion.period_s)],
            Self::Pitch { per_length } => {
                let angle = |x: &f64| TAU * per_length * x;
                let wave = |f: fn(f64) -> f64| position.iter().map(|x| f(angle(x))).collect();
                vec![wave(f64::cos), wave(f64::sin)]
            }
        }
    }
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

    /// What its effects are called, in their order.
    pub(crate) fn names(&self) -> impl Iterator<Item = EffectName> {
        self.0.iter().filter_map(|(way, _)| way.called().name())
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
    /// Motor − load.
    pub target: &'a [f64],
    /// The samples that are judged: moving ones and those about reversals.
    pub mask: Vec<bool>,
}

impl<'a> Apart<'a> {
    /// The difference of a record; `None` where there is no load scale.
    pub(crate) fn on(motion: &'a Kinematics, path: Path<'a>) -> Option<Self> {
        let pairs = motion.moving.iter().zip(&motion.slow);
        Some(Self {
            motion,
            path,
            target: motion.difference.as_deref()?,
            mask: pairs.map(|(moving, slow)| *moving || *slow).collect(),
        })
    }

    fn columns(&self, way: Way) -> Vec<Vec<f64>> {
        way.columns(self.motion, self.path)
    }

    fn design(&self, ways: &[Way]) -> Vec<Vec<f64>> {
        ways.iter().flat_map(|way| self.columns(*way)).collect()
    }

    /// Gram matrices over the samples that are judged.
    pub(crate) fn blocks(&self, ways: &[Way]) -> Blocks {
        let design = self.design(ways);
        let columns: Vec<&[f64]> = design.iter().map(Vec::as_slice).collect();
        Blocks::new(&columns, self.target, &self.mask, self.motion.period_s)
    }

    /// Errors on blocks that were held out of the fit.
    pub(crate) fn cross_validate(&self, ways: &[Way]) -> Fit {
        self.blocks(ways).cross_validate()
    }

    /// Ways with the coefficients that leave least.
    pub(crate) fn fit(&self, ways: &[Way]) -> FittedWays {
        let coefficients = self.blocks(ways).fit().coefficients;
        let mut rest = coefficients.into_iter();
        let mut own = |way: Way| rest.by_ref().take(self.columns(way).len()).collect();
        FittedWays(ways.iter().map(|way| (*way, own(*way))).collect())
    }

    /// What fitted ways leave of each sample.
    pub(crate) fn residual(&self, fitted: &FittedWays) -> Vec<f64> {
        let mut predicted = vec![0.0; self.target.len()];
        for (way, own) in &fitted.0 {
            for (column, coefficient) in self.columns(*way).iter().zip(own) {
                let pairs = predicted.iter_mut().zip(column);
                pairs.for_each(|(sum, value)| *sum += coefficient * value);
            }
        }
        let pairs = self.target.iter().zip(predicted);
        pairs
            .map(|(target, predicted)| target - predicted)
            .collect()
    }

    /// Rms of what fitted ways leave, µm (µrad).
    pub(crate) fn rms_um(&self, fitted: &FittedWays) -> f64 {
        let residual = self.residual(fitted);
        let inside = residual
            .iter()
            .zip(&self.mask)
            .filter(|(_, inside)| **inside);
        let (sum, count) = inside.fold((0.0, 0.0), |(sum, count), (left, _)| {
            (sum + left.powi(2), count + 1.0)
        });
        1.0e6 * (sum / f64::max(count, 1.0)).sqrt()
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
        let path = Path {
            position,
            transmitted,
        };
        assert!(Apart::on(&axis.motion, path).is_none());
    }

    #[test]
    fn a_pitch_error_is_a_cosine_and_a_sine_with_a_wave_number() {
        let axis = axis(usual);
        let path = Path {
            position: &[0.0, 0.25, 0.5, 0.75],
            transmitted: &[],
        };
        // Half a period a unit: 0°, 45°, 90°, 135°.
        let columns = Way::Pitch { per_length: 0.5 }.columns(&axis.motion, path);
        let half = 0.5_f64.sqrt();
        let wanted = [[1.0, half, 0.0, -half], [0.0, half, 1.0, half]];
        for (value, wanted) in columns.iter().flatten().zip(wanted.iter().flatten()) {
            assert!((value - wanted).abs() < 1.0e-12, "{value} {wanted}");
        }
    }

    #[test]
    fn a_spring_is_wound_up_by_the_transmitted_force_less_the_motors_own() {
        let axis = apart_by(|x| x);
        let columns = apart(&axis).columns(Way::WindUp);
        let acceleration = axis.motion.low_passed(&axis.motion.acceleration);
        assert_eq!(columns, [axis.motion.effort_lp.clone(), acceleration]);
        let ones = apart(&axis).columns(Way::Constant);
        assert_eq!(ones, [vec![1.0; axis.motion.len()]]);
        let gap = Behind {
            gap: 2.0e-6,
            coulomb: 1.0,
            ..Behind::default()
        };
        let lag = gap.follow(&axis.dataset.train.position, 1.0e-3);
        assert_eq!(apart(&axis).columns(Way::Play(gap)), [lag]);
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
        apart.target = &target;
        // √((9 + 9 + 25 + 25)/4) µm; the rows of a metre are outside.
        let rms = apart.rms_um(&FittedWays::default());
        assert!((rms - 17.0_f64.sqrt()).abs() < 1.0e-9, "{rms}");
        apart.mask.fill(false);
        assert_eq!(apart.rms_um(&FittedWays::default()), 0.0);
    }
}
