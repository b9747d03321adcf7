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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::made::{Axis, axis, usual};

    /// What is left of a friction of 12 at a level of 10, in motion in the positive direction.
    fn left(axis: &mut Axis, friction: f64, position: impl Fn(usize) -> f64) -> Vec<f64> {
        let motion = &mut axis.motion;
        let rows = motion.len();
        motion.direction.fill(1.0);
        motion.friction_position = (0..rows).map(position).collect();
        error(&Observed {
            motion,
            level: vec![10.0; rows],
            friction: vec![friction; rows],
            resolution: 1.0,
        })
    }

    #[test]
    fn at_standstill_friction_holds_up_to_its_level_in_both_directions() {
        let mut axis = axis(usual);
        for (friction, wanted) in [
            (0.0, 0.0),
            (10.0, 0.0),
            (-10.0, 0.0),
            (12.0, 2.0),
            (-12.0, -2.0),
        ] {
            let left = left(&mut axis, friction, |_| 5.0);
            assert!(left.iter().all(|left| *left == wanted), "{friction}");
        }
    }

    #[test]
    fn in_motion_friction_has_its_level_against_the_motion() {
        let mut axis = axis(usual);
        for (friction, wanted) in [(0.0, -10.0), (12.0, 2.0), (-12.0, -22.0)] {
            let left = left(&mut axis, friction, |row| row as f64);
            let middle = &left[1000..5000];
            let near = |left: &f64| (left - wanted).abs() < 1.0e-9;
            assert!(middle.iter().all(near), "{friction}");
        }
    }

    #[test]
    fn the_axis_stands_up_to_one_and_a_half_counts_in_six_rows() {
        let mut axis = axis(usual);
        let mut stands = |a_row: f64| left(&mut axis, 0.0, |row| a_row * row as f64)[3000] == 0.0;
        assert!(stands(0.25) && stands(-0.25) && !stands(0.26) && !stands(-0.26));
    }

    #[test]
    fn three_rows_before_and_after_a_step_are_in_motion() {
        let mut axis = axis(usual);
        let left = left(&mut axis, 0.0, |row| if row < 3000 { 0.0 } else { 9.0 });
        let moving: Vec<usize> = (0..6000).filter(|row| left[*row] != 0.0).collect();
        assert_eq!(moving, (2997..3003).collect::<Vec<usize>>());
    }
}
