//! The model of friction in the drive, as identification found it: what it leaves of a burst at
//! every feed, and that it does no harm where nothing is to be gained.

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

/// The largest error at the table and the largest change of the force within a cycle, from a time
/// on, of the first axis along a path that begins at rest in its middle.
fn harm(
    machine: &Machine,
    compensation: &[AxisCompensation],
    duration_s: f64,
    from_s: f64,
    path_m: impl Fn(f64) -> f64,
) -> [f64; 2] {
    let mut session = Session::open(machine, &Place::InProcess, compensation, 0).unwrap();
    session.go_to(&[path_m(0.0), 0.0]).unwrap();
    let (mut error_um, mut force_n, mut before) = (0.0_f64, 0.0_f64, None);
    session
        .follow(
            duration_s,
            |time_s| vec![path_m(time_s), 0.0],
            |time_s, axes| {
                let truth = axes[0].truth.unwrap();
                if time_s >= from_s {
                    error_um = error_um.max(1.0e6 * (axes[0].reference_m - truth.table_m).abs());
                    let change: f64 = before.map_or(0.0, |before: f64| axes[0].force_n - before);
                    force_n = force_n.max(change.abs());
                }
                before = Some(axes[0].force_n);
            },
        )
        .unwrap();
    [error_um, force_n]
}

/// On 10 mm at 10 mm/s, a rest, and what comes then.
fn after_a_way(then_m: impl Fn(f64) -> f64) -> impl Fn(f64) -> f64 {
    const ON_S: f64 = 1.0;
    const REST_S: f64 = 2.0;
    move |time_s| {
        let share = (time_s / ON_S).clamp(0.0, 1.0);
        let on_m = 0.01 * (share - (std::f64::consts::TAU * share).sin() / std::f64::consts::TAU);
        on_m + then_m(time_s - ON_S - REST_S)
    }
}

/// A smooth step of a size within 50 ms.
fn step_m(size_m: f64, time_s: f64) -> f64 {
    let share = (time_s / 0.05).clamp(0.0, 1.0);
    size_m * share * share * (3.0 - 2.0 * share)
}

/// The smallest setpoint: 10 nm / 256.
const FINE_M: f64 = 1.0e-8 / 256.0;

/// v² / r at R 100 mm, F 500 mm/min.
const REVERSAL_M_PER_S2: f64 = 6.94e-4;

type Path = Box<dyn Fn(f64) -> f64 + Sync>;

/// Name, path, and where the largest error is looked for.
fn harmless_paths() -> Vec<(&'static str, Path, f64)> {
    let flip = |time_s: f64| {
        let flips = (time_s / 0.1).max(0.0) as u32;
        if time_s > 0.0 && flips.is_multiple_of(2) {
            -FINE_M
        } else {
            0.0
        }
    };
    vec![
        (
            "jog back by 0.04 nm after a dwell",
            Box::new(after_a_way(
                |time_s| if time_s > 0.0 { -FINE_M } else { 0.0 },
            )),
            3.0,
        ),
        (
            "jog back by 1 µm after a dwell",
            Box::new(after_a_way(|time_s| step_m(-1.0e-6, time_s))),
            3.0,
        ),
        (
            "standstill, setpoint flips one count every 100 cycles",
            Box::new(after_a_way(flip)),
            3.0,
        ),
        (
            "back by 5 µm and on again, within presliding",
            Box::new(after_a_way(|time_s| {
                step_m(-5.0e-6, time_s) + step_m(5.0e-6, time_s - 0.1)
            })),
            3.0,
        ),
        (
            "stop 2 ms after the reversal of R 100 F 500",
            Box::new(|time_s| {
                let since_s = (time_s - 1.5).min(0.002);
                -0.5 * REVERSAL_M_PER_S2 * since_s * since_s
            }),
            1.4,
        ),
    ]
}

#[test]
fn the_model_is_nowhere_worse_than_none_where_nothing_is_to_be_gained() {
    let machine = Machine::reference();
    let none = Stand::in_process(&machine).uncompensated();
    let mut rows: Vec<Measured> = Vec::new();
    for (name, path, from_s) in harmless_paths() {
        let of =
            |compensation: &[AxisCompensation]| harm(&machine, compensation, 4.5, from_s, &path);
        let ([without_um, _], [with_um, step_n]) = (of(&none), of(model()));
        assert!(
            with_um <= without_um + 0.2,
            "{name}: {with_um} µm, {without_um} without"
        );
        rows.push(row(format!("{name}, none"), without_um, "µm"));
        rows.push(row(format!("{name}, model"), with_um, "µm"));
        rows.push(row(
            format!("{name}, model: largest step of the force"),
            step_n,
            "N",
        ));
    }
    golden::check("friction-model-harm", &rows);
}

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
