//! The ranking of candidates and the parameters, for people.

use std::collections::BTreeMap;

use crate::evidence::actuator;
use crate::evidence::free_run::Judged;
use crate::evidence::reversal::{self, bristle};
use crate::evidence::selection::Scored;
use crate::fit::bench::{Bench, Term};
use crate::identify::Findings;
use crate::model::effects::{Named, Naming};
use crate::report::forms::{Candidate, Parameter, SlowRipple};

const EFFORT: &str = "effort of moving samples";
const ABOUT_REVERSALS: &str = "effort about reversals";
const FREE_RUN: &str = "free-run position";
const DIFFERENCE: &str = "motor - load position";

/// Every candidate once, where it stood best; accepted ones first.
pub(crate) fn candidates(findings: &Findings<'_>, found: &[String]) -> Vec<Candidate> {
    let mut list = on_effort(findings);
    list.extend(on_reversals(findings));
    list.extend(on_free_run(findings));
    list.extend(on_difference(findings));
    // One line each: the judgement that removes most.
    list.sort_by(|a, b| b.share.total_cmp(&a.share));
    let mut seen = std::collections::BTreeSet::new();
    list.retain(|candidate| seen.insert(candidate.effect.clone()));
    for candidate in &mut list {
        candidate.accepted = found.contains(&candidate.effect);
    }
    list.sort_by(|a, b| {
        b.accepted
            .cmp(&a.accepted)
            .then(b.share.total_cmp(&a.share))
    });
    list
}

fn on_effort(findings: &Findings<'_>) -> Vec<Candidate> {
    let mut list: Vec<Candidate> = Vec::new();
    for scored in &findings.selected.scored {
        let known = list
            .iter_mut()
            .find(|candidate| candidate.effect == scored.effect);
        match known {
            Some(known) if known.share >= scored.gain.share => {}
            Some(known) => (known.share, known.evidence) = (scored.gain.share, scored.gain.t),
            None => list.push(force_candidate(findings, scored)),
        }
    }
    list
}

fn force_candidate(findings: &Findings<'_>, scored: &Scored) -> Candidate {
    let Findings {
        dataset,
        motion,
        validation,
        ..
    } = findings;
    let mut model = findings.declared.model.clone();
    match crate::model::effects::find(scored.effect) {
        Some(effect) => model.terms.push(Term {
            effect,
            parameter: scored.parameter,
        }),
        None if scored.effect == "delay" => model.delay_s = scored.parameter,
        None => {
            model = actuator::linearised(&Bench::new(dataset, motion), &model, scored.parameter);
        }
    }
    let coefficients = Bench::new(dataset, motion).fit(&model).coefficients;
    Candidate {
        effect: scored.effect.into(),
        validation_error_percent: Some(
            Bench::new(dataset, validation).force_error_percent(&model, &coefficients),
        ),
        evidence: scored.gain.t,
        share: scored.gain.share,
        judged_on: EFFORT,
        physical: scored.physical,
        accepted: scored.accepted,
    }
}

fn on_reversals(findings: &Findings<'_>) -> Option<Candidate> {
    let presliding = findings.presliding?;
    Some(Candidate {
        effect: "presliding".into(),
        validation_error_percent: Some(with_bristle(findings, presliding.deflection)),
        evidence: presliding.t,
        share: removed(presliding.dahl, presliding.rigid),
        judged_on: ABOUT_REVERSALS,
        physical: presliding.deflection >= reversal::resolution(findings.dataset),
        accepted: false,
    })
}

/// Force error on the validation record of the declared model with a bristle in place of the sign.
fn with_bristle(findings: &Findings<'_>, deflection: f64) -> f64 {
    let Findings {
        dataset,
        motion,
        validation,
        ..
    } = findings;
    let model = &findings.declared.model;
    let (train, validate) = (
        bristle::motion(motion, deflection),
        bristle::motion(validation, deflection),
    );
    let coefficients = Bench::new(dataset, &train).fit(model).coefficients;
    Bench::new(dataset, &validate).force_error_percent(model, &coefficients)
}

fn removed(after: f64, before: f64) -> f64 {
    1.0 - (after / before.max(f64::MIN_POSITIVE)).powi(2)
}

fn on_free_run(findings: &Findings<'_>) -> Vec<Candidate> {
    let Some(reversals) = findings
        .reversals
        .as_ref()
        .filter(|_| findings.difference.is_none())
    else {
        return Vec::new();
    };
    let candidate = |effect: &str, judged: &Judged| Candidate {
        effect: effect.into(),
        validation_error_percent: None,
        evidence: reversals.t(judged),
        share: removed(judged.held_out, reversals.rigid.held_out),
        judged_on: FREE_RUN,
        physical: true,
        accepted: false,
    };
    let gap = reversals.gap.as_ref().map(|gap| candidate("backlash", gap));
    [Some(candidate("presliding", &reversals.bristle)), gap]
        .into_iter()
        .flatten()
        .collect()
}

fn on_difference(findings: &Findings<'_>) -> Vec<Candidate> {
    let first = findings
        .difference
        .iter()
        .flat_map(|d| &d.scored)
        .filter(|scored| scored.round == 0);
    first
        .map(|scored| Candidate {
            effect: scored.effect.into(),
            // Of the position difference: what is left of its rms on held-out blocks.
            validation_error_percent: Some(100.0 * (1.0 - scored.gain.share).max(0.0).sqrt()),
            evidence: scored.gain.t,
            share: scored.gain.share,
            judged_on: DIFFERENCE,
            physical: scored.physical,
            accepted: scored.accepted,
        })
        .collect()
}

/// Parameters of the extended model, with intervals.
pub(crate) fn parameters(
    findings: &Findings<'_>,
    ripple: Option<&SlowRipple>,
) -> BTreeMap<String, Parameter> {
    let mut named = of_the_inverse_model(findings);
    let length = findings.dataset.kind.position_unit();
    let plain = |name: &str, value: f64, unit: &str| Named {
        name: name.into(),
        value,
        half_width: None,
        unit: unit.into(),
    };
    let deflection = findings
        .extended
        .deflection
        .filter(|_| !findings.has_free_run_shape());
    named.extend(deflection.map(|deflection| plain("presliding_deflection", deflection, length)));
    if let Some(difference) = &findings.difference {
        let stiffness_unit = format!("{}/{length}", findings.dataset.effort.unit());
        named.extend(difference.gap.map(|gap| plain("backlash_gap", gap, length)));
        named.extend(
            difference
                .stiffness
                .map(|k| plain("compliance_stiffness", k, &stiffness_unit)),
        );
        named.extend(difference.pitch().into_iter().flat_map(|(amplitude, k)| {
            [
                plain("pitch_error_amplitude", amplitude, length),
                plain("pitch_error_period", 1.0 / k, length),
            ]
        }));
    }
    for order in ripple.iter().flat_map(|ripple| &ripple.orders) {
        let unit = findings.dataset.effort.unit().to_owned();
        let half_width = Some(order.half_width);
        let name = format!("torque_ripple_amplitude_order_{}", order.per_rev);
        named.push(Named {
            name,
            value: order.amplitude,
            half_width,
            unit,
        });
    }
    table(named)
}

/// Named parameters as a table.
pub(crate) fn table(named: Vec<Named>) -> BTreeMap<String, Parameter> {
    let mut table = BTreeMap::new();
    for Named {
        name,
        value,
        half_width,
        unit,
    } in named
    {
        let half = half_width.unwrap_or(0.0);
        let mut key = name.clone();
        let mut times = 1;
        while table.contains_key(&key) {
            times += 1;
            key = format!("{name}_{times}");
        }
        table.insert(
            key,
            Parameter {
                value,
                unit,
                low: value - half,
                high: value + half,
            },
        );
    }
    table
}

fn of_the_inverse_model(findings: &Findings<'_>) -> Vec<Named> {
    let Findings {
        dataset,
        motion,
        extended,
        ..
    } = findings;
    let seen = extended.motion(motion);
    let half_widths =
        Bench::new(dataset, &seen).half_widths(&extended.model, &extended.coefficients);
    let mut rest = extended
        .coefficients
        .iter()
        .copied()
        .zip(half_widths.linear.iter().copied());
    let mut named: Vec<Named> = Vec::new();
    for (term, parameter_half_width) in extended.model.terms.iter().zip(&half_widths.parameters) {
        let own: Vec<(f64, f64)> = rest
            .by_ref()
            .take(term.effect.width(term.parameter))
            .collect();
        let parameter_half_width = *parameter_half_width;
        let naming = Naming {
            parameter: term.parameter,
            parameter_half_width,
            coefficients: &own,
            dataset,
        };
        named.extend(term.effect.parameters(&naming));
    }
    let fitted = |name: &str, value: f64, half_width: Option<f64>, unit: String| Named {
        name: name.into(),
        value,
        half_width,
        unit,
    };
    if extended.model.delay_s != 0.0 {
        named.push(fitted(
            "delay",
            extended.model.delay_s,
            half_widths.delay_s,
            "s".into(),
        ));
    }
    if extended.model.saturates() {
        let k = extended.model.saturation.per_effort;
        named.push(fitted(
            "torque_saturation",
            k,
            half_widths.saturation,
            format!("1/{}", dataset.effort.unit()),
        ));
    }
    named.extend(findings.free_run_shape());
    named
}

impl Findings<'_> {
    /// Whether the deflection or the gap come from the free run.
    fn has_free_run_shape(&self) -> bool {
        self.difference.is_none()
            && self
                .reversals
                .as_ref()
                .is_some_and(|r| r.accepted.presliding || r.accepted.backlash)
    }

    /// Deflection and gap from the free run, with their intervals.
    fn free_run_shape(&self) -> Vec<Named> {
        let Some(reversals) = self
            .reversals
            .as_ref()
            .filter(|_| self.has_free_run_shape())
        else {
            return Vec::new();
        };
        let is_shape = |named: &Named| {
            named.name.starts_with("presliding") || named.name.starts_with("backlash")
        };
        reversals
            .named(self.dataset)
            .into_iter()
            .filter(is_shape)
            .collect()
    }
}
