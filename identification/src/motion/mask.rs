//! Which samples count: moving ones, slow ones, and those whose effort is not known.

use std::ops::Range;

use crate::motion::filter::trim;
use crate::record::samples::Record;

/// Slow and spoilt samples take their neighbours within this time with them: about two periods of
/// the low-pass's cut-off, over which it mixes them.
const MARGIN_S: f64 = 0.020;
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
    let is_slow = velocity_lp.iter().map(|velocity| velocity.abs() <= limit);
    let slow = widened(is_slow, period_s);
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
    widened(bad, record.period_s)
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

/// A mask with the margin about each of its samples; each row is written once.
fn widened(mask: impl ExactSizeIterator<Item = bool>, period_s: f64) -> Vec<bool> {
    let (rows, margin) = (mask.len(), (MARGIN_S / period_s).round() as usize);
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
