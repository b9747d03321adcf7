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
//! searches filter thousands of columns.

use std::f64::consts::PI;

use nalgebra::Complex;

const ORDER: usize = 4;
/// Rows by which a signal is continued at each end.
const PADDING: usize = 3 * ORDER;
/// The bilinear transform's factor for a sample rate of two.
const BILINEAR: f64 = 4.0;

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
        let a = polynomial(poles.map(|pole| (BILINEAR + pole) / (BILINEAR - pole)));
        // All zeros are at −1.
        let b = [1.0, 4.0, 6.0, 4.0, 1.0].map(|binomial| binomial * gain);
        let feedback = [-a[1], -a[2], -a[3], -a[4]];
        let input = [1, 2, 3, 4].map(|place| b[place] - b[0] * a[place]);
        Self {
            through: b[0],
            settled: settled(&a, input),
            feedback,
            input,
        }
    }

    /// Signals of one length forwards and backwards through the filter; those that are not longer
    /// than the padding come back as they were.
    ///
    /// Several go beside each other: each value of a signal waits for the one before it.
    #[must_use]
    pub(crate) fn both_ways<const N: usize>(&self, signals: [&[f64]; N]) -> [Vec<f64>; N] {
        let rows = signals[0].len();
        if rows <= PADDING {
            return signals.map(<[f64]>::to_vec);
        }
        let mut values = padded(signals);
        self.run(values.iter_mut());
        self.run(values.iter_mut().rev());
        let inside = &values[PADDING..PADDING + rows];
        std::array::from_fn(|place| inside.iter().map(|row| row[place]).collect())
    }

    /// One run, in place.
    fn run<'a, const N: usize>(&self, values: impl Iterator<Item = &'a mut [f64; N]>) {
        let mut values = values.peekable();
        let first = values.peek().map_or([0.0; N], |row| **row);
        let mut states = first.map(|first| self.settled.map(|state| state * first));
        for row in values {
            for (value, state) in row.iter_mut().zip(&mut states) {
                *value = self.step(*value, state);
            }
        }
    }

    /// The output for an input.
    #[inline]
    fn step(&self, x: f64, s: &mut [f64; ORDER]) -> f64 {
        let ([f1, f2, f3, f4], [c1, c2, c3, c4]) = (self.feedback, self.input);
        let y = self.through * x + s[0];
        *s = [
            f1 * s[0] + s[1] + c1 * x,
            f2 * s[0] + s[2] + c2 * x,
            f3 * s[0] + s[3] + c3 * x,
            f4 * s[0] + c4 * x,
        ];
        y
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

/// Signals continued at both ends by their point reflection, row by row.
fn padded<const N: usize>(signals: [&[f64]; N]) -> Vec<[f64; N]> {
    let last = signals[0].len() - 1;
    let at = |row: usize| signals.map(|signal| signal[row]);
    let reflected = |about: usize, row: usize| signals.map(|x| 2.0 * x[about] - x[row]);
    let before = (1..=PADDING).rev().map(|row| reflected(0, row));
    let after = (1..=PADDING).map(|row| reflected(last, last - row));
    before.chain((0..=last).map(at)).chain(after).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn alone_or_beside_another_signal_it_is_the_filter_of_the_crate_butterworth_to_the_last_bit() {
        let signal: Vec<f64> = (0..700).map(|i| (0.003 * f64::from(i * i)).sin()).collect();
        for (rate, cutoff) in [
            (1000.0, 100.0),
            (8000.0, 30.0),
            (250.0, 25.0),
            (4000.0, 20.0),
        ] {
            let theirs = butterworth::Filter::new(4, rate, butterworth::Cutoff::LowPass(cutoff));
            let theirs = theirs.unwrap().bidirectional(&signal).unwrap();
            let filter = Butterworth::new(rate, cutoff).unwrap();
            let other: Vec<f64> = signal.iter().map(|x| x * x).collect();
            let [ours, beside] = filter.both_ways([&signal, &other]);
            assert_eq!(filter.both_ways([&signal])[0], ours);
            assert_eq!(filter.both_ways([&other])[0], beside);
            assert_eq!(ours, theirs, "{cutoff} Hz of {rate} Hz");
        }
    }

    #[test]
    fn a_constant_passes_and_a_line_in_its_middle() {
        let filter = Butterworth::new(1000.0, 100.0).unwrap();
        let near = |(out, wanted): (&f64, &f64)| (out - wanted).abs() < 1.0e-9;
        assert!(
            filter.both_ways([&[7.0; 50]])[0]
                .iter()
                .zip(&[7.0; 50])
                .all(near)
        );
        let line: Vec<f64> = (0..200).map(|i| 3.0 + 0.5 * f64::from(i)).collect();
        let [out] = filter.both_ways([&line]);
        assert!(out[80..120].iter().zip(&line[80..120]).all(near), "{out:?}");
    }

    #[test]
    fn a_signal_that_is_not_longer_than_the_padding_comes_back_as_it_was() {
        let filter = Butterworth::new(1000.0, 100.0).unwrap();
        let signal: Vec<f64> = (0..20).map(|i| f64::from(i * i % 7)).collect();
        for rows in [0, 1, PADDING] {
            assert_eq!(filter.both_ways([&signal[..rows]])[0], signal[..rows]);
        }
        assert_eq!(
            filter.both_ways([&signal[..=PADDING]])[0].len(),
            PADDING + 1
        );
        assert_ne!(
            filter.both_ways([&signal[..=PADDING]])[0],
            signal[..=PADDING]
        );
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
