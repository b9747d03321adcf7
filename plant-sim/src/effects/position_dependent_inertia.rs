//! A mass that is a function of position, as of a crank or of an arm that folds:
//! m(x) = A sin(2π x / p + φ) beside the table's own.
//!
//! With T = ½ m(x) v² Lagrange's equation gives m a + ½ m'(x) v²: the axis feels a force without
//! any acceleration, where its mass changes under way.

use std::f64::consts::TAU;

use axis_model::PositionDependentInertia;

use super::{Instant, Simulated};

/// Angle within the period.
fn angle(own: &PositionDependentInertia, table_m: f64) -> f64 {
    TAU * table_m / own.period + own.phase.unwrap_or(0.0)
}

impl Simulated for PositionDependentInertia {
    fn added_mass_kg(&self, at: &Instant) -> f64 {
        self.position_dependent_inertia * angle(self, at.table_m).sin()
    }

    fn table_n(&self, at: &Instant) -> f64 {
        let slope = TAU / self.period * angle(self, at.table_m).cos();
        -0.5 * self.position_dependent_inertia * slope * at.table_m_per_s.powi(2)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::axis::{Axis, AxisParameters};
    use crate::friction::{Law, Sliding};
    use crate::machine::Machine;
    use crate::mechanics::Motion;

    const CRANK: PositionDependentInertia = PositionDependentInertia {
        position_dependent_inertia: 60.0,
        period: 0.2,
        phase: Some(0.4),
    };

    /// The reference axis with the crank, and without any friction.
    fn axis() -> Axis {
        let mut effects = super::super::Effects::default();
        effects.add(CRANK).unwrap();
        let actual = Machine::reference().axes[0].actual.clone();
        let sliding = Sliding {
            coulomb_n: 0.0,
            static_n: 0.0,
            viscous_n_s_per_m: 0.0,
            ..actual.sliding
        };
        let parameters = AxisParameters {
            sliding,
            law: Law::Coulomb,
            effects,
            current_loop_time_constant_s: 0.0,
            force_noise_n: 0.0,
            ..actual
        };
        Axis::new(parameters, 1)
    }

    /// ½ (M + m(x)) v².
    fn energy(axis: &Axis) -> f64 {
        let mechanics = axis.parameters().mechanics;
        let own = mechanics.motor_inertia_kg + mechanics.table_mass_kg;
        let at = Instant {
            table_m: axis.motion().table_m,
            ..Instant::default()
        };
        0.5 * (own + CRANK.added_mass_kg(&at)) * axis.motion().table_m_per_s.powi(2)
    }

    #[test]
    fn an_axis_that_coasts_keeps_its_energy_while_its_mass_changes() {
        let mut axis = axis();
        axis.place(Motion {
            motor_m_per_s: 0.3,
            table_m_per_s: 0.3,
            ..Motion::default()
        });
        let start = energy(&axis);
        let (mut slowest, mut fastest) = (f64::INFINITY, 0.0_f64);
        for _ in 0..700 {
            axis.advance(0.0, 1.0e-3);
            let velocity = axis.motion().table_m_per_s;
            (slowest, fastest) = (slowest.min(velocity), fastest.max(velocity));
        }
        assert!((energy(&axis) / start - 1.0).abs() < 2.0e-3);
        assert!(fastest / slowest > 1.05, "{slowest} {fastest}");
    }
}
