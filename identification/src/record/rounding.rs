//! The step to which a recorded signal was rounded.
//!
//! A converter gives multiples of its step q. The error, −q/2 to q/2, has an rms of q/√12 (Bennett,
//! Bell System Technical Journal 27, 1948). It is no noise: at low speed it goes with the signal
//! itself, and structure up to that size says nothing about the axis.

/// The usual distance between neighbouring values of a signal; zero for fewer than two values.
///
/// A signal that was hardly rounded has many values close together, and a step of nearly nothing.
#[must_use]
pub(crate) fn step(values: &[f64]) -> f64 {
    let mut sorted: Vec<f64> = values.iter().copied().filter(|v| v.is_finite()).collect();
    sorted.sort_by(f64::total_cmp);
    // The last digit of a decimal number is no step.
    let range = sorted
        .last()
        .zip(sorted.first())
        .map_or(0.0, |(last, first)| last - first);
    sorted.dedup_by(|a, b| (*a - *b).abs() <= 1.0e-9 * range);
    let mut steps: Vec<f64> = sorted.windows(2).map(|pair| pair[1] - pair[0]).collect();
    if steps.is_empty() {
        return 0.0;
    }
    let middle = steps.len() / 2;
    *steps.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// Rms of what rounding to a step leaves out.
#[must_use]
pub(crate) fn rms(step: f64) -> f64 {
    step / 12.0_f64.sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn waves(rows: usize) -> impl Iterator<Item = f64> {
        (0..rows).map(|row| 30.0 * (0.01 * row as f64).sin())
    }

    #[test]
    fn the_step_of_a_rounded_signal_is_found_and_an_unrounded_one_has_next_to_none() {
        let rounded: Vec<f64> = waves(5000).map(|v| 0.7 * (v / 0.7).round()).collect();
        assert!((step(&rounded) - 0.7).abs() < 1.0e-9);
        let smooth: Vec<f64> = waves(5000).collect();
        assert!(step(&smooth) < 0.05, "{}", step(&smooth));
        assert_eq!((step(&[3.0; 9]), step(&[])), (0.0, 0.0));
    }

    #[test]
    fn rounding_leaves_out_as_much_as_it_is_said_to() {
        let apart = waves(200_000).map(|v| v - 0.7 * (v / 0.7).round());
        let left = (apart.map(|e| e * e).sum::<f64>() / 200_000.0).sqrt();
        assert!((left / rms(0.7) - 1.0).abs() < 0.03, "{left}");
    }
}
