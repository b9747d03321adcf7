//! Friction that changes with time from the start of the record (warm-up): `(a sign(v) + b
//! v)·exp(−t / τ)`; every record starts cold.
//!
//! Friction that is larger one way than the other changes both ways alike, by its share: then the
//! difference drifts too, `(a sign(v) + b v + c)·exp(−t / τ)`.

use axis_model::EffectName;

use super::{Action, Against, Effect, Instant, Kinematics, Named, Naming, Setting};
use crate::model::name::Called;
use crate::record::dataset::Dataset;

/// (a sign(v) + b v)·exp(−t/τ); by direction with a constant force beside both.
pub(crate) struct FrictionDrift {
    by_direction: bool,
}

/// The usual form.
pub(crate) const BOTH_WAYS: &FrictionDrift = &FrictionDrift {
    by_direction: false,
};
const BY_DIRECTION: &FrictionDrift = &FrictionDrift { by_direction: true };

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
        let mut columns = vec![on(&motion.direction), on(&motion.velocity_lp)];
        if self.by_direction {
            columns.push(fall);
        }
        columns
    }

    fn width(&self, _: f64) -> usize {
        if self.by_direction { 3 } else { 2 }
    }

    fn by_direction(&self) -> Option<&'static dyn Effect> {
        Some(BY_DIRECTION)
    }

    fn is_tuned(&self) -> bool {
        true
    }

    fn is_level(&self, column: usize) -> bool {
        column == 0
    }

    /// What friction takes more of at first is there at any cut-off. A loop that bounces between
    /// two flanks shakes otherwise as the setpoint goes on, and looks so above the lower one.
    fn is_judged_slow_too(&self) -> bool {
        true
    }

    fn against(&self) -> Against {
        Against::Time
    }

    fn action(&self, at: &Instant, tau: f64, own: &[f64]) -> Action {
        let fall = (-at.time_s / tau).exp();
        let by_direction = own.get(2).copied().unwrap_or(0.0);
        Action {
            level: own[0] * fall,
            force: fall * (own[1] * at.velocity + by_direction),
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
        let unit = naming.effort_unit("");
        let by_speed = naming.effort_unit(&format!(" s/{}", naming.length()));
        let coulomb = naming.coefficient("friction_drift_coulomb", 0, unit.clone());
        let viscous = naming.coefficient("friction_drift_viscous", 1, by_speed);
        let by_direction = self
            .by_direction
            .then(|| naming.coefficient("friction_drift_by_direction", 2, unit));
        let time = naming.nonlinear("friction_drift_time_constant", naming.parameter, "s".into());
        let all = [Some(coulomb), Some(viscous), by_direction, Some(time)];
        all.into_iter().flatten().collect()
    }
}
