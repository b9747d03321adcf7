//! Presliding: what happens between stick and slip, judged on the samples about reversals.
//!
//! The friction that is observed there, effort − everything but the sign columns, is compared with two models of the same level G(v): rigid
//! Coulomb friction *with* a stick phase (at standstill the friction is whatever holds, up to G), and Dahl's bristle,
//! `dz = (sign(dx) − z)(1 − exp(−|dx| / δ))`, force G·z (Dahl 1968), which has no such freedom. Moving samples hardly show presliding: at
//! δ of a few micrometres the force error there does not change.

use crate::kinematics::Kinematics;
use crate::record::Dataset;
use crate::selection::{Bench, Model};

/// Rms ratio of Dahl to rigid Coulomb friction, at most. On simulated records without presliding it was at least 1.15, with it (stiffness 2·10⁷ to
/// 1.2·10⁸ N/m at 170 to 310 N) 0.06 to 0.62 in five of six.
pub const RATIO: f64 = 0.7;
/// Above this ratio nothing is suspected at reversals.
pub const SUSPICION: f64 = 0.85;
/// Smallest t: there are few reversals in a record, so it is small even where the ratio is 0.07.
const T: f64 = 1.2;
/// Smallest deflection, in counts of the encoder.
const FEWEST_COUNTS: f64 = 2.0;
/// The axis stands while it moves less than this, counts in six samples.
const STICK_COUNTS: f64 = 1.5;
/// Deflections that are searched, in moving-velocity units times a second: 0.3 to 300 µm on a linear axis.
const SMALLEST: f64 = 3.0e-4;
const LARGEST: f64 = 0.3;

/// What the samples about reversals say.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Presliding {
    /// Rms error with rigid Coulomb friction.
    pub rigid: f64,
    /// Rms error with Dahl's bristle.
    pub dahl: f64,
    /// Best deflection δ.
    pub deflection: f64,
    /// Mean over standard error of the gain per reversal block.
    pub t: f64,
    /// Whether presliding is accepted.
    pub accepted: bool,
}

/// Dahl's state, −1…1, along a position.
#[must_use]
pub fn dahl(position: &[f64], deflection: f64) -> Vec<f64> {
    let mut state = 0.0_f64;
    let mut before = position.first().copied().unwrap_or(0.0);
    position
        .iter()
        .map(|x| {
            let step = x - before;
            before = *x;
            if step != 0.0 {
                state = step.signum() + (state - step.signum()) * (-step.abs() / deflection).exp();
            }
            state
        })
        .collect()
}

/// Judges presliding for a model; `None` where the model has no Coulomb friction or the record no reversals.
#[must_use]
pub fn presliding(bench: &Bench<'_>, model: &Model, coefficients: &[f64]) -> Option<Presliding> {
    let motion = bench.motion;
    if motion.slow.iter().filter(|slow| **slow).count() < 200 {
        return None;
    }
    let (level, observed) = level_and_observed(bench, model, coefficients)?;
    let resolution = encoder_resolution(bench.dataset);
    let rigid = rigid_error(motion, &level, &observed, resolution);
    let unit = bench.dataset.kind.moving_velocity();
    let error = |deflection: f64| dahl_error(motion, &level, &observed, deflection);
    let grid = crate::effects::geometric(SMALLEST * unit, LARGEST * unit, 24);
    let best = grid.into_iter().min_by(|a, b| rms(&error(*a), motion).total_cmp(&rms(&error(*b), motion)))?;
    let deflection = golden(best / 1.4, best * 1.4, &|deflection| rms(&error(deflection), motion));
    let bristle = error(deflection);
    let t = block_t(motion, &rigid, &bristle);
    let (rigid, dahl) = (rms(&rigid, motion), rms(&bristle, motion));
    let accepted = dahl <= RATIO * rigid && t >= T && deflection >= self::resolution(bench.dataset);
    Some(Presliding { rigid, dahl, deflection, t, accepted })
}

/// Rms of the effort about reversals that a model does not explain: with a bristle of the given deflection, else with rigid stick.
#[must_use]
pub fn error_rms(bench: &Bench<'_>, model: &Model, coefficients: &[f64], deflection: Option<f64>) -> Option<f64> {
    let (level, observed) = level_and_observed(bench, model, coefficients)?;
    let error = match deflection {
        Some(deflection) => dahl_error(bench.motion, &level, &observed, deflection),
        None => rigid_error(bench.motion, &level, &observed, encoder_resolution(bench.dataset)),
    };
    Some(rms(&error, bench.motion))
}

/// Resolution of the encoder where friction acts: the load scale if there is one.
fn encoder_resolution(dataset: &Dataset) -> f64 {
    if dataset.train.load.is_some() { dataset.load_resolution } else { dataset.resolution }
}

/// Level G(v) of the sign columns, and effort − all other columns, low-passed.
fn level_and_observed(bench: &Bench<'_>, model: &Model, coefficients: &[f64]) -> Option<(Vec<f64>, Vec<f64>)> {
    let motion = bench.motion;
    let mut level = vec![0.0; motion.len()];
    let mut others = vec![0.0; motion.len()];
    let mut rest = coefficients.iter();
    let mut has_coulomb = false;
    for term in &model.terms {
        let is_sign = matches!(term.effect.name(), "coulomb" | "stribeck" | "position_dependent_friction");
        has_coulomb |= term.effect.name() == "coulomb";
        for column in term.effect.columns(motion, bench.dataset, term.parameter) {
            let coefficient = rest.next()?;
            if is_sign {
                let signed = column.iter().zip(&motion.direction);
                level.iter_mut().zip(signed).for_each(|(level, (c, d))| *level += coefficient * c * d);
            } else {
                let column = motion.filter.apply(&column);
                others.iter_mut().zip(column).for_each(|(others, c)| *others += coefficient * c);
            }
        }
    }
    let observed = motion.effort_lp.iter().zip(others).map(|(effort, others)| effort - others).collect();
    has_coulomb.then_some((level, observed))
}

fn rigid_error(motion: &Kinematics, level: &[f64], observed: &[f64], resolution: f64) -> Vec<f64> {
    let x = &motion.friction_position;
    let slipping: Vec<f64> = level.iter().zip(&motion.direction).map(|(level, direction)| level * direction).collect();
    let slipping = motion.filter.apply(&slipping);
    (0..motion.len())
        .map(|at| {
            let (from, to) = (at.saturating_sub(3), (at + 3).min(motion.len() - 1));
            if (x[to] - x[from]).abs() <= STICK_COUNTS * resolution {
                let level = level[at].abs();
                observed[at] - observed[at].min(level).max(-level)
            } else {
                observed[at] - slipping[at]
            }
        })
        .collect()
}

fn dahl_error(motion: &Kinematics, level: &[f64], observed: &[f64], deflection: f64) -> Vec<f64> {
    let state = dahl(&motion.friction_position, deflection);
    let force: Vec<f64> = level.iter().zip(state).map(|(level, state)| level * state).collect();
    motion.filter.apply(&force).iter().zip(observed).map(|(force, observed)| observed - force).collect()
}

fn rms(error: &[f64], motion: &Kinematics) -> f64 {
    let slow = error.iter().zip(&motion.slow).filter(|(_, slow)| **slow);
    let (sum, count) = slow.fold((0.0, 0.0), |(sum, count), (e, _)| (sum + e * e, count + 1.0));
    (sum / f64::max(count, 1.0)).sqrt()
}

/// Mean over standard error of the gain, one value per contiguous run of slow samples.
fn block_t(motion: &Kinematics, before: &[f64], after: &[f64]) -> f64 {
    let mut gains: Vec<f64> = Vec::new();
    let mut inside = false;
    for ((slow, b), a) in motion.slow.iter().zip(before).zip(after) {
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

fn golden(mut low: f64, mut high: f64, error: &dyn Fn(f64) -> f64) -> f64 {
    const RATIO: f64 = 0.618_033_988_749_894_9;
    for _ in 0..12 {
        let (a, b) = (high - RATIO * (high - low), low + RATIO * (high - low));
        if error(a) < error(b) { high = b } else { low = a }
    }
    0.5 * (low + high)
}

/// Motion whose direction columns follow Dahl's state instead of the sign.
#[must_use]
pub fn with_presliding(motion: &Kinematics, deflection: f64) -> Kinematics {
    Kinematics { direction: dahl(&motion.friction_position, deflection), ..motion.clone() }
}

/// Smallest δ that a dataset can show.
#[must_use]
pub fn resolution(dataset: &Dataset) -> f64 {
    FEWEST_COUNTS * encoder_resolution(dataset)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_bristle_saturates_and_reverses_over_its_deflection() {
        let there: Vec<f64> = (0..100).map(f64::from).collect();
        let back: Vec<f64> = (0..100).map(|i| 99.0 - f64::from(i)).collect();
        let state = dahl(&[there, back].concat(), 5.0);
        assert!((state[99] - 1.0).abs() < 1.0e-6 && (state[199] + 1.0).abs() < 1.0e-6);
        // One deflection after the reversal (row 100 repeats the turning point): −1 + 2/e.
        assert!((state[105] - (2.0 * (-1.0_f64).exp() - 1.0)).abs() < 1.0e-6);
    }
}
