//! Forward selection with joint refinement and removal, on held-out blocks.
//!
//! Thresholds. A candidate must remove a share of the held-out error (relevance), be large enough
//! to matter to the axis (percent of effort), and do so in more blocks than chance (t). Share is
//! what separates: on 14 simulated records with nothing missing the largest false share was 0.016;
//! t alone does not (false candidates reached 14, because gains sit in few blocks). Figures:
//! docs/identification.md.

use crate::evidence::actuator::{self, Pair};
use crate::fit::bench::{Bench, Model, Saturation, Term};
use crate::fit::blocks::{Blocks, Fit, Gain};
use crate::fit::search::{descend, smallest};
use crate::model::effects::{Effect, Fitted, LIBRARY, Setting};
use crate::motion::kinematics::Kinematics;
use crate::record::dataset::Dataset;

/// Smallest share of the held-out error.
pub(crate) const SHARE: f64 = 0.05;
/// Smallest size, percent of the effort.
pub(crate) const PERCENT: f64 = 0.15;
/// Shares of the held-out error, and the smallest t from each of them on. The t of an effect that
/// shows in few blocks (slow motion) is small however large it is there.
pub(crate) const T: [(f64, f64); 4] = [(0.30, 1.0), (0.12, 1.5), (0.08, 2.5), (SHARE, 3.0)];
/// From this t on a coefficient's interval is not asked.
const CERTAIN_T: f64 = 2.5;
/// Largest error on another record with an effect over that without it.
const VETO: f64 = 1.05;
/// Smallest share of a structure without a name.
pub(crate) const NAMELESS_SHARE: f64 = 0.15;
/// Most effects that are added.
const MOST: usize = 8;

/// A candidate and what it is worth.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Scored {
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

/// What the selection did.
#[derive(Clone, Default)]
pub(crate) struct Selection {
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
pub(crate) fn declared_model(dataset: &Dataset) -> Model {
    // Coulomb asymmetry and offset are the same force: one column stands for both.
    let column = |name: &String| {
        if name == "coulomb_asymmetry" {
            "offset".to_owned()
        } else {
            name.clone()
        }
    };
    let names: std::collections::BTreeSet<String> = dataset.declared.iter().map(column).collect();
    let known = LIBRARY
        .into_iter()
        .filter(|effect| names.contains(effect.name()));
    let start = |effect: &'static dyn Effect| match effect.name() {
        "stribeck" => 5.0 * dataset.kind.moving_velocity(),
        "friction_drift" => 0.3 * dataset.train.duration_s(),
        "position_dependent_friction" => 1.0,
        "torque_ripple" => dataset.lead_m_per_rev.map_or(100.0, |lead| 1.0 / lead),
        _ => 0.0,
    };
    Model {
        terms: known
            .map(|effect| Term {
                effect,
                parameter: start(effect),
            })
            .collect(),
        ..Model::default()
    }
}

/// Fits what the declared model has beyond linear coefficients.
pub(crate) fn prepare(pair: Pair<'_>, model: &mut Model) {
    let declared = |name: &str| {
        pair.bench
            .dataset
            .declared
            .iter()
            .any(|declared| declared == name)
    };
    if declared("delay") {
        model.delay_s = actuator::best_delay(pair.low, model, 2.5e-4);
    }
    if declared("torque_saturation") {
        *model = actuator::with_saturation(pair.bench, model, None);
    }
    for at in 0..model.terms.len() {
        start_term(pair.bench, model, at);
    }
    refine(pair, model);
}

/// Puts the nonlinear parameter of a declared term where the others leave the least.
fn start_term(bench: &Bench<'_>, model: &mut Model, at: usize) {
    let mut others = model.clone();
    let term = others.terms.remove(at);
    let residual = bench.residual(&others, &bench.fit(&others).coefficients);
    let setting = Setting {
        dataset: bench.dataset,
        residual: &residual,
    };
    let grid = term.effect.grid(bench.motion, &setting);
    if grid.len() > 1 {
        let best = smallest(grid, &|parameter| {
            bench.sse(&model.with_parameter(at, parameter))
        });
        model.terms[at].parameter = best.unwrap_or(term.parameter);
    }
}

/// Forward selection on a record, from the declared model. `progress` hears of every round.
pub(crate) fn select(pair: Pair<'_>, start: Model, progress: &mut dyn FnMut(&str)) -> Selection {
    let start = Start {
        terms: start.terms.len(),
        delay: start.delay_s != 0.0,
        saturation: start.saturates(),
        model: start,
    };
    let mut selection = Selection {
        model: start.model.clone(),
        ..Selection::default()
    };
    for round in 0..MOST {
        let mut candidates = candidates(pair, &selection.model, round);
        candidates.sort_by(|a, b| b.0.gain.share.total_cmp(&a.0.gain.share));
        let best = candidates.iter().position(|(scored, model)| {
            is_accepted(scored) && is_certain(pair.bench, scored, model)
        });
        if let Some(best) = best {
            candidates[best].0.accepted = true;
            let (scored, model) = &candidates[best];
            progress(&format!(
                "{} removes {:.0} % of the held-out residual",
                scored.effect,
                100.0 * scored.gain.share
            ));
            let list = if scored.nameless {
                &mut selection.nameless
            } else {
                &mut selection.found
            };
            if !list.contains(&scored.effect) {
                list.push(scored.effect);
            }
            selection.model = model.clone();
        }
        selection
            .scored
            .extend(candidates.into_iter().map(|(scored, _)| scored));
        if best.is_none() {
            break;
        }
        refine(pair, &mut selection.model);
    }
    remove(pair.bench, &mut selection, &start);
    selection
}

/// Everything that a model could have besides, judged.
fn candidates(pair: Pair<'_>, model: &Model, round: usize) -> Vec<(Scored, Model)> {
    let bench = pair.bench;
    let base = bench.fit(model);
    let residual = bench.residual(model, &base.coefficients);
    let setting = Setting {
        dataset: bench.dataset,
        residual: &residual,
    };
    let mut candidates: Vec<(Scored, Model)> = LIBRARY
        .into_iter()
        .filter(|effect| is_open(*effect, model, bench.dataset))
        .filter_map(|effect| candidate(bench, model, &base, effect, &setting, round))
        .collect();
    if model.delay_s == 0.0 {
        candidates.push(actuator::delay_candidate(pair, model, &base, round));
    }
    if !model.saturates() {
        candidates.push(actuator::saturation_candidate(pair, model, &base, round));
    }
    candidates
}

fn is_open(effect: &'static dyn Effect, model: &Model, dataset: &Dataset) -> bool {
    let present = model
        .terms
        .iter()
        .any(|term| term.effect.name() == effect.name());
    let declared = dataset.declared.iter().any(|name| name == effect.name());
    if effect.repeats() {
        true
    } else {
        !declared && !present
    }
}

fn is_accepted(scored: &Scored) -> bool {
    let smallest = if scored.nameless {
        NAMELESS_SHARE
    } else {
        SHARE
    };
    scored.physical && scored.gain.share >= smallest && is_enough(&scored.gain)
}

/// Whether what was fitted differs from zero: asked where the gain sits in few blocks.
fn is_certain(bench: &Bench<'_>, scored: &Scored, model: &Model) -> bool {
    if scored.gain.t >= CERTAIN_T {
        return true;
    }
    let coefficients = bench.fit(model).coefficients;
    let half_widths = bench.half_widths(model, &coefficients);
    match scored.effect {
        "torque_saturation" => half_widths
            .saturation
            .is_some_and(|half| half < model.saturation.per_effort),
        "delay" => half_widths.delay_s.is_some_and(|half| half < model.delay_s),
        _ => {
            let width = model
                .terms
                .last()
                .map_or(0, |term| term.effect.width(term.parameter));
            let own = coefficients
                .iter()
                .zip(&half_widths.linear)
                .rev()
                .take(width);
            own.into_iter().any(|(value, half)| value.abs() > *half)
        }
    }
}

/// Drops effects that make the error on another record larger by more than a little: what holds on
/// one record only is no effect of the axis.
pub(crate) fn veto(
    bench: &Bench<'_>,
    other: &Bench<'_>,
    selection: &mut Selection,
    declared: usize,
) {
    let error = |model: &Model| {
        let coefficients = bench.fit(model).coefficients;
        other.force_error_percent(model, &coefficients)
    };
    let mut at = declared;
    while at < selection.model.terms.len() {
        let mut without = selection.model.clone();
        let name = without.terms.remove(at).effect.name();
        if error(&selection.model) <= VETO * error(&without) {
            at += 1;
            continue;
        }
        selection.model = without;
        if !selection.model.has(name) {
            selection.found.retain(|found| *found != name);
            selection.nameless.retain(|found| *found != name);
        }
    }
    let undelayed = Model {
        delay_s: 0.0,
        ..selection.model.clone()
    };
    if selection.found.contains(&"delay") && error(&selection.model) > VETO * error(&undelayed) {
        selection.found.retain(|found| *found != "delay");
        selection.model = undelayed;
    }
    let ideal = Model {
        saturation: Saturation::default(),
        ..selection.model.clone()
    };
    if selection.found.contains(&"torque_saturation")
        && error(&selection.model) > VETO * error(&ideal)
    {
        selection
            .found
            .retain(|found| *found != "torque_saturation");
        selection.model = ideal;
    }
}

/// Whether a gain is relevant, large enough to matter to the axis, and more than chance.
#[must_use]
pub(crate) fn is_enough(gain: &Gain) -> bool {
    gain.percent >= PERCENT
        && T.iter()
            .any(|(from, smallest)| gain.share >= *from && gain.t >= *smallest)
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
) -> Option<(Scored, Model)> {
    let fixed = bench.design(model);
    let sse = |parameter: f64| {
        bench
            .blocks(&bench.extended(&fixed, &Term { effect, parameter }))
            .fit()
            .sse
    };
    let bounds = effect.bounds(bench.motion);
    let inside = |k: &f64| !effect.is_tuned() || (*k >= bounds.0 && *k <= bounds.1);
    let known = |k: &f64| inside(k) && is_new(bench, model, effect, *k);
    let grid: Vec<f64> = effect
        .grid(bench.motion, setting)
        .into_iter()
        .filter(known)
        .collect();
    // Nothing on the grid: the record cannot show the effect.
    let start = smallest(grid, &sse)?;
    let parameter = descend(start, effect.refine_step(bench.motion, start), bounds, &sse);
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
    Some((
        Scored {
            effect: effect.name(),
            parameter,
            gain,
            physical,
            accepted: false,
            nameless,
            round,
        },
        extended,
    ))
}

/// A repeated ripple must have another wave number than the ones already found.
fn is_new(bench: &Bench<'_>, model: &Model, effect: &'static dyn Effect, parameter: f64) -> bool {
    let (low, high) = bench.motion.span();
    let width = if effect.name() == "torque_ripple" {
        2.0 / (high - low)
    } else {
        2.0 / bench.motion.duration_s()
    };
    let same = model
        .terms
        .iter()
        .filter(|term| term.effect.name() == effect.name());
    !effect.repeats()
        || same
            .into_iter()
            .all(|term| (term.parameter - parameter).abs() > width)
}

fn coefficient_of(model: &Model, bench: &Bench<'_>, fit: &Fit, name: &str) -> f64 {
    let mut place = 0;
    for term in &model.terms {
        if term.effect.name() == name {
            return fit.coefficients.get(place).copied().unwrap_or(0.0);
        }
        place += term
            .effect
            .columns(bench.motion, bench.dataset, term.parameter)
            .len();
    }
    f64::INFINITY
}

/// Joint refinement of all nonlinear parameters: without it the grid's coarseness leaves residuals
/// that look like other effects.
pub(crate) fn refine(pair: Pair<'_>, model: &mut Model) {
    let bench = pair.bench;
    for _ in 0..2 {
        for at in 0..model.terms.len() {
            let term = model.terms[at];
            let step = 0.3 * term.effect.refine_step(bench.motion, term.parameter);
            if step > 0.0 {
                let sse = |parameter: f64| bench.sse(&model.with_parameter(at, parameter));
                model.terms[at].parameter =
                    descend(term.parameter, step, term.effect.bounds(bench.motion), &sse);
            }
        }
        if model.delay_s != 0.0 {
            model.delay_s = actuator::best_delay(pair.low, model, model.delay_s);
        }
        if model.saturates() {
            *model = actuator::with_saturation(bench, model, Some(model.saturation.per_effort));
        }
    }
}

/// The model with the load's own inertia, where that lowers the held-out error: for an axis whose
/// load moves otherwise than its motor.
#[must_use]
pub(crate) fn with_load_inertia(bench: &Bench<'_>, model: &Model) -> Model {
    let extended = with(
        model,
        &crate::model::effects::load_inertia::LoadInertia,
        0.0,
    );
    if bench.motion.load_acceleration.is_none() {
        return model.clone();
    }
    let gain = Gain::of(&bench.fit(model), &bench.fit(&extended));
    if gain.share >= SHARE && gain.t >= T[0].1 {
        extended
    } else {
        model.clone()
    }
}

/// What stood at the start of a selection, and is not removed.
struct Start {
    terms: usize,
    delay: bool,
    saturation: bool,
    model: Model,
}

/// Drops what the later ones have made superfluous.
fn remove(bench: &Bench<'_>, selection: &mut Selection, start: &Start) {
    let matters = |without: &Model, full: &Model| {
        let gain = Gain::of(&bench.fit(without), &bench.fit(full));
        gain.share >= SHARE && gain.percent >= PERCENT
    };
    let mut at = start.terms;
    while at < selection.model.terms.len() {
        let mut without = selection.model.clone();
        let name = without.terms.remove(at).effect.name();
        if matters(&without, &selection.model) {
            at += 1;
            continue;
        }
        selection.model = without;
        if !selection.model.has(name) {
            selection.found.retain(|found| *found != name);
            selection.nameless.retain(|found| *found != name);
        }
    }
    let undelayed = Model {
        delay_s: 0.0,
        ..selection.model.clone()
    };
    if !start.delay && selection.model.delay_s != 0.0 && !matters(&undelayed, &selection.model) {
        selection.found.retain(|found| *found != "delay");
        selection.model = undelayed;
    }
    let ideal = Model {
        saturation: Saturation::default(),
        ..selection.model.clone()
    };
    if !start.saturation && selection.model.saturates() && !matters(&ideal, &selection.model) {
        selection
            .found
            .retain(|found| *found != "torque_saturation");
        selection.model = ideal;
    }
}

/// The usual model, without selection.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Plain {
    /// Moved mass.
    pub inertia: f64,
    /// Viscous friction.
    pub viscous: f64,
    /// Coulomb friction.
    pub coulomb: f64,
}

/// Plain least squares on inertia, velocity, direction and a constant; for physical tests and start
/// values.
#[must_use]
pub(crate) fn plain_fit(motion: &Kinematics) -> Plain {
    let lp = |column: &[f64]| motion.low_passed(column);
    let ones = vec![1.0; motion.len()];
    let columns = [
        lp(&motion.acceleration),
        lp(&motion.velocity),
        lp(&motion.direction),
        ones,
    ];
    let views: Vec<&[f64]> = columns.iter().map(Vec::as_slice).collect();
    let fit = Blocks::new(&views, &motion.effort_lp, &motion.fitted, motion.period_s).fit();
    match fit.coefficients[..] {
        [inertia, viscous, coulomb, _] => Plain {
            inertia,
            viscous,
            coulomb,
        },
        _ => Plain {
            inertia: f64::INFINITY,
            viscous: 0.0,
            coulomb: 0.0,
        },
    }
}
