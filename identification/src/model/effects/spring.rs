//! A force that depends on position alone: no effect of the list, but it must not be absorbed by
//! one. So it may have four terms: what a spring, a cable or a weight that swings leaves of a
//! parabola looks like a ripple.

use super::{Action, Against, Effect, Instant, Kinematics, Named, Naming, Setting, polynomial};
use crate::model::name::Called;
use crate::record::dataset::Dataset;

/// a u + b u², or four powers.
pub(crate) struct Spring;

/// Its choices. With four terms half a turn of a weight is known within a hundredth of it.
const TERMS: [f64; 3] = [1.0, 2.0, 4.0];

/// A polynomial of any degree in position: what a wave of few periods must not be taken for. The
/// nonlinear parameter is its degree.
pub(crate) struct SmoothForce;

impl Effect for SmoothForce {
    fn called(&self) -> Called {
        Called::Structure("smooth force over position")
    }

    fn equation(&self) -> &'static str {
        "a1 u + a2 u^2 + ..., u = position over the travel, -1 to 1"
    }

    fn columns(&self, motion: &Kinematics, dataset: &Dataset, degree: f64) -> Vec<Vec<f64>> {
        let u = polynomial::over_travel(motion, dataset);
        polynomial::of_degree(u.map(|u| (u, 1.0)), self.width(degree))
    }

    fn width(&self, degree: f64) -> usize {
        degree as usize
    }

    fn parameters(&self, _: &Naming<'_>) -> Vec<Named> {
        Vec::new()
    }
}

impl Effect for Spring {
    fn called(&self) -> Called {
        Called::Structure("force over position")
    }

    fn equation(&self) -> &'static str {
        "a u + b u^2 (+ c u^3 + d u^4), u = position over the travel, -1 to 1"
    }

    fn columns(&self, motion: &Kinematics, dataset: &Dataset, terms: f64) -> Vec<Vec<f64>> {
        let u = polynomial::over_travel(motion, dataset);
        polynomial::columns(u.map(|u| (u, 1.0)), terms)
    }

    fn width(&self, terms: f64) -> usize {
        polynomial::width(terms)
    }

    fn against(&self) -> Against {
        Against::Position
    }

    fn action(&self, at: &Instant, _: f64, own: &[f64]) -> Action {
        Action::force(polynomial::value(own, at.scaled))
    }

    fn grid(&self, _: &Kinematics, _: &Setting<'_>) -> Vec<f64> {
        TERMS.to_vec()
    }

    fn parameters(&self, naming: &Naming<'_>) -> Vec<Named> {
        vec![naming.coefficient(
            "force_over_position",
            0,
            naming.effort_unit(" over half the travel"),
        )]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::made::{axis, model, usual};
    use crate::model::inverse::Part;
    use axis_model::EffectName::{Coulomb, Inertia, Offset, Viscous};

    #[test]
    fn four_terms_leave_a_hundredth_of_a_weight_that_swings_half_a_turn() {
        let (middle, half) = axis(usual).dataset.travel();
        let axis = axis(|motion, row| {
            let u = (motion.position_lp[row] - middle) / half;
            usual(motion, row) + 50.0 * (1.57 * u + 0.4).sin()
        });
        let left = |terms: f64| {
            let usual = model(&[Inertia, Viscous, Coulomb, Offset]);
            axis.bench()
                .sse(&usual.with(Part::found(&Spring, terms)))
                .sqrt()
        };
        let [line, parabola, four] = [1.0, 2.0, 4.0].map(left);
        assert!(
            four < 0.02 * line && four < 0.1 * parabola,
            "{line} {parabola} {four}"
        );
    }
}
