//! Friction that grows with the magnitude of the transmitted force, `μ·|Q|·sign(v)`: the efficiency
//! of a screw. The motor pays for it where it drives and is spared where it brakes.
//!
//! ```text
//! u = m a + F,  F = (M − m) a + Fv v + Fc sign(v) + F0 + μ |F| sign(v)
//! F = Q (1 + μ σ),  σ = sign(v Q)                         drives (+1) or brakes (−1)
//! Q = (M' − m') a + Fv' v + Fc' sign(v) + F0'             the primed ones are over 1 − μ²
//! ```
//!
//! m is the part of the moved mass before the contact that rubs: the motor's own. Its share `m'/M'`
//! is the nonlinear parameter. The friction is written with Q, the force by motion: to the order of
//! μ² it is the transmitted force F, and with it the effort is linear in μ.
//!
//! The effort itself would be a noisy regressor: its noise has the same sign as the target's
//! wherever the motor drives, and the effect would be found on every axis that hardly brakes. So Q
//! is computed from the motion ([`ByMotion`]), once more after each step of σ. What the model has
//! beside the usual effects (a payload, a spring) is a part of it as it was fitted last
//! ([`Others`]).
//!
//! Where the friction of the axis changes with place, speed or time, the load may press that very
//! surface (a nut that warms up) or another one (a worn guide beside the screw). These are two
//! forms; the second is the usual one. Where μ changes, 1 − μ² does too, and the usual columns
//! cannot take it up: the column of that form has F = R/(1 − μ σ) itself for Q, with the μ of an
//! earlier fit, and all coefficients are without primes.
//!
//! What is found is friction only where the friction without load is: an unphysical split of the
//! usual columns could have any ratio.
//!
//! Where the motor never brakes, `Q sign(v)` is |Q| everywhere: the column is a sum of the usual
//! ones, and the record cannot show the effect.

use axis_model::EffectName;

use super::by_motion::{ByMotion, Others, Usual};
use super::{Action, Effect, Fitted, Instant, Kinematics, Named, Naming, Setting};
use crate::model::name::Called;
use crate::record::dataset::Dataset;

/// μ·|Q|·sign(v), or with the friction that it adds to: μ·|Q|·sign(v)·F(x, v, t)/Fc.
pub(crate) struct LoadDependentFriction {
    /// Whether the load presses the surface whose friction changes with place, speed or time.
    is_shared: bool,
}

/// On a surface of its own: the usual form.
pub(crate) static OWN_SURFACE: &LoadDependentFriction = &LoadDependentFriction { is_shared: false };
static SHARED_SURFACE: &LoadDependentFriction = &LoadDependentFriction { is_shared: true };
static FORMS: [&dyn Effect; 2] = [SHARED_SURFACE, OWN_SURFACE];

/// Shares of the moved mass that are tried as the motor's own.
const MOTOR_SHARES: [f64; 5] = [0.0, 0.2, 0.4, 0.6, 0.8];
/// A load without mass would transmit no inertia at all.
const BOUNDS: (f64, f64) = (0.0, 0.95);
/// Half the distance of the grid.
const FIRST_STEP: f64 = 0.1;
/// Step of the derivative by the share, which may be zero.
const DERIVATIVE_STEP: f64 = 0.01;
/// Fits of the coefficients of Q: from μ = 0 each leaves a tenth of the error of the one before.
const FITS: usize = 4;
/// As in the vocabulary; from 1 on an axis would lock itself.
const LARGEST_RATIO: f64 = 0.9;

/// Force by motion, without the share of the inertia that is the motor's own.
fn force(coefficients: Usual, motor_share: f64, at: Usual) -> f64 {
    let [mass, viscous, coulomb, offset] = coefficients;
    (1.0 - motor_share) * mass * at[0] + viscous * at[1] + coulomb * at[2] + offset
}

impl LoadDependentFriction {
    /// |Q| sign(v) with the coefficients that are known, or that agree with those that are fitted
    /// beside it; what else the load has to be moved against is a part of Q.
    fn column(&self, motion: &Kinematics, share: f64, others: &Others) -> Vec<f64> {
        let by_motion = ByMotion::beside(motion, others);
        let of = |usual: Usual, ratio: f64| {
            let [.., coulomb, _] = usual;
            let at = |row| {
                let behind = force(usual, share, by_motion.at(row)) + others.load(row);
                let surface = self.surface(coulomb, others, row);
                let direction = motion.direction[row];
                direction * surface * self.transmitted(behind, direction, ratio * surface)
            };
            (0..motion.len()).map(at).collect()
        };
        if let Some(usual) = others.usual {
            return of(usual, others.ratio);
        }
        (0..FITS).fold(vec![0.0; motion.len()], |own, _| {
            let (usual, ratio) = by_motion.fit(&[own]);
            of(usual, ratio[0])
        })
    }

    /// Magnitude of the force that is transmitted where a force has to be overcome: Q on a surface
    /// of its own, F on one that changes.
    fn transmitted(&self, behind: f64, direction: f64, ratio: f64) -> f64 {
        if self.is_shared {
            let drives = (direction * behind).signum();
            behind.abs() / (1.0 - drives * ratio.clamp(0.0, LARGEST_RATIO))
        } else {
            behind.abs()
        }
    }

    /// How much friction its surface has at a row, over what it has where nothing changes it.
    fn surface(&self, coulomb: f64, others: &Others, row: usize) -> f64 {
        if self.is_shared && coulomb > 0.0 {
            1.0 + others.level(row) / coulomb
        } else {
            1.0
        }
    }
}

impl Effect for LoadDependentFriction {
    fn called(&self) -> Called {
        EffectName::LoadDependentFriction.into()
    }

    fn equation(&self) -> &'static str {
        if self.is_shared {
            "mu |Q| F/Fc sign(v), Q = force by motion behind the motor's own inertia, F/Fc = friction \
             over its level"
        } else {
            "mu |Q| sign(v), Q = force by motion behind the motor's own inertia"
        }
    }

    fn forms(&self) -> &'static [&'static dyn Effect] {
        &FORMS
    }

    fn form(&self) -> f64 {
        f64::from(u8::from(self.is_shared))
    }

    fn columns(&self, motion: &Kinematics, dataset: &Dataset, motor_share: f64) -> Vec<Vec<f64>> {
        self.columns_beside(motion, dataset, motor_share, &Others::default())
    }

    fn columns_beside(
        &self,
        motion: &Kinematics,
        _: &Dataset,
        motor_share: f64,
        others: &Others,
    ) -> Vec<Vec<f64>> {
        vec![self.column(motion, motor_share, others)]
    }

    fn is_tuned(&self) -> bool {
        true
    }

    fn is_level(&self, _: usize) -> bool {
        true
    }

    fn follows_load(&self) -> bool {
        true
    }

    fn is_nearest_outsider(&self) -> bool {
        true
    }

    /// From `u = M a + R + μ s |Q|` and `Q = (1 − r) M a + R`, with the motor's share r and the
    /// resistance R: `Q = A − (1 − r) μ s |Q|`, `A = (1 − r) u + r R`.
    fn action(&self, at: &Instant, motor_share: f64, own: &[f64]) -> Action {
        let behind = (1.0 - motor_share) * at.effort + motor_share * at.resistance;
        let drives = if at.velocity * behind < 0.0 {
            -1.0
        } else {
            1.0
        };
        if self.is_shared {
            let ratio = own[0] * at.surface;
            Action::level(ratio * behind.abs() / (1.0 - drives * motor_share * ratio))
        } else {
            Action::level(own[0] * behind.abs() / (1.0 + drives * (1.0 - motor_share) * own[0]))
        }
    }

    fn start(&self, _: &Dataset) -> f64 {
        MOTOR_SHARES[2]
    }

    fn grid(&self, _: &Kinematics, _: &Setting<'_>) -> Vec<f64> {
        MOTOR_SHARES.to_vec()
    }

    fn first_step(&self, _: &Kinematics, _: f64) -> f64 {
        FIRST_STEP
    }

    fn derivative_step(&self, _: f64) -> f64 {
        DERIVATIVE_STEP
    }

    fn bounds(&self, _: &Kinematics) -> (f64, f64) {
        BOUNDS
    }

    fn is_physical(&self, fitted: &Fitted<'_>) -> bool {
        let is_friction = fitted.coulomb >= 0.0 && fitted.viscous >= 0.0;
        let ratio = fitted.own.first();
        is_friction && ratio.is_some_and(|ratio| *ratio > 0.0 && *ratio < LARGEST_RATIO)
    }

    fn parameters(&self, naming: &Naming<'_>) -> Vec<Named> {
        vec![naming.coefficient("load_dependent_friction", 0, String::new())]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::made::{USUAL, axis, found, model, usual};
    use EffectName::{Coulomb, Inertia, Offset, Viscous};

    const RATIO: f64 = 0.15;
    const MOTOR_SHARE: f64 = 0.4;

    /// The force by motion of the usual axis, 40 % of whose mass is the motor's own.
    fn by_motion(motion: &Kinematics, row: usize) -> f64 {
        usual(motion, row) - MOTOR_SHARE * USUAL[0] * motion.acceleration[row]
    }

    /// The effort of the usual axis with it.
    fn loaded(motion: &Kinematics, row: usize) -> f64 {
        let own = RATIO * by_motion(motion, row).abs() * motion.direction[row];
        usual(motion, row) + own
    }

    #[test]
    fn the_column_is_the_force_by_motion_against_the_direction() {
        let axis = axis(loaded);
        let columns = OWN_SURFACE.columns(&axis.motion, &axis.dataset, MOTOR_SHARE);
        let mut brakes = 0;
        for row in (300..5700).filter(|row| axis.motion.fitted[*row]) {
            let wanted = by_motion(&axis.motion, row);
            brakes += usize::from(wanted * axis.motion.direction[row] < 0.0);
            let wanted = wanted.abs() * axis.motion.direction[row];
            assert!(
                (columns[0][row] - wanted).abs() < 0.6,
                "{row}: {} {wanted}",
                columns[0][row]
            );
        }
        assert!(brakes > 100, "{brakes}");
    }

    #[test]
    fn the_ratio_that_made_an_effort_comes_back_beside_the_usual_coefficients() {
        let axis = axis(loaded);
        let part = found(EffectName::LoadDependentFriction, MOTOR_SHARE);
        let fitted = axis
            .bench()
            .fit(&model(&[Inertia, Viscous, Coulomb, Offset]).with(part));
        let ratio = fitted.of(EffectName::LoadDependentFriction).unwrap()[0];
        assert!((ratio - RATIO).abs() < 0.003, "{ratio}");
        let mass = fitted.of(Inertia).unwrap()[0];
        assert!((mass / USUAL[0] - 1.0).abs() < 0.005, "{mass}");
    }

    /// Level of a simulated axis over what the fit has at the same force by motion.
    fn level_over_fitted(
        effect: &LoadDependentFriction,
        surface: f64,
    ) -> impl Iterator<Item = f64> {
        let cases = [
            (30.0, 45.0, 0.1),
            (-200.0, 45.0, 0.1),
            (-30.0, -45.0, -0.1),
            (200.0, -45.0, -0.1),
        ];
        cases
            .into_iter()
            .map(move |(mass_force, resistance, velocity)| {
                let behind = (1.0 - MOTOR_SHARE) * mass_force + resistance;
                let direction = f64::signum(velocity);
                let ratio = if effect.is_shared {
                    RATIO * surface
                } else {
                    RATIO
                };
                let level = ratio * effect.transmitted(behind, direction, ratio);
                let at = Instant {
                    velocity,
                    resistance,
                    effort: mass_force + resistance + level * direction,
                    surface,
                    ..Instant::default()
                };
                let action = effect.action(&at, MOTOR_SHARE, &[RATIO]);
                assert_eq!(action.force, 0.0);
                action.level / level
            })
    }

    #[test]
    fn a_simulated_axis_has_the_force_of_the_fit_whether_it_drives_or_brakes() {
        for effect in [OWN_SURFACE, SHARED_SURFACE] {
            for surface in [1.0, 1.8] {
                let mut shares = level_over_fitted(effect, surface);
                assert!(shares.all(|share| (share - 1.0).abs() < 1.0e-12));
            }
        }
    }

    #[test]
    fn a_surface_that_changes_is_pressed_by_what_it_makes_the_motor_transmit() {
        // Driving 60 N against a friction of 0.2 of what is transmitted takes 75 N, braking 50 N.
        assert_eq!(SHARED_SURFACE.transmitted(60.0, 1.0, 0.2), 75.0);
        assert_eq!(SHARED_SURFACE.transmitted(60.0, -1.0, 0.2), 50.0);
        assert_eq!(SHARED_SURFACE.transmitted(-60.0, 1.0, 0.2), 50.0);
        assert_eq!(OWN_SURFACE.transmitted(-60.0, 1.0, 0.2), 60.0);
    }

    #[test]
    fn a_ratio_is_above_zero_and_below_self_locking_beside_friction_that_is_none_below_zero() {
        let physical = |ratio: f64, coulomb: f64, viscous: f64| {
            OWN_SURFACE.is_physical(&Fitted {
                parameter: MOTOR_SHARE,
                own: &[ratio],
                inertia: 90.0,
                coulomb,
                viscous,
            })
        };
        for (ratio, coulomb, viscous, wanted) in [
            (0.89, 25.0, 200.0, true),
            (0.01, 25.0, 0.0, true),
            (0.0, 25.0, 200.0, false),
            (-0.1, 25.0, 200.0, false),
            (0.91, 25.0, 200.0, false),
            (0.2, -1.0, 200.0, false),
            (0.2, 25.0, -1.0, false),
        ] {
            let is = physical(ratio, coulomb, viscous);
            assert_eq!(is, wanted, "{ratio} {coulomb} {viscous}");
        }
    }

    #[test]
    fn the_ratio_has_the_name_of_the_vocabulary_its_interval_and_no_unit() {
        let naming = Naming {
            parameter: MOTOR_SHARE,
            parameter_half_width: None,
            form_half_width: None,
            lag_half_width: None,
            coefficients: &[(RATIO, 0.01)],
            dataset: &axis(usual).dataset,
        };
        let named = OWN_SURFACE.parameters(&naming);
        let wanted = Named {
            name: EffectName::LoadDependentFriction.parameters()[0].report_name(),
            value: RATIO,
            half_width: Some(0.01),
            unit: String::new(),
        };
        assert_eq!(named, [wanted]);
    }
}
