//! The usual model, `u = M a + Fv v + Fc sign(v) + F0`, without selection: for start values and for
//! tests of what can be physical.

use crate::fit::blocks::Blocks;
use crate::motion::kinematics::Kinematics;

/// Its parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Plain {
    /// Moved mass.
    pub inertia: f64,
    /// Viscous friction.
    pub viscous: f64,
    /// Coulomb friction.
    pub coulomb: f64,
}

impl Plain {
    /// Least squares on moving samples.
    #[must_use]
    pub(crate) fn fit(motion: &Kinematics) -> Self {
        Self::beside(motion, None)
    }

    /// The moved mass, motor and load: that of the usual model, or more where the load's own
    /// acceleration was measured and says so. A load that waits in a gap or swings on a spring
    /// takes a part of its mass out of what goes with the motor.
    #[must_use]
    pub(crate) fn moved_mass(motion: &Kinematics) -> f64 {
        let usual = Self::fit(motion).inertia;
        let own = motion.load_acceleration.as_deref();
        let both = own.map(|own| Self::beside(motion, Some(own)).inertia);
        both.map_or(usual, |both| both.max(usual))
    }

    fn beside(motion: &Kinematics, more: Option<&[f64]>) -> Self {
        let columns = [
            motion.low_passed(&motion.acceleration),
            motion.low_passed(&motion.velocity),
            motion.low_passed(&motion.direction),
            vec![1.0; motion.len()],
        ];
        let more = more.map(|column| motion.low_passed(column));
        let columns: Vec<Vec<f64>> = columns.into_iter().chain(more).collect();
        let views: Vec<&[f64]> = columns.iter().map(Vec::as_slice).collect();
        let blocks = Blocks::new(&views, &motion.effort_lp, &motion.fitted, motion.period_s);
        let coefficients = blocks.fit().coefficients;
        Self {
            inertia: coefficients[0],
            viscous: coefficients[1],
            coulomb: coefficients[2],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::made::{USUAL, axis, usual};

    #[test]
    fn the_usual_axis_has_the_usual_parameters() {
        let plain = Plain::fit(&axis(usual).motion);
        let found = [plain.inertia, plain.viscous, plain.coulomb];
        for (found, wanted) in found.into_iter().zip(USUAL) {
            assert!((found / wanted - 1.0).abs() < 1.0e-3, "{found} {wanted}");
        }
    }

    #[test]
    fn a_load_that_swings_on_its_own_is_in_the_moved_mass() {
        let mut axis = axis(usual);
        // 40 kg follow a fifth of the motor's acceleration, and swing.
        let swing = |row: usize| 2.0 * (50.0 * 1.0e-3 * row as f64).sin();
        let of_motor = axis.motion.acceleration.iter().enumerate();
        let own: Vec<f64> = of_motor.map(|(row, a)| swing(row) - 0.8 * a).collect();
        axis.put(|motion, row| usual(motion, row) + 40.0 * own[row]);
        axis.motion.load_acceleration = Some(own);
        let [plain, moved] = [
            Plain::fit(&axis.motion).inertia,
            Plain::moved_mass(&axis.motion),
        ];
        assert!(plain < 0.8 * USUAL[0], "{plain}");
        assert!((moved / USUAL[0] - 1.0).abs() < 1.0e-3, "{moved}");
    }
}
