//! Friction that depends on position: `sign(v)·(a u + b u²)`, with u the position scaled to −1…1
//! over the travel of the training record.

use axis_model::EffectName;

use super::{Action, Against, Effect, Instant, Kinematics, Named, Naming, Setting, polynomial};
use crate::model::name::Called;
use crate::record::dataset::Dataset;

/// sign(v)·(a u + b u²).
pub(crate) struct PositionDependentFriction;

impl Effect for PositionDependentFriction {
    fn called(&self) -> Called {
        EffectName::PositionDependentFriction.into()
    }

    fn equation(&self) -> &'static str {
        "sign(v) (a u + b u^2), u = position over the travel, -1 to 1"
    }

    fn columns(&self, motion: &Kinematics, dataset: &Dataset, terms: f64) -> Vec<Vec<f64>> {
        let directions = motion.direction.iter().copied();
        let pairs = polynomial::over_travel(motion, dataset).zip(directions);
        polynomial::columns(pairs, terms)
    }

    fn width(&self, terms: f64) -> usize {
        polynomial::width(terms)
    }

    fn is_level(&self) -> bool {
        true
    }

    fn against(&self) -> Against {
        Against::Position
    }

    fn action(&self, at: &Instant, _: f64, own: &[f64]) -> Action {
        Action::level(polynomial::value(own, at.scaled))
    }

    fn start(&self, _: &Dataset) -> f64 {
        1.0
    }

    fn grid(&self, _: &Kinematics, _: &Setting<'_>) -> Vec<f64> {
        polynomial::TERMS.to_vec()
    }

    fn parameters(&self, naming: &Naming<'_>) -> Vec<Named> {
        let name = [
            "position_dependent_friction_linear",
            "position_dependent_friction_quadratic",
        ];
        let known = name.iter().enumerate().take(naming.coefficients.len());
        known
            .map(|(place, name)| {
                naming.coefficient(name, place, naming.effort_unit(" over half the travel"))
            })
            .collect()
    }
}
