//! Output-error fit: the parameters whose simulation stays nearest to the recorded positions.
//!
//! Parameters start from the inverse model and are moved by Levenberg–Marquardt: the least of
//! `Σ ((q_sim − q_rec)/s)²` over every fifth settled row, where s is what the start leaves (rms).
//! The Jacobian is numerical: forward differences, central ones where the cost is jagged.
//! Intervals: a jackknife over blocks of the record, one Gauss–Newton step each.

use std::sync::OnceLock;

use levenberg_marquardt::{LeastSquaresProblem, LevenbergMarquardt};
use nalgebra::storage::Owned;
use nalgebra::{DMatrix, DVector, Dyn};

use crate::fit::blocks::Blocks;
use crate::fit::side_by_side::side_by_side;
use crate::record::samples::Record;
use crate::simulate::drive::Drive;
use crate::simulate::model::Simulated;
use crate::simulate::parameters::Parameter;
use crate::simulate::run::{SETTLING_ROWS, error_along, simulate};

/// Of five rows one is compared: positions are smooth.
const STRIDE: usize = 5;
/// Simulations that a fit may use, as a multiple of the number of parameters.
const PATIENCE: usize = 12;
/// Relative changes below which a fit ends: of the cost, of the parameters, of the gradient. The
/// numerical Jacobian is not better than these.
const COST_TOLERANCE: f64 = 1.0e-4;
/// Of the cost, for a fit that only comes near.
const NEAR_COST_TOLERANCE: f64 = 3.0e-3;
const PARAMETER_TOLERANCE: f64 = 1.0e-5;
const GRADIENT_TOLERANCE: f64 = 1.0e-6;
/// A simulation that leaves the numbers is this far off in every row.
const RUN_AWAY: f64 = 1.0e6;

/// A record, and who drives the simulation along it.
#[derive(Clone, Copy)]
pub(crate) struct Course<'a> {
    /// Who drives.
    pub drive: &'a Drive,
    /// The record.
    pub record: &'a Record,
}

/// A model to be fitted to a record.
struct Problem<'a> {
    start: &'a Simulated,
    course: Course<'a>,
    /// The rows that are compared.
    rows: Vec<usize>,
    parameters: Vec<Parameter>,
    /// Unit of the error.
    scale: f64,
    /// Parameters as multiples of their scales.
    at: DVector<f64>,
    /// The errors there, once they were asked for.
    left: OnceLock<DVector<f64>>,
}

impl<'a> Problem<'a> {
    fn new(start: &'a Simulated, course: Course<'a>, rows: Vec<usize>, scale: f64) -> Self {
        Self::moving(start.parameters(), start, course, (rows, scale))
    }

    /// A problem in which only some of the parameters move.
    fn moving(
        parameters: Vec<Parameter>,
        start: &'a Simulated,
        course: Course<'a>,
        (rows, scale): (Vec<usize>, f64),
    ) -> Self {
        let at = parameters.iter().map(Parameter::scaled);
        Self {
            start,
            course,
            rows,
            at: DVector::from_iterator(parameters.len(), at),
            parameters,
            scale,
            left: OnceLock::new(),
        }
    }

    fn model(&self, at: &DVector<f64>) -> Simulated {
        let pairs = self.parameters.iter().zip(at);
        let moved: Vec<Parameter> = pairs.map(|(row, at)| row.at(*at)).collect();
        self.start.with(&moved)
    }

    fn residual_at(&self, at: &DVector<f64>) -> DVector<f64> {
        let Course { drive, record } = self.course;
        let run = simulate(&self.model(at), drive, record);
        let error = |row: &usize| {
            let error = (run.motor[*row] - record.position[*row]) / self.scale;
            if error.is_finite() { error } else { RUN_AWAY }
        };
        DVector::from_iterator(self.rows.len(), self.rows.iter().map(error))
    }

    /// The errors where the parameters stand.
    fn left(&self) -> &DVector<f64> {
        self.left.get_or_init(|| self.residual_at(&self.at))
    }

    /// Forward differences, central ones where the cost is jagged; parameters side by side.
    fn slopes(&self) -> DMatrix<f64> {
        let here = self.left();
        let places: Vec<usize> = (0..self.parameters.len()).collect();
        let columns = side_by_side(&places, |place| self.slope(*place, here));
        DMatrix::from_columns(&columns)
    }

    fn slope(&self, place: usize, here: &DVector<f64>) -> DVector<f64> {
        let parameter = &self.parameters[place];
        let moved = |step: f64| {
            let mut at = self.at.clone();
            at[place] += step;
            self.residual_at(&at)
        };
        let step = parameter.step;
        if parameter.is_jagged() {
            (moved(step) - moved(-step)) / (2.0 * step)
        } else {
            (moved(step) - here) / step
        }
    }
}

impl LeastSquaresProblem<f64, Dyn, Dyn> for Problem<'_> {
    type ParameterStorage = Owned<f64, Dyn>;
    type ResidualStorage = Owned<f64, Dyn>;
    type JacobianStorage = Owned<f64, Dyn, Dyn>;

    fn set_params(&mut self, at: &DVector<f64>) {
        self.at.copy_from(at);
        self.left.take();
    }

    fn params(&self) -> DVector<f64> {
        self.at.clone()
    }

    fn residuals(&self) -> Option<DVector<f64>> {
        Some(self.left().clone())
    }

    fn jacobian(&self) -> Option<DMatrix<f64>> {
        Some(self.slopes())
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
    let course = Course { drive, record };
    fit_within(start, start.parameters(), course, mask, COST_TOLERANCE)
}

/// The same of the parameters that are known least, ended where it goes on slowly: a start for
/// another fit.
#[must_use]
pub(crate) fn near(
    start: &Simulated,
    drive: &Drive,
    record: &Record,
    mask: &dyn Fn(usize) -> bool,
) -> Simulated {
    let (parameters, course) = (start.core_parameters(), Course { drive, record });
    fit_within(start, parameters, course, mask, NEAR_COST_TOLERANCE)
}

fn fit_within(
    start: &Simulated,
    parameters: Vec<Parameter>,
    course: Course<'_>,
    mask: &dyn Fn(usize) -> bool,
    cost_tolerance: f64,
) -> Simulated {
    let Course { drive, record } = course;
    let settled = record.settled(SETTLING_ROWS).step_by(STRIDE);
    let inside = |row: &usize| mask(*row) && !record.interpolated[*row];
    let rows = settled.filter(inside).collect();
    let left = error_along(start, drive, record, mask);
    let scale = left.max(f64::MIN_POSITIVE);
    let problem = Problem::moving(parameters, start, course, (rows, scale));
    let (problem, _) = LevenbergMarquardt::new()
        .with_ftol(cost_tolerance)
        .with_xtol(PARAMETER_TOLERANCE)
        .with_gtol(GRADIENT_TOLERANCE)
        .with_stepbound(1.0)
        .with_patience(PATIENCE)
        .minimize(problem);
    problem.model(&problem.at)
}

/// Half widths of 95 % intervals of a fitted model's parameters, in the order of their table:
/// jackknife over blocks.
#[must_use]
pub(crate) fn half_widths(model: &Simulated, drive: &Drive, record: &Record) -> Vec<f64> {
    let rows = record.settled(SETTLING_ROWS).step_by(STRIDE).collect();
    let problem = Problem::new(model, Course { drive, record }, rows, 1.0);
    let (residual, jacobian) = (problem.left(), problem.slopes());
    let columns: Vec<Vec<f64>> = jacobian
        .column_iter()
        .map(|column| column.iter().copied().collect())
        .collect();
    let views: Vec<&[f64]> = columns.iter().map(Vec::as_slice).collect();
    let period_s = record.period_s * STRIDE as f64;
    let all = vec![true; residual.len()];
    let blocks = Blocks::new(&views, residual.as_slice(), &all, period_s);
    let halves = blocks.half_widths().into_iter();
    halves
        .zip(&problem.parameters)
        .map(|(half, parameter)| half * parameter.scale)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::dataset::Dataset;
    use crate::record::form::ControllerForm;
    use crate::simulate::axis::{Gap, Shape};
    use crate::simulate::controller::known::Controller;
    use crate::simulate::made;
    use axis_model::EffectName::{Coulomb, Inertia, Offset, Viscous};

    /// A law on a load that was not recorded: believed, not checked.
    fn controller() -> ControllerForm {
        ControllerForm {
            position_gain_per_s: Some(40.0),
            velocity_gain_n_s_per_m: Some(14_000.0),
            acceleration_feedforward_kg: Some(80.0),
            position_sensor: Some("load".into()),
            ..ControllerForm::default()
        }
    }

    /// A rigid axis along two sines.
    fn dataset(rows: u32) -> Dataset {
        let path = made::two_sines(rows);
        let record = Record {
            reference: Some(path.clone()),
            ..made::record(1.0e-3, path)
        };
        made::dataset(record, Some(controller()))
    }

    fn model(dataset: &Dataset, coefficients: [f64; 4]) -> Simulated {
        let [mass, viscous, coulomb, offset] = coefficients;
        let fitted = made::fitted(&[
            (Inertia, 0.0, &[mass]),
            (Viscous, 0.0, &[viscous]),
            (Coulomb, 0.0, &[coulomb]),
            (Offset, 0.0, &[offset]),
        ]);
        Simulated::new(dataset, 1.0e-3, &fitted, Shape::default()).unwrap()
    }

    fn values(model: &Simulated) -> Vec<f64> {
        model.parameters().iter().map(|row| row.value).collect()
    }

    const TRUTH: [f64; 4] = [90.0, 200.0, 25.0, -4.0];
    const AWAY: [f64; 4] = [80.0, 250.0, 20.0, 0.0];

    /// A record of the true model.
    fn recorded(rows: u32) -> (Dataset, Drive) {
        let mut dataset = dataset(rows);
        let drive = Drive::of(Controller::of(&dataset));
        assert!(matches!(drive, Drive::Known(_)));
        dataset.train.position = simulate(&model(&dataset, TRUTH), &drive, &dataset.train).motor;
        (dataset, drive)
    }

    #[test]
    fn the_parameters_that_made_a_record_come_back() {
        let (dataset, drive) = recorded(6000);
        let fitted = fit(&model(&dataset, AWAY), &drive, &dataset.train, &|_| true);
        for (value, wanted) in values(&fitted).into_iter().zip(TRUTH) {
            assert!((value / wanted - 1.0).abs() < 0.01, "{value} {wanted}");
        }
        let widths = half_widths(&fitted, &drive, &dataset.train);
        let pairs = || widths.iter().zip(TRUTH);
        assert!(
            pairs().all(|(half, wanted)| *half < 0.05 * wanted.abs()),
            "{widths:?}"
        );
    }

    #[test]
    fn rows_outside_the_mask_and_in_holes_are_not_fitted() {
        let (mut dataset, drive) = recorded(3000);
        // Rows 2000 to 2199 are masked, 2500 to 2599 stand in a hole: both are 1 mm off.
        for row in (2000..2200).chain(2500..2600) {
            dataset.train.position[row] += 1.0e-3;
        }
        dataset.train.interpolated[2500..2600].fill(true);
        let mask = |row: usize| !(2000..2200).contains(&row);
        let fitted = fit(&model(&dataset, AWAY), &drive, &dataset.train, &mask);
        for (value, wanted) in values(&fitted).into_iter().zip(TRUTH) {
            assert!((value / wanted - 1.0).abs() < 0.01, "{value} {wanted}");
        }
    }

    #[test]
    fn half_widths_grow_with_what_a_model_does_not_explain_and_shrink_with_none() {
        let (mut dataset, drive) = recorded(4000);
        let truth = model(&dataset, TRUTH);
        let exact = half_widths(&truth, &drive, &dataset.train);
        assert!(exact.iter().all(|half| *half < 1.0e-9), "{exact:?}");
        let shake = |dataset: &mut Dataset, size: f64| {
            for (row, x) in dataset.train.position.iter_mut().enumerate() {
                *x += size * (0.7 * row as f64).sin();
            }
        };
        shake(&mut dataset, 1.0e-6);
        let one = half_widths(&truth, &drive, &dataset.train);
        shake(&mut dataset, 1.0e-6);
        let two = half_widths(&truth, &drive, &dataset.train);
        for (one, two) in one.iter().zip(two) {
            assert!(
                *one > 0.0 && (two / one - 2.0).abs() < 1.0e-3,
                "{one} {two}"
            );
        }
    }

    /// Half widths in multiples of the scale, where the record asks every block for another value
    /// of the parameter at a place: one step of 1e-4 more or less, by block.
    fn half_widths_of(place: usize, sign: impl Fn(usize) -> f64) -> Vec<f64> {
        // A period is a block: 60 rows of every fifth. All blocks weigh the same.
        let sine = |row: i32| 0.02 * (std::f64::consts::TAU * f64::from(row) / 300.0).sin();
        let path: Vec<f64> = (0..3300).map(sine).collect();
        let record = Record {
            reference: Some(path.clone()),
            ..made::record(1.0e-3, path)
        };
        let mut dataset = made::dataset(record, Some(controller()));
        let drive = Drive::of(Controller::of(&dataset));
        let truth = model(&dataset, TRUTH);
        let rows: Vec<usize> = dataset
            .train
            .settled(SETTLING_ROWS)
            .step_by(STRIDE)
            .collect();
        let slope = {
            let course = Course {
                drive: &drive,
                record: &dataset.train,
            };
            let problem = Problem::new(&truth, course, rows.clone(), 1.0);
            problem.slopes().column(place).into_owned()
        };
        dataset.train.position = simulate(&truth, &drive, &dataset.train).motor;
        for (at, row) in rows.into_iter().enumerate() {
            dataset.train.position[row] += 1.0e-4 * sign(at / 60) * slope[at];
        }
        let table = truth.parameters();
        let widths = half_widths(&truth, &drive, &dataset.train).into_iter();
        widths
            .zip(table)
            .map(|(half, row)| half / row.scale)
            .collect()
    }

    #[test]
    fn blocks_that_ask_for_the_same_parameter_leave_no_interval() {
        let widths = half_widths_of(0, |_| 1.0);
        assert!(widths.iter().all(|half| *half < 1.0e-7), "{widths:?}");
    }

    #[test]
    fn the_interval_is_what_the_jackknife_over_ten_blocks_gives_by_hand() {
        // Five blocks ask for one step more, five for one less. Without one of them the mean is
        // ∓1/9 of a step: 2.262·√(9/10 · 10/81) = 0.754 of it.
        for place in [0, 1] {
            let widths = half_widths_of(place, |block| if block % 2 == 0 { 1.0 } else { -1.0 });
            let steps = widths[place] / 1.0e-4;
            assert!((steps / 0.754 - 1.0).abs() < 0.05, "{place}: {steps}");
        }
    }

    #[test]
    fn the_error_is_simulated_less_recorded_in_units_of_the_scale() {
        let (mut dataset, drive) = recorded(400);
        dataset.train.position[310] -= 6.0e-6;
        let truth = model(&dataset, TRUTH);
        let course = Course {
            drive: &drive,
            record: &dataset.train,
        };
        let problem = Problem::new(&truth, course, vec![305, 310], 2.0e-6);
        let error = problem.residual_at(&problem.at);
        assert!(
            error[0].abs() < 1.0e-6 && (error[1] - 3.0).abs() < 1.0e-6,
            "{error}"
        );
        let mut nowhere = problem.at.clone();
        nowhere[3] = f64::NAN;
        assert_eq!(problem.residual_at(&nowhere).as_slice(), [1.0e6, 1.0e6]);
    }

    /// Rows, columns and steps of the Jacobian against central differences of a step.
    fn check_jacobian(problem: &Problem<'_>, step: impl Fn(usize) -> f64, within: f64) {
        let jacobian = problem.slopes();
        for place in 0..problem.parameters.len() {
            let moved = |step: f64| {
                let mut at = problem.at.clone();
                at[place] += step;
                problem.residual_at(&at)
            };
            let step = step(place);
            let central = (moved(step) - moved(-step)) / (2.0 * step);
            let error = (jacobian.column(place) - &central).norm() / central.norm();
            assert!(error < within, "parameter {place}: {error}");
        }
    }

    #[test]
    fn the_jacobian_agrees_with_central_differences() {
        let dataset = dataset(6000);
        let start = model(&dataset, TRUTH);
        let course = Course {
            drive: &Drive::Followed,
            record: &dataset.train,
        };
        let rows = (300..6000).step_by(50).collect();
        check_jacobian(&Problem::new(&start, course, rows, 1.0), |_| 1.0e-4, 0.05);
    }

    #[test]
    fn over_a_gap_the_jacobian_is_central_with_wide_steps() {
        let dataset = dataset(1000);
        let mut start = model(&dataset, TRUTH);
        start.mechanics.shape.gap = Some(Gap {
            width: 2.0e-5,
            load_share: 0.45,
            motor_friction: 0.3,
            restitution: 0.5,
        });
        let course = Course {
            drive: &Drive::Followed,
            record: &dataset.train,
        };
        let mut problem = Problem::new(&start, course, (300..1000).step_by(50).collect(), 1.0);
        problem.parameters.drain(..4);
        problem.at = problem.at.rows(4, 4).into_owned();
        check_jacobian(&problem, |_| 0.04, 1.0e-12);
    }
}
