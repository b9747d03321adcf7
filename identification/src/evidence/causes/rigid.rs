//! The rigid axis, `u = M a + B v + C sign v + F0`, as a witness: how much of the effort it leaves.
//!
//! It asks moving rows only, one in five milliseconds (the low-pass makes neighbours alike), and
//! takes the effort from anywhere: from another row, by another clock, as a mean.

use std::ops::Range;

use nalgebra::{Matrix4, Vector4};

use crate::motion::kinematics::Kinematics;
use crate::record::dataset::Dataset;

/// Time between two rows that are asked, s: a sixth of a period at 30 Hz.
const APART_S: f64 = 5.0e-3;
/// Fewest rows for a fit of four numbers: a quarter of a second of motion.
const FEWEST_ROWS: usize = 50;

/// Columns and efforts of one record.
pub(crate) struct Rigid {
    /// Acceleration, velocity, direction, one; low-passed.
    columns: Vec<[f64; 4]>,
    /// Effort, low-passed.
    effort: Vec<f64>,
    /// Moving rows.
    rows: Vec<usize>,
    /// Sample period, s.
    pub period_s: f64,
}

/// A fit of it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RigidFit {
    /// Inertia, viscous and Coulomb friction, constant.
    pub coefficients: [f64; 4],
    /// Share of the effort's variance that is left.
    pub left: f64,
    /// Sum of squares of the effort about its mean.
    pub scatter: f64,
}

impl Rigid {
    /// The witness of a record.
    pub(crate) fn of(dataset: &Dataset, motion: &Kinematics) -> Self {
        let limit = dataset.moving_velocity;
        let friction: Vec<f64> = motion
            .velocity_lp
            .iter()
            .map(|v| (v / limit).clamp(-1.0, 1.0))
            .collect();
        let [acceleration, velocity, direction] =
            [&motion.acceleration, &motion.velocity, &friction].map(|c| motion.low_passed(c));
        let every = ((APART_S / motion.period_s).round() as usize).max(1);
        let column = |row: usize| [acceleration[row], velocity[row], direction[row], 1.0];
        Self {
            columns: (0..motion.len()).map(column).collect(),
            effort: motion.effort_lp.clone(),
            rows: (0..motion.len())
                .step_by(every)
                .filter(|row| motion.moving[*row])
                .collect(),
            period_s: motion.period_s,
        }
    }

    /// Number of rows of the record.
    pub(crate) const fn len(&self) -> usize {
        self.effort.len()
    }

    /// The fit to all moving rows.
    pub(crate) fn fit(&self) -> Option<RigidFit> {
        self.fit_to(0..self.len(), &|row| Some(self.effort[row]))
    }

    /// The fit to a part of the rows.
    pub(crate) fn fit_part(&self, part: Range<usize>) -> Option<RigidFit> {
        self.fit_to(part, &|row| Some(self.effort[row]))
    }

    /// The fit to those rows for which something holds.
    pub(crate) fn fit_where(&self, holds: &dyn Fn(usize) -> bool) -> Option<RigidFit> {
        let effort = |row: usize| holds(row).then(|| self.effort[row]);
        self.fit_to(0..self.len(), &effort)
    }

    /// Mean of what coefficients predict over moving rows for which something holds.
    pub(crate) fn mean_predicted(
        &self,
        coefficients: [f64; 4],
        holds: &dyn Fn(usize) -> bool,
    ) -> Option<f64> {
        let rows = self.rows.iter().filter(|row| holds(**row));
        let predicted = rows.map(|row| product(&self.columns[*row], &coefficients));
        let (count, sum) = predicted.fold((0.0, 0.0), |(n, sum), u| (n + 1.0, sum + u));
        (count > 0.0).then(|| sum / count)
    }

    /// The fit with the effort taken from so many rows later; between two rows it is a line.
    pub(crate) fn fit_later(&self, rows_later: &dyn Fn(usize) -> f64) -> Option<RigidFit> {
        self.fit_to(0..self.len(), &|row| {
            self.effort_at(row as f64 + rows_later(row))
        })
    }

    /// The fit of the means of the columns over the last rows.
    pub(crate) fn fit_means(&self, rows: usize) -> Option<RigidFit> {
        let mut sum = [0.0; 4];
        let mut means = Vec::with_capacity(self.len());
        for row in 0..self.len() {
            for (place, sum) in sum.iter_mut().enumerate() {
                let gone = row
                    .checked_sub(rows)
                    .map_or(0.0, |old| self.columns[old][place]);
                *sum += self.columns[row][place] - gone;
            }
            means.push(sum.map(|sum| sum / rows as f64));
        }
        let from = self.rows.iter().copied().filter(|row| *row >= rows);
        fit(from.map(|row| (means[row], self.effort[row])))
    }

    /// The fit of the columns behind a first-order lag.
    pub(crate) fn fit_lagged(&self, lag_s: f64) -> Option<RigidFit> {
        let share = 1.0 - (-self.period_s / lag_s).exp();
        let mut state = *self.columns.first()?;
        let mut lagged = Vec::with_capacity(self.len());
        for columns in &self.columns {
            for (state, column) in state.iter_mut().zip(columns) {
                *state += share * (column - *state);
            }
            lagged.push(state);
        }
        let rows = self.rows.iter().copied();
        fit(rows.map(|row| (lagged[row], self.effort[row])))
    }

    fn effort_at(&self, row: f64) -> Option<f64> {
        let (before, share) = (row.floor(), row - row.floor());
        let at = (before >= 0.0).then_some(before as usize)?;
        let (one, next) = (self.effort.get(at)?, self.effort.get(at + 1)?);
        Some(one + share * (next - one))
    }

    fn fit_to(
        &self,
        part: Range<usize>,
        effort: &dyn Fn(usize) -> Option<f64>,
    ) -> Option<RigidFit> {
        let rows = self.rows.iter().copied().filter(|row| part.contains(row));
        fit(rows.filter_map(|row| Some((self.columns[row], effort(row)?))))
    }

    /// Share of the effort's variance that other coefficients leave.
    pub(crate) fn left_by(&self, coefficients: [f64; 4]) -> f64 {
        let mut sums = Moments::default();
        let mut left = 0.0;
        for row in &self.rows {
            let effort = self.effort[*row];
            let predicted = product(&self.columns[*row], &coefficients);
            left += (effort - predicted).powi(2);
            sums.add(effort);
        }
        left / sums.scatter().max(f64::MIN_POSITIVE)
    }
}

fn product(columns: &[f64; 4], coefficients: &[f64; 4]) -> f64 {
    let pairs = columns.iter().zip(coefficients);
    pairs.map(|(column, factor)| column * factor).sum()
}

/// Sums for a variance.
#[derive(Clone, Copy, Default)]
struct Moments {
    count: f64,
    sum: f64,
    squares: f64,
}

impl Moments {
    fn add(&mut self, value: f64) {
        self.count += 1.0;
        self.sum += value;
        self.squares += value * value;
    }

    fn scatter(&self) -> f64 {
        self.squares - self.sum * self.sum / self.count.max(1.0)
    }
}

fn fit(rows: impl Iterator<Item = ([f64; 4], f64)>) -> Option<RigidFit> {
    let (mut gram, mut cross, mut moments) =
        (Matrix4::zeros(), Vector4::zeros(), Moments::default());
    for (columns, effort) in rows {
        let columns = Vector4::from(columns);
        gram += columns * columns.transpose();
        cross += effort * columns;
        moments.add(effort);
    }
    if moments.count < FEWEST_ROWS as f64 || moments.scatter() <= 0.0 {
        return None;
    }
    // Scaled, so that metres and newtons do not decide what is singular.
    let scale = gram
        .diagonal()
        .map(|square: f64| 1.0 / square.sqrt().max(f64::MIN_POSITIVE));
    let by = Matrix4::from_diagonal(&scale);
    let solved = (by * gram * by).cholesky()?.solve(&(by * cross));
    let coefficients = by * solved;
    let left = moments.squares - cross.dot(&coefficients);
    Some(RigidFit {
        coefficients: coefficients.into(),
        left: (left / moments.scatter()).max(0.0),
        scatter: moments.scatter(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::made::{USUAL, axis, usual};

    fn rigid() -> Rigid {
        let axis = axis(usual);
        Rigid::of(&axis.dataset, &axis.motion)
    }

    #[test]
    fn a_rigid_axis_leaves_nothing_and_has_its_parameters() {
        let fit = rigid().fit().unwrap();
        assert!(fit.left < 1.0e-4, "{fit:?}");
        for (found, wanted) in fit.coefficients.into_iter().zip(USUAL).take(2) {
            assert!((found / wanted - 1.0).abs() < 0.02, "{found} {wanted}");
        }
        assert!((rigid().left_by(fit.coefficients) - fit.left).abs() < 1.0e-6);
        assert!(rigid().left_by(fit.coefficients.map(|c| 1.5 * c)) > 0.2);
    }

    #[test]
    fn an_effort_from_other_rows_or_of_means_leaves_more() {
        let rigid = rigid();
        let left = |fit: Option<RigidFit>| fit.unwrap().left;
        let shifted = left(rigid.fit_later(&|_| 40.0));
        assert!(shifted > 100.0 * left(rigid.fit()), "{shifted}");
        assert!(left(rigid.fit_means(1)) < 1.0e-4);
        assert!(left(rigid.fit_means(80)) > 0.01);
    }

    #[test]
    fn a_fit_needs_a_quarter_of_a_second() {
        let rigid = rigid();
        let at = rigid.rows[10];
        assert!(rigid.fit_part(at..at + 200).is_none());
        assert!(rigid.fit_part(at..at + 900).is_some());
    }
}
