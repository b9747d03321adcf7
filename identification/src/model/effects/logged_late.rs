//! Logged late: the effort of a row acted before the record says.
//!
//! ```text
//! delay        u_recorded(t) = q(t + τ)    the drive is late: it acts after it was told to
//! logged late  u_recorded(t) = q(t − τ)    the log is late: it says what was, the axis is prompt
//! ```
//!
//! In the fit they are one shift of all columns with two signs, so that a model has one of them. In
//! the axis they differ: a delay is in the loop and costs phase, a late log is in no loop. So a
//! free run has the delay and never the lateness, and a recorded effort that drives a simulation is
//! read ahead by it.
//!
//! No column. Searched as a delay is ([`super::delay`]).

use axis_model::EffectName;

use super::{Effect, Fitted, Kinematics, Named, Naming, Setting, Stage};
use crate::model::name::Called;
use crate::record::dataset::Dataset;

/// u(t) acted at t − τ.
pub(crate) struct LoggedLate;

/// Less is no name, s: filters and sampling of any current loop shift by that much.
pub(crate) const SHORTEST_S: f64 = 1.5e-4;
/// Longest lateness that is searched, s: two cycles of a slow fieldbus.
const LONGEST_S: f64 = 2.0e-2;
/// Grid and first value of the search, s: twenty a period of the search's low-pass of 30 Hz and
/// more.
const GRID_S: f64 = 5.0e-4;
/// Tries of the other sign, which must not be the best.
const EARLY: i32 = 8;
/// Tries of its own sign.
const LATE: i32 = 40;
/// First step of the descent, s.
const STEP_S: f64 = 2.0e-4;

impl Effect for LoggedLate {
    fn called(&self) -> Called {
        EffectName::LoggedLate.into()
    }

    fn equation(&self) -> &'static str {
        "u(t) acted at t - tau"
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

    fn is_nearest_outsider(&self) -> bool {
        true
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

    fn grid(&self, _: &Kinematics, _: &Setting<'_>) -> Vec<f64> {
        (-EARLY..=LATE).map(|i| GRID_S * f64::from(i)).collect()
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

    fn bounds(&self, _: &Kinematics) -> (f64, f64) {
        (-LONGEST_S, LONGEST_S)
    }

    fn is_physical(&self, fitted: &Fitted<'_>) -> bool {
        fitted.parameter >= SHORTEST_S
    }

    fn parameters(&self, naming: &Naming<'_>) -> Vec<Named> {
        vec![naming.nonlinear("logged_late", naming.parameter, "s".into())]
    }
}
