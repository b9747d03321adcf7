//! Forward selection with joint refinement and removal, on held-out blocks.
//!
//! Thresholds. A candidate must remove a share of the held-out error (relevance), be large enough to matter to the axis (percent of effort), and
//! do so in more blocks than chance (t). Share is what separates: on 14 simulated records with nothing missing the largest false share was 0.016, the
//! smallest true one accepted 0.16; t alone does not (false candidates reached 14, because gains sit in few blocks). Figures: docs/identification.md.

use crate::effects::{Effect, Fitted, LIBRARY, Setting};
use crate::kinematics::Kinematics;
use crate::record::Dataset;
use crate::regression::{Blocks, Fit, Gain};

/// Smallest share of the held-out error.
pub const SHARE: f64 = 0.08;
/// Smallest size, percent of the effort.
pub const PERCENT: f64 = 0.15;
/// Smallest t; a large share needs less of it.
pub const T: f64 = 2.5;
/// A share from which [`T_LARGE`] is enough.
pub const LARGE_SHARE: f64 = 0.12;
/// Smallest t of a large share.
pub const T_LARGE: f64 = 1.5;
/// Smallest share of a structure without a name.
pub const NAMELESS_SHARE: f64 = 0.15;
/// A delay below this is not worth a name, s.
pub const SHORTEST_DELAY_S: f64 = 1.0e-4;
/// Longest delay that is searched, s.
const LONGEST_DELAY_S: f64 = 6.0e-3;
/// Cut-off for the search of a delay: quantisation comes back through the controller as effort that follows measured noise, and looks like a delay
/// at 100 Hz but not here.
const DELAY_CUTOFF_HZ: f64 = 30.0;
/// Most effects that are added.
const MOST: usize = 8;

/// An effect with its nonlinear parameter.
#[derive(Clone, Copy)]
pub struct Term {
    /// Which effect.
    pub effect: &'static dyn Effect,
    /// Its nonlinear parameter.
    pub parameter: f64,
}

/// An inverse model: terms and delay.
#[derive(Clone, Default)]
pub struct Model {
    /// Terms; the declared ones first.
    pub terms: Vec<Term>,
    /// The recorded effort acts this much later than the record says, s.
    pub delay_s: f64,
}

/// A candidate and what it is worth.
#[derive(Clone, Debug, PartialEq)]
pub struct Scored {
    /// Effect.
    pub effect: &'static str,
    /// Nonlinear parameter.
    pub parameter: f64,
    /// Gain on held-out blocks.
    pub gain: Gain,
    /// Whether what was fitted can be this effect.
    pub physical: bool,
    /// Whether it was accepted.
    pub accepted: bool,
    /// Whether it has no name.
    pub nameless: bool,
    /// Round of the selection, from 0.
    pub round: usize,
}

/// A record with low-passed columns that are kept between fits.
pub struct Bench<'a> {
    /// The axis.
    pub dataset: &'a Dataset,
    /// The motion.
    pub motion: &'a Kinematics,
}

impl Bench<'_> {
    /// Low-passed columns of a term.
    #[must_use]
    pub fn columns(&self, term: &Term) -> Vec<Vec<f64>> {
        let raw = term.effect.columns(self.motion, self.dataset, term.parameter);
        raw.iter().map(|column| self.motion.filter.apply(column)).collect()
    }

    fn design(&self, model: &Model) -> Vec<Vec<f64>> {
        let columns = model.terms.iter().flat_map(|term| self.columns(term));
        columns.map(|column| shifted(column, model.delay_s / self.motion.period_s)).collect()
    }

    fn blocks(&self, design: &[Vec<f64>]) -> Blocks {
        let columns: Vec<&[f64]> = design.iter().map(Vec::as_slice).collect();
        Blocks::new(&columns, &self.motion.effort_lp, &self.motion.moving, self.motion.period_s)
    }

    /// Fit of a model with its held-out errors.
    #[must_use]
    pub fn fit(&self, model: &Model) -> Fit {
        self.blocks(&self.design(model)).cross_validate()
    }

    /// Half widths of the 95 % intervals of the coefficients.
    #[must_use]
    pub fn half_widths(&self, model: &Model) -> Vec<f64> {
        self.blocks(&self.design(model)).half_widths()
    }

    fn sse(&self, model: &Model) -> f64 {
        self.blocks(&self.design(model)).fit().sse
    }

    /// Prediction in the low-passed domain.
    #[must_use]
    pub fn predict_lp(&self, model: &Model, coefficients: &[f64]) -> Vec<f64> {
        weighted(&self.design(model), coefficients, self.motion.len())
    }

    /// Prediction that is not low-passed.
    #[must_use]
    pub fn predict(&self, model: &Model, coefficients: &[f64]) -> Vec<f64> {
        let columns =
            model.terms.iter().flat_map(|term| term.effect.columns(self.motion, self.dataset, term.parameter));
        let columns: Vec<Vec<f64>> =
            columns.map(|column| shifted(column, model.delay_s / self.motion.period_s)).collect();
        weighted(&columns, coefficients, self.motion.len())
    }

    /// Residual in the low-passed domain.
    #[must_use]
    pub fn residual(&self, model: &Model, coefficients: &[f64]) -> Vec<f64> {
        let predicted = self.predict_lp(model, coefficients);
        self.motion.effort_lp.iter().zip(predicted).map(|(effort, predicted)| effort - predicted).collect()
    }

    /// Force error over moving samples, percent.
    #[must_use]
    pub fn force_error_percent(&self, model: &Model, coefficients: &[f64]) -> f64 {
        let residual = self.residual(model, coefficients);
        let norm = |values: &[f64]| {
            let moving = values.iter().zip(&self.motion.moving).filter(|(_, moving)| **moving);
            moving.map(|(value, _)| value * value).sum::<f64>().sqrt()
        };
        100.0 * norm(&residual) / norm(&self.motion.effort_lp).max(f64::MIN_POSITIVE)
    }
}

fn weighted(columns: &[Vec<f64>], coefficients: &[f64], rows: usize) -> Vec<f64> {
    let mut sum = vec![0.0; rows];
    for (column, coefficient) in columns.iter().zip(coefficients) {
        sum.iter_mut().zip(column).for_each(|(sum, value)| *sum += coefficient * value);
    }
    sum
}

/// A band-limited signal seen `by` samples later; cubic Lagrange interpolation.
fn shifted(column: Vec<f64>, by: f64) -> Vec<f64> {
    if by == 0.0 || column.len() < 4 {
        return column;
    }
    let last = column.len() - 3;
    (0..column.len())
        .map(|row| {
            let at = (row as f64 + by).clamp(1.0, last as f64);
            let base = (at.floor() as usize).clamp(1, last);
            let u = at - base as f64;
            let [a, b, c, d] = [column[base - 1], column[base], column[base + 1], column[base + 2]];
            a * (-u * (u - 1.0) * (u - 2.0) / 6.0)
                + b * ((u + 1.0) * (u - 1.0) * (u - 2.0) / 2.0)
                + c * (-(u + 1.0) * u * (u - 2.0) / 2.0)
                + d * ((u + 1.0) * u * (u - 1.0) / 6.0)
        })
        .collect()
}

/// What the selection did.
#[derive(Clone, Default)]
pub struct Selection {
    /// The model with everything that was accepted.
    pub model: Model,
    /// Accepted effects, in the order in which they were found.
    pub found: Vec<&'static str>,
    /// Structures without a name that were found.
    pub nameless: Vec<&'static str>,
    /// All candidates of all rounds.
    pub scored: Vec<Scored>,
}

/// The declared terms of the inverse model.
#[must_use]
pub fn declared_model(dataset: &Dataset) -> Model {
    let known = dataset.declared.iter().filter_map(|name| crate::effects::find(name));
    let start = |effect: &'static dyn Effect| match effect.name() {
        "stribeck" => 5.0 * dataset.kind.moving_velocity(),
        "friction_drift" => 0.3 * dataset.train.period_s * dataset.train.len() as f64,
        "position_dependent_friction" => 1.0,
        "torque_ripple" => dataset.lead_m_per_rev.map_or(100.0, |lead| 1.0 / lead),
        _ => 0.0,
    };
    Model { terms: known.map(|effect| Term { effect, parameter: start(effect) }).collect(), delay_s: 0.0 }
}

/// Forward selection on a record; `low` is the same record with the cut-off of the delay search. `progress` hears of every round.
pub fn select(bench: &Bench<'_>, low: &Bench<'_>, start: Model, progress: &mut dyn FnMut(&str)) -> Selection {
    let declared = start.terms.len();
    let mut selection = Selection { model: start, ..Selection::default() };
    refine(bench, &mut selection.model);
    for round in 0..MOST {
        let base = bench.fit(&selection.model);
        let residual = bench.residual(&selection.model, &base.coefficients);
        let setting = Setting { dataset: bench.dataset, residual: &residual };
        let mut candidates: Vec<(Scored, Model)> = LIBRARY
            .into_iter()
            .filter(|effect| is_open(*effect, &selection.model, bench.dataset))
            .map(|effect| candidate(bench, &selection.model, &base, effect, &setting, round))
            .collect();
        if !selection.found.contains(&"delay") && !bench.dataset.declared.iter().any(|name| name == "delay") {
            candidates.push(delay_candidate(bench, low, &selection.model, &base, round));
        }
        candidates.sort_by(|a, b| b.0.gain.share.total_cmp(&a.0.gain.share));
        let best = candidates.iter().position(|(scored, _)| is_accepted(scored));
        if let Some(best) = best {
            candidates[best].0.accepted = true;
            let (scored, model) = &candidates[best];
            progress(&format!("{} removes {:.0} % of the held-out residual", scored.effect, 100.0 * scored.gain.share));
            let list = if scored.nameless { &mut selection.nameless } else { &mut selection.found };
            if !list.contains(&scored.effect) {
                list.push(scored.effect);
            }
            selection.model = model.clone();
        }
        selection.scored.extend(candidates.into_iter().map(|(scored, _)| scored));
        if best.is_none() {
            break;
        }
        refine(bench, &mut selection.model);
    }
    remove(bench, &mut selection, declared);
    selection
}

fn is_open(effect: &'static dyn Effect, model: &Model, dataset: &Dataset) -> bool {
    let present = model.terms.iter().any(|term| term.effect.name() == effect.name());
    !dataset.declared.iter().any(|name| name == effect.name()) && (!present || effect.repeats())
}

fn is_accepted(scored: &Scored) -> bool {
    let Gain { share, percent, t } = scored.gain;
    let smallest = if scored.nameless { NAMELESS_SHARE } else { SHARE };
    scored.physical
        && share >= smallest
        && percent >= PERCENT
        && (t >= T || (share >= LARGE_SHARE && t >= T_LARGE))
        && (scored.effect != "delay" || scored.parameter >= SHORTEST_DELAY_S)
}

fn with(model: &Model, effect: &'static dyn Effect, parameter: f64) -> Model {
    let mut model = model.clone();
    model.terms.push(Term { effect, parameter });
    model
}

fn candidate(
    bench: &Bench<'_>,
    model: &Model,
    base: &Fit,
    effect: &'static dyn Effect,
    setting: &Setting<'_>,
    round: usize,
) -> (Scored, Model) {
    let fixed = bench.design(model);
    let sse = |parameter: f64| {
        let own = bench.columns(&Term { effect, parameter });
        let own = own.into_iter().map(|column| shifted(column, model.delay_s / bench.motion.period_s));
        let design: Vec<Vec<f64>> = fixed.iter().cloned().chain(own).collect();
        bench.blocks(&design).fit().sse
    };
    let known = |k: &f64| is_new(bench, model, effect, *k);
    let grid: Vec<f64> = effect.grid(bench.motion, setting).into_iter().filter(known).collect();
    let start = smallest(grid, &sse).unwrap_or(0.0);
    let parameter = descend(start, effect.refine_step(bench.motion, start), effect.bounds(bench.motion), &sse);
    let extended = with(model, effect, parameter);
    let fit = bench.fit(&extended);
    let own = &fit.coefficients[base.coefficients.len().min(fit.coefficients.len())..];
    let physical = effect.is_physical(&Fitted {
        own,
        coulomb: coefficient_of(model, bench, &fit, "coulomb"),
        viscous: coefficient_of(model, bench, &fit, "viscous"),
    });
    let gain = Gain::of(base, &fit);
    let nameless = effect.is_nameless();
    (Scored { effect: effect.name(), parameter, gain, physical, accepted: false, nameless, round }, extended)
}

/// A repeated ripple must have another wave number than the ones already found.
fn is_new(bench: &Bench<'_>, model: &Model, effect: &'static dyn Effect, parameter: f64) -> bool {
    let (low, high) = bench.motion.span();
    let width = if effect.name() == "torque_ripple" { 2.0 / (high - low) } else { 2.0 / bench.motion.duration_s() };
    let same = model.terms.iter().filter(|term| term.effect.name() == effect.name());
    !effect.repeats() || same.into_iter().all(|term| (term.parameter - parameter).abs() > width)
}

fn coefficient_of(model: &Model, bench: &Bench<'_>, fit: &Fit, name: &str) -> f64 {
    let mut place = 0;
    for term in &model.terms {
        if term.effect.name() == name {
            return fit.coefficients.get(place).copied().unwrap_or(0.0);
        }
        place += term.effect.columns(bench.motion, bench.dataset, term.parameter).len();
    }
    f64::INFINITY
}

fn smallest(values: Vec<f64>, sse: &dyn Fn(f64) -> f64) -> Option<f64> {
    values.into_iter().map(|value| (sse(value), value)).min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, value)| value)
}

/// Steps of one size that a descent may take before it halves them.
const STEPS: usize = 12;

/// Step-halving descent about a start value, within bounds.
fn descend(start: f64, step: f64, (low, high): (f64, f64), sse: &dyn Fn(f64) -> f64) -> f64 {
    if step == 0.0 {
        return start;
    }
    let (mut best, mut at, mut step) = (sse(start), start, step);
    for _ in 0..6 {
        for _ in 0..STEPS {
            let tries = [at - step, at + step].into_iter().filter(|value| *value >= low && *value <= high);
            let tries = tries.map(|value| (sse(value), value));
            let better = tries.min_by(|a, b| a.0.total_cmp(&b.0)).filter(|(sse, _)| *sse < best);
            match better {
                Some((sse, value)) => (best, at) = (sse, value),
                None => break,
            }
        }
        step *= 0.5;
    }
    at
}

fn delay_candidate(bench: &Bench<'_>, low: &Bench<'_>, model: &Model, base: &Fit, round: usize) -> (Scored, Model) {
    let delayed = |delay_s: f64| Model { delay_s, ..model.clone() };
    let sse = |delay_s: f64| low.sse(&delayed(delay_s));
    let grid: Vec<f64> = (-8..=24).map(|i| 2.5e-4 * f64::from(i)).filter(|d| *d <= LONGEST_DELAY_S).collect();
    let start = smallest(grid, &sse).unwrap_or(0.0);
    let parameter = descend(start, 1.0e-4, (-LONGEST_DELAY_S, LONGEST_DELAY_S), &sse);
    let extended = delayed(parameter);
    let gain = Gain::of(base, &bench.fit(&extended));
    let gain_low = Gain::of(&low.fit(model), &low.fit(&extended));
    let gain = Gain { share: gain.share.min(gain_low.share), t: gain.t.min(gain_low.t), ..gain };
    let scored =
        Scored { effect: "delay", parameter, gain, physical: parameter > 0.0, accepted: false, nameless: false, round };
    (scored, extended)
}

/// The cut-off for the delay search at a sample period.
#[must_use]
pub fn delay_cutoff_hz(period_s: f64) -> f64 {
    DELAY_CUTOFF_HZ.min(crate::filter::cutoff_hz(period_s))
}

/// Joint refinement of all nonlinear parameters: without it the grid's coarseness leaves residuals that look like other effects.
pub fn refine(bench: &Bench<'_>, model: &mut Model) {
    for _ in 0..2 {
        for at in 0..model.terms.len() {
            let term = model.terms[at];
            let step = 0.3 * term.effect.refine_step(bench.motion, term.parameter);
            if step == 0.0 {
                continue;
            }
            let others = Model { terms: [&model.terms[..at], &model.terms[at + 1..]].concat(), delay_s: model.delay_s };
            let fixed = bench.design(&others);
            let parameter = descend(term.parameter, step, term.effect.bounds(bench.motion), &|parameter| {
                let own = bench.columns(&Term { parameter, ..term }).into_iter();
                let own = own.map(|column| shifted(column, model.delay_s / bench.motion.period_s));
                bench.blocks(&fixed.iter().cloned().chain(own).collect::<Vec<_>>()).fit().sse
            });
            model.terms[at].parameter = parameter;
        }
    }
}

/// Drops what the later ones have made superfluous.
fn remove(bench: &Bench<'_>, selection: &mut Selection, declared: usize) {
    let mut at = declared;
    while at < selection.model.terms.len() {
        let full = bench.fit(&selection.model);
        let mut without = selection.model.clone();
        let term = without.terms.remove(at);
        let gain = Gain::of(&bench.fit(&without), &full);
        if gain.share >= SHARE && gain.percent >= PERCENT {
            at += 1;
            continue;
        }
        selection.model = without;
        let name = term.effect.name();
        if !selection.model.terms.iter().any(|term| term.effect.name() == name) {
            selection.found.retain(|found| *found != name);
            selection.nameless.retain(|found| *found != name);
        }
    }
}

/// Total inertia by plain least squares on inertia, velocity, direction and a constant; for the physical test of a motor mass.
#[must_use]
pub fn declared_inertia(motion: &Kinematics) -> f64 {
    let lp = |column: &[f64]| motion.filter.apply(column);
    let ones = vec![1.0; motion.len()];
    let columns = [lp(&motion.acceleration), lp(&motion.velocity), lp(&motion.direction), ones];
    let views: Vec<&[f64]> = columns.iter().map(Vec::as_slice).collect();
    let fit = Blocks::new(&views, &motion.effort_lp, &motion.moving, motion.period_s).fit();
    fit.coefficients.first().copied().unwrap_or(f64::INFINITY)
}
