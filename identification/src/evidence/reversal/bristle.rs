//! Friction with a bristle: force G·z, whose state z follows the measured position, by Dahl's law
//! ([`friction`](crate::simulate::friction)) or by Maxwell slip ([`mod@super::slip`]).

use super::slip::Elements;
use super::{Observed, rms};
use crate::fit::search::golden;
use crate::motion::kinematics::Kinematics;
use crate::simulate::friction::bend_after;

/// Deflections that are searched, in moving-velocity units times a second: 0.3 to 300 µm on a
/// linear axis.
const SMALLEST: f64 = 3.0e-4;
const LARGEST: f64 = 0.3;

/// Dahl's state, −1…1, along a position.
#[must_use]
pub(crate) fn state(position: &[f64], deflection: f64) -> Vec<f64> {
    let mut state = 0.0_f64;
    let mut before = position.first().copied().unwrap_or(0.0);
    position
        .iter()
        .map(|x| {
            let step = x - before;
            before = *x;
            state = bend_after(state, step, deflection);
            state
        })
        .collect()
}

/// The best deflection and what it leaves; `unit` is the moving velocity.
#[must_use]
pub(crate) fn best(observed: &Observed<'_>, unit: f64) -> (f64, Vec<f64>) {
    let left = |deflection: f64| rms(&error(observed, deflection), &observed.motion.slow);
    let start = crate::fit::search::smallest(&deflections(unit), &left).unwrap_or(unit);
    let deflection = golden(start / 1.4, start * 1.4, &left);
    (deflection, error(observed, deflection))
}

/// Deflections to start from.
pub(crate) fn deflections(unit: f64) -> Vec<f64> {
    crate::model::effects::geometric(SMALLEST * unit, LARGEST * unit, 24)
}

/// What a bristle does not explain.
#[must_use]
pub(crate) fn error(observed: &Observed<'_>, deflection: f64) -> Vec<f64> {
    observed.without(&state(&observed.motion.friction_position, deflection))
}

/// A bristle of either law.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Bristle {
    /// Dahl's law of a deflection.
    Dahl(f64),
    /// Maxwell slip.
    Slip(Elements),
}

impl Bristle {
    /// Level over stiffness at standstill.
    pub(crate) fn deflection(&self) -> f64 {
        match self {
            Self::Dahl(deflection) => *deflection,
            Self::Slip(elements) => elements.deflection(),
        }
    }

    /// The same law, its ways multiplied.
    pub(crate) fn scaled(&self, factor: f64) -> Self {
        match self {
            Self::Dahl(deflection) => Self::Dahl(factor * deflection),
            Self::Slip(elements) => Self::Slip(elements.scaled(factor)),
        }
    }

    /// Motion whose direction columns follow the bristle's state instead of the sign.
    #[must_use]
    pub(crate) fn motion(&self, motion: &Kinematics) -> Kinematics {
        Kinematics {
            direction: self.state(motion),
            ..motion.clone()
        }
    }

    /// What it does not explain of an observed friction.
    pub(super) fn error(&self, observed: &Observed<'_>) -> Vec<f64> {
        match self {
            Self::Dahl(deflection) => error(observed, *deflection),
            Self::Slip(elements) => elements.error(observed),
        }
    }

    /// State, −1…1.
    fn state(&self, motion: &Kinematics) -> Vec<f64> {
        match self {
            Self::Dahl(deflection) => state(&motion.friction_position, *deflection),
            Self::Slip(elements) => elements.state(motion),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::made::{axis, usual};

    #[test]
    fn what_is_left_is_the_friction_less_the_level_times_the_bend() {
        let mut axis = axis(usual);
        let motion = &mut axis.motion;
        let rows = motion.len();
        for sign in [1.0, -1.0] {
            motion.friction_position = (0..rows).map(|row| sign * row as f64).collect();
            let left = error(
                &Observed {
                    motion,
                    level: vec![10.0; rows],
                    friction: vec![12.0; rows],
                    resolution: 1.0,
                },
                5.0,
            );
            let wanted = 12.0 - sign * 10.0;
            let near = |left: &f64| (left - wanted).abs() < 1.0e-9;
            assert!(left[1000..5000].iter().all(near), "{}", left[3000]);
        }
    }

    #[test]
    fn deflections_are_tried_from_0_3_to_300_micrometres_on_a_linear_axis() {
        let tried = deflections(1.0e-3);
        assert_eq!(tried.len(), 24);
        assert!((tried[0] / 0.3e-6 - 1.0).abs() < 1.0e-9);
        assert!((tried[23] / 300.0e-6 - 1.0).abs() < 1.0e-9);
    }

    #[test]
    fn a_motion_with_a_bristle_has_its_bend_for_a_direction_and_all_else_as_it_was() {
        let plain = axis(usual).motion;
        let bent = Bristle::Dahl(2.0e-4).motion(&plain);
        assert_eq!(bent.direction, state(&plain.friction_position, 2.0e-4));
        assert!(bent.direction != plain.direction && bent.direction.len() == plain.len());
        assert_eq!((bent.velocity, bent.moving), (plain.velocity, plain.moving));
    }

    #[test]
    fn the_bristle_saturates_and_reverses_over_its_deflection() {
        let there: Vec<f64> = (0..100).map(f64::from).collect();
        let back: Vec<f64> = (0..100).map(|i| 99.0 - f64::from(i)).collect();
        let state = state(&[there, back].concat(), 5.0);
        assert!((state[99] - 1.0).abs() < 1.0e-6 && (state[199] + 1.0).abs() < 1.0e-6);
        // One deflection after the reversal (row 100 repeats the turning point): −1 + 2/e.
        assert!((state[105] - (2.0 * (-1.0_f64).exp() - 1.0)).abs() < 1.0e-6);
    }
}
