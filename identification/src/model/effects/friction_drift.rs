//! Friction that changes with time from the start of the record (warm-up): `(a sign(v) + b
//! v)·exp(−t / τ)`; every record starts cold.

use axis_model::EffectName;

use super::{Action, Against, Effect, Instant, Kinematics, Named, Naming, Setting};
use crate::model::name::Called;
use crate::record::dataset::Dataset;

/// (a sign(v) + b v)·exp(−t/τ).
pub(crate) struct FrictionDrift;

impl Effect for FrictionDrift {
    fn called(&self) -> Called {
        EffectName::FrictionDrift.into()
    }

    fn equation(&self) -> &'static str {
        "(a sign(v) + b v) exp(-t/tau)"
    }

    fn columns(&self, motion: &Kinematics, _: &Dataset, tau: f64) -> Vec<Vec<f64>> {
        let fall: Vec<f64> = motion.time_s.iter().map(|t| (-t / tau).exp()).collect();
        let on = |what: &[f64]| {
            fall.iter()
                .zip(what)
                .map(|(fall, what)| fall * what)
                .collect()
        };
        vec![on(&motion.direction), on(&motion.velocity_lp)]
    }

    fn width(&self, _: f64) -> usize {
        2
    }

    fn is_tuned(&self) -> bool {
        true
    }

    fn against(&self) -> Against {
        Against::Time
    }

    fn action(&self, at: &Instant, tau: f64, own: &[f64]) -> Action {
        let fall = (-at.time_s / tau).exp();
        Action {
            level: own[0] * fall,
            force: own[1] * fall * at.velocity,
            ..Action::default()
        }
    }

    fn start(&self, dataset: &Dataset) -> f64 {
        0.3 * dataset.train.duration_s()
    }

    fn grid(&self, motion: &Kinematics, _: &Setting<'_>) -> Vec<f64> {
        [0.05, 0.1, 0.2, 0.4, 0.8, 1.6]
            .map(|share| share * motion.duration_s())
            .to_vec()
    }

    fn first_step(&self, _: &Kinematics, tau: f64) -> f64 {
        0.25 * tau
    }

    fn bounds(&self, motion: &Kinematics) -> (f64, f64) {
        (0.02 * motion.duration_s(), 3.0 * motion.duration_s())
    }

    /// A record that begins with slow motion has its Stribeck fall at its start.
    fn rivals(&self) -> &'static [EffectName] {
        &[EffectName::Stribeck]
    }

    fn parameters(&self, naming: &Naming<'_>) -> Vec<Named> {
        vec![
            naming.coefficient("friction_drift_coulomb", 0, naming.effort_unit("")),
            naming.coefficient(
                "friction_drift_viscous",
                1,
                naming.effort_unit(&format!(" s/{}", naming.length())),
            ),
            naming.nonlinear("friction_drift_time_constant", naming.parameter, "s".into()),
        ]
    }
}
