//! The force error by the protocols that papers use, side by side: they mix them, and the figures
//! differ by what counts as a sample and by what was fitted.

use std::ops::Range;

use serde::Serialize;

use crate::evidence::findings::Findings;
use crate::evidence::inverse_dynamics::Compared;
use crate::motion::kinematics::Kinematics;
use crate::motion::mask::is_inside;

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

/// The table of a dataset; where the whole file is no record of its own, the training record is.
pub(crate) fn table(findings: &Findings<'_>, whole: Option<&Kinematics>) -> Vec<Protocol> {
    let (dataset, motion) = (findings.dataset, findings.motion);
    let whole = whole.unwrap_or(motion);
    let (all, thinned) = (with_samples(whole, 1), with_samples(whole, DECIMATION));
    let fitted_to_training = |definition, motion: &Kinematics| {
        let percent = findings
            .models
            .each(|model| model.force_error_percent(dataset, motion));
        Protocol::new(definition, percent)
    };
    let fitted_to_these = |definition, motion: &Kinematics| {
        let refitted = findings
            .models
            .each(|model| model.refitted(dataset, motion));
        let percent = refitted.each(|model| model.force_error_percent(dataset, motion));
        Protocol::new(definition, percent)
    };
    vec![
        fitted_to_training(
            "moving samples of the training record, fitted to them",
            motion,
        ),
        fitted_to_training(
            "moving samples of the validation record, fitted to the training record",
            findings.validation,
        ),
        fitted_to_these("moving samples of the whole file, fitted to them", whole),
        fitted_to_these(
            "all samples of the whole file, fitted to them: standstill counts, where friction is whatever holds",
            &all,
        ),
        fitted_to_these(
            "the same, every fifth low-passed sample (as published for EMPS)",
            &thinned,
        ),
    ]
}

impl Protocol {
    const fn new(definition: &'static str, percent: Compared<f64>) -> Self {
        Self {
            definition,
            declared_percent: percent.declared,
            extended_percent: percent.extended,
        }
    }
}

/// The motion with every n-th sample in place of the moving ones, but for the filter's ends.
fn with_samples(motion: &Kinematics, every: usize) -> Kinematics {
    let mask = samples(&motion.pieces, every);
    Kinematics {
        moving: mask.clone(),
        fitted: mask,
        ..motion.clone()
    }
}

fn samples(pieces: &[Range<usize>], every: usize) -> Vec<bool> {
    let rows = 0..pieces.last().map_or(0, |last| last.end);
    rows.map(|row| row % every == 0 && is_inside(pieces, row))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn record(rows: usize) -> Vec<Range<usize>> {
        std::iter::once(0..rows).collect()
    }

    #[test]
    fn the_ends_of_the_filter_count_in_no_protocol() {
        let all = samples(&record(900), 1);
        let counted: Vec<usize> = (0..all.len()).filter(|row| all[*row]).collect();
        assert_eq!(counted, (200..700).collect::<Vec<usize>>());
    }

    #[test]
    fn the_published_protocol_keeps_every_fifth_sample() {
        let (all, fifth) = (
            samples(&record(1000), 1),
            samples(&record(1000), DECIMATION),
        );
        let count = |mask: &[bool]| mask.iter().filter(|inside| **inside).count();
        assert_eq!(count(&fifth), count(&all).div_ceil(5));
        assert!((0..1000).all(|row| !fifth[row] || row % 5 == 0));
    }
}
