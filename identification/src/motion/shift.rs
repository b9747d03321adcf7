//! A signal seen at other times than those of its rows: a delay of an effort, a velocity that a
//! drive gives late.

/// A band-limited signal seen `by` samples later; cubic Lagrange interpolation.
#[must_use]
pub(crate) fn shifted(column: &[f64], by: f64) -> Vec<f64> {
    if by == 0.0 || column.len() < 4 {
        return column.to_vec();
    }
    let rows = 0..column.len();
    rows.map(|row| Seen::of(row, by, column.len()).value(column))
        .collect()
}

/// The same for several signals of one length.
#[must_use]
pub(crate) fn all_shifted(columns: &[Vec<f64>], by: f64) -> Vec<Vec<f64>> {
    let rows = columns.first().map_or(0, Vec::len);
    if by == 0.0 || rows < 4 {
        return columns.to_vec();
    }
    // The weights are the same for each.
    let seen: Vec<Seen> = (0..rows).map(|row| Seen::of(row, by, rows)).collect();
    let shifted = |column: &Vec<f64>| seen.iter().map(|seen| seen.value(column)).collect();
    columns.iter().map(shifted).collect()
}

/// Where a row is seen: between the second and the third of four rows.
struct Seen {
    first: usize,
    weights: [f64; 4],
}

impl Seen {
    fn of(row: usize, by: f64, rows: usize) -> Self {
        let last = rows - 3;
        let at = (row as f64 + by).clamp(1.0, last as f64);
        // It is at least one: the whole part is its floor.
        let base = (at as usize).clamp(1, last);
        let u = at - base as f64;
        Self {
            first: base - 1,
            weights: [
                -u * (u - 1.0) * (u - 2.0) / 6.0,
                (u + 1.0) * (u - 1.0) * (u - 2.0) / 2.0,
                -(u + 1.0) * u * (u - 2.0) / 2.0,
                (u + 1.0) * u * (u - 1.0) / 6.0,
            ],
        }
    }

    fn value(&self, column: &[f64]) -> f64 {
        let near = &column[self.first..self.first + 4];
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
