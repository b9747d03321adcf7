//! What happens about reversals, in the inverse model: stick or bristle.
//!
//! Moving samples hardly show presliding. Judged here is the friction that is observed about
//! reversals, effort − everything but the sign columns, against two models of the same level G(v):
//! [`stick`], rigid Coulomb friction that holds whatever there is at standstill, and [`bristle`],
//! Dahl's hysteresis, without that freedom. A gap cannot be judged this way (its impacts are not in
//! the low-passed effort): see [`crate::evidence::free_run`].

pub(crate) mod bristle;
pub(crate) mod stick;

use axis_model::EffectName;

use crate::evidence::thresholds::{BRISTLE_RATIO, BRISTLE_T, FEWEST_COUNTS};
use crate::fit::bench::Bench;
use crate::fit::fitted::{Fitted, Term};
use crate::motion::kinematics::Kinematics;
use crate::record::dataset::Dataset;

/// Friction about reversals, as observed, with the level of the model.
pub(crate) struct Observed<'a> {
    /// The motion.
    pub motion: &'a Kinematics,
    /// Level G(v) of the sign columns.
    pub level: Vec<f64>,
    /// Effort − all other columns, low-passed.
    pub friction: Vec<f64>,
    /// Resolution of the encoder where friction acts.
    pub resolution: f64,
}

/// What the samples about reversals say.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Presliding {
    /// Rms error with rigid Coulomb friction.
    pub rigid: f64,
    /// Rms error with Dahl's bristle.
    pub dahl: f64,
    /// Best deflection δ.
    pub deflection: f64,
    /// Mean over standard error of the gain per reversal.
    pub t: f64,
    /// Whether presliding is accepted.
    pub accepted: bool,
}

/// Judges presliding for a model; `None` where the model has no Coulomb friction or the record no
/// reversals.
#[must_use]
pub(crate) fn presliding(bench: &Bench<'_>, fitted: &Fitted) -> Option<Presliding> {
    let motion = bench.motion;
    if motion.slow.iter().filter(|slow| **slow).count() < 200 {
        return None;
    }
    let observed = Observed::new(bench, fitted)?;
    let rigid = stick::error(&observed);
    let (deflection, bristle) = bristle::best(&observed, bench.dataset.kind.moving_velocity());
    let t = block_t(&motion.slow, &rigid, &bristle);
    let (rigid, dahl) = (rms(&rigid, &motion.slow), rms(&bristle, &motion.slow));
    let accepted =
        dahl <= BRISTLE_RATIO * rigid && t >= BRISTLE_T && deflection >= resolution(bench.dataset);
    Some(Presliding {
        rigid,
        dahl,
        deflection,
        t,
        accepted,
    })
}

/// Rms of the effort about reversals that a model does not explain: with a bristle of the given
/// deflection, else with rigid stick.
#[must_use]
pub(crate) fn error_rms(
    bench: &Bench<'_>,
    fitted: &Fitted,
    deflection: Option<f64>,
) -> Option<f64> {
    let observed = Observed::new(bench, fitted)?;
    let error = match deflection {
        Some(deflection) => bristle::error(&observed, deflection),
        None => stick::error(&observed),
    };
    Some(rms(&error, &bench.motion.slow))
}

/// Smallest δ that a dataset can show.
#[must_use]
pub(crate) fn resolution(dataset: &Dataset) -> f64 {
    FEWEST_COUNTS * encoder_resolution(dataset)
}

/// Resolution of the encoder where friction acts: the load scale if there is one.
fn encoder_resolution(dataset: &Dataset) -> f64 {
    if dataset.train.load.is_some() {
        dataset.load_resolution
    } else {
        dataset.resolution
    }
}

impl<'a> Observed<'a> {
    fn new(bench: &Bench<'a>, fitted: &Fitted) -> Option<Self> {
        fitted.of(EffectName::Coulomb)?;
        let motion = bench.motion;
        let mut level = vec![0.0; motion.len()];
        let mut others = vec![0.0; motion.len()];
        for Term { part, own } in fitted.terms() {
            let columns = part.effect.columns(motion, bench.dataset, part.parameter);
            for (column, coefficient) in columns.iter().zip(own) {
                if part.effect.is_level() {
                    let signed = column.iter().zip(&motion.direction);
                    level
                        .iter_mut()
                        .zip(signed)
                        .for_each(|(level, (c, d))| *level += coefficient * c * d);
                } else {
                    let column = motion.low_passed(column);
                    others
                        .iter_mut()
                        .zip(column)
                        .for_each(|(others, c)| *others += coefficient * c);
                }
            }
        }
        let friction = motion
            .effort_lp
            .iter()
            .zip(others)
            .map(|(effort, others)| effort - others)
            .collect();
        let resolution = encoder_resolution(bench.dataset);
        Some(Self {
            motion,
            level,
            friction,
            resolution,
        })
    }
}

/// Rms over a mask.
#[must_use]
pub(crate) fn rms(error: &[f64], mask: &[bool]) -> f64 {
    let inside = error.iter().zip(mask).filter(|(_, inside)| **inside);
    let (sum, count) = inside.fold((0.0, 0.0), |(sum, count), (e, _)| {
        (sum + e * e, count + 1.0)
    });
    (sum / f64::max(count, 1.0)).sqrt()
}

/// Mean over standard error of the gain, one value per contiguous run of a mask.
fn block_t(mask: &[bool], before: &[f64], after: &[f64]) -> f64 {
    let mut gains: Vec<f64> = Vec::new();
    let mut inside = false;
    for ((slow, b), a) in mask.iter().zip(before).zip(after) {
        if *slow && !inside {
            gains.push(0.0);
        }
        inside = *slow;
        if let (true, Some(gain)) = (*slow, gains.last_mut()) {
            *gain += b * b - a * a;
        }
    }
    crate::fit::blocks::t_of(&gains)
}
