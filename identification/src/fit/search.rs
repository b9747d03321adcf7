//! One-dimensional searches for nonlinear parameters.

use crate::fit::side_by_side::side_by_side;

/// The value of least error.
#[must_use]
pub(crate) fn smallest(values: &[f64], sse: &(dyn Fn(f64) -> f64 + Sync)) -> Option<f64> {
    side_by_side(values, |value| (sse(*value), *value))
        .into_iter()
        .min_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, value)| value)
}

/// Steps of one size that a descent may take before it halves them.
const STEPS: usize = 12;

/// Step-halving descent about a start value, within bounds.
#[must_use]
pub(crate) fn descend(
    start: f64,
    step: f64,
    (low, high): (f64, f64),
    sse: &dyn Fn(f64) -> f64,
) -> f64 {
    if step == 0.0 {
        return start;
    }
    let (mut best, mut at, mut step) = (sse(start), start, step);
    for _ in 0..6 {
        for _ in 0..STEPS {
            let tries = [at - step, at + step]
                .into_iter()
                .filter(|value| *value >= low && *value <= high);
            let tries = tries.map(|value| (sse(value), value));
            let better = tries
                .min_by(|a, b| a.0.total_cmp(&b.0))
                .filter(|(sse, _)| *sse < best);
            match better {
                Some((sse, value)) => (best, at) = (sse, value),
                None => break,
            }
        }
        step *= 0.5;
    }
    at
}

/// Golden-section search, to one part in 300 of the interval.
#[must_use]
pub(crate) fn golden(mut low: f64, mut high: f64, error: &dyn Fn(f64) -> f64) -> f64 {
    const RATIO: f64 = 0.618_033_988_749_894_9;
    for _ in 0..12 {
        let (a, b) = (high - RATIO * (high - low), low + RATIO * (high - low));
        if error(a) < error(b) {
            high = b;
        } else {
            low = a;
        }
    }
    0.5 * (low + high)
}
