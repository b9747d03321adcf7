//! A contour with many small reversals beside circles: the section of a turbine blade (the paper's
//! first conclusion).

use super::*;

use std::path::{Path, PathBuf};

use hil_tests::blade;
use workbench::contour_test::{self, ContourReport};
use workbench::trajectory::Contour;

/// File, F mm/min, how often X and Y turn round on it, and the share of the largest error and of
/// its root mean square that may be left, or half a micrometre. What is left at F 2000 is not
/// friction: radii of a third of a millimetre ask for 300 m/s³.
const CONTOURS: [(&str, f64, [u32; 2], f64); 6] = [
    ("section", 500.0, [2, 3], 0.14),
    ("section", 1000.0, [2, 3], 0.06),
    ("section", 2000.0, [2, 3], 0.15),
    ("root", 500.0, [8, 11], 0.08),
    ("root", 1000.0, [8, 11], 0.08),
    ("root", 2000.0, [8, 11], 0.28),
];

fn file(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("contours");
    folder.join(name).with_extension("csv")
}

#[test]
fn the_blade_is_what_its_formulas_say() {
    for (name, points_mm) in [("section", blade::section()), ("root", blade::root())] {
        let text = blade::csv(&points_mm);
        if std::env::var_os("QUADRANT_BLESS").is_some() {
            std::fs::write(file(name), &text).unwrap();
        }
        assert!(
            std::fs::read_to_string(file(name)).unwrap() == text,
            "contours/{name}.csv is another one (QUADRANT_BLESS=1 rewrites it)"
        );
    }
}

fn run(
    machine: &Machine,
    (name, feed_mm_min): (&str, f64),
    compensation: &[AxisCompensation],
) -> ContourReport {
    let stand = Stand::in_process(machine);
    let contour = Contour::read(&file(name), feed_mm_min / 6.0e4).unwrap();
    contour_test::run(&stand, &contour, compensation, None).unwrap()
}

#[test]
fn contours_with_many_reversals_keep_little_of_their_error() {
    let machine = Machine::reference();
    let methods = methods();
    let rows = on_all_cores(&CONTOURS, |(file, feed, reversals, most)| {
        let reports = methods
            .each_ref()
            .map(|(_, own)| run(&machine, (file, *feed), own));
        let [none, .., model] = &reports;
        assert_eq!(none.reversals, *reversals, "{file}");
        for [before_um, after_um] in [
            [none.largest_um, model.largest_um],
            [none.rms_um, model.rms_um],
        ] {
            assert!(
                after_um <= (most * before_um).max(0.5),
                "{file} F {feed}: {after_um} µm of {before_um}"
            );
        }
        let rows = methods.iter().zip(&reports).map(|((method, _), report)| {
            let name = format!("{file} F {feed}, {method}");
            [
                row(name.clone(), report.largest_um, "µm"),
                row(format!("{name}: root mean square"), report.rms_um, "µm"),
            ]
        });
        rows.flatten().collect::<Vec<_>>()
    });
    golden::check("contour", &rows.concat());
}

fn methods() -> [(&'static str, Vec<AxisCompensation>); 4] {
    let mut all = harm::methods().into_iter();
    let mut of = |name: &str| all.find(|(own, _)| *own == name).unwrap();
    ["none", "coulomb", "pulse", "model"].map(&mut of)
}
