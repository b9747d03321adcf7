//! The ellipse: second harmonic of the radial deviation, from different gains of the axes.

use super::point::Point;
use super::reversals::{REVERSALS, apart};

/// Amplitude of cos 2θ and sin 2θ by projection, window by window symmetric so that the harmonics
/// stay orthogonal.
pub(super) fn ellipse_um(points: &[Point], deviation: &[f64], window: f64) -> f64 {
    let quiet = |angle: f64| REVERSALS.iter().all(|(at, ..)| apart(angle, *at) > window);
    let mut sums = [0.0; 6];
    for (point, deviation) in points
        .iter()
        .zip(deviation)
        .filter(|(point, _)| quiet(point.angle_rad))
    {
        let (sin, cos) = (2.0 * point.angle_rad).sin_cos();
        for (sum, value) in sums.iter_mut().zip([
            1.0,
            *deviation,
            cos * deviation,
            sin * deviation,
            cos * cos,
            sin * sin,
        ]) {
            *sum += value;
        }
    }
    let [_, _, cos, sin, cos_cos, sin_sin] = sums;
    if cos_cos > 0.0 && sin_sin > 0.0 {
        (cos / cos_cos).hypot(sin / sin_sin)
    } else {
        0.0
    }
}
