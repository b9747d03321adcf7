//! The burst at a reversal: how far the path leaves the circle there.

use std::f64::consts::TAU;

use super::point::Point;
use super::reversals::apart;

/// The larger one; `NaN` where one of them is, so that a diverged run never looks perfect.
#[must_use]
pub const fn larger(one: f64, other: f64) -> f64 {
    if one.is_nan() || other.is_nan() {
        f64::NAN
    } else {
        one.max(other)
    }
}

/// A path with its radial deviations, and what of it is looked at.
#[derive(Clone, Copy)]
pub(super) struct Deviating<'a> {
    /// The path.
    pub(super) points: &'a [Point],
    /// Its radial deviations, µm.
    pub(super) deviation_um: &'a [f64],
    /// Their median, µm.
    pub(super) median_um: f64,
    /// Half width of the window about a reversal, rad.
    pub(super) window_rad: f64,
    /// Where the turns that count begin, rad.
    pub(super) from_rad: f64,
}

impl Deviating<'_> {
    /// Mean over the turns of the largest deviation in the window about `at`, µm; turns of which
    /// the window was lost do not count. A diverged run has no burst but `NaN`, so that it
    /// never looks perfect, and so has one that was lost there; an empty path has zero.
    pub(super) fn burst_um(&self, at: f64) -> f64 {
        let mut largest: Vec<Option<f64>> = Vec::new();
        for (point, deviation) in self.points.iter().zip(self.deviation_um) {
            if apart(point.angle_rad, at) > self.window_rad {
                continue;
            }
            let turn = self.turn(point);
            if largest.len() <= turn {
                largest.resize(turn + 1, None);
            }
            let size = (deviation - self.median_um).abs();
            largest[turn] = Some(larger(size, largest[turn].unwrap_or(0.0)));
        }
        let seen: Vec<f64> = largest.into_iter().flatten().collect();
        match (seen.len(), self.points.len()) {
            (0, 0) => 0.0,
            (0, _) => f64::NAN,
            (count, _) => seen.iter().sum::<f64>() / count as f64,
        }
    }

    /// Turns counted so that a window is never cut in two: from the middle between reversals.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a few turns, never negative"
    )]
    fn turn(&self, point: &Point) -> usize {
        ((point.angle_rad - self.from_rad).max(0.0) / TAU) as usize
    }
}
