//! Output-error fit: the parameters whose simulation stays nearest to the recorded positions.

use levenberg_marquardt::{LeastSquaresProblem, LevenbergMarquardt};
use nalgebra::storage::Owned;
use nalgebra::{DMatrix, DVector, Dyn};

use super::drive::Drive;
use super::model::{Entry, Simulated};
use super::run::{SETTLING_ROWS, simulate};
use crate::fit::blocks::Blocks;
use crate::fit::side_by_side::side_by_side;
use crate::record::samples::Record;

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
            .map(|(value, entry)| {
                entry.scale
                    * if entry.positive {
                        value.abs().max(1.0e-4)
                    } else {
                        *value
                    }
            })
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

    /// Forward differences, central ones where the cost is jagged; parameters side by side.
    fn jacobian_at(&self, at: &DVector<f64>) -> DMatrix<f64> {
        let here = self.residual_at(at);
        let places: Vec<usize> = (0..self.entries.len()).collect();
        let columns = side_by_side(&places, |place| self.slope_at(at, *place, &here));
        DMatrix::from_columns(&columns)
    }

    fn slope_at(&self, at: &DVector<f64>, place: usize, here: &DVector<f64>) -> DVector<f64> {
        let entry = &self.entries[place];
        let moved = |step: f64| {
            let mut at = at.clone();
            at[place] += step;
            self.residual_at(&at)
        };
        if entry.is_jagged() {
            (moved(entry.step) - moved(-entry.step)) / (2.0 * entry.step)
        } else {
            (moved(entry.step) - here) / entry.step
        }
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
pub(crate) fn fit(
    start: &Simulated,
    drive: &Drive,
    record: &Record,
    mask: &dyn Fn(usize) -> bool,
) -> Simulated {
    let entries = start.entries();
    let values = start.values();
    let at = DVector::from_iterator(
        values.len(),
        values
            .iter()
            .zip(&entries)
            .map(|(value, entry)| value / entry.scale),
    );
    let inside = |row: &usize| mask(*row) && !record.interpolated[*row];
    let rows: Vec<usize> = record
        .settled(SETTLING_ROWS)
        .step_by(STRIDE)
        .filter(inside)
        .collect();
    let scale = super::run::position_rms(&simulate(start, drive, record), record, mask)
        .max(f64::MIN_POSITIVE);
    let problem = Problem {
        start,
        drive,
        record,
        rows,
        entries,
        scale,
        at,
    };
    let solver = LevenbergMarquardt::new()
        .with_ftol(1.0e-4)
        .with_xtol(1.0e-5)
        .with_gtol(1.0e-6);
    let (problem, _) = solver
        .with_stepbound(1.0)
        .with_patience(PATIENCE)
        .minimize(problem);
    problem.model(&problem.at)
}

/// Half widths of 95 % intervals of a fitted model's parameters: jackknife over blocks, one
/// Gauss–Newton step each.
#[must_use]
pub(crate) fn half_widths(model: &Simulated, drive: &Drive, record: &Record) -> Vec<f64> {
    let entries = model.entries();
    let values = model.values();
    let scaled = values
        .iter()
        .zip(&entries)
        .map(|(value, entry)| value / entry.scale);
    let at = DVector::from_iterator(values.len(), scaled);
    let rows: Vec<usize> = record.settled(SETTLING_ROWS).step_by(STRIDE).collect();
    let problem = Problem {
        start: model,
        drive,
        record,
        rows,
        entries,
        scale: 1.0,
        at,
    };
    let (residual, jacobian) = (
        problem.residual_at(&problem.at),
        problem.jacobian_at(&problem.at),
    );
    let columns: Vec<Vec<f64>> = jacobian
        .column_iter()
        .map(|column| column.iter().copied().collect())
        .collect();
    let views: Vec<&[f64]> = columns.iter().map(Vec::as_slice).collect();
    let period_s = record.period_s * STRIDE as f64;
    let blocks = Blocks::new(
        &views,
        residual.as_slice(),
        &vec![true; residual.len()],
        period_s,
    );
    blocks
        .half_widths()
        .iter()
        .zip(&problem.entries)
        .map(|(half, entry)| half * entry.scale)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::fitted::Fitted;
    use crate::model::inverse::{Model, Part};
    use crate::record::dataset::Dataset;
    use crate::record::units::{AxisKind, Effort, EffortHold};
    use crate::simulate::axis::Shape;
    use axis_model::EffectName;

    /// A law on a load that was not recorded: believed, not checked.
    fn controller() -> crate::record::form::ControllerForm {
        crate::record::form::ControllerForm {
            position_gain_per_s: Some(40.0),
            velocity_gain_n_s_per_m: Some(14_000.0),
            acceleration_feedforward_kg: Some(80.0),
            position_sensor: Some("load".into()),
            ..Default::default()
        }
    }

    /// A rigid axis along two sines.
    fn dataset() -> Dataset {
        let period_s = 1.0e-3;
        let path = |t: f64| 0.02 * (3.0 * t).sin() + 0.004 * (11.0 * t).sin();
        let time_s: Vec<f64> = (0..6000).map(|row| period_s * f64::from(row)).collect();
        let record = Record {
            period_s,
            position: time_s.iter().map(|t| path(*t)).collect(),
            load: None,
            reference: Some(time_s.iter().map(|t| path(*t)).collect()),
            effort: vec![0.0; time_s.len()],
            rows: Vec::new(),
            jittered: false,
            joints: Vec::new(),
            interpolated: vec![false; time_s.len()],
            time_s,
        };
        Dataset {
            name: "made".into(),
            kind: AxisKind::Linear,
            effort: Effort::Force,
            hold: EffortHold::ZeroOrder,
            effort_lag_s: 0.0,
            lead_m_per_rev: None,
            resolution: 1.0e-9,
            load_resolution: 0.0,
            effort_limit: None,
            controller: Some(controller()),
            declared: Vec::new(),
            train: record.clone(),
            validate: record,
            held_back: false,
            notes: Vec::new(),
        }
    }

    fn model(dataset: &Dataset, coefficients: [f64; 4]) -> Simulated {
        let names = [
            EffectName::Inertia,
            EffectName::Viscous,
            EffectName::Coulomb,
            EffectName::Offset,
        ];
        let parts =
            names.map(|name| Part::declared(crate::model::effects::find(name).unwrap(), 0.0));
        let model = Model {
            parts: parts.to_vec(),
        };
        let fitted = Fitted::new(model, &coefficients);
        Simulated::new(dataset, 1.0e-3, &fitted, Shape::default()).unwrap()
    }

    #[test]
    fn the_parameters_that_made_a_record_come_back() {
        let mut dataset = dataset();
        let drive = Drive::of(&dataset);
        assert!(matches!(drive, Drive::Known(_)));
        let truth = [90.0, 200.0, 25.0, -4.0];
        dataset.train.position = simulate(&model(&dataset, truth), &drive, &dataset.train).motor;
        let fitted = fit(
            &model(&dataset, [80.0, 250.0, 20.0, 0.0]),
            &drive,
            &dataset.train,
            &|_| true,
        );
        for (value, wanted) in fitted.values().into_iter().zip(truth) {
            assert!((value / wanted - 1.0).abs() < 0.01, "{value} {wanted}");
        }
        let widths = half_widths(&fitted, &drive, &dataset.train);
        assert!(
            widths
                .iter()
                .zip(truth)
                .all(|(half, wanted)| *half < 0.05 * wanted.abs()),
            "{widths:?}"
        );
    }

    #[test]
    fn the_jacobian_agrees_with_central_differences() {
        let dataset = dataset();
        let start = model(&dataset, [90.0, 200.0, 25.0, -4.0]);
        let entries = start.entries();
        let at = DVector::from_iterator(
            4,
            start
                .values()
                .iter()
                .zip(&entries)
                .map(|(v, e)| v / e.scale),
        );
        let rows = (300..6000).step_by(50).collect();
        let (drive, record) = (Drive::Followed, &dataset.train);
        let problem = Problem {
            start: &start,
            drive: &drive,
            record,
            rows,
            entries,
            scale: 1.0,
            at,
        };
        let forward = problem.jacobian_at(&problem.at);
        for place in 0..4 {
            let moved = |step: f64| {
                let mut at = problem.at.clone();
                at[place] += step;
                problem.residual_at(&at)
            };
            let central = (moved(1.0e-4) - moved(-1.0e-4)) / 2.0e-4;
            let error = (forward.column(place) - &central).norm() / central.norm();
            assert!(error < 0.05, "parameter {place}: {error}");
        }
    }
}
