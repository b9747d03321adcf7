//! Cosine and sine of `2π k x` for one k after the other, in equal steps.
//!
//! From k to k + Δ the angle of a place x grows by the same amount every time, so the pair is
//! turned by one fixed rotation: four products instead of two trigonometric functions. Scans of
//! thousands of k over thousands of rows live on that. Each turn rounds by some 10⁻¹⁶, and every
//! [`RENEWED`] turns the pair is computed anew.
//!
//! Anew means: from the nearest of [`NODES`] angles, turned by what is left of the angle, δ, with
//! `cos δ = 1 − δ²/2 + δ⁴/24` and `sin δ = δ − δ³/6`: right to δ⁵/120, 3·10⁻¹⁵, and without a
//! call.

use std::f64::consts::TAU;
use std::sync::LazyLock;

/// Turns after which the pairs are computed anew.
pub(super) const RENEWED: usize = 64;

/// Angles of a turn whose cosine and sine are kept; a power of two.
const NODES: usize = 1024;

/// Cosine and sine at the nodes.
static AT_NODES: LazyLock<[[f64; 2]; NODES]> = LazyLock::new(|| {
    std::array::from_fn(|node| {
        let (sin, cos) = (TAU * node as f64 / NODES as f64).sin_cos();
        [cos, sin]
    })
});

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

/// Of so many evenly spaced k the one whose wave is the strongest component of values over their
/// places.
pub(crate) fn strongest(samples: &[(f64, f64)], from: f64, step: f64, count: usize) -> Option<f64> {
    let turning = samples.iter().map(|(x, e)| (Turning::new(*x, step), *e));
    let mut turning: Vec<(Turning, f64)> = turning.collect();
    let sizes = (0..count).map(|i| {
        let k = from + step * i as f64;
        if i % RENEWED == 0 {
            for (wave, _) in &mut turning {
                wave.renew(k);
            }
        }
        (size(&mut turning), k)
    });
    let largest = sizes.max_by(|a, b| a.0.total_cmp(&b.0));
    largest.map(|(_, k)| k)
}

/// Size of the component of a k; the samples go on to the next one.
fn size(samples: &mut [(Turning, f64)]) -> f64 {
    let (mut re, mut im) = (0.0, 0.0);
    for (wave, e) in samples {
        let [cos, sin] = wave.at;
        wave.turn();
        re += cos * *e;
        im += sin * *e;
    }
    f64::hypot(re, im)
}

/// Cosine and sine of `2π k x`.
#[inline]
#[must_use]
pub(super) fn wave(k: f64, x: f64) -> [f64; 2] {
    let nodes = k * x * NODES as f64;
    let nearest = (nodes + 0.5_f64.copysign(nodes)) as i64;
    let left = (nodes - nearest as f64) * (TAU / NODES as f64);
    // The low bits of a node are its place in the turn, below zero too.
    let [cos, sin] = AT_NODES[nearest as usize % NODES];
    let square = left * left;
    let (c, s) = (
        1.0 - square * (0.5 - square / 24.0),
        left * (1.0 - square / 6.0),
    );
    [cos * c - sin * s, sin * c + cos * s]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wave_is_cosine_and_sine() {
        for i in -4000..4000 {
            let turns = 0.001_37 * f64::from(i);
            let (sin, cos) = (TAU * turns).sin_cos();
            let [c, s] = wave(0.5, 2.0 * turns);
            assert!((c - cos).abs() < 1.0e-13, "{turns}: {c} {cos}");
            assert!((s - sin).abs() < 1.0e-13, "{turns}: {s} {sin}");
        }
        // A place far out, and no number.
        assert!((wave(1.0e9, 1.25)[0] - 1.0).abs() < 1.0e-6);
        assert!(wave(f64::NAN, 1.0)[0].is_nan());
    }

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

    #[test]
    fn the_strongest_wave_is_found_whatever_its_phase() {
        for phase in [0.0, 0.4, 1.6, 3.0] {
            let at = |x: f64| {
                (
                    x,
                    (TAU * 3.0 * x + phase).cos() + 0.5 * (TAU * 5.0 * x).sin(),
                )
            };
            let samples: Vec<(f64, f64)> = (0..100).map(|i| at(0.01 * f64::from(i))).collect();
            let found = strongest(&samples, 1.0, 1.0, 8);
            assert_eq!(found, Some(3.0), "{phase}");
        }
        assert_eq!(strongest(&[(0.0, 1.0)], 1.0, 1.0, 0), None);
    }
}
