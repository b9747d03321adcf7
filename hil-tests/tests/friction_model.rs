//! The model of friction in the drive, as identification found it: what it leaves of a burst at
//! every feed, and that it does no harm where nothing is to be gained.

#[path = "friction_model/contour.rs"]
mod contour;
#[path = "friction_model/harm.rs"]
mod harm;
#[path = "friction_model/self_tuning.rs"]
mod self_tuning;

use std::sync::OnceLock;

use hil_tests::golden::{self, Measured, row};
use hil_tests::rig::circle;
use hil_tests::{Scope, on_all_cores};
use plant_sim::Machine;
use workbench::ballbar::{self, CircleFigures};
use workbench::commissioning::identified_axes;
use workbench::compensation::AxisCompensation;
use workbench::network::place::Place;
use workbench::session::{Session, Stand};
use workbench::trajectory::{Circle, MEASURE_FROM_RAD};
use workbench::tuning;

/// R mm, F mm/min, and the most that may be left of the burst: a share of it, or half a micrometre.
const CELLS: [(f64, f64, f64); 10] = [
    (100.0, 2000.0, 0.03),
    (100.0, 500.0, 0.06),
    (100.0, 1000.0, 0.03),
    (100.0, 3000.0, 0.03),
    (100.0, 8000.0, 0.03),
    (25.0, 1000.0, 0.03),
    (25.0, 3000.0, 0.03),
    (25.0, 8000.0, 0.04),
    (10.0, 1000.0, 0.03),
    (10.0, 8000.0, 0.04),
];

/// What `quadrant tune --method model` makes of the records of the reference machine's axes.
fn model() -> &'static [AxisCompensation] {
    static MODEL: OnceLock<Vec<AxisCompensation>> = OnceLock::new();
    MODEL.get_or_init(|| {
        let machine = Machine::reference();
        let stand = Stand::in_process(&machine);
        let folder = tempfile::tempdir().unwrap();
        identified_axes::record(&stand, folder.path()).unwrap();
        let results = identified_axes::identify(&stand, folder.path()).unwrap();
        let tuned = tuning::model(&stand, &circle(100.0, 2000.0), &results).unwrap();
        tuned.unwrap().compensation
    })
}

fn run(machine: &Machine, circle: &Circle, compensation: &[AxisCompensation]) -> CircleFigures {
    let mut session = Session::open(machine, &Place::InProcess, compensation, 0).unwrap();
    let points = session.circle(circle).unwrap();
    ballbar::figures(&points, circle.radius_m, 0.0, MEASURE_FROM_RAD)
}

fn name((radius, feed, ..): &(f64, f64, f64)) -> String {
    format!("R {radius} F {feed}")
}

#[test]
fn one_model_from_records_alone_removes_the_burst_at_every_feed() {
    let machine = Machine::reference();
    let none = Stand::in_process(&machine).uncompensated();
    let cells = Scope::now().rows("friction-model", &CELLS, 1, 2);
    let rows = on_all_cores(cells, |cell| {
        let circle = circle(cell.0, cell.1);
        let before = run(&machine, &circle, &none);
        let after = run(&machine, &circle, model());
        let most_um = (cell.2 * before.peak_max_um).max(0.5);
        let left_um = after.peak_max_um;
        assert!(
            left_um <= most_um,
            "{}: {left_um} µm of {}",
            name(cell),
            before.peak_max_um
        );
        vec![
            row(format!("{}, none", name(cell)), before.peak_max_um, "µm"),
            row(format!("{}, model", name(cell)), left_um, "µm"),
            row(
                format!("{}, none: G", name(cell)),
                before.circular_deviation_g_um,
                "µm",
            ),
            row(
                format!("{}, model: G", name(cell)),
                after.circular_deviation_g_um,
                "µm",
            ),
        ]
    });
    let names: Vec<String> = cells.iter().map(name).collect();
    golden::check_some("friction-model", &rows.concat(), &names);
}

/// v² / r at R 100 mm, F 500 mm/min.
const REVERSAL_M_PER_S2: f64 = 6.94e-4;

/// The largest error over a reversal at R 100 F 500, µm, of an axis that has come some way before.
fn first_reversal_um(machine: &Machine, compensation: &[AxisCompensation], rests: bool) -> f64 {
    let turn = |time_s: f64| {
        let since_s = time_s - 1.5;
        -0.5 * REVERSAL_M_PER_S2 * since_s * since_s
    };
    let mut session = Session::open(machine, &Place::InProcess, compensation, 0).unwrap();
    session.go_to(&[turn(0.0) - 0.01, 0.0]).unwrap();
    session.go_to(&[turn(0.0), 0.0]).unwrap();
    if rests {
        session.master_mut().disable().unwrap();
        session.master_mut().enable().unwrap();
    }
    let mut error_um = 0.0_f64;
    session
        .follow(
            2.5,
            |time_s| vec![turn(time_s), 0.0],
            |time_s, axes| {
                let off_m = axes[0].reference_m - axes[0].truth.unwrap().table_m;
                if time_s > 1.4 {
                    error_um = error_um.max(1.0e6 * off_m.abs());
                }
            },
        )
        .unwrap();
    error_um
}

#[test]
fn the_first_reversal_after_disable_and_enable_is_as_good_as_any_other() {
    let machine = Machine::reference();
    let none = Stand::in_process(&machine).uncompensated();
    let without_um = first_reversal_um(&machine, &none, false);
    let [usual_um, first_um] =
        [false, true].map(|rests| first_reversal_um(&machine, model(), rests));
    assert!(usual_um < 0.1 * without_um, "{usual_um} µm of {without_um}");
    assert!(
        first_um < usual_um + 0.2,
        "{first_um} µm, otherwise {usual_um}"
    );
}
