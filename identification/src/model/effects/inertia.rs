//! Inertia: force M·a.

use super::{Action, Effect, Instant, Kinematics, Named, Naming};
use crate::record::dataset::Dataset;

/// M·a.
pub(crate) struct Inertia;

impl Effect for Inertia {
    fn name(&self) -> &'static str {
        "inertia"
    }

    fn equation(&self) -> &'static str {
        "M a"
    }

    fn columns(&self, motion: &Kinematics, _: &Dataset, _: f64) -> Vec<Vec<f64>> {
        vec![motion.acceleration.clone()]
    }

    fn action(&self, _: &Instant, _: f64, _: &[f64]) -> Action {
        Action::default()
    }

    fn parameters(&self, naming: &Naming<'_>) -> Vec<Named> {
        let unit = naming.effort_unit(&format!(" s2/{}", naming.length()));
        vec![naming.coefficient("inertia", 0, unit)]
    }
}
