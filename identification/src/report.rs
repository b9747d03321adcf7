//! What is said about an identification: findings in, forms out.
//!
//! Nothing is decided here. [`forms`] holds the form of `identify --json` and the curves; every
//! other file fills one part of it.

use axis_model::EffectName;

use crate::evidence::all_rows::AllRows;
use crate::evidence::findings::Findings;
use crate::evidence::force_noise;
use crate::evidence::reversal;
use crate::evidence::slow_ripple::RippleAtReversals;
use crate::motion::filter;
use crate::motion::kinematics::Kinematics;
use crate::record::dataset::Dataset;
use crate::record::excerpt::note;
use crate::report::effects::Travel;
use crate::report::forms::{
    Curves, ForceNoise, Identification, LoopOscillation, Report, ResidualReport, RippleOrder,
    SlowRipple,
};

pub(crate) mod curves;
pub(crate) mod effects;
pub(crate) mod errors;
pub mod figures;
pub(crate) mod forms;
pub(crate) mod free_run;
pub(crate) mod parameters;
pub(crate) mod pictures;
pub(crate) mod presliding;
pub(crate) mod protocols;
pub(crate) mod ranking;
pub(crate) mod remarks;
pub(crate) mod shown;
pub(crate) mod unknown;

/// The report with its curves; errors and predictions are of all rows where an excerpt was fitted.
pub(crate) fn identification(findings: &Findings<'_>, all: Option<&AllRows<'_>>) -> Identification {
    let dataset = findings.dataset;
    let judged_on = all.map_or(dataset, |all| all.dataset);
    let (free_run, free_run_curve) = free_run::report(findings, judged_on).unzip();
    let mut report = Report {
        free_run,
        ..report(findings)
    };
    if let Some(all) = all {
        report.train = errors::over_all_rows(&all.train);
        report.validate = errors::over_all_rows(&all.validate);
        report.warnings.insert(0, note(all.dataset, dataset));
    }
    let residual = &findings.train.extended.residual;
    Identification {
        effects: effects::effects(&report, travel(dataset)),
        report,
        curves: Curves {
            effects: pictures::effects(findings),
            free_run: free_run_curve.unwrap_or_default(),
            ..all.map_or_else(
                || curves::curves(findings),
                |all| curves::of_all_rows(findings, all),
            )
        },
        travel: dataset.travel(),
        residual_rms: reversal::rms(residual, &findings.motion.moving),
        effort_unit: dataset.effort.unit(),
        effort_column: dataset.effort.column(),
        position_unit: dataset.kind.position_unit(),
    }
}

fn travel(dataset: &Dataset) -> Travel {
    Travel {
        middle_and_half: dataset.travel(),
        unit: dataset.kind.position_unit(),
    }
}

/// The report, but for the free run, which has a curve of its own.
fn report(findings: &Findings<'_>) -> Report {
    let dataset = findings.dataset;
    let found = &findings.found;
    let parameters = parameters::parameters(findings);
    let bristle = parameters::bristle(findings);
    let bristle = bristle.as_deref();
    let whole = dataset.whole();
    let whole = whole.and_then(|record| Kinematics::new(dataset, &record));
    let of_motor = parameters::motor_elements(findings);
    let presliding =
        bristle.and_then(|bristle| presliding::curve(bristle, &of_motor, &parameters.estimates));
    let table = unknown::table(parameters.estimates);
    Report {
        dataset: dataset.name.clone(),
        declared: words(&dataset.declared),
        shown: shown::shown(findings),
        candidates: ranking::candidates(findings),
        train: errors::on_training(findings),
        validate: errors::on_validation(findings),
        whole: whole
            .as_ref()
            .map(|motion| errors::refitted(findings, motion)),
        protocols: protocols::table(findings, whole.as_ref()),
        residual: residual(findings),
        free_run: None,
        slow_ripple: findings.stages.ripple.as_ref().map(slow_ripple),
        presliding,
        force_noise: force_noise(findings),
        loop_oscillation: loop_oscillation(findings),
        cutoff_hz: filter::fit_cutoff_hz(dataset, &dataset.train),
        as_defined: errors::as_defined(findings),
        verdict: findings.verdict.word().into(),
        warnings: remarks::remarks(findings, &table, &parameters.from),
        parameters: table,
        parameters_from: parameters.from,
        found: words(found.names()),
    }
}

fn loop_oscillation(findings: &Findings<'_>) -> Option<LoopOscillation> {
    let own = findings.oscillations.iter().filter(|own| !own.is_asked);
    let largest = own.max_by(|a, b| a.rms.total_cmp(&b.rms));
    largest.map(|own| LoopOscillation {
        frequency_hz: own.hz,
        rms: own.rms,
    })
}

fn force_noise(findings: &Findings<'_>) -> Option<ForceNoise> {
    let run = findings.stages.reversals.free_run.as_ref()?;
    let law = run.controller.law()?;
    let (motion, model) = ([findings.motion, findings.low], &findings.models.extended);
    let noise = force_noise::force_noise(findings.dataset, motion, model, &law)?;
    Some(ForceNoise {
        recorded: noise.recorded,
        acting: noise.acting,
    })
}

fn words(names: &[EffectName]) -> Vec<String> {
    names.iter().map(ToString::to_string).collect()
}

fn residual(findings: &Findings<'_>) -> ResidualReport {
    let (structure, white) = (&findings.residual, findings.residual.is_white());
    ResidualReport {
        white_before: white.declared,
        white_after: white.extended,
        share_before: structure.share.declared,
        share_after: structure.share.extended,
        late_ms: 1.0e3 * structure.left.extended.late_s,
        late_share: structure.left.extended.shift.share,
        looks_like: findings.verdict.looks_like.clone(),
    }
}

fn slow_ripple(ripple: &RippleAtReversals) -> SlowRipple {
    let orders = ripple.orders.iter().map(|order| RippleOrder {
        per_rev: order.per_rev,
        amplitude: order.amplitude,
        half_width: order.half_width,
        share: order.gain.share,
        evidence: order.gain.t,
    });
    SlowRipple {
        fastest: ripple.fastest,
        cutoff_hz: ripple.cutoff_hz,
        orders: orders.collect(),
        train_force_error_before_percent: ripple.train_percent.declared,
        train_force_error_after_percent: ripple.train_percent.extended,
        validate_force_error_before_percent: ripple.validate_percent.declared,
        validate_force_error_after_percent: ripple.validate_percent.extended,
    }
}
