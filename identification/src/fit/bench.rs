//! A model on a record: low-passed columns, fit, prediction.
//!
//! The inverse model is `u = h(Σ θ · column)`, seen `delay` later, where h is the actuator: `q / (1
//! − k |q|)` undoes a delivered effort of `u / (1 + k |u|)`. With k = 0 the fit is linear;
//! otherwise it is linearised about an earlier fit (Gauss–Newton), so that blocks and
//! cross-validation stay those of a linear fit. The saturation is put on the prediction, never on
//! the recorded effort: noise in a regressor would look like an effect.

use std::cell::RefCell;
use std::collections::HashMap;
use std::rc::Rc;

use crate::fit::blocks::{Blocks, Fit};
use crate::model::effects::Effect;
use crate::motion::kinematics::Kinematics;
use crate::record::dataset::Dataset;

/// An effect with its nonlinear parameter.
#[derive(Clone, Copy)]
pub(crate) struct Term {
    /// Which effect.
    pub effect: &'static dyn Effect,
    /// Its nonlinear parameter.
    pub parameter: f64,
}

/// Actuator whose delivered effort falls behind.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Saturation {
    /// k of `u / (1 + k |u|)`, one over the unit of the effort.
    pub per_effort: f64,
    /// Coefficients about which the fit is linearised.
    pub about: Vec<f64>,
}

/// The largest k·|q| that is followed; beyond it the inverse runs away.
const LARGEST_LOSS: f64 = 0.8;

impl Saturation {
    /// Commanded effort for a wanted one.
    #[must_use]
    pub(crate) fn commanded(&self, wanted: f64) -> f64 {
        wanted / (1.0 - (self.per_effort * wanted.abs()).min(LARGEST_LOSS))
    }

    /// Delivered effort for a commanded one.
    #[must_use]
    pub(crate) fn delivered(&self, commanded: f64) -> f64 {
        commanded / (1.0 + self.per_effort * commanded.abs())
    }

    fn slope(&self, wanted: f64) -> f64 {
        1.0 / (1.0 - (self.per_effort * wanted.abs()).min(LARGEST_LOSS)).powi(2)
    }
}

/// An inverse model: terms, delay and actuator.
#[derive(Clone, Default)]
pub(crate) struct Model {
    /// Terms; the declared ones first.
    pub terms: Vec<Term>,
    /// The recorded effort acts this much later than the record says, s.
    pub delay_s: f64,
    /// Actuator.
    pub saturation: Saturation,
}

impl Model {
    /// The model with another nonlinear parameter of a term.
    #[must_use]
    pub(crate) fn with_parameter(&self, at: usize, parameter: f64) -> Self {
        let mut model = self.clone();
        model.terms[at].parameter = parameter;
        model
    }

    /// Whether the actuator falls behind.
    #[must_use]
    pub(crate) fn saturates(&self) -> bool {
        self.saturation.per_effort != 0.0
    }

    /// Whether a term of this name is in it.
    #[must_use]
    pub(crate) fn has(&self, name: &str) -> bool {
        self.terms.iter().any(|term| term.effect.name() == name)
    }
}

/// Columns and target of a linear (or linearised) fit.
#[derive(Clone, Debug)]
pub(crate) struct Design {
    columns: Vec<Vec<f64>>,
    target: Vec<f64>,
    slope: Option<Vec<f64>>,
    shift_rows: f64,
}

/// Half widths of 95 % intervals.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct HalfWidths {
    /// Per coefficient.
    pub linear: Vec<f64>,
    /// Per term: of its nonlinear parameter, where it has one.
    pub parameters: Vec<Option<f64>>,
    /// Of the delay.
    pub delay_s: Option<f64>,
    /// Of the saturation.
    pub saturation: Option<f64>,
}

type Columns = Rc<Vec<Vec<f64>>>;

/// A record on which models are fitted; it keeps the low-passed columns of the terms that it has
/// seen last.
pub(crate) struct Bench<'a> {
    /// The axis.
    pub dataset: &'a Dataset,
    /// The motion.
    pub motion: &'a Kinematics,
    kept: RefCell<HashMap<(&'static str, u64), Columns>>,
}

/// Values that are kept before all are forgotten: 32 MB.
const KEPT_VALUES: usize = 4_000_000;

impl<'a> Bench<'a> {
    /// A bench for a record.
    #[must_use]
    pub(crate) fn new(dataset: &'a Dataset, motion: &'a Kinematics) -> Self {
        Self {
            dataset,
            motion,
            kept: RefCell::default(),
        }
    }

    fn low_passed(&self, term: &Term) -> Vec<Vec<f64>> {
        let raw = term
            .effect
            .columns(self.motion, self.dataset, term.parameter);
        raw.iter()
            .map(|column| self.motion.low_passed(column))
            .collect()
    }

    /// Low-passed columns of a term.
    fn columns(&self, term: &Term) -> Columns {
        let key = (term.effect.name(), term.parameter.to_bits());
        if let Some(known) = self.kept.borrow().get(&key) {
            return Rc::clone(known);
        }
        let columns: Columns = Rc::new(self.low_passed(term));
        let mut kept = self.kept.borrow_mut();
        let values: usize = kept
            .values()
            .map(|columns| columns.len() * self.motion.len())
            .sum();
        if values > KEPT_VALUES {
            kept.clear();
        }
        kept.insert(key, Rc::clone(&columns));
        columns
    }

    /// Columns and target of a model.
    #[must_use]
    pub(crate) fn design(&self, model: &Model) -> Design {
        let shift_rows = model.delay_s / self.motion.period_s;
        let mut columns = Vec::new();
        for term in &model.terms {
            columns.extend(
                self.columns(term)
                    .iter()
                    .map(|column| shifted(column, shift_rows)),
            );
        }
        let target = self.motion.effort_lp.clone();
        let linear = Design {
            columns,
            target,
            slope: None,
            shift_rows,
        };
        if model.saturation.per_effort == 0.0 {
            linear
        } else {
            linear.about(&model.saturation)
        }
    }

    /// A design with one more term.
    #[must_use]
    pub(crate) fn extended(&self, design: &Design, term: &Term) -> Design {
        Self::with_columns(design, &self.columns(term))
    }

    /// The same for a term that will not be asked for again: nothing is kept.
    #[must_use]
    pub(crate) fn extended_once(&self, design: &Design, term: &Term) -> Design {
        Self::with_columns(design, &self.low_passed(term))
    }

    fn with_columns(design: &Design, columns: &[Vec<f64>]) -> Design {
        let mut design = design.clone();
        for column in columns {
            let mut column = shifted(column, design.shift_rows);
            if let Some(slope) = &design.slope {
                column
                    .iter_mut()
                    .zip(slope)
                    .for_each(|(value, slope)| *value *= slope);
            }
            design.columns.push(column);
        }
        design
    }

    /// Gram matrices of a design over the samples that are fitted.
    #[must_use]
    pub(crate) fn blocks(&self, design: &Design) -> Blocks {
        let columns: Vec<&[f64]> = design.columns.iter().map(Vec::as_slice).collect();
        Blocks::new(
            &columns,
            &design.target,
            &self.motion.fitted,
            self.motion.period_s,
        )
    }

    /// Fit of a model with its held-out errors.
    #[must_use]
    pub(crate) fn fit(&self, model: &Model) -> Fit {
        self.blocks(&self.design(model)).cross_validate()
    }

    /// Half widths of 95 % intervals of everything that was fitted: the columns' own and,
    /// linearised, the nonlinear parameters.
    #[must_use]
    pub(crate) fn half_widths(&self, model: &Model, coefficients: &[f64]) -> HalfWidths {
        let mut design = self.design(model);
        let columns = design.columns.len();
        let mut slope = |step: f64, moved: &dyn Fn(f64) -> Model| {
            let [up, down] = [step, -step].map(|step| self.predict_lp(&moved(step), coefficients));
            design.columns.push(
                up.iter()
                    .zip(&down)
                    .map(|(up, down)| (up - down) / (2.0 * step))
                    .collect(),
            );
        };
        let tuned: Vec<usize> = (0..model.terms.len())
            .filter(|at| model.terms[*at].effect.is_tuned())
            .collect();
        for at in &tuned {
            let parameter = model.terms[*at].parameter;
            slope(1.0e-4 * parameter, &|step| {
                model.with_parameter(*at, parameter + step)
            });
        }
        if model.delay_s != 0.0 {
            slope(1.0e-5, &|step| Model {
                delay_s: model.delay_s + step,
                ..model.clone()
            });
        }
        let Saturation { per_effort, about } = &model.saturation;
        if model.saturates() {
            let moved = |step: f64| Saturation {
                per_effort: per_effort + step,
                about: about.clone(),
            };
            slope(1.0e-3 * per_effort, &|step| Model {
                saturation: moved(step),
                ..model.clone()
            });
        }
        let all = self.blocks(&design).half_widths();
        let (linear, rest) = all.split_at(columns);
        let mut rest = rest.iter().copied();
        let mut parameters = vec![None; model.terms.len()];
        for at in tuned {
            parameters[at] = rest.next();
        }
        let delay_s = if model.delay_s == 0.0 {
            None
        } else {
            rest.next()
        };
        let saturation = if model.saturates() { rest.next() } else { None };
        HalfWidths {
            linear: linear.to_vec(),
            parameters,
            delay_s,
            saturation,
        }
    }

    /// Sum of squares that a model leaves in the sample.
    #[must_use]
    pub(crate) fn sse(&self, model: &Model) -> f64 {
        self.blocks(&self.design(model)).fit().sse
    }

    /// Prediction in the low-passed domain.
    #[must_use]
    pub(crate) fn predict_lp(&self, model: &Model, coefficients: &[f64]) -> Vec<f64> {
        let linear = Model {
            saturation: Saturation::default(),
            ..model.clone()
        };
        let wanted = weighted(
            &self.design(&linear).columns,
            coefficients,
            self.motion.len(),
        );
        wanted
            .into_iter()
            .map(|q| model.saturation.commanded(q))
            .collect()
    }

    /// What the motor gives to the load side, but for its own mass: the delivered effort without
    /// what acts on the motor itself (ripple); low-passed.
    #[must_use]
    pub(crate) fn transmitted(&self, model: &Model, coefficients: &[f64]) -> Vec<f64> {
        let commanded = shifted(
            &self.motion.effort_lp,
            -model.delay_s / self.motion.period_s,
        );
        let mut transmitted: Vec<f64> = commanded
            .into_iter()
            .map(|u| model.saturation.delivered(u))
            .collect();
        let mut rest = coefficients.iter();
        for term in &model.terms {
            for column in self.columns(term).iter() {
                let coefficient = rest.next().copied().unwrap_or(0.0);
                if term.effect.acts_on_motor() {
                    transmitted
                        .iter_mut()
                        .zip(column)
                        .for_each(|(sum, value)| *sum -= coefficient * value);
                }
            }
        }
        transmitted
    }

    /// Prediction that is not low-passed.
    #[must_use]
    pub(crate) fn predict(&self, model: &Model, coefficients: &[f64]) -> Vec<f64> {
        let raw = model.terms.iter().flat_map(|term| {
            term.effect
                .columns(self.motion, self.dataset, term.parameter)
        });
        let shift_rows = model.delay_s / self.motion.period_s;
        let columns: Vec<Vec<f64>> = raw.map(|column| shifted(&column, shift_rows)).collect();
        let wanted = weighted(&columns, coefficients, self.motion.len());
        wanted
            .into_iter()
            .map(|q| model.saturation.commanded(q))
            .collect()
    }

    /// Residual in the low-passed domain.
    #[must_use]
    pub(crate) fn residual(&self, model: &Model, coefficients: &[f64]) -> Vec<f64> {
        let predicted = self.predict_lp(model, coefficients);
        self.motion
            .effort_lp
            .iter()
            .zip(predicted)
            .map(|(effort, predicted)| effort - predicted)
            .collect()
    }

    /// Force error over moving samples, percent.
    #[must_use]
    pub(crate) fn force_error_percent(&self, model: &Model, coefficients: &[f64]) -> f64 {
        let residual = self.residual(model, coefficients);
        let norm = |values: &[f64]| {
            let moving = values
                .iter()
                .zip(&self.motion.moving)
                .filter(|(_, moving)| **moving);
            moving.map(|(value, _)| value * value).sum::<f64>().sqrt()
        };
        100.0 * norm(&residual) / norm(&self.motion.effort_lp).max(f64::MIN_POSITIVE)
    }
}

impl Design {
    /// The design of a saturating actuator, linearised: `u − h(q0) + h'(q0) q0 = h'(q0) q`.
    fn about(mut self, saturation: &Saturation) -> Self {
        let wanted = weighted(&self.columns, &saturation.about, self.target.len());
        let slope: Vec<f64> = wanted.iter().map(|q| saturation.slope(*q)).collect();
        for ((target, q), slope) in self.target.iter_mut().zip(&wanted).zip(&slope) {
            *target += slope * q - saturation.commanded(*q);
        }
        for column in &mut self.columns {
            column
                .iter_mut()
                .zip(&slope)
                .for_each(|(value, slope)| *value *= slope);
        }
        Self {
            slope: Some(slope),
            ..self
        }
    }
}

fn weighted(columns: &[Vec<f64>], coefficients: &[f64], rows: usize) -> Vec<f64> {
    let mut sum = vec![0.0; rows];
    for (column, coefficient) in columns.iter().zip(coefficients) {
        sum.iter_mut()
            .zip(column)
            .for_each(|(sum, value)| *sum += coefficient * value);
    }
    sum
}

/// A band-limited signal seen `by` samples later; cubic Lagrange interpolation.
fn shifted(column: &[f64], by: f64) -> Vec<f64> {
    if by == 0.0 || column.len() < 4 {
        return column.to_vec();
    }
    let last = column.len() - 3;
    (0..column.len())
        .map(|row| {
            let at = (row as f64 + by).clamp(1.0, last as f64);
            let base = (at.floor() as usize).clamp(1, last);
            let u = at - base as f64;
            let [a, b, c, d] = [
                column[base - 1],
                column[base],
                column[base + 1],
                column[base + 2],
            ];
            a * (-u * (u - 1.0) * (u - 2.0) / 6.0)
                + b * ((u + 1.0) * (u - 1.0) * (u - 2.0) / 2.0)
                + c * (-(u + 1.0) * u * (u - 2.0) / 2.0)
                + d * ((u + 1.0) * u * (u - 1.0) / 6.0)
        })
        .collect()
}
