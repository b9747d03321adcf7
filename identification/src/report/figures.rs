//! Numbers for people: rounded to what they mean.
//!
//! Errors are rms values over some tens of independent stretches. Their own uncertainty is some
//! percent, so three digits say all that they have. A parameter has the digits that its interval
//! bears: two digits of the interval's half width, the value to the same place.

use axis_model::Estimate;

/// Digits of an error, and of a value without an interval.
const DIGITS: i32 = 3;
/// Digits of the half width of an interval.
const DIGITS_OF_AN_INTERVAL: i32 = 2;
/// Beyond these sizes a number has a power of ten.
const PLAIN: std::ops::Range<f64> = 1.0e-3..1.0e6;

/// An error with three digits; what is no number ran away.
#[must_use]
pub fn error(value: f64) -> String {
    if value.is_finite() {
        rounded(value, place(value, DIGITS))
    } else {
        "ran away".into()
    }
}

/// A value with the digits that its interval bears, and the interval's ends to the same place.
#[must_use]
pub fn estimate(estimate: &Estimate) -> [String; 3] {
    let half_width = 0.5 * (estimate.high - estimate.low).abs();
    let last = if half_width > 0.0 && half_width.is_finite() {
        place(half_width, DIGITS_OF_AN_INTERVAL)
    } else {
        place(estimate.value, DIGITS)
    };
    // A value far inside its interval keeps a digit of its own.
    let last = last.min(place(estimate.value, 1));
    [estimate.value, estimate.low, estimate.high].map(|value| rounded(value, last))
}

/// The power of ten of the last of so many digits.
fn place(value: f64, digits: i32) -> i32 {
    if value == 0.0 || !value.is_finite() {
        return 0;
    }
    let scientific = format!("{:.*e}", (digits - 1).unsigned_abs() as usize, value);
    let power = scientific.split('e').nth(1);
    power.and_then(|text| text.parse().ok()).unwrap_or(0) + 1 - digits
}

/// A number to a power of ten.
fn rounded(value: f64, last: i32) -> String {
    let size = value.abs();
    if size == 0.0 || !value.is_finite() || PLAIN.contains(&size) {
        if last > 0 {
            let step = 10.0_f64.powi(last);
            return format!("{:.0}", step * (value / step).round());
        }
        return format!("{value:.*}", last.unsigned_abs() as usize);
    }
    // The first digit after rounding: 9.996e7 to three digits is 1.00e8.
    let step = 10.0_f64.powi(last);
    let first = place(step * (value / step).round(), 15) + 14;
    let digits = first - last;
    format!("{:.*e}", digits.max(0).unsigned_abs() as usize, value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_has_three_digits_whatever_its_size() {
        for (value, wanted) in [
            (121.977, "122"),
            (5.5468, "5.55"),
            (0.434_56, "0.435"),
            (99.96, "100"),
            (1234.5, "1230"),
            (0.001_234_5, "0.00123"),
            (1.234_56e-5, "1.23e-5"),
            (1.0e42, "1.00e42"),
            (9.7287e7, "9.73e7"),
            (9.996e7, "1.00e8"),
            (0.0, "0"),
            (-5.5468, "-5.55"),
            (f64::NAN, "ran away"),
            (f64::INFINITY, "ran away"),
        ] {
            assert_eq!(error(value), wanted, "{value}");
        }
    }

    fn about(value: f64, half_width: f64) -> [String; 3] {
        estimate(&Estimate {
            value,
            unit: "N".into(),
            low: value - half_width,
            high: value + half_width,
        })
    }

    #[test]
    fn a_parameter_has_the_digits_that_its_interval_bears() {
        assert_eq!(about(182.612_3, 1.123), ["182.6", "181.5", "183.7"]);
        assert_eq!(about(182.612_3, 36.0), ["183", "147", "219"]);
        assert_eq!(about(18_261.2, 360.0), ["18260", "17900", "18620"]);
        assert_eq!(
            about(1.804e-5, 1.2e-7),
            ["1.804e-5", "1.792e-5", "1.816e-5"]
        );
    }

    #[test]
    fn without_an_interval_a_parameter_has_three_digits_and_far_inside_one_it_keeps_one() {
        assert_eq!(about(1.764_321e8, 0.0), ["1.76e8", "1.76e8", "1.76e8"]);
        assert_eq!(about(0.12, 100.0), ["0.1", "-99.9", "100.1"]);
    }
}
