//! Quadratic drag: `q v |v|`.

use axis_model::EffectName;

use super::{Action, Effect, Fitted, Instant, Kinematics, Named, Naming};
use crate::model::name::Called;
use crate::record::dataset::Dataset;

/// q·v·|v|.
pub(crate) struct QuadraticDrag;

impl Effect for QuadraticDrag {
    fn called(&self) -> Called {
        EffectName::QuadraticDrag.into()
    }

    fn equation(&self) -> &'static str {
        "q v |v|"
    }

    fn columns(&self, motion: &Kinematics, _: &Dataset, _: f64) -> Vec<Vec<f64>> {
        vec![motion.velocity_lp.iter().map(|v| v * v.abs()).collect()]
    }

    fn action(&self, at: &Instant, _: f64, own: &[f64]) -> Action {
        Action::force(own[0] * at.velocity * at.velocity.abs())
    }

    fn is_physical(&self, fitted: &Fitted<'_>) -> bool {
        fitted.own.first().is_some_and(|q| *q > 0.0) && fitted.viscous >= 0.0
    }

    fn parameters(&self, naming: &Naming<'_>) -> Vec<Named> {
        let unit = naming.effort_unit(&format!(" s2/{}2", naming.length()));
        vec![naming.coefficient("quadratic_drag", 0, unit)]
    }
}
