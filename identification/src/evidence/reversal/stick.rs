//! Rigid Coulomb friction with a stick phase.

use super::Observed;

/// The axis stands while it moves less than this, counts in six samples.
const STICK_COUNTS: f64 = 1.5;

/// What rigid friction does not explain: at standstill it holds up to the level.
#[must_use]
pub(crate) fn error(observed: &Observed<'_>) -> Vec<f64> {
    let motion = observed.motion;
    let x = &motion.friction_position;
    let slipping: Vec<f64> = observed
        .level
        .iter()
        .zip(&motion.direction)
        .map(|(level, d)| level * d)
        .collect();
    let slipping = motion.low_passed(&slipping);
    (0..motion.len())
        .map(|at| {
            let (from, to) = (at.saturating_sub(3), (at + 3).min(motion.len() - 1));
            if (x[to] - x[from]).abs() <= STICK_COUNTS * observed.resolution {
                let level = observed.level[at].abs();
                observed.friction[at] - observed.friction[at].min(level).max(-level)
            } else {
                observed.friction[at] - slipping[at]
            }
        })
        .collect()
}
