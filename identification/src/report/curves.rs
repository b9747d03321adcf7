//! Curves of the validation record, for pictures and `prediction.csv`.
//!
//! The fit lives on a uniform time base, the file on its own time stamps. The curves have one row
//! for each row of the file, so where the two differ predictions go back by interpolation.

use crate::evidence::findings::Findings;
use crate::motion::kinematics::Kinematics;
use crate::record::samples::Record;
use crate::record::time_base::interpolate;
use crate::report::forms::{Curves, EffectCurve};

/// The curves, with those of the effects and of the free run.
pub(crate) fn curves(
    findings: &Findings<'_>,
    effects: Vec<EffectCurve>,
    free_run: Vec<[f64; 3]>,
) -> Curves {
    let (record, motion) = (&findings.dataset.validate, findings.validation);
    let judged = &findings.validate;
    let rows = Rows::of(record, motion);
    Curves {
        effects,
        free_run,
        time_s: record.rows.iter().map(|(t, _)| *t).collect(),
        effort: acting_effort(findings, &rows),
        declared: rows.interpolated(&judged.declared.prediction),
        extended: rows.interpolated(&judged.extended.prediction),
        moving: moving(findings),
    }
}

/// The recorded effort, or, where a known lag stands between it and the motion, the acting one:
/// that is what the predictions are of.
fn acting_effort(findings: &Findings<'_>, rows: &Rows<'_>) -> Vec<f64> {
    if findings.dataset.effort_lag_s > 0.0 {
        rows.interpolated(&findings.validation.effort)
    } else {
        let recorded = &findings.dataset.validate.rows;
        recorded.iter().map(|(_, effort)| *effort).collect()
    }
}

/// Velocity, position and both residuals of moving samples.
fn moving(findings: &Findings<'_>) -> Vec<[f64; 4]> {
    let (motion, judged) = (findings.validation, &findings.validate);
    let row = |at: usize| {
        [
            motion.velocity_lp[at],
            motion.position_lp[at],
            judged.declared.residual[at],
            judged.extended.residual[at],
        ]
    };
    let moving = (0..motion.len()).filter(|at| motion.moving[*at]);
    moving.map(row).collect()
}

/// From the uniform time base to the rows of the file.
struct Rows<'a> {
    /// Times of the uniform base, s.
    uniform_s: &'a [f64],
    /// Times of the file's rows on that base, s; `None` where row and sample are the same.
    at_s: Option<Vec<f64>>,
}

impl<'a> Rows<'a> {
    fn of(record: &Record, motion: &'a Kinematics) -> Self {
        Self::new(&record.rows, record.jittered, &motion.time_s)
    }

    fn new(rows: &[(f64, f64)], jittered: bool, uniform_s: &'a [f64]) -> Self {
        let first = rows.first().map_or(0.0, |(t, _)| *t);
        let origin = first - uniform_s.first().copied().unwrap_or(0.0);
        let at_s = rows.iter().map(|(t, _)| t - origin).collect();
        let even = !jittered && rows.len() == uniform_s.len();
        Self {
            uniform_s,
            at_s: (!even).then_some(at_s),
        }
    }

    fn interpolated(&self, values: &[f64]) -> Vec<f64> {
        match &self.at_s {
            Some(at_s) => interpolate(self.uniform_s, values, at_s),
            None => values.to_vec(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const UNIFORM_S: [f64; 4] = [0.0, 1.0, 2.0, 3.0];
    const SQUARES: [f64; 4] = [0.0, 1.0, 4.0, 9.0];

    fn rows(times_s: &[f64]) -> Vec<(f64, f64)> {
        times_s.iter().map(|t| (*t, 0.0)).collect()
    }

    #[test]
    fn an_even_record_keeps_its_samples_untouched() {
        // Time stamps that are a little off their samples do not count as another base.
        let file = rows(&[5.0, 6.001, 7.0, 8.0]);
        let rows = Rows::new(&file, false, &UNIFORM_S);
        assert_eq!(rows.interpolated(&SQUARES), SQUARES);
    }

    #[test]
    fn a_jittered_record_gets_its_values_at_its_own_times() {
        let file = rows(&[5.0, 6.5, 7.0, 7.25]);
        let rows = Rows::new(&file, true, &UNIFORM_S);
        assert_eq!(rows.interpolated(&SQUARES), [0.0, 2.5, 4.0, 5.25]);
    }

    #[test]
    fn a_record_with_a_hole_gets_one_value_for_each_of_its_rows() {
        // The sample at 7 s was interpolated: the file has no such row.
        let file = rows(&[5.0, 6.0, 8.0]);
        let rows = Rows::new(&file, false, &UNIFORM_S);
        assert_eq!(rows.interpolated(&SQUARES), [0.0, 1.0, 9.0]);
    }
}
