//! Least squares on blocks: fit, held-out error, intervals, all from one Gram matrix per block.
//!
//! Residuals of a servo axis are correlated, so whole blocks of one second are left out, with a
//! guard at their ends; random rows would tell the fit what it is asked to predict.

use nalgebra::{DMatrix, DVector};

/// Length of a block, s.
const BLOCK_S: f64 = 1.0;
/// Samples this near to a block's end are not used, s.
const GUARD_S: f64 = 0.020;
/// Folds of the cross-validation.
const FOLDS: usize = 10;
/// Ridge, relative to the mean diagonal: keeps equal columns from blowing up.
const RIDGE: f64 = 1.0e-12;

/// Gram matrices of `[columns, target]`, one per block.
#[derive(Clone, Debug)]
pub(crate) struct Blocks {
    grams: Vec<DMatrix<f64>>,
    scale: Vec<f64>,
    folds: usize,
}

/// A fit and its held-out error.
#[derive(Clone, Debug)]
pub(crate) struct Fit {
    /// Coefficient per column.
    pub coefficients: Vec<f64>,
    /// Sum of squares left in the sample.
    pub sse: f64,
    /// Sum of squares left on each block when it was left out.
    pub held_out: Vec<f64>,
    /// Sum of squares of the target.
    pub total: f64,
}

impl Blocks {
    /// Gram matrices over the samples of a mask.
    #[must_use]
    pub(crate) fn new(columns: &[&[f64]], target: &[f64], mask: &[bool], period_s: f64) -> Self {
        let size = columns.len() + 1;
        // A short record still has one block a fold.
        let per_block = ((BLOCK_S / period_s).round() as usize)
            .min(target.len() / FOLDS)
            .max(1);
        let guard = ((GUARD_S / period_s).round() as usize).min(per_block / 10);
        let blocks = target.len().div_ceil(per_block);
        let mut grams = vec![DMatrix::zeros(size, size); blocks];
        let mut row = vec![0.0; size];
        for at in (0..target.len()).filter(|at| mask[*at]) {
            let within = at % per_block;
            if within < guard || within + guard >= per_block {
                continue;
            }
            for (value, column) in row.iter_mut().zip(columns) {
                *value = column[at];
            }
            row[size - 1] = target[at];
            let gram = &mut grams[at / per_block];
            for i in 0..size {
                for j in 0..=i {
                    gram[(i, j)] += row[i] * row[j];
                }
            }
        }
        grams
            .iter_mut()
            .for_each(DMatrix::fill_upper_triangle_with_lower_triangle);
        grams.retain(|gram| gram[(size - 1, size - 1)] > 0.0);
        let total = sum(&grams, size);
        // A column of zeros keeps a scale that can be divided by.
        let scale: Vec<f64> = (0..size)
            .map(|i| total[(i, i)].sqrt())
            .map(|s| if s > 0.0 { s } else { 1.0 })
            .collect();
        let folds = FOLDS.min(grams.len()).max(1);
        Self {
            grams,
            scale,
            folds,
        }
    }

    /// The fit over all blocks, without cross-validation; `held_out` is empty.
    #[must_use]
    pub(crate) fn fit(&self) -> Fit {
        let total = sum(&self.grams, self.scale.len());
        let coefficients = self.solve(&total);
        let last = self.scale.len() - 1;
        Fit {
            sse: left(&total, &coefficients),
            coefficients: coefficients.as_slice().to_vec(),
            held_out: Vec::new(),
            total: total[(last, last)],
        }
    }

    /// The fit with its held-out errors.
    #[must_use]
    pub(crate) fn cross_validate(&self) -> Fit {
        let total = sum(&self.grams, self.scale.len());
        let mut held_out = vec![0.0; self.grams.len()];
        for fold in 0..self.folds {
            let coefficients = self.without_fold(&total, fold);
            for (block, gram) in self.grams.iter().enumerate().skip(fold).step_by(self.folds) {
                held_out[block] = left(gram, &coefficients);
            }
        }
        Fit {
            held_out,
            ..self.fit()
        }
    }

    /// Half widths of 95 % intervals by the jackknife over folds.
    #[must_use]
    pub(crate) fn half_widths(&self) -> Vec<f64> {
        let total = sum(&self.grams, self.scale.len());
        let folds: Vec<DVector<f64>> = (0..self.folds)
            .map(|fold| self.without_fold(&total, fold))
            .collect();
        let count = folds.len() as f64;
        (0..self.scale.len() - 1)
            .map(|i| {
                let mean = folds.iter().map(|fold| fold[i]).sum::<f64>() / count;
                let spread = folds
                    .iter()
                    .map(|fold| (fold[i] - mean).powi(2))
                    .sum::<f64>();
                1.96 * ((count - 1.0) / count * spread).sqrt()
            })
            .collect()
    }

    fn without_fold(&self, total: &DMatrix<f64>, fold: usize) -> DVector<f64> {
        let mut rest = total.clone();
        self.grams
            .iter()
            .skip(fold)
            .step_by(self.folds)
            .for_each(|gram| rest -= gram);
        self.solve(&rest)
    }

    fn solve(&self, gram: &DMatrix<f64>) -> DVector<f64> {
        let size = self.scale.len() - 1;
        let scaled = |i: usize, j: usize| gram[(i, j)] / (self.scale[i] * self.scale[j]);
        let mut normal = DMatrix::from_fn(size, size, scaled);
        let ridge = RIDGE * normal.trace().max(f64::MIN_POSITIVE) / size.max(1) as f64;
        (0..size).for_each(|i| normal[(i, i)] += ridge);
        let right = DVector::from_fn(size, |i, _| scaled(i, size));
        let solution = normal
            .cholesky()
            .map_or_else(|| DVector::zeros(size), |c| c.solve(&right));
        DVector::from_fn(size, |i, _| solution[i] * self.scale[size] / self.scale[i])
    }
}

fn sum(grams: &[DMatrix<f64>], size: usize) -> DMatrix<f64> {
    grams
        .iter()
        .fold(DMatrix::zeros(size, size), |sum, gram| sum + gram)
}

/// Σ(y − Xθ)² from a Gram matrix.
fn left(gram: &DMatrix<f64>, coefficients: &DVector<f64>) -> f64 {
    let last = coefficients.len();
    let mut sse = gram[(last, last)];
    for i in 0..last {
        sse -= 2.0 * coefficients[i] * gram[(i, last)];
        for j in 0..last {
            sse += coefficients[i] * coefficients[j] * gram[(i, j)];
        }
    }
    // A column that overflowed must not look like a perfect fit.
    if sse.is_finite() {
        sse.max(0.0)
    } else {
        f64::MAX
    }
}

/// How much better a fit is than another on held-out blocks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Gain {
    /// Sum of squares that is removed on held-out blocks.
    pub removed: f64,
    /// Share of the held-out error (sum of squares) that is removed.
    pub share: f64,
    /// Size of what is removed, percent of the target.
    pub percent: f64,
    /// Mean over standard error of the gains per block.
    pub t: f64,
}

impl Gain {
    /// Gain of `after` over `before`, on the same blocks.
    #[must_use]
    pub(crate) fn of(before: &Fit, after: &Fit) -> Self {
        let gains: Vec<f64> = before
            .held_out
            .iter()
            .zip(&after.held_out)
            .map(|(b, a)| b - a)
            .collect();
        let sum = gains.iter().sum::<f64>();
        let base: f64 = before.held_out.iter().sum();
        Self {
            removed: sum,
            share: sum / base.max(f64::MIN_POSITIVE),
            percent: 100.0
                * sum.signum()
                * (sum.abs() / before.total.max(f64::MIN_POSITIVE)).sqrt(),
            t: t_of(&gains),
        }
    }

    /// This gain, but relevant and certain only as far as another one is too.
    #[must_use]
    pub(crate) fn smaller(self, other: &Self) -> Self {
        Self {
            share: self.share.min(other.share),
            t: self.t.min(other.t),
            ..self
        }
    }
}

/// Fewer blocks have no standard error worth the name.
const FEWEST_GAINS: usize = 3;

/// Mean over standard error; zero where there are too few values.
#[must_use]
pub(crate) fn t_of(gains: &[f64]) -> f64 {
    if gains.len() < FEWEST_GAINS {
        return 0.0;
    }
    let count = gains.len() as f64;
    let mean = gains.iter().sum::<f64>() / count.max(1.0);
    let variance =
        gains.iter().map(|gain| (gain - mean).powi(2)).sum::<f64>() / (count - 1.0).max(1.0);
    mean / (variance / count.max(1.0)).sqrt().max(f64::MIN_POSITIVE)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_known_line_is_found_and_a_foreign_column_gains_nothing() {
        let rows = 20_000;
        let wave = |k: f64| {
            (0..rows)
                .map(|i| (k * f64::from(i)).sin())
                .collect::<Vec<f64>>()
        };
        let (a, b, noise) = (wave(0.011), wave(0.0231), wave(1.7));
        let target: Vec<f64> = a
            .iter()
            .zip(&noise)
            .map(|(a, n)| 3.0 * a + 0.1 * n)
            .collect();
        let mask = vec![true; rows as usize];
        let before = Blocks::new(&[&a], &target, &mask, 1.0e-3).cross_validate();
        let after = Blocks::new(&[&a, &b], &target, &mask, 1.0e-3).cross_validate();
        assert!((before.coefficients[0] - 3.0).abs() < 1.0e-3);
        assert!(Gain::of(&before, &after).share < 0.01);
        let none = Blocks::new(&[&b], &target, &mask, 1.0e-3).cross_validate();
        assert!(Gain::of(&none, &after).share > 0.99);
    }
}
