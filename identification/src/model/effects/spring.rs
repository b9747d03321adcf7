//! A force that depends on position alone: no effect of the list, but it must not be absorbed by
//! one.

use super::{Action, Against, Effect, Instant, Kinematics, Named, Naming, Setting, polynomial};
use crate::model::name::Called;
use crate::record::dataset::Dataset;

/// a u + b u².
pub(crate) struct Spring;

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
        "a u + b u^2, u = position over the travel, -1 to 1"
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
        polynomial::TERMS.to_vec()
    }

    fn parameters(&self, naming: &Naming<'_>) -> Vec<Named> {
        vec![naming.coefficient(
            "force_over_position",
            0,
            naming.effort_unit(" over half the travel"),
        )]
    }
}
