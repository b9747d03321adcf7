//! The reference machine's circles beside the prototype's figures, with the paper's pulse.

use hil_tests::golden::{self, Measured, row};
use hil_tests::rig::{circle, quiet_reference};
use hil_tests::{Scope, on_all_cores};
use workbench::ballbar::{self, CircleFigures};
use workbench::compensation::{AxisCompensation, Compensation};
use workbench::network::place::Place;
use workbench::session::{Session, Stand};
use workbench::trajectory::{Circle, MEASURE_FROM_RAD};
use workbench::tuning;

/// R mm, F mm/min; uncompensated and tuned-at-F2000 burst of the prototype that
/// `plant-sim/src/reference.toml` describes, µm.
const CIRCLES: [(f64, f64, f64, f64); 5] = [
    (100.0, 2000.0, 33.71, 6.59),
    (100.0, 8000.0, 46.34, 19.98),
    (10.0, 1000.0, 39.53, 11.28),
    (25.0, 1000.0, 33.64, 6.59),
    (100.0, 500.0, 14.12, 7.29),
];

fn run(circle: &Circle, compensation: &[AxisCompensation]) -> CircleFigures {
    let machine = quiet_reference();
    let mut session = Session::open(&machine, &Place::InProcess, compensation, 0).unwrap();
    let points = session.circle(circle).unwrap();
    ballbar::figures(&points, circle.radius_m, 0.0, MEASURE_FROM_RAD)
}

/// One circle without compensation, with the tuned pulse and with a bare Coulomb force, beside the
/// prototype.
fn figures(cell: &(f64, f64, f64, f64), tuned: &[AxisCompensation]) -> Vec<Measured> {
    let (radius, feed, prototype, prototype_pulse) = *cell;
    let none = vec![AxisCompensation::default(); 2];
    let coulomb = vec![
        AxisCompensation {
            reversal: Compensation::Coulomb { force_n: 400.0 },
            backlash_m: 0.0
        };
        2
    ];
    let of =
        |compensation: &[AxisCompensation]| run(&circle(radius, feed), compensation).peak_max_um;
    let (before, pulse, force) = (of(&none), of(tuned), of(&coulomb));
    for (what, came, wanted) in [
        ("none", before, prototype),
        ("pulse", pulse, prototype_pulse),
    ] {
        assert!(
            (came / wanted - 1.0).abs() < 0.25,
            "{}, {what}: {came} µm, prototype {wanted} µm",
            name(cell)
        );
    }
    let mut rows = vec![
        row(format!("{}, none", name(cell)), before, "µm"),
        row(
            format!("{}, pulse tuned at R 100 F 2000", name(cell)),
            pulse,
            "µm",
        ),
        row(format!("{}, bare Coulomb force", name(cell)), force, "µm"),
    ];
    if (radius, feed) == (100.0, 2000.0) {
        let reduction = 100.0 * (1.0 - pulse / before);
        assert!(reduction >= 78.0, "{reduction} %");
        rows.push(row(
            format!("{}, burst reduction", name(cell)),
            reduction,
            "%",
        ));
    }
    rows
}

fn name((radius, feed, ..): &(f64, f64, f64, f64)) -> String {
    format!("R {radius} F {feed}")
}

#[test]
fn the_pulse_removes_four_fifths_at_its_own_feed_and_the_paper_warns_rightly_about_others() {
    if Scope::now().leaves_row_to("tests/commission.rs, which tunes at R 100 F 2000") {
        return;
    }
    let machine = quiet_reference();
    let stand = Stand::in_process(&machine);
    let tuned = tuning::pulse(&stand, &circle(100.0, 2000.0), 0.0)
        .unwrap()
        .unwrap();
    let cells = Scope::now().rows("reference-machine", &CIRCLES, 1, 3);
    let rows = on_all_cores(cells, |cell| figures(cell, &tuned.compensation)).concat();
    golden::check_some(
        "reference-machine",
        &rows,
        &cells.iter().map(name).collect::<Vec<_>>(),
    );
}
