//! How much structure is left in a residual.
//!
//! Rows are correlated, so no row-wise whiteness test is honest. Judged instead by the share of the
//! residual's variance that general features (velocity by direction, position, time: piecewise
//! linear) explain on held-out blocks, and by the share of the best single candidate; the larger of
//! the two counts. General features alone miss ripple and delay, and over-fit into negative shares.

use crate::fit::blocks::Blocks;
use crate::motion::kinematics::Kinematics;

/// Features of one kind.
#[derive(Clone, Debug)]
pub(crate) struct Structure {
    /// Over what.
    pub over: &'static str,
    /// Share of the residual's variance on held-out blocks, floored at zero.
    pub share: f64,
}

/// Shares by kind of feature, largest first.
#[must_use]
pub(crate) fn structures(motion: &Kinematics, residual: &[f64]) -> Vec<Structure> {
    let forwards = split(&motion.velocity_lp, 1.0);
    let backwards = split(&motion.velocity_lp, -1.0);
    let kinds: [(&'static str, Vec<Vec<f64>>); 3] = [
        (
            "velocity by direction",
            [hats(&forwards, motion, 8), hats(&backwards, motion, 8)].concat(),
        ),
        ("position", hats(&motion.position_lp, motion, 12)),
        ("time", hats(&motion.time_s, motion, 8)),
    ];
    let mut shares: Vec<Structure> = kinds
        .into_iter()
        .map(|(over, columns)| Structure {
            over,
            share: share(motion, residual, &columns),
        })
        .collect();
    shares.sort_by(|a, b| b.share.total_cmp(&a.share));
    shares
}

fn split(values: &[f64], sign: f64) -> Vec<f64> {
    values
        .iter()
        .map(|v| if v * sign > 0.0 { *v } else { f64::NAN })
        .collect()
}

/// Piecewise linear features with knots at quantiles of the moving samples; `NaN` stands outside.
fn hats(values: &[f64], motion: &Kinematics, count: usize) -> Vec<Vec<f64>> {
    let moving = values
        .iter()
        .zip(&motion.moving)
        .filter(|(v, moving)| **moving && v.is_finite());
    let mut sorted: Vec<f64> = moving.map(|(v, _)| *v).collect();
    sorted.sort_by(f64::total_cmp);
    if sorted.len() < 100 {
        return Vec::new();
    }
    let mut knots: Vec<f64> = (0..count)
        .map(|i| sorted[i * (sorted.len() - 1) / (count - 1)])
        .collect();
    knots.dedup_by(|a, b| (*a - *b).abs() <= 1.0e-12);
    (0..knots.len())
        .map(|at| values.iter().map(|v| hat(&knots, at, *v)).collect())
        .collect()
}

fn hat(knots: &[f64], at: usize, value: f64) -> f64 {
    if !value.is_finite() {
        return 0.0;
    }
    let rise = at.checked_sub(1).map_or(
        if value <= knots[at] {
            1.0
        } else {
            f64::INFINITY
        },
        |left| (value - knots[left]) / (knots[at] - knots[left]),
    );
    let fall = knots.get(at + 1).map_or(
        if value >= knots[at] {
            1.0
        } else {
            f64::INFINITY
        },
        |right| (right - value) / (right - knots[at]),
    );
    rise.min(fall).clamp(0.0, 1.0)
}

fn share(motion: &Kinematics, residual: &[f64], columns: &[Vec<f64>]) -> f64 {
    if columns.is_empty() {
        return 0.0;
    }
    let views: Vec<&[f64]> = columns.iter().map(Vec::as_slice).collect();
    let fit = Blocks::new(&views, residual, &motion.moving, motion.period_s).cross_validate();
    let left: f64 = fit.held_out.iter().sum();
    (1.0 - left / fit.total.max(f64::MIN_POSITIVE)).max(0.0)
}
