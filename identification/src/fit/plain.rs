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
        let ones = vec![1.0; motion.len()];
        let columns = [
            motion.low_passed(&motion.acceleration),
            motion.low_passed(&motion.velocity),
            motion.low_passed(&motion.direction),
            ones,
        ];
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
}
