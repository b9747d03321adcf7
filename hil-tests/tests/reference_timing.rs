//! The timing of the feedforward, seen at the table: a trapezoid of 5 m/s², and circles whose acceleration changes quickly.

use hil_tests::rig::quiet_reference;
use workbench::ballbar;
use workbench::compensation::{AxisCompensation, Compensation};
use workbench::run::{Place, Session};
use workbench::trajectory::{Circle, MEASURE_FROM_RAD};

const ACCELERATION: f64 = 5.0;
const VELOCITY: f64 = 0.2;

/// Rest for 0.1 s, up at 5 m/s² to 0.2 m/s, on for 0.1 s, down again.
fn trapezoid(time_s: f64) -> f64 {
    let (ramp, hold) = (VELOCITY / ACCELERATION, 0.1);
    let up = |t: f64| 0.5 * ACCELERATION * t.max(0.0).powi(2);
    let t = time_s - 0.1;
    up(t) - up(t - ramp) - up(t - ramp - hold) + up(t - 2.0 * ramp - hold)
}

/// Largest force and largest deviation of the table from the setpoint, µm, once the axis is over its breakaway.
fn along(at: impl Fn(f64) -> f64, duration_s: f64) -> (f64, f64) {
    let machine = quiet_reference();
    let none = vec![AxisCompensation::default(); 2];
    let mut session = Session::open(&machine, &Place::InProcess, &none, 0).unwrap();
    let (mut error, mut force) = (0.0_f64, 0.0_f64);
    session
        .follow(
            duration_s,
            |time_s| vec![at(time_s), 0.0],
            |_, axes| {
                error = error.max((axes[0].reference_m - axes[0].load_m).abs());
                force = force.max(axes[0].force_n.abs());
            },
        )
        .unwrap();
    (1.0e6 * error, force)
}

#[test]
fn figures_of_the_feedforward() {
    let (error, force) = along(trapezoid, 0.5);
    println!("trapezoid 5 m/s2: {error:.2} um, {force:.0} N");
    let none = vec![AxisCompensation::default(); 2];
    let coulomb = vec![AxisCompensation { reversal: Compensation::Coulomb { force_n: 400.0 }, backlash_m: 0.0 }; 2];
    for (radius_mm, feed) in [(10.0, 8000.0), (100.0, 2000.0), (100.0, 500.0)] {
        let circle =
            Circle { radius_m: 1.0e-3 * radius_mm, feed_m_per_s: feed / 6.0e4, turns: 3, counter_clockwise: true };
        for (name, compensation) in [("none", &none), ("coulomb", &coulomb)] {
            let machine = quiet_reference();
            let mut session = Session::open(&machine, &Place::InProcess, compensation, 0).unwrap();
            let points = session.circle(&circle).unwrap();
            let figures = ballbar::figures(&points, circle.radius_m, 0.0, MEASURE_FROM_RAD);
            println!(
                "R {radius_mm} F {feed} {name}: {:.3} um, radius {:.3} um",
                figures.peak_max_um, figures.circular_deviation_g_um
            );
        }
    }
}
