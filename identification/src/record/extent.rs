//! What a column of numbers shows by itself: its range, its smallest step, its limit.

/// Smallest and largest value.
#[must_use]
pub(crate) fn range(values: &[f64]) -> (f64, f64) {
    let empty = (f64::INFINITY, f64::NEG_INFINITY);
    values
        .iter()
        .fold(empty, |(low, high), v| (low.min(*v), high.max(*v)))
}

/// So many equal largest efforts in a row are a limit.
const PLATEAU_ROWS: usize = 5;
/// What rounding may leave between two efforts at one limit, as a share of it.
const EQUAL: f64 = 1.0e-9;

/// The largest effort, where it stands for several rows: the drive was at its limit.
#[must_use]
pub(crate) fn plateau(effort: &[f64]) -> Option<f64> {
    let most = effort.iter().fold(0.0_f64, |most, u| most.max(u.abs()));
    let at_most = |effort: &f64| effort.abs() >= most * (1.0 - EQUAL);
    effort
        .windows(PLATEAU_ROWS)
        .any(|rows| rows.iter().all(at_most))
        .then_some(most)
}

/// Smallest step between two rows, the rounding of an encoder whose resolution was not stated.
#[must_use]
pub(crate) fn smallest_step(values: &[f64]) -> f64 {
    let steps = values
        .windows(2)
        .map(|pair| (pair[1] - pair[0]).abs())
        .filter(|step| *step > 0.0);
    let smallest = steps.fold(f64::INFINITY, f64::min);
    if smallest.is_finite() { smallest } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn five_equal_largest_efforts_are_a_limit_and_four_are_not() {
        let with = |rows: usize| [vec![1.0, -2.0], vec![-3.0; rows], vec![0.5]].concat();
        assert_eq!(plateau(&with(5)), Some(3.0));
        assert_eq!(plateau(&with(4)), None);
    }

    #[test]
    fn an_encoder_rounds_to_the_smallest_step_and_standstill_is_none() {
        assert_eq!(smallest_step(&[0.0, 0.0, 0.5, 0.25, 1.0]), 0.25);
        assert_eq!(smallest_step(&[2.0, 2.0, 2.0]), 0.0);
    }

    #[test]
    fn the_range_holds_the_ends() {
        assert_eq!(range(&[1.0, -4.0, 2.0]), (-4.0, 2.0));
    }
}
