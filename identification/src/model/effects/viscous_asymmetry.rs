//! Viscous friction that differs by direction: `(Fv ± c) v`, that is a column `|v|`.
//!
//! Janot, Gautier and Brunot saw it on EMPS (2019) and blamed screw fatigue.

use axis_model::EffectName;

use super::{Effect, Kinematics, Named, Naming, Steady};
use crate::model::name::Called;
use crate::record::dataset::Dataset;

/// c·|v|.
pub(crate) struct ViscousAsymmetry;

impl Effect for ViscousAsymmetry {
    fn called(&self) -> Called {
        EffectName::ViscousAsymmetry.into()
    }

    fn equation(&self) -> &'static str {
        "c |v|: Fv + c forwards, Fv - c backwards"
    }

    fn columns(&self, motion: &Kinematics, _: &Dataset, _: f64) -> Vec<Vec<f64>> {
        vec![motion.velocity.iter().map(|v| v.abs()).collect()]
    }

    fn steady(&self, own: &[f64]) -> Option<Steady> {
        Some(Steady {
            by_speed: own[0],
            ..Steady::default()
        })
    }

    fn parameters(&self, naming: &Naming<'_>) -> Vec<Named> {
        let unit = naming.effort_unit(&format!(" s/{}", naming.length()));
        vec![naming.coefficient("viscous_asymmetry", 0, unit)]
    }
}
