//! What stands out of a column: runs of one to five rows that leave the range which the rows before
//! and after them allow.
//!
//! ```text
//! allowed at a row   between the lines through the rows before, through those after, and the chord
//! excursion          how far all rows of a run are outside of that; zero for a step and for a kink
//! scale              the excursion that one row in a hundred exceeds, over runs of any length
//! ```
//!
//! The scale is the record's own, a form of Hampel's identifier (Hampel 1974; Pearson 2002): noise,
//! quantisation, held rows and ticks of a coarse encoder make excursions in more than one row of a
//! hundred, so they raise it. Stamps may be wrong where rows are right and the other way round: the
//! lines are drawn over the stamps and over the count of rows, and both are allowed.

use std::ops::Range;

use crate::record::extent::smallest_step;

/// Longest run: what is longer is a disturbance of the axis and not of a row.
const LONGEST: usize = 5;
/// Share of the rows below the scale.
const SCALE_SHARE: f64 = 0.99;
/// An excursion stands out from so many scales on. The largest of 100 000 rows of normal noise has
/// 2.2 scales, of noise in a fifth of the rows 3.4.
const SCALES: f64 = 5.0;
/// And from so many of the column's own steps on: rounding makes two of nothing.
const STEPS: f64 = 4.0;
/// What both sides allow must agree within this share of the excursion: after an outlier the column
/// goes on as if nothing had happened. After an impulse that the axis felt it hardly does.
const GOES_ON: f64 = 1.0 / 3.0;
/// Rows on either side that a line is drawn through.
const SIDE: usize = 3;

/// A run of rows that stands out.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Excursion {
    /// The rows.
    pub rows: Range<usize>,
    /// How far at least each of them is outside of what is allowed, with its sign.
    pub size: f64,
}

/// The runs of a column that stand out, the largest first; none touches another.
#[must_use]
pub(crate) fn excursions(time_s: &[f64], values: &[f64]) -> Vec<Excursion> {
    let sizes: Vec<Vec<f64>> = (1..=LONGEST)
        .map(|run| sizes(time_s, values, run))
        .collect();
    let scale = sizes.iter().map(|sizes| scale(sizes)).fold(0.0, f64::max);
    let limit = (SCALES * scale).max(STEPS * smallest_step(values));
    let mut large = Vec::new();
    for (run, sizes) in (1..).zip(&sizes) {
        let rows = sizes
            .iter()
            .enumerate()
            .filter(|(_, size)| size.abs() > limit);
        large.extend(rows.map(|(start, size)| Excursion {
            rows: start + SIDE..start + SIDE + run,
            size: *size,
        }));
    }
    large.retain(|one| goes_on(time_s, values, one));
    large.sort_by(|a, b| b.size.abs().total_cmp(&a.size.abs()));
    apart(large, values.len())
}

/// Of runs that touch the first one.
fn apart(runs: Vec<Excursion>, rows: usize) -> Vec<Excursion> {
    let mut taken = vec![false; rows];
    let mut is_free = |one: &Excursion| {
        let near = one.rows.start - 1..(one.rows.end + 1).min(rows);
        let free = !taken[near].contains(&true);
        if free {
            taken[one.rows.clone()].fill(true);
        }
        free
    };
    runs.into_iter().filter(|one| is_free(one)).collect()
}

fn scale(sizes: &[f64]) -> f64 {
    let mut sizes: Vec<f64> = sizes.iter().map(|size| size.abs()).collect();
    if sizes.is_empty() {
        return 0.0;
    }
    let place = ((sizes.len() - 1) as f64 * SCALE_SHARE) as usize;
    *sizes.select_nth_unstable_by(place, f64::total_cmp).1
}

/// The excursion of every run of a length; the first begins at row [`SIDE`].
fn sizes(time_s: &[f64], values: &[f64], run: usize) -> Vec<f64> {
    let starts = SIDE..(values.len() + 1).saturating_sub(run + SIDE);
    starts
        .map(|start| size(time_s, values, start..start + run))
        .collect()
}

/// By how much the row of a run that is least outside is outside.
fn size(time_s: &[f64], values: &[f64], run: Range<usize>) -> f64 {
    let lines = Lines::about(time_s, values, &run);
    let outside = run.map(|row| {
        let (low, high) = lines.allowed(time_s, row);
        (values[row] - high).max(0.0) + (values[row] - low).min(0.0)
    });
    let least = |a: f64, b: f64| if b.abs() < a.abs() { b } else { a };
    outside.fold(f64::INFINITY, least)
}

/// Whether the rows before a run and those after it agree where they stand.
fn goes_on(time_s: &[f64], values: &[f64], one: &Excursion) -> bool {
    let lines = Lines::about(time_s, values, &one.rows);
    let mut widths = one.rows.clone().map(|row| {
        let (low, high) = lines.allowed(time_s, row);
        high - low
    });
    widths.all(|width| width < GOES_ON * one.size.abs())
}

/// Three lines: through the rows before a run, through those after it, and from one to the other;
/// over the stamps and over the count of rows. Each is a point and a slope.
struct Lines {
    over_stamps: [(f64, f64, f64); 3],
    over_rows: [(f64, f64, f64); 3],
}

impl Lines {
    fn about(time_s: &[f64], values: &[f64], run: &Range<usize>) -> Self {
        let (a, b, far) = (run.start - 1, run.end, SIDE - 1);
        let over = |time: &dyn Fn(usize) -> f64| {
            let slope =
                |from: usize, to: usize| (values[to] - values[from]) / (time(to) - time(from));
            [
                (time(a), values[a], slope(a - far, a)),
                (time(b), values[b], slope(b, b + far)),
                (time(a), values[a], slope(a, b)),
            ]
        };
        Self {
            over_stamps: over(&|row| time_s[row]),
            over_rows: over(&|row| row as f64),
        }
    }

    /// The least and the most that any of them gives at a row.
    fn allowed(&self, time_s: &[f64], row: usize) -> (f64, f64) {
        let at = |lines: &[(f64, f64, f64); 3], time: f64| {
            lines.map(|(at, value, slope)| value + slope * (time - at))
        };
        let values = [
            at(&self.over_stamps, time_s[row]),
            at(&self.over_rows, row as f64),
        ];
        let empty = (f64::INFINITY, f64::NEG_INFINITY);
        let all = values.into_iter().flatten();
        all.fold(empty, |(low, high), line| (low.min(line), high.max(line)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Noise between −1 and 1 that repeats nowhere.
    fn noise(row: usize) -> f64 {
        2.0 * (1.0e4 * (row as f64 * 12.9898).sin()).fract().abs() - 1.0
    }

    fn even(rows: usize) -> Vec<f64> {
        (0..rows).map(|row| 1.0e-3 * row as f64).collect()
    }

    /// First row and number of rows of each.
    fn found(values: &[f64]) -> Vec<(usize, usize)> {
        let found = excursions(&even(values.len()), values);
        let rows = found.into_iter().map(|one| one.rows);
        rows.map(|rows| (rows.start, rows.len())).collect()
    }

    fn noisy(law: impl Fn(usize) -> f64) -> Vec<f64> {
        (0..5000).map(|row| law(row) + 0.1 * noise(row)).collect()
    }

    #[test]
    fn a_run_of_up_to_five_rows_stands_out_and_a_longer_one_does_not() {
        for run in 1..=7 {
            let values = noisy(|row| {
                if (700..700 + run).contains(&row) {
                    9.0
                } else {
                    1.0
                }
            });
            let wanted = if run <= 5 {
                vec![(700, run)]
            } else {
                Vec::new()
            };
            assert_eq!(found(&values), wanted, "{run}");
        }
    }

    #[test]
    fn a_step_a_kink_and_a_ramp_do_not_stand_out() {
        let step = |row: usize| if row < 2500 { -20.0 } else { 20.0 };
        let kink = |row: usize| (row as f64 - 2500.0).abs();
        let late = |row: usize| (row as f64 - 2500.4).max(0.0) * 3.0;
        let ramp = |row: usize| (row.clamp(2500, 2503) as f64 - 2500.0) * 9.0;
        for values in [noisy(step), noisy(kink), noisy(late), noisy(ramp)] {
            assert_eq!(found(&values), []);
        }
    }

    #[test]
    fn a_spike_ten_rows_from_a_larger_step_stands_out_most() {
        for beside in [2480, 2490, 2510, 2520] {
            let values = noisy(|row| {
                let step = if row < 2500 { -20.0 } else { 20.0 };
                step + if row == beside { -15.0 } else { 0.0 }
            });
            assert_eq!(found(&values)[0], (beside, 1));
        }
    }

    #[test]
    fn what_a_hundredth_of_the_rows_does_stands_out_nowhere() {
        let ticks = noisy(|row| if row % 80 == 0 { 5.0 } else { 0.0 });
        assert_eq!(found(&ticks), []);
        let rare = noisy(|row| if row % 1000 == 500 { 5.0 } else { 0.0 });
        assert_eq!(found(&rare).len(), 5);
    }

    #[test]
    fn a_late_stamp_does_not_make_its_position_stand_out() {
        let mut time_s = even(5000);
        let position: Vec<f64> = time_s.iter().map(|t| 0.2 * t).collect();
        // Row 3000 was stamped with the time of the next one.
        time_s[3000] += 0.9e-3;
        assert_eq!(excursions(&time_s, &position), []);
    }

    #[test]
    fn rounding_alone_stands_out_nowhere() {
        let coarse = |row: usize| (3.0 * (0.002 * row as f64).sin()).round();
        let values: Vec<f64> = (0..5000).map(coarse).collect();
        assert_eq!(found(&values), []);
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(32))]

        #[test]
        fn noise_of_any_size_about_any_wave_stands_out_nowhere(
            amplitude in 1.0e-3..10.0_f64, wave in 0.0..100.0_f64, slow in 0.001..0.03_f64, hold in 1..6_usize,
        ) {
            let value = |row: usize| {
                let held = row - row % hold;
                wave * (slow * held as f64).sin() + amplitude * noise(held)
            };
            let values: Vec<f64> = (0..3000).map(value).collect();
            prop_assert_eq!(found(&values), []);
        }

        #[test]
        fn a_spike_of_thirty_times_the_noise_stands_out_anywhere(
            row in 10..2980_usize, run in 1..=5_usize, sign in prop::sample::select(vec![-1.0, 1.0]), slow in 0.001..0.01_f64,
        ) {
            let mut values: Vec<f64> = (0..3000)
                .map(|row| 100.0 * (slow * row as f64).sin() + noise(row))
                .collect();
            values[row..row + run].iter_mut().for_each(|value| *value += sign * 60.0);
            prop_assert_eq!(found(&values), [(row, run)]);
        }
    }
}
