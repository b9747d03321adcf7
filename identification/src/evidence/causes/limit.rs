//! An effort that is cut off by the log and not by the drive.
//!
//! Where a drive is at its limit, the axis gets no more than that. Where only the log is, the axis
//! goes on as the true effort makes it: the motion there asks for more than was recorded.

use crate::evidence::causes::rigid::Rigid;
use crate::record::extent::range;

/// Share of the rows at one value from which that value is a limit.
const LEAST_SHARE: f64 = 0.01;
/// Rows within this time of a limit are not fitted, s: the low-pass mixes them.
const MARGIN_S: f64 = 0.05;
/// What the motion asks for beyond the limit, as a share of half the range of the effort.
const BEYOND: f64 = 0.1;

/// The cause, where the effort stands at an end of its range against the motion.
pub(crate) fn cause(rigid: &Rigid, effort: &[f64], column: &str) -> Option<String> {
    let (low, high) = range(effort);
    let at_end = |end: f64| effort.iter().filter(|u| **u == end).count();
    let is_limit = |end: f64| at_end(end) as f64 > LEAST_SHARE * effort.len() as f64;
    let ends: Vec<f64> = [low, high]
        .into_iter()
        .filter(|end| is_limit(*end))
        .collect();
    if ends.is_empty() {
        return None;
    }
    let near = near(effort, &ends, (MARGIN_S / rigid.period_s) as usize);
    let fit = rigid.fit_where(&|row| !near[row])?;
    let asked = |end: f64| {
        let at_end = |row: usize| effort[row] == end;
        rigid.mean_predicted(fit.coefficients, &at_end)
    };
    let beyond = |end: &f64| {
        let over = asked(*end)? - end;
        let outwards = if *end == high { over } else { -over };
        (outwards > BEYOND * 0.5 * (high - low)).then_some((*end, over + end))
    };
    let (end, asked) = ends.iter().find_map(beyond)?;
    Some(format!(
        "{column} is cut off at {end:.4}: the motion there asks for {asked:.4} in the mean"
    ))
}

/// Rows within a margin of those at one of the ends.
fn near(effort: &[f64], ends: &[f64], margin: usize) -> Vec<bool> {
    let mut near = vec![false; effort.len()];
    let rows = effort.iter().enumerate();
    for (row, _) in rows.filter(|(_, u)| ends.contains(u)) {
        let until = (row + margin + 1).min(near.len());
        near[row.saturating_sub(margin)..until].fill(true);
    }
    near
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::made::{axis, usual};

    fn said(limit: f64) -> String {
        let mut axis = axis(usual);
        let effort = &mut axis.dataset.train.effort;
        for u in effort.iter_mut() {
            *u = u.min(limit);
        }
        let effort = effort.clone();
        axis.put(|_, row| effort[row]);
        axis.dataset.train.effort.clone_from(&effort);
        let rigid = Rigid::of(&axis.dataset, &axis.motion);
        cause(&rigid, &effort, "force_n").unwrap_or_default()
    }

    #[test]
    fn a_log_that_is_cut_off_is_told_and_a_peak_is_not() {
        assert!(said(20.0).starts_with("force_n is cut off at 20.0000: the motion there asks for"));
        assert_eq!(said(1.0e6), "");
    }

    #[test]
    fn rows_near_a_limit_are_those_within_the_margin() {
        let near = near(&[0.0, 1.0, 2.0, 3.0, 2.0, 1.0], &[3.0], 1);
        assert_eq!(near, [false, false, true, true, true, false]);
    }
}
