//! The records on which the identification is judged: nothing, each effect alone, pairs, and
//! disturbances outside the list.
//!
//! The place of a plan in the list gives its seed and its noise, so a new plan goes to the end.

use super::hidden::Foreign::{CubicDrag, Hum, Spring};
use super::hidden::Hidden::{
    self, Backlash, Compliance, Delay, Foreign, FrictionDrift, LoadDependentFriction, LoggedLate,
    Payload, PitchError, PositionDependentFriction, PositionDependentInertia, Presliding,
    QuadraticDrag, Stribeck, TorqueConstantRipple, TorqueRipple, TorqueSaturation,
    ViscousAsymmetry,
};
use super::plan::{Plan, Positions};

/// Noise levels of the recorded effort, N.
const NOISE_N: [f64; 3] = [1.5, 4.0, 9.0];

/// Records with nothing hidden; every second one has a load scale.
pub const EMPTY: usize = 20;

/// Seed of the first plan.
const FIRST_SEED: u64 = 1000;

/// What a plan hides and which positions it records.
#[derive(Clone, Copy)]
struct Case {
    positions: Positions,
    hidden: &'static [Hidden],
}

/// With the motor's position alone.
const fn motor(hidden: &'static [Hidden]) -> Case {
    Case {
        positions: Positions::Motor,
        hidden,
    }
}

/// With a load scale.
const fn scale(hidden: &'static [Hidden]) -> Case {
    Case {
        positions: Positions::MotorAndLoad,
        hidden,
    }
}

#[rustfmt::skip] // One line for each case: the list is read across.
const ALONE: &[Case] = &[
    motor(&[ViscousAsymmetry { share: 0.10 }]),
    motor(&[ViscousAsymmetry { share: -0.25 }]),
    motor(&[Stribeck { ratio: 1.3, velocity_m_per_s: 3.0e-3 }]),
    motor(&[Stribeck { ratio: 1.6, velocity_m_per_s: 6.0e-3 }]),
    motor(&[Presliding { deflection_m: 4.0e-6 }]),
    motor(&[Presliding { deflection_m: 12.0e-6 }]),
    scale(&[Presliding { deflection_m: 8.0e-6 }]),
    scale(&[Backlash { gap_m: 12.0e-6 }]),
    scale(&[Backlash { gap_m: 40.0e-6 }]),
    motor(&[Backlash { gap_m: 20.0e-6 }]),
    motor(&[Backlash { gap_m: 45.0e-6 }]),
    scale(&[Compliance { stiffness_n_per_m: 4.0e7 }]),
    scale(&[Compliance { stiffness_n_per_m: 1.2e8 }]),
    motor(&[TorqueRipple { amplitude_n: 8.0, order_per_rev: 6.0 }]),
    motor(&[TorqueRipple { amplitude_n: 25.0, order_per_rev: 2.0 }]),
    scale(&[PitchError { amplitude_m: 1.5e-6, period_m: 0.010 }]),
    scale(&[PitchError { amplitude_m: 5.0e-6, period_m: 0.020 }]),
    motor(&[PositionDependentFriction { per_m: 1.0 }]),
    motor(&[PositionDependentFriction { per_m: -2.0 }]),
    motor(&[FrictionDrift { gain: 0.2, time_constant_s: 8.0 }]),
    motor(&[FrictionDrift { gain: 0.4, time_constant_s: 15.0 }]),
    motor(&[QuadraticDrag { n_s2_per_m2: 600.0 }]),
    motor(&[QuadraticDrag { n_s2_per_m2: 1500.0 }]),
    motor(&[TorqueSaturation { share: 0.05 }]),
    motor(&[TorqueSaturation { share: 0.12 }]),
    motor(&[Delay { delay_s: 0.5e-3 }]),
    motor(&[Delay { delay_s: 0.9e-3 }]),
];

#[rustfmt::skip] // As above.
const PAIRS: &[Case] = &[
    motor(&[Stribeck { ratio: 1.5, velocity_m_per_s: 4.0e-3 },
            TorqueRipple { amplitude_n: 15.0, order_per_rev: 6.0 }]),
    motor(&[ViscousAsymmetry { share: 0.2 }, FrictionDrift { gain: 0.3, time_constant_s: 10.0 }]),
    motor(&[PositionDependentFriction { per_m: 1.5 },
            TorqueRipple { amplitude_n: 20.0, order_per_rev: 3.0 }]),
    motor(&[QuadraticDrag { n_s2_per_m2: 1000.0 },
            Stribeck { ratio: 1.4, velocity_m_per_s: 5.0e-3 }]),
    scale(&[Backlash { gap_m: 20.0e-6 }, TorqueRipple { amplitude_n: 15.0, order_per_rev: 6.0 }]),
    motor(&[Delay { delay_s: 0.6e-3 }, ViscousAsymmetry { share: -0.2 }]),
    scale(&[PitchError { amplitude_m: 3.0e-6, period_m: 0.010 },
            Stribeck { ratio: 1.4, velocity_m_per_s: 4.0e-3 }]),
    scale(&[Compliance { stiffness_n_per_m: 6.0e7 },
            FrictionDrift { gain: 0.3, time_constant_s: 8.0 }]),
    motor(&[Presliding { deflection_m: 8.0e-6 },
            Stribeck { ratio: 1.4, velocity_m_per_s: 4.0e-3 }]),
    motor(&[Presliding { deflection_m: 6.0e-6 },
            TorqueRipple { amplitude_n: 12.0, order_per_rev: 4.0 }]),
    motor(&[TorqueSaturation { share: 0.10 }, ViscousAsymmetry { share: 0.2 }]),
    scale(&[Backlash { gap_m: 30.0e-6 }, FrictionDrift { gain: 0.3, time_constant_s: 12.0 }]),
];

#[rustfmt::skip] // As above.
const OUTSIDE: &[Case] = &[
    motor(&[Foreign(Spring { n_per_m: 400.0 })]),
    scale(&[Foreign(Spring { n_per_m: -150.0 })]),
    motor(&[Foreign(Hum { amplitude_n: 12.0, hz: 0.7 })]),
    scale(&[Foreign(Hum { amplitude_n: 20.0, hz: 3.0 })]),
    motor(&[Foreign(CubicDrag { n_s3_per_m3: 12_000.0 })]),
    motor(&[Foreign(Spring { n_per_m: 300.0 }), Foreign(Hum { amplitude_n: 10.0, hz: 1.3 })]),
];

#[rustfmt::skip] // As above.
const FOLLOWING_LOAD: &[Case] = &[
    motor(&[LoadDependentFriction { share: 0.15 }]),
    motor(&[LoadDependentFriction { share: 0.12 },
            Stribeck { ratio: 1.4, velocity_m_per_s: 4.0e-3 }]),
];

#[rustfmt::skip] // As above.
const CHANGING_MASS: &[Case] = &[
    motor(&[Payload { kg: 90.0, at_s: 11.0 }]),
    motor(&[PositionDependentInertia { kg: 70.0, period_m: 0.15 }]),
    motor(&[PositionDependentInertia { kg: 50.0, period_m: 0.08 },
            ViscousAsymmetry { share: 0.2 }]),
];

#[rustfmt::skip] // As above.
const OTHER_EFFORT: &[Case] = &[
    motor(&[TorqueConstantRipple { share: 0.06, order_per_rev: 6.0 }]),
    motor(&[TorqueConstantRipple { share: 0.1, order_per_rev: 1.0 },
            Stribeck { ratio: 1.4, velocity_m_per_s: 4.0e-3 }]),
    motor(&[LoggedLate { late_s: 1.3e-3 }]),
    motor(&[LoggedLate { late_s: 4.0e-3 }, ViscousAsymmetry { share: 0.2 }]),
];

/// All plans, in a fixed order.
#[must_use]
pub fn plans() -> Vec<Plan> {
    let empty = (0..EMPTY).map(|index| {
        let case = if index % 2 == 0 { scale } else { motor };
        case(&[])
    });
    let later = [FOLLOWING_LOAD, CHANGING_MASS, OTHER_EFFORT].concat();
    let hidden = [ALONE, PAIRS, OUTSIDE, &later].concat();
    let cases = empty.chain(hidden).enumerate();
    cases.map(|(index, case)| plan(index, case)).collect()
}

fn plan(index: usize, case: Case) -> Plan {
    Plan {
        positions: case.positions,
        hidden: case.hidden.to_vec(),
        noise_n: NOISE_N[index % NOISE_N.len()],
        seed: FIRST_SEED + index as u64,
        ..Plan::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn there_are_74_plans_and_every_seed_is_its_own() {
        let plans = plans();
        let hides = |count: usize| {
            plans
                .iter()
                .filter(|plan| plan.hidden.len() == count)
                .count()
        };
        assert_eq!((hides(0), hides(1), hides(2)), (EMPTY, 37, 17));
        let seeds: Vec<u64> = plans.iter().map(|plan| plan.seed).collect();
        assert_eq!(seeds, (1000..1074).collect::<Vec<_>>());
    }

    #[test]
    fn what_acts_between_motor_and_load_is_recorded_with_a_scale() {
        for plan in plans() {
            let needs_scale = |one: &Hidden| matches!(one, Compliance { .. } | PitchError { .. });
            if plan.hidden.iter().any(needs_scale) {
                assert_eq!(plan.positions, Positions::MotorAndLoad, "{plan:?}");
            }
        }
    }
}
