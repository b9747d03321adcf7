//! Mass of the load where it moves otherwise than the motor: `M2·(a2 − a1)`. No effect of its own:
//! it comes with a gap or a compliance that a load scale shows, and makes the total `M1·a1 +
//! M2·a2`.

use super::{Effect, Kinematics, Named, Naming};
use crate::model::name::Called;
use crate::record::dataset::Dataset;

/// M2·(a2 − a1).
pub(crate) struct LoadInertia;

impl Effect for LoadInertia {
    fn called(&self) -> Called {
        Called::Structure("load_inertia")
    }

    fn equation(&self) -> &'static str {
        "M2 (a2 - a1)"
    }

    fn columns(&self, motion: &Kinematics, _: &Dataset, _: f64) -> Vec<Vec<f64>> {
        vec![
            motion
                .load_acceleration
                .clone()
                .unwrap_or_else(|| vec![0.0; motion.len()]),
        ]
    }

    fn is_mass(&self) -> bool {
        true
    }

    fn parameters(&self, naming: &Naming<'_>) -> Vec<Named> {
        vec![naming.coefficient(
            "load_inertia",
            0,
            naming.effort_unit(&format!(" s2/{}", naming.length())),
        )]
    }
}
