//! Coefficients beside friction that grows with the load.
//!
//! That friction is written with the force by motion Q, which makes the effort linear in its ratio
//! μ: what acts behind the contact is then 1/(1 − μ²) times as large as it is
//! ([`load_dependent_friction`](crate::model::effects::load_dependent_friction)). For people and
//! for whoever computes with it that factor is taken off.

use axis_model::EffectName;

use crate::fit::fitted::Estimate;

/// Estimates as the axis has them, without what the form of the fit adds to them.
#[must_use]
pub(crate) fn without_primes(mut estimates: Vec<Estimate>) -> Vec<Estimate> {
    let by_load = EffectName::LoadDependentFriction;
    let friction = estimates.iter().find(|one| one.part.is(by_load));
    let Some((ratio, half_width, motor_share)) = friction
        .filter(|friction| !friction.part.is_reshaped())
        .map(|friction| {
            (
                friction.own[0].0,
                friction.own[0].1,
                friction.part.parameter,
            )
        })
    else {
        return estimates;
    };
    let behind = 1.0 - ratio.powi(2);
    for one in &mut estimates {
        let share = if one.part.is(EffectName::Inertia) {
            motor_share + (1.0 - motor_share) * behind
        } else if one.part.effect.acts_on_motor() || one.part.effect.follows_load() {
            1.0
        } else {
            behind
        };
        let uncertain = if share < 1.0 {
            2.0 * ratio * half_width
        } else {
            0.0
        };
        for (value, half) in &mut one.own {
            *half = (share * *half).hypot(uncertain * *value);
            *value *= share;
        }
    }
    estimates
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::made::found;
    use EffectName::{Coulomb, Inertia, LoadDependentFriction, TorqueRipple};

    fn estimate(name: EffectName, parameter: f64, own: &[(f64, f64)]) -> Estimate {
        Estimate {
            part: found(name, parameter),
            own: own.to_vec(),
            parameter_half_width: None,
            form_half_width: None,
            lag_half_width: None,
        }
    }

    #[test]
    fn what_acts_behind_the_contact_is_smaller_than_it_was_fitted() {
        let all = vec![
            estimate(Inertia, 0.0, &[(100.0, 1.0)]),
            estimate(Coulomb, 0.0, &[(50.0, 0.5)]),
            estimate(TorqueRipple, 400.0, &[(3.0, 0.1), (4.0, 0.1)]),
            estimate(LoadDependentFriction, 0.25, &[(0.2, 0.01)]),
        ];
        let as_they_are = without_primes(all.clone());
        let values = |place: usize| as_they_are[place].own.clone();
        assert!((values(0)[0].0 - (25.0 + 75.0 * 0.96)).abs() < 1.0e-12);
        assert!((values(1)[0].0 - 48.0).abs() < 1.0e-12);
        assert!((values(1)[0].1 - 0.48_f64.hypot(0.2)).abs() < 1.0e-12);
        assert_eq!(
            (values(2), values(3)),
            (all[2].own.clone(), all[3].own.clone())
        );
        // Without it everything is as it was fitted.
        assert_eq!(without_primes(all[..3].to_vec())[1].own, all[1].own);
    }
}
