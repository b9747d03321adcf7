//! Viscous friction: force Fv·v.

use axis_model::EffectName;

use super::{Effect, Kinematics, Named, Naming, Steady};
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

    fn steady(&self, own: &[f64]) -> Option<Steady> {
        Some(Steady {
            by_velocity: own[0],
            ..Steady::default()
        })
    }

    fn parameters(&self, naming: &Naming<'_>) -> Vec<Named> {
        let unit = naming.effort_unit(&format!(" s/{}", naming.length()));
        vec![naming.coefficient("viscous", 0, unit)]
    }
}
