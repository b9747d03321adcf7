//! One-dimensional searches for nonlinear parameters.

use crate::fit::side_by_side::side_by_side;

/// The value of least error.
#[must_use]
pub(crate) fn smallest<T: Copy + Send + Sync>(
    values: &[T],
    sse: &(dyn Fn(T) -> f64 + Sync),
) -> Option<T> {
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
        // Where a step came from is worse: it is not tried again.
        let mut last = None;
        for _ in 0..STEPS {
            let tries = [-step, step].into_iter().filter(|by| last != Some(-by));
            let inside = tries.filter(|by| at + by >= low && at + by <= high);
            let better = inside
                .map(|by| (sse(at + by), by))
                .min_by(|a, b| a.0.total_cmp(&b.0))
                .filter(|(sse, _)| *sse < best);
            let Some((sse, by)) = better else { break };
            (best, at, last) = (sse, at + by, Some(by));
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

#[cfg(test)]
mod tests {
    use super::*;
    use std::cell::RefCell;

    #[test]
    fn the_value_of_least_error_is_the_smallest() {
        let error = |value: f64| (value - 2.2).powi(2);
        assert_eq!(smallest(&[4.0, 2.0, 3.0], &error), Some(2.0));
        assert_eq!(smallest(&[], &error), None);
    }

    #[test]
    fn a_descent_reaches_the_bottom_to_a_thirty_second_of_its_step() {
        for bottom in [1.3, -0.7] {
            let found = descend(0.0, 0.5, (-10.0, 10.0), &|value| (value - bottom).abs());
            assert!((found - bottom).abs() <= 0.5 / 32.0, "{found}");
        }
    }

    #[test]
    fn a_descent_takes_twelve_steps_of_a_size_and_no_step_of_zero() {
        let far = |value: f64| (value - 1.0e6).abs();
        // 12 steps of 1, 1/2, 1/4, 1/8, 1/16, 1/32.
        let found = descend(0.0, 1.0, (-1.0e9, 1.0e9), &far);
        assert!(
            (found - 12.0 * (2.0 - 1.0 / 32.0)).abs() < 1.0e-12,
            "{found}"
        );
        assert_eq!(descend(3.0, 0.0, (-1.0e9, 1.0e9), &far), 3.0);
    }

    #[test]
    fn a_descent_stays_within_its_bounds_and_may_stand_on_them() {
        let tried = RefCell::new(Vec::new());
        let error = |value: f64| {
            tried.borrow_mut().push(value);
            value
        };
        assert_eq!(descend(1.0, 0.5, (0.0, 1.5), &error), 0.0);
        let down = |value: f64| -value;
        assert_eq!(descend(1.0, 0.5, (0.0, 1.5), &down), 1.5);
        let inside = |value: &f64| (0.0..=1.5).contains(value);
        assert!(tried.borrow().iter().all(inside));
    }

    #[test]
    fn the_golden_section_is_within_one_part_in_three_hundred() {
        for bottom in [0.9, 2.0, 3.95] {
            let found = golden(0.5, 4.0, &|value| (value - bottom).powi(2));
            assert!((found - bottom).abs() < 3.5 / 300.0, "{found} {bottom}");
        }
    }
}
