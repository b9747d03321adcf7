//! An effort that is read at the wrong time: rows late or early, by another clock, as a mean,
//! behind a filter.
//!
//! A shift by a row or two is a delay and has a name. Here it is one that no bus has.

use crate::evidence::causes::rigid::{Rigid, RigidFit};
use crate::evidence::causes::worth::explains;

/// Longest shift and longest mean that are tried, s.
const LONGEST_S: f64 = 0.1;
/// Step of the search, s: a sixth of a period at 30 Hz.
const STEP_S: f64 = 5.0e-3;
/// A shorter shift is a delay of a bus or of a log, s: three cycles at 1 kHz.
const SHORTEST_S: f64 = 3.0e-3;
/// A shorter lag is that of a current loop, s.
const SHORTEST_LAG_S: f64 = 1.0e-2;
/// Largest error of a clock that is tried: crystals are within 0.01 %, counters of a wrong rate are
/// off by percents.
const LARGEST_RATE: f64 = 0.03;

/// A reading of the effort, and what it leaves.
pub(crate) struct Reading {
    /// In words that follow the column's name.
    pub words: String,
    /// Share of the effort's variance.
    pub left: f64,
}

/// Readings at other times.
pub(crate) fn readings(rigid: &Rigid) -> Vec<Reading> {
    let readings = [shift(rigid), clock(rigid), mean(rigid), lag(rigid)];
    readings.into_iter().flatten().collect()
}

/// The cause that explains most of what is left.
pub(crate) fn cause(readings: Vec<Reading>, left: f64, column: &str) -> Option<String> {
    let explain = |reading: &Reading| explains(left, reading.left);
    let readings = readings.into_iter().filter(explain);
    let best = readings.min_by(|one, other| one.left.total_cmp(&other.left))?;
    Some(format!(
        "{column} {}: so read, the axis leaves {:.2} % of its square instead of {:.1} %",
        best.words,
        100.0 * best.left,
        100.0 * left
    ))
}

/// The number of a list that leaves least.
fn best(
    numbers: impl Iterator<Item = f64>,
    fit: impl Fn(f64) -> Option<RigidFit>,
) -> Option<(f64, f64)> {
    let fits = numbers.filter_map(|number| Some((number, fit(number)?.left)));
    fits.min_by(|one, other| one.1.total_cmp(&other.1))
}

/// Numbers from −`most` to `most` about another.
fn about(middle: f64, most: f64, step: f64) -> impl Iterator<Item = f64> {
    let steps = (most / step).round() as i32;
    (-steps..=steps).map(move |at| middle + step * f64::from(at))
}

/// The number that leaves least, searched coarsely and then about the best.
fn searched(most: f64, step: f64, fit: impl Fn(f64) -> Option<RigidFit>) -> Option<(f64, f64)> {
    let (coarse, _) = best(about(0.0, most, step), &fit)?;
    let (finer, _) = best(about(coarse, step, 0.1 * step), &fit)?;
    best(about(finer, 0.1 * step, 0.01 * step), &fit)
}

fn shift(rigid: &Rigid) -> Option<Reading> {
    let in_rows = |time_s: f64| time_s / rigid.period_s;
    let fit = |rows: f64| rigid.fit_later(&|_| rows);
    let (rows, left) = searched(in_rows(LONGEST_S), in_rows(STEP_S), fit)?;
    let time_s = rigid.period_s * rows;
    let side = if rows > 0.0 { "late" } else { "early" };
    let words = format!(
        "is {:.1} rows {side} ({:.1} ms)",
        rows.abs(),
        1.0e3 * time_s.abs()
    );
    let is_long = (SHORTEST_S..LONGEST_S).contains(&time_s.abs());
    is_long.then_some(Reading { words, left })
}

fn clock(rigid: &Rigid) -> Option<Reading> {
    let duration_s = rigid.period_s * rigid.len() as f64;
    let fit = |rate: f64| rigid.fit_later(&|row| rate * row as f64);
    let (rate, left) = searched(LARGEST_RATE, STEP_S / duration_s, fit)?;
    let side = if rate > 0.0 { "slow" } else { "fast" };
    let words = format!("has a clock that goes {:.2} % {side}", 100.0 * rate.abs());
    Some(Reading { words, left })
}

fn mean(rigid: &Rigid) -> Option<Reading> {
    let step = (STEP_S / rigid.period_s).max(1.0);
    let windows = (1..).map(|at| step * f64::from(at));
    let windows = windows.take_while(|rows| rows * rigid.period_s <= LONGEST_S);
    let (rows, left) = best(windows, |rows| rigid.fit_means(rows.round() as usize))?;
    let words = format!("looks like a mean of the last {rows:.0} rows");
    Some(Reading { words, left })
}

fn lag(rigid: &Rigid) -> Option<Reading> {
    // Up to ten times the shortest, a fifth more each time.
    let lags = (0..13).map(|at| SHORTEST_LAG_S * 1.2_f64.powi(at));
    let (lag_s, left) = best(lags, |lag_s| rigid.fit_lagged(lag_s))?;
    let words = format!("lags like a filter of {:.0} ms", 1.0e3 * lag_s);
    Some(Reading { words, left })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::made::{axis, usual};
    use crate::motion::kinematics::Kinematics;

    fn said(law: impl Fn(&Kinematics, usize) -> f64) -> String {
        let axis = axis(law);
        let rigid = Rigid::of(&axis.dataset, &axis.motion);
        let left = rigid.fit().unwrap().left;
        cause(readings(&rigid), left, "force_n").unwrap_or_default()
    }

    #[test]
    fn a_shift_is_told_with_its_side_and_its_rows() {
        let late = said(|motion, row| usual(motion, row.saturating_sub(30)));
        assert!(
            late.starts_with("force_n is 30.0 rows late (30.0 ms)"),
            "{late}"
        );
        let early = said(|motion, row| usual(motion, (row + 30).min(5999)));
        assert!(early.starts_with("force_n is 30.0 rows early"), "{early}");
    }

    #[test]
    fn a_delay_of_two_rows_has_a_name_and_is_no_cause() {
        assert_eq!(said(|motion, row| usual(motion, row.saturating_sub(2))), "");
    }

    #[test]
    fn a_clock_that_goes_wrong_is_told_with_its_rate() {
        let fast = said(|motion, row| usual(motion, (row + row / 50).min(5999)));
        assert!(
            fast.starts_with("force_n has a clock that goes 1.9"),
            "{fast}"
        );
        assert!(fast.contains("% fast"), "{fast}");
    }

    #[test]
    fn a_mean_is_told_with_its_length() {
        let mean = said(|motion, row| {
            let rows = row.saturating_sub(99)..=row;
            rows.map(|row| usual(motion, row)).sum::<f64>() / 100.0
        });
        assert!(mean.contains("a mean of the last 100 rows"), "{mean}");
    }

    #[test]
    fn a_filter_is_told_with_its_lag() {
        let lagged = said(|motion, row| {
            let rows = row.saturating_sub(300)..=row;
            let weights = rows.clone().map(|at| (-((row - at) as f64) / 40.0).exp());
            let sum: f64 = weights.clone().sum();
            rows.zip(weights)
                .map(|(at, weight)| weight * usual(motion, at) / sum)
                .sum()
        });
        assert!(lagged.contains("lags like a filter of 43 ms"), "{lagged}");
    }
}
