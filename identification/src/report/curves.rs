//! Curves of the validation record, for pictures and `prediction.csv`.
//!
//! The fit lives on a uniform time base, the file on its own time stamps. The curves have one row
//! for each row of the file, so where the two differ predictions go back by interpolation.

use crate::evidence::all_rows::AllRows;
use crate::evidence::findings::Findings;
use crate::evidence::inverse_dynamics::Compared;
use crate::record::dataset::Dataset;
use crate::record::time_base::interpolate;
use crate::report::forms::Curves;

/// The curves, but for those of the effects and of the free run.
pub(crate) fn curves(findings: &Findings<'_>) -> Curves {
    let (dataset, judged) = (findings.dataset, &findings.validate);
    let effort = &findings.validation.effort;
    let prediction = judged.each(|judged| &judged.prediction[..]);
    Curves {
        moving: moving(findings),
        ..on_rows(dataset, effort, prediction)
    }
}

/// The same for a long record: the moving samples are those of the excerpt, all else is of all
/// rows.
pub(crate) fn of_all_rows(findings: &Findings<'_>, all: &AllRows<'_>) -> Curves {
    Curves {
        moving: moving(findings),
        ..on_rows(all.dataset, &all.effort, all.prediction.each(Vec::as_slice))
    }
}

fn on_rows(dataset: &Dataset, effort: &[f64], prediction: Compared<&[f64]>) -> Curves {
    let record = &dataset.validate;
    let rows = Rows::new(&record.rows, record.jittered, &record.time_s);
    // Where a known lag stands between the recorded effort and the motion, the acting one: that is
    // what the predictions are of.
    let effort = if dataset.effort_lag_s > 0.0 {
        rows.interpolated(effort)
    } else {
        record.rows.iter().map(|(_, effort)| *effort).collect()
    };
    Curves {
        time_s: record.rows.iter().map(|(t, _)| *t).collect(),
        effort,
        declared: rows.interpolated(prediction.declared),
        extended: rows.interpolated(prediction.extended),
        ..Curves::default()
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
