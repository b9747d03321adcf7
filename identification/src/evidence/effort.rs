//! What the effort of moving samples lacks.
//!
//! Candidates are all effects of the library that the model does not have. Each is judged on
//! held-out blocks with its nonlinear parameter at its best; delay and saturation must hold at the
//! lower cut-off too. What later effects made superfluous is removed again, and so is what makes
//! another record worse.

use axis_model::EffectName;

use crate::evidence::selection::{self, Candidate, Output, Scored, Selection, is_enough};
use crate::evidence::thresholds::{
    CERTAIN_T, EFFORT_PERCENT, EFFORT_SHARE, LOAD_INERTIA, NAMELESS_SHARE, VETO_RATIO,
};
use crate::fit::bench::Bench;
use crate::fit::blocks::{Fit, Gain};
use crate::fit::fitted::{Estimate, Fitted};
use crate::fit::side_by_side::side_by_side;
use crate::fit::tuning::{self, Pair};
use crate::model::effects::load_inertia::LoadInertia;
use crate::model::effects::{self, Effect, LIBRARY, Setting};
use crate::model::inverse::{Model, Origin, Part};

/// The effort of moving samples, at both cut-offs.
struct Effort<'a>(Pair<'a>);

/// Forward selection from the declared model, and removal of what is superfluous in the end.
/// `progress` hears of every effect.
pub(crate) fn select(pair: Pair<'_>, start: Model, progress: &mut dyn FnMut(&str)) -> Selection {
    let mut heard = |scored: &Scored| {
        let percent = 100.0 * scored.gain.share;
        let effect = scored.effect;
        progress(&format!(
            "{effect} removes {percent:.0} % of the held-out residual"
        ));
    };
    let mut selection = selection::select(&Effort(pair), start, &mut heard);
    remove(pair.bench, &mut selection.model);
    selection
}

impl Output for Effort<'_> {
    type Model = Model;

    fn candidates(&self, model: &Model, round: usize) -> Vec<Candidate<Model>> {
        let bench = self.0.bench;
        let base = bench.cross_validate(model);
        let residual = bench.residual(&bench.fit(model));
        let setting = Setting {
            dataset: bench.dataset,
            residual: &residual,
        };
        let open = |effect: &&'static dyn Effect| effect.repeats() || !model.has(effect.called());
        let candidate = |effect: &&'static dyn Effect| {
            let extended = tuning::extended(self.0, model, *effect, &setting)?;
            Some(self.judged(model, &base, extended, round))
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
        scored.physical
            && is_large
            && is_enough(&scored.gain)
            && (scored.gain.t >= CERTAIN_T || is_certain(self.0.bench, &candidate.model))
    }

    fn refined(&self, mut model: Model) -> Model {
        tuning::refine(self.0, &mut model);
        model
    }
}

impl Effort<'_> {
    /// Judges a model with one part more than another.
    fn judged(&self, model: &Model, base: &Fit, extended: Model, round: usize) -> Candidate<Model> {
        let fit = self.0.bench.cross_validate(&extended);
        let fitted = Fitted::new(extended, &fit.coefficients);
        let extended = fitted.model();
        let (effect, parameter) = last(extended);
        let mut gain = Gain::of(base, &fit);
        if effect.is_judged_slow_too() {
            gain = gain.smaller(&self.gain_at_low_cutoff(model, extended, effect));
        }
        let scored = Scored {
            effect: effect.called(),
            parameter,
            gain,
            physical: is_physical(effect, parameter, &fitted),
            accepted: false,
            round,
        };
        Candidate {
            scored,
            model: fitted.into_model(),
        }
    }

    fn gain_at_low_cutoff(&self, model: &Model, extended: &Model, effect: &dyn Effect) -> Gain {
        let low = self.0.low;
        let extended = tuning::settled(low, extended.clone(), effect);
        Gain::of(&low.cross_validate(model), &low.cross_validate(&extended))
    }
}

/// Effect and nonlinear parameter of the part that came in last.
fn last(model: &Model) -> (&'static dyn Effect, f64) {
    let part = model.parts.last().expect("an extended model has a part");
    (part.effect, part.parameter)
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
        coulomb: first(EffectName::Coulomb),
        viscous: first(EffectName::Viscous),
    })
}

/// Whether what was fitted last differs from zero: asked where the gain sits in few blocks.
fn is_certain(bench: &Bench<'_>, model: &Model) -> bool {
    let estimates = bench.estimates(&bench.fit(model));
    estimates.last().is_some_and(Estimate::is_certain)
}

/// Drops effects that make the error on another record larger by more than a little: what holds on
/// one record only is no effect of the axis.
pub(crate) fn veto(bench: &Bench<'_>, other: &Bench<'_>, model: &mut Model) {
    let error = |model: &Model| other.force_error_percent(&bench.fit(model));
    prune(model, &|full, without| {
        error(full) <= VETO_RATIO * error(without)
    });
}

/// Drops what the later ones have made superfluous.
fn remove(bench: &Bench<'_>, model: &mut Model) {
    prune(model, &|full, without| {
        let gain = Gain::of(&bench.cross_validate(without), &bench.cross_validate(full));
        gain.share >= EFFORT_SHARE && gain.percent >= EFFORT_PERCENT
    });
}

/// Drops the parts that were found and, one after the other, are not worth keeping: `keeps` is
/// asked with the full model and with the model without the part.
fn prune(model: &mut Model, keeps: &dyn Fn(&Model, &Model) -> bool) {
    let outwards = model.outwards().into_iter();
    let asked: Vec<Part> = outwards
        .map(|place| model.parts[place].clone())
        .filter(|part| part.origin == Origin::Found)
        .collect();
    for part in asked {
        let without = model.without(&part);
        if !keeps(model, &without) {
            *model = without;
        }
    }
}

/// The model with the load's own inertia, where that lowers the held-out error: for an axis whose
/// load moves otherwise than its motor.
#[must_use]
pub(crate) fn with_load_inertia(bench: &Bench<'_>, model: &Model) -> Model {
    if bench.motion.load_acceleration.is_none() {
        return model.clone();
    }
    let extended = model.with(Part::found(&LoadInertia, 0.0));
    let gain = Gain::of(
        &bench.cross_validate(model),
        &bench.cross_validate(&extended),
    );
    let (share, t) = LOAD_INERTIA;
    if gain.share >= share && gain.t >= t {
        extended
    } else {
        model.clone()
    }
}
