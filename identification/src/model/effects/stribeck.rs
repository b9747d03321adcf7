//! Stribeck fall: friction above the Coulomb level at low speed, `c·sign(v)·exp(−(v / vs)²)` (Bo
//! and Pavelescu 1982).

use axis_model::EffectName;

use super::{Action, Effect, Fitted, Instant, Kinematics, Named, Naming, Setting, geometric};
use crate::model::name::Called;
use crate::record::dataset::Dataset;

/// c·sign(v)·exp(−(v/vs)²).
pub(crate) struct Stribeck;

/// Breakaway friction of more than five times Coulomb is something else.
const LARGEST_RATIO: f64 = 4.0;

impl Effect for Stribeck {
    fn called(&self) -> Called {
        EffectName::Stribeck.into()
    }

    fn equation(&self) -> &'static str {
        "c sign(v) exp(-(v/vs)^2)"
    }

    fn columns(&self, motion: &Kinematics, _: &Dataset, vs: f64) -> Vec<Vec<f64>> {
        let fall = motion.velocity_lp.iter().zip(&motion.direction);
        vec![
            fall.map(|(v, direction)| direction * (-(v / vs).powi(2)).exp())
                .collect(),
        ]
    }

    fn is_tuned(&self) -> bool {
        true
    }

    fn is_level(&self) -> bool {
        true
    }

    fn action(&self, at: &Instant, vs: f64, own: &[f64]) -> Action {
        Action::level(own[0] * (-(at.velocity / vs).powi(2)).exp())
    }

    fn start(&self, dataset: &Dataset) -> f64 {
        5.0 * dataset.kind.moving_velocity()
    }

    fn grid(&self, _: &Kinematics, setting: &Setting<'_>) -> Vec<f64> {
        let moving = setting.dataset.kind.moving_velocity();
        geometric(0.7 * moving, 40.0 * moving, 14)
    }

    fn first_step(&self, _: &Kinematics, vs: f64) -> f64 {
        0.15 * vs
    }

    fn bounds(&self, motion: &Kinematics) -> (f64, f64) {
        let fastest = motion
            .velocity_lp
            .iter()
            .fold(0.0, |fastest: f64, v| fastest.max(v.abs()));
        (1.0e-3 * fastest, 0.5 * fastest)
    }

    fn is_physical(&self, fitted: &Fitted<'_>) -> bool {
        fitted
            .own
            .first()
            .is_some_and(|c| *c > 0.0 && *c < LARGEST_RATIO * fitted.coulomb)
    }

    fn parameters(&self, naming: &Naming<'_>) -> Vec<Named> {
        vec![
            naming.coefficient("stribeck_excess", 0, naming.effort_unit("")),
            naming.nonlinear(
                "stribeck_velocity",
                naming.parameter,
                format!("{}/s", naming.length()),
            ),
        ]
    }
}
