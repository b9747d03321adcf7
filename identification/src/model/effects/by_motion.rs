//! The effort that the motion predicts: that of the usual four columns beside another effect's own.
//!
//! An effect that is a factor of the effort (friction per force, a torque constant that ripples)
//! must not have the recorded effort in its columns: they would hold the noise of the target, and
//! the fit would explain noise by itself. So the effort is computed from the motion. The few
//! coefficients for that are fitted to the record beside the effect's columns, and both are made to
//! agree by a few rounds. A handful of numbers from thousands of rows hold no noise of a row.

use nalgebra::{DMatrix, DVector};

use crate::motion::kinematics::Kinematics;

/// Acceleration, velocity, direction, one.
pub(crate) type Usual = [f64; 4];

/// What the usual effort is made of, row by row and low-passed.
pub(crate) struct ByMotion<'a> {
    motion: &'a Kinematics,
    /// Low-passed acceleration.
    pub acceleration: Vec<f64>,
    columns: [Vec<f64>; 4],
}

impl<'a> ByMotion<'a> {
    /// Of a motion.
    #[must_use]
    pub(crate) fn of(motion: &'a Kinematics) -> Self {
        let acceleration = motion.low_passed(&motion.acceleration);
        let columns = [
            acceleration.clone(),
            motion.velocity_lp.clone(),
            motion.low_passed(&motion.direction),
            vec![1.0; motion.len()],
        ];
        Self {
            motion,
            acceleration,
            columns,
        }
    }

    /// What a row has of each.
    #[must_use]
    pub(crate) fn at(&self, row: usize) -> Usual {
        [
            self.acceleration[row],
            self.motion.velocity_lp[row],
            self.motion.direction[row],
            1.0,
        ]
    }

    /// Effort of a row with the coefficients of a fit.
    #[must_use]
    pub(crate) fn effort(&self, usual: Usual, row: usize) -> f64 {
        let pairs = usual.into_iter().zip(self.at(row));
        pairs.map(|(coefficient, value)| coefficient * value).sum()
    }

    /// Efforts of all rows by the usual columns alone.
    #[must_use]
    pub(crate) fn efforts(&self) -> Vec<f64> {
        let (usual, _) = self.fit(&[]);
        let rows = 0..self.motion.len();
        rows.map(|row| self.effort(usual, row)).collect()
    }

    /// Coefficients of the usual columns and of others beside them, by least squares over the
    /// fitted samples.
    #[must_use]
    pub(crate) fn fit(&self, beside: &[Vec<f64>]) -> (Usual, Vec<f64>) {
        let low_passed: Vec<Vec<f64>> = beside
            .iter()
            .map(|own| self.motion.low_passed(own))
            .collect();
        let columns: Vec<&[f64]> = self
            .columns
            .iter()
            .chain(&low_passed)
            .map(Vec::as_slice)
            .collect();
        let solution = least_squares(self.motion, &columns);
        let (usual, own) = solution.split_at(self.columns.len());
        ([usual[0], usual[1], usual[2], usual[3]], own.to_vec())
    }
}

/// A column of zeros, or one that repeats others, gets no coefficient.
fn least_squares(motion: &Kinematics, columns: &[&[f64]]) -> Vec<f64> {
    let size = columns.len();
    let (mut gram, mut right) = (DMatrix::zeros(size, size), DVector::zeros(size));
    let mut at = DVector::zeros(size);
    for row in (0..motion.len()).filter(|row| motion.fitted[*row]) {
        for (value, column) in at.iter_mut().zip(columns) {
            *value = column[row];
        }
        gram.ger(1.0, &at, &at, 1.0);
        right.axpy(motion.effort_lp[row], &at, 1.0);
    }
    let smallest = SINGULAR * gram.norm();
    let solution = gram.svd(true, true).solve(&right, smallest);
    solution.map_or_else(|_| vec![0.0; size], |solution| solution.as_slice().to_vec())
}

/// Singular values below this share of the largest are none: rounding of a sum over 10⁵ rows.
const SINGULAR: f64 = 1.0e-12;
