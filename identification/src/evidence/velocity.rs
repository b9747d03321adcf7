//! Whether velocity and acceleration come from the position or from the drive's own velocity: the
//! first decision about a record, for both records together.
//!
//! Coarse positions, and positions whose time stamps jitter, have a poor derivative, and the
//! inertia comes out small. The drive has measured the velocity itself and often better. But its
//! column may be in another unit, of another axis, filtered and late. So three questions are asked.
//!
//! 1. Is it the derivative of the position ([`mod@oddity`])? Its slope and its delay are found.
//!    What is no velocity of this axis, or comes too late, is not used. What is a little late or a
//!    little large is put right, because the position is the truth in size and in time.
//! 2. Where the clock jitters: does that do harm ([`both_ways`])? The declared model is fitted with
//!    the low-pass of the errors and with the lower one.
//! 3. Is it better? The declared model is fitted with either source, and the measured velocity must
//!    leave a tenth less of the effort on blocks that were held out.
//!
//! A velocity that is not used is taken out of the records, and a remark says why: so whatever
//! follows sees one source, and a record without the column is as it always was.

pub(crate) mod both_ways;
pub(crate) mod oddity;

use std::borrow::Cow;

use crate::evidence::velocity::both_ways::{BothWays, Left};
use crate::evidence::velocity::oddity::oddity;
use crate::motion::filter::cutoff_hz;
use crate::motion::measured_velocity::Relation;
use crate::record::dataset::Dataset;
use crate::record::excerpt::{ExcerptSize, excerpt};
use crate::record::samples::Record;

/// The dataset with the velocity that is to be used, or without one.
pub(crate) fn decided(dataset: &Dataset, size: ExcerptSize) -> Cow<'_, Dataset> {
    let records = [&dataset.train, &dataset.validate];
    match records.map(|record| record.velocity.is_some()) {
        [false, false] => Cow::Borrowed(dataset),
        [true, true] => Cow::Owned(asked(dataset, size)),
        _ => Cow::Owned(refused(dataset, "it is in one of the two records only")),
    }
}

fn asked(dataset: &Dataset, size: ExcerptSize) -> Dataset {
    let records = [
        ("training", &dataset.train),
        ("validation", &dataset.validate),
    ];
    for (what, record) in records {
        if let Some(oddity) = Relation::of(record).and_then(|r| oddity(dataset, record, r)) {
            return refused(dataset, &format!("{oddity} ({what} record)"));
        }
    }
    let Some(relation) = Relation::of(&dataset.train) else {
        return refused(dataset, NO_ROOM);
    };
    let aligned = aligned(dataset, relation);
    let excerpt = excerpt(&aligned, size);
    match BothWays::of(excerpt.as_ref().unwrap_or(&aligned)) {
        Some(ways) => by_evidence(aligned, relation, ways),
        None => refused(dataset, NO_ROOM),
    }
}

const NO_ROOM: &str = "the sample period leaves no room for the low-pass";

/// The dataset without its velocity, and why.
fn refused(dataset: &Dataset, why: &str) -> Dataset {
    let note = format!("{} is not used: {why}", column(dataset));
    dataset.clone().without_velocity().with_note(note)
}

/// Both velocities as the training record's stands to its position.
fn aligned(dataset: &Dataset, relation: Relation) -> Dataset {
    let align = |record: &Record| Record {
        velocity: record
            .velocity
            .as_deref()
            .map(|velocity| relation.aligned(velocity, record.period_s)),
        ..record.clone()
    };
    dataset.with_records(align(&dataset.train), align(&dataset.validate))
}

fn by_evidence(aligned: Dataset, relation: Relation, ways: BothWays) -> Dataset {
    let note = [
        Some(said(&aligned, ways.left())),
        put_right(relation, aligned.train.period_s),
        ways.full_band().then(|| kept(&aligned.train)),
    ];
    let note = note.into_iter().flatten().collect::<String>();
    let chosen = if ways.left().is_better_measured() {
        aligned
    } else {
        aligned.without_velocity()
    };
    Dataset {
        full_band: ways.full_band(),
        ..chosen.with_note(note)
    }
}

/// Which source is used, and what each of them leaves.
fn said(dataset: &Dataset, left: Left) -> String {
    let (column, unit) = (column(dataset), dataset.kind.position_unit());
    let leaves = format!(
        "with it the declared model leaves {:.2} % of the effort on held-out blocks, with the derivative of position_{unit} {:.2} %",
        left.by_velocity, left.by_position
    );
    if left.is_better_measured() {
        format!("{column} is used for velocity and acceleration: {leaves}")
    } else {
        format!("{column} is not used: {leaves}, and it must leave a tenth less")
    }
}

/// A delay below this share of a row is none, and is not told.
const TOLD_ROWS: f64 = 0.05;
/// A slope that is off by less is not told.
const TOLD_SLOPE: f64 = 0.01;

/// What was done to the velocity before.
fn put_right(relation: Relation, period_s: f64) -> Option<String> {
    let Relation { slope, late_s, .. } = relation;
    let (rows, ms) = (late_s / period_s, 1.0e3 * late_s.abs());
    let when = if late_s > 0.0 { "after" } else { "before" };
    let shift = (rows.abs() > TOLD_ROWS).then(|| {
        let rows = rows.abs();
        format!("; it came {ms:.2} ms ({rows:.2} rows) {when} the position and was shifted")
    });
    let scale = ((slope - 1.0).abs() > TOLD_SLOPE)
        .then(|| format!("; it was {slope:.3} times as large and was scaled"));
    let both: String = shift.into_iter().chain(scale).collect();
    (!both.is_empty()).then_some(both)
}

/// That a jittered record has the low-pass of the errors.
fn kept(record: &Record) -> String {
    let hz = cutoff_hz(record.period_s);
    format!(
        "; the clock jitters, but up to {hz:.0} Hz that does no harm: the low-pass is not lowered"
    )
}

/// The usual name of the column.
fn column(dataset: &Dataset) -> &'static str {
    dataset.kind.velocity_columns()[0]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::made::on;
    use crate::fit::plain::Plain;
    use crate::motion::kinematics::Kinematics;
    use crate::record::excerpt::EXCERPT;
    use crate::simulate::made;

    const MASS: f64 = 90.0;

    /// Velocity and acceleration along the two sines of [`made::two_sines`].
    fn motion(t: f64) -> (f64, f64) {
        let (a, b) = (3.0 * t, 11.0 * t);
        (
            0.06 * a.cos() + 0.044 * b.cos(),
            -0.18 * a.sin() - 0.484 * b.sin(),
        )
    }

    /// 20 s at 1 kHz of 90 kg, 200 N s/m, 25 N and −4 N, with positions in counts of 20 µm and a
    /// velocity that is so large and so many rows late.
    fn record(slope: f64, late_rows: f64) -> Record {
        let counted = |x: f64| 2.0e-5 * (x / 2.0e-5).round();
        let position = made::two_sines(20_000).into_iter().map(counted).collect();
        let at = |row: f64| motion(1.0e-3 * row);
        let effort = |row: i32| {
            let (v, a) = at(f64::from(row));
            let noise = 0.2 * (0.37 * f64::from(row * row % 1009)).sin();
            MASS * a + 200.0 * v + 25.0 * v.signum() - 4.0 + noise
        };
        let velocity = |row: i32| slope * at(f64::from(row) - late_rows).0;
        Record {
            velocity: Some((0..20_000).map(velocity).collect()),
            effort: (0..20_000).map(effort).collect(),
            ..made::record(1.0e-3, position)
        }
    }

    fn dataset(train: Record) -> Dataset {
        on(train).dataset
    }

    fn inertia(dataset: &Dataset) -> f64 {
        Plain::fit(&Kinematics::new(dataset, &dataset.train).unwrap()).inertia
    }

    /// What was decided of a record, and what is said.
    fn outcome(train: Record) -> (Dataset, String) {
        let decided = decided(&dataset(train), EXCERPT).into_owned();
        let note = decided.notes.concat();
        (decided, note)
    }

    #[test]
    fn coarse_positions_beside_a_good_velocity_give_the_inertia_within_two_percent() {
        let (decided, note) = outcome(record(1.0, 0.0));
        assert!(note.starts_with("velocity_m_s is used"), "{note}");
        let by_velocity = inertia(&decided);
        let by_position = inertia(&decided.without_velocity());
        assert!((by_velocity / MASS - 1.0).abs() < 0.02, "{by_velocity}");
        assert!(by_position < 0.9 * MASS, "{by_position}");
    }

    #[test]
    fn a_jittered_clock_beside_a_good_velocity_keeps_the_low_pass_of_the_errors() {
        let exact = record(1.0, 0.0);
        let off_s = |row: usize| 3.0e-4 * (0.71 * (row * row % 1013) as f64).sin();
        let velocity = exact.velocity.clone().unwrap();
        let rows = made::two_sines(20_000).into_iter().zip(velocity);
        let rows = rows.enumerate();
        let jittered = Record {
            position: rows.map(|(row, (x, v))| x + v * off_s(row)).collect(),
            jittered: true,
            ..exact
        };
        let (decided, note) = outcome(jittered);
        assert!(note.starts_with("velocity_m_s is used"), "{note}");
        assert!(note.contains("up to 100 Hz that does no harm"), "{note}");
        assert!(decided.full_band);
        let found = inertia(&decided);
        assert!((found / MASS - 1.0).abs() < 0.02, "{found}");
    }

    #[test]
    fn a_velocity_that_is_a_little_late_and_large_is_put_right_and_told() {
        let (decided, note) = outcome(record(1.05, 0.5));
        assert!(note.contains("0.50 ms (0.50 rows) after"), "{note}");
        assert!(note.contains("1.050 times as large"), "{note}");
        let found = inertia(&decided);
        assert!((found / MASS - 1.0).abs() < 0.02, "{found}");
    }

    #[test]
    fn a_velocity_in_another_unit_or_too_late_is_not_used_and_told() {
        for (slope, late_rows, why) in [(1.0e3, 0.0, "in mm/s"), (1.0, 8.0, "8.0 ms after")] {
            let (decided, note) = outcome(record(slope, late_rows));
            assert!(note.starts_with("velocity_m_s is not used"), "{note}");
            assert!(note.contains(why), "{note}");
            assert_eq!(
                (decided.train.velocity, decided.validate.velocity),
                (None, None)
            );
        }
    }

    #[test]
    fn a_velocity_that_adds_nothing_leaves_the_record_as_it_is_without_it() {
        let fine = Record {
            position: made::two_sines(20_000),
            ..record(1.0, 0.0)
        };
        let (decided, note) = outcome(fine.clone());
        assert!(note.contains("must leave a tenth less"), "{note}");
        let without = Record {
            velocity: None,
            ..fine
        };
        assert_eq!(decided.train, without);
        assert!(matches!(decided_of(&dataset(without)), Cow::Borrowed(_)));
    }

    fn decided_of(dataset: &Dataset) -> Cow<'_, Dataset> {
        decided(dataset, EXCERPT)
    }

    #[test]
    fn a_velocity_of_one_of_two_records_is_not_used() {
        let mut dataset = dataset(record(1.0, 0.0));
        dataset.validate.velocity = None;
        let decided = decided_of(&dataset);
        assert_eq!(decided.train.velocity, None);
        assert!(decided.notes[0].contains("one of the two records only"));
    }

    #[test]
    fn an_odd_velocity_of_the_validation_record_counts_too() {
        let mut dataset = dataset(record(1.0, 0.0));
        let swapped = dataset.validate.velocity.iter().flatten().map(|v| -v);
        dataset.validate.velocity = Some(swapped.collect());
        let decided = decided_of(&dataset);
        assert_eq!(decided.train.velocity, None);
        let note = &decided.notes[0];
        assert!(note.contains("sign is swapped") && note.contains("(validation record)"));
    }
}
