//! Least squares whose coefficients are not negative, from a Gram matrix.
//!
//! The active set of Lawson and Hanson (Solving Least Squares Problems, 1974, ch. 23): a column
//! whose gradient helps most comes in, one whose coefficient would become negative goes out.

use nalgebra::{DMatrix, DVector};

/// A column comes in where its gradient is above this share of the largest product with the target.
const HELPS: f64 = 1.0e-9;
/// Columns come in and go out at most so often each.
const MOST_ROUNDS: usize = 10;
/// Ridge, relative to the diagonal: neighbouring columns are nearly the same.
const RIDGE: f64 = 1.0e-9;

/// Coefficients of a Gram matrix of `[columns, target]`.
#[must_use]
pub(crate) fn non_negative(gram: &DMatrix<f64>) -> Vec<f64> {
    let count = gram.ncols() - 1;
    let target = gram.column(count).rows(0, count).into_owned();
    let mut columns = gram.view((0, 0), (count, count)).into_owned();
    for i in 0..count {
        columns[(i, i)] *= 1.0 + RIDGE;
    }
    let mut found = DVector::zeros(count);
    let mut inside = vec![false; count];
    for _ in 0..MOST_ROUNDS * count {
        let gradient = &target - &columns * &found;
        let outside = (0..count).filter(|i| !inside[*i]);
        let best = outside.max_by(|i, j| gradient[*i].total_cmp(&gradient[*j]));
        let Some(best) = best.filter(|best| gradient[*best] > HELPS * target.amax()) else {
            break;
        };
        inside[best] = true;
        while !step(&columns, &target, &mut inside, &mut found) {}
    }
    found.as_slice().to_vec()
}

/// A step towards the fit of the columns that are inside; whether it got there. Else one at least
/// has gone out.
fn step(
    columns: &DMatrix<f64>,
    target: &DVector<f64>,
    inside: &mut [bool],
    found: &mut DVector<f64>,
) -> bool {
    let places: Vec<usize> = (0..inside.len()).filter(|i| inside[*i]).collect();
    let wanted = columns.select_rows(&places).select_columns(&places);
    let Some(wanted) = wanted.cholesky() else {
        for place in places {
            inside[place] = found[place] > 0.0;
        }
        return true;
    };
    let wanted = wanted.solve(&target.select_rows(&places));
    let pairs = || places.iter().copied().zip(wanted.iter().copied());
    let as_far = pairs()
        .filter(|(_, wanted)| *wanted <= 0.0)
        .map(|(place, wanted)| found[place] / (found[place] - wanted))
        .fold(1.0_f64, f64::min);
    let mut arrived = true;
    for (place, wanted) in pairs() {
        let is_last = wanted <= 0.0 && found[place] / (found[place] - wanted) <= as_far;
        found[place] += as_far * (wanted - found[place]);
        if is_last || found[place] <= 0.0 {
            (found[place], inside[place], arrived) = (0.0, false, false);
        }
    }
    arrived
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// The Gram matrix of columns and a target.
    fn gram(columns: &[Vec<f64>], target: &[f64]) -> DMatrix<f64> {
        let all: Vec<&[f64]> = columns.iter().map(Vec::as_slice).chain([target]).collect();
        let dot = |i: usize, j: usize| all[i].iter().zip(all[j]).map(|(a, b)| a * b).sum();
        DMatrix::from_fn(all.len(), all.len(), dot)
    }

    #[test]
    fn what_would_be_negative_is_zero_and_the_others_are_fitted_without_it() {
        let columns = [
            vec![1.0, 0.0, 0.0],
            vec![0.0, 1.0, 0.0],
            vec![1.0, 1.0, 1.0],
        ];
        let found = non_negative(&gram(&columns, &[3.0, -2.0, 0.0]));
        assert!((found[0] - 3.0).abs() < 1.0e-6, "{found:?}");
        assert_eq!(found[1..], [0.0, 0.0]);
    }

    proptest! {
        /// Karush, Kuhn and Tucker: no gradient of a zero helps, and that of the others is none.
        #[test]
        fn no_coefficient_can_be_moved_for_the_better(
            columns in prop::collection::vec(prop::collection::vec(-1.0..1.0_f64, 12), 6),
            target in prop::collection::vec(-1.0..1.0_f64, 12),
        ) {
            let gram = gram(&columns, &target);
            let found = non_negative(&gram);
            let scale = gram.column(6).rows(0, 6).amax();
            for i in 0..6 {
                let products = (0..6).map(|j| gram[(i, j)] * found[j]);
                let gradient = gram[(i, 6)] - products.sum::<f64>();
                prop_assert!(found[i] >= 0.0);
                let most = if found[i] > 0.0 { gradient.abs() } else { gradient };
                prop_assert!(most <= 1.0e-5 * scale, "{i}: {gradient} {found:?}");
            }
        }
    }
}
