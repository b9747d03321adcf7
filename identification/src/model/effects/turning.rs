//! Cosine and sine of `2π k x` for one k after the other, in equal steps.
//!
//! From k to k + Δ the angle of a place x grows by the same amount every time, so the pair is
//! turned by one fixed rotation: four products instead of two trigonometric functions. Scans of
//! thousands of k over thousands of rows live on that. Each turn rounds by some 10⁻¹⁶, and every
//! [`RENEWED`] turns the pair is computed anew: no scan is off by more than 10⁻¹³.

use std::f64::consts::TAU;

/// Turns after which the pairs are computed anew.
pub(super) const RENEWED: usize = 64;

/// A wave at a place.
#[derive(Clone, Copy, Debug)]
pub(super) struct Turning {
    x: f64,
    /// Cosine and sine.
    pub at: [f64; 2],
    by: [f64; 2],
}

impl Turning {
    /// At a place, with a step of k; at k = 0 first.
    #[must_use]
    pub(super) fn new(x: f64, step: f64) -> Self {
        Self {
            x,
            at: [1.0, 0.0],
            by: wave(step, x),
        }
    }

    /// Computes the pair for a k.
    pub(super) fn renew(&mut self, k: f64) {
        self.at = wave(k, self.x);
    }

    /// Goes on to the next k.
    #[inline]
    pub(super) fn turn(&mut self) {
        let ([cos, sin], [c, s]) = (self.at, self.by);
        self.at = [cos * c - sin * s, sin * c + cos * s];
    }
}

/// Cosine and sine of `2π k x`.
#[must_use]
pub(super) fn wave(k: f64, x: f64) -> [f64; 2] {
    let (sin, cos) = (TAU * k * x).sin_cos();
    [cos, sin]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turned_pairs_are_cosine_and_sine_to_ten_to_the_minus_thirteen() {
        for x in [0.0, 0.37, -1.9] {
            let mut turning = Turning::new(x, 0.13);
            turning.renew(5.0);
            for turn in 0..RENEWED {
                let wanted = wave(5.0 + 0.13 * turn as f64, x);
                let apart = turning.at.into_iter().zip(wanted);
                assert!(apart.into_iter().all(|(a, b)| (a - b).abs() < 1.0e-13));
                turning.turn();
            }
        }
    }
}
