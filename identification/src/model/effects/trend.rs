//! A force that drifts with time: no effect of the list (temperature of a sensor, a load that
//! changes), but it must not be absorbed by one.

use super::{Action, Against, Effect, Instant, Kinematics, Named, Naming, Setting, polynomial};
use crate::model::name::Called;
use crate::record::dataset::Dataset;

/// a s + b s², s = time over the record.
pub(crate) struct Trend;

impl Effect for Trend {
    fn called(&self) -> Called {
        Called::Structure("drifting force")
    }

    fn equation(&self) -> &'static str {
        "a s + b s^2, s = time over the training record"
    }

    fn columns(&self, motion: &Kinematics, dataset: &Dataset, terms: f64) -> Vec<Vec<f64>> {
        let duration_s = dataset.train.duration_s();
        let shares = motion.time_s.iter().map(|t| t / duration_s);
        polynomial::columns(shares.map(|s| (s, 1.0)), terms)
    }

    fn width(&self, terms: f64) -> usize {
        polynomial::width(terms)
    }

    fn against(&self) -> Against {
        Against::Time
    }

    fn action(&self, at: &Instant, _: f64, own: &[f64]) -> Action {
        Action::force(polynomial::value(own, at.time_share))
    }

    fn grid(&self, _: &Kinematics, _: &Setting<'_>) -> Vec<f64> {
        polynomial::TERMS.to_vec()
    }

    fn parameters(&self, naming: &Naming<'_>) -> Vec<Named> {
        vec![naming.coefficient(
            "drifting_force",
            0,
            naming.effort_unit(" over the training record"),
        )]
    }
}
