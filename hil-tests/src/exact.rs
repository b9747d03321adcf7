//! The drive's model of friction made of what a machine file says, not of what a record shows: what
//! is left with it is not the fault of identification.

use std::f64::consts::TAU;

use axis_model::{
    Compliance, Coulomb, Effect, Estimate, Inertia, Presliding, Stribeck, TorqueRipple, Viscous,
    ViscousAsymmetry,
};
use plant_sim::friction::Law;
use plant_sim::machine::MachineAxis;
use workbench::compensation::{AxisCompensation, Compensation};
use workbench::model_file::Known;
use workbench::tuning::friction_model;

/// The compensation of an axis; none where it has no friction. Friction over position is not in it.
#[must_use]
pub fn model(axis: &MachineAxis, period_s: f64) -> AxisCompensation {
    let known = Known::of_machine(axis, period_s);
    let model = friction_model::of_effects(&known, &effects(axis), &elements(axis));
    AxisCompensation {
        reversal: model.map_or(Compensation::None, |model| {
            Compensation::Model(Box::new(model))
        }),
        backlash_m: 0.0,
    }
}

fn known(value: f64) -> Estimate {
    Estimate::about(value, 0.0, "")
}

fn effects(axis: &MachineAxis) -> Vec<Effect<Estimate>> {
    let (sliding, mechanics) = (&axis.actual.sliding, &axis.actual.mechanics);
    let (motor_kg, table_kg) = (mechanics.motor_inertia_kg, mechanics.table_mass_kg);
    let stiffness_n_per_m = axis.actual.law.stiffness_n_per_m();
    let damping = match axis.actual.law {
        Law::LuGre {
            bristle_damping_n_s_per_m,
            ..
        } => bristle_damping_n_s_per_m,
        _ => 0.0,
    };
    let mut effects = vec![
        Effect::Inertia(Inertia {
            inertia: known(motor_kg + table_kg),
            load: Some(known(table_kg)),
        }),
        Effect::Coulomb(Coulomb {
            coulomb: known(sliding.coulomb_n),
        }),
        Effect::Viscous(Viscous {
            viscous: known(sliding.viscous_n_s_per_m),
        }),
        Effect::ViscousAsymmetry(ViscousAsymmetry {
            viscous_asymmetry: known(sliding.viscous_asymmetry),
        }),
        Effect::Stribeck(Stribeck {
            excess: known(sliding.static_n - sliding.coulomb_n),
            velocity: known(sliding.stribeck_velocity_m_per_s),
            exponent: Some(known(sliding.stribeck_exponent)),
            lag: Some(known(sliding.stribeck_lag_s)),
        }),
        Effect::Compliance(Compliance {
            stiffness: known(mechanics.screw_stiffness_n_per_m),
            damping: Some(known(mechanics.screw_damping_n_s_per_m)),
        }),
    ];
    if stiffness_n_per_m > 0.0 {
        effects.push(Effect::Presliding(Presliding {
            deflection: known(sliding.coulomb_n / stiffness_n_per_m),
            damping: Some(known(damping)),
        }));
    }
    let listed = axis
        .actual
        .effects
        .list()
        .iter()
        .filter_map(|effect| match effect {
            Effect::TorqueRipple(own) => Some(Effect::TorqueRipple(ripple(own))),
            _ => None,
        });
    effects.extend(listed);
    effects
}

fn ripple(own: &TorqueRipple<f64>) -> TorqueRipple<Estimate> {
    TorqueRipple {
        amplitude: known(own.amplitude),
        order: own.order.map(known),
        period: own.period.map(known),
        phase: own.phase.map(|phase| known(phase.rem_euclid(TAU))),
    }
}

/// Shares and ways from rest of Maxwell slip.
fn elements(axis: &MachineAxis) -> Vec<(f64, f64)> {
    let Law::MaxwellSlip {
        stiffness_n_per_m,
        share,
    } = &axis.actual.law
    else {
        return Vec::new();
    };
    let level_n = axis.actual.sliding.coulomb_n;
    let pairs = share.iter().zip(stiffness_n_per_m);
    pairs
        .map(|(share, stiffness)| (*share, share * level_n / stiffness))
        .collect()
}
