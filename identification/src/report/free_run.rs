//! Free-run errors before and after.
//!
//! Both models are fitted to the positions of the training record, so that the comparison is one of
//! structures. The declared model keeps of the shape at reversals what is declared of it.

use axis_model::EffectName;

use crate::evidence::findings::Findings;
use crate::evidence::free_run::{Judged, Reversals};
use crate::evidence::inverse_dynamics::Compared;
use crate::evidence::reversal::Presliding;
use crate::record::dataset::Dataset;
use crate::record::samples::Record;
use crate::report::forms::{FreeRun, FreeRunErrors, ReversalShapes};
use crate::simulate::axis::Shape;
use crate::simulate::controller::known::Controller;
use crate::simulate::drive::Drive;
use crate::simulate::fit::fit;
use crate::simulate::model::Simulated;
use crate::simulate::run::{Run, SETTLING_ROWS, position_rms, simulate, strays};

const MICRO: f64 = 1.0e6;
/// Points of the picture, at most about twice as many.
const POINTS: usize = 6000;

/// The free run's chapter, with errors on the records of `judged_on`, and its picture: time,
/// position error declared and extended, µm (µrad).
pub(crate) fn report(
    findings: &Findings<'_>,
    judged_on: &Dataset,
) -> Option<(FreeRun, Vec<[f64; 3]>)> {
    let reversals = findings.stages.reversals.free_run.as_ref()?;
    let models = Compared {
        declared: declared(findings, reversals)?,
        extended: reversals.best().model.clone(),
    };
    let (travel, drive) = (2.0 * findings.dataset.travel().1, &reversals.drive);
    let form = FreeRun {
        controller: word(reversals.controller),
        controller_misfit_percent: misfit(reversals.controller).map(|share| 100.0 * share),
        train: errors(&models, drive, &judged_on.train, travel),
        validate: errors(&models, drive, &judged_on.validate, travel),
        reversals: shapes(reversals, findings.stages.reversals.inverse),
    };
    Some((form, curve(&models, drive, &judged_on.validate)))
}

const fn word(controller: Controller) -> &'static str {
    match controller {
        Controller::Known(_) => "known",
        Controller::NotDescribed => "not described",
        Controller::Hidden(_) => "hidden by noise",
        Controller::Refuted(_) => "refuted",
    }
}

const fn misfit(controller: Controller) -> Option<f64> {
    match controller {
        Controller::Known(law) => Some(law.misfit),
        Controller::NotDescribed => None,
        Controller::Hidden(share) | Controller::Refuted(share) => Some(share),
    }
}

/// The declared model, simulated.
fn declared(findings: &Findings<'_>, reversals: &Reversals) -> Option<Simulated> {
    let dataset = findings.dataset;
    let best = reversals.best().model.mechanics.shape;
    let shape = Shape {
        bristle: best
            .bristle
            .filter(|_| dataset.declares(EffectName::Presliding)),
        gap: best.gap.filter(|_| dataset.declares(EffectName::Backlash)),
    };
    let declared = &findings.models.declared;
    let start = Simulated::new(dataset, dataset.train.period_s, &declared.fitted, shape)?;
    Some(fit(&start, &reversals.drive, &dataset.train, &|_| true))
}

fn errors(
    models: &Compared<Simulated>,
    drive: &Drive,
    record: &Record,
    travel: f64,
) -> FreeRunErrors {
    let um = models.each(|model| {
        let run = simulate(model, drive, record);
        if strays(&run, record, travel) {
            return f64::NAN;
        }
        MICRO * position_rms(&run, record, &|_| true)
    });
    let tracking_um = tracking_rms(record).map(|rms| MICRO * rms);
    FreeRunErrors {
        position_error_um_before: um.declared,
        position_error_um_after: um.extended,
        tracking_error_um: tracking_um,
        tracking_error_percent_before: tracking_um.map(|rms| 100.0 * um.declared / rms),
        tracking_error_percent_after: tracking_um.map(|rms| 100.0 * um.extended / rms),
    }
}

fn shapes(reversals: &Reversals, inverse: Option<Presliding>) -> ReversalShapes {
    let um = |judged: &Judged| MICRO * judged.told();
    ReversalShapes {
        rigid_um: um(&reversals.rigid),
        bristle_um: um(&reversals.bristle),
        gap_um: reversals.gap.as_ref().map(um),
        both_um: reversals.both.as_ref().map(um),
        rigid_effort: inverse.map(|inverse| inverse.rigid),
        bristle_effort: inverse.map(|inverse| inverse.dahl),
    }
}

fn curve(models: &Compared<Simulated>, drive: &Drive, record: &Record) -> Vec<[f64; 3]> {
    let runs = models.each(|model| simulate(model, drive, record));
    let stride = (record.len() / POINTS).max(1);
    let rows = (SETTLING_ROWS..record.len()).step_by(stride);
    let error = |run: &Run, row: usize| MICRO * (run.motor[row] - record.position[row]);
    rows.map(|row| {
        [
            record.time_s[row],
            error(&runs.declared, row),
            error(&runs.extended, row),
        ]
    })
    .collect()
}

/// Rms of setpoint − position.
fn tracking_rms(record: &Record) -> Option<f64> {
    let reference = record.reference.as_ref()?;
    let rows = record.len().saturating_sub(SETTLING_ROWS).max(1) as f64;
    let pairs = reference.iter().zip(&record.position).skip(SETTLING_ROWS);
    Some((pairs.map(|(r, q)| (r - q).powi(2)).sum::<f64>() / rows).sqrt()).filter(|rms| *rms > 0.0)
}
