//! A Butterworth low-pass of fourth order, run forwards and backwards: no phase.
//!
//! Four poles on a circle in the left half plane, `p = −Ω e^(iπm/8)`, m = −3, −1, 1, 3. The
//! bilinear transform `s = 4 (z − 1)/(z + 1)` brings them to `(4 + p)/(4 − p)`; Ω is warped so that
//! the cut-off stays where it is, `Ω = 4 tan(π f T)`. The transfer function is used in the second
//! direct form, transposed:
//!
//! ```text
//! y  = b₀ x + s₁
//! s₁ = −a₁ s₁ + s₂ + c₁ x      c = b − b₀ a
//! …
//! s₄ = −a₄ s₁      + c₄ x
//! ```
//!
//! As in `filtfilt` of SciPy: the state starts where a constant input leaves it, and the signal is
//! continued at both ends by its point reflection, over three times the order.
//!
//! A filter of one order that is known here takes a fifth of the time of one of any order, and the
//! searches filter thousands of columns. Each value waits for the one before it, so a long signal
//! goes through in [`LANES`] parts beside each other. A part begins as far before its rows as the
//! filter remembers: what it does not know of then is below the rounding.

use std::array::from_fn;
use std::f64::consts::PI;

use nalgebra::Complex;

const ORDER: usize = 4;
/// Rows by which a signal is continued at each end.
const PADDING: usize = 3 * ORDER;
/// The bilinear transform's factor for a sample rate of two.
const BILINEAR: f64 = 4.0;
/// Parts of a signal that are filtered beside each other.
const LANES: usize = 4;
/// What is left of an input once it is forgotten.
const FORGOTTEN: f64 = 1.0e-18;
/// A signal is cut into parts where each is so much longer than the filter's memory.
const WORTH_CUTTING: usize = 4;

/// States of the filter for signals beside each other.
type States<const N: usize> = [[f64; N]; ORDER];

/// The filter's coefficients.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Butterworth {
    /// b₀.
    through: f64,
    /// −a₁…−a₄.
    feedback: [f64; ORDER],
    /// c₁…c₄.
    input: [f64; ORDER],
    /// The state that a constant input of one leaves.
    settled: [f64; ORDER],
    /// Rows after which an input is forgotten.
    memory: usize,
}

impl Butterworth {
    /// A low-pass; `None` where the cut-off is not below half the sample rate.
    #[must_use]
    pub(crate) fn new(rate_hz: f64, cutoff_hz: f64) -> Option<Self> {
        let is_possible = rate_hz > 0.0 && cutoff_hz > 0.0 && cutoff_hz < rate_hz / 2.0;
        is_possible.then(|| Self::with_share(2.0 * cutoff_hz / rate_hz))
    }

    /// The low-pass whose cut-off is a share of half the sample rate.
    fn with_share(share: f64) -> Self {
        let radius = BILINEAR * (PI * share / 2.0).tan();
        let poles = [-3.0, -1.0, 1.0, 3.0].map(|m: f64| {
            let angle = Complex::i() * PI * m / (2.0 * ORDER as f64);
            -angle.exp() * radius
        });
        let below = poles.map(|pole| BILINEAR - pole);
        let gain = radius.powi(4) * (1.0 / below.into_iter().product::<Complex<f64>>().re);
        let poles = poles.map(|pole| (BILINEAR + pole) / (BILINEAR - pole));
        let slowest = poles.map(Complex::norm).into_iter().fold(0.0, f64::max);
        let a = polynomial(poles);
        // All zeros are at −1.
        let b = [1.0, 4.0, 6.0, 4.0, 1.0].map(|binomial| binomial * gain);
        let feedback = [-a[1], -a[2], -a[3], -a[4]];
        let input = [1, 2, 3, 4].map(|place| b[place] - b[0] * a[place]);
        Self {
            through: b[0],
            settled: settled(&a, input),
            feedback,
            input,
            memory: (FORGOTTEN.ln() / slowest.ln()).ceil() as usize,
        }
    }

    /// A signal forwards and backwards through the filter; one that is not longer than the padding
    /// comes back as it was.
    #[must_use]
    pub(crate) fn both_ways(&self, signal: &[f64]) -> Vec<f64> {
        if signal.len() <= PADDING {
            return signal.to_vec();
        }
        let mut values = self.once(&padded(signal));
        values.reverse();
        let mut values = self.once(&values);
        values.reverse();
        values[PADDING..PADDING + signal.len()].to_vec()
    }

    /// A signal once through the filter.
    fn once(&self, signal: &[f64]) -> Vec<f64> {
        if signal.len() < LANES * WORTH_CUTTING * self.memory {
            return self.in_lanes::<1>(signal, 0);
        }
        self.in_lanes::<LANES>(signal, self.memory)
    }

    /// The same in so many parts, each entered so many rows before it begins. Before the signal its
    /// first value has been there for ever, and after it the last one stays.
    fn in_lanes<const N: usize>(&self, signal: &[f64], lead: usize) -> Vec<f64> {
        let length = signal.len().div_ceil(N);
        let (first, last) = (signal[0], signal[signal.len() - 1]);
        let mut values = vec![first; lead];
        values.extend_from_slice(signal);
        values.resize(lead + N * length, last);
        let lanes: [&[f64]; N] = from_fn(|lane| &values[lane * length..][..lead + length]);
        let at = |step: usize| lanes.map(|lane| lane[step]);
        let mut states = self.settled.map(|state| at(0).map(|first| state * first));
        for step in 0..lead {
            (_, states) = self.step(at(step), states);
        }
        let mut out = vec![0.0; N * length];
        for step in 0..length {
            let values;
            (values, states) = self.step(at(lead + step), states);
            for (lane, value) in values.into_iter().enumerate() {
                out[lane * length + step] = value;
            }
        }
        out.truncate(signal.len());
        out
    }

    /// The outputs for inputs, and the states after them.
    #[inline]
    fn step<const N: usize>(&self, x: [f64; N], s: States<N>) -> ([f64; N], States<N>) {
        let ([f1, f2, f3, f4], [c1, c2, c3, c4]) = (self.feedback, self.input);
        let after = [
            from_fn(|lane| f1 * s[0][lane] + s[1][lane] + c1 * x[lane]),
            from_fn(|lane| f2 * s[0][lane] + s[2][lane] + c2 * x[lane]),
            from_fn(|lane| f3 * s[0][lane] + s[3][lane] + c3 * x[lane]),
            from_fn(|lane| f4 * s[0][lane] + c4 * x[lane]),
        ];
        (from_fn(|lane| self.through * x[lane] + s[0][lane]), after)
    }
}

/// Real parts of the coefficients of `Π(1 − root z⁻¹)`.
fn polynomial(roots: [Complex<f64>; ORDER]) -> [f64; ORDER + 1] {
    let mut coefficients = [Complex::ZERO; ORDER + 1];
    coefficients[0] = Complex::ONE;
    for root in roots {
        for place in (1..=ORDER).rev() {
            let before = coefficients[place - 1];
            coefficients[place] -= root * before;
        }
    }
    coefficients.map(|coefficient| coefficient.re)
}

/// The state that a constant input of one leaves.
fn settled(a: &[f64; ORDER + 1], input: [f64; ORDER]) -> [f64; ORDER] {
    let mut state = [0.0; ORDER];
    state[0] = input.iter().sum::<f64>() / (a[1..].iter().sum::<f64>() + 1.0);
    for place in 1..ORDER {
        state[place] = a[place] * state[0] + state[place - 1] - input[place - 1];
    }
    state
}

/// A signal continued at both ends by its point reflection.
fn padded(signal: &[f64]) -> Vec<f64> {
    let last = signal.len() - 1;
    let reflected = |about: usize, row: usize| 2.0 * signal[about] - signal[row];
    let before = (1..=PADDING).rev().map(|row| reflected(0, row));
    let after = (1..=PADDING).map(|row| reflected(last, last - row));
    before.chain(signal.iter().copied()).chain(after).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const CUT_OFFS: [(f64, f64); 4] = [
        (1000.0, 100.0),
        (8000.0, 30.0),
        (250.0, 25.0),
        (4000.0, 20.0),
    ];

    /// So many rows from the crate `butterworth`, and from here.
    fn theirs_and_ours(rows: i32, rate: f64, cutoff: f64) -> (Vec<f64>, Vec<f64>) {
        let signal: Vec<f64> = (0..rows)
            .map(|i| (0.003 * f64::from(i * (i % 1000))).sin())
            .collect();
        let theirs = butterworth::Filter::new(4, rate, butterworth::Cutoff::LowPass(cutoff));
        let theirs = theirs.unwrap().bidirectional(&signal).unwrap();
        let filter = Butterworth::new(rate, cutoff).unwrap();
        (theirs, filter.both_ways(&signal))
    }

    #[test]
    fn it_is_the_filter_of_the_crate_butterworth_to_the_last_bit() {
        for (rate, cutoff) in CUT_OFFS {
            let (theirs, ours) = theirs_and_ours(700, rate, cutoff);
            assert_eq!(ours, theirs, "{cutoff} Hz of {rate} Hz");
        }
    }

    #[test]
    fn a_signal_in_parts_is_the_whole_one_within_its_rounding() {
        for (rate, cutoff) in CUT_OFFS {
            let filter = Butterworth::new(rate, cutoff).unwrap();
            let rows = LANES * WORTH_CUTTING * filter.memory + 3;
            let (theirs, ours) = theirs_and_ours(rows as i32, rate, cutoff);
            let apart = theirs.iter().zip(&ours).map(|(a, b)| (a - b).abs());
            let most = apart.fold(0.0, f64::max);
            // The direct form rounds the more, the lower its cut-off is.
            let rounding = 1.0e-17 * (rate / cutoff).powi(4);
            assert!(
                most < rounding.max(1.0e-13),
                "{cutoff} Hz of {rate} Hz: {most:e}"
            );
            assert_ne!(ours, theirs, "{cutoff} Hz of {rate} Hz: in one part");
        }
    }

    #[test]
    fn a_constant_passes_and_a_line_in_its_middle() {
        let filter = Butterworth::new(1000.0, 100.0).unwrap();
        let near = |(out, wanted): (&f64, &f64)| (out - wanted).abs() < 1.0e-9;
        assert!(
            filter
                .both_ways(&[7.0; 50])
                .iter()
                .zip(&[7.0; 50])
                .all(near)
        );
        let line: Vec<f64> = (0..200).map(|i| 3.0 + 0.5 * f64::from(i)).collect();
        let out = filter.both_ways(&line);
        assert!(out[80..120].iter().zip(&line[80..120]).all(near), "{out:?}");
    }

    #[test]
    fn a_signal_that_is_not_longer_than_the_padding_comes_back_as_it_was() {
        let filter = Butterworth::new(1000.0, 100.0).unwrap();
        let signal: Vec<f64> = (0..20).map(|i| f64::from(i * i % 7)).collect();
        for rows in [0, 1, PADDING] {
            assert_eq!(filter.both_ways(&signal[..rows]), signal[..rows]);
        }
        assert_eq!(filter.both_ways(&signal[..=PADDING]).len(), PADDING + 1);
        assert_ne!(filter.both_ways(&signal[..=PADDING]), signal[..=PADDING]);
    }

    #[test]
    fn a_cut_off_must_be_positive_and_below_half_the_rate() {
        for (rate, cutoff, possible) in [
            (1000.0, 499.0, true),
            (1000.0, 500.0, false),
            (1000.0, 0.0, false),
            (0.0, 1.0, false),
        ] {
            assert_eq!(
                Butterworth::new(rate, cutoff).is_some(),
                possible,
                "{cutoff} of {rate}"
            );
        }
    }
}
