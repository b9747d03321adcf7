//! The records on which the identification is judged: nothing, each effect alone, pairs, and
//! disturbances outside the list.

use crate::records::Hidden::{
    Backlash, Compliance, CubicDrag, Delay, FrictionDrift, Hum, PitchError,
    PositionDependentFriction, Presliding, QuadraticDrag, Spring, Stribeck, TorqueRipple,
    TorqueSaturation, ViscousAsymmetry,
};
use crate::records::Plan;

/// Noise levels of the recorded effort, N.
const NOISE_N: [f64; 3] = [1.5, 4.0, 9.0];

/// Records with nothing hidden.
pub const EMPTY: usize = 20;

/// All plans, in a fixed order.
#[must_use]
pub fn plans() -> Vec<Plan> {
    let empty = (0..EMPTY).map(|_| (vec![], false));
    let single = [
        (vec![ViscousAsymmetry(0.10)], false),
        (vec![ViscousAsymmetry(-0.25)], false),
        (vec![Stribeck(1.3, 3.0e-3)], false),
        (vec![Stribeck(1.6, 6.0e-3)], false),
        (vec![Presliding(4.0e-6)], false),
        (vec![Presliding(12.0e-6)], false),
        (vec![Presliding(8.0e-6)], true),
        (vec![Backlash(12.0e-6)], true),
        (vec![Backlash(40.0e-6)], true),
        (vec![Backlash(20.0e-6)], false),
        (vec![Backlash(45.0e-6)], false),
        (vec![Compliance(4.0e7)], true),
        (vec![Compliance(1.2e8)], true),
        (vec![TorqueRipple(8.0, 6.0)], false),
        (vec![TorqueRipple(25.0, 2.0)], false),
        (vec![PitchError(1.5e-6, 0.010)], true),
        (vec![PitchError(5.0e-6, 0.020)], true),
        (vec![PositionDependentFriction(1.0)], false),
        (vec![PositionDependentFriction(-2.0)], false),
        (vec![FrictionDrift(0.2, 8.0)], false),
        (vec![FrictionDrift(0.4, 15.0)], false),
        (vec![QuadraticDrag(600.0)], false),
        (vec![QuadraticDrag(1500.0)], false),
        (vec![TorqueSaturation(0.05)], false),
        (vec![TorqueSaturation(0.12)], false),
        (vec![Delay(0.5e-3)], false),
        (vec![Delay(0.9e-3)], false),
    ];
    let pairs = [
        (vec![Stribeck(1.5, 4.0e-3), TorqueRipple(15.0, 6.0)], false),
        (vec![ViscousAsymmetry(0.2), FrictionDrift(0.3, 10.0)], false),
        (
            vec![PositionDependentFriction(1.5), TorqueRipple(20.0, 3.0)],
            false,
        ),
        (vec![QuadraticDrag(1000.0), Stribeck(1.4, 5.0e-3)], false),
        (vec![Backlash(20.0e-6), TorqueRipple(15.0, 6.0)], true),
        (vec![Delay(0.6e-3), ViscousAsymmetry(-0.2)], false),
        (vec![PitchError(3.0e-6, 0.010), Stribeck(1.4, 4.0e-3)], true),
        (vec![Compliance(6.0e7), FrictionDrift(0.3, 8.0)], true),
        (vec![Presliding(8.0e-6), Stribeck(1.4, 4.0e-3)], false),
        (vec![Presliding(6.0e-6), TorqueRipple(12.0, 4.0)], false),
        (vec![TorqueSaturation(0.10), ViscousAsymmetry(0.2)], false),
        (vec![Backlash(30.0e-6), FrictionDrift(0.3, 12.0)], true),
    ];
    let outside = [
        (vec![Spring(400.0)], false),
        (vec![Spring(-150.0)], true),
        (vec![Hum(12.0, 0.7)], false),
        (vec![Hum(20.0, 3.0)], true),
        (vec![CubicDrag(12_000.0)], false),
        (vec![Spring(300.0), Hum(10.0, 1.3)], false),
    ];
    let all = empty.chain(single).chain(pairs).chain(outside);
    all.enumerate()
        .map(|(index, (hidden, load_scale))| Plan {
            load_scale: load_scale || (hidden.is_empty() && index % 2 == 0),
            hidden,
            noise_n: NOISE_N[index % NOISE_N.len()],
            seed: 1000 + index as u64,
            ..Plan::default()
        })
        .collect()
}
