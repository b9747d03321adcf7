//! A force that depends on position alone: no effect of the list, but it must not be absorbed by
//! one.

use super::{Action, Against, Effect, Instant, Kinematics, Named, Naming, Setting};
use crate::model::effects::position_dependent_friction::{polynomial, scaled};
use crate::model::name::Called;
use crate::record::dataset::Dataset;

/// a u + b u².
pub(crate) struct Spring;

impl Effect for Spring {
    fn called(&self) -> Called {
        Called::Structure("force over position")
    }

    fn equation(&self) -> &'static str {
        "a u + b u^2, u = position over the travel, -1 to 1"
    }

    fn columns(&self, motion: &Kinematics, dataset: &Dataset, terms: f64) -> Vec<Vec<f64>> {
        let u = scaled(motion, dataset);
        let power = |n: i32| u.iter().map(|u| u.powi(n)).collect();
        if terms > 1.5 {
            vec![power(1), power(2)]
        } else {
            vec![power(1)]
        }
    }

    fn width(&self, terms: f64) -> usize {
        if terms > 1.5 { 2 } else { 1 }
    }

    fn against(&self) -> Against {
        Against::Position
    }

    fn action(&self, at: &Instant, _: f64, own: &[f64]) -> Action {
        Action::force(polynomial(own, at.scaled))
    }

    fn grid(&self, _: &Kinematics, _: &Setting<'_>) -> Vec<f64> {
        vec![1.0, 2.0]
    }

    fn parameters(&self, naming: &Naming<'_>) -> Vec<Named> {
        vec![naming.coefficient(
            "force_over_position",
            0,
            naming.effort_unit(" over half the travel"),
        )]
    }
}
