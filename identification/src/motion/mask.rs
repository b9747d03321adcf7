//! Which samples count: moving ones, slow ones, and those whose effort is not known.

use std::ops::Range;

use crate::motion::filter::trim;
use crate::record::samples::Record;

/// Slow and spoilt samples take their neighbours within this time with them: two periods of the
/// low-pass's cut-off at 1 kHz, over which it mixes them.
const MARGIN_S: f64 = 0.020;
/// The same in periods of any cut-off.
const PERIODS_OF_CUTOFF: f64 = 2.0;
/// Least share of the samples that has to be clear of rest: else all are fitted.
const CLEAR_SHARE: f64 = 0.5;
/// Share of the limit from which an effort counts as limited.
const LIMITED: f64 = 0.999;

/// Whether a sample is away from the filter's ends in its piece.
#[must_use]
pub(crate) fn is_inside(pieces: &[Range<usize>], row: usize) -> bool {
    pieces.iter().any(|piece| {
        let trim = trim(piece.len());
        row >= piece.start + trim && row + trim < piece.end
    })
}

/// Samples of one piece at a velocity above a limit, and those about a lower one; the filter's ends
/// are neither.
#[must_use]
pub(crate) fn moving_and_slow(
    velocity_lp: &[f64],
    limit: f64,
    period_s: f64,
) -> (Vec<bool>, Vec<bool>) {
    moving_and_slow_within(MARGIN_S, velocity_lp, limit, period_s)
}

/// Moving samples of one piece into which a low-pass of this cut-off has not mixed what holds the
/// axis at rest; all moving samples where too few are so far from rest.
#[must_use]
pub(crate) fn clear_of_rest(
    moving: &[bool],
    velocity_lp: &[f64],
    limit: f64,
    period_s: f64,
    cutoff_hz: f64,
) -> Vec<bool> {
    let margin_s = PERIODS_OF_CUTOFF / cutoff_hz;
    if margin_s <= MARGIN_S {
        return moving.to_vec();
    }
    let (clear, _) = moving_and_slow_within(margin_s, velocity_lp, limit, period_s);
    unless_few(clear, moving, CLEAR_SHARE)
}

/// What is left of a mask, or all of it where that is less than a share.
#[must_use]
pub(crate) fn unless_few(left: Vec<bool>, of: &[bool], share: f64) -> Vec<bool> {
    let count = |mask: &[bool]| mask.iter().filter(|inside| **inside).count() as f64;
    if count(&left) >= share * count(of) {
        left
    } else {
        of.to_vec()
    }
}

fn moving_and_slow_within(
    margin_s: f64,
    velocity_lp: &[f64],
    limit: f64,
    period_s: f64,
) -> (Vec<bool>, Vec<bool>) {
    let is_slow = velocity_lp.iter().map(|velocity| velocity.abs() <= limit);
    let slow = widened(is_slow, margin_s, period_s);
    let all = 0..velocity_lp.len();
    let with = |wanted: bool| -> Vec<bool> {
        let rows = slow.iter().enumerate();
        rows.map(|(row, slow)| is_inside(std::slice::from_ref(&all), row) && *slow == wanted)
            .collect()
    };
    (with(false), with(true))
}

/// Samples about a hole in the record or about an effort at its limit: what acted there is not
/// known.
#[must_use]
pub(crate) fn spoilt(record: &Record, limit: Option<f64>) -> Vec<bool> {
    let limited = |effort: &f64| limit.is_some_and(|limit| effort.abs() >= LIMITED * limit);
    let rows = record.effort.iter().zip(&record.interpolated);
    let bad = rows.map(|(effort, hole)| *hole || limited(effort));
    widened(bad, MARGIN_S, record.period_s)
}

/// The samples of a mask without those of another.
#[must_use]
pub(crate) fn without(mask: &[bool], other: &[bool]) -> Vec<bool> {
    let both = mask.iter().zip(other);
    both.map(|(inside, other)| *inside && !other).collect()
}

/// The samples that are in both masks.
#[must_use]
pub(crate) fn both(one: &[bool], other: &[bool]) -> Vec<bool> {
    let pairs = one.iter().zip(other);
    pairs.map(|(one, other)| *one && *other).collect()
}

/// A mask with a margin about each of its samples; each row is written once.
#[must_use]
pub(crate) fn widened(
    mask: impl ExactSizeIterator<Item = bool>,
    margin_s: f64,
    period_s: f64,
) -> Vec<bool> {
    let (rows, margin) = (mask.len(), (margin_s / period_s).round() as usize);
    let mut wide = vec![false; rows];
    let mut until = 0;
    for (row, _) in mask.enumerate().filter(|(_, inside)| *inside) {
        let from = row.saturating_sub(margin).max(until);
        until = (row + margin + 1).min(rows);
        wide[from.min(until)..until].fill(true);
    }
    wide
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slow_samples_take_their_neighbours_with_them() {
        let at = |row: i32| if row == 500 { 0.0 } else { 0.1 };
        let velocity: Vec<f64> = (0..1000).map(at).collect();
        let (moving, slow) = moving_and_slow(&velocity, 1.0e-3, 1.0e-3);
        assert_eq!(slow.iter().filter(|slow| **slow).count(), 41);
        assert!(!moving[480] && !moving[520] && moving[479] && moving[521]);
        assert!(!moving[199] && moving[200] && moving[799] && !moving[800]);
    }

    #[test]
    fn a_sample_at_the_limit_velocity_is_slow() {
        let velocity = vec![1.0e-3; 1000];
        let (moving, slow) = moving_and_slow(&velocity, 1.0e-3, 1.0e-3);
        assert!(!moving.contains(&true));
        assert_eq!(slow.iter().filter(|slow| **slow).count(), 600);
    }

    #[test]
    fn what_a_low_cut_off_mixes_with_rest_is_not_clear_of_it() {
        let at = |row: i32| if row == 1000 { 0.0 } else { 0.1 };
        let velocity: Vec<f64> = (0..2000).map(at).collect();
        let (moving, _) = moving_and_slow(&velocity, 1.0e-3, 1.0e-3);
        let left_out = |cutoff_hz| {
            let clear = clear_of_rest(&moving, &velocity, 1.0e-3, 1.0e-3, cutoff_hz);
            clear[200..1800].iter().filter(|clear| !**clear).count()
        };
        assert_eq!([100.0, 50.0, 20.0].map(left_out), [41, 81, 201]);
    }

    #[test]
    fn all_moving_samples_are_taken_where_few_are_clear_of_rest() {
        let at = |row: i32| if row % 150 == 0 { 0.0 } else { 0.1 };
        let velocity: Vec<f64> = (0..2000).map(at).collect();
        let (moving, _) = moving_and_slow(&velocity, 1.0e-3, 1.0e-3);
        let clear = |cutoff_hz| clear_of_rest(&moving, &velocity, 1.0e-3, 1.0e-3, cutoff_hz);
        assert!(clear(20.0) == moving && clear(50.0) != moving);
    }

    fn record(effort: Vec<f64>) -> Record {
        let rows = effort.len();
        Record {
            period_s: 1.0e-3,
            position: vec![0.0; rows],
            load: None,
            velocity: None,
            reference: None,
            time_s: vec![0.0; rows],
            rows: Vec::new(),
            jittered: false,
            joints: Vec::new(),
            interpolated: (0..rows).map(|row| row == 300).collect(),
            effort,
        }
    }

    #[test]
    fn what_acted_about_a_hole_or_at_the_limit_is_not_known() {
        let at = |row: i32| if row == 100 { -9.995 } else { 9.98 };
        let record = record((0..400).map(at).collect());
        let rows = |mask: &[bool]| (0..mask.len()).filter(|row| mask[*row]).collect::<Vec<_>>();
        let limited = spoilt(&record, Some(10.0));
        assert_eq!(
            rows(&limited),
            (80..=120).chain(280..=320).collect::<Vec<_>>()
        );
        assert_eq!(
            rows(&spoilt(&record, None)),
            (280..=320).collect::<Vec<_>>()
        );
    }

    #[test]
    fn every_piece_has_the_filters_ends_of_its_own() {
        let pieces = [0..1000, 1000..1400];
        let inside: Vec<usize> = (0..1400).filter(|row| is_inside(&pieces, *row)).collect();
        assert_eq!(inside, (200..800).chain(1100..1300).collect::<Vec<_>>());
    }

    #[test]
    fn a_mask_without_another_keeps_the_rest() {
        assert_eq!(
            without(&[true, true, false], &[true, false, true]),
            [false, true, false]
        );
    }
}
