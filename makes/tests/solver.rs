//! The step of the train against an integrator that is not ours: Dormand and Prince's of fifth
//! order (`ode_solvers`), with tolerances far below what is compared.

use makes::mechanics::friction::{Law, Stribeck};
use makes::mechanics::joint::Joint;
use makes::mechanics::train::Train;
use ode_solvers::dopri5::Dopri5;
use ode_solvers::rk4::Rk4;
use ode_solvers::{SVector, System};

/// Step of the makes, s.
const STEP_S: f64 = 2.0e-5;
const DURATION_S: f64 = 0.5;

/// A drive's effort: two sines.
fn drive(time_s: f64) -> f64 {
    60.0 * libm::sin(20.0 * time_s) + 25.0 * libm::sin(71.0 * time_s)
}

fn ours(train: &Train) -> (f64, f64) {
    ours_by(train, STEP_S)
}

fn ours_by(train: &Train, step_s: f64) -> (f64, f64) {
    let mut state = train.at_rest(0.0);
    for k in 0..(DURATION_S / step_s).round() as usize {
        train.step(&mut state, drive((k as f64 + 0.5) * step_s), step_s);
    }
    (state.positions[0], state.positions[train.load()])
}

fn theirs<S: System<f64, SVector<f64, 4>>>(system: S) -> (f64, f64) {
    let start = SVector::<f64, 4>::zeros();
    let mut solver = Dopri5::new(system, 0.0, DURATION_S, 1.0e-3, start, 1.0e-10, 1.0e-12);
    solver.integrate().expect("it integrates");
    let end = solver.y_out().last().expect("it has an end");
    (end[0], end[1])
}

/// By classic Runge and Kutta with a step of a microsecond, where bristles make it stiff.
fn theirs_by_small_steps<S: System<f64, SVector<f64, 4>>>(system: S) -> (f64, f64) {
    let start = SVector::<f64, 4>::zeros();
    let mut solver = Rk4::new(system, 0.0, start, DURATION_S, 1.0e-6);
    solver.integrate().expect("it integrates");
    let end = solver.y_out().last().expect("it has an end");
    (end[0], end[1])
}

/// Two masses on a shaft with viscous friction: positions, velocities.
struct Shaft;

impl System<f64, SVector<f64, 4>> for Shaft {
    fn system(&self, t: f64, y: &SVector<f64, 4>, dy: &mut SVector<f64, 4>) {
        let carried = 2.0e5 * (y[0] - y[1]) + 80.0 * (y[2] - y[3]);
        dy[0] = y[2];
        dy[1] = y[3];
        dy[2] = (drive(t) - carried - 10.0 * y[2]) / 3.0;
        dy[3] = (carried - 20.0 * y[3]) / 5.0;
    }
}

#[test]
fn a_shaft_ends_where_another_solver_says() {
    let train = Train::one(3.0, 0.0, 10.0).then(Joint::stiff(2.0e5, 80.0), 5.0, 0.0, 20.0);
    let ((motor, load), (expected_motor, expected_load)) = (ours(&train), theirs(Shaft));
    let scale = expected_load.abs();
    assert!(
        (motor - expected_motor).abs() < 5.0e-5 * scale,
        "{motor} {expected_motor}"
    );
    assert!(
        (load - expected_load).abs() < 5.0e-5 * scale,
        "{load} {expected_load}"
    );
}

/// One mass with a steep tanh: what `Law::Rigid` is the limit of.
struct Steep {
    knee: f64,
}

impl System<f64, SVector<f64, 4>> for Steep {
    fn system(&self, t: f64, y: &SVector<f64, 4>, dy: &mut SVector<f64, 4>) {
        let fall = 1.0 + 0.5 * libm::exp(-(y[2] / 0.02) * (y[2] / 0.02));
        let friction = 20.0 * fall * libm::tanh(y[2] / self.knee);
        dy[0] = y[2];
        dy[2] = (drive(t) - friction) / 3.0;
    }
}

fn falling() -> Train {
    let mut train = Train::one(3.0, 20.0, 0.0);
    train.surfaces[0].law = Law::Rigid {
        coulomb: 20.0,
        stribeck: Some(Stribeck {
            excess: 0.5,
            velocity: 0.02,
            exponent: 2.0,
        }),
    };
    train
}

#[test]
fn rigid_friction_is_the_limit_of_a_steep_tanh() {
    let rigid = ours(&falling()).0;
    let off = |knee: f64| (theirs_by_small_steps(Steep { knee }).0 - rigid).abs();
    // The axis ends at 0.146 m. Distance from the limit: 1.3 mm, 0.03 mm.
    let (coarse, fine) = (off(1.0e-3), off(1.0e-5));
    assert!((1.0e-3..2.0e-3).contains(&coarse), "{coarse}");
    assert!(fine < 5.0e-5, "{fine}");
}

/// One mass with a tanh.
struct Tanh;

impl System<f64, SVector<f64, 4>> for Tanh {
    fn system(&self, t: f64, y: &SVector<f64, 4>, dy: &mut SVector<f64, 4>) {
        dy[0] = y[2];
        dy[2] = (drive(t) - 20.0 * libm::tanh(y[2] / 1.0e-3)) / 3.0;
    }
}

#[test]
fn a_smooth_law_ends_where_another_solver_says() {
    let mut train = Train::one(3.0, 20.0, 0.0);
    train.surfaces[0].law = Law::Smooth {
        coulomb: 20.0,
        knee: 1.0e-3,
    };
    let (mine, other) = (ours(&train).0, theirs(Tanh).0);
    assert!(
        (mine - other).abs() < 1.0e-4 * other.abs(),
        "{mine} {other}"
    );
}

/// LuGre written out as its differential equation.
struct Bristle;

impl System<f64, SVector<f64, 4>> for Bristle {
    fn system(&self, t: f64, y: &SVector<f64, 4>, dy: &mut SVector<f64, 4>) {
        let rate = y[2] - y[2].abs() * 2.0e6 * y[3] / 20.0;
        let fade = libm::exp(-(y[2] / 0.05) * (y[2] / 0.05));
        dy[0] = y[2];
        dy[2] = (drive(t) - 2.0e6 * y[3] - 900.0 * fade * rate) / 3.0;
        dy[3] = rate;
    }
}

#[test]
fn bristles_end_where_another_solver_says() {
    let mut train = Train::one(3.0, 20.0, 0.0);
    train.surfaces[0].law = Law::LuGre {
        coulomb: 20.0,
        stribeck: None,
        stiffness: 2.0e6,
        micro_damping: 900.0,
        fade_velocity: 0.05,
    };
    let (mine, other) = (ours(&train).0, theirs_by_small_steps(Bristle).0);
    assert!(
        (mine - other).abs() < 2.0e-3 * other.abs(),
        "{mine} {other}"
    );
}
