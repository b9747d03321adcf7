//! What each compensation leaves of the burst and of G at every feed: `cargo bench -p hil-tests
//! --bench compensation [-- CELLS]`.
//!
//! Circles on the reference machine with its noise, over the bus, mean of three turns of the true
//! table: largest burst and circular deviation G, µm, and the share of each that is gone, %. The
//! two models are those of the records that `tune --method model` makes: of the declared model
//! alone, and of the model extended by what identification found. The pulse is tuned at R 100 F
//! 2000, and in each cell itself. CELLS takes the first so many cells.

use hil_tests::on_all_cores;
use hil_tests::rig::circle;
use identification::{Dataset, Identification, fit_declared};
use plant_sim::Machine;
use workbench::circle_test;
use workbench::commissioning::identified_axes;
use workbench::compensation::AxisCompensation;
use workbench::session::Stand;
use workbench::tuning::{self, coulomb_force};

/// R mm, F mm/min.
const CELLS: [(f64, f64); 13] = [
    (100.0, 2000.0),
    (100.0, 250.0),
    (100.0, 500.0),
    (100.0, 1000.0),
    (100.0, 3000.0),
    (100.0, 8000.0),
    (25.0, 1000.0),
    (25.0, 3000.0),
    (25.0, 8000.0),
    (10.0, 500.0),
    (10.0, 1000.0),
    (10.0, 8000.0),
    (100.0, 100.0),
];

/// Methods whose parameters are the same in every cell.
struct Fixed {
    name: &'static str,
    compensation: Vec<AxisCompensation>,
}

fn main() {
    let mut arguments = std::env::args().skip(1).filter(|text| text != "--bench");
    let cells = arguments.next().and_then(|text| text.parse().ok());
    let cells = &CELLS[..cells.unwrap_or(CELLS.len()).min(CELLS.len())];
    let machine = Machine::reference();
    let fixed = fixed(&machine);
    println!(
        "| cell | method | burst, µm | less, % | G, µm | less, % |\n|---|---|---|---|---|---|"
    );
    for lines in on_all_cores(cells, |cell| of_cell(&machine, *cell, &fixed)) {
        print!("{lines}");
    }
}

fn fixed(machine: &Machine) -> Vec<Fixed> {
    let stand = Stand::in_process(machine);
    let usual = circle(CELLS[0].0, CELLS[0].1);
    let pulse = tuning::pulse(&stand, &usual, 0.0).expect("the pulse can be tuned");
    let (declared, extended) = identified(&stand);
    let model = |results: &[Identification]| {
        let tuned = tuning::model(&stand, &usual, results).expect("the circle can be run");
        tuned.expect("the axes have friction").compensation
    };
    vec![
        Fixed {
            name: "coulomb",
            compensation: coulomb_force::measured(&stand).expect("friction can be measured"),
        },
        Fixed {
            name: "pulse tuned at R 100 F 2000",
            compensation: pulse.expect("there is a burst").compensation,
        },
        Fixed {
            name: "model, declared",
            compensation: model(&declared),
        },
        Fixed {
            name: "model, extended",
            compensation: model(&extended),
        },
    ]
}

/// What the records say with the declared model alone, and with what it lacks.
fn identified(stand: &Stand<'_>) -> (Vec<Identification>, Vec<Identification>) {
    let folder = tempfile::tempdir().expect("a temporary folder can be made");
    identified_axes::record(stand, folder.path()).expect("the axes can be recorded");
    let declared = stand.axis_names().into_iter().map(|name| {
        let path = folder.path().join(format!("records-{name}"));
        let dataset = Dataset::read(&path, None, None).expect("the record was just written");
        fit_declared(&dataset, &mut |_| ()).expect("the declared model fits")
    });
    let declared = declared.collect();
    let extended = identified_axes::identify(stand, folder.path()).expect("records can be fitted");
    (declared, extended)
}

fn of_cell(machine: &Machine, cell: (f64, f64), fixed: &[Fixed]) -> String {
    let stand = Stand::in_process(machine);
    let circle = circle(cell.0, cell.1);
    let run = |compensation: &[AxisCompensation]| {
        let run = circle_test::run(&stand, &circle, compensation, None);
        let figures = run.expect("the circle can be run").report.figures;
        [figures.peak_max_um, figures.circular_deviation_g_um]
    };
    let none = run(&stand.uncompensated());
    let line = |name: &str, [burst, deviation]: [f64; 2]| {
        let less = |now: f64, before: f64| 100.0 * (1.0 - now / before);
        format!(
            "| R {} F {} | {name} | {burst:.2} | {:.1} | {deviation:.2} | {:.1} |\n",
            cell.0,
            cell.1,
            less(burst, none[0]),
            less(deviation, none[1])
        )
    };
    let mut lines = line("none", none);
    for method in fixed {
        lines += &line(method.name, run(&method.compensation));
    }
    let own = tuning::pulse(&stand, &circle, 0.0).expect("the pulse can be tuned");
    if let Some(own) = own {
        lines += &line("pulse tuned in that cell", run(&own.compensation));
    }
    lines
}
