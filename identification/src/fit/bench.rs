//! A model on a record: low-passed columns, fit, prediction.
//!
//! The inverse model is `u = h(Σ θ · column)`, seen `delay` later, where h is the actuator
//! ([`crate::model::inverse`]). With an ideal actuator the fit is linear. Otherwise it is
//! linearised about an earlier fit (Gauss–Newton), so that blocks and cross-validation stay those
//! of a linear fit.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use crate::fit::blocks::{Blocks, Fit};
use crate::fit::fitted::{Estimate, Fitted, Searched, Term};
use crate::fit::rows::Rows;
use crate::fit::span::Span;
use crate::model::effects::by_motion::{Others, place_among_usual};
use crate::model::effects::torque_saturation::Saturation;
use crate::model::effects::{Effect, Instant, Stage};
use crate::model::inverse::{Beside, Model, Part, saturation};
use crate::model::name::Called;
use crate::motion::bodies::add;
use crate::motion::filter::fit_cutoff_hz;
use crate::motion::kinematics::Kinematics;
use crate::motion::shift::{all_shifted, shifted};
use crate::record::dataset::Dataset;

/// Columns and target of a linear (or linearised) fit.
#[derive(Clone, Debug)]
pub(crate) struct Design {
    columns: Vec<Vec<f64>>,
    target: Vec<f64>,
    slope: Option<Vec<f64>>,
    shift_rows: f64,
}

/// A model's rows, beside which parts are tried.
pub(crate) struct Gathered {
    rows: Rows,
    slope: Option<Vec<f64>>,
    shift_rows: f64,
}

type Columns = Arc<Vec<Vec<f64>>>;
/// Effect; nonlinear parameter, form and lag; number of columns.
type Structure = (Called, [u64; 4], usize);
/// A structure, and those beside which it is with their coefficients.
type Key = (Structure, Vec<(Structure, Vec<u64>)>);
type Kept = HashMap<Key, Columns>;

/// A record on which models are fitted; it keeps the low-passed columns of the terms that it has
/// seen last.
pub(crate) struct Bench<'a> {
    /// The axis.
    pub dataset: &'a Dataset,
    /// The motion.
    pub motion: &'a Kinematics,
    kept: Mutex<Kept>,
}

/// Low-passed columns are fitted on so many rows a period of the cut-off: what the low-pass leaves
/// beyond half of that is nothing. Half as many would do for a fit, but not for the search of a
/// time: its error has small valleys then.
const ROWS_A_PERIOD: f64 = 10.0;
/// So many coefficients of one part are a curve.
const FEWEST_OF_A_CURVE: usize = 4;
/// Coefficients of another day are known to within this share of themselves.
const ANOTHER_DAY: f64 = 1.0;
/// Values that are kept before all are forgotten: 32 MB.
const KEPT_VALUES: usize = 4_000_000;

impl<'a> Bench<'a> {
    /// A bench for a record.
    #[must_use]
    pub(crate) fn new(dataset: &'a Dataset, motion: &'a Kinematics) -> Self {
        Self {
            dataset,
            motion,
            kept: Mutex::default(),
        }
    }

    /// Raw columns of a part.
    #[must_use]
    pub(crate) fn raw(&self, part: &Part) -> Vec<Vec<f64>> {
        let (motion, dataset) = (self.motion, self.dataset);
        let others = self.others(part);
        part.effect
            .columns_beside(motion, dataset, part.parameter, &others)
    }

    /// What the parts of an earlier fit did.
    fn others(&self, of: &Part) -> Others {
        let mut others = Others {
            drive: saturation(of.beside.iter().map(|one| &one.part)),
            ..Others::default()
        };
        let itself = |beside: &&Beside| beside.part.called() == of.called();
        let acts = |one: &&Beside| one.part.effect.stage() == Stage::Force;
        let forces = of.beside.iter().filter(acts);
        let parts: Vec<&Beside> = forces.filter(|one| !itself(one)).collect();
        if let Some(itself) = of.beside.iter().find(itself) {
            others.ratio = itself.own[0];
        }
        if parts
            .iter()
            .any(|beside| place_among_usual(beside.part.called()).is_none())
        {
            let none = || vec![0.0; self.motion.len()];
            (others.load, others.motor, others.level) = (none(), none(), none());
        }
        for Beside { part, own } in parts {
            if let Some(place) = place_among_usual(part.called()) {
                others.usual.get_or_insert_default()[place] = own[0];
                continue;
            }
            let on_motor = part.effect.acts_on_motor();
            let sum = if on_motor {
                &mut others.motor
            } else {
                &mut others.load
            };
            add(sum, &self.raw(part), own);
            if !part.effect.comes_and_goes() {
                add(&mut others.level, &[self.level(part, own)], &[1.0]);
            }
        }
        others
    }

    /// Friction level of a part by rows, as a simulation has it.
    fn level(&self, part: &Part, own: &[f64]) -> Vec<f64> {
        let (middle, half) = self.dataset.travel();
        let duration_s = self.dataset.train.duration_s();
        let motion = self.motion;
        let fall = part.effect.fall();
        let left = fall.map(|fall| fall.along(motion, part.parameter));
        let level = |row: usize| {
            let (position, time_s) = (motion.position_lp[row], motion.time_s[row]);
            let at = Instant {
                position,
                scaled: (position - middle) / half,
                velocity: motion.velocity_lp[row],
                left: left.as_ref().map(|left| left[row]),
                time_s,
                time_share: time_s / duration_s,
                ..Instant::default()
            };
            part.effect.action(&at, part.parameter, own).level
        };
        (0..motion.len()).map(level).collect()
    }

    fn low_passed(&self, part: &Part) -> Vec<Vec<f64>> {
        self.motion.all_low_passed(&self.raw(part))
    }

    /// Low-passed columns of a part.
    fn columns(&self, part: &Part) -> Columns {
        let key = key(part);
        if let Some(known) = self.kept().get(&key) {
            return Arc::clone(known);
        }
        // The lock is free meanwhile: other candidates make theirs.
        let columns: Columns = Arc::new(self.low_passed(part));
        self.keep(key, Arc::clone(&columns));
        columns
    }

    fn keep(&self, key: Key, columns: Columns) {
        let mut kept = self.kept();
        let count: usize = kept.values().map(|columns| columns.len()).sum();
        if count * self.motion.len() > KEPT_VALUES {
            kept.clear();
        }
        kept.insert(key, columns);
    }

    fn kept(&self) -> MutexGuard<'_, Kept> {
        self.kept.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Rows by which the columns of a model are seen later.
    fn shift_rows(&self, model: &Model) -> f64 {
        model.delay_s() / self.motion.period_s
    }

    /// Columns and target of a model.
    #[must_use]
    pub(crate) fn design(&self, model: &Model) -> Design {
        let shift_rows = self.shift_rows(model);
        let (mut columns, mut about) = (Vec::new(), vec![0.0; self.motion.len()]);
        for part in &model.parts {
            let own = self.columns(part);
            let from = columns.len();
            columns.extend(all_shifted(&own, shift_rows));
            add(&mut about, &columns[from..], &part.about);
        }
        let linear = Design {
            columns,
            target: self.motion.effort_lp.clone(),
            slope: None,
            shift_rows,
        };
        let saturation = model.saturation();
        if saturation.is_ideal() {
            linear
        } else {
            linear.about(saturation, &about, &self.lost_at_peaks(model))
        }
    }

    /// What a saturating drive loses beyond what low-passed efforts show
    /// ([`Saturation::lost_at_peaks`]).
    fn lost_at_peaks(&self, model: &Model) -> Vec<f64> {
        let drive = model.saturation();
        let lost = Called::Structure("lost at peaks");
        let key = ((lost, [drive.per_effort.to_bits(), 0, 0, 0], 1), Vec::new());
        if let Some(known) = self.kept().get(&key) {
            return known[0].clone();
        }
        let lost = drive.lost_at_peaks(self.motion);
        self.keep(key, Arc::new(vec![lost.clone()]));
        lost
    }

    /// The rows of a model, for parts that are tried beside it.
    #[must_use]
    pub(crate) fn gathered(&self, model: &Model) -> Gathered {
        let design = self.design(model);
        Gathered {
            rows: self.rows(&design),
            slope: design.slope,
            shift_rows: design.shift_rows,
        }
    }

    /// Blocks of a model with one more part.
    #[must_use]
    pub(crate) fn beside(&self, model: &Gathered, part: &Part) -> Blocks {
        model.with(&self.columns(part))
    }

    /// The same for a part that will not be asked for again: nothing is kept.
    #[must_use]
    pub(crate) fn beside_once(&self, model: &Gathered, part: &Part) -> Blocks {
        model.with(&self.low_passed(part))
    }

    fn rows(&self, design: &Design) -> Rows {
        let columns: Vec<&[f64]> = design.columns.iter().map(Vec::as_slice).collect();
        self.thinned(&columns, &design.target, &self.motion.fitted)
    }

    /// The rows of low-passed columns and a target, as many as the low-pass leaves different.
    fn thinned(&self, columns: &[&[f64]], target: &[f64], mask: &[bool]) -> Rows {
        let Kinematics {
            period_s, filter, ..
        } = self.motion;
        let every = 1.0 / (ROWS_A_PERIOD * filter.cutoff_hz * period_s);
        Rows::thinned(columns, target, mask, (*period_s, every.max(1.0) as usize))
    }

    /// Gram matrices of a design over the samples that are fitted.
    fn blocks(&self, design: &Design) -> Blocks {
        Blocks::with(&self.rows(design), &[])
    }

    /// A model with the coefficients that leave least.
    #[must_use]
    pub(crate) fn fit(&self, model: &Model) -> Fitted {
        let coefficients = self.blocks(&self.design(model)).fit().coefficients;
        Fitted::new(model.clone(), &coefficients)
    }

    /// Errors of a model on blocks that were held out of its fit.
    #[must_use]
    pub(crate) fn cross_validate(&self, model: &Model) -> Fit {
        self.blocks(&self.design(model)).cross_validate()
    }

    /// Half width of the 95 % interval of what a model, fitted here, predicts on a bench; rms,
    /// percent of the effort there.
    #[must_use]
    pub(crate) fn uncertainty_on(&self, other: &Bench<'_>, model: &Model) -> f64 {
        let [own, others] = [self, other].map(|bench| bench.blocks(&bench.design(model)));
        own.uncertainty_on(&others)
    }

    /// Sum of squares that the structure of a fit leaves on each half of the blocks, with the
    /// coefficients that the other half gives it. A curve keeps its shape: it has more coefficients
    /// than half a record knows.
    #[must_use]
    pub(crate) fn left_on_halves(&self, fitted: &Fitted) -> f64 {
        let mut design = self.design(fitted.model());
        let known;
        (design.columns, known) = in_shapes(design.columns, fitted);
        let halves = self.blocks(&design).in_folds(2);
        halves.left_out_near(&known, ANOTHER_DAY, self.independent_samples())
    }

    /// Sum of squares of what the parts of a fit that a smaller model lacks would add here, as far
    /// as the smaller model cannot take their place.
    #[must_use]
    pub(crate) fn adds(&self, fitted: &Fitted, without: &Model) -> f64 {
        let own = self.besides(fitted, without);
        let span = Span::of(self.design(without).into_columns(), &self.motion.fitted);
        span.outside(&own).iter().map(|value| value * value).sum()
    }

    /// What the parts of a fit that a smaller model lacks do here.
    fn besides(&self, fitted: &Fitted, without: &Model) -> Vec<f64> {
        let mut own = vec![0.0; self.motion.len()];
        let known = |part: &Part| without.parts.iter().any(|other| other.is_same(part));
        for term in fitted.terms().filter(|term| !known(term.part)) {
            add(&mut own, &self.columns(term.part), term.own);
        }
        own
    }

    /// Errors on held-out blocks of a fit that may move, linearised, the nonlinear parameter and
    /// what else of a part is searched.
    #[must_use]
    pub(crate) fn cross_validate_about(
        &self,
        fitted: &Fitted,
        place: usize,
        other: Searched,
    ) -> Fit {
        let searched = [Searched::Parameter, other].map(|what| (place, what));
        self.blocks(&self.design_about(fitted, &searched))
            .cross_validate()
    }

    /// Columns and target of a fitted model with its slopes by what was searched.
    fn design_about(&self, fitted: &Fitted, searched: &[(usize, Searched)]) -> Design {
        let slope = |(place, what): &(usize, Searched)| match what {
            Searched::Parameter => self.derivative(fitted, *place),
            Searched::Form | Searched::Lag => self.derivative_by(fitted, *place, *what),
        };
        let mut design = self.design(fitted.model());
        design.columns.extend(searched.iter().map(slope));
        design
    }

    /// How far the nonlinear parameters of parts, by their places, have to go to leave the least,
    /// linearised about a fit: all of them and the coefficients together (Gauss and Newton).
    #[must_use]
    pub(crate) fn step_about(&self, fitted: &Fitted, places: &[usize]) -> Vec<f64> {
        let searched: Vec<_> = places
            .iter()
            .map(|place| (*place, Searched::Parameter))
            .collect();
        let design = self.design_about(fitted, &searched);
        let mut coefficients = self.blocks(&design).fit().coefficients;
        coefficients.split_off(design.columns.len() - places.len())
    }

    /// Everything that was fitted with half widths of 95 % intervals: the columns' own and,
    /// linearised, the nonlinear parameters, and the forms that are not the usual ones. What was
    /// searched elsewhere (a delay, at the lower cut-off) is as uncertain besides as the least lies
    /// away here, and the coefficients beside it are.
    #[must_use]
    pub(crate) fn estimates(&self, fitted: &Fitted) -> Vec<Estimate> {
        let model = fitted.model();
        let of_part = |place: usize| {
            let part = &model.parts[place];
            let parameter = part.effect.is_tuned().then_some(Searched::Parameter);
            let form = part.is_reshaped().then_some(Searched::Form);
            let lag = (part.effect.lag_s() > 0.0).then_some(Searched::Lag);
            let searched = parameter.into_iter().chain(form).chain(lag);
            searched.map(move |what| (place, what))
        };
        let searched: Vec<_> = model.outwards().into_iter().flat_map(of_part).collect();
        self.estimates_with(fitted, &searched)
    }

    /// The same where the nonlinear parameters are known.
    #[must_use]
    pub(crate) fn estimates_of_coefficients(&self, fitted: &Fitted) -> Vec<Estimate> {
        self.estimates_with(fitted, &[])
    }

    fn estimates_with(&self, fitted: &Fitted, searched: &[(usize, Searched)]) -> Vec<Estimate> {
        let design = self.design_about(fitted, searched);
        let blocks = self.blocks(&design);
        let half_widths = blocks.half_widths_beside_steps(self.independent_samples());
        let of_columns = design.columns.len() - searched.len();
        let (own, others) = half_widths.split_at(of_columns);
        let mut least = blocks.fit().coefficients;
        let away = least.split_off(of_columns);
        let found = fitted.terms().flat_map(|term| term.own.iter().copied());
        let wider = own.iter().zip(least.iter().zip(found));
        let own: Vec<f64> = wider
            .map(|(half, (least, found))| half.hypot(least - found))
            .collect();
        fitted.estimates(&own, |place, what| {
            let among = searched.iter().position(|one| *one == (place, what))?;
            Some(others[among].hypot(away[among]))
        })
    }

    /// Half width of what a fit was made with, by the slope of the prediction over it: on rows of a
    /// mask, beside the coefficients. As far as the least lies away there, it is uncertain besides.
    #[must_use]
    pub(crate) fn half_width_by(&self, fitted: &Fitted, slope: Vec<f64>, mask: &[bool]) -> f64 {
        let mut design = self.design(fitted.model());
        design.columns.push(slope);
        let columns: Vec<&[f64]> = design.columns.iter().map(Vec::as_slice).collect();
        let rows = self.thinned(&columns, &design.target, mask);
        let blocks = Blocks::with(&rows, &[]);
        let last = |all: Vec<f64>| all.last().copied().unwrap_or(0.0);
        last(blocks.half_widths()).hypot(last(blocks.fit().coefficients))
    }

    /// Samples that are fitted, as far as the low-pass leaves them independent: two a period of its
    /// cut-off.
    fn independent_samples(&self) -> f64 {
        let fitted = self.motion.fitted.iter().filter(|fitted| **fitted).count() as f64;
        let cutoff_hz = fit_cutoff_hz(self.dataset, &self.dataset.train);
        let rows = 0.5 / (cutoff_hz * self.motion.period_s);
        fitted / rows.max(1.0)
    }

    /// Derivative of the prediction by the nonlinear parameter of a part; low-passed.
    fn derivative(&self, fitted: &Fitted, place: usize) -> Vec<f64> {
        let part = &fitted.model().parts[place];
        let step = part.effect.derivative_step(part.parameter);
        let at = |step: f64| fitted.with_parameter(place, part.parameter + step);
        self.slope([&at(-step), &at(step)], 2.0 * step)
    }

    /// Derivative of the prediction by the form or the lag of a part, over its neighbours;
    /// low-passed.
    fn derivative_by(&self, fitted: &Fitted, place: usize, what: Searched) -> Vec<f64> {
        let effect = fitted.model().parts[place].effect;
        let (below, above) = neighbours(effect, what);
        let at = |choice: &'static dyn Effect| fitted.with_form(place, choice);
        self.slope([&at(below), &at(above)], what.of(above) - what.of(below))
    }

    /// Slope of the prediction between two fits that are so far apart.
    fn slope(&self, ends: [&Fitted; 2], apart: f64) -> Vec<f64> {
        let [low, high] = ends.map(|fitted| self.predict_lp(fitted));
        let pairs = low.iter().zip(&high);
        pairs.map(|(low, high)| (high - low) / apart).collect()
    }

    /// Sum of squares that a model leaves in the sample.
    #[must_use]
    pub(crate) fn sse(&self, model: &Model) -> f64 {
        self.blocks(&self.design(model)).fit().sse
    }

    /// Prediction from the columns of each part, beside an effort that is wanted besides.
    fn predicted(
        &self,
        fitted: &Fitted,
        mut wanted: Vec<f64>,
        columns: impl Fn(&Part) -> Columns,
    ) -> Vec<f64> {
        let shift_rows = self.shift_rows(fitted.model());
        for term in fitted.terms() {
            let later = all_shifted(&columns(term.part), shift_rows);
            add(&mut wanted, &later, term.own);
        }
        let saturation = fitted.model().saturation();
        wanted.iter().map(|q| saturation.commanded(*q)).collect()
    }

    /// Prediction in the low-passed domain.
    #[must_use]
    pub(crate) fn predict_lp(&self, fitted: &Fitted) -> Vec<f64> {
        let model = fitted.model();
        let beside = if model.saturation().is_ideal() {
            vec![0.0; self.motion.len()]
        } else {
            self.lost_at_peaks(model)
        };
        self.predicted(fitted, beside, |part| self.columns(part))
    }

    /// Prediction that is not low-passed.
    #[must_use]
    pub(crate) fn predict(&self, fitted: &Fitted) -> Vec<f64> {
        let nothing = vec![0.0; self.motion.len()];
        self.predicted(fitted, nothing, |part| Arc::new(self.raw(part)))
    }

    /// What the motor gives to the load side, but for its own mass: the delivered effort without
    /// what acts on the motor itself (ripple); low-passed.
    #[must_use]
    pub(crate) fn transmitted(&self, fitted: &Fitted) -> Vec<f64> {
        let delivered = fitted.model().saturation().delivered_lp(self.motion);
        let mut transmitted = shifted(&delivered, -self.shift_rows(fitted.model()));
        let on_motor = |term: &Term<'_>| term.part.effect.acts_on_motor();
        for term in fitted.terms().filter(on_motor) {
            for (column, coefficient) in self.columns(term.part).iter().zip(term.own) {
                let pairs = transmitted.iter_mut().zip(column);
                pairs.for_each(|(sum, value)| *sum -= coefficient * value);
            }
        }
        transmitted
    }

    /// Residual in the low-passed domain.
    #[must_use]
    pub(crate) fn residual(&self, fitted: &Fitted) -> Vec<f64> {
        let predicted = self.predict_lp(fitted);
        let pairs = self.motion.effort_lp.iter().zip(predicted);
        pairs
            .map(|(effort, predicted)| effort - predicted)
            .collect()
    }

    /// Rms of one column of a part, for a coefficient of one, over fitted samples; percent of the
    /// effort's.
    #[must_use]
    pub(crate) fn percent_of_effort(&self, part: &Part, column: usize) -> f64 {
        let norm = |values: &[f64]| {
            let pairs = values.iter().zip(&self.motion.fitted);
            let fitted = pairs.filter(|(_, fitted)| **fitted);
            fitted.map(|(value, _)| value * value).sum::<f64>().sqrt()
        };
        let columns = self.columns(part);
        let effort = norm(&self.motion.effort_lp).max(f64::MIN_POSITIVE);
        columns
            .get(column)
            .map_or(0.0, |column| 100.0 * norm(column) / effort)
    }

    /// Force error over moving samples, percent.
    #[must_use]
    pub(crate) fn force_error_percent(&self, fitted: &Fitted) -> f64 {
        let residual = self.residual(fitted);
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

fn key(part: &Part) -> Key {
    let structure = |part: &Part| {
        let Part {
            effect, parameter, ..
        } = part;
        let lag = [effect.lag_s(), effect.lag_growth()];
        let shape = [*parameter, effect.form(), lag[0], lag[1]].map(f64::to_bits);
        (part.called(), shape, part.width())
    };
    let bits = |own: &[f64]| own.iter().map(|value| value.to_bits()).collect();
    let beside = part.beside.iter();
    let beside = beside.map(|beside| (structure(&beside.part), bits(&beside.own)));
    (structure(part), beside.collect())
}

/// The columns of a fit with their coefficients, those of each curve as the one that it has become.
fn in_shapes(columns: Vec<Vec<f64>>, fitted: &Fitted) -> (Vec<Vec<f64>>, Vec<f64>) {
    let mut columns = columns.into_iter();
    let shaped = fitted.terms().flat_map(|term| {
        let own: Vec<Vec<f64>> = columns.by_ref().take(term.own.len()).collect();
        let known = term.own.iter().copied();
        if own.len() < FEWEST_OF_A_CURVE {
            return own.into_iter().zip(known).collect::<Vec<_>>();
        }
        let mut curve = vec![0.0; own[0].len()];
        add(&mut curve, &own, term.own);
        vec![(curve, 1.0)]
    });
    shaped.unzip()
}

impl Gathered {
    /// The model alone.
    #[must_use]
    pub(crate) fn fit(&self) -> Fit {
        Blocks::with(&self.rows, &[]).fit()
    }

    /// Blocks with more low-passed columns.
    fn with(&self, columns: &[Vec<f64>]) -> Blocks {
        let mut more = all_shifted(columns, self.shift_rows);
        if let Some(slope) = &self.slope {
            for column in &mut more {
                multiply(column, slope);
            }
        }
        Blocks::with(&self.rows, &more)
    }
}

impl Design {
    /// The columns, as they are fitted.
    #[must_use]
    pub(crate) fn into_columns(self) -> Vec<Vec<f64>> {
        self.columns
    }

    /// The design of a saturating actuator, linearised about a wanted effort q0:
    /// `u − h(q0 + p) + h'(q0 + p) q0 = h'(q0 + p) q`, with p what it loses at peaks.
    fn about(mut self, saturation: Saturation, wanted: &[f64], at_peaks: &[f64]) -> Self {
        let pairs = wanted.iter().zip(at_peaks);
        let all: Vec<f64> = pairs.map(|(q, peaks)| q + peaks).collect();
        let slope: Vec<f64> = all.iter().map(|q| saturation.slope(*q)).collect();
        let rows = wanted.iter().zip(&all).zip(&slope);
        for (target, ((q, all), slope)) in self.target.iter_mut().zip(rows) {
            *target += slope * q - saturation.commanded(*all);
        }
        for column in &mut self.columns {
            multiply(column, &slope);
        }
        Self {
            slope: Some(slope),
            ..self
        }
    }
}

/// The choices on both sides of an effect's own; at an end itself.
fn neighbours(
    effect: &'static dyn Effect,
    what: Searched,
) -> (&'static dyn Effect, &'static dyn Effect) {
    let choices = what.choices(effect);
    let place = what.place(effect).unwrap_or(0);
    let at = |place: usize| choices.get(place).copied().unwrap_or(effect);
    (at(place.saturating_sub(1)), at(place + 1))
}

fn multiply(column: &mut [f64], by: &[f64]) {
    let pairs = column.iter_mut().zip(by);
    pairs.for_each(|(value, by)| *value *= by);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::made::{USUAL, axis, found, model, usual};
    use axis_model::EffectName::{
        self, Coulomb, Delay, Inertia, Offset, Stribeck, TorqueRipple, TorqueSaturation, Viscous,
    };
    use std::f64::consts::TAU;

    const DECLARED: [EffectName; 4] = [Inertia, Viscous, Coulomb, Offset];

    fn near(one: f64, other: f64, share: f64) -> bool {
        (one - other).abs() <= share * other.abs()
    }

    #[test]
    fn the_coefficients_that_made_an_effort_come_back_with_intervals_about_them() {
        let axis = axis(usual);
        let bench = axis.bench();
        let fitted = bench.fit(&model(&DECLARED));
        let estimates = bench.estimates(&fitted);
        for ((name, estimate), wanted) in DECLARED.iter().zip(&estimates).zip(USUAL) {
            let (value, half) = estimate.own[0];
            assert_eq!(fitted.of(*name), Some(&[value][..]));
            assert!(near(value, wanted, 1.0e-3), "{name} {value}");
            assert!(half > 0.0 && half < 0.01 * wanted.abs(), "{name} {half}");
            assert_eq!(estimate.parameter_half_width, None);
        }
        assert!(bench.force_error_percent(&fitted) < 0.05);
    }

    #[test]
    fn the_force_error_is_the_rms_of_what_is_left_over_that_of_the_effort() {
        let axis = axis(|_, _| 50.0);
        let half = Fitted::new(model(&[Offset]), &[49.0]);
        assert!(near(axis.bench().force_error_percent(&half), 2.0, 1.0e-3));
        let residual = axis.bench().residual(&half);
        assert!(near(residual[3000], 1.0, 0.05), "{}", residual[3000]);
    }

    #[test]
    fn a_delayed_effort_is_that_of_later_rows() {
        let axis = axis(|motion, row| usual(motion, (row + 3).min(motion.len() - 1)));
        let bench = axis.bench();
        let late = |delay_s: f64| model(&DECLARED).with(found(Delay, delay_s));
        let error = |delay_s| bench.force_error_percent(&bench.fit(&late(delay_s)));
        assert!(error(3.0e-3) < 0.1, "{}", error(3.0e-3));
        assert!(error(-3.0e-3) > 1.0 && error(2.5e-3) > 2.0 * error(3.0e-3));
        let fitted = bench.fit(&late(3.0e-3));
        let delay = &bench.estimates(&fitted)[4];
        assert!(delay.own.is_empty());
        let half = delay.parameter_half_width.unwrap();
        assert!(half > 1.0e-9 && half < 1.0e-4, "{half}");
    }

    #[test]
    fn a_saturating_drive_is_linearised_about_the_fit_and_then_fits() {
        let k = 2.0e-3;
        let saturation = Saturation { per_effort: k };
        // What is wanted has peaks, in which the low-pass sees less lost than was.
        let peaks = |row: usize| 60.0 * f64::from(u8::from(row % 50 < 4));
        let wanted = |motion: &Kinematics, row| usual(motion, row) + peaks(row);
        let mut axis = axis(|motion, row| saturation.commanded(wanted(motion, row)));
        let raw: Vec<f64> = (0..axis.motion.len()).map(peaks).collect();
        axis.motion
            .acceleration
            .iter_mut()
            .zip(&raw)
            .for_each(|(a, force)| *a += force / USUAL[0]);
        let all: Vec<f64> = (0..axis.motion.len())
            .map(|row| usual(&axis.motion, row))
            .collect();
        let wanted = axis.motion.low_passed(&all);
        let bench = axis.bench();
        let ideal = bench.fit(&model(&DECLARED));
        let mut saturated = model(&DECLARED).with(found(TorqueSaturation, k));
        for _ in 0..4 {
            let fitted = bench.fit(&saturated);
            let own: Vec<Vec<f64>> = fitted.terms().map(|term| term.own.to_vec()).collect();
            saturated
                .parts
                .iter_mut()
                .zip(own)
                .for_each(|(part, own)| part.about = own);
        }
        let fitted = bench.fit(&saturated);
        assert!(near(fitted.of(Inertia).unwrap()[0], USUAL[0], 1.0e-3));
        assert!(near(fitted.of(Coulomb).unwrap()[0], USUAL[2], 1.0e-2));
        assert!(bench.force_error_percent(&fitted) < 0.1 * bench.force_error_percent(&ideal));
        // What the motor gives is what was wanted.
        let transmitted = bench.transmitted(&fitted);
        let rows = 300..5700;
        assert!(
            rows.into_iter()
                .all(|row| (transmitted[row] - wanted[row]).abs() < 0.05)
        );
        let half = bench.estimates(&fitted)[4].parameter_half_width.unwrap();
        assert!(half > 0.0 && half < 0.1 * k, "{half}");
    }

    #[test]
    fn a_part_tried_beside_a_model_gives_the_fit_of_the_longer_model() {
        let axis = axis(usual);
        let bench = axis.bench();
        let mut short = model(&DECLARED)
            .with(found(Delay, 1.5e-3))
            .with(found(TorqueSaturation, 1.0e-3));
        for (part, about) in short.parts.iter_mut().zip(USUAL) {
            part.about = vec![about];
        }
        let part = found(Stribeck, 0.01);
        let long = bench.cross_validate(&short.with(part.clone()));
        let short = bench.gathered(&short);
        for beside in [
            bench.beside(&short, &part),
            bench.beside_once(&short, &part),
        ] {
            let beside = beside.cross_validate();
            assert_eq!(beside.coefficients, long.coefficients);
            assert_eq!(beside.held_out, long.held_out);
        }
    }

    #[test]
    fn what_acts_on_the_motor_is_not_transmitted() {
        let axis = axis(usual);
        let bench = axis.bench();
        let ripple = model(&[Coulomb]).with(found(TorqueRipple, 100.0));
        let fitted = Fitted::new(ripple, &[25.0, 3.0, 0.0]);
        let transmitted = bench.transmitted(&fitted);
        for row in [1000, 2500] {
            let (effort, x) = (axis.motion.effort_lp[row], axis.motion.position_lp[row]);
            let wanted = effort - 3.0 * (TAU * 100.0 * x).cos();
            assert!((transmitted[row] - wanted).abs() < 0.05, "{row}");
        }
    }

    #[test]
    fn a_delay_and_the_effort_that_is_transmitted_go_opposite_ways() {
        let axis = axis(|_, row| row as f64);
        let late = Fitted::new(model(&[Offset]).with(found(Delay, 5.0e-3)), &[0.0]);
        let transmitted = axis.bench().transmitted(&late);
        assert!(
            (transmitted[3000] - 2995.0).abs() < 0.1,
            "{}",
            transmitted[3000]
        );
    }

    #[test]
    fn the_interval_of_a_known_parameter_is_not_asked() {
        let axis = axis(usual);
        let bench = axis.bench();
        let fitted = bench.fit(&model(&DECLARED).with(found(TorqueRipple, 300.0)));
        let both = |estimates: Vec<Estimate>| {
            let ripple = estimates.into_iter().next_back().unwrap();
            (ripple.own[0].1, ripple.parameter_half_width.is_some())
        };
        let (free, has_free) = both(bench.estimates(&fitted));
        let (fixed, has_fixed) = both(bench.estimates_of_coefficients(&fitted));
        assert!(has_free && !has_fixed && free > 0.0 && fixed > 0.0);
    }

    #[test]
    fn a_prediction_that_is_not_low_passed_keeps_its_corners() {
        let axis = axis(usual);
        let bench = axis.bench();
        let fitted = Fitted::new(model(&[Coulomb]), &[25.0]);
        let sharp = bench.predict(&fitted);
        assert!(
            sharp
                .iter()
                .all(|force| (force.abs() - 25.0).abs() < 1.0e-9)
        );
        let smooth = bench.predict_lp(&fitted);
        assert!(smooth.iter().any(|force| force.abs() < 20.0));
    }

    #[test]
    fn columns_are_kept_and_forgotten_without_another_result() {
        let axis = axis(usual);
        let bench = axis.bench();
        let with = |vs: f64| bench.sse(&model(&DECLARED).with(found(Stribeck, vs)));
        let first = with(0.01);
        // More than what is kept: 6000 rows each.
        let many: Vec<f64> = (0..700).map(|i| 0.01 + 1.0e-5 * f64::from(i)).collect();
        let part = |vs: &f64| bench.columns(&found(Stribeck, *vs)).len();
        assert_eq!(many.iter().map(part).sum::<usize>(), 700);
        let kept = bench.kept().len();
        assert!(kept < 100, "{kept}");
        assert_eq!(with(0.01), first);
    }
}
