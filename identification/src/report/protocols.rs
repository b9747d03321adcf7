//! The force error by the protocols that papers use, side by side: they mix them, and the figures
//! differ by what counts as a sample and by what was fitted.

use serde::Serialize;

use crate::fit::bench::{Bench, Model};
use crate::identify::{Findings, Fitted};
use crate::motion::filter::TRIM;
use crate::motion::kinematics::Kinematics;

/// A force error by one protocol, `100 ‖f − f̂‖ / ‖f‖` of low-passed efforts.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Protocol {
    /// Which samples, and what was fitted.
    pub definition: &'static str,
    /// Declared model, percent.
    pub declared_percent: f64,
    /// Extended model, percent.
    pub extended_percent: f64,
}

/// Every so many low-passed samples is kept where a protocol decimates: 1 kHz to 200 Hz, twice the
/// cut-off.
const DECIMATION: usize = 5;

/// The table of a dataset.
pub(crate) fn table(findings: &Findings<'_>) -> Vec<Protocol> {
    let Findings {
        dataset,
        motion,
        validation,
        declared,
        extended,
        ..
    } = findings;
    let whole = dataset
        .whole()
        .and_then(|record| Kinematics::new(dataset, &record));
    let whole = whole.as_ref().unwrap_or(motion);
    let row = |definition: &'static str, error: &dyn Fn(&Fitted) -> f64| Protocol {
        definition,
        declared_percent: error(declared),
        extended_percent: error(extended),
    };
    let given = |fitted: &Fitted, motion: &Kinematics| {
        error(findings, fitted, motion, &fitted.coefficients)
    };
    let refitted = |fitted: &Fitted, motion: &Kinematics| {
        let seen = fitted.motion(motion);
        let coefficients = Bench::new(dataset, &seen).fit(&fitted.model).coefficients;
        error(findings, fitted, motion, &coefficients)
    };
    let (all, thinned) = (with_samples(whole, 1), with_samples(whole, DECIMATION));
    vec![
        row(
            "moving samples of the training record, fitted to them",
            &|fitted| given(fitted, motion),
        ),
        row(
            "moving samples of the validation record, fitted to the training record",
            &|fitted| given(fitted, validation),
        ),
        row(
            "moving samples of the whole file, fitted to them",
            &|fitted| refitted(fitted, whole),
        ),
        row(
            "all samples of the whole file, fitted to them: standstill counts, where friction is whatever holds",
            &|fitted| refitted(fitted, &all),
        ),
        row(
            "the same, every fifth low-passed sample (as published for EMPS)",
            &|fitted| refitted(fitted, &thinned),
        ),
    ]
}

/// The motion with every n-th sample in place of the moving ones, but for the filter's ends.
fn with_samples(motion: &Kinematics, every: usize) -> Kinematics {
    let rows = motion.len();
    let mask: Vec<bool> = (0..rows)
        .map(|row| row >= TRIM && row + TRIM < rows && row % every == 0)
        .collect();
    Kinematics {
        moving: mask.clone(),
        fitted: mask,
        ..motion.clone()
    }
}

fn error(
    findings: &Findings<'_>,
    fitted: &Fitted,
    motion: &Kinematics,
    coefficients: &[f64],
) -> f64 {
    let seen = fitted.motion(motion);
    let model: &Model = &fitted.model;
    Bench::new(findings.dataset, &seen).force_error_percent(model, coefficients)
}
