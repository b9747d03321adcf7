//! Errors and predictions of all rows of a long record, of which an excerpt was fitted.
//!
//! The record is judged a stretch at a time, so that memory does not grow with it. Each stretch is
//! seen with a margin at both ends, in which the low-pass and the states of friction settle; only
//! its own rows count. What a model leaves of a record is the mean square over the stretches,
//! weighted by what each of them has.

use std::ops::Range;

use crate::evidence::difference::Path;
use crate::evidence::findings::Findings;
use crate::evidence::inverse_dynamics::{Compared, Judgement};
use crate::fit::bench::Bench;
use crate::motion::kinematics::Kinematics;
use crate::record::dataset::Dataset;
use crate::record::samples::Record;

/// Rows of a stretch: fifty vectors of it are 16 MB.
const STRETCH_ROWS: usize = 40_000;
/// Rows of its margins: five times what the low-pass trims.
const MARGIN_ROWS: usize = 1000;

/// What a model leaves of all rows of a record.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Errors {
    /// Force error over moving samples, percent of the effort.
    pub force_percent: f64,
    /// Rms of the effort about reversals that is not explained.
    pub reversal_rms: f64,
    /// Rms of motor − load that is not explained, µm (µrad), where there is a load scale.
    pub difference_um: Option<f64>,
}

/// The long records of a dataset, judged.
pub(crate) struct AllRows<'a> {
    /// The dataset with its whole records.
    pub dataset: &'a Dataset,
    /// Errors on the training record.
    pub train: Compared<Errors>,
    /// Errors on the validation record.
    pub validate: Compared<Errors>,
    /// Acting effort of the validation record.
    pub effort: Vec<f64>,
    /// Predicted effort of the validation record.
    pub prediction: Compared<Vec<f64>>,
}

impl<'a> AllRows<'a> {
    /// Judges the models that an excerpt gave on the dataset that it was taken from.
    pub(crate) fn of(findings: &Findings<'_>, dataset: &'a Dataset) -> Self {
        let mut all = Self {
            dataset,
            train: errors(findings, &dataset.train, &mut |_| ()),
            validate: Compared::default(),
            effort: Vec::new(),
            prediction: Compared::default(),
        };
        let Self {
            effort, prediction, ..
        } = &mut all;
        let validate = errors(findings, &dataset.validate, &mut |stretch| {
            let own = stretch.own.clone();
            effort.extend_from_slice(&stretch.motion.effort[own.clone()]);
            let Compared { declared, extended } = &stretch.judged;
            let from = |judged: &Judgement| judged.prediction[own.clone()].to_vec();
            prediction.declared.extend(from(declared));
            prediction.extended.extend(from(extended));
        });
        Self { validate, ..all }
    }
}

/// A stretch of a record, judged.
struct Stretch {
    /// Its own rows within it: the others are margin.
    own: Range<usize>,
    motion: Kinematics,
    judged: Compared<Judgement>,
    difference_um: Option<Compared<f64>>,
}

fn errors(
    findings: &Findings<'_>,
    record: &Record,
    hear: &mut dyn FnMut(&Stretch),
) -> Compared<Errors> {
    let mut sums = Compared::<Sums>::default();
    for own in stretches(record.len()) {
        if let Some(stretch) = Stretch::of(findings, record, own) {
            hear(&stretch);
            let um = stretch.difference_um;
            sums.declared
                .add(&stretch, &stretch.judged.declared, um.map(|um| um.declared));
            sums.extended
                .add(&stretch, &stretch.judged.extended, um.map(|um| um.extended));
        }
    }
    sums.each(Sums::errors)
}

/// Stretches of so many rows; a rest that is shorter than the margins belongs to the last one.
fn stretches(rows: usize) -> Vec<Range<usize>> {
    let count = (rows.saturating_sub(2 * MARGIN_ROWS) / STRETCH_ROWS).max(1);
    let end = |place: usize| {
        if place + 1 == count {
            rows
        } else {
            (place + 1) * STRETCH_ROWS
        }
    };
    (0..count)
        .map(|place| place * STRETCH_ROWS..end(place))
        .collect()
}

impl Stretch {
    fn of(findings: &Findings<'_>, record: &Record, own: Range<usize>) -> Option<Self> {
        let from = own.start.saturating_sub(MARGIN_ROWS);
        let until = (own.end + MARGIN_ROWS).min(record.len());
        let part = record.part(from..until);
        let own = own.start - from..own.end - from;
        let motion = only(Kinematics::new(findings.dataset, &part)?, &own);
        let judged = findings
            .models
            .each(|model| model.on(findings.dataset, &motion));
        let difference_um = difference_um(findings, &part, &motion);
        Some(Self {
            own,
            motion,
            judged,
            difference_um,
        })
    }
}

/// The motion with nothing but a range of its rows that counts.
fn only(mut motion: Kinematics, own: &Range<usize>) -> Kinematics {
    for mask in [&mut motion.moving, &mut motion.fitted, &mut motion.slow] {
        mask[..own.start].fill(false);
        mask[own.end..].fill(false);
    }
    motion
}

/// Rms of motor − load that each model leaves.
pub(crate) fn difference_um(
    findings: &Findings<'_>,
    record: &Record,
    motion: &Kinematics,
) -> Option<Compared<f64>> {
    let difference = findings.stages.difference.as_ref()?;
    let bench = Bench::new(findings.dataset, motion);
    let transmitted = bench.transmitted(&findings.models.extended.fitted);
    let path = Path {
        position: &record.position,
        transmitted: &transmitted,
    };
    let (declared, extended) = difference.on(motion, path)?;
    Some(Compared { declared, extended })
}

/// Sums of squares over stretches.
#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    effort: f64,
    force: f64,
    slow_rows: f64,
    reversal: f64,
    difference_rows: f64,
    difference: Option<f64>,
}

impl Sums {
    fn add(&mut self, stretch: &Stretch, judged: &Judgement, difference_um: Option<f64>) {
        let motion = &stretch.motion;
        let moving = motion.effort_lp.iter().zip(&motion.moving);
        let moving = moving.filter(|(_, moving)| **moving);
        let effort: f64 = moving.map(|(effort, _)| effort * effort).sum();
        let count = |mask: &[bool]| mask.iter().filter(|inside| **inside).count() as f64;
        let (moving_rows, slow_rows) = (count(&motion.moving), count(&motion.slow));
        self.effort += effort;
        self.force += effort * (0.01 * judged.force_percent).powi(2);
        self.slow_rows += slow_rows;
        self.reversal += slow_rows * judged.reversal_rms.powi(2);
        if let Some(um) = difference_um {
            let rows = moving_rows + slow_rows;
            self.difference_rows += rows;
            *self.difference.get_or_insert(0.0) += rows * um.powi(2);
        }
    }

    fn errors(&self) -> Errors {
        let rms = |sum: f64, of: f64| (sum / of.max(f64::MIN_POSITIVE)).sqrt();
        Errors {
            force_percent: 100.0 * rms(self.force, self.effort),
            reversal_rms: rms(self.reversal, self.slow_rows),
            difference_um: self.difference.map(|sum| rms(sum, self.difference_rows)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stretches_cover_every_row_once_and_none_is_short() {
        for rows in [3000, 40_000, 81_999, 82_000, 1_000_000] {
            let stretches = stretches(rows);
            assert_eq!(
                (stretches[0].start, stretches[stretches.len() - 1].end),
                (0, rows)
            );
            assert!(
                stretches
                    .windows(2)
                    .all(|pair| pair[0].end == pair[1].start)
            );
            assert!(
                stretches
                    .iter()
                    .all(|own| own.len() < 2 * STRETCH_ROWS + 2 * MARGIN_ROWS)
            );
            assert!(
                stretches
                    .iter()
                    .all(|own| own.len() >= STRETCH_ROWS.min(rows))
            );
        }
    }

    #[test]
    fn errors_are_weighted_by_what_each_stretch_has() {
        let sums = Sums {
            effort: 4.0,
            force: 0.01,
            slow_rows: 10.0,
            reversal: 90.0,
            difference_rows: 0.0,
            difference: None,
        };
        let errors = sums.errors();
        assert!((errors.force_percent - 5.0).abs() < 1.0e-12);
        assert!((errors.reversal_rms - 3.0).abs() < 1.0e-12);
        assert_eq!(errors.difference_um, None);
    }
}
