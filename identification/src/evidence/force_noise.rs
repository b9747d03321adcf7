//! Noise of the force: what only the record has, and what acts on the axis.
//!
//! What a model leaves of the effort is both. Where the controller is known it tells them apart: it
//! gives what was asked for from the recorded positions, so what the recorded effort differs from
//! that by is noise of the record. What the model leaves of the effort that was asked for has acted
//! on the axis, or is structure, or rounding of the positions. Structure is slow, so what lies
//! between the two cut-offs of the fit is taken, and white noise is as large as that makes it.

use axis_model::EffectName;

use crate::evidence::inverse_dynamics::InverseDynamics;
use crate::evidence::reversal::rms;
use crate::fit::bench::Bench;
use crate::motion::derivatives::Derivatives;
use crate::motion::filter::LowPass;
use crate::motion::kinematics::Kinematics;
use crate::motion::lag::acting_effort;
use crate::record::dataset::Dataset;
use crate::simulate::controller::law::Law;

/// Rows about the impulse whose answer is that of a low-pass.
const ROWS: usize = 2000;

/// Product of neighbours over the square, in its standard errors, up to which noise is white.
const WHITE: f64 = 2.0;
/// Fewest seconds of moving rows that tell the noise.
const FEWEST_SECONDS: usize = 5;

/// White noise of the force, rms in the unit of the effort.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ForceNoise {
    /// Of the record alone.
    pub recorded: f64,
    /// Acting on the axis.
    pub acting: f64,
}

/// The mean squares of a signal at a cut-off, and what of it is known.
#[derive(Clone, Copy, Debug)]
struct Band {
    /// All of it.
    square: f64,
    /// Rounding of the positions.
    rounding: f64,
    /// White noise of one.
    white: f64,
}

/// The noise of a training record whose controller follows a law; the motion is that of both
/// cut-offs. `None` where they are the same.
pub(crate) fn force_noise(
    dataset: &Dataset,
    motion: [&Kinematics; 2],
    model: &InverseDynamics,
    law: &Law,
) -> Option<ForceNoise> {
    let of_record = law.leaves_of(&dataset.train);
    let (period_s, hold) = (dataset.train.period_s, dataset.hold);
    let acting = acting_effort(&of_record, dataset.effort_lag_s, period_s, hold);
    let mask = where_the_law_holds(&of_record, &motion[0].fitted, period_s)?;
    let mass = model.fitted.of(EffectName::Inertia);
    let mass = mass.and_then(<[f64]>::first).copied().unwrap_or(0.0);
    let band = |motion: &Kinematics| {
        let seen = model.motion(motion);
        let left = Bench::new(dataset, &seen).residual(&model.fitted);
        let of_record = motion.low_passed(&acting);
        let asked: Vec<f64> = left.iter().zip(&of_record).map(|(a, b)| a - b).collect();
        let counted = mass.powi(2) * dataset.resolution.powi(2) / 12.0;
        Band {
            square: rms(&asked, &mask).powi(2),
            rounding: counted * second_differences(dataset, &motion.filter),
            white: white(&motion.filter),
        }
    };
    let [wide, narrow] = motion.map(band);
    Some(ForceNoise {
        recorded: rms(&of_record, &mask),
        acting: between(wide, narrow)?,
    })
}

/// The rows of a mask in the seconds in which a law leaves nothing that goes on from row to row:
/// there the recorded effort is what it asked for, and noise. `None` where these are few.
fn where_the_law_holds(left: &[f64], mask: &[bool], period_s: f64) -> Option<Vec<bool>> {
    let second = ((1.0 / period_s).round() as usize).max(1);
    let mut holds = vec![false; mask.len()];
    for (at, values) in left.chunks(second).enumerate() {
        let neighbours: f64 = values.windows(2).map(|pair| pair[0] * pair[1]).sum();
        let share = neighbours / sum_of_squares(values).max(f64::MIN_POSITIVE);
        if share.abs() <= WHITE / (values.len() as f64).sqrt() {
            let rows = at * second..at * second + values.len();
            holds[rows.clone()].copy_from_slice(&mask[rows]);
        }
    }
    let rows = holds.iter().filter(|inside| **inside).count();
    (rows >= FEWEST_SECONDS * second).then_some(holds)
}

/// White noise that is as large between two cut-offs as what is there beside rounding.
fn between(wide: Band, narrow: Band) -> Option<f64> {
    let square = wide.square - wide.rounding - (narrow.square - narrow.rounding);
    let white = wide.white - narrow.white;
    (white > 0.0).then(|| (square.max(0.0) / white).sqrt())
}

/// One at a row, nothing about it.
fn impulse() -> Vec<f64> {
    let mut impulse = vec![0.0; 2 * ROWS + 1];
    impulse[ROWS] = 1.0;
    impulse
}

fn sum_of_squares(answer: &[f64]) -> f64 {
    answer.iter().map(|value| value * value).sum()
}

/// Mean square that a low-pass leaves of white noise of one.
pub(crate) fn white(filter: &LowPass) -> f64 {
    sum_of_squares(&filter.apply(&impulse()))
}

/// The same of the acceleration from positions that are white noise of one.
pub(crate) fn second_differences(dataset: &Dataset, filter: &LowPass) -> f64 {
    let plain = Derivatives::new(&impulse(), dataset.train.period_s, dataset.hold);
    let derivatives = if dataset.is_sharpened {
        plain.sharpened(dataset.hold)
    } else {
        plain
    };
    sum_of_squares(&filter.apply(&derivatives.acceleration))
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// Half a step to either side, the same every time (Knuth's MMIX generator).
    pub(crate) fn noise() -> impl FnMut() -> f64 {
        let mut state = 1_u64;
        move || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
        }
    }

    #[test]
    fn a_low_pass_of_a_tenth_of_the_rate_leaves_a_fifth_of_white_noise() {
        let wide = white(&LowPass::new(1.0e-3, 100.0).unwrap());
        let narrow = white(&LowPass::new(1.0e-3, 30.0).unwrap());
        assert!((0.17..0.20).contains(&wide), "{wide}");
        assert!((narrow / wide - 0.3).abs() < 0.02, "{narrow} {wide}");
    }

    #[test]
    fn the_law_holds_in_the_seconds_in_which_it_leaves_noise() {
        // Ten seconds of noise, a slow error beside it in the last three.
        let mut noise = noise();
        let slow = |row: usize| if row < 7000 { 0.0 } else { 0.5 };
        let left: Vec<f64> = (0..10_000).map(|row| noise() + slow(row)).collect();
        let mut mask = vec![true; left.len()];
        mask[0] = false;
        let holds = where_the_law_holds(&left, &mask, 1.0e-3).unwrap();
        let rows = |from: usize, to: usize| holds[from..to].iter().filter(|row| **row).count();
        assert!(!holds[0] && rows(0, 7000) >= 5000 && rows(7000, 10_000) == 0);
        mask[..3000].fill(false);
        assert!(where_the_law_holds(&left, &mask, 1.0e-3).is_none());
    }

    #[test]
    fn noise_is_what_lies_between_the_cut_offs_and_slow_structure_is_none() {
        let band = |white: f64, rounding: f64| Band {
            // 4.5 N of noise, 2 N of structure at both cut-offs.
            square: 4.5 * 4.5 * white + 4.0 + rounding,
            rounding,
            white,
        };
        let noise = between(band(0.19, 0.3), band(0.06, 0.01)).unwrap();
        assert!((noise - 4.5).abs() < 1.0e-9, "{noise}");
        assert!(between(band(0.19, 0.3), band(0.19, 0.3)).is_none());
        let slow = Band {
            square: 9.0,
            ..band(0.06, 0.0)
        };
        assert_eq!(between(band(0.19, 0.0), slow), Some(0.0));
    }
}
