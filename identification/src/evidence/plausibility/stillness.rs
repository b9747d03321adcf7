//! A column that stands still while the axis moves: it froze, or it was held between its rows.

use crate::evidence::plausibility::steps::quantile;
use crate::record::extent::range;

/// Shortest time that a column stands still before it froze, s: a reading of a bus that fails comes
/// back sooner.
const FROZEN_S: f64 = 1.0;
/// Share of its travel that another column makes meanwhile.
const MEANWHILE: f64 = 0.05;
/// Share of rows without a change from which an effort was held.
const HELD_SHARE: f64 = 0.8;
/// Share of its distances between changes that are the usual one.
const EVEN_SHARE: f64 = 0.8;
/// Longest hold, s: half a period of the low-pass at 100 Hz.
const LONGEST_HOLD_S: f64 = 5.0e-3;

/// The time from which on a column stands still while another moves, s.
pub(crate) fn frozen_from(values: &[f64], other: &[f64], period_s: f64) -> Option<f64> {
    let (low, high) = range(other);
    let rows = (FROZEN_S / period_s) as usize;
    let run = longest_run(values);
    let (least, most) = range(&other[run.clone()]);
    let moves = most - least > MEANWHILE * (high - low);
    (run.len() > rows && moves).then_some(period_s * run.start as f64)
}

/// The time from which on an effort stands still while the axis goes there and back, s: friction
/// turns over, and even a coarse current shows that.
pub(crate) fn frozen_effort_from(effort: &[f64], position: &[f64], period_s: f64) -> Option<f64> {
    let (low, high) = range(position);
    let least = MEANWHILE * (high - low);
    let goes = |sign: f64| furthest(&position[longest_run(effort)], sign) > least;
    frozen_from(effort, position, period_s).filter(|_| goes(1.0) && goes(-1.0))
}

/// The furthest way in one direction, from any row to any later one.
fn furthest(position: &[f64], sign: f64) -> f64 {
    let mut back = f64::INFINITY;
    let ways = position.iter().map(|x| {
        back = back.min(sign * x);
        sign * x - back
    });
    ways.fold(0.0, f64::max)
}

/// Whether values stand still longest at an end of their range: an effort is at its limit there.
pub(crate) fn is_longest_at_an_end(values: &[f64]) -> bool {
    let (low, high) = range(values);
    let stuck = values.get(longest_run(values).start);
    stuck.is_some_and(|value| [low, high].contains(value))
}

/// The longest run of equal values.
fn longest_run(values: &[f64]) -> std::ops::Range<usize> {
    let (mut best, mut start) = (0..0, 0);
    for row in 1..=values.len() {
        if row == values.len() || values[row] != values[start] {
            if row - start > best.len() {
                best = start..row;
            }
            start = row;
        }
    }
    best
}

/// Rows for which an effort is held, where that is too long.
pub(crate) fn held_rows(effort: &[f64], period_s: f64) -> Option<usize> {
    let changes: Vec<usize> = (1..effort.len())
        .filter(|row| effort[*row] != effort[row - 1])
        .collect();
    let is_still = 1.0 - changes.len() as f64 / effort.len() as f64 > HELD_SHARE;
    let gaps: Vec<f64> = changes
        .windows(2)
        .map(|pair| (pair[1] - pair[0]) as f64)
        .collect();
    let gap = quantile(gaps.iter().copied(), 0.5);
    let even = gaps.iter().filter(|one| **one == gap).count();
    let is_even = even as f64 >= EVEN_SHARE * gaps.len() as f64;
    (is_still && is_even && gap * period_s > LONGEST_HOLD_S).then_some(gap as usize)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulate::made::two_sines;

    fn frozen_for(rows: usize) -> Option<f64> {
        let motion = two_sines(4000);
        let mut values = motion.clone();
        values[1000..1000 + rows].fill(motion[1000]);
        frozen_from(&values, &motion, 1.0e-3)
    }

    #[test]
    fn a_column_froze_where_it_stands_for_more_than_a_second_of_motion() {
        assert_eq!(frozen_for(1500), Some(1.0));
        assert_eq!(frozen_for(900), None);
        let rest = vec![0.0; 4000];
        assert_eq!(frozen_from(&rest, &rest, 1.0e-3), None);
    }

    #[test]
    fn an_effort_froze_where_the_axis_comes_back_meanwhile() {
        let motion = two_sines(4000);
        let effort_of = |rows: std::ops::Range<usize>| -> Vec<f64> {
            let mut effort = motion.clone();
            effort[rows].fill(1.0);
            effort
        };
        let froze = |path: &[f64]| frozen_effort_from(&effort_of(1000..2500), path, 1.0e-3);
        assert_eq!(froze(&motion), Some(1.0));
        let one_way: Vec<f64> = (0..4000).map(f64::from).collect();
        assert_eq!(froze(&one_way), None);
        let way = [3.0, 1.0, 4.0, 2.0];
        assert_eq!((furthest(&way, 1.0), furthest(&way, -1.0)), (3.0, 2.0));
    }

    #[test]
    fn an_effort_at_its_limit_stands_at_an_end_of_its_range() {
        assert!(is_longest_at_an_end(&[1.0, 3.0, 3.0, 3.0, 2.0, 2.0]));
        assert!(!is_longest_at_an_end(&[1.0, 3.0, 2.0, 2.0, 2.0]));
    }

    #[test]
    fn an_effort_is_held_where_it_changes_at_even_distances_above_five_milliseconds() {
        let held = |rows: usize| -> Vec<f64> {
            (0..4000)
                .map(|row| (0.7 * (row / rows) as f64).sin())
                .collect()
        };
        assert_eq!(held_rows(&held(50), 1.0e-3), Some(50));
        assert_eq!(held_rows(&held(1), 1.0e-3), None);
        assert_eq!(held_rows(&held(6), 1.0e-3), Some(6));
        assert_eq!(held_rows(&held(6), 2.0e-4), None);
        let coarse: Vec<f64> = two_sines(4000)
            .iter()
            .map(|x| (100.0 * x).round())
            .collect();
        assert_eq!(held_rows(&coarse, 1.0e-3), None);
    }
}
