//! The pulse over the acceleration at the reversal: what `quadrant tune --method adaptive` makes of
//! circles at one small radius leaves little at every radius and feed.

use std::sync::OnceLock;

use hil_tests::golden::{self, row};
use hil_tests::rig::circle;
use hil_tests::{Scope, on_all_cores};
use plant_sim::Machine;
use workbench::circle_test;
use workbench::compensation::AxisCompensation;
use workbench::session::Stand;
use workbench::tuning;

/// R mm, F mm/min, and the most that may be left of the burst.
const CELLS: [(f64, f64, f64); 13] = [
    (100.0, 3000.0, 0.25),
    (100.0, 500.0, 0.15),
    (10.0, 8000.0, 0.13),
    (100.0, 1000.0, 0.2),
    (100.0, 2000.0, 0.22),
    (100.0, 8000.0, 0.21),
    (25.0, 1000.0, 0.22),
    (25.0, 3000.0, 0.25),
    (25.0, 8000.0, 0.12),
    (10.0, 500.0, 0.21),
    (10.0, 1000.0, 0.25),
    (100.0, 250.0, 0.25),
    (100.0, 100.0, 0.5),
];

fn adaptive() -> &'static [AxisCompensation] {
    static ADAPTIVE: OnceLock<Vec<AxisCompensation>> = OnceLock::new();
    ADAPTIVE.get_or_init(|| {
        let machine = Machine::reference();
        let stand = Stand::in_process(&machine);
        let tuned = tuning::adaptive(&stand, &circle(100.0, 2000.0)).unwrap();
        tuned.expect("there is a burst").compensation
    })
}

fn name((radius, feed, ..): &(f64, f64, f64)) -> String {
    format!("R {radius} F {feed}")
}

#[test]
fn one_table_of_pulses_leaves_a_quarter_of_the_burst_at_most_from_500_mm_per_min_on() {
    let machine = Machine::reference();
    let stand = Stand::in_process(&machine);
    let table = adaptive();
    let cells = Scope::now().rows("adaptive", &CELLS, 1, 3);
    let rows = on_all_cores(cells, |cell| {
        let circle = circle(cell.0, cell.1);
        let burst_um = |compensation: &[AxisCompensation]| {
            let run = circle_test::run(&stand, &circle, compensation, None).unwrap();
            run.report.figures.peak_max_um
        };
        let (before_um, after_um) = (burst_um(&stand.uncompensated()), burst_um(table));
        assert!(
            after_um <= cell.2 * before_um,
            "{}: {after_um} µm of {before_um}",
            name(cell)
        );
        vec![
            row(format!("{}, none", name(cell)), before_um, "µm"),
            row(format!("{}, adaptive", name(cell)), after_um, "µm"),
        ]
    });
    let names: Vec<String> = cells.iter().map(name).collect();
    golden::check_some("adaptive", &rows.concat(), &names);
}
