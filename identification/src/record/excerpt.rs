//! An excerpt of a long record: windows of it, evenly spread over its time.
//!
//! What is fitted does not get better without end: after some tens of thousands of rows the
//! intervals are narrower than what differs from day to day, but time and memory go on growing. So
//! of a record that is longer than a limit windows are fitted. Each cell of the record's time gives
//! one, so that what drifts and every part of the travel are seen. Errors and predictions are of
//! all rows nevertheless.
//!
//! ```text
//! time      |-----cell-----|-----cell-----|-----cell-----|
//! windows   [=====]---------[=====]----------[=====]-----
//! ```
//!
//! A window begins where the axis moves: the states that nobody recorded (how far a bristle is
//! bent, on which side of its gap a load lies) are then known after a few rows, which the low-pass
//! keeps out of the fit anyway.

use std::ops::Range;

use crate::record::dataset::Dataset;
use crate::record::samples::Record;

/// How much of a record is fitted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct ExcerptSize {
    /// A record of at most so many rows is fitted whole.
    pub whole: usize,
    /// Of a longer one at most so many rows are fitted.
    pub rows: usize,
    /// Number of windows.
    pub windows: usize,
}

/// Whole up to two minutes at 1 kHz: twice what `commission` records, so that its figures are of
/// every row. Beyond, a minute at 1 kHz in six windows. That is twice the longest record on which
/// the thresholds were found (30 000 rows); six, because Stribeck falls and drifts need several
/// places in time, and each window loses 400 rows to the low-pass.
pub(crate) const EXCERPT: ExcerptSize = ExcerptSize {
    whole: 120_000,
    rows: 60_000,
    windows: 6,
};

/// Blocks of the cross-validation and of the free run, s: windows are whole blocks where that
/// leaves more than one a window.
const BLOCK_S: f64 = 2.0;
/// Rows over which the axis must move at the start of a window: those that the low-pass trims.
const MOVING_ROWS: usize = 200;

/// The excerpt of a dataset: windows in place of its long records. `None` where both are short
/// enough to be fitted whole.
#[must_use]
pub(crate) fn excerpt(dataset: &Dataset, size: ExcerptSize) -> Option<Dataset> {
    let records = [&dataset.train, &dataset.validate];
    let windows = records.map(|record| windows(record, dataset.moving_velocity, size));
    if windows.iter().all(Option::is_none) {
        return None;
    }
    let taken = |at: usize| match &windows[at] {
        Some(windows) => records[at].windows(windows),
        None => records[at].clone(),
    };
    Some(dataset.with_records(taken(0), taken(1)))
}

/// What an excerpt left out, for people.
#[must_use]
pub(crate) fn note(all: &Dataset, excerpt: &Dataset) -> String {
    let parts = [
        ("training", &all.train, &excerpt.train),
        ("validation", &all.validate, &excerpt.validate),
    ];
    let cut = parts
        .into_iter()
        .filter(|(_, all, taken)| taken.len() < all.len());
    let cut: Vec<String> = cut
        .map(|(name, all, taken)| {
            let pieces = taken.pieces();
            let window_s = pieces[0].len() as f64 * taken.period_s;
            let (rows, of, count) = (taken.len(), all.len(), pieces.len());
            format!("{rows} of {of} rows of the {name} record ({count} windows of {window_s:.1} s)")
        })
        .collect();
    format!(
        "long record: used {}; force errors and free-run errors of both records and the prediction \
         are of all rows, everything else (fit, ranking, residual, protocols, whole file) is of \
         the windows",
        cut.join(" and ")
    )
}

/// The windows of a record; `None` where it is short enough to be fitted whole.
fn windows(record: &Record, moving_velocity: f64, size: ExcerptSize) -> Option<Vec<Range<usize>>> {
    if record.len() <= size.whole {
        return None;
    }
    let rows = window_rows(record.period_s, size);
    let cell = record.len() / size.windows;
    let in_cell = |place: usize| {
        let cell = place * cell..(place + 1) * cell;
        let starts = cell.start..=cell.end - rows;
        let start = starts
            .clone()
            .find(|row| moves(record, *row, moving_velocity));
        let start = start.unwrap_or(cell.start);
        start..start + rows
    };
    Some((0..size.windows).map(in_cell).collect())
}

/// Rows of a window: whole blocks, where at least one fits.
fn window_rows(period_s: f64, size: ExcerptSize) -> usize {
    let most = size.rows / size.windows;
    let block = ((BLOCK_S / period_s).round() as usize).max(1);
    if most < block {
        most
    } else {
        most - most % block
    }
}

/// Whether the axis moves from a row on.
fn moves(record: &Record, row: usize, moving_velocity: f64) -> bool {
    let x = &record.position;
    let last = (row + MOVING_ROWS).min(x.len() - 1);
    let way = moving_velocity * record.period_s * MOVING_ROWS as f64;
    (x[last] - x[row]).abs() > way
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 1 kHz; stands for the first half of every second, then moves at 10 mm/s.
    fn record(rows: usize) -> Record {
        let at = |row: usize| {
            let (whole, part) = (row / 1000, row % 1000);
            1.0e-5 * (500 * whole + part.saturating_sub(500)) as f64
        };
        Record {
            period_s: 1.0e-3,
            position: (0..rows).map(at).collect(),
            load: None,
            velocity: None,
            reference: None,
            effort: vec![0.0; rows],
            time_s: (0..rows).map(|row| 1.0e-3 * row as f64).collect(),
            rows: Vec::new(),
            jittered: false,
            joints: Vec::new(),
            interpolated: vec![false; rows],
        }
    }

    const SMALL: ExcerptSize = ExcerptSize {
        whole: 14_000,
        rows: 12_000,
        windows: 3,
    };

    fn of(rows: usize) -> Option<Vec<Range<usize>>> {
        windows(&record(rows), 1.0e-3, SMALL)
    }

    #[test]
    fn a_record_up_to_the_limit_is_fitted_whole() {
        assert_eq!(of(14_000), None);
        assert!(of(14_001).is_some());
    }

    #[test]
    fn windows_are_whole_blocks_of_two_seconds_one_in_each_cell_of_time() {
        let windows = of(60_000).unwrap();
        assert_eq!(windows.len(), 3);
        for (place, window) in windows.iter().enumerate() {
            assert_eq!(window.len(), 4000);
            let cell = 20_000 * place..20_000 * (place + 1);
            assert!(
                cell.start <= window.start && window.end <= cell.end,
                "{window:?}"
            );
        }
    }

    #[test]
    fn a_window_begins_where_the_axis_moves() {
        for window in of(60_000).unwrap() {
            // More than 0.2 mm within 200 rows: from 20 rows after 0.3 s of each second on.
            assert!((320..=321).contains(&(window.start % 1000)), "{window:?}");
        }
    }

    #[test]
    fn a_cell_in_which_nothing_moves_gives_its_first_rows() {
        let mut still = record(60_000);
        still.position.fill(0.0);
        let windows = windows(&still, 1.0e-3, SMALL).unwrap();
        assert_eq!(windows, [0..4000, 20_000..24_000, 40_000..44_000]);
    }

    #[test]
    fn a_fast_record_has_windows_that_are_shorter_than_a_block() {
        assert_eq!(window_rows(1.0e-3, SMALL), 4000);
        assert_eq!(window_rows(0.9e-3, SMALL), 2222);
        assert_eq!(window_rows(1.0e-4, SMALL), 4000);
    }
}
