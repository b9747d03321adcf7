//! The reference machine's circles beside the prototype's figures, with the paper's pulse.

use hil_tests::golden::{self, row};
use hil_tests::rig::quiet_reference;
use workbench::ballbar::{self, CircleFigures};
use workbench::compensation::{AxisCompensation, Compensation};
use workbench::interrupt::Interrupt;
use workbench::run::{Place, Session};
use workbench::trajectory::{Circle, MEASURE_FROM_RAD};
use workbench::tune;

/// R mm, F mm/min; uncompensated and tuned-at-F2000 burst of the prototype, µm (reference-axis.toml).
const CIRCLES: [(f64, f64, f64, f64); 5] = [
    (100.0, 500.0, 14.12, 7.29),
    (100.0, 2000.0, 33.71, 6.59),
    (25.0, 1000.0, 33.64, 6.59),
    (100.0, 8000.0, 46.34, 19.98),
    (10.0, 1000.0, 39.53, 11.28),
];

fn circle(radius_mm: f64, feed_mm_min: f64) -> Circle {
    Circle { radius_m: 1.0e-3 * radius_mm, feed_m_per_s: feed_mm_min / 6.0e4, turns: 3, counter_clockwise: true }
}

fn run(circle: &Circle, compensation: &[AxisCompensation]) -> CircleFigures {
    let machine = quiet_reference();
    let mut session = Session::open(&machine, &Place::InProcess, compensation, 0).unwrap();
    let points = session.circle(circle).unwrap();
    ballbar::figures(&points, circle.radius_m, 0.0, MEASURE_FROM_RAD)
}

#[test]
fn the_pulse_removes_four_fifths_at_its_own_feed_and_the_paper_warns_rightly_about_others() {
    let machine = quiet_reference();
    let tuned = tune::pulse(&machine, &Place::InProcess, &circle(100.0, 2000.0), 0.0, &Interrupt::never()).unwrap();
    let none = vec![AxisCompensation::default(); 2];
    let coulomb = vec![AxisCompensation { reversal: Compensation::Coulomb { force_n: 400.0 }, backlash_m: 0.0 }; 2];
    let mut rows = Vec::new();
    for (radius, feed, prototype, prototype_pulse) in CIRCLES {
        let of = |compensation: &[AxisCompensation]| run(&circle(radius, feed), compensation).peak_max_um;
        let (before, pulse, force) = (of(&none), of(&tuned.compensation), of(&coulomb));
        assert!((before / prototype - 1.0).abs() < 0.25, "R {radius} F {feed}: {before} µm, prototype {prototype} µm");
        assert!(
            (pulse / prototype_pulse - 1.0).abs() < 0.25,
            "R {radius} F {feed}: {pulse} µm, prototype {prototype_pulse} µm"
        );
        let name = |what: &str| format!("R {radius} F {feed}, {what}");
        rows.push(row(name("none"), before, "µm"));
        rows.push(row(name("pulse tuned at R 100 F 2000"), pulse, "µm"));
        rows.push(row(name("bare Coulomb force"), force, "µm"));
        if (radius, feed) == (100.0, 2000.0) {
            let reduction = 100.0 * (1.0 - pulse / before);
            assert!(reduction >= 78.0, "{reduction} %");
            rows.push(row("burst reduction at R 100 F 2000", reduction, "%"));
        }
    }
    golden::check("reference-machine", &rows);
}
