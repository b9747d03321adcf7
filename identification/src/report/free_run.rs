//! Free-run errors before and after, for the report.

use crate::evidence::free_run::Reversals;
use crate::identify::Findings;
use crate::record::samples::Record;
use crate::report::forms::{FreeRun, FreeRunErrors, ReversalShapes};
use crate::report::ranking;
use crate::simulate::axis::Shape;
use crate::simulate::fit::fit;
use crate::simulate::model::Simulated;
use crate::simulate::run::{Drive, SETTLING_ROWS, position_rms, simulate};

const MICRO: f64 = 1.0e6;

/// Free runs of the declared and of the extended model, both fitted to the positions of the
/// training record.
pub(crate) fn report(
    findings: &Findings<'_>,
    reversals: &Reversals,
) -> Option<(FreeRun, Vec<[f64; 3]>)> {
    let dataset = findings.dataset;
    let record = &dataset.train;
    let drive = reversals.drive;
    let extended = &reversals.best().model;
    let declares = |name: &str| dataset.declared.iter().any(|declared| declared == name);
    let shape = Shape {
        deflection: if declares("presliding") {
            extended.shape.deflection
        } else {
            0.0
        },
        gap: if declares("backlash") {
            extended.shape.gap
        } else {
            0.0
        },
        ..extended.shape
    };
    let declared = &findings.declared;
    let start = Simulated::new(
        dataset,
        record.period_s,
        &declared.model,
        &declared.coefficients,
        shape,
    )?;
    let before = fit(&start, &drive, record, &|_| true);
    let errors = |record: &Record| {
        let [before, after] = [&before, extended]
            .map(|model| MICRO * position_rms(&simulate(model, &drive, record), record, &|_| true));
        let tracking = tracking_rms(record).map(|rms| MICRO * rms);
        FreeRunErrors {
            position_error_um_before: before,
            position_error_um_after: after,
            tracking_error_percent_before: tracking.map(|rms| 100.0 * before / rms),
            tracking_error_percent_after: tracking.map(|rms| 100.0 * after / rms),
        }
    };
    let um = |judged: &crate::evidence::free_run::Judged| MICRO * judged.held_out;
    let runs = [&before, extended].map(|model| simulate(model, &drive, &dataset.validate));
    let curve = curve(&dataset.validate, &runs);
    let report = FreeRun {
        controller: match drive {
            Drive::Known(_) => "known",
            Drive::Followed => "followed",
        },
        controller_misfit_percent: match drive {
            Drive::Known(law) => Some(100.0 * law.misfit),
            Drive::Followed => None,
        },
        train: errors(record),
        validate: errors(&dataset.validate),
        reversals: ReversalShapes {
            rigid_um: um(&reversals.rigid),
            bristle_um: um(&reversals.bristle),
            gap_um: reversals.gap.as_ref().map(um),
            both_um: reversals.both.as_ref().map(um),
        },
        parameters: ranking::table(reversals.named(dataset)),
    };
    Some((report, curve))
}

/// Time and both position errors, thinned for a picture.
fn curve(record: &Record, runs: &[crate::simulate::run::Run; 2]) -> Vec<[f64; 3]> {
    let stride = (record.len() / 6000).max(1);
    let rows = (SETTLING_ROWS..record.len()).step_by(stride);
    let error = |run: &crate::simulate::run::Run, row: usize| {
        MICRO * (run.motor[row] - record.position[row])
    };
    rows.map(|row| {
        [
            record.time_s[row],
            error(&runs[0], row),
            error(&runs[1], row),
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
