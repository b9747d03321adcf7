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
            let (motion, um) = (&stretch.motion, stretch.difference_um);
            sums.declared
                .add(motion, &stretch.judged.declared, um.map(|um| um.declared));
            sums.extended
                .add(motion, &stretch.judged.extended, um.map(|um| um.extended));
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
        let seen = with_margins(&own, record.len());
        let own = within(&own, &seen);
        let part = record.part(seen);
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

/// A stretch with its margins, as far as there are so many rows.
fn with_margins(own: &Range<usize>, rows: usize) -> Range<usize> {
    own.start.saturating_sub(MARGIN_ROWS)..(own.end + MARGIN_ROWS).min(rows)
}

/// Where a range stands within another that holds it.
fn within(own: &Range<usize>, seen: &Range<usize>) -> Range<usize> {
    own.start - seen.start..own.end - seen.start
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
        hold: findings.dataset.hold,
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
    fn add(&mut self, motion: &Kinematics, judged: &Judgement, difference_um: Option<f64>) {
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
    use crate::evidence::findings::tests::{Scene, findings};
    use crate::fit::made::{axis, usual};

    #[test]
    fn a_rest_that_is_shorter_than_two_margins_belongs_to_the_last_stretch() {
        let ends = |rows| -> Vec<usize> { stretches(rows).iter().map(|own| own.end).collect() };
        assert_eq!(ends(81_999), [81_999]);
        assert_eq!(ends(82_000), [40_000, 82_000]);
        assert_eq!(ends(121_999), [40_000, 121_999]);
        assert_eq!(ends(122_000), [40_000, 80_000, 122_000]);
    }

    #[test]
    fn a_stretch_is_seen_with_a_thousand_rows_at_both_ends_where_there_are_so_many() {
        assert_eq!(with_margins(&(0..40_000), 100_000), 0..41_000);
        assert_eq!(with_margins(&(40_000..80_000), 100_000), 39_000..81_000);
        assert_eq!(with_margins(&(80_000..100_000), 100_000), 79_000..100_000);
    }

    #[test]
    fn within_its_margins_a_stretch_begins_after_the_first_one() {
        assert_eq!(within(&(40_000..80_000), &(39_000..81_000)), 1000..41_000);
        assert_eq!(within(&(0..40_000), &(0..41_000)), 0..40_000);
    }

    #[test]
    fn nothing_counts_in_the_margins() {
        let mut motion = axis(usual).motion;
        for mask in [&mut motion.moving, &mut motion.fitted, &mut motion.slow] {
            mask.fill(true);
        }
        let motion = only(motion, &(1000..5000));
        for mask in [motion.moving, motion.fitted, motion.slow] {
            assert_eq!(mask.iter().filter(|inside| **inside).count(), 4000);
            assert!(!mask[999] && mask[1000] && mask[4999] && !mask[5000]);
        }
    }

    /// A stretch with moving rows of these efforts, and so many rows about reversals.
    fn stretch(efforts: &[f64], slow_rows: usize) -> Kinematics {
        let mut motion = axis(usual).motion;
        for mask in [&mut motion.moving, &mut motion.slow] {
            mask.fill(false);
        }
        motion.moving[..efforts.len()].fill(true);
        motion.effort_lp[..efforts.len()].copy_from_slice(efforts);
        motion.slow[100..100 + slow_rows].fill(true);
        motion
    }

    fn left(force_percent: f64, reversal_rms: f64) -> Judgement {
        Judgement {
            force_percent,
            reversal_rms,
            residual: Vec::new(),
            prediction: Vec::new(),
        }
    }

    #[test]
    fn two_stretches_leave_what_both_leave_together() {
        let mut sums = Sums::default();
        // 60 % of √(3² + 4²) are 3, a third of 12 is 4: √(3² + 4²)/√(5² + 12²).
        sums.add(&stretch(&[3.0, -4.0], 2), &left(60.0, 3.0), Some(2.0));
        sums.add(&stretch(&[12.0], 1), &left(100.0 / 3.0, 6.0), Some(4.0));
        let errors = sums.errors();
        let near = |value: f64, wanted: f64| assert!((value - wanted).abs() < 1.0e-12, "{value}");
        near(errors.force_percent, 500.0 / 13.0);
        // √((2·3² + 6²)/3) of the effort; four rows of 2 µm and two of 4 µm.
        near(errors.reversal_rms, 18.0_f64.sqrt());
        near(errors.difference_um.unwrap(), 8.0_f64.sqrt());
    }

    #[test]
    fn without_a_load_scale_there_is_no_difference() {
        let mut sums = Sums::default();
        sums.add(&stretch(&[3.0], 2), &left(60.0, 3.0), None);
        assert_eq!(sums.errors().difference_um, None);
    }

    #[test]
    fn a_record_of_one_stretch_leaves_what_its_findings_say() {
        let scene = Scene::behind(2.0e-6);
        let findings = findings(&scene, &[]);
        let all = AllRows::of(&findings, &scene.dataset);
        let (train, validate) = (&findings.train, &findings.validate);
        for (all, one) in [(&all.train, train), (&all.validate, validate)] {
            for (all, one) in [(all.declared, &one.declared), (all.extended, &one.extended)] {
                let same = |a: f64, b: f64| assert!((a - b).abs() <= 1.0e-9 * b, "{a} {b}");
                same(all.force_percent, one.force_percent);
                same(all.reversal_rms, one.reversal_rms);
                assert!(one.reversal_rms > 0.0 && one.force_percent > 0.0);
                // Nothing was fitted to the difference: all of it is left.
                same(all.difference_um.unwrap(), 2.0);
            }
        }
        assert!(all.train.declared.force_percent > all.train.extended.force_percent);
        assert_eq!(all.effort, scene.motion.effort);
        assert_eq!(all.prediction.declared, validate.declared.prediction);
        assert_eq!(all.prediction.extended, validate.extended.prediction);
    }

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
