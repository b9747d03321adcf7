//! Output-error fit: the parameters whose simulation stays nearest to the recorded positions.

use levenberg_marquardt::{LeastSquaresProblem, LevenbergMarquardt};
use nalgebra::storage::Owned;
use nalgebra::{DMatrix, DVector, Dyn};

use super::model::{Entry, Simulated};
use super::{Drive, SETTLING_ROWS, simulate};
use crate::record::Record;

/// Every so many rows is compared: positions are smooth.
const STRIDE: usize = 5;
/// Simulations that a fit may use, as a multiple of the number of parameters.
const PATIENCE: usize = 12;

struct Problem<'a> {
    start: &'a Simulated,
    drive: &'a Drive,
    record: &'a Record,
    rows: Vec<usize>,
    entries: Vec<Entry>,
    scale: f64,
    at: DVector<f64>,
}

impl Problem<'_> {
    fn model(&self, at: &DVector<f64>) -> Simulated {
        let values: Vec<f64> = at
            .iter()
            .zip(&self.entries)
            .map(|(value, entry)| entry.scale * if entry.positive { value.abs().max(1.0e-4) } else { *value })
            .collect();
        self.start.with(&values)
    }

    fn residual_at(&self, at: &DVector<f64>) -> DVector<f64> {
        let run = simulate(&self.model(at), self.drive, self.record);
        let error = |row: &usize| {
            let error = (run.motor[*row] - self.record.position[*row]) / self.scale;
            if error.is_finite() { error } else { 1.0e6 }
        };
        DVector::from_iterator(self.rows.len(), self.rows.iter().map(error))
    }

    /// Forward differences, central ones where the cost is jagged.
    fn jacobian_at(&self, at: &DVector<f64>) -> DMatrix<f64> {
        let here = self.residual_at(at);
        let mut jacobian = DMatrix::zeros(self.rows.len(), at.len());
        for (place, entry) in self.entries.iter().enumerate() {
            let moved = |step: f64| {
                let mut at = at.clone();
                at[place] += step;
                self.residual_at(&at)
            };
            let slope = if entry.is_jagged() {
                (moved(entry.step) - moved(-entry.step)) / (2.0 * entry.step)
            } else {
                (moved(entry.step) - &here) / entry.step
            };
            jacobian.set_column(place, &slope);
        }
        jacobian
    }
}

impl LeastSquaresProblem<f64, Dyn, Dyn> for Problem<'_> {
    type ParameterStorage = Owned<f64, Dyn>;
    type ResidualStorage = Owned<f64, Dyn>;
    type JacobianStorage = Owned<f64, Dyn, Dyn>;

    fn set_params(&mut self, at: &DVector<f64>) {
        self.at.copy_from(at);
    }

    fn params(&self) -> DVector<f64> {
        self.at.clone()
    }

    fn residuals(&self) -> Option<DVector<f64>> {
        Some(self.residual_at(&self.at))
    }

    fn jacobian(&self) -> Option<DMatrix<f64>> {
        Some(self.jacobian_at(&self.at))
    }
}

/// The model fitted to the rows of a mask.
#[must_use]
pub fn fit(start: &Simulated, drive: &Drive, record: &Record, mask: &dyn Fn(usize) -> bool) -> Simulated {
    let entries = start.entries();
    let values = start.values();
    let at = DVector::from_iterator(values.len(), values.iter().zip(&entries).map(|(value, entry)| value / entry.scale));
    let inside = |row: &usize| mask(*row) && !record.interpolated[*row];
    let rows: Vec<usize> = (SETTLING_ROWS..record.len()).step_by(STRIDE).filter(inside).collect();
    let scale = super::position_rms(&simulate(start, drive, record), record, mask).max(f64::MIN_POSITIVE);
    let problem = Problem { start, drive, record, rows, entries, scale, at };
    let solver = LevenbergMarquardt::new().with_ftol(1.0e-4).with_xtol(1.0e-5).with_gtol(1.0e-6);
    let (problem, _) = solver.with_stepbound(1.0).with_patience(PATIENCE).minimize(problem);
    problem.model(&problem.at)
}
