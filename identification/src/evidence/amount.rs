//! How much of the effort of motion a model leaves, and whether it can be noise.
//!
//! The effort of motion is the effort without its mean: gravity is not motion. Noise and
//! quantisation leave a residual that is as slow as the low-pass makes it; what is left of a motion
//! is slower.

use crate::evidence::inverse_dynamics::InverseDynamics;
use crate::evidence::reversal::rms;
use crate::evidence::thresholds::{LEFT_PERCENT, NOISE_SLOWNESS};
use crate::evidence::verdict::Reason;
use crate::motion::kinematics::Kinematics;
use crate::record::dataset::Dataset;

/// How much is left.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Amount {
    /// Rms of the residual, percent of the effort without its mean.
    pub percent: f64,
    /// Correlation time of the residual over that of low-passed white noise.
    pub slowness: f64,
}

impl Amount {
    /// What a residual is beside the effort of its motion.
    pub(crate) fn of(motion: &Kinematics, residual: &[f64]) -> Self {
        let moved = about_mean(&motion.effort_lp, &motion.fitted).max(f64::MIN_POSITIVE);
        Self {
            percent: 100.0 * rms(residual, &motion.fitted) / moved,
            slowness: slowness(motion, residual, &motion.fitted),
        }
    }

    /// What it says, with words for where it is left.
    pub(crate) fn reason(&self, left: &str) -> Option<Reason> {
        let words = format!("{:.0} % {left}", self.percent);
        (self.percent > LEFT_PERCENT).then(|| {
            if self.slowness > NOISE_SLOWNESS {
                let times = self.slowness;
                Reason::unexplained(format!(
                    "{words}, {times:.1} times as slow as noise would be"
                ))
            } else {
                Reason::told(format!("{words}, as fast as noise"))
            }
        })
    }
}

/// What a structure leaves of another record with that record's own coefficients: another day has
/// another friction, but no other structure.
pub(crate) fn on_another_record(
    dataset: &Dataset,
    other: &Kinematics,
    model: &InverseDynamics,
) -> Option<Reason> {
    let left = model.refitted(dataset, other).on(dataset, other);
    let left = Amount::of(other, &left.residual);
    left.reason("of the effort of motion is left on the validation record, even with coefficients of its own")
}

/// Rms about the mean.
pub(crate) fn about_mean(signal: &[f64], mask: &[bool]) -> f64 {
    let inside = || signal.iter().zip(mask).filter(|(_, inside)| **inside);
    let mean = inside().map(|(value, _)| value).sum::<f64>() / inside().count().max(1) as f64;
    let apart: Vec<f64> = signal.iter().map(|value| value - mean).collect();
    rms(&apart, mask)
}

/// Correlation time of a low-passed signal over that of low-passed white noise: the sum of the
/// autocorrelation up to its first zero.
pub(crate) fn slowness(motion: &Kinematics, signal: &[f64], mask: &[bool]) -> f64 {
    over_noise(motion, signal, mask, |signal, mask| {
        let ratios = autocorrelation(signal, mask);
        let positive = ratios.take_while(|ratio| *ratio > 0.0);
        positive.sum::<f64>().max(1.0)
    })
}

/// The sum of the squares of the autocorrelation of a low-passed signal over that of low-passed
/// white noise: about one for noise, more for what is slower and for a wave of any frequency
/// (the number of independent samples falls so: Bartlett, JRSS 98, 1935).
pub(crate) fn colour(motion: &Kinematics, signal: &[f64], mask: &[bool]) -> f64 {
    let lags = (COLOUR_PERIODS / (motion.filter.cutoff_hz * motion.period_s)) as usize;
    over_noise(motion, signal, mask, |signal, mask| {
        let ratios = autocorrelation(signal, mask).take(lags.max(1));
        ratios.map(|ratio| ratio.powi(2)).sum::<f64>()
    })
}

/// Longest lag of [`colour`], in periods of the low-pass's cut-off: a wave that lasts for so long
/// is no noise.
const COLOUR_PERIODS: f64 = 40.0;

/// What is measured on a signal, over the same of the impulse response of a record's low-pass: that
/// is as slow and as coloured as white noise behind it.
fn over_noise(
    motion: &Kinematics,
    signal: &[f64],
    mask: &[bool],
    measured: impl Fn(&[f64], &[bool]) -> f64,
) -> f64 {
    let mut impulse = vec![0.0; IMPULSE_ROWS];
    impulse[IMPULSE_ROWS / 2] = 1.0;
    let response = motion.filter.apply(&impulse);
    measured(signal, mask) / measured(&response, &vec![true; IMPULSE_ROWS])
}

/// The mean products of the samples of a mask with later ones, over those with themselves: by lag,
/// up to a twentieth of the signal.
fn autocorrelation(signal: &[f64], mask: &[bool]) -> impl Iterator<Item = f64> {
    let at = |lag: usize| {
        let pairs = (0..signal.len() - lag).filter(|row| mask[*row] && mask[row + lag]);
        let products = pairs.map(|row| (signal[row] * signal[row + lag], 1.0));
        let (sum, count) = products.fold((0.0, 0.0), |(s, n), (p, one)| (s + p, n + one));
        sum / f64::max(count, 1.0)
    };
    let whole = at(0).max(f64::MIN_POSITIVE);
    (0..signal.len() / 20).map(move |lag| at(lag) / whole)
}

/// Rows in which the impulse of a low-pass of a tenth of the sample rate, or of 20 Hz at 1 kHz, has
/// died away.
const IMPULSE_ROWS: usize = 4001;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::made::{Axis, axis, model, usual};
    use axis_model::EffectName::{Coulomb, Inertia, Offset, Viscous};

    /// An axis with a force more than the usual ones.
    fn with(force: impl Fn(&Kinematics, usize) -> f64) -> Axis {
        axis(move |motion, row| usual(motion, row) + force(motion, row))
    }

    fn fitted(axis: &Axis) -> InverseDynamics {
        InverseDynamics {
            fitted: axis
                .bench()
                .fit(&model(&[Inertia, Viscous, Coulomb, Offset])),
            bristle: None,
            by_the_load: None,
            slips_at: None,
        }
    }

    fn wave(motion: &Kinematics, row: usize) -> f64 {
        20.0 * (61.0 * motion.time_s[row]).sin()
    }

    fn counts(reason: Option<Reason>) -> Option<bool> {
        reason.map(|reason| reason.counts)
    }

    #[test]
    fn a_slow_rest_counts_where_much_is_left_and_noise_is_told() {
        let axis = with(wave);
        let left = Amount::of(&axis.motion, &axis.bench().residual(&fitted(&axis).fitted));
        assert!(left.slowness > NOISE_SLOWNESS, "{}", left.slowness);
        assert!(left.percent > LEFT_PERCENT, "{}", left.percent);
        assert_eq!(counts(left.reason("is left")), Some(true));
        let slowness = NOISE_SLOWNESS - 0.1;
        assert_eq!(
            counts(Amount { slowness, ..left }.reason("is left")),
            Some(false)
        );
        let percent = LEFT_PERCENT - 0.1;
        assert_eq!(Amount { percent, ..left }.reason("is left"), None);
    }

    #[test]
    fn another_record_may_have_other_coefficients_but_no_other_structure() {
        let fitted = fitted(&with(|_, _| 0.0));
        let reason = |other: &Axis| on_another_record(&other.dataset, &other.motion, &fitted);
        let warmer = with(|motion, row| 15.0 * motion.direction[row]);
        assert_eq!(reason(&warmer), None);
        let other = with(wave);
        let words = reason(&other).unwrap().words;
        assert!(words.contains("on the validation record"), "{words}");
        assert_eq!(counts(reason(&other)), Some(true));
    }
}
