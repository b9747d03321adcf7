//! `quadrant compare` on runs of `commission`: a machine as it was, the same again with other
//! noise, and after it has warmed up.
//!
//! With `QUADRANT_BLESS=1` the picture of the README, `docs/compare.svg`, is made anew by
//! `cargo certify`, which alone runs the third.

use std::path::{Path, PathBuf};

use hil_tests::{Scope, pictures};
use plant_sim::Machine;

use workbench::cli::{Circles, Compare};
use workbench::commands::commission::{self, Wanted};
use workbench::commands::compare;
use workbench::interrupt::Interrupt;
use workbench::network::place::Place;

/// What has become of the reference machine in a run.
struct Run {
    name: &'static str,
    change: fn(&mut Machine),
}

/// The runs after the one of the machine as it was.
const LATER: [Run; 2] = [
    Run {
        name: "warm",
        change: |machine| {
            for axis in &mut machine.axes {
                axis.actual.sliding.coulomb_n *= 0.7;
                axis.actual.sliding.static_n *= 0.7;
                axis.actual.sliding.viscous_n_s_per_m *= 0.7;
            }
        },
    },
    Run {
        name: "cold-again",
        change: |machine| machine.seed += 1,
    },
];

fn commissioned(run: &Run, folder: &Path) -> PathBuf {
    let out = folder.join(run.name);
    let mut machine = Machine::reference();
    (run.change)(&mut machine);
    let wanted = Wanted::into(&out);
    commission::commission(&machine, Place::InProcess, &wanted, &Interrupt::never()).unwrap();
    out
}

/// Runs of a machine that warms up differ by its friction and by nothing else; the first of them
/// stands in the folder `cold`.
pub(super) fn assert_a_warm_machine_differs_by_its_friction(cold: &Path) {
    let folder = tempfile::tempdir().unwrap();
    let later = Scope::now().rows("runs to compare with the first", &LATER, 1, 1);
    let later_runs = later.iter().map(|run| commissioned(run, folder.path()));
    let runs: Vec<PathBuf> = std::iter::once(cold.to_path_buf())
        .chain(later_runs)
        .collect();
    let [page, plot, json] =
        ["compare.html", "compare.svg", "compare.json"].map(|name| folder.path().join(name));
    compare::run(&Compare {
        runs: runs.clone(),
        out: Some(page.clone()),
        plot: Some(plot.clone()),
        circles: Circles::Before,
        json: Some(json.clone()),
    })
    .unwrap();
    let said: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(json).unwrap()).unwrap();
    assert_eq!(said["runs"].as_array().unwrap().len(), runs.len());
    for change in said["changed"].as_array().unwrap() {
        // The seed is no change of the machine.
        assert_eq!(change["run"], "warm", "{change}");
    }
    let by_percent = |name: &str| {
        let changes = said["changed"].as_array().unwrap().iter();
        let own = changes.filter(|change| change["what"] == name);
        own.map(|change| change["by_percent"].as_f64().unwrap())
            .collect::<Vec<_>>()
    };
    for name in ["coulomb", "viscous", "stribeck_excess"] {
        let changes = by_percent(name);
        assert_eq!(changes.len(), 2, "{name}: {said}");
        assert!(
            changes.iter().all(|percent| (percent + 30.0).abs() < 1.5),
            "{name}: {changes:?}"
        );
    }
    for name in ["load_inertia", "compliance_stiffness"] {
        assert!(by_percent(name).is_empty(), "{name}");
    }
    let text = std::fs::read_to_string(page).unwrap();
    for part in ["coulomb", "cold", "warm", "from run to run"] {
        assert!(text.contains(part), "{part}");
    }
    if later.len() == LATER.len() {
        pictures::check("compare.svg", &std::fs::read_to_string(plot).unwrap());
    }
}
