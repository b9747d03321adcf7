//! Offset: a constant force. Coulomb friction that differs by direction is the same force: `Fc ±
//! ΔF` is `Fc sign(v)` and a constant.

use axis_model::EffectName;

use super::{Against, Effect, Kinematics, Named, Naming, Steady};
use crate::model::name::Called;
use crate::record::dataset::Dataset;

/// A constant force.
pub(crate) struct Offset;

impl Effect for Offset {
    fn called(&self) -> Called {
        EffectName::Offset.into()
    }

    fn equation(&self) -> &'static str {
        "F0"
    }

    fn columns(&self, motion: &Kinematics, _: &Dataset, _: f64) -> Vec<Vec<f64>> {
        vec![vec![1.0; motion.len()]]
    }

    fn stands_for(&self, declared: EffectName) -> bool {
        declared == EffectName::CoulombAsymmetry
    }

    fn against(&self) -> Against {
        Against::Time
    }

    fn steady(&self, own: &[f64]) -> Option<Steady> {
        Some(Steady {
            force: own[0],
            ..Steady::default()
        })
    }

    fn parameters(&self, naming: &Naming<'_>) -> Vec<Named> {
        vec![naming.coefficient("offset", 0, naming.effort_unit(""))]
    }
}
