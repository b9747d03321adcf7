//! Coulomb friction: force Fc·sign(v); at standstill, whatever holds.

use axis_model::EffectName;

use super::{Effect, Kinematics, Named, Naming, Steady};
use crate::model::name::Called;
use crate::record::dataset::Dataset;

/// Fc·sign(v).
pub(crate) struct Coulomb;

impl Effect for Coulomb {
    fn called(&self) -> Called {
        EffectName::Coulomb.into()
    }

    fn equation(&self) -> &'static str {
        "Fc sign(v)"
    }

    fn columns(&self, motion: &Kinematics, _: &Dataset, _: f64) -> Vec<Vec<f64>> {
        vec![motion.direction.clone()]
    }

    fn is_level(&self, _: usize) -> bool {
        true
    }

    fn steady(&self, own: &[f64]) -> Option<Steady> {
        Some(Steady {
            level: own[0],
            ..Steady::default()
        })
    }

    fn parameters(&self, naming: &Naming<'_>) -> Vec<Named> {
        vec![naming.coefficient("coulomb", 0, naming.effort_unit(""))]
    }
}
