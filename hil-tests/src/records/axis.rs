//! The axis of a plan: masses, friction and offset by the seed, then what is hidden.
//!
//! Ranges are those of a table with a screw of 10 mm, about 700 kg as the motor sees it: other
//! machines of the make of the reference axis.

use axis_model::Offset;
use plant_sim::axis::{Axis, AxisParameters, Mounting, Reading};
use plant_sim::effects::Effects;
use plant_sim::friction::{Law, Sliding};
use plant_sim::mechanics::Mechanics;

use super::draws::Draws;
use super::plan::{Plan, Sensor};
use super::{COUNTS_PER_REV, LEAD_M};

/// Force that disturbs the axis, as a share of the noise of the recorded effort.
const DISTURBANCE: f64 = 0.3;
/// Resolution of the load scale, m.
pub(super) const LOAD_RESOLUTION_M: f64 = 1.0e-7;
/// A load reading counts 10 nm.
const M_PER_LOAD_COUNT: f64 = 1.0e-8;

/// The axis of a plan.
pub(super) fn parameters(plan: &Plan, draws: &mut Draws) -> AxisParameters {
    let sliding = sliding(plan, draws);
    let mechanics = mechanics(draws);
    let mut parameters = AxisParameters {
        mechanics,
        lead_m_per_rev: LEAD_M,
        sliding,
        law: Law::Coulomb,
        motor_side: None,
        effects: offset(draws.between(-30.0, 30.0)),
        motor_encoder_counts_per_rev: COUNTS_PER_REV,
        load_encoder_resolution_m: LOAD_RESOLUTION_M,
        current_loop_time_constant_s: 2.0e-5,
        force_limit_n: 1.0e4,
        force_noise_n: DISTURBANCE * plan.noise_n,
        mounting: Mounting::default(),
    };
    for hidden in &plan.hidden {
        hidden.hide_in(&mut parameters);
    }
    parameters
}

fn offset(offset: f64) -> Effects {
    let mut effects = Effects::default();
    let added = effects.add(Offset { offset });
    added.expect("the simulator has an offset");
    effects
}

/// Coulomb and viscous friction without a Stribeck fall.
fn sliding(plan: &Plan, draws: &mut Draws) -> Sliding {
    let coulomb_n = plan.friction_factor * draws.between(180.0, 320.0);
    Sliding {
        coulomb_n,
        static_n: coulomb_n,
        stribeck_velocity_m_per_s: 2.0e-3,
        stribeck_exponent: 2.0,
        stribeck_lag_s: 0.0,
        stribeck_lag_growth: 0.0,
        viscous_n_s_per_m: draws.between(700.0, 1100.0),
        coulomb_asymmetry: 0.0,
        viscous_asymmetry: 0.0,
        quadratic_drag_n_s2_per_m2: 0.0,
    }
}

/// Motor and table on a screw that is as good as rigid.
fn mechanics(draws: &mut Draws) -> Mechanics {
    Mechanics {
        motor_inertia_kg: draws.between(380.0, 460.0),
        table_mass_kg: draws.between(250.0, 340.0),
        screw_stiffness_n_per_m: 1.0e10,
        screw_damping_n_s_per_m: 2.0e5,
        backlash_m: 0.0,
    }
}

/// The moved mass, kg.
pub(super) fn mass_kg(parameters: &AxisParameters) -> f64 {
    parameters.mechanics.motor_inertia_kg + parameters.mechanics.table_mass_kg
}

/// Way of one count of the motor encoder, m.
pub(super) fn motor_resolution_m() -> f64 {
    LEAD_M / f64::from(COUNTS_PER_REV)
}

/// What the encoders say.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Measured {
    /// Position of the motor, m.
    pub(super) motor_m: f64,
    /// Position of the table, m.
    pub(super) load_m: f64,
}

impl Measured {
    /// Reads the encoders of an axis.
    pub(super) fn of(axis: &mut Axis) -> Self {
        let Reading {
            motor_increments,
            load_10_nm,
        } = axis.read();
        Self {
            motor_m: motor_increments as f64 * motor_resolution_m(),
            load_m: M_PER_LOAD_COUNT * load_10_nm as f64,
        }
    }

    /// The position on which the loop is closed, m.
    pub(super) const fn at(self, sensor: Sensor) -> f64 {
        match sensor {
            Sensor::Motor => self.motor_m,
            Sensor::Load => self.load_m,
        }
    }
}
