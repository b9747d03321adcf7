//! Friction that grows with the force that the screw transmits to the table, as in its nut and its
//! bearings: level μ |F|.

use axis_model::LoadDependentFriction;

use super::{Instant, Simulated};

impl Simulated for LoadDependentFriction {
    fn friction_level_n(&self, at: &Instant) -> f64 {
        self.load_dependent_friction * at.transmitted_n.abs()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::axis::{Axis, AxisParameters};
    use crate::friction::{Law, Sliding};
    use crate::machine::Machine;
    use crate::mechanics::Motion;

    const SHARE: f64 = 0.2;
    const COULOMB_N: f64 = 100.0;

    /// The reference axis with Coulomb friction and μ = 0.2, nothing else.
    fn axis() -> Axis {
        let mut effects = super::super::Effects::default();
        let own = LoadDependentFriction {
            load_dependent_friction: SHARE,
        };
        effects.add(own).unwrap();
        let actual = Machine::reference().axes[0].actual.clone();
        let parameters = AxisParameters {
            sliding: Sliding {
                coulomb_n: COULOMB_N,
                static_n: COULOMB_N,
                stribeck_velocity_m_per_s: 1.0e-3,
                stribeck_exponent: 2.0,
                stribeck_lag_s: 0.0,
                stribeck_lag_growth: 0.0,
                viscous_n_s_per_m: 0.0,
                coulomb_asymmetry: 0.0,
                viscous_asymmetry: 0.0,
                quadratic_drag_n_s2_per_m2: 0.0,
            },
            law: Law::Coulomb,
            effects,
            current_loop_time_constant_s: 0.0,
            force_noise_n: 0.0,
            force_limit_n: 1.0e4,
            ..actual
        };
        Axis::new(parameters, 1)
    }

    /// Acceleration of the table over 0.1 s under a constant force, from a velocity.
    fn acceleration(force_n: f64, from_m_per_s: f64) -> f64 {
        let mut axis = axis();
        axis.place(Motion {
            motor_m_per_s: from_m_per_s,
            table_m_per_s: from_m_per_s,
            ..Motion::default()
        });
        for _ in 0..100 {
            axis.advance(force_n, 1.0e-3);
        }
        (axis.motion().table_m_per_s - from_m_per_s) / 0.1
    }

    /// u = M1 a + F and F = M2 a + (Fc + μ |F|) s: a = (u (1 − σ μ) − Fc s) / (M − σ μ M1), where
    /// σ is the sign of F along the motion.
    fn wanted(force_n: f64, direction: f64, along: f64) -> f64 {
        let mechanics = axis().parameters().mechanics;
        let (m1, m2) = (mechanics.motor_inertia_kg, mechanics.table_mass_kg);
        let share = along * SHARE;
        (force_n * (1.0 - share) - COULOMB_N * direction) / (m1 + m2 - share * m1)
    }

    #[test]
    fn a_push_and_a_brake_slide_as_the_closed_form_says() {
        for (force_n, from, direction, along) in [
            (600.0, 0.0, 1.0, 1.0),
            (-600.0, 0.0, -1.0, 1.0),
            (-900.0, 1.0, 1.0, -1.0),
            (900.0, -1.0, -1.0, -1.0),
        ] {
            let (slides, wanted) = (
                acceleration(force_n, from),
                wanted(force_n, direction, along),
            );
            assert!(
                (slides / wanted - 1.0).abs() < 0.01,
                "{force_n} N: {slides} {wanted}"
            );
        }
    }

    #[test]
    fn the_level_is_the_share_of_either_sign_of_the_force() {
        let own = LoadDependentFriction {
            load_dependent_friction: SHARE,
        };
        for transmitted_n in [300.0, -300.0] {
            let at = Instant {
                transmitted_n,
                ..Instant::default()
            };
            assert!((own.friction_level_n(&at) - 60.0).abs() < 1.0e-12);
        }
    }
}
