//! What the effort of moving samples lacks.
//!
//! Candidates are all effects of the library that the model does not have. Each is judged on
//! held-out blocks with its nonlinear parameter at its best; delay and saturation must hold at the
//! lower cut-off too. What later effects made superfluous is removed again, and so is what makes
//! another record worse.
//!
//! Some effects have rivals ([`Effect::rivals`]): what looks like a change over time is often slow
//! motion that came first. Such an effect must beat its rival, at the rival's own best, by the rule
//! by which an effect beats no effect.
//!
//! The nearest outsiders ([`Effect::is_nearest_outsider`]) never replace a listed name that is as
//! good. First only what the listed effects leave is open to them. Where one of them explains some
//! of that, all compete from the start, and in each round an outsider must beat the best listed
//! candidate by the rule by which an effect beats no effect ([`is_enough`]). Of the two models the
//! second is taken, unless the first beats it by the same rule. Where none came in, but one removed
//! more than every listed effect of its round, the second is taken where it beats the first.
//!
//! Some effects have look-alikes ([`Effect::look_alikes`]): a payload without its mass is a brake
//! that drags. While something else is still missing, what tells the two apart is small beside the
//! rest. So an effect may come in where it leaves less than its look-alikes do, and in the end it
//! must beat them by the rule: where it does not, the selection is done again without it.

use std::cmp::Ordering;

use axis_model::EffectName;

use crate::evidence::few_periods::{beats_smooth, unearned};
use crate::evidence::forms::{self, beats};
use crate::evidence::look_alikes::{as_look_alikes, looks_like_another};
use crate::evidence::selection::{
    self, Candidate, Output, Scored, Selection, is_enough, is_large_outside,
};
use crate::evidence::thresholds::{
    BOTH_ALIKE, BOTH_APART, BOTH_SHARE, CERTAIN_T, EFFORT_PERCENT, EFFORT_SHARE, LOAD_INERTIA,
    NAMELESS_SHARE,
};
use crate::fit::bench::Bench;
use crate::fit::blocks::{Fit, Gain};
use crate::fit::fitted::{Estimate, Fitted};
use crate::fit::side_by_side::side_by_side;
use crate::fit::tuning::{self, Pair, SMOOTH_DEGREE};
use crate::model::effects::load_inertia::LoadInertia;
use crate::model::effects::{self, Effect, LIBRARY, Setting};
use crate::model::inverse::{Model, Origin, Part};
use crate::model::name::Called;
use crate::progress::Step;
use crate::record::rounding;

/// The effort of moving samples.
struct Effort<'a> {
    /// At both cut-offs.
    pair: Pair<'a>,
    /// When the nearest outsiders may come in.
    outsiders: Outsiders,
    /// Effects that may not come in with few periods: they have not earned their names.
    closed: Vec<Called>,
    /// Effects that may not come in at all: something that looks like them is as good.
    refused: Vec<Called>,
}

/// When the nearest outsiders may come in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Outsiders {
    /// Where no listed effect is accepted any more.
    Last,
    /// Where they beat every listed effect of the round.
    Compete,
}

/// Forward selection from the declared model, and removal of what is superfluous in the end.
/// `progress` hears of every effect.
pub(crate) fn select(pair: Pair<'_>, start: &Model, progress: &mut dyn FnMut(&Step)) -> Selection {
    let mut selected = |outsiders: Outsiders| {
        let mut output = Effort {
            pair,
            outsiders,
            closed: Vec::new(),
            refused: Vec::new(),
        };
        loop {
            let selection = select_on(&output, start.clone(), progress);
            if let Some(called) = unearned(pair.bench, &selection.model) {
                output.closed.push(called);
            } else if let Some(called) = looks_like_another(pair.bench, &selection.model) {
                output.refused.push(called);
            } else {
                return selection;
            }
        }
    };
    let listed_first = selected(Outsiders::Last);
    let has_outsider = has_outsider(&listed_first.model);
    if !has_outsider && !passed_over(&listed_first.scored) {
        return listed_first;
    }
    let together = selected(Outsiders::Compete);
    let [first, second] = [&listed_first, &together].map(|selection| &selection.model);
    let is_second = if has_outsider {
        !beats(pair.bench, first, second)
    } else {
        beats(pair.bench, second, first)
    };
    if is_second { together } else { listed_first }
}

/// Whether an outsider that is large enough removed more than every listed effect of its round.
fn passed_over(scored: &[Scored]) -> bool {
    let is_outsider = |one: &&Scored| {
        let effect = effects::find(one.effect);
        effect.is_some_and(Effect::is_nearest_outsider)
    };
    let mut outsiders = scored.iter().filter(is_outsider);
    outsiders.any(|outsider| {
        let rest = |one: &Scored| 1.0 - one.gain.share;
        let is_better = |other: &Scored| {
            other.round != outsider.round
                || !other.physical
                || rest(outsider) < (1.0 - EFFORT_SHARE) * rest(other)
        };
        let mut listed = scored.iter().filter(|one| !is_outsider(one));
        let is_large = is_enough(&outsider.gain) && is_large_outside(&outsider.gain);
        outsider.physical && is_large && listed.all(is_better)
    })
}

fn select_on(output: &Effort<'_>, start: Model, progress: &mut dyn FnMut(&Step)) -> Selection {
    let mut heard = |scored: &Scored| {
        progress(&Step::Found {
            effect: scored.effect.to_string(),
            percent: 100.0 * scored.gain.share,
            round: scored.round,
        });
    };
    let mut selection = selection::select(output, start, &mut heard);
    remove(output.pair, &mut selection.model);
    selection
}

/// Whether what came in last need not earn its name yet. A wave of few periods whose period was
/// searched must, at once: any curve over the position is a sum of such waves, and it takes long to
/// refuse them together.
fn may_wait_for_its_name(bench: &Bench<'_>, model: &Model) -> bool {
    let effect = last(model).effect;
    let is_searched = effect.smooth().is_some() && effect.is_tuned();
    !is_searched || unearned(bench, model).is_none()
}

fn has_outsider(model: &Model) -> bool {
    let found = |part: &&Part| part.origin == Origin::Found;
    let mut found = model.parts.iter().filter(found);
    found.any(|part| part.effect.is_nearest_outsider())
}

impl Output for Effort<'_> {
    type Model = Model;

    fn candidates(&self, model: &Model, round: usize) -> Vec<Candidate<Model>> {
        let bench = self.pair.bench;
        let base = bench.cross_validate(model);
        let residual = bench.residual(&Fitted::new(model.clone(), &base.coefficients));
        let setting = Setting {
            dataset: bench.dataset,
            residual: &residual,
        };
        let open = |effect: &&'static dyn Effect| {
            model.is_open_to(*effect) && !self.refused.contains(&effect.called())
        };
        let extended = |model: &Model, effect| tuning::extended(self.pair, model, effect, &setting);
        let judged = |extended: Model| self.judged(model, &base, extended, round);
        let candidate = |effect: &&'static dyn Effect| {
            let few = effect.with_few_periods().iter();
            let few = few.filter(|few| !self.closed.contains(&few.called()));
            let all = std::iter::once(effect).chain(few);
            let once = all.filter_map(|effect| extended(model, *effect).map(judged));
            let once = once.max_by(better)?;
            let is_first = effect.comes_and_goes() && !model.has(effect.called());
            if !is_first || self.accepts(&once) {
                return Some(once);
            }
            let twice = extended(&once.model, *effect).map(judged);
            let is_clear = |twice: &Candidate<Model>| {
                twice.scored.gain.share >= BOTH_SHARE
                    && self.accepts(twice)
                    && self.goes_again(twice)
            };
            Some(twice.filter(is_clear).unwrap_or(once))
        };
        let all: Vec<&'static dyn Effect> = LIBRARY.into_iter().filter(open).collect();
        side_by_side(&all, candidate)
            .into_iter()
            .flatten()
            .collect()
    }

    fn accepts(&self, candidate: &Candidate<Model>) -> bool {
        let scored = &candidate.scored;
        let is_large = scored.effect.name().is_some() || scored.gain.share >= NAMELESS_SHARE;
        let is_large = is_large && (!is_outsider(candidate) || is_large_outside(&scored.gain));
        scored.physical
            && is_large
            && is_enough(&scored.gain)
            && self.is_beyond_rounding(&scored.gain)
            && is_certain(
                self.pair.bench,
                &candidate.model,
                last(&candidate.model),
                &scored.gain,
            )
    }

    fn best(&self, candidates: &[Candidate<Model>]) -> Option<usize> {
        let of = |outsider: bool| {
            let is_one = move |place: &usize| is_outsider(&candidates[*place]) == outsider;
            let places = (0..candidates.len()).filter(is_one);
            places
                .filter(|place| self.accepts(&candidates[*place]))
                .filter(|place| self.beats_rivals(&candidates[*place].model, candidates))
        };
        let listed = of(false).next();
        match (self.outsiders, listed) {
            (Outsiders::Last, Some(_)) => listed,
            (Outsiders::Last, None) => of(true).next(),
            (Outsiders::Compete, _) => {
                let wins = |place: &usize| {
                    let rival = listed.map(|listed| &candidates[listed].model);
                    let own = &candidates[*place].model;
                    rival.is_none_or(|rival| beats(self.pair.bench, own, rival))
                };
                of(true).find(wins).or(listed)
            }
        }
    }

    fn refined(&self, model: Model) -> Model {
        forms::refined(self.pair, model)
    }
}

impl Effort<'_> {
    /// Whether a gain is more than the rounding of the effort can imitate.
    fn is_beyond_rounding(&self, gain: &Gain) -> bool {
        let Bench {
            dataset, motion, ..
        } = self.pair.bench;
        let rows = motion.fitted.iter().filter(|inside| **inside).count() as f64;
        let rounding = rounding::rms(rounding::step(&dataset.train.effort));
        gain.removed >= rows * rounding.powi(2)
    }

    /// Judges a model with one part more than another.
    fn judged(&self, model: &Model, base: &Fit, extended: Model, round: usize) -> Candidate<Model> {
        let fit = self.pair.bench.cross_validate(&extended);
        let fitted = Fitted::new(extended, &fit.coefficients);
        let extended = fitted.model();
        let Part {
            effect, parameter, ..
        } = *last(extended);
        let mut gain = Gain::of(base, &fit);
        if effect.is_judged_slow_too() {
            gain = gain.smaller(&self.gain_at_low_cutoff(model, extended, effect));
        }
        let scored = Scored {
            effect: effect.called(),
            parameter,
            gain,
            physical: is_physical(effect, parameter, &fitted)
                && self.leaves_less_than_look_alikes(extended)
                && self.beats_smooth(model, extended)
                && may_wait_for_its_name(self.pair.bench, extended),
            accepted: false,
            round,
        };
        Candidate {
            scored,
            model: fitted.into_model(),
        }
    }

    /// Whether the last two parts of a model are one thing that comes and goes: what one brings the
    /// other takes away, and it stays long enough.
    fn goes_again(&self, candidate: &Candidate<Model>) -> bool {
        let bench = self.pair.bench;
        let fitted = bench.fit(&candidate.model);
        let mut last = fitted.terms().rev();
        let (Some(one), Some(other)) = (last.next(), last.next()) else {
            return false;
        };
        let [brought, taken] = [one, other].map(|term| term.own[0]);
        let stays_s = (one.part.parameter - other.part.parameter).abs();
        let largest = brought.abs().max(taken.abs());
        (brought + taken).abs() <= BOTH_ALIKE * largest
            && stays_s >= BOTH_APART * bench.motion.duration_s()
    }

    /// Whether the last part of a model leaves less than everything that nearly looks like it.
    fn leaves_less_than_look_alikes(&self, model: &Model) -> bool {
        let bench = self.pair.bench;
        let mut others = as_look_alikes(model, last(model).effect);
        others.all(|other| forms::gain(bench, model, &other).share > 0.0)
    }

    /// Whether the last part of a model beats a smooth function of the position, where it has to:
    /// one with as many coefficients where the effect is declared, so that its name is not the
    /// question.
    fn beats_smooth(&self, model: &Model, extended: &Model) -> bool {
        let effect = last(extended).effect;
        let is_declared = effect.called().is_declared_in(self.pair.bench.dataset);
        let degree = if is_declared { 2.0 } else { SMOOTH_DEGREE };
        effect.smooth().is_none_or(|smooth| {
            let with_smooth = model.with(Part::found(smooth, degree));
            beats_smooth(self.pair.bench, extended, &with_smooth)
        })
    }

    /// Whether the last part of a model beats the candidates that it has to.
    fn beats_rivals(&self, model: &Model, candidates: &[Candidate<Model>]) -> bool {
        let rivals = last(model).effect.rivals();
        let is_rival = |other: &&Candidate<Model>| {
            let called = other.scored.effect.name();
            other.scored.physical && called.is_some_and(|name| rivals.contains(&name))
        };
        let mut rivals = candidates.iter().filter(is_rival);
        rivals.all(|rival| beats(self.pair.bench, model, &rival.model))
    }

    fn gain_at_low_cutoff(&self, model: &Model, extended: &Model, effect: &dyn Effect) -> Gain {
        let low = self.pair.low;
        let extended = tuning::settled(low, extended.clone(), effect);
        Gain::of(&low.cross_validate(model), &low.cross_validate(&extended))
    }
}

/// Of two candidates for one effect: first whether it can be this effect, then what it removes.
fn better(a: &Candidate<Model>, b: &Candidate<Model>) -> Ordering {
    let (a, b) = (&a.scored, &b.scored);
    let physical = a.physical.cmp(&b.physical);
    physical.then(a.gain.share.total_cmp(&b.gain.share))
}

fn is_outsider(candidate: &Candidate<Model>) -> bool {
    last(&candidate.model).effect.is_nearest_outsider()
}

/// The part that came in last.
fn last(model: &Model) -> &Part {
    model.parts.last().expect("an extended model has a part")
}

/// Whether the last part of a fitted model can be its effect.
fn is_physical(effect: &dyn Effect, parameter: f64, fitted: &Fitted) -> bool {
    // Without friction of its kind in the model nothing is too large beside it.
    let first = |name| {
        let own = fitted.of(name).and_then(<[f64]>::first);
        own.copied().unwrap_or(f64::INFINITY)
    };
    let own = fitted.terms().next_back().map_or(&[][..], |term| term.own);
    effect.is_physical(&effects::Fitted {
        parameter,
        own,
        inertia: first(EffectName::Inertia),
        coulomb: first(EffectName::Coulomb),
        viscous: first(EffectName::Viscous),
    })
}

/// Drops what the later ones have made superfluous.
///
/// A part that came in early may hold the others where they would not be without it. So the model
/// without it is refined before it is asked whether it is as good.
fn remove(pair: Pair<'_>, model: &mut Model) {
    let bench = pair.bench;
    let without = |model: &Model, part: &Part| {
        let mut without = model.without(part);
        tuning::refine(pair, &mut without);
        without
    };
    prune(model, &without, &|full, without, part| {
        let gain = forms::gain(bench, full, without);
        is_worth_keeping(&gain) && is_certain(bench, full, part, &gain)
    });
}

/// The parts of a model that were found, from the outside inwards.
fn parts_found(model: &Model) -> Vec<Part> {
    let outwards = model.outwards().into_iter();
    outwards
        .map(|place| model.parts[place].clone())
        .filter(|part| part.origin == Origin::Found)
        .collect()
}

/// Whether a part of a model differs from zero: its interval is asked where its gain sits in few
/// blocks.
fn is_certain(bench: &Bench<'_>, model: &Model, part: &Part, gain: &Gain) -> bool {
    let of_part = |one: &Estimate| one.part.is_same(part);
    let differs = || {
        let estimates = bench.estimates(&bench.fit(model)).into_iter();
        estimates.filter(of_part).all(|one| one.is_certain())
    };
    gain.t >= CERTAIN_T || differs()
}

/// Whether a part that was accepted still removes enough.
fn is_worth_keeping(gain: &Gain) -> bool {
    gain.share >= EFFORT_SHARE && gain.percent >= EFFORT_PERCENT
}

/// Drops the parts that were found and, one after the other, are not worth keeping. `without` takes
/// a part out of a model; `keeps` is asked with the full model, the one without, and the part.
pub(crate) fn prune(
    model: &mut Model,
    without: &dyn Fn(&Model, &Part) -> Model,
    keeps: &dyn Fn(&Model, &Model, &Part) -> bool,
) {
    let mut place = 0;
    while let Some(part) = parts_found(model).get(place) {
        let without = without(model, part);
        if keeps(model, &without, part) {
            place += 1;
        } else {
            *model = without;
        }
    }
}

/// The model with the load's own inertia, where that lowers the held-out error: for an axis whose
/// load moves otherwise than its motor.
#[must_use]
pub(crate) fn with_load_inertia(bench: &Bench<'_>, model: &Model) -> Model {
    with_inertia_of_the_load(bench, model, Part::found(&LoadInertia, 0.0))
}

/// Whether the load's own inertia would lower the held-out error of a model.
pub(crate) fn lacks_load_inertia(bench: &Bench<'_>, model: &Model) -> bool {
    with_load_inertia(bench, model).parts.len() > model.parts.len()
}

/// A model with the load's own inertia as a part that is not asked whether it may stay.
#[must_use]
pub(crate) fn with_load(bench: &Bench<'_>, model: &Model) -> Model {
    with_inertia_of_the_load(bench, model, Part::declared(&LoadInertia, 0.0))
}

/// A model without the load's own inertia.
#[must_use]
pub(crate) fn without_load(model: &Model) -> Model {
    model.without(&Part::declared(&LoadInertia, 0.0))
}

/// The declared model with the load's own inertia, where a load that moves otherwise than its motor
/// is declared too: without it what fast motion lacks looks like a change of everything else.
#[must_use]
pub(crate) fn with_declared_load(bench: &Bench<'_>, declared: &Model) -> Model {
    let apart = [EffectName::Compliance, EffectName::Backlash];
    if apart.iter().any(|name| bench.dataset.declares(*name)) {
        with_load(bench, declared)
    } else {
        declared.clone()
    }
}

fn with_inertia_of_the_load(bench: &Bench<'_>, model: &Model, part: Part) -> Model {
    if bench.motion.load_acceleration.is_none() || model.has(part.called()) {
        return model.clone();
    }
    let extended = model.with(part);
    let gain = Gain::of(
        &bench.cross_validate(model),
        &bench.cross_validate(&extended),
    );
    if moves_otherwise(&gain) {
        extended
    } else {
        model.clone()
    }
}

/// Drops what the load's own inertia makes superfluous; says whether anything went. A load that
/// moves otherwise than its motor looks like a shift in time until its inertia is in the model.
pub(crate) fn remove_beside_load(bench: &Bench<'_>, model: &mut Model) -> bool {
    let before = model.parts.len();
    let error = |model: &Model| bench.cross_validate(&with_load_inertia(bench, model));
    prune(model, &Model::without, &|full, without, _| {
        is_worth_keeping(&Gain::of(&error(without), &error(full)))
    });
    model.parts.len() < before
}

/// Whether the load's own inertia lowers the error enough to come in.
fn moves_otherwise(gain: &Gain) -> bool {
    let (share, t) = LOAD_INERTIA;
    gain.share >= share && gain.t >= t
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::made::{Axis, axis, found, model, on, usual};
    use crate::motion::kinematics::Kinematics;
    use crate::simulate::made;
    use EffectName::{
        Coulomb, Delay, FrictionDrift, Inertia, Offset, Payload, QuadraticDrag, Stribeck,
        TorqueConstantRipple, TorqueRipple, Viscous, ViscousAsymmetry,
    };
    use std::f64::consts::{PI, TAU};

    const DECLARED: [EffectName; 4] = [Inertia, Viscous, Coulomb, Offset];

    const fn effort(pair: Pair<'_>) -> Effort<'_> {
        Effort {
            pair,
            outsiders: Outsiders::Last,
            closed: Vec::new(),
            refused: Vec::new(),
        }
    }

    /// An axis with 60 N s/m more in one direction than in the other.
    fn asymmetric() -> Axis {
        axis(|motion, row| usual(motion, row) + 60.0 * motion.velocity[row].abs())
    }

    fn kept(start: &Model, keeps: &dyn Fn(&Model, &Model) -> bool) -> Vec<&'static str> {
        let mut model = start.clone();
        prune(&mut model, &Model::without, &|full, without, _| {
            keeps(full, without)
        });
        let parts = model.parts.iter();
        parts.map(|part| part.called().as_str()).collect()
    }

    #[test]
    fn only_what_was_found_is_asked_and_each_part_against_what_is_left() {
        let full = model(&[Inertia, Coulomb])
            .with(found(Delay, 1.0e-3))
            .with(found(Stribeck, 0.01))
            .with(found(TorqueRipple, 100.0));
        assert_eq!(kept(&full, &|_, _| false), ["inertia", "coulomb"]);
        assert_eq!(kept(&full, &|_, _| true).len(), 5);
        // Forces are asked first, the delay last.
        let three = |_: &Model, without: &Model| without.parts.len() < 3;
        assert_eq!(kept(&full, &three), ["inertia", "coulomb", "delay"]);
    }

    #[test]
    fn a_part_that_removes_nothing_goes_and_one_that_does_stays() {
        let axis = asymmetric();
        let mut full = model(&DECLARED)
            .with(found(ViscousAsymmetry, 0.0))
            .with(found(QuadraticDrag, 0.0));
        let bench = axis.bench();
        let pair = Pair {
            bench: &bench,
            low: &bench,
        };
        remove(pair, &mut full);
        assert_eq!(full.found(), [ViscousAsymmetry]);
    }

    #[test]
    fn what_only_stands_for_a_load_that_moves_otherwise_goes() {
        let mut axis = asymmetric();
        // The load swings about the motor, with 40 of 90 kg.
        let swing = |row: usize| 3.0 * (50.0 * 1.0e-3 * row as f64).sin();
        axis.motion.load_acceleration = Some((0..axis.motion.len()).map(swing).collect());
        axis.put(|motion, row| {
            let asymmetry = 60.0 * motion.velocity[row].abs();
            usual(motion, row) + asymmetry + 40.0 * swing(row)
        });
        let mut full = model(&DECLARED)
            .with(found(ViscousAsymmetry, 0.0))
            .with(found(QuadraticDrag, 0.0));
        assert!(remove_beside_load(&axis.bench(), &mut full));
        assert_eq!(full.found(), [ViscousAsymmetry]);
        assert!(!remove_beside_load(&axis.bench(), &mut full));
    }

    #[test]
    fn what_is_put_in_is_found_and_nothing_else() {
        let axis = asymmetric();
        let bench = axis.bench();
        let pair = Pair {
            bench: &bench,
            low: &bench,
        };
        let (mut said, mut percents) = (Vec::new(), Vec::new());
        let selection = select(pair, &model(&DECLARED), &mut |step| {
            said.push(step.to_string());
            if let Step::Found { percent, round, .. } = step {
                percents.push((*percent, *round));
            }
        });
        let accepted = selection.scored.iter().filter(|scored| scored.accepted);
        let accepted: Vec<(f64, usize)> = accepted
            .map(|scored| (100.0 * scored.gain.share, scored.round))
            .collect();
        assert_eq!(percents, accepted);
        assert!((90.0..100.0).contains(&percents[0].0), "{percents:?}");
        assert_eq!(selection.found(), [ViscousAsymmetry]);
        assert_eq!(selection.nameless().count(), 0);
        assert!(
            said[0].starts_with("viscous_asymmetry removes "),
            "{said:?}"
        );
    }

    /// 20 s there and back, to other ends each time.
    fn wandering() -> Axis {
        let path = |t: f64| {
            let sines = [(0.02, 3.0), (0.012, 4.7), (0.004, 11.0), (0.01, 0.83)];
            sines.map(|(x, w)| x * (w * t).sin()).iter().sum()
        };
        let rows = 0..20_000;
        on(made::record(
            1.0e-3,
            rows.map(|row| path(1.0e-3 * f64::from(row))).collect(),
        ))
    }

    /// Turns within the travel where nothing tells how long one is: the order of a ripple is then
    /// its number of periods.
    const UNKNOWN: f64 = 1.0;

    /// What is found on an axis that turns so often within its travel, with a force over position,
    /// −1…1, and the order of each ripple.
    fn found_over(turns: f64, force: impl Fn(f64) -> f64) -> (Vec<Called>, Vec<f64>) {
        found_on(turns, |motion, row, u| usual(motion, row) + force(u))
    }

    fn found_on(
        turns: f64,
        law: impl Fn(&Kinematics, usize, f64) -> f64,
    ) -> (Vec<Called>, Vec<f64>) {
        let mut axis = wandering();
        let (low, high) = axis.motion.span();
        let u = |x: f64| (2.0 * x - low - high) / (high - low);
        let noise = |row: usize| 0.2 * (0.37 * (row * row % 1013) as f64).sin();
        axis.put(|motion, row| law(motion, row, u(motion.position_lp[row])) + noise(row));
        let lead = (high - low) / turns;
        axis.dataset.lead_m_per_rev = Some(lead).filter(|_| turns != UNKNOWN);
        let bench = axis.bench();
        let pair = Pair {
            bench: &bench,
            low: &bench,
        };
        let model = select(pair, &model(&DECLARED), &mut |_| ()).model;
        let waves = model
            .parts
            .iter()
            .filter(|part| part.effect.smooth().is_some());
        let orders = waves.map(|part| part.parameter * lead).collect();
        (model.found(), orders)
    }

    /// What is found on the wandering axis, whose effort is also given the time.
    fn found_with(law: impl Fn(&Kinematics, usize, f64) -> f64) -> Model {
        let mut axis = wandering();
        let noise = |row: usize| 0.2 * (0.37 * (row * row % 1013) as f64).sin();
        axis.put(|motion, row| law(motion, row, motion.time_s[row]) + noise(row));
        let bench = axis.bench();
        let pair = Pair {
            bench: &bench,
            low: &bench,
        };
        select(pair, &model(&DECLARED), &mut |_| ()).model
    }

    #[test]
    fn a_payload_that_is_taken_up_and_put_down_is_found_at_both_times() {
        let loaded = |t: f64| f64::from(u8::from((6.0..14.0).contains(&t)));
        let model = found_with(|motion, row, t| {
            let brings = 60.0 * motion.acceleration[row] + 10.0 * motion.direction[row];
            usual(motion, row) + loaded(t) * brings
        });
        assert_eq!(model.found(), [Payload]);
        let parts = model.parts.iter().filter(|part| part.called() == Payload);
        let mut times_s: Vec<f64> = parts.map(|part| part.parameter).collect();
        times_s.sort_by(f64::total_cmp);
        let both = times_s.iter().zip([6.0, 14.0]);
        assert!(
            times_s.len() == 2 && both.into_iter().all(|(t, is)| (t - is).abs() < 0.05),
            "{times_s:?}"
        );
    }

    #[test]
    fn a_payload_is_told_from_a_brake_and_from_a_warm_up() {
        let from = |t: f64, from_s: f64| f64::from(u8::from(t > from_s));
        let is_found = |law: &dyn Fn(&Kinematics, usize, f64) -> f64| {
            found_with(|motion, row, t| usual(motion, row) + law(motion, row, t))
                .found()
                .contains(&Payload.into())
        };
        // Beside a ripple the mass is small at first.
        let ripple =
            |motion: &Kinematics, row: usize| 12.0 * (2000.0 * motion.position_lp[row]).sin();
        assert!(is_found(&|motion, row, t| {
            let brings = 20.0 * motion.acceleration[row] + 40.0;
            ripple(motion, row) + from(t, 9.0) * brings
        }));
        assert!(!is_found(&|motion, row, t| {
            ripple(motion, row) + from(t, 9.0) * (15.0 * motion.direction[row] + 40.0)
        }));
        assert!(!is_found(&|motion, row, t| {
            let brings = 40.0 * motion.acceleration[row] + 10.0 * motion.direction[row];
            (-t / 9.0).exp() * brings
        }));
    }

    /// A wave of an order on an axis that turns so often within −1…1.
    fn order_of(turns: f64, order: f64, phase: f64) -> impl Fn(f64) -> f64 {
        move |u| (PI * turns * order * u + phase).sin()
    }

    #[test]
    fn a_wave_of_few_periods_is_found_at_its_order_whatever_its_phase() {
        for (turns, order) in [(1.65, 1.0), (3.0, 1.0), (0.32, 18.0), (0.15, 36.0)] {
            for phase in [0.3, 1.9] {
                let wave = order_of(turns, order, phase);
                let (found, orders) = found_over(turns, |u| 5.0 * wave(u));
                assert_eq!(found, [TorqueRipple], "{turns} {order}");
                assert!(
                    orders.len() == 1 && (orders[0] - order).abs() < 1.0e-9,
                    "{orders:?}"
                );
            }
        }
    }

    #[test]
    fn a_wave_of_three_periods_and_more_is_found_where_no_turn_is_known() {
        for periods in [3.1, 4.4, 5.7, 7.6] {
            for phase in [0.3, 1.9] {
                let wave = order_of(UNKNOWN, periods, phase);
                let (found, orders) = found_over(UNKNOWN, |u| 5.0 * wave(u));
                assert_eq!(found, [TorqueRipple], "{periods} {phase}");
                assert!(
                    orders.len() == 1 && (orders[0] / periods - 1.0).abs() < 5.0e-3,
                    "{orders:?} {periods}"
                );
            }
        }
    }

    #[test]
    fn two_waves_of_few_periods_are_found_together_where_no_turn_is_known() {
        let (one, two) = (order_of(UNKNOWN, 3.6, 0.3), order_of(UNKNOWN, 7.2, 2.1));
        let (found, mut periods) = found_over(UNKNOWN, |u| 8.0 * one(u) + 5.0 * two(u));
        periods.sort_by(f64::total_cmp);
        assert_eq!(found, [TorqueRipple]);
        let pairs = periods.iter().zip([3.6, 7.2]);
        assert!(periods.len() == 2, "{periods:?}");
        assert!(
            pairs
                .into_iter()
                .all(|(found, is)| (found / is - 1.0).abs() < 5.0e-3),
            "{periods:?}"
        );
    }

    #[test]
    fn what_is_no_wave_is_no_ripple_where_no_turn_is_known_either() {
        let latch = |u: f64| 40.0 * u * (0.5 - 12.5 * u * u).exp();
        let steps = |u: f64| 6.0 * ((u - 0.3) / 0.05).tanh() + 4.0 * ((u + 0.4) / 0.1).tanh();
        let buffers = |u: f64| 20.0 * (u - 0.7).max(0.0) - 15.0 * (-u - 0.6).max(0.0);
        let knots = |u: f64| 6.0 * (2.3 * u + (7.0 * u).sin() * u).cos();
        let all: [&dyn Fn(f64) -> f64; 4] = [&latch, &steps, &buffers, &knots];
        for (place, force) in all.into_iter().enumerate() {
            let (found, _) = found_over(UNKNOWN, force);
            assert!(!found.contains(&TorqueRipple.into()), "{place}");
        }
    }

    #[test]
    fn two_orders_are_found_together_and_no_spring_stays_that_came_first() {
        let (one, two) = (order_of(1.7, 1.0, 0.3), order_of(1.7, 2.0, 2.1));
        let (found, mut orders) = found_over(1.7, |u| 8.0 * one(u) + 5.0 * two(u));
        orders.sort_by(f64::total_cmp);
        assert_eq!(found, [TorqueRipple]);
        assert!((orders[0] - 1.0).abs() < 1.0e-9 && (orders[1] - 2.0).abs() < 1.0e-9);
        assert_eq!(orders.len(), 2);
    }

    #[test]
    fn a_polynomial_over_position_is_no_ripple_however_often_the_axis_turns() {
        for (turns, own) in [
            (0.3, [5.0, -8.0, 2.0, 7.0]),
            (0.8, [-3.0, 1.0, 9.0, -6.0]),
            (1.4, [0.5, 9.0, -9.0, 1.0]),
            (1.7, [-7.0, 4.0, 6.0, -9.0]),
            (2.2, [8.0, 2.0, -9.0, -4.0]),
            (2.6, [1.0, -9.0, 1.0, 9.0]),
            (3.1, [-9.0, -2.0, 9.0, 3.0]),
            (3.9, [6.0, 6.0, -9.0, -9.0]),
        ] {
            let force = |u: f64| own.iter().rev().fold(0.0, |sum, own| u * (own + sum));
            let (found, _) = found_over(turns, force);
            assert!(!found.contains(&TorqueRipple.into()), "{turns} {own:?}");
        }
    }

    #[test]
    fn a_spring_that_stiffens_a_latch_and_a_pendulum_of_less_than_a_turn_are_no_ripple() {
        let hard = |u: f64| 3.0 * u + 9.0 * u.powi(3);
        let latch = |u: f64| 40.0 * u * (0.5 - 12.5 * u * u).exp();
        let pendulum = |u: f64| 9.0 * (3.0 * u + 0.4).sin();
        for turns in [0.95, 2.2] {
            for force in [&hard as &dyn Fn(f64) -> f64, &latch] {
                let (found, _) = found_over(turns, force);
                assert!(!found.contains(&TorqueRipple.into()), "{turns}");
            }
        }
        let (found, _) = found_over(6.0 / TAU, pendulum);
        assert!(!found.contains(&TorqueRipple.into()));
    }

    #[test]
    fn a_torque_constant_that_ripples_at_a_known_order_is_told_from_friction_that_does() {
        let (turns, order) = (0.22, 7.0);
        let wave = order_of(turns, order, 0.8);
        let (found, orders) = found_on(turns, |motion, row, u| {
            usual(motion, row) / (1.0 + 0.11 * wave(u))
        });
        assert_eq!(found, [TorqueConstantRipple]);
        assert!((orders[0] - order).abs() < 1.0e-9, "{orders:?}");
        let (found, _) = found_on(turns, |motion, row, u| {
            usual(motion, row) + 4.0 * wave(u) * motion.direction[row]
        });
        assert!(
            !found.contains(&TorqueConstantRipple.into()) && !found.contains(&TorqueRipple.into()),
            "{found:?}"
        );
    }

    const fn gain(share: f64, percent: f64, t: f64) -> Gain {
        Gain {
            removed: 1.0,
            share,
            percent,
            t,
        }
    }

    #[test]
    fn a_part_stays_from_a_twentieth_and_0_15_percent_of_the_effort_on() {
        assert!(is_worth_keeping(&gain(0.05, 0.15, 0.0)));
        assert!(!is_worth_keeping(&gain(0.0499, 9.0, 9.0)));
        assert!(!is_worth_keeping(&gain(0.5, 0.149, 9.0)));
    }

    #[test]
    fn the_loads_inertia_comes_in_from_a_twentieth_and_a_t_of_one_on() {
        assert!(moves_otherwise(&gain(0.05, 0.0, 1.0)));
        assert!(!moves_otherwise(&gain(0.0499, 9.0, 9.0)));
        assert!(!moves_otherwise(&gain(0.5, 9.0, 0.99)));
    }

    /// Share of an effect that one axis shows; another one is its record at the lower cut-off.
    fn share_at_both([usual, lower]: [&Axis; 2], part: Part) -> f64 {
        let (bench, low) = (usual.bench(), lower.bench());
        let output = effort(Pair {
            bench: &bench,
            low: &low,
        });
        let declared = model(&DECLARED);
        let base = bench.cross_validate(&declared);
        let judged = output.judged(&declared, &base, declared.with(part), 2);
        assert_eq!((judged.scored.round, judged.scored.accepted), (2, false));
        judged.scored.gain.share
    }

    #[test]
    fn a_delay_and_a_drift_gain_no_more_than_they_do_at_the_lower_cutoff() {
        // What is commanded acts three rows later: the effort is early.
        let late = axis(|motion, row| usual(motion, (row + 3).min(motion.len() - 1)));
        let cold = axis(|motion, row| {
            let fall = (-motion.time_s[row] / 10.0).exp();
            usual(motion, row) + 10.0 * fall * motion.direction[row]
        });
        let neither = axis(usual);
        for (shown, effect, parameter) in [(&late, Delay, 3.0e-3), (&cold, FrictionDrift, 10.0)] {
            let share = |low: &Axis| share_at_both([shown, low], found(effect, parameter));
            assert!(share(shown) > 0.9, "{effect} {}", share(shown));
            assert!(share(&neither) < 0.1, "{effect} {}", share(&neither));
        }
    }

    fn candidate(effect: EffectName, share: f64, t: f64, physical: bool) -> Candidate<Model> {
        Candidate {
            scored: Scored {
                effect: effect.into(),
                parameter: 0.0,
                gain: Gain {
                    removed: 1.0,
                    share,
                    percent: 1.0,
                    t,
                },
                physical,
                accepted: false,
                round: 0,
            },
            model: model(&DECLARED).with(found(effect, 0.0)),
        }
    }

    #[test]
    fn a_drift_of_friction_must_beat_a_stribeck_fall_at_its_own_best() {
        let fall = |motion: &Kinematics, row: usize| {
            let v = motion.velocity[row] / 0.01;
            15.0 * (-v * v).exp() * motion.direction[row]
        };
        let warm_up = |motion: &Kinematics, row: usize| {
            15.0 * (-motion.time_s[row] / 2.0).exp() * motion.direction[row]
        };
        let beats = |law: &dyn Fn(&Kinematics, usize) -> f64| {
            let axis = axis(|motion, row| usual(motion, row) + law(motion, row));
            let bench = axis.bench();
            let output = effort(Pair {
                bench: &bench,
                low: &bench,
            });
            let mut stribeck = candidate(Stribeck, 0.1, 2.0, true);
            stribeck.model = model(&DECLARED).with(found(Stribeck, 0.01));
            let drift = model(&DECLARED).with(found(FrictionDrift, 2.0));
            output.beats_rivals(&drift, &[stribeck])
        };
        assert!(beats(&warm_up) && !beats(&fall));
    }

    #[test]
    fn a_candidate_is_accepted_where_it_is_physical_enough_and_certain() {
        let axis = asymmetric();
        let bench = axis.bench();
        let output = effort(Pair {
            bench: &bench,
            low: &bench,
        });
        let accepts =
            |effect, share, t, physical| output.accepts(&candidate(effect, share, t, physical));
        assert!(accepts(ViscousAsymmetry, 0.06, 3.0, true));
        assert!(!accepts(ViscousAsymmetry, 0.06, 3.0, false));
        assert!(!accepts(ViscousAsymmetry, 0.04, 3.0, true));
        // Below the certain t the interval is asked: one is there, the other is not.
        assert!(accepts(ViscousAsymmetry, 0.5, 2.4, true));
        let nothing = self::axis(usual);
        let bench = nothing.bench();
        let output = effort(Pair {
            bench: &bench,
            low: &bench,
        });
        let doubtful = |t| candidate(QuadraticDrag, 0.5, t, true);
        let interval = bench.estimates(&bench.fit(&doubtful(2.4).model));
        assert_eq!(output.accepts(&doubtful(2.4)), interval[4].is_certain());
        assert!(output.accepts(&doubtful(2.5)));
    }

    #[test]
    fn a_structure_without_a_name_needs_a_larger_share() {
        let axis = asymmetric();
        let bench = axis.bench();
        let output = effort(Pair {
            bench: &bench,
            low: &bench,
        });
        let structure = |share| {
            let mut candidate = candidate(ViscousAsymmetry, share, 5.0, true);
            candidate.scored.effect = crate::model::name::Called::Structure("drifting force");
            output.accepts(&candidate)
        };
        assert!(structure(0.15) && !structure(0.149));
    }

    #[test]
    fn friction_that_is_not_in_the_model_limits_nothing() {
        let own = |names: &[EffectName], coefficients: &[f64]| {
            let with = model(names).with(found(Stribeck, 0.01));
            let stribeck = found(Stribeck, 0.01).effect;
            is_physical(stribeck, 0.01, &Fitted::new(with, coefficients))
        };
        assert!(own(&[Coulomb], &[10.0, 39.0]) && !own(&[Coulomb], &[10.0, 41.0]));
        assert!(own(&[Viscous], &[10.0, 41.0]));
    }

    #[test]
    fn the_loads_own_inertia_comes_in_where_it_lowers_the_error() {
        let mut axis = axis(usual);
        let wave = |row: usize| (0.31 * row as f64).sin();
        let relative: Vec<f64> = (0..6000).map(|row| 0.4 * wave(row)).collect();
        assert_eq!(
            with_load_inertia(&axis.bench(), &model(&DECLARED))
                .parts
                .len(),
            4
        );
        axis.motion.load_acceleration = Some(relative);
        assert_eq!(
            with_load_inertia(&axis.bench(), &model(&DECLARED))
                .parts
                .len(),
            4
        );
        axis.put(|motion, row| {
            usual(motion, row) + 30.0 * 0.4 * wave(row) * f64::from(motion.moving[row])
        });
        let with = with_load_inertia(&axis.bench(), &model(&DECLARED));
        assert_eq!(with.parts.len(), 5);
        let mass = axis.bench().fit(&with).terms().next_back().unwrap().own[0];
        assert!((mass - 30.0).abs() < 3.0, "{mass}");
    }
}
