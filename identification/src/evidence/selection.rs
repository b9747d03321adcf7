//! Forward selection with joint refinement and removal, on held-out blocks.
//!
//! Thresholds. A candidate must remove a share of the held-out error (relevance), be large enough
//! to matter to the axis (percent of effort), and do so in more blocks than chance (t). Share is
//! what separates: on 14 simulated records with nothing missing the largest false share was 0.016;
//! t alone does not (false candidates reached 14, because gains sit in few blocks). Figures:
//! docs/identification.md.

use axis_model::EffectName;

use crate::fit::bench::Bench;
use crate::fit::blocks::{Blocks, Fit, Gain};
use crate::fit::fitted::{Estimate, Fitted};
use crate::fit::tuning::{self, Pair};
use crate::model::effects::{self, Effect, LIBRARY, Setting};
use crate::model::inverse::{Model, Origin, Part};
use crate::model::name::Called;
use crate::motion::kinematics::Kinematics;

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
    pub effect: Called,
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
    /// All candidates of all rounds.
    pub scored: Vec<Scored>,
}

impl Selection {
    /// Accepted effects, in the order in which they were found.
    #[must_use]
    pub(crate) fn found(&self) -> Vec<EffectName> {
        self.model
            .found()
            .into_iter()
            .filter_map(Called::name)
            .collect()
    }

    /// Structures without a name that were found.
    #[must_use]
    pub(crate) fn nameless(&self) -> Vec<Called> {
        let found = self.model.found().into_iter();
        found.filter(|called| called.name().is_none()).collect()
    }
}

/// Forward selection on a record, from the declared model. `progress` hears of every round.
pub(crate) fn select(pair: Pair<'_>, start: Model, progress: &mut dyn FnMut(&str)) -> Selection {
    let mut selection = Selection {
        model: start,
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
            selection.model = model.clone();
        }
        selection
            .scored
            .extend(candidates.into_iter().map(|(scored, _)| scored));
        if best.is_none() {
            break;
        }
        tuning::refine(pair, &mut selection.model);
    }
    remove(pair.bench, &mut selection.model);
    selection
}

/// Everything that a model could have besides, judged.
fn candidates(pair: Pair<'_>, model: &Model, round: usize) -> Vec<(Scored, Model)> {
    let bench = pair.bench;
    let base = bench.cross_validate(model);
    let residual = bench.residual(&bench.fit(model));
    let setting = Setting {
        dataset: bench.dataset,
        residual: &residual,
    };
    LIBRARY
        .into_iter()
        .filter(|effect| effect.repeats() || !model.has(effect.called()))
        .filter_map(|effect| candidate(pair, model, &base, effect, &setting, round))
        .collect()
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
    let certain = || {
        let estimates = bench.estimates(&bench.fit(model));
        estimates.last().is_some_and(Estimate::is_certain)
    };
    scored.gain.t >= CERTAIN_T || certain()
}

/// Drops effects that make the error on another record larger by more than a little: what holds on
/// one record only is no effect of the axis.
pub(crate) fn veto(bench: &Bench<'_>, other: &Bench<'_>, model: &mut Model) {
    let error = |model: &Model| other.force_error_percent(&bench.fit(model));
    prune(model, &|full, without| error(full) <= VETO * error(without));
}

/// Drops what the later ones have made superfluous.
fn remove(bench: &Bench<'_>, model: &mut Model) {
    prune(model, &|full, without| {
        let gain = Gain::of(&bench.cross_validate(without), &bench.cross_validate(full));
        gain.share >= SHARE && gain.percent >= PERCENT
    });
}

/// Drops the parts that were found and, one after the other, are not worth keeping: `keeps` is
/// asked with the full model and with the model without the part.
fn prune(model: &mut Model, keeps: &dyn Fn(&Model, &Model) -> bool) {
    let asked: Vec<Part> = model
        .outwards()
        .into_iter()
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

/// Whether a gain is relevant, large enough to matter to the axis, and more than chance.
#[must_use]
pub(crate) fn is_enough(gain: &Gain) -> bool {
    gain.percent >= PERCENT
        && T.iter()
            .any(|(from, smallest)| gain.share >= *from && gain.t >= *smallest)
}

fn candidate(
    pair: Pair<'_>,
    model: &Model,
    base: &Fit,
    effect: &'static dyn Effect,
    setting: &Setting<'_>,
    round: usize,
) -> Option<(Scored, Model)> {
    let extended = tuning::extended(pair, model, effect, setting)?;
    let parameter = extended.parts.last()?.parameter;
    let fit = pair.bench.cross_validate(&extended);
    let mut gain = Gain::of(base, &fit);
    if effect.is_judged_slow_too() {
        let low = tuning::settled(pair.low, extended.clone(), effect);
        let slow = Gain::of(
            &pair.low.cross_validate(model),
            &pair.low.cross_validate(&low),
        );
        gain.share = gain.share.min(slow.share);
        gain.t = gain.t.min(slow.t);
    }
    let fitted = Fitted::new(extended, &fit.coefficients);
    let scored = Scored {
        effect: effect.called(),
        parameter,
        gain,
        physical: is_physical(effect, parameter, &fitted),
        accepted: false,
        nameless: effect.is_nameless(),
        round,
    };
    Some((scored, fitted.into_model()))
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

/// The model with the load's own inertia, where that lowers the held-out error: for an axis whose
/// load moves otherwise than its motor.
#[must_use]
pub(crate) fn with_load_inertia(bench: &Bench<'_>, model: &Model) -> Model {
    let extended = model.with(Part::found(&effects::load_inertia::LoadInertia, 0.0));
    if bench.motion.load_acceleration.is_none() {
        return model.clone();
    }
    let gain = Gain::of(
        &bench.cross_validate(model),
        &bench.cross_validate(&extended),
    );
    if gain.share >= SHARE && gain.t >= T[0].1 {
        extended
    } else {
        model.clone()
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
