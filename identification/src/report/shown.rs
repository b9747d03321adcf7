//! Where each effect shows that was found: the output on which it lowers what is left.
//!
//! The table of errors has one row for a record and one column for an output, so an effect of
//! another output leaves it as it was. Here each effect has a row of its own: what is left of its
//! output without it and with it, on the training record.
//!
//! | output | without, with |
//! |---|---|
//! | effort of moving samples | the extended model without the effect, fitted anew, and with it |
//! | effort about reversals | rigid friction, a bristle |
//! | position of the simulation | rigid friction, the shape; blocks that were not fitted |
//! | motor − load | the declared effects, all that were found |
//! | effort about fast reversals | the declared model, with the ripple |

use axis_model::EffectName;

use crate::evidence::findings::Findings;
use crate::evidence::reversal::bristle::Bristle;
use crate::fit::bench::Bench;
use crate::model::inverse::{Model, Origin, Part};
use crate::report::forms::Shown;
use crate::report::ranking::{ABOUT_FAST_REVERSALS, ABOUT_REVERSALS, DIFFERENCE, EFFORT, FREE_RUN};

/// Rows of all effects that were found, in their order; an effect that two outputs show has two.
pub(crate) fn shown(findings: &Findings<'_>) -> Vec<Shown> {
    let names = findings.found.names().iter();
    names.flat_map(|name| of_effect(findings, *name)).collect()
}

fn of_effect(findings: &Findings<'_>, name: EffectName) -> Vec<Shown> {
    let rows = [
        on_effort(findings, name),
        about_reversals(findings, name),
        in_free_run(findings, name),
        between(findings, name),
        about_fast_reversals(findings, name),
    ];
    let rows = rows.into_iter().flatten();
    rows.map(|(on, unit, [without, with])| Shown {
        effect: name.to_string(),
        on,
        unit,
        without,
        with,
    })
    .collect()
}

/// Output, unit, and what is left without the effect and with it.
type Row = Option<(&'static str, &'static str, [f64; 2])>;

fn on_effort(findings: &Findings<'_>, name: EffectName) -> Row {
    let extended = &findings.models.extended;
    let is_it = |part: &Part| part.origin == Origin::Found && part.is(name);
    let (its, others): (Vec<Part>, Vec<Part>) = extended
        .fitted
        .model()
        .parts
        .iter()
        .cloned()
        .partition(is_it);
    if its.is_empty() {
        return None;
    }
    let seen = extended.motion(findings.motion);
    let bench = Bench::new(findings.dataset, &seen);
    let without = bench.fit(&Model { parts: others });
    let left = [&without, &extended.fitted].map(|fitted| bench.force_error_percent(fitted));
    Some((EFFORT, "%", left))
}

fn about_reversals(findings: &Findings<'_>, name: EffectName) -> Row {
    let gap = findings.stages.reversals.gap_by_effort();
    if let Some(gap) = gap.filter(|_| name == EffectName::Backlash) {
        let unit = findings.dataset.effort.unit();
        return Some((ABOUT_REVERSALS, unit, [gap.bristle, gap.left]));
    }
    let inverse = findings.stages.reversals.inverse?;
    let shows = name == EffectName::Presliding && inverse.dahl < inverse.rigid;
    let unit = findings.dataset.effort.unit();
    let with = match findings.models.extended.bristle {
        Some(Bristle::Slip(_)) => findings.train.extended.reversal_rms,
        _ => inverse.dahl,
    };
    shows.then_some((ABOUT_REVERSALS, unit, [inverse.rigid, with]))
}

fn in_free_run(findings: &Findings<'_>, name: EffectName) -> Row {
    let run = findings.stages.reversals.accepted_shape()?;
    let shows = match name {
        EffectName::Presliding => run.accepted.presliding,
        EffectName::Backlash => run.accepted.backlash,
        _ => false,
    };
    let left = [run.rigid.held_out, run.best().held_out].map(|rms| 1.0e6 * rms);
    (shows && left[1] < left[0]).then_some((FREE_RUN, millionths(findings), left))
}

fn between(findings: &Findings<'_>, name: EffectName) -> Row {
    let difference = findings.stages.difference.as_ref()?;
    let left = [difference.before_um, difference.after_um];
    let shows = difference.found.contains(&name);
    shows.then_some((DIFFERENCE, millionths(findings), left))
}

fn about_fast_reversals(findings: &Findings<'_>, name: EffectName) -> Row {
    let ripple = findings.stages.ripple.as_ref()?;
    let left = [ripple.train_percent.declared, ripple.train_percent.extended];
    (name == EffectName::TorqueRipple).then_some((ABOUT_FAST_REVERSALS, "%", left))
}

const fn millionths(findings: &Findings<'_>) -> &'static str {
    findings.dataset.kind.millionths()
}
