//! What a file cannot be: each check says the file, the line or column, what was wanted and what to
//! do.

use std::path::Path;

use crate::error::IdentificationError;
use crate::record::extent::range;
use crate::record::form::AxisForm;
use crate::record::samples::Record;
use crate::record::time_base::median_step;
use crate::record::units::Effort;

type Outcome = Result<(), IdentificationError>;

/// Fewest rows of a training record: the filter's ends (2 × 200) and a few blocks.
pub(crate) const FEWEST_ROWS: usize = 2000;
/// Shortest validation record, s: nothing is fitted to it, so a stroke is enough.
const SHORTEST_VALIDATION_S: f64 = 1.0;
/// And its fewest rows: the ends of the low-pass settle within 30 rows where its cut-off is a tenth
/// of the rate, and as many again must be left.
const FEWEST_VALIDATION_ROWS: usize = 100;
/// A step longer than so many median ones is no hole that can be bridged.
const LONGEST_HOLE_STEPS: f64 = 50.0;
/// Median step over stated period beyond which one of them is wrong: a clock is never off by so
/// much, and every velocity of the fit would be.
const PERIOD_RATIO: std::ops::Range<f64> = 0.8..1.25;
/// Two records are of one rate within this ratio of their periods.
const SAME_RATE: std::ops::RangeInclusive<f64> = 0.99..=1.01;
/// Rows over which motion is looked for: noise of one step is no motion.
const MOTION_ROWS: usize = 5;
/// An axis moves where one row in so many does.
const MOVING_ONE_IN: usize = 20;

/// The header is line 1, so that row 0 is line 2.
const FIRST_LINE: usize = 2;

/// What a record is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Purpose {
    /// The model is fitted to it.
    Training,
    /// The model is judged on it.
    Validation,
}

/// A record that is long enough for its purpose.
pub(crate) fn length(path: &str, time_s: &[f64], purpose: Purpose) -> Outcome {
    let refused = |why: String| Err(IdentificationError::new(format!("{path}: {why}")));
    let (count, fewest) = match purpose {
        Purpose::Training => (time_s.len(), FEWEST_ROWS),
        Purpose::Validation => (time_s.len(), FEWEST_VALIDATION_ROWS),
    };
    if count < fewest {
        return refused(format!(
            "{count} rows; identification needs at least {fewest}, record longer"
        ));
    }
    // A record of n rows lasts n periods.
    let lasts_s = (time_s[count - 1] - time_s[0]) * count as f64 / (count - 1) as f64;
    if purpose == Purpose::Validation && lasts_s < SHORTEST_VALIDATION_S * (1.0 - 1.0e-6) {
        return refused(format!(
            "{lasts_s:.3} s; a validation record lasts at least {SHORTEST_VALIDATION_S} s, record longer"
        ));
    }
    Ok(())
}

/// Time that increases, without gaps that cannot be bridged.
pub(crate) fn time(path: &str, time_s: &[f64]) -> Outcome {
    let after = |row: usize| row + 1 + FIRST_LINE;
    if let Some(row) = time_s.windows(2).position(|pair| pair[1] <= pair[0]) {
        return Err(IdentificationError::new(format!(
            "{path}:{}: time_s does not increase ({} after {}); sort the rows or remove doubles",
            after(row),
            time_s[row + 1],
            time_s[row]
        )));
    }
    let period = median_step(time_s);
    let missing = |pair: &[f64]| pair[1] - pair[0] > LONGEST_HOLE_STEPS * period;
    match time_s.windows(2).position(missing) {
        Some(row) => Err(IdentificationError::new(format!(
            "{path}:{}: {:.3} s are missing (the median step is {period:.6} s); split the record there",
            after(row),
            time_s[row + 1] - time_s[row]
        ))),
        None => Ok(()),
    }
}

/// The stated sample period against the rows.
pub(crate) fn period(path: &str, time_s: &[f64], stated: Option<f64>) -> Outcome {
    let median = median_step(time_s);
    match stated {
        Some(period) if !PERIOD_RATIO.contains(&(median / period)) => {
            Err(IdentificationError::new(format!(
                "{path}: time_s steps by {median} s, dataset.toml says sample_period_s = {period}; is one of them wrong, or in another unit?"
            )))
        }
        _ => Ok(()),
    }
}

/// An effort that was recorded.
pub(crate) fn effort(path: &str, which: Effort, effort: &[f64]) -> Outcome {
    let (low, high) = range(effort);
    if high - low > 0.0 {
        return Ok(());
    }
    Err(IdentificationError::new(format!(
        "{path}: column {} is constant ({low}); was the effort recorded?",
        which.column()
    )))
}

/// An axis that moves.
pub(crate) fn motion(folder: &Path, what: &str, record: &Record, axis: &AxisForm) -> Outcome {
    let (slowest, unit) = (axis.moving_velocity(), axis.kind.position_unit());
    let limit = slowest * record.period_s * MOTION_ROWS as f64;
    let moves = |rows: &&[f64]| (rows[MOTION_ROWS] - rows[0]).abs() > limit;
    let moving = record
        .position
        .windows(MOTION_ROWS + 1)
        .filter(moves)
        .count();
    if moving * MOVING_ONE_IN >= record.len() {
        return Ok(());
    }
    Err(IdentificationError::new(format!(
        "{}: the axis hardly moves in the {what} record ({moving} of {} rows above {slowest} {unit}/s); record motion, check the unit of the position, or state moving_above_{unit}_s under [axis] for an axis that is as slow as that",
        folder.display(),
        record.len()
    )))
}

/// A second record that was recorded like the training record.
pub(crate) fn alike(
    path: &Path,
    (train, effort): (&Record, Effort),
    (other, other_effort): (&Record, Effort),
) -> Outcome {
    let refused = |why: String| {
        Err(IdentificationError::new(format!(
            "{}: {why}",
            path.display()
        )))
    };
    if effort != other_effort {
        return refused(format!(
            "effort is {}, the training record has {}; record both the same way",
            other_effort.column(),
            effort.column()
        ));
    }
    if train.load.is_some() != other.load.is_some() {
        return refused(
            "one record has a load position and the other has not; record both the same way".into(),
        );
    }
    if !SAME_RATE.contains(&(other.period_s / train.period_s)) {
        return refused(format!(
            "sample period {} s, the training record has {} s; record both at the same rate",
            other.period_s, train.period_s
        ));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn even(rows: usize) -> Vec<f64> {
        (0..rows).map(|row| 1.0e-3 * row as f64).collect()
    }

    /// 1 kHz, at a velocity for a share of the rows.
    fn record(velocity: f64, moving_rows: usize, rows: usize) -> Record {
        let at = |row: usize| 1.0e-3 * velocity * row.min(moving_rows) as f64;
        Record {
            period_s: 1.0e-3,
            position: (0..rows).map(at).collect(),
            load: None,
            velocity: None,
            reference: None,
            effort: vec![0.0; rows],
            rows: Vec::new(),
            jittered: false,
            joints: Vec::new(),
            interpolated: vec![false; rows],
            time_s: even(rows),
        }
    }

    fn text(outcome: Outcome) -> String {
        outcome.unwrap_err().to_string()
    }

    #[test]
    fn two_thousand_rows_are_enough_for_training() {
        let checked = |rows: usize| length("a.csv", &even(rows), Purpose::Training);
        assert!(checked(2000).is_ok());
        assert!(text(checked(1999)).starts_with("a.csv: 1999 rows"));
    }

    #[test]
    fn one_second_is_enough_for_validation_at_a_hundred_hertz_and_more() {
        let checked = |rows: usize, period_s: f64| {
            let time_s: Vec<f64> = (0..rows).map(|row| 3.0 + period_s * row as f64).collect();
            length("b.csv", &time_s, Purpose::Validation)
        };
        assert!(checked(1000, 1.0e-3).is_ok() && checked(100, 1.0e-2).is_ok());
        assert!(text(checked(999, 1.0e-3)).starts_with("b.csv: 0.999 s; a validation record"));
        assert!(text(checked(99, 0.1)).starts_with("b.csv: 99 rows"));
    }

    #[test]
    fn the_line_of_a_time_that_goes_back_is_named() {
        assert!(time("a.csv", &even(100)).is_ok());
        let mut back = even(100);
        back[7] = back[6];
        // Row 7 stands in line 9: the header is line 1.
        assert!(text(time("a.csv", &back)).starts_with("a.csv:9: time_s does not increase"));
    }

    #[test]
    fn fifty_missing_steps_are_bridged_and_more_are_not() {
        let with_gap = |steps: usize| [&even(200)[..100], &even(400)[99 + steps..]].concat();
        assert!(time("a.csv", &with_gap(49)).is_ok());
        assert!(text(time("a.csv", &with_gap(51))).starts_with("a.csv:102: 0.051 s are missing"));
    }

    #[test]
    fn a_period_in_milliseconds_is_noticed() {
        assert!(period("a.csv", &even(100), Some(1.2e-3)).is_ok());
        assert!(text(period("a.csv", &even(100), Some(1.0))).contains("another unit"));
        assert!(period("a.csv", &even(100), None).is_ok());
    }

    #[test]
    fn a_constant_effort_was_not_recorded() {
        assert!(effort("a.csv", Effort::Force, &[1.0, 1.1]).is_ok());
        assert!(text(effort("a.csv", Effort::Force, &[1.0, 1.0])).contains("force_n is constant"));
    }

    #[test]
    fn one_row_in_twenty_must_move_by_more_than_a_millimetre_a_second() {
        let checked =
            |record: &Record| motion(Path::new("a"), "training", record, &AxisForm::default());
        assert!(checked(&record(1.1e-3, 110, 2000)).is_ok());
        assert!(checked(&record(1.1e-3, 90, 2000)).is_err());
        let slow = record(0.9e-3, 2000, 2000);
        assert!(text(checked(&slow)).contains("moving_above_m_s"));
        // An axis that is said to be as slow as that moves.
        let stated: AxisForm = toml::from_str("moving_above_m_s = 0.8e-3").unwrap();
        assert!(motion(Path::new("a"), "training", &slow, &stated).is_ok());
    }

    #[test]
    fn two_records_are_of_one_effort_one_scale_and_one_rate() {
        let train = record(1.0, 10, 10);
        let against = |other: &Record, effort: Effort| {
            alike(Path::new("b.csv"), (&train, Effort::Force), (other, effort))
        };
        assert!(against(&train, Effort::Force).is_ok());
        assert!(text(against(&train, Effort::Current)).contains("effort is current_a"));
        let scaled = Record {
            load: Some(Vec::new()),
            ..train.clone()
        };
        assert!(text(against(&scaled, Effort::Force)).contains("load position"));
        let faster = Record {
            period_s: 0.98e-3,
            ..train.clone()
        };
        assert!(text(against(&faster, Effort::Force)).contains("sample period"));
    }
}
