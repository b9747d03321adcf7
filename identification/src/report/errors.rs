//! Errors of the declared and of the extended model: on both records, on the whole file, and with
//! the defined low-pass where the fit had to use another.

use crate::evidence::all_rows::{self, difference_um};
use crate::evidence::findings::Findings;
use crate::evidence::inverse_dynamics::{Compared, Judgement};
use crate::motion::filter::cutoff_hz;
use crate::motion::kinematics::Kinematics;
use crate::record::samples::Record;
use crate::report::forms::Errors;

/// Rms of motor − load that each model leaves, µm (µrad).
type DifferenceUm = Compared<f64>;

/// Errors on the training record.
pub(crate) fn on_training(findings: &Findings<'_>) -> Errors {
    let difference = findings.stages.difference.as_ref();
    let um = difference.map(|difference| Compared {
        declared: difference.before_um,
        extended: difference.after_um,
    });
    errors(&findings.train, um)
}

/// Errors on the validation record.
pub(crate) fn on_validation(findings: &Findings<'_>) -> Errors {
    let record = &findings.dataset.validate;
    let um = difference_um(findings, record, findings.validation);
    errors(&findings.validate, um)
}

/// Errors on a long record, all of its rows.
pub(crate) fn over_all_rows(errors: &Compared<all_rows::Errors>) -> Errors {
    let Compared { declared, extended } = errors;
    Errors {
        force_error_before_percent: declared.force_percent,
        force_error_after_percent: extended.force_percent,
        reversal_error_before: declared.reversal_rms,
        reversal_error_after: extended.reversal_rms,
        position_difference_error_um_before: declared.difference_um,
        position_difference_error_um_after: extended.difference_um,
    }
}

/// Both structures fitted to the whole file, where validation is its last part: the protocol of the
/// published figures.
pub(crate) fn refitted(findings: &Findings<'_>, whole: &Kinematics) -> Errors {
    let dataset = findings.dataset;
    let refitted = findings.models.each(|model| model.refitted(dataset, whole));
    errors(&refitted.each(|model| model.on(dataset, whole)), None)
}

/// Errors with the defined low-pass, where the fit used another: training and validation record.
pub(crate) fn as_defined(findings: &Findings<'_>) -> Option<[Errors; 2]> {
    let dataset = findings.dataset;
    if !dataset.train.jittered || dataset.full_band {
        return None;
    }
    let on = |record: &Record| {
        let motion = Kinematics::with_cutoff(dataset, record, cutoff_hz(record.period_s))?;
        let judged = findings.models.each(|model| model.on(dataset, &motion));
        Some(errors(&judged, None))
    };
    Some([on(&dataset.train)?, on(&dataset.validate)?])
}

fn errors(judged: &Compared<Judgement>, difference_um: Option<DifferenceUm>) -> Errors {
    Errors {
        force_error_before_percent: judged.declared.force_percent,
        force_error_after_percent: judged.extended.force_percent,
        reversal_error_before: judged.declared.reversal_rms,
        reversal_error_after: judged.extended.reversal_rms,
        position_difference_error_um_before: difference_um.map(|um| um.declared),
        position_difference_error_um_after: difference_um.map(|um| um.extended),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn judgement(force_percent: f64, reversal_rms: f64) -> Judgement {
        Judgement {
            force_percent,
            reversal_rms,
            residual: Vec::new(),
            prediction: Vec::new(),
        }
    }

    #[test]
    fn before_is_the_declared_model_and_after_the_extended_one() {
        let judged = Compared {
            declared: judgement(4.0, 30.0),
            extended: judgement(1.5, 20.0),
        };
        let um = Compared {
            declared: 12.0,
            extended: 0.3,
        };
        let wanted = Errors {
            force_error_before_percent: 4.0,
            force_error_after_percent: 1.5,
            reversal_error_before: 30.0,
            reversal_error_after: 20.0,
            position_difference_error_um_before: Some(12.0),
            position_difference_error_um_after: Some(0.3),
        };
        assert_eq!(errors(&judged, Some(um)), wanted);
    }

    #[test]
    fn without_a_load_scale_there_is_no_error_of_the_difference() {
        let judged = Compared {
            declared: judgement(4.0, 30.0),
            extended: judgement(1.5, 20.0),
        };
        let errors = errors(&judged, None);
        assert_eq!(errors.position_difference_error_um_before, None);
        assert_eq!(errors.position_difference_error_um_after, None);
    }
}
