//! Viscous friction: force Fv·v.

use axis_model::EffectName;

use super::{Action, Effect, Instant, Kinematics, Named, Naming};
use crate::model::name::Called;
use crate::record::dataset::Dataset;

/// Fv·v.
pub(crate) struct Viscous;

impl Effect for Viscous {
    fn called(&self) -> Called {
        EffectName::Viscous.into()
    }

    fn equation(&self) -> &'static str {
        "Fv v"
    }

    fn columns(&self, motion: &Kinematics, _: &Dataset, _: f64) -> Vec<Vec<f64>> {
        vec![motion.velocity.clone()]
    }

    fn action(&self, at: &Instant, _: f64, own: &[f64]) -> Action {
        Action::force(own[0] * at.velocity)
    }

    fn parameters(&self, naming: &Naming<'_>) -> Vec<Named> {
        let unit = naming.effort_unit(&format!(" s/{}", naming.length()));
        vec![naming.coefficient("viscous", 0, unit)]
    }
}
