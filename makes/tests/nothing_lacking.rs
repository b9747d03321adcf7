//! An empty make lacks nothing: over windows of its run the drive's impulse is inertia, viscous
//! friction, Coulomb friction and a constant force, and they come out as `truth.json` says.
//!
//! ∫F dt = M·Δv + Fv·Δx + Fc·∫sign v dt + F0·Δt, from the true motion of the run, not from its
//! record. With its effect present the same sum leaves more, where the effect is one of effort.

mod common;

use common::{some_of, some_outside};
use makes::make::{Make, Presence};
use makes::rig::Rig;
use makes::sensing::Trace;
use makes::truth::Effect;
use nalgebra::{DMatrix, DVector};
use scope::on_all_cores;

/// Windows of 20 ms: longer than the swing of any joint, shorter than any move.
const WINDOW_S: f64 = 0.02;

/// Slower than this share of its largest velocity the motor may wind up its joint before a load
/// that sticks, under any effort.
const STANDS: f64 = 1.0e-3;

/// Share of the impulse (without its mean) that the four leave, and the four.
fn fit(rig: &Rig) -> (f64, Vec<f64>) {
    let trace = rig.run(&(rig.training.0.clone(), rig.training.1.min(24.0)));
    let rows: Vec<[f64; 5]> = windows(&trace);
    let columns = DMatrix::from_fn(rows.len(), 4, |row, column| rows[row][column]);
    let impulse = DVector::from_iterator(rows.len(), rows.iter().map(|row| row[4]));
    let found = columns
        .clone()
        .svd(true, true)
        .solve(&impulse, 1.0e-14)
        .expect("both sides of the decomposition were asked for");
    let left = (&impulse - columns * &found).norm();
    let share = left / impulse.add_scalar(-impulse.mean()).norm();
    (share, found.iter().copied().collect())
}

/// Largest effort of the training record.
fn strongest(rig: &Rig) -> f64 {
    let trace = rig.run(&(rig.training.0.clone(), 5.0));
    trace.current.iter().fold(0.0, |most, f| f.abs().max(most))
}

/// Δv, Δx, ∫sign v dt, Δt and the impulse of every window in which the axis moves and
/// does not turn over.
fn windows(trace: &Trace) -> Vec<[f64; 5]> {
    let count = (WINDOW_S / trace.step_s).round() as usize;
    let fastest = trace.velocity.iter().fold(0.0_f64, |m, v| v.abs().max(m));
    let window = |k: usize| {
        let (from, to) = (k * count, (k + 1) * count);
        let sign = trace.velocity[from].signum();
        let mut velocities = trace.velocity[from..=to].iter();
        let one_way = velocities.all(|v| v * sign > STANDS * fastest);
        let impulse = trace.current[from..to].iter().sum::<f64>() * trace.step_s;
        let dv = trace.velocity[to] - trace.velocity[from];
        let dx = trace.motor[to] - trace.motor[from];
        one_way.then_some([dv, dx, sign * WINDOW_S, WINDOW_S, impulse])
    };
    (0..trace.motor.len() / count - 1)
        .filter_map(window)
        .collect()
}

#[test]
fn an_empty_make_is_what_its_declared_model_says() {
    let rows = some_of(|_| true);
    let fits = on_all_cores(&rows, |make| {
        let rig = make.rig(Presence::Absent, 1);
        (fit(&rig), rig)
    });
    for (make, ((left, found), rig)) in rows.iter().zip(fits) {
        println!("{} {:.2} %", make.name, 100.0 * left);
        assert!(left < 0.02, "{}: {:.2} % left", make.name, 100.0 * left);
        let off = |found: f64, told: f64| (found / told - 1.0).abs();
        assert!(
            off(found[0], rig.train.inertia()) < 0.02,
            "{} {found:?}",
            make.name
        );
        // Films of oil and air have none: what is found is then small beside the whole effort.
        let coulomb = rig.train.coulomb();
        let none = coulomb == 0.0 && found[2].abs() < 0.01 * strongest(&rig);
        assert!(
            none || off(found[2], coulomb) < 0.03,
            "{} {found:?}",
            make.name
        );
    }
}

/// Effects that the sum of moving samples shows.
const OF_EFFORT: [Effect; 11] = [
    Effect::ViscousAsymmetry,
    Effect::Stribeck,
    Effect::TorqueRipple,
    Effect::PositionDependentFriction,
    Effect::FrictionDrift,
    Effect::QuadraticDrag,
    Effect::TorqueSaturation,
    Effect::Payload,
    Effect::PositionDependentInertia,
    Effect::LoadDependentFriction,
    Effect::TorqueConstantRipple,
];

#[test]
fn an_effect_of_effort_leaves_what_the_declared_model_cannot_say() {
    let shows = |make: &Make| make.hides.iter().any(|effect| OF_EFFORT.contains(effect));
    let rows = some_of(shows);
    let left = on_all_cores(&rows, |make| fit(&make.rig(Presence::Present, 1)).0);
    for (make, left) in rows.iter().zip(left) {
        println!("{} {:.2} %", make.name, 100.0 * left);
        assert!(left > 0.02, "{}: {:.2} % left", make.name, 100.0 * left);
    }
}

#[test]
fn a_machine_held_back_lacks_nothing_without_its_disturbance() {
    let rows = some_outside();
    let fits = on_all_cores(&rows, |row| (fit(&row.good_rig(1)).0, fit(&row.rig(1)).0));
    for (row, (good, disturbed)) in rows.iter().zip(fits) {
        println!(
            "{} {:.2} % and {:.2} %",
            row.name,
            100.0 * good,
            100.0 * disturbed
        );
        assert!(good < 0.02, "{}: {:.2} % left", row.name, 100.0 * good);
    }
}
