//! The drive's model of friction made of what a machine file says, not of what a record shows: what
//! is left with it is not the fault of identification. Friction of both sides of the screw is one
//! friction to the drive, made of the elements of both.

use std::f64::consts::TAU;

use axis_model::{
    Backlash, Compliance, Coulomb, CoulombAsymmetry, Effect, Estimate, Inertia, Presliding,
    Stribeck, TorqueRipple, Viscous, ViscousAsymmetry,
};
use plant_sim::friction::{Law, Sliding};
use plant_sim::machine::MachineAxis;
use workbench::compensation::{AxisCompensation, Compensation};
use workbench::model_file::{Known, MotorSide};
use workbench::tuning::friction_model::{self, RIGID_M};
use workbench::tuning::springs::{Spring, Springs, of_bristle};

/// The compensation of an axis; none where it has no friction. Friction over position is not in it.
#[must_use]
pub fn model(axis: &MachineAxis, period_s: f64) -> AxisCompensation {
    let known = Known::of_machine(axis, period_s);
    let (slipping, motor) = (slipping(axis), bristle_of_motor(axis));
    let model = friction_model::of_effects(&known, &effects(axis), slipping, motor);
    let model = model.map(|model| Compensation::Model(Box::new(model)));
    AxisCompensation {
        reversal: model.unwrap_or_default(),
        backlash_m: 0.0,
    }
}

/// The motor's friction beside that of the table, where both are bristles.
fn bristle_of_motor(axis: &MachineAxis) -> Option<MotorSide> {
    let own = axis.actual.motor_side.as_ref()?;
    let deflection_m = |sliding: &Sliding, law: &Law| match law {
        Law::LuGre { .. } => Some(sliding.coulomb_n / law.stiffness_n_per_m()),
        _ => None,
    };
    let own_m = deflection_m(&own.sliding, &own.law)?;
    let of_table_m = deflection_m(&axis.actual.sliding, &axis.actual.law)?;
    Some(MotorSide {
        coulomb_n: own.sliding.coulomb_n,
        share: own.sliding.coulomb_n / coulomb_n(axis),
        deflection: own_m / of_table_m,
    })
}

fn known(value: f64) -> Estimate {
    Estimate::about(value, 0.0, "")
}

/// Friction of the table, and of the motor's side where it has some.
fn sides(axis: &MachineAxis) -> Vec<(&Sliding, &Law)> {
    let actual = &axis.actual;
    let motor = actual.motor_side.as_ref();
    let motor = motor.map(|own| (&own.sliding, &own.law));
    [(&actual.sliding, &actual.law)]
        .into_iter()
        .chain(motor)
        .collect()
}

/// A quantity of both sides together.
fn of_both(axis: &MachineAxis, of_side: impl Fn(&Sliding, &Law) -> f64) -> f64 {
    let each = sides(axis).into_iter();
    each.map(|(sliding, law)| of_side(sliding, law)).sum()
}

fn coulomb_n(axis: &MachineAxis) -> f64 {
    of_both(axis, |sliding, _| sliding.coulomb_n)
}

fn excess_n(sliding: &Sliding) -> f64 {
    sliding.static_n - sliding.coulomb_n
}

/// A quantity of each side as far as it falls.
fn by_fall(axis: &MachineAxis, of_side: impl Fn(&Sliding) -> f64) -> f64 {
    let all_n = of_both(axis, |sliding, _| excess_n(sliding));
    let each = |sliding: &Sliding, _: &Law| excess_n(sliding) * of_side(sliding);
    of_both(axis, each) / all_n.max(f64::MIN_POSITIVE)
}

/// Share of the fall that is of a bristle at the table; of the friction where nothing falls.
fn bristle_share(axis: &MachineAxis) -> f64 {
    let of_table = &axis.actual.sliding;
    let falls_n = of_both(axis, |sliding, _| excess_n(sliding));
    match axis.actual.law {
        Law::LuGre { .. } if falls_n > 0.0 => excess_n(of_table) / falls_n,
        Law::LuGre { .. } => of_table.coulomb_n / coulomb_n(axis),
        _ => 0.0,
    }
}

/// Damping of bristles, as identification has it: of the whole friction, where only the table has
/// a bristle.
fn bristle_damping(axis: &MachineAxis) -> f64 {
    let damping = |law: &Law| match law {
        Law::LuGre {
            bristle_damping_n_s_per_m,
            ..
        } => *bristle_damping_n_s_per_m,
        _ => 0.0,
    };
    let all = of_both(axis, |_, law| damping(law));
    let of_table = damping(&axis.actual.law);
    if all > of_table {
        all
    } else {
        of_table * coulomb_n(axis) / axis.actual.sliding.coulomb_n
    }
}

fn effects(axis: &MachineAxis) -> Vec<Effect<Estimate>> {
    let (sliding, mechanics) = (&axis.actual.sliding, &axis.actual.mechanics);
    let (motor_kg, table_kg) = (mechanics.motor_inertia_kg, mechanics.table_mass_kg);
    let stiffness_n_per_m = axis.actual.law.stiffness_n_per_m();
    let excess_n = of_both(axis, |sliding, _| excess_n(sliding));
    let mut effects = vec![
        Effect::Inertia(Inertia {
            inertia: known(motor_kg + table_kg),
            load: Some(known(table_kg)),
        }),
        Effect::Coulomb(Coulomb {
            coulomb: known(coulomb_n(axis)),
        }),
        Effect::Viscous(Viscous {
            viscous: known(of_both(axis, |sliding, _| sliding.viscous_n_s_per_m)),
        }),
        Effect::CoulombAsymmetry(CoulombAsymmetry {
            coulomb_asymmetry: known(sliding.coulomb_asymmetry),
        }),
        Effect::ViscousAsymmetry(ViscousAsymmetry {
            viscous_asymmetry: known(sliding.viscous_asymmetry),
        }),
        Effect::Stribeck(Stribeck {
            excess: known(excess_n),
            velocity: known(sliding.stribeck_velocity_m_per_s),
            exponent: Some(known(sliding.stribeck_exponent)),
            lag: Some(known(by_fall(axis, |own| own.stribeck_lag_s))),
            lag_growth: Some(known(sliding.stribeck_lag_growth)),
        }),
        Effect::Compliance(Compliance {
            stiffness: known(mechanics.screw_stiffness_n_per_m),
            damping: Some(known(mechanics.screw_damping_n_s_per_m)),
        }),
    ];
    if mechanics.backlash_m > 0.0 {
        effects.push(Effect::Backlash(Backlash {
            gap: known(mechanics.backlash_m),
            motor_friction: None,
            restitution: None,
            load_share: None,
        }));
    }
    if stiffness_n_per_m > 0.0 {
        effects.push(Effect::Presliding(Presliding {
            deflection: known(sliding.coulomb_n / stiffness_n_per_m),
            damping: Some(known(bristle_damping(axis))),
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

/// Springs of both sides, where one at least has Maxwell slip: a bristle beside such is as many.
fn slipping(axis: &MachineAxis) -> Option<Springs> {
    let sides = sides(axis);
    let slips = |(_, law): &(&Sliding, &Law)| matches!(law, Law::MaxwellSlip { .. });
    sides.iter().any(slips).then(|| {
        let mut each = sides.into_iter().map(springs);
        Springs {
            table: each.next().unwrap_or_default(),
            motor: each.next().unwrap_or_default(),
            bristle_share: bristle_share(axis),
        }
    })
}

fn springs((sliding, law): (&Sliding, &Law)) -> Vec<Spring> {
    let coulomb_n = sliding.coulomb_n;
    match law {
        Law::Coulomb => vec![Spring {
            level_n: coulomb_n,
            way_m: RIGID_M,
        }],
        Law::LuGre { .. } => of_bristle(coulomb_n, coulomb_n / law.stiffness_n_per_m()),
        Law::MaxwellSlip {
            stiffness_n_per_m,
            share,
        } => {
            let spring = |(share, stiffness): (&f64, &f64)| {
                let level_n = share * coulomb_n;
                Spring {
                    level_n,
                    way_m: level_n / stiffness,
                }
            };
            share.iter().zip(stiffness_n_per_m).map(spring).collect()
        }
    }
}
