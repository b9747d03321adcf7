//! Friction that depends on position: `sign(v)·(a u + b u²)`, with u the position scaled to −1…1
//! over the travel of the training record.

use axis_model::EffectName;

use super::{Action, Against, Effect, Instant, Kinematics, Named, Naming, Setting};
use crate::model::name::Called;
use crate::record::dataset::Dataset;

/// sign(v)·(a u + b u²).
pub(crate) struct PositionDependentFriction;

/// `a u + b u²`, as far as there are coefficients.
#[must_use]
pub(crate) fn polynomial(own: &[f64], u: f64) -> f64 {
    own.iter()
        .rev()
        .fold(0.0, |sum, coefficient| u * (coefficient + sum))
}

/// Position scaled to the travel of the training record, so that a validation record uses the same
/// scale.
#[must_use]
pub(crate) fn scaled(motion: &Kinematics, dataset: &Dataset) -> Vec<f64> {
    let (middle, half) = dataset.travel();
    motion
        .position_lp
        .iter()
        .map(|x| (x - middle) / half)
        .collect()
}

impl Effect for PositionDependentFriction {
    fn called(&self) -> Called {
        EffectName::PositionDependentFriction.into()
    }

    fn equation(&self) -> &'static str {
        "sign(v) (a u + b u^2), u = position over the travel, -1 to 1"
    }

    fn columns(&self, motion: &Kinematics, dataset: &Dataset, terms: f64) -> Vec<Vec<f64>> {
        let u = scaled(motion, dataset);
        let power = |n: i32| {
            u.iter()
                .zip(&motion.direction)
                .map(|(u, d)| d * u.powi(n))
                .collect()
        };
        if terms > 1.5 {
            vec![power(1), power(2)]
        } else {
            vec![power(1)]
        }
    }

    fn width(&self, terms: f64) -> usize {
        if terms > 1.5 { 2 } else { 1 }
    }

    fn is_level(&self) -> bool {
        true
    }

    fn against(&self) -> Against {
        Against::Position
    }

    fn action(&self, at: &Instant, _: f64, own: &[f64]) -> Action {
        Action::level(polynomial(own, at.scaled))
    }

    fn start(&self, _: &Dataset) -> f64 {
        1.0
    }

    fn grid(&self, _: &Kinematics, _: &Setting<'_>) -> Vec<f64> {
        vec![1.0, 2.0]
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
