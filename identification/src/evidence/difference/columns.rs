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
