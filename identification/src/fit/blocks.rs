//! Least squares on blocks: fit, held-out error, intervals, all from one Gram matrix per block.
//!
//! Residuals of a servo axis are correlated, so whole blocks of one second are left out, with a
//! guard at their ends; random rows would tell the fit what it is asked to predict.

use nalgebra::{DMatrix, DVector};

use crate::fit::non_negative::non_negative;
use crate::fit::rows::{FOLDS, Rows};

/// Two-sided 95 % quantiles of Student's t with one degree of freedom, two, … nine.
const STUDENT: [f64; FOLDS - 1] = [
    12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262,
];

/// So many blocks after one may still have what is left of it.
const NEIGHBOURS: usize = 2;

/// Ridge, relative to the mean diagonal: keeps equal columns from blowing up.
const RIDGE: f64 = 1.0e-12;

/// A column is in one fold where no more than this part of its sum of squares is in the others.
const NOTHING_LEFT: f64 = 1.0e-6;

/// A coefficient that is known beforehand may differ by as much as makes this part of the target's
/// root mean square: one that is next to zero (an offset) changes by more than a share of itself.
const LEAST_SPREAD: f64 = 0.05;

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
    /// Blocks of the samples of a mask.
    #[must_use]
    pub(crate) fn new(columns: &[&[f64]], target: &[f64], mask: &[bool], period_s: f64) -> Self {
        let width = columns.len() + 1;
        Self::of(Rows::new(columns, target, mask, period_s).grams(), width)
    }

    /// Blocks of rows with more columns beside those that were gathered.
    #[must_use]
    pub(crate) fn with(rows: &Rows, more: &[Vec<f64>]) -> Self {
        Self::of(rows.grams_with(more), rows.width() + more.len())
    }

    /// Blocks of rows with another target.
    #[must_use]
    pub(crate) fn toward(rows: &Rows, target: &[f64]) -> Self {
        Self::of(rows.grams_toward(target), rows.width())
    }

    /// Blocks by the Gram matrices of so many columns, the target's last.
    fn of(mut grams: Vec<DMatrix<f64>>, size: usize) -> Self {
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

    /// The same blocks in another number of folds.
    #[must_use]
    pub(crate) fn in_folds(self, folds: usize) -> Self {
        let folds = folds.min(self.grams.len()).max(1);
        Self { folds, ..self }
    }

    /// What is there to explain: the fit without any column.
    #[must_use]
    pub(crate) fn nothing(&self) -> Fit {
        let last = self.scale.len() - 1;
        let held_out: Vec<f64> = self.grams.iter().map(|gram| gram[(last, last)]).collect();
        let total = held_out.iter().sum();
        Fit {
            coefficients: vec![0.0; last],
            sse: total,
            held_out,
            total,
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

    /// Sum of squares left on folds that were left out, with coefficients that are known beforehand
    /// to within a share of themselves, or [`LEAST_SPREAD`]: what a fold's rest does not tell stays
    /// where it was. The blocks hold so many independent samples.
    #[must_use]
    pub(crate) fn left_out_near(
        &self,
        known: &[f64],
        within: f64,
        independent_samples: f64,
    ) -> f64 {
        let size = self.scale.len();
        let total = sum(&self.grams, size);
        let least = |i: usize| LEAST_SPREAD * (total[(size - 1, size - 1)] / total[(i, i)]).sqrt();
        let spread = known.iter().enumerate().map(|(i, known)| {
            let least = Some(least(i)).filter(|least| least.is_finite());
            within * known.abs().max(least.unwrap_or(0.0))
        });
        let spread: Vec<f64> = spread.collect();
        let of_fold = |fold: usize| {
            let own = self.grams.iter().skip(fold).step_by(self.folds);
            let own = own.fold(DMatrix::zeros(size, size), |sum, gram| sum + gram);
            let rest = &total - &own;
            let share =
                rest[(size - 1, size - 1)] / total[(size - 1, size - 1)].max(f64::MIN_POSITIVE);
            let samples = (share * independent_samples).max(1.0);
            let variance = left(&rest, &self.solve(&rest)) / samples;
            left(&own, &near(&rest, known, &spread, variance))
        };
        (0..self.folds).map(of_fold).sum()
    }

    /// Half widths of 95 % intervals: the wider one of those by folds and of those by neighbours.
    #[must_use]
    pub(crate) fn half_widths(&self) -> Vec<f64> {
        let both = self.half_widths_by_folds().into_iter();
        let both = both.zip(self.half_widths_by_neighbours());
        both.map(|(folds, neighbours)| folds.max(neighbours))
            .collect()
    }

    /// Half widths by the jackknife over single blocks, where what is left of a block goes on in
    /// the next ones: their products count as far as they are near (Newey and West, Econometrica
    /// 55, 1987, with Bartlett's weights). In folds, neighbours are apart and say nothing of that.
    fn half_widths_by_neighbours(&self) -> Vec<f64> {
        let single = self.clone().in_folds(self.grams.len());
        let away = single.away_from_their_mean();
        let products = |i: usize, lag: usize| -> f64 {
            let pairs = away.iter().zip(away.iter().skip(lag));
            pairs.map(|(one, next)| one[i] * next[i]).sum()
        };
        let variance = |i: usize| {
            let near = (1..=NEIGHBOURS).map(|lag| {
                let weight = 1.0 - lag as f64 / (NEIGHBOURS + 1) as f64;
                2.0 * weight * products(i, lag)
            });
            single.jackknife() * (products(i, 0) + near.sum::<f64>()).max(0.0)
        };
        let quantile = student(single.folds);
        (0..self.scale.len() - 1)
            .map(|i| quantile * variance(i).sqrt())
            .collect()
    }

    /// Half widths by the jackknife over folds. The folds are few, so the quantile is that of
    /// Student's t with one degree of freedom less than there are folds (Efron and Tibshirani, An
    /// Introduction to the Bootstrap, 1993, ch. 12).
    fn half_widths_by_folds(&self) -> Vec<f64> {
        let away = self.away_from_their_mean();
        let of_column = |i: usize| away.iter().map(|away| away[i].powi(2)).sum::<f64>();
        let quantile = student(self.folds);
        (0..self.scale.len() - 1)
            .map(|i| quantile * (self.jackknife() * of_column(i)).sqrt())
            .collect()
    }

    /// The same, but for a column that lives in one fold, as a step at a time does. Without that
    /// fold nothing is known of it, so the jackknife says nothing: it has the half width of least
    /// squares over so many independent samples.
    #[must_use]
    pub(crate) fn half_widths_beside_steps(&self, independent_samples: f64) -> Vec<f64> {
        let mut half_widths = self.half_widths();
        let steps = (0..half_widths.len()).filter(|i| self.is_in_one_fold(*i));
        let steps: Vec<usize> = steps.collect();
        if !steps.is_empty() {
            let plain = self.plain_half_widths(independent_samples);
            for step in steps {
                half_widths[step] = plain[step];
            }
        }
        half_widths
    }

    /// Whether hardly anything is left of a column without one of the folds.
    fn is_in_one_fold(&self, column: usize) -> bool {
        let power = |grams: &mut dyn Iterator<Item = &DMatrix<f64>>| -> f64 {
            grams.map(|gram| gram[(column, column)]).sum()
        };
        let all = power(&mut self.grams.iter());
        let of_fold = |fold| power(&mut self.grams.iter().skip(fold).step_by(self.folds));
        (0..self.folds).any(|fold| all - of_fold(fold) < NOTHING_LEFT * all)
    }

    /// Half widths of 95 % intervals by least squares.
    fn plain_half_widths(&self, independent_samples: f64) -> Vec<f64> {
        let size = self.scale.len() - 1;
        let total = sum(&self.grams, size + 1);
        let scaled = |i: usize, j: usize| total[(i, j)] / (self.scale[i] * self.scale[j]);
        let inverse = DMatrix::from_fn(size, size, scaled).pseudo_inverse(RIDGE);
        let variance = self.fit().sse / independent_samples.max(1.0);
        let half_width = |i: usize| {
            let own = inverse
                .as_ref()
                .map_or(f64::INFINITY, |inverse| inverse[(i, i)]);
            1.96 * (own.max(0.0) * variance).sqrt() / self.scale[i]
        };
        (0..size).map(half_width).collect()
    }

    /// Half width of the 95 % interval of the prediction of blocks with the same columns, rms over
    /// them, percent of their target; infinite where the prediction has no bounds.
    #[must_use]
    pub(crate) fn uncertainty_on(&self, other: &Self) -> f64 {
        let size = other.scale.len();
        let total = sum(&other.grams, size);
        let columns = total.view((0, 0), (size - 1, size - 1));
        let away = self.away_from_their_mean();
        let spread: f64 = away.iter().map(|away| away.dot(&(columns * away))).sum();
        let share = self.jackknife() * spread / total[(size - 1, size - 1)];
        if share.is_finite() {
            100.0 * 1.96 * share.max(0.0).sqrt()
        } else {
            f64::INFINITY
        }
    }

    /// Coefficients without each fold, about their mean.
    fn away_from_their_mean(&self) -> Vec<DVector<f64>> {
        let total = sum(&self.grams, self.scale.len());
        let folds: Vec<DVector<f64>> = (0..self.folds)
            .map(|fold| self.without_fold(&total, fold))
            .collect();
        let mean = folds.iter().sum::<DVector<f64>>() / folds.len() as f64;
        folds.into_iter().map(|fold| fold - &mean).collect()
    }

    /// Coefficients over all blocks of which none is negative, of all columns but the first ones,
    /// which are free.
    #[must_use]
    pub(crate) fn non_negative_beside(&self, free: usize) -> Vec<f64> {
        non_negative(&self.beside(free, &sum(&self.grams, self.scale.len())))
    }

    /// The same without each fold.
    #[must_use]
    pub(crate) fn non_negative_beside_without_folds(&self, free: usize) -> Vec<Vec<f64>> {
        self.without_folds(|rest| non_negative(&self.beside(free, rest)))
    }

    /// All coefficients without each fold, those of the first columns free and those of the others
    /// not negative.
    #[must_use]
    pub(crate) fn beside_non_negative_without_folds(&self, free: usize) -> Vec<Vec<f64>> {
        self.without_folds(|rest| {
            let parts = non_negative(&self.beside(free, rest));
            let mut all = self.solve_first(free, rest, &parts);
            all.extend(parts);
            all
        })
    }

    /// What follows from the Gram matrix without each fold.
    fn without_folds<T>(&self, of: impl Fn(&DMatrix<f64>) -> T) -> Vec<T> {
        let total = sum(&self.grams, self.scale.len());
        let without = |fold: usize| of(&self.gram_without(&total, fold));
        (0..self.folds).map(without).collect()
    }

    /// Coefficients of the first columns beside those of the others.
    fn solve_first(&self, free: usize, gram: &DMatrix<f64>, others: &[f64]) -> Vec<f64> {
        let last = self.scale.len() - 1;
        let own = |i: usize| if i < free { i } else { last };
        // What the others explain of each product with the target is taken away.
        let explained = |i: usize| {
            let of_others = others.iter().enumerate();
            of_others
                .map(|(j, other)| other * gram[(i, free + j)])
                .sum::<f64>()
        };
        let reduced = DMatrix::from_fn(free + 1, free + 1, |i, j| {
            let product = gram[(own(i), own(j))];
            match (own(i) == last, own(j) == last) {
                (false, true) => product - explained(i),
                (true, false) => product - explained(j),
                _ => product,
            }
        });
        let scale: Vec<f64> = (0..=free).map(|i| self.scale[own(i)]).collect();
        solved(&reduced, &scale).as_slice().to_vec()
    }

    /// A Gram matrix of what the first columns leave of the others (Schur's complement).
    fn beside(&self, free: usize, gram: &DMatrix<f64>) -> DMatrix<f64> {
        let size = self.scale.len();
        let scaled = |i: usize, j: usize| gram[(i, j)] / (self.scale[i] * self.scale[j]);
        let mut own = DMatrix::from_fn(free, free, scaled);
        let ridge = RIDGE * own.trace().max(f64::MIN_POSITIVE) / free.max(1) as f64;
        (0..free).for_each(|i| own[(i, i)] += ridge);
        let cross = DMatrix::from_fn(free, size - free, |i, j| scaled(i, free + j));
        let explained = own
            .cholesky()
            .map_or_else(|| 0.0 * &cross, |c| c.solve(&cross));
        let left = cross.transpose() * explained;
        DMatrix::from_fn(size - free, size - free, |i, j| {
            let (i, j, left) = (free + i, free + j, left[(i, j)]);
            (scaled(i, j) - left) * self.scale[i] * self.scale[j]
        })
    }

    /// Variance of what all folds give over the squares of what each leaves.
    fn jackknife(&self) -> f64 {
        let count = self.folds as f64;
        (count - 1.0) / count
    }

    fn without_fold(&self, total: &DMatrix<f64>, fold: usize) -> DVector<f64> {
        self.solve(&self.gram_without(total, fold))
    }

    fn gram_without(&self, total: &DMatrix<f64>, fold: usize) -> DMatrix<f64> {
        let own = self.grams.iter().skip(fold).step_by(self.folds);
        own.fold(total.clone(), |rest, gram| rest - gram)
    }

    fn solve(&self, gram: &DMatrix<f64>) -> DVector<f64> {
        solved(gram, &self.scale)
    }
}

/// Least squares by a Gram matrix whose columns, the target's last, have such scales.
fn solved(gram: &DMatrix<f64>, scale: &[f64]) -> DVector<f64> {
    let size = scale.len() - 1;
    let scaled = |i: usize, j: usize| gram[(i, j)] / (scale[i] * scale[j]);
    let mut normal = DMatrix::from_fn(size, size, scaled);
    let ridge = RIDGE * normal.trace().max(f64::MIN_POSITIVE) / size.max(1) as f64;
    (0..size).for_each(|i| normal[(i, i)] += ridge);
    let right = DVector::from_fn(size, |i, _| scaled(i, size));
    let solution = normal
        .cholesky()
        .map_or_else(|| DVector::zeros(size), |c| c.solve(&right));
    DVector::from_fn(size, |i, _| solution[i] * scale[size] / scale[i])
}

/// Half width of the 95 % interval of a value that came out so without each fold: by the jackknife,
/// for what no linear fit gives.
#[must_use]
pub(crate) fn half_width_without_folds(values: &[f64]) -> f64 {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let spread: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
    student(values.len()) * ((count - 1.0) / count * spread).sqrt()
}

/// Two-sided 95 % quantile of Student's t with one degree of freedom less than there are parts;
/// beyond the table within 0.01 of it.
fn student(parts: usize) -> f64 {
    let freedom = parts.max(2) - 1;
    let known = STUDENT.get(freedom - 1).copied();
    known.unwrap_or(1.96 + 2.5 / freedom as f64)
}

/// Least squares by a Gram matrix with coefficients that are known to within a spread each, where
/// an independent sample of the target has this variance (Tikhonov's regularisation).
fn near(gram: &DMatrix<f64>, known: &[f64], spread: &[f64], variance: f64) -> DVector<f64> {
    let size = known.len();
    let known = DVector::from_row_slice(known);
    let columns = gram.view((0, 0), (size, size)).into_owned();
    let right = gram.view((0, size), (size, 1)).column(0) - &columns * &known;
    // In spreads, so that all are of one size.
    let scaled = DMatrix::from_fn(size, size, |i, j| columns[(i, j)] * spread[i] * spread[j]);
    let right = DVector::from_fn(size, |i, _| right[i] * spread[i]);
    let ridge = variance.max(RIDGE * scaled.trace()).max(f64::MIN_POSITIVE);
    let normal = scaled + DMatrix::identity(size, size) * ridge;
    let moved = normal
        .cholesky()
        .map_or_else(|| DVector::zeros(size), |c| c.solve(&right));
    DVector::from_fn(size, |i, _| known[i] + spread[i] * moved[i])
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

    #[test]
    fn free_columns_are_fitted_beside_those_that_are_not_negative() {
        let wave = |k: f64| -> Vec<f64> { (0..20_000).map(|i| (k * f64::from(i)).sin()).collect() };
        let (free, one, other) = (wave(0.011), wave(0.0231), wave(0.017));
        let rows = free.iter().zip(&one).zip(&other);
        let target: Vec<f64> = rows.map(|((f, a), b)| -2.0 * f + 3.0 * a - b).collect();
        let columns = [&free[..], &one, &other];
        let blocks = Blocks::new(&columns, &target, &vec![true; 20_000], 1.0e-3);
        for own in blocks.beside_non_negative_without_folds(1) {
            assert!(
                (own[0] + 2.0).abs() < 0.02 && (own[1] - 3.0).abs() < 0.02,
                "{own:?}"
            );
            assert_eq!(own[2], 0.0);
        }
    }

    /// A gram of one column and a target, as if from one row each.
    fn blocks(rows: &[(f64, f64)]) -> Blocks {
        let gram =
            |(x, y): &(f64, f64)| DMatrix::from_row_slice(2, 2, &[x * x, x * y, x * y, y * y]);
        let grams: Vec<DMatrix<f64>> = rows.iter().map(gram).collect();
        Blocks {
            folds: grams.len(),
            scale: vec![1.0, 1.0],
            grams,
        }
    }

    #[test]
    fn what_a_record_does_not_tell_stays_as_it_was_known() {
        let known = [2.0, 1.0];
        let at = |gram: &[f64], within: f64, variance| {
            let spread = known.map(|known| within * known);
            let gram = DMatrix::from_row_slice(3, 3, gram);
            let coefficients = near(&gram, &known, &spread, variance);
            [coefficients[0], coefficients[1]]
        };
        let is_near = |one: [f64; 2], other: [f64; 2]| {
            one.iter()
                .zip(other)
                .all(|(one, other)| (one - other).abs() < 1.0e-4)
        };
        // Nothing is told.
        assert!(is_near(at(&[0.0; 9], 1.0, 1.0), known));
        // Two columns that are one: their sum is 4 instead of 3, by shares of what was known.
        let together = [1.0, 1.0, 4.0, 1.0, 1.0, 4.0, 4.0, 4.0, 16.0];
        assert!(is_near(at(&together, 1.0, 1.0e-9), [2.8, 1.2]));
        // Two columns for themselves, of a certain record and of one that says next to nothing.
        let apart = [1.0, 0.0, 3.0, 0.0, 1.0, -1.0, 3.0, -1.0, 10.0];
        assert!(is_near(at(&apart, 1.0, 1.0e-9), [3.0, -1.0]));
        assert!(is_near(at(&apart, 1.0e-3, 1.0e3), known));
    }

    #[test]
    fn folds_that_are_left_out_are_judged_between_what_was_known_and_what_the_others_say() {
        let blocks = blocks(&[(1.0, 2.0), (1.0, 2.0), (1.0, 5.0)]);
        let left = |within| blocks.left_out_near(&[2.0], within, 30.0);
        let others: f64 = blocks.cross_validate().held_out.iter().sum();
        assert!((left(1.0e-6) - 9.0).abs() < 1.0e-6);
        assert!((left(1.0e6) - others).abs() < 1.0e-6, "{others}");
    }

    #[test]
    fn a_coefficient_that_was_next_to_zero_may_move_by_its_part_of_the_target() {
        // All of the target is one column, whose coefficient comes from 0 to 3.
        let left = blocks(&[(1.0, 3.0); 40]).left_out_near(&[0.0], 1.0, 4.0e3);
        assert!(left < 1.0e-3 * 9.0 * 40.0, "{left}");
    }

    #[test]
    fn each_block_is_predicted_from_the_others() {
        // Slopes 2, 2 and 5 at x = 1: the third is predicted as 2, the others as 3.5.
        let fit = blocks(&[(1.0, 2.0), (1.0, 2.0), (1.0, 5.0)]).cross_validate();
        assert!((fit.coefficients[0] - 3.0).abs() < 1.0e-9);
        let wanted = [2.25, 2.25, 9.0];
        let pairs = fit.held_out.iter().zip(wanted);
        assert!(
            pairs
                .into_iter()
                .all(|(left, wanted)| (left - wanted).abs() < 1.0e-9)
        );
        assert!((fit.sse - 6.0).abs() < 1.0e-9 && (fit.total - 33.0).abs() < 1.0e-9);
    }

    #[test]
    fn half_widths_are_those_of_the_jackknife() {
        // Without one block each: 3.5, 3.5, 2; mean 3, squares 1.5, times 2/3 is 1.
        let widths = blocks(&[(1.0, 2.0), (1.0, 2.0), (1.0, 5.0)]).half_widths_by_folds();
        assert_eq!(widths.len(), 1);
        assert!((widths[0] - STUDENT[1]).abs() < 1.0e-9, "{widths:?}");
    }

    #[test]
    fn what_goes_on_in_the_next_block_makes_an_interval_wider() {
        let is_up = |draw: usize| (13 * draw * draw + 7 * draw) % 31 > 15;
        let value = |draw: usize| if is_up(draw) { 6.0 } else { 4.0 };
        // Sixty draws of one block each, and twenty of three blocks each.
        let known = |blocks_each: usize| {
            let rows: Vec<(f64, f64)> =
                (0..60).map(|row| (1.0, value(row / blocks_each))).collect();
            let blocks = blocks(&rows).in_folds(FOLDS);
            (
                blocks.half_widths_by_neighbours()[0],
                blocks.half_widths_by_folds()[0],
            )
        };
        let wanted = |draws: f64| 2.0 / draws.sqrt();
        let (apart, _) = known(1);
        assert!((apart / wanted(60.0) - 1.0).abs() < 0.4, "{apart}");
        let (together, by_folds) = known(3);
        assert!(
            together / wanted(20.0) > 0.7 && together > by_folds,
            "{together} {by_folds}"
        );
    }

    #[test]
    fn a_gain_is_share_size_and_t_of_what_blocks_lose() {
        let fit = |held_out: &[f64]| Fit {
            coefficients: Vec::new(),
            sse: 0.0,
            held_out: held_out.to_vec(),
            total: 10_000.0,
        };
        let gain = Gain::of(&fit(&[4.0, 5.0, 6.0]), &fit(&[3.0, 3.0, 3.0]));
        // Gains 1, 2, 3: mean 2, standard error 1/√3.
        assert!((gain.removed - 6.0).abs() < 1.0e-12 && (gain.share - 0.4).abs() < 1.0e-12);
        assert!((gain.percent - 100.0 * (6.0e-4_f64).sqrt()).abs() < 1.0e-12);
        assert!((gain.t - 2.0 * 3.0_f64.sqrt()).abs() < 1.0e-12);
        let loss = Gain::of(&fit(&[3.0, 3.0, 3.0]), &fit(&[4.0, 5.0, 6.0]));
        assert!((loss.percent + gain.percent).abs() < 1.0e-12 && loss.t < 0.0);
    }

    #[test]
    fn the_smaller_gain_has_the_smaller_share_and_t_and_keeps_its_size() {
        let gain = |share, percent, t| Gain {
            removed: share,
            share,
            percent,
            t,
        };
        let smaller = gain(0.3, 1.0, 2.0).smaller(&gain(0.1, 9.0, 5.0));
        assert_eq!(
            smaller,
            Gain {
                removed: 0.3,
                ..gain(0.1, 1.0, 2.0)
            }
        );
        let smaller = gain(0.3, 1.0, 5.0).smaller(&gain(0.4, 9.0, 2.0));
        assert_eq!((smaller.share, smaller.t), (0.3, 2.0));
    }

    #[test]
    fn two_blocks_have_no_standard_error_and_three_have() {
        assert_eq!(t_of(&[1.0, 1.1]), 0.0);
        assert!((t_of(&[1.0, 2.0, 6.0]) - 3.0 / (7.0_f64 / 3.0).sqrt()).abs() < 1.0e-12);
    }

    #[test]
    fn samples_within_twenty_milliseconds_of_the_end_of_a_second_are_not_used() {
        let rows = 10_000;
        let (ones, mask) = (vec![1.0; rows], vec![true; rows]);
        let at = |rows: &[usize]| {
            let mut target = vec![1.0; 10_000];
            for row in rows {
                target[*row] = 1000.0;
            }
            Blocks::new(&[&ones], &target, &mask, 1.0e-3)
                .fit()
                .coefficients[0]
        };
        assert!((at(&[0, 19, 980, 999, 1000, 9980]) - 1.0).abs() < 1.0e-9);
        for row in [20, 979, 1020] {
            assert!(at(&[row]) > 1.1, "{row}");
        }
    }

    #[test]
    fn a_mask_leaves_samples_out_and_an_empty_block_is_none() {
        let rows = 3000;
        let ones = vec![1.0; rows];
        let target: Vec<f64> = (0..rows)
            .map(|row| if row < 1500 { 1.0 } else { 3.0 })
            .collect();
        let mask: Vec<bool> = (0..rows).map(|row| row < 1500).collect();
        let fit = Blocks::new(&[&ones], &target, &mask, 1.0e-3).cross_validate();
        assert!((fit.coefficients[0] - 1.0).abs() < 1.0e-9);
        // Blocks of a tenth of the record: five of ten have samples.
        assert_eq!(fit.held_out.len(), 5);
    }

    #[test]
    fn a_column_of_zeros_gets_no_coefficient_and_equal_columns_share() {
        let rows = 3000;
        let (ones, zeros) = (vec![1.0; rows], vec![0.0; rows]);
        let mask = vec![true; rows];
        let fit = Blocks::new(&[&ones, &zeros, &ones], &ones, &mask, 1.0e-3).fit();
        assert!(fit.coefficients[1].abs() < 1.0e-6);
        assert!((fit.coefficients[0] + fit.coefficients[2] - 1.0).abs() < 1.0e-6);
        assert!((fit.coefficients[0] - fit.coefficients[2]).abs() < 0.1);
    }

    #[test]
    fn a_column_that_overflows_is_no_perfect_fit() {
        let gram = DMatrix::from_element(2, 2, f64::INFINITY);
        assert_eq!(left(&gram, &DVector::from_element(1, 1.0)), f64::MAX);
    }
}
