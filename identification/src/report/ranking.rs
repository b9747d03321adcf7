//! The ranking of candidates: each effect once, with the judgement in which it stood best.
//!
//! An effect can be judged on several outputs and in several rounds. What counts is the share of
//! the held-out error that it removes. Accepted effects stand in front.

use std::collections::BTreeSet;

use axis_model::EffectName;

use crate::evidence::findings::Findings;
use crate::evidence::free_run::Judged;
use crate::evidence::reversal::bristle::Bristle;
use crate::evidence::reversal::{self, Presliding};
use crate::evidence::selection::Scored;
use crate::fit::bench::Bench;
use crate::fit::tuning::settled;
use crate::model::effects::find;
use crate::model::inverse::{Model, Part};
use crate::report::forms::Candidate;

pub(crate) const EFFORT: &str = "effort of moving samples";
pub(crate) const ABOUT_REVERSALS: &str = "effort about reversals";
pub(crate) const ABOUT_FAST_REVERSALS: &str = "effort about fast reversals";
pub(crate) const FREE_RUN: &str = "free-run position";
pub(crate) const DIFFERENCE: &str = "motor - load position";

/// Every candidate once, where it stood best; accepted ones first.
pub(crate) fn candidates(findings: &Findings<'_>) -> Vec<Candidate> {
    let mut list = on_effort(findings);
    list.extend(on_reversals(findings));
    list.extend(gap_on_reversals(findings));
    list.extend(on_free_run(findings));
    list.extend(on_difference(findings));
    list.extend(about_fast_reversals(findings));
    let names = findings.found.names();
    for candidate in &mut list {
        candidate.accepted = names.iter().any(|name| name.as_str() == candidate.effect);
    }
    ranked(list)
}

/// One line for each effect, the judgement that removes most; accepted ones first, then by share.
fn ranked(mut list: Vec<Candidate>) -> Vec<Candidate> {
    list.sort_by(|a, b| b.share.total_cmp(&a.share));
    let mut seen = BTreeSet::new();
    list.retain(|candidate| seen.insert(candidate.effect.clone()));
    // A stable sort: shares stay in order.
    list.sort_by_key(|candidate| !candidate.accepted);
    list
}

/// The best round of each effect.
fn on_effort(findings: &Findings<'_>) -> Vec<Candidate> {
    let (dataset, mut best) = (findings.dataset, Vec::<Candidate>::new());
    let declared = findings.models.declared.fitted.model();
    let benches = [findings.motion, findings.validation].map(|motion| Bench::new(dataset, motion));
    for scored in &findings.stages.effort.scored {
        let known = best
            .iter_mut()
            .find(|candidate| candidate.effect == scored.effect.as_str());
        match known {
            Some(known) if known.share >= scored.gain.share => {}
            Some(known) => (known.share, known.evidence) = (scored.gain.share, scored.gain.t),
            None => best.push(on_effort_alone(&benches, declared, scored)),
        }
    }
    best
}

/// A candidate with the error of the declared model and this effect alone, fitted to the training
/// record, on the validation record.
fn on_effort_alone(
    [train, validation]: &[Bench<'_>; 2],
    declared: &Model,
    scored: &Scored,
) -> Candidate {
    let fitted = train.fit(&with(train, declared, scored));
    Candidate {
        effect: scored.effect.as_str().into(),
        validation_error_percent: Some(validation.force_error_percent(&fitted)),
        difference_left_percent: None,
        evidence: scored.gain.t,
        share: scored.gain.share,
        judged_on: EFFORT,
        physical: scored.physical,
        accepted: false,
    }
}

fn with(bench: &Bench<'_>, declared: &Model, scored: &Scored) -> Model {
    let Some(effect) = find(scored.effect) else {
        return declared.clone();
    };
    let model = declared.with(Part::found(effect, scored.parameter));
    settled(bench, model, effect)
}

fn on_reversals(findings: &Findings<'_>) -> Option<Candidate> {
    let presliding = findings.stages.reversals.inverse?;
    Some(Candidate {
        effect: EffectName::Presliding.to_string(),
        validation_error_percent: Some(with_bristle(findings, &presliding)),
        difference_left_percent: None,
        evidence: presliding.t,
        share: removed(presliding.dahl, presliding.rigid),
        judged_on: ABOUT_REVERSALS,
        physical: presliding.deflection >= reversal::resolution(findings.dataset),
        accepted: false,
    })
}

/// A gap before the bristle; its share is that of what the bristle leaves.
fn gap_on_reversals(findings: &Findings<'_>) -> Option<Candidate> {
    let gap = findings.stages.reversals.gap?;
    Some(Candidate {
        effect: EffectName::Backlash.to_string(),
        validation_error_percent: None,
        difference_left_percent: None,
        evidence: gap.t,
        share: gap.share,
        judged_on: ABOUT_REVERSALS,
        physical: gap.can_be,
        accepted: false,
    })
}

/// Force error on the validation record of the declared model with a bristle in place of the sign.
fn with_bristle(findings: &Findings<'_>, presliding: &Presliding) -> f64 {
    let (dataset, model) = (findings.dataset, findings.models.declared.fitted.model());
    let [train, validate] = [findings.motion, findings.validation]
        .map(|motion| Bristle::Dahl(presliding.deflection).motion(motion));
    let fitted = Bench::new(dataset, &train).fit(model);
    Bench::new(dataset, &validate).force_error_percent(&fitted)
}

/// Share of a mean square that is gone, from both rms.
fn removed(after_rms: f64, before_rms: f64) -> f64 {
    1.0 - (after_rms / before_rms.max(f64::MIN_POSITIVE)).powi(2)
}

/// Bristle and gap; where there is a load scale the difference is the better judge of both.
fn on_free_run(findings: &Findings<'_>) -> Vec<Candidate> {
    let Some(reversals) = findings.stages.reversals.free_run_alone() else {
        return Vec::new();
    };
    let candidate = |effect: EffectName, judged: &Judged| Candidate {
        effect: effect.to_string(),
        validation_error_percent: None,
        difference_left_percent: None,
        evidence: judged.t(&reversals.rigid),
        share: removed(judged.held_out, reversals.rigid.held_out),
        judged_on: FREE_RUN,
        physical: true,
        accepted: false,
    };
    let bristle = candidate(EffectName::Presliding, &reversals.bristle);
    // One word for a gap: the effort's, where that found it.
    let by_effort = findings.stages.reversals.gap_by_effort().is_some();
    let gap = reversals.gap.as_ref().filter(|_| !by_effort);
    let gap = gap.map(|gap| candidate(EffectName::Backlash, gap));
    [bristle].into_iter().chain(gap).collect()
}

fn about_fast_reversals(findings: &Findings<'_>) -> Option<Candidate> {
    let ripple = findings.stages.ripple.as_ref()?;
    let percent = ripple.train_percent;
    Some(Candidate {
        effect: EffectName::TorqueRipple.to_string(),
        validation_error_percent: None,
        difference_left_percent: None,
        evidence: ripple.orders.first().map_or(0.0, |order| order.gain.t),
        share: removed(percent.extended, percent.declared),
        judged_on: ABOUT_FAST_REVERSALS,
        physical: true,
        accepted: false,
    })
}

/// The first round: later ones stand on what was accepted in it.
fn on_difference(findings: &Findings<'_>) -> Vec<Candidate> {
    let difference = findings.stages.difference.iter();
    let scored = difference.flat_map(|difference| &difference.scored);
    let first = scored.filter(|scored| scored.round == 0);
    first.map(of_the_difference).collect()
}

fn of_the_difference(scored: &Scored) -> Candidate {
    let share_left = (1.0 - scored.gain.share).max(0.0);
    Candidate {
        effect: scored.effect.as_str().into(),
        validation_error_percent: None,
        difference_left_percent: Some(100.0 * share_left.sqrt()),
        evidence: scored.gain.t,
        share: scored.gain.share,
        judged_on: DIFFERENCE,
        physical: scored.physical,
        accepted: false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn candidate(effect: &str, share: f64, judged_on: &'static str, accepted: bool) -> Candidate {
        Candidate {
            effect: effect.into(),
            validation_error_percent: None,
            difference_left_percent: None,
            evidence: 5.0,
            share,
            judged_on,
            physical: true,
            accepted,
        }
    }

    #[test]
    fn accepted_effects_stand_in_front_and_each_group_falls_in_share() {
        let list = ranked(vec![
            candidate("delay", 0.1, EFFORT, false),
            candidate("stribeck", 0.3, EFFORT, true),
            candidate("compliance", 0.9, DIFFERENCE, false),
            candidate("torque_ripple", 0.5, EFFORT, true),
        ]);
        let order: Vec<&str> = list.iter().map(|c| c.effect.as_str()).collect();
        assert_eq!(order, ["torque_ripple", "stribeck", "compliance", "delay"]);
    }

    #[test]
    fn an_effect_keeps_the_judgement_in_which_it_removes_most() {
        let list = ranked(vec![
            candidate("presliding", 0.2, ABOUT_REVERSALS, false),
            candidate("presliding", 0.8, FREE_RUN, false),
            candidate("backlash", 0.7, FREE_RUN, false),
        ]);
        assert_eq!(list.len(), 2);
        assert_eq!((list[0].judged_on, list[0].share), (FREE_RUN, 0.8));
    }

    #[test]
    fn half_the_rms_is_three_quarters_of_the_mean_square() {
        assert_eq!(removed(1.0, 2.0), 0.75);
        assert_eq!(removed(4.0, 2.0), -3.0);
    }
}
