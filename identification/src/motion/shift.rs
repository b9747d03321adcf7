//! A signal seen at other times than those of its rows: a delay of an effort, a velocity that a
//! drive gives late.

/// A band-limited signal seen `by` samples later; cubic Lagrange interpolation.
#[must_use]
pub(crate) fn shifted(column: &[f64], by: f64) -> Vec<f64> {
    if by == 0.0 || column.len() < 4 {
        return column.to_vec();
    }
    Later::of(by).applied(column)
}

/// The same for several signals of one length.
#[must_use]
pub(crate) fn all_shifted(columns: &[Vec<f64>], by: f64) -> Vec<Vec<f64>> {
    columns.iter().map(|column| shifted(column, by)).collect()
}

/// Where rows are seen: between the second and the third of four rows, at the same place between
/// them for every row.
struct Later {
    /// From a row to the first of the four that it is seen among.
    first: isize,
    weights: [f64; 4],
}

impl Later {
    fn of(by: f64) -> Self {
        let u = by - by.floor();
        Self {
            first: (by.floor() - 1.0) as isize,
            weights: [
                -u * (u - 1.0) * (u - 2.0) / 6.0,
                (u + 1.0) * (u - 1.0) * (u - 2.0) / 2.0,
                -(u + 1.0) * u * (u - 2.0) / 2.0,
                (u + 1.0) * u * (u - 1.0) / 6.0,
            ],
        }
    }

    /// A column seen so; beyond its ends the value at the second row, or at the last but two.
    fn applied(&self, column: &[f64]) -> Vec<f64> {
        let rows = column.len();
        let seen = column.array_windows().map(|near| self.value(near));
        // Row r is seen by the window that begins at r + first; there are rows - 3 of them.
        let before = self.first.saturating_neg().clamp(0, rows as isize) as usize;
        let skipped = self.first.max(0) as usize;
        let mut values = vec![column[1]; before];
        values.extend(seen.skip(skipped).take(rows - before));
        values.resize(rows, column[rows - 3]);
        values
    }

    fn value(&self, near: &[f64; 4]) -> f64 {
        let [a, b, c, d] = self.weights;
        a * near[0] + b * near[1] + c * near[2] + d * near[3]
    }
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
        for by in [0.0, 0.25, -2.5, 100.0] {
            let one = shifted(&column, by);
            assert_eq!(
                all_shifted(&[column.clone(), column.clone()], by),
                [&one[..], &one]
            );
        }
        assert_eq!(all_shifted(&[], 1.0), Vec::<Vec<f64>>::new());
        assert_eq!(shifted(&column, 0.0), column);
        assert_eq!(shifted(&column[..3], 1.0), column[..3]);
        // Beyond the ends it stays at the last value that can be interpolated.
        assert_eq!(shifted(&column, 100.0)[39], column[37]);
        assert_eq!(shifted(&column, -100.0)[0], column[1]);
    }
}
