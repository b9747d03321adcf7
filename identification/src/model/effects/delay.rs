//! Delay: the effort of a row acts later than the record says.
//!
//! No column: all columns are taken later by it. Searched where quantisation that comes back
//! through the controller as effort does not look like a delay ([`Effect::is_judged_slow_too`]).

use axis_model::EffectName;

use super::{Effect, Fitted, Kinematics, Named, Naming, Setting, Stage};
use crate::model::name::Called;
use crate::record::dataset::Dataset;

/// u(t) acts at t + delay.
pub(crate) struct Delay;

/// A delay below this is not worth a name, s: a tenth of the cycle of the axes that were recorded.
pub(crate) const SHORTEST_S: f64 = 1.0e-4;
/// Longest delay that is searched: so much, or so many rows of a slow record.
const LONGEST_S: f64 = 6.0e-3;
const LONGEST_ROWS: f64 = 6.0;
/// Grid and first value of the search, s.
const GRID_S: f64 = 2.5e-4;
/// First step of the descent, s.
const STEP_S: f64 = 1.0e-4;

/// Longest delay that is searched on a record, s: the dead time of a bus is some of its cycles.
fn longest_s(motion: &Kinematics) -> f64 {
    LONGEST_S.max(LONGEST_ROWS * motion.period_s)
}

impl Effect for Delay {
    fn called(&self) -> Called {
        EffectName::Delay.into()
    }

    fn equation(&self) -> &'static str {
        "u(t) acts at t + delay"
    }

    fn columns(&self, _: &Kinematics, _: &Dataset, _: f64) -> Vec<Vec<f64>> {
        Vec::new()
    }

    fn width(&self, _: f64) -> usize {
        0
    }

    fn stage(&self) -> Stage {
        Stage::Time
    }

    fn is_judged_slow_too(&self) -> bool {
        true
    }

    fn is_tuned(&self) -> bool {
        true
    }

    fn start(&self, _: &Dataset) -> f64 {
        GRID_S
    }

    /// A delay that would have to act before its cause is in the grid: it must not be the best.
    fn grid(&self, motion: &Kinematics, _: &Setting<'_>) -> Vec<f64> {
        let late = (longest_s(motion) / GRID_S).round() as i32;
        (-8..=late).map(|i| GRID_S * f64::from(i)).collect()
    }

    fn first_step(&self, _: &Kinematics, _: f64) -> f64 {
        STEP_S
    }

    fn later_step(&self, _: &Kinematics, _: f64) -> f64 {
        STEP_S
    }

    fn derivative_step(&self, _: f64) -> f64 {
        1.0e-5
    }

    fn bounds(&self, motion: &Kinematics) -> (f64, f64) {
        (-longest_s(motion), longest_s(motion))
    }

    fn is_physical(&self, fitted: &Fitted<'_>) -> bool {
        fitted.parameter >= SHORTEST_S
    }

    fn parameters(&self, naming: &Naming<'_>) -> Vec<Named> {
        vec![naming.nonlinear("delay", naming.parameter, "s".into())]
    }
}
