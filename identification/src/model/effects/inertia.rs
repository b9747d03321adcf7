//! Inertia: force M·a.

use axis_model::EffectName;

use super::{Effect, Kinematics, Named, Naming};
use crate::model::name::Called;
use crate::record::dataset::Dataset;

/// M·a.
pub(crate) struct Inertia;

impl Effect for Inertia {
    fn called(&self) -> Called {
        EffectName::Inertia.into()
    }

    fn equation(&self) -> &'static str {
        "M a"
    }

    fn columns(&self, motion: &Kinematics, _: &Dataset, _: f64) -> Vec<Vec<f64>> {
        vec![motion.acceleration.clone()]
    }

    fn is_mass(&self) -> bool {
        true
    }

    fn parameters(&self, naming: &Naming<'_>) -> Vec<Named> {
        let unit = naming.effort_unit(&format!(" s2/{}", naming.length()));
        vec![naming.coefficient("inertia", 0, unit)]
    }
}
