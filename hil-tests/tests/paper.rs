//! The paper's figures as scenarios: Fig. 1 (polar step and burst), Fig. 4 (gap outside), Fig. 5
//! (gap inside), Fig. 8 (dry friction).
//!
//! Plots go to `target/paper/`; `docs/paper.md` has the table.

use hil_tests::golden::{self, Measured, row};
use hil_tests::rig::{circle, dry_friction, gap_inside, gap_outside, quiet_reference};
use hil_tests::{Scope, on_all_cores};
use plant_sim::Machine;
use workbench::ballbar::{self, Point};
use workbench::commissioning::reversal_curves::{ReversalRun, six_curves};
use workbench::commissioning::reversal_run::reversal_rows;
use workbench::compensation::AxisCompensation;
use workbench::network::master::AxisCycle;
use workbench::network::place::Place;
use workbench::presentation::plots::{self, Ink, Polar, Trace};
use workbench::session::{Session, Stand};
use workbench::trajectory::{Circle, MEASURE_FROM_RAD};

fn none() -> Vec<AxisCompensation> {
    vec![AxisCompensation::default(); 2]
}

fn run(machine: &Machine, circle: &Circle) -> Vec<Point> {
    let mut session = Session::open(machine, &Place::InProcess, &none(), 0).unwrap();
    session.circle(circle).unwrap()
}

fn keep(name: &str, svg: &str) {
    let folder = std::path::Path::new(env!("CARGO_TARGET_TMPDIR"))
        .parent()
        .unwrap()
        .join("paper");
    std::fs::create_dir_all(&folder).unwrap();
    let text = plots::standalone(svg);
    if std::env::var_os("QUADRANT_BLESS").is_some() {
        let docs = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/paper");
        std::fs::create_dir_all(&docs).unwrap();
        std::fs::write(docs.join(name), &text).unwrap();
    }
    std::fs::write(folder.join(name), text).unwrap();
}

fn polar(title: &str, traces: &[Trace<'_>]) -> String {
    plots::polar(&Polar {
        title,
        axes: ["X", "Y"],
        traces,
        bursts: Default::default(),
        zone: None,
    })
}

/// Gaps outside the loop, µm; that of the polar plot first.
const GAPS_UM: [f64; 5] = [100.0, 400.0, 20.0, 50.0, 200.0];

/// The step of a gap outside the loop, axis by axis within 2 % of gap and twice the wind-up.
fn step(gap_um: f64) -> Measured {
    let machine = gap_outside(1.0e-6 * gap_um);
    let circle = circle(100.0, 500.0);
    let points = run(&machine, &circle);
    let figures = ballbar::figures(&points, circle.radius_m, 1.0e-6 * gap_um, MEASURE_FROM_RAD);
    let actual = &machine.axes[0].actual;
    let wanted_um =
        gap_um + 2.0e6 * actual.sliding.coulomb_n / actual.mechanics.screw_stiffness_n_per_m;
    for step_um in figures.step_um {
        assert!(
            (step_um / wanted_um - 1.0).abs() < 0.02,
            "gap {gap_um} µm: step {step_um} µm, wanted {wanted_um} µm"
        );
    }
    if gap_um == 100.0 {
        let trace = Trace {
            name: "gap 100 µm outside".into(),
            ink: Ink::Before,
            is_dashed: false,
            points: &points[..points.len() / 3],
            radius_m: 0.1,
        };
        keep(
            "fig-1a-step.svg",
            &polar("Fig. 1(a): step, R 100 mm, F 500 mm/min", &[trace]),
        );
    }
    row(
        format!("Fig. 4, gap {gap_um} µm outside, step X"),
        figures.step_um[0],
        "µm",
    )
}

#[test]
fn fig_1_and_4_a_gap_outside_the_loop_gives_a_step_of_gap_plus_twice_the_wind_up() {
    let gaps = Scope::now().rows("paper-fig-4", &GAPS_UM, 1, 2);
    let rows = on_all_cores(gaps, |gap_um| step(*gap_um));
    let scenarios: Vec<String> = gaps
        .iter()
        .map(|gap_um| format!("Fig. 4, gap {gap_um} µm outside"))
        .collect();
    golden::check_some("paper-fig-4", &rows, &scenarios);
}

#[test]
fn fig_4_the_table_stands_while_the_motor_crosses_the_gap() {
    let gap_m = 1.0e-4;
    let machine = gap_outside(gap_m);
    let rows = reversal_rows(&Stand::in_process(&machine), &none(), &circle(100.0, 500.0)).unwrap();
    let of = |row: &(f64, AxisCycle)| row.1.truth.unwrap();
    // While table − motor goes through the middle half of the gap.
    let crossing: Vec<(f64, f64)> = rows
        .iter()
        .map(|row| (of(row).table_m, of(row).motor_m - of(row).table_m))
        .filter(|(_, ahead)| ahead.abs() < 0.25 * gap_m)
        .collect();
    assert!(crossing.len() > 50, "{} samples", crossing.len());
    let (low, high) = crossing
        .iter()
        .fold((f64::MAX, f64::MIN), |(low, high), (x, _)| {
            (low.min(*x), high.max(*x))
        });
    let moved_um = 1.0e6 * (high - low);
    golden::check(
        "paper-fig-4-flat",
        &[row(
            "way of the table while the motor crosses half the gap of 100 µm",
            moved_um,
            "µm",
        )],
    );
    assert!(moved_um < 0.5, "{moved_um} µm");
}

#[test]
fn fig_5_a_gap_inside_the_loop_gives_bursts_that_grow_with_it() {
    let mut rows = Vec::new();
    let mut bursts = Vec::new();
    // The prototype's bursts for its 2 kHz loop.
    for (gap_um, prototype_um) in [(0.0, 12.0), (100.0, 43.0), (200.0, 65.0), (400.0, 101.0)] {
        let circle = circle(10.0, 500.0);
        let points = run(&gap_inside(1.0e-6 * gap_um), &circle);
        let figures = ballbar::figures(&points, circle.radius_m, 1.0e-6 * gap_um, MEASURE_FROM_RAD);
        let burst = figures.peak_max_um;
        assert!(
            (burst / prototype_um - 1.0).abs() < 0.25,
            "gap {gap_um} µm: {burst} µm, prototype {prototype_um} µm"
        );
        rows.push(row(
            format!("Fig. 5, gap {gap_um} µm inside, burst"),
            burst,
            "µm",
        ));
        bursts.push(burst);
        if gap_um == 400.0 {
            let trace = Trace {
                name: "gap 400 µm inside".into(),
                ink: Ink::Before,
                is_dashed: false,
                points: &points[..points.len() / 3],
                radius_m: 0.01,
            };
            keep(
                "fig-5b-gap-inside.svg",
                &polar("Fig. 5(b): gap inside, R 10 mm, F 500 mm/min", &[trace]),
            );
        }
    }
    assert!(bursts.windows(2).all(|pair| pair[0] < pair[1]));
    // Between 100 and 400 µm: burst ∝ gap^n.
    rows.push(row(
        "Fig. 5, exponent of burst over gap",
        (bursts[3] / bursts[1]).ln() / 4.0_f64.ln(),
        "",
    ));
    golden::check("paper-fig-5", &rows);
}

#[test]
fn fig_8_dry_friction_makes_the_table_stagnate_until_the_torque_passes_it() {
    let machine = dry_friction();
    let rows = reversal_rows(
        &Stand::in_process(&machine),
        &none(),
        &circle(100.0, 2000.0),
    )
    .unwrap();
    let run = ReversalRun {
        name: "",
        inks: [Ink::Before, Ink::After],
        rows: &rows,
    };
    for (place, svg) in six_curves(&machine, &[run]).iter().enumerate() {
        keep(&format!("fig-8a-{}.svg", place + 1), svg);
    }
    let still = |row: &(f64, AxisCycle), next: &(f64, AxisCycle)| {
        (next.1.truth.unwrap().table_m - row.1.truth.unwrap().table_m).abs() < 1.0e-12
    };
    let standing: Vec<&(f64, AxisCycle)> = rows
        .windows(2)
        .filter(|pair| still(&pair[0], &pair[1]))
        .map(|pair| &pair[0])
        .collect();
    let (first, last) = (standing.first().unwrap(), standing.last().unwrap());
    let stagnation_ms = 1.0e3 * (last.0 - first.0);
    assert_eq!(
        standing.len() as f64,
        (stagnation_ms / 1.0e3 / machine.period_s).round() + 1.0,
        "it stands once, without a break"
    );
    let force = |row: &(f64, AxisCycle)| row.1.truth.unwrap().force_n;
    let change_n = force(last) - force(first);
    let friction_n = machine.axes[0].actual.sliding.coulomb_n;
    // From sliding the one way to sliding the other way: twice the friction.
    assert!(
        (change_n / (2.0 * friction_n) - 1.0).abs() < 0.1,
        "{change_n} N"
    );
    golden::check(
        "paper-fig-8",
        &[
            row("Fig. 8, stagnation at R 100 F 2000", stagnation_ms, "ms"),
            row("Fig. 8, change of drive force during it", change_n, "N"),
        ],
    );
}

#[test]
fn fig_1_and_8_friction_inside_the_loop_gives_bursts_on_the_polar_plot() {
    let circle = circle(100.0, 2000.0);
    let points = run(&quiet_reference(), &circle);
    let dry = run(&dry_friction(), &circle);
    let figures = |points: &[Point]| {
        ballbar::figures(points, circle.radius_m, 0.0, MEASURE_FROM_RAD).peak_max_um
    };
    let traces = [
        ("presliding and Stribeck (reference)", Ink::Before, &points),
        ("dry friction", Ink::After, &dry),
    ]
    .map(|(name, ink, points)| Trace {
        name: name.into(),
        ink,
        is_dashed: false,
        points: &points[..points.len() / 3],
        radius_m: 0.1,
    });
    keep(
        "fig-1b-burst.svg",
        &polar("Fig. 1(b): burst, R 100 mm, F 2000 mm/min", &traces),
    );
    golden::check(
        "paper-fig-1",
        &[
            row(
                "Fig. 1(b), burst of the reference machine",
                figures(&points),
                "µm",
            ),
            row("Fig. 8(b), burst with dry friction", figures(&dry), "µm"),
        ],
    );
}
