//! One time base: rows with jittered stamps or holes are brought onto equal steps by interpolation;
//! rows that are even already stay as they are.
//!
//! Positions follow the cubic through the four rows about a time. A line between two rows is off by
//! an eighth of the acceleration times the step squared, and that comes back as a spike of the
//! acceleration: one lost row would give as much as the whole motion. Efforts and velocities are
//! noisier than that, and follow the line. So do positions whose stamps jitter: a cubic makes more
//! of an error in time than a line does.

use crate::record::samples::Record;

/// The columns of a file as they stand in it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Rows {
    /// Time stamp, s.
    pub time_s: Vec<f64>,
    /// Motor position.
    pub position: Vec<f64>,
    /// Load position, if it was measured.
    pub load: Option<Vec<f64>>,
    /// Velocity of the motor as the drive gives it, if it was recorded.
    pub velocity: Option<Vec<f64>>,
    /// Setpoint, if it was recorded.
    pub reference: Option<Vec<f64>>,
    /// Effort.
    pub effort: Vec<f64>,
    /// Rows that were found to be outliers, and bridged.
    pub left_out: Vec<bool>,
}

impl Rows {
    /// Time stamp and effort of each row.
    #[must_use]
    pub(crate) fn stamped(&self) -> Vec<(f64, f64)> {
        let pairs = self.time_s.iter().zip(&self.effort);
        pairs.map(|(time, effort)| (*time, *effort)).collect()
    }
}

/// What `dataset.toml` says about time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Clock {
    /// Sample period, s, where it is stated.
    pub period_s: Option<f64>,
    /// Time stamp that counts as zero.
    pub origin_s: f64,
}

/// A stated period counts where it is within this share of the median step; else the median does.
const STATED_WITHIN: f64 = 0.2;
/// Stamps are even where each is within this share of the period of its place.
const EVEN_WITHIN: f64 = 0.1;
/// Rows further apart than so many median steps leave a hole; less is jitter.
const HOLE_PERIODS: f64 = 10.0;
/// Steps that are off by more than this share of the period are no whole number of periods.
const OFF: f64 = 0.1;
/// Share of such steps from which a clock jitters; fewer are missing rows.
const JITTERY_SHARE: f64 = 0.02;

/// The record of a file's rows.
#[must_use]
pub(crate) fn uniform(rows: Rows, clock: Clock) -> Record {
    let median = median_step(&rows.time_s);
    let period_s = clock
        .period_s
        .filter(|period| (period / median - 1.0).abs() < STATED_WITHIN)
        .unwrap_or(median);
    if is_even(&rows.time_s, period_s) {
        as_it_stands(rows, period_s, clock.origin_s)
    } else {
        interpolated(&rows, period_s, median, clock.origin_s)
    }
}

fn is_even(time_s: &[f64], period_s: f64) -> bool {
    let start = time_s[0];
    let off = |(i, t): (usize, &f64)| (t - start - period_s * i as f64).abs();
    time_s
        .iter()
        .enumerate()
        .all(|row| off(row) < EVEN_WITHIN * period_s)
}

fn as_it_stands(rows: Rows, period_s: f64, origin_s: f64) -> Record {
    Record {
        period_s,
        rows: rows.stamped(),
        interpolated: rows.left_out,
        time_s: rows.time_s.into_iter().map(|t| t - origin_s).collect(),
        position: rows.position,
        load: rows.load,
        velocity: rows.velocity,
        reference: rows.reference,
        effort: rows.effort,
        jittered: false,
        joints: Vec::new(),
    }
}

fn interpolated(rows: &Rows, period_s: f64, median: f64, origin_s: f64) -> Record {
    let start = rows.time_s[0];
    let duration = rows.time_s[rows.time_s.len() - 1] - start;
    let count = (duration / period_s).floor() as usize + 1;
    let at: Vec<f64> = (0..count).map(|i| start + period_s * i as f64).collect();
    let on_base = |values: &[f64]| interpolate(&rows.time_s, values, &at);
    let jittered = jitters(&rows.time_s, median);
    let along = |values: &[f64]| {
        if jittered {
            on_base(values)
        } else {
            interpolate_smoothly(&rows.time_s, values, &at)
        }
    };
    Record {
        period_s,
        rows: rows.stamped(),
        interpolated: bridged(rows, &at, HOLE_PERIODS * median),
        position: along(&rows.position),
        load: rows.load.as_deref().map(along),
        velocity: rows.velocity.as_deref().map(on_base),
        reference: rows.reference.as_deref().map(along),
        effort: on_base(&rows.effort),
        jittered,
        joints: Vec::new(),
        time_s: at.iter().map(|t| t - origin_s).collect(),
    }
}

/// Median of the steps between time stamps.
#[must_use]
pub(crate) fn median_step(time_s: &[f64]) -> f64 {
    let mut steps: Vec<f64> = time_s.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let middle = steps.len() / 2;
    *steps.select_nth_unstable_by(middle, f64::total_cmp).1
}

fn jitters(time_s: &[f64], period_s: f64) -> bool {
    let off = |step: f64| ((step / period_s).round() - step / period_s).abs() > OFF;
    let steps = time_s.windows(2).map(|pair| pair[1] - pair[0]);
    let count = steps.filter(|step| off(*step)).count();
    count as f64 > JITTERY_SHARE * time_s.len() as f64
}

/// Which times stand in a hole, between two rows that are further apart, or next to an outlier.
fn bridged(rows: &Rows, at: &[f64], hole_s: f64) -> Vec<bool> {
    let between = |(right, t): (usize, f64)| {
        let (before, after) = (rows.time_s[right - 1], rows.time_s[right]);
        let in_hole = after - before > hole_s && t > before && t < after;
        in_hole || rows.left_out[right - 1] || rows.left_out[right]
    };
    neighbours(&rows.time_s, at).map(between).collect()
}

/// Values seen at other times, in rising order; beyond the ends they stay.
#[must_use]
pub(crate) fn interpolate(time_s: &[f64], values: &[f64], at: &[f64]) -> Vec<f64> {
    let value = |(right, t): (usize, f64)| {
        let (t0, t1) = (time_s[right - 1], time_s[right]);
        let share = ((t - t0) / (t1 - t0)).clamp(0.0, 1.0);
        values[right - 1] + share * (values[right] - values[right - 1])
    };
    neighbours(time_s, at).map(value).collect()
}

/// Values along the cubic through the two rows before and the two after each time (Lagrange); along
/// the line where there are no two, and beyond the ends they stay.
fn interpolate_smoothly(time_s: &[f64], values: &[f64], at: &[f64]) -> Vec<f64> {
    let lines = interpolate(time_s, values, at);
    let value = |((right, t), line): ((usize, f64), f64)| {
        let is_inside = right >= 2 && right + 1 < time_s.len() && t <= time_s[right];
        if is_inside {
            let four = right - 2..right + 2;
            cubic(&time_s[four.clone()], &values[four], t)
        } else {
            line
        }
    };
    neighbours(time_s, at).zip(lines).map(value).collect()
}

/// The polynomial through some points, at a time (Lagrange).
fn cubic(time_s: &[f64], values: &[f64], t: f64) -> f64 {
    let weight = |i: usize| -> f64 {
        let others = time_s.iter().enumerate().filter(|(j, _)| *j != i);
        others
            .map(|(_, other)| (t - other) / (time_s[i] - other))
            .product()
    };
    values
        .iter()
        .enumerate()
        .map(|(i, value)| weight(i) * value)
        .sum()
}

/// Each time with the first row that is not before it (the second row at least, the last at most).
fn neighbours<'a>(time_s: &'a [f64], at: &'a [f64]) -> impl Iterator<Item = (usize, f64)> + 'a {
    let mut right = 1;
    at.iter().map(move |t| {
        while right + 1 < time_s.len() && time_s[right] < *t {
            right += 1;
        }
        (right, *t)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows(time_s: Vec<f64>) -> Rows {
        let position: Vec<f64> = time_s.iter().map(|t| 2.0 * t).collect();
        Rows {
            load: None,
            velocity: Some(time_s.iter().map(|t| 3.0 - t).collect()),
            reference: Some(position.clone()),
            effort: time_s.iter().map(|t| -t).collect(),
            left_out: vec![false; time_s.len()],
            position,
            time_s,
        }
    }

    const CLOCK: Clock = Clock {
        period_s: None,
        origin_s: 1.0,
    };

    fn even(count: i32) -> Vec<f64> {
        (0..count).map(|i| 1.0 + 0.01 * f64::from(i)).collect()
    }

    #[test]
    fn even_rows_stay_as_they_are_and_count_from_the_origin() {
        let record = uniform(rows(even(100)), CLOCK);
        assert_eq!(record.position, rows(even(100)).position);
        assert_eq!(record.time_s[0], 0.0);
        assert_eq!(record.rows[0], (1.0, -1.0));
        assert!(!record.jittered);
    }

    #[test]
    fn a_stated_period_counts_where_it_is_near_the_median_step() {
        let stated = |period_s| Clock {
            period_s: Some(period_s),
            ..CLOCK
        };
        assert_eq!(
            uniform(rows(even(100)), stated(0.010_000_1)).period_s,
            0.010_000_1
        );
        assert!((uniform(rows(even(100)), stated(0.02)).period_s - 0.01).abs() < 1.0e-12);
    }

    #[test]
    fn jitter_is_interpolated_and_a_line_stays_a_line() {
        let jittered = even(200)
            .into_iter()
            .enumerate()
            .map(|(i, t)| t + if i % 2 == 1 { 0.003 } else { 0.0 })
            .collect();
        let clock = Clock {
            period_s: Some(0.01),
            ..CLOCK
        };
        let record = uniform(rows(jittered), clock);
        assert!(record.jittered && !record.interpolated.contains(&true));
        for (t, x) in record.time_s.iter().zip(&record.position) {
            assert!((x - 2.0 * (t + 1.0)).abs() < 1.0e-9, "{t}: {x}");
        }
        let velocity = record.velocity.as_deref().unwrap();
        for (t, v) in record.time_s.iter().zip(velocity) {
            assert!((v - (2.0 - t)).abs() < 1.0e-9, "{t}: {v}");
        }
    }

    #[test]
    fn what_stands_in_a_hole_is_marked_and_its_ends_are_not() {
        // Rows 50 to 69 are missing: 21 steps of 1/128 s, which binary numbers hold exactly.
        let kept = (0..100).filter(|row| !(50..70).contains(row));
        let record = uniform(
            rows(kept.map(|row| f64::from(row) / 128.0).collect()),
            CLOCK,
        );
        assert!(!record.jittered && record.len() == 100);
        let marked: Vec<usize> = (0..100).filter(|row| record.interpolated[*row]).collect();
        assert_eq!(marked, (50..70).collect::<Vec<usize>>());
    }

    #[test]
    fn an_outlier_is_marked_on_an_even_base_and_its_neighbours_are_on_a_jittered_one() {
        let marked = |time_s: Vec<f64>| {
            let mut rows = rows(time_s);
            rows.left_out[50] = true;
            let record = uniform(rows, CLOCK);
            let marked = (0..record.len()).filter(|row| record.interpolated[*row]);
            marked.collect::<Vec<usize>>()
        };
        assert_eq!(marked(even(100)), [50]);
        let mut late = even(100);
        late.iter_mut().skip(1).for_each(|t| *t += 0.003);
        assert_eq!(marked(late), [50, 51]);
    }

    #[test]
    fn a_row_that_is_lost_comes_back_without_a_spike_of_the_acceleration() {
        const OMEGA: f64 = 20.0;
        let kept = (0..200).filter(|row| !(90..92).contains(row) && *row != 150);
        let mut rows = rows(kept.map(|row| f64::from(row) / 1024.0).collect());
        rows.position = rows.time_s.iter().map(|t| (OMEGA * t).sin()).collect();
        let record = uniform(
            rows,
            Clock {
                period_s: None,
                origin_s: 0.0,
            },
        );
        let x = &record.position;
        for row in 1..record.len() - 1 {
            let acceleration = (x[row + 1] - 2.0 * x[row] + x[row - 1]) * 1024.0_f64.powi(2);
            let wanted = -OMEGA.powi(2) * (OMEGA * record.time_s[row]).sin();
            // A line would be off by as much as the acceleration is, 400 at most.
            assert!(
                (acceleration - wanted).abs() < 1.0,
                "{row}: {acceleration} {wanted}"
            );
        }
    }

    #[test]
    fn the_median_step_does_not_see_a_hole() {
        assert_eq!(median_step(&[0.0, 1.0, 2.0, 10.0, 11.0]), 1.0);
    }
}
