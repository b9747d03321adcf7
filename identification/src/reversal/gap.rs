//! A gap between motor and load, seen from the motor alone.
//!
//! In contact the motor feels the load's friction and mass; while it crosses the gap it feels neither:
//! `observed = G sign(v2) + M2 (a2 − a1)`, with the load's motion from [`crate::load`]; where the load stands in contact, friction is whatever holds.

use super::{Observed, rms};
use crate::load::Behind;
use crate::search::golden;

/// A gap and the share of the moved mass that stands behind it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Gap {
    /// Width.
    pub width: f64,
    /// Load mass over moved mass.
    pub share: f64,
}

/// Gaps that are searched, in moving-velocity units times a second: 1 to 300 µm on a linear axis.
const SMALLEST: f64 = 1.0e-3;
const LARGEST: f64 = 0.3;
/// Shares of the moved mass that are tried.
const SHARES: [f64; 4] = [0.25, 0.4, 0.55, 0.7];

/// The best gap and what it leaves; `unit` is the moving velocity.
#[must_use]
pub fn best(observed: &Observed<'_>, unit: f64) -> (Gap, Vec<f64>) {
    let left = |gap: Gap| rms(&error(observed, gap), &observed.about);
    let grid = crate::effects::geometric(SMALLEST * unit, LARGEST * unit, 20);
    let width = crate::search::smallest(grid, &|width| left(Gap { width, share: 0.4 })).unwrap_or(unit);
    let share = crate::search::smallest(SHARES.to_vec(), &|share| left(Gap { width, share })).unwrap_or(0.4);
    let width = golden(width / 1.5, width * 1.5, &|width| left(Gap { width, share }));
    let share = golden((share - 0.15).max(0.1), (share + 0.15).min(0.9), &|share| left(Gap { width, share }));
    let gap = Gap { width, share };
    (gap, error(observed, gap))
}

/// What a gap does not explain.
#[must_use]
pub fn error(observed: &Observed<'_>, gap: Gap) -> Vec<f64> {
    let motion = observed.motion;
    let rows = motion.len();
    let mass = gap.share * observed.inertia;
    let typical = typical_level(observed);
    let moved = mass.max(f64::MIN_POSITIVE);
    let (coulomb, viscous) = (typical / moved, observed.viscous.max(0.0) / moved);
    let behind = Behind { gap: gap.width, coulomb, viscous, restitution: 0.0 };
    let load = behind.follow(&motion.raw_position, motion.period_s);
    let at = |values: &[f64], row: usize| values[row.min(rows - 1)];
    let mut force = vec![0.0; rows];
    let mut held = vec![false; rows];
    for row in 0..rows {
        let acceleration =
            (at(&load.velocity, row + 1) - load.velocity[row.saturating_sub(1)]) / (2.0 * motion.period_s);
        let velocity = load.velocity[row];
        let moves = velocity.abs() > 0.0;
        let friction = if moves { observed.level[row].abs() * velocity.signum() } else { 0.0 };
        force[row] = friction + mass * (acceleration - motion.acceleration[row]);
        held[row] = !moves && load.lag[row].abs() >= 0.499 * gap.width;
    }
    let force = motion.filter.apply(&force);
    (0..rows)
        .map(|row| {
            let seen = observed.friction[row];
            let level = observed.level[row].abs();
            if held[row] { seen - seen.clamp(-level, level.max(0.0)) } else { seen - force[row] }
        })
        .collect()
}

fn typical_level(observed: &Observed<'_>) -> f64 {
    let about = observed.level.iter().zip(&observed.about).filter(|(_, about)| **about);
    let (sum, count) = about.fold((0.0, 0.0), |(sum, count), (level, _)| (sum + level.abs(), count + 1.0));
    sum / f64::max(count, 1.0)
}
