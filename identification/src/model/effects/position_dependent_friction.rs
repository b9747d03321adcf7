//! Friction that depends on position: `sign(v)·(a u + b u²)`, with u the position scaled to −1…1
//! over the travel of the training record, or `sign(v)·c(u)` with a smooth curve ([`curve`]) where
//! a worn or dirty place asks for it.

use axis_model::EffectName;

use super::{
    Action, Against, Effect, Fitted, Instant, Kinematics, Named, Naming, Setting, curve, polynomial,
};
use crate::model::name::Called;
use crate::record::dataset::Dataset;

/// sign(v)·(a u + b u²), or sign(v)·c(u).
pub(crate) struct PositionDependentFriction;

/// What a report calls the force at a knot of the curve, counted from one.
#[must_use]
pub(crate) fn knot_name(number: usize) -> String {
    format!("{}_knot_{number}", EffectName::PositionDependentFriction)
}

/// Number of intervals of the curve, where the choice is one.
fn intervals(choice: f64) -> Option<usize> {
    (choice >= curve::INTERVALS[0]).then_some(choice as usize)
}

impl Effect for PositionDependentFriction {
    fn called(&self) -> Called {
        EffectName::PositionDependentFriction.into()
    }

    fn equation(&self) -> &'static str {
        "sign(v) (a u + b u^2) or sign(v) c(u), u = position over the travel, -1 to 1"
    }

    fn columns(&self, motion: &Kinematics, dataset: &Dataset, choice: f64) -> Vec<Vec<f64>> {
        let directions = motion.direction.iter().copied();
        let pairs = polynomial::over_travel(motion, dataset).zip(directions);
        match intervals(choice) {
            Some(intervals) => curve::columns(pairs, intervals),
            None => polynomial::columns(pairs, choice),
        }
    }

    fn width(&self, choice: f64) -> usize {
        intervals(choice).unwrap_or_else(|| polynomial::width(choice))
    }

    fn is_level(&self, _: usize) -> bool {
        true
    }

    fn against(&self) -> Against {
        Against::Position
    }

    fn action(&self, at: &Instant, choice: f64, own: &[f64]) -> Action {
        Action::level(match intervals(choice) {
            Some(_) => curve::value(own, at.scaled),
            None => polynomial::value(own, at.scaled),
        })
    }

    fn start(&self, _: &Dataset) -> f64 {
        1.0
    }

    fn grid(&self, _: &Kinematics, _: &Setting<'_>) -> Vec<f64> {
        [&polynomial::TERMS[..], &curve::INTERVALS].concat()
    }

    /// A curve may not take away more than all of the friction.
    fn is_physical(&self, fitted: &Fitted<'_>) -> bool {
        intervals(fitted.parameter).is_none() || fitted.own.iter().all(|own| *own > -fitted.coulomb)
    }

    fn parameters(&self, naming: &Naming<'_>) -> Vec<Named> {
        let name = EffectName::PositionDependentFriction.as_str();
        if intervals(naming.parameter).is_some() {
            let at_knot =
                |place| naming.coefficient(&knot_name(place + 1), place, naming.effort_unit(""));
            return (0..naming.coefficients.len()).map(at_knot).collect();
        }
        let known = ["linear", "quadratic"]
            .iter()
            .zip(0..naming.coefficients.len());
        let term = |(term, place): (&&str, usize)| {
            let unit = naming.effort_unit(" over half the travel");
            naming.coefficient(&format!("{name}_{term}"), place, unit)
        };
        known.map(term).collect()
    }
}
