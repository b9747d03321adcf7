//! A force that drifts with time: no effect of the list (temperature of a sensor, a load that
//! changes), but it must not be absorbed by one.

use super::position_dependent_friction::polynomial;
use super::{Action, Against, Effect, Instant, Kinematics, Named, Naming, Setting};
use crate::model::name::Called;
use crate::record::dataset::Dataset;

/// a s + b s², s = time over the record.
pub(crate) struct Trend;

/// Time over the training record.
fn scaled(time_s: f64, dataset: &Dataset) -> f64 {
    time_s / dataset.train.duration_s()
}

impl Effect for Trend {
    fn called(&self) -> Called {
        Called::Structure("drifting force")
    }

    fn equation(&self) -> &'static str {
        "a s + b s^2, s = time over the training record"
    }

    fn columns(&self, motion: &Kinematics, dataset: &Dataset, terms: f64) -> Vec<Vec<f64>> {
        let power = |n: i32| {
            motion
                .time_s
                .iter()
                .map(|t| scaled(*t, dataset).powi(n))
                .collect()
        };
        if terms > 1.5 {
            vec![power(1), power(2)]
        } else {
            vec![power(1)]
        }
    }

    fn width(&self, terms: f64) -> usize {
        if terms > 1.5 { 2 } else { 1 }
    }

    fn against(&self) -> Against {
        Against::Time
    }

    fn action(&self, at: &Instant, _: f64, own: &[f64]) -> Action {
        Action::force(polynomial(own, at.time_share))
    }

    fn grid(&self, _: &Kinematics, _: &Setting<'_>) -> Vec<f64> {
        vec![1.0, 2.0]
    }

    fn parameters(&self, naming: &Naming<'_>) -> Vec<Named> {
        vec![naming.coefficient(
            "drifting_force",
            0,
            naming.effort_unit(" over the training record"),
        )]
    }
}
