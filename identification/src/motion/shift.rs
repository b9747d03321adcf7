//! A signal seen at other times than those of its rows: a delay of an effort, a velocity that a
//! drive gives late.

/// A band-limited signal seen `by` samples later; cubic Lagrange interpolation.
#[must_use]
pub(crate) fn shifted(column: &[f64], by: f64) -> Vec<f64> {
    if by == 0.0 || column.len() < 4 {
        return column.to_vec();
    }
    let last = column.len() - 3;
    (0..column.len())
        .map(|row| {
            let at = (row as f64 + by).clamp(1.0, last as f64);
            let base = (at.floor() as usize).clamp(1, last);
            let u = at - base as f64;
            let [a, b, c, d] = [
                column[base - 1],
                column[base],
                column[base + 1],
                column[base + 2],
            ];
            a * (-u * (u - 1.0) * (u - 2.0) / 6.0)
                + b * ((u + 1.0) * (u - 1.0) * (u - 2.0) / 2.0)
                + c * (-(u + 1.0) * u * (u - 2.0) / 2.0)
                + d * ((u + 1.0) * u * (u - 1.0) / 6.0)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_signal_seen_later_is_interpolated_exactly_up_to_the_third_power() {
        let cubic = |x: f64| 2.0 - x + 0.5 * x * x - 0.03 * x.powi(3);
        let column: Vec<f64> = (0..40).map(|row| cubic(f64::from(row))).collect();
        for by in [0.25, 1.75, -2.5] {
            let later = shifted(&column, by);
            for row in 5..35_u16 {
                let wanted = cubic(f64::from(row) + by);
                assert!((later[usize::from(row)] - wanted).abs() < 1.0e-9);
            }
        }
        assert_eq!(shifted(&column, 0.0), column);
        assert_eq!(shifted(&column[..3], 1.0), column[..3]);
        // Beyond the ends it stays at the last value that can be interpolated.
        assert_eq!(shifted(&column, 100.0)[39], column[37]);
        assert_eq!(shifted(&column, -100.0)[0], column[1]);
    }
}
