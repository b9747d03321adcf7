//! What happens about reversals: stick, bristle or gap.
//!
//! Moving samples hardly show presliding or a gap. Judged here is the friction that is observed about reversals, effort − everything but the sign
//! columns, against three models of the same level G(v):
//! - [`stick`]: rigid Coulomb friction; at standstill the friction is whatever holds, up to G;
//! - [`bristle`]: Dahl's hysteresis over a deflection δ, without that freedom;
//! - [`gap`]: a load behind a gap, which takes its friction and its mass away from the motor while that crosses.
//!
//! What separates bristle and gap in the motor's signals: in a bristle the friction turns over with *distance*, from −G to G; in a gap it falls to
//! zero, and with it the effort of the load's inertia, and comes back with an impact.

pub mod bristle;
pub mod gap;
pub mod stick;

use crate::bench::{Bench, Model};
use crate::kinematics::Kinematics;
use crate::record::Dataset;

/// Rms ratio of Dahl to rigid Coulomb friction, at most.
pub const RATIO: f64 = 0.7;
/// Above this ratio nothing is suspected at reversals.
pub const SUSPICION: f64 = 0.85;
/// Smallest t: there are few reversals in a record, so it is small even where the ratio is 0.07.
const T: f64 = 1.2;
/// Rms ratio of gap to rigid Coulomb friction, at most.
pub const GAP_RATIO: f64 = 0.55;
/// Rms ratio of gap to Dahl, at most.
const GAP_TO_BRISTLE: f64 = 0.8;
/// Smallest t of a gap.
const GAP_T: f64 = 2.5;
/// Smallest deflection or gap, in counts of the encoder.
const FEWEST_COUNTS: f64 = 2.0;
/// Slow runs up to this length are reversals; longer ones are rests, s.
const LONGEST_REVERSAL_S: f64 = 0.150;
/// Reversals are judged with so much about them, s.
const ABOUT_S: f64 = 0.040;

/// Friction about reversals, as observed, with the level of the model.
pub struct Observed<'a> {
    /// The motion.
    pub motion: &'a Kinematics,
    /// Level G(v) of the sign columns.
    pub level: Vec<f64>,
    /// Effort − all other columns, low-passed.
    pub friction: Vec<f64>,
    /// Moved mass of the fit.
    pub inertia: f64,
    /// Viscous friction of the fit.
    pub viscous: f64,
    /// Resolution of the encoder where friction acts.
    pub resolution: f64,
    /// Samples that are judged: short reversals with their neighbourhood.
    pub about: Vec<bool>,
}

/// What the samples about reversals say.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reversal {
    /// Rms error with rigid Coulomb friction, over all slow samples.
    pub rigid: f64,
    /// Rms error with Dahl's bristle, over all slow samples.
    pub dahl: f64,
    /// Rms error with rigid Coulomb friction about reversals.
    pub rigid_about: f64,
    /// Rms error with Dahl's bristle about reversals.
    pub dahl_about: f64,
    /// Rms error with a gap about reversals.
    pub gap_about: f64,
    /// Best deflection δ.
    pub deflection: f64,
    /// Best gap.
    pub gap: gap::Gap,
    /// Mean over standard error of the bristle's gain per reversal.
    pub t: f64,
    /// Mean over standard error of the gap's gain per reversal.
    pub gap_t: f64,
    /// Whether presliding is accepted.
    pub presliding: bool,
    /// Whether backlash is accepted.
    pub backlash: bool,
}

/// Judges reversals for a model; `None` where the model has no Coulomb friction or the record no reversals.
#[must_use]
pub fn judge(bench: &Bench<'_>, model: &Model, coefficients: &[f64]) -> Option<Reversal> {
    let motion = bench.motion;
    if motion.slow.iter().filter(|slow| **slow).count() < 200 {
        return None;
    }
    let observed = Observed::new(bench, model, coefficients)?;
    let rigid = stick::error(&observed);
    let (deflection, dahl) = bristle::best(&observed, bench.dataset.kind.moving_velocity());
    let (gap, behind_gap) = gap::best(&observed, bench.dataset.kind.moving_velocity());
    let smallest = FEWEST_COUNTS * observed.resolution;
    let (t, gap_t) = (block_t(&motion.slow, &rigid, &dahl), block_t(&observed.about, &rigid, &behind_gap));
    let about = |error: &[f64]| rms(error, &observed.about);
    let mut reversal = Reversal {
        rigid: rms(&rigid, &motion.slow),
        dahl: rms(&dahl, &motion.slow),
        rigid_about: about(&rigid),
        dahl_about: about(&dahl),
        gap_about: about(&behind_gap),
        deflection,
        gap,
        t,
        gap_t,
        presliding: false,
        backlash: false,
    };
    // With a load scale a gap shows in motor - load, and friction is judged where it acts.
    reversal.backlash = motion.difference.is_none()
        && reversal.gap_about <= GAP_RATIO * reversal.rigid_about
        && reversal.gap_about <= GAP_TO_BRISTLE * reversal.dahl_about
        && gap_t >= GAP_T
        && gap.width >= smallest;
    reversal.presliding =
        !reversal.backlash && reversal.dahl <= RATIO * reversal.rigid && t >= T && deflection >= smallest;
    Some(reversal)
}

/// Rms of the effort about reversals and rests that a model does not explain.
#[must_use]
pub fn error_rms(bench: &Bench<'_>, model: &Model, coefficients: &[f64], accepted: Option<&Reversal>) -> Option<f64> {
    let observed = Observed::new(bench, model, coefficients)?;
    let error = match accepted {
        Some(reversal) if reversal.presliding => bristle::error(&observed, reversal.deflection),
        Some(reversal) if reversal.backlash => gap::error(&observed, reversal.gap),
        Some(_) | None => stick::error(&observed),
    };
    Some(rms(&error, &bench.motion.slow))
}

/// Smallest δ or gap that a dataset can show from one encoder.
#[must_use]
pub fn resolution(dataset: &Dataset) -> f64 {
    FEWEST_COUNTS * encoder_resolution(dataset)
}

/// Resolution of the encoder where friction acts: the load scale if there is one.
fn encoder_resolution(dataset: &Dataset) -> f64 {
    if dataset.train.load.is_some() { dataset.load_resolution } else { dataset.resolution }
}

impl<'a> Observed<'a> {
    fn new(bench: &Bench<'a>, model: &Model, coefficients: &[f64]) -> Option<Self> {
        let motion = bench.motion;
        let mut level = vec![0.0; motion.len()];
        let mut others = vec![0.0; motion.len()];
        let mut rest = coefficients.iter();
        let (mut has_coulomb, mut inertia, mut viscous) = (false, 0.0, 0.0);
        for term in &model.terms {
            let is_sign = matches!(term.effect.name(), "coulomb" | "stribeck" | "position_dependent_friction");
            has_coulomb |= term.effect.name() == "coulomb";
            for column in term.effect.columns(motion, bench.dataset, term.parameter) {
                let coefficient = rest.next()?;
                match term.effect.name() {
                    "inertia" => inertia = *coefficient,
                    "viscous" => viscous = *coefficient,
                    _ => {}
                }
                if is_sign {
                    let signed = column.iter().zip(&motion.direction);
                    level.iter_mut().zip(signed).for_each(|(level, (c, d))| *level += coefficient * c * d);
                } else {
                    let column = motion.filter.apply(&column);
                    others.iter_mut().zip(column).for_each(|(others, c)| *others += coefficient * c);
                }
            }
        }
        let friction = motion.effort_lp.iter().zip(others).map(|(effort, others)| effort - others).collect();
        let resolution = encoder_resolution(bench.dataset);
        let about = about_reversals(motion);
        has_coulomb.then_some(Self { motion, level, friction, inertia, viscous, resolution, about })
    }
}

/// Slow runs that are short enough to be reversals, with what is about them.
fn about_reversals(motion: &Kinematics) -> Vec<bool> {
    let rows = motion.len();
    let longest = (LONGEST_REVERSAL_S / motion.period_s).round() as usize;
    let margin = (ABOUT_S / motion.period_s).round() as usize;
    let mut about = vec![false; rows];
    let mut row = 0;
    while row < rows {
        let run = motion.slow[row..].iter().take_while(|slow| **slow).count();
        if run > 0 && run <= longest {
            about[row.saturating_sub(margin)..(row + run + margin).min(rows)].fill(true);
        }
        row += run.max(1);
    }
    about
}

/// Rms over a mask.
#[must_use]
pub fn rms(error: &[f64], mask: &[bool]) -> f64 {
    let inside = error.iter().zip(mask).filter(|(_, inside)| **inside);
    let (sum, count) = inside.fold((0.0, 0.0), |(sum, count), (e, _)| (sum + e * e, count + 1.0));
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
    let count = gains.len() as f64;
    let mean = gains.iter().sum::<f64>() / count.max(1.0);
    let variance = gains.iter().map(|gain| (gain - mean).powi(2)).sum::<f64>() / (count - 1.0).max(1.0);
    mean / (variance / count.max(1.0)).sqrt().max(f64::MIN_POSITIVE)
}
