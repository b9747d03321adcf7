//! What each compensation leaves of the burst, of G and of H at every feed: `cargo bench -p
//! hil-tests --bench compensation [-- CELLS]`.
//!
//! Circles on the reference machine with its noise, over the bus, mean of three turns of the true
//! table. The pulse is tuned at R 100 F 2000, and in each cell itself; `adaptive` on circles of R
//! 20 alone. The models are those of the records that `tune --method model` makes: of the declared
//! model alone, of the model extended by what identification found, and the same refined by the
//! drives on five circles. CELLS takes the first so many cells. The first table has the largest
//! bursts, the second one everything.

use hil_tests::on_all_cores;
use hil_tests::rig::circle;
use identification::Identification;
use plant_sim::Machine;
use workbench::ballbar::CircleFigures;
use workbench::circle_test;
use workbench::commissioning::feeds::less_percent;
use workbench::commissioning::identified_axes;
use workbench::compensation::{self, AxisCompensation};
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

/// Circles on which the drives refine the model first.
const REFINING_TURNS: u32 = 5;

/// A method whose parameters are the same in every cell.
struct Fixed {
    name: &'static str,
    compensation: Vec<AxisCompensation>,
    /// Turns before the circle.
    turns: u32,
}

/// What a method left in a cell.
struct Left {
    method: &'static str,
    figures: CircleFigures,
}

fn main() {
    let mut arguments = std::env::args().skip(1).filter(|text| text != "--bench");
    let cells = arguments.next().and_then(|text| text.parse().ok());
    let cells = &CELLS[..cells.unwrap_or(CELLS.len()).min(CELLS.len())];
    let machine = Machine::reference();
    let fixed = fixed(&machine);
    let all = on_all_cores(cells, |cell| of_cell(&machine, *cell, &fixed));
    print_bursts(cells, &all);
    println!();
    print_figures(cells, &all);
}

fn fixed(machine: &Machine) -> Vec<Fixed> {
    let stand = Stand::in_process(machine);
    let usual = circle(CELLS[0].0, CELLS[0].1);
    let pulse = tuning::pulse(&stand, &usual, 0.0).expect("the pulse can be tuned");
    let adaptive = tuning::adaptive(&stand, &usual).expect("pulses can be tuned");
    let (declared, extended) = identified(&stand);
    let model = |results: &[Identification]| {
        let tuned = tuning::model(&stand, &usual, results).expect("the circle can be run");
        tuned.expect("the axes have friction").compensation
    };
    let extended = model(&extended);
    let refining = compensation::self_tuning(&extended).expect("there is a model");
    let of = |name, compensation| Fixed {
        name,
        compensation,
        turns: 0,
    };
    vec![
        of("none", stand.uncompensated()),
        of(
            "coulomb",
            coulomb_force::measured(&stand).expect("friction can be measured"),
        ),
        of(
            "pulse of R 100 F 2000",
            pulse.expect("there is a burst").compensation,
        ),
        of("adaptive", adaptive.expect("there is a burst").compensation),
        of("model, declared", model(&declared)),
        of("model, extended", extended),
        Fixed {
            turns: REFINING_TURNS,
            ..of("model + self-tuning", refining)
        },
    ]
}

/// What the records say with the declared model alone, and with what it lacks.
fn identified(stand: &Stand<'_>) -> (Vec<Identification>, Vec<Identification>) {
    let folder = tempfile::tempdir().expect("a temporary folder can be made");
    identified_axes::record(stand, folder.path()).expect("the axes can be recorded");
    let declared =
        identified_axes::declared(stand, folder.path()).expect("the declared model fits");
    let extended = identified_axes::identify(stand, folder.path()).expect("records can be fitted");
    (declared, extended)
}

fn of_cell(machine: &Machine, cell: (f64, f64), fixed: &[Fixed]) -> Vec<Left> {
    let stand = Stand::in_process(machine);
    let circle = circle(cell.0, cell.1);
    let run = |turns: u32, compensation: &[AxisCompensation]| {
        let run = circle_test::run_after(&stand, &circle, turns, compensation, None);
        run.expect("the circle can be run").report.figures
    };
    let of_fixed = |method: &Fixed| Left {
        method: method.name,
        figures: run(method.turns, &method.compensation),
    };
    let mut all: Vec<Left> = fixed.iter().map(of_fixed).collect();
    let own = tuning::pulse(&stand, &circle, 0.0).expect("the pulse can be tuned");
    all.extend(own.map(|own| Left {
        method: "pulse of that cell",
        figures: run(0, &own.compensation),
    }));
    all
}

/// The largest burst of each method, a row for each cell.
fn print_bursts(cells: &[(f64, f64)], all: &[Vec<Left>]) {
    let Some(first) = all.first() else { return };
    let methods: Vec<&str> = first.iter().map(|left| left.method).collect();
    println!("| burst, µm (% less) | {} |", methods.join(" | "));
    println!("|---|{}", "---|".repeat(methods.len()));
    for ((radius, feed), row) in cells.iter().zip(all) {
        let before = row[0].figures.peak_max_um;
        let own = |left: &Left| {
            let burst = left.figures.peak_max_um;
            format!("{burst:.2} ({:.1})", less_percent(before, burst))
        };
        let rest: Vec<String> = row[1..].iter().map(own).collect();
        println!(
            "| R {radius} F {feed} | {before:.2} | {} |",
            rest.join(" | ")
        );
    }
}

/// Everything, a row for each method in each cell.
fn print_figures(cells: &[(f64, f64)], all: &[Vec<Left>]) {
    println!(
        "| cell | method | burst, µm | less, % | X far | Y far | X near | Y near | G, µm | less, % | H, µm |\n|---|---|---|---|---|---|---|---|---|---|---|"
    );
    for ((radius, feed), row) in cells.iter().zip(all) {
        let before = &row[0].figures;
        for Left { method, figures } in row {
            let [burst, g] = [figures.peak_max_um, figures.circular_deviation_g_um];
            let peaks: Vec<String> = figures
                .peak_um
                .iter()
                .map(|peak| format!("{peak:.2}"))
                .collect();
            println!(
                "| R {radius} F {feed} | {method} | {burst:.2} | {:.1} | {} | {g:.2} | {:.1} | {:.2} |",
                less_percent(before.peak_max_um, burst),
                peaks.join(" | "),
                less_percent(before.circular_deviation_g_um, g),
                figures.circular_hysteresis_h_um.unwrap_or(f64::NAN)
            );
        }
    }
}
