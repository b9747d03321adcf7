//! Whether the model that `commission` hands on is good enough to compensate with: `cargo bench -p
//! hil-tests --bench model [-- SEEDS]`.
//!
//! The reference machine is recorded and identified, with other noise for every seed (20). Its
//! `model.toml` is put into the plant and driven around circles without compensation. The table has
//! the largest burst of the true machine and of the model, µm, and how far the model's is off, %:
//! median and range over the seeds. The last column is how far it is off with the noise of the
//! machine's own force. What noise was told stands below.

use hil_tests::on_all_cores;
use plant_sim::Machine;
use workbench::ballbar::median;
use workbench::circle_test;
use workbench::commissioning::identified_axes;
use workbench::session::Stand;
use workbench::trajectory::Circle;

/// Seeds.
const SEEDS: u64 = 20;
/// The first one.
const FIRST_SEED: u64 = 401;
/// Radius of the circles, m.
const RADIUS_M: f64 = 0.1;
/// Their feeds, mm/min.
const FEEDS: [f64; 3] = [500.0, 2000.0, 8000.0];

fn main() {
    let mut arguments = std::env::args().skip(1).filter(|text| text != "--bench");
    let seeds = arguments.next().and_then(|text| text.parse().ok());
    let seeds: Vec<u64> = (0..seeds.unwrap_or(SEEDS)).collect();
    let models = on_all_cores(&seeds, |seed| of_seed(FIRST_SEED + seed));
    let bursts: Vec<&Vec<BurstsUm>> = models.iter().map(|model| &model.bursts).collect();
    println!(
        "| feed, mm/min | machine, µm | model, µm | off, % | from | to | with its noise: off, % |\n|---|---|---|---|---|---|---|"
    );
    for (place, feed) in FEEDS.iter().enumerate() {
        let of = |which: fn(&BurstsUm) -> f64| -> Vec<f64> {
            bursts.iter().map(|all| which(&all[place])).collect()
        };
        let off = of(|burst| 100.0 * (burst.model / burst.machine - 1.0));
        println!(
            "| {feed:.0} | {:.2} | {:.2} | {:+.2} | {:+.2} | {:+.2} | {:+.2} |",
            median(&of(|burst| burst.machine)),
            median(&of(|burst| burst.model)),
            median(&off),
            off.iter().copied().fold(f64::INFINITY, f64::min),
            off.iter().copied().fold(f64::NEG_INFINITY, f64::max),
            median(&of(|burst| 100.0 * (burst.noisy / burst.machine - 1.0)))
        );
    }
    let noises: Vec<f64> = models.iter().flat_map(|model| model.noises_n).collect();
    println!(
        "\nnoise of the force: {:.2} N (machine {:.2}), {:.2} to {:.2}",
        median(&noises),
        Machine::reference().axes[0].actual.force_noise_n,
        noises.iter().copied().fold(f64::INFINITY, f64::min),
        noises.iter().copied().fold(f64::NEG_INFINITY, f64::max),
    );
}

/// What a seed gave.
struct OfSeed {
    /// At each feed.
    bursts: Vec<BurstsUm>,
    /// Noise of the force of both axes in `model.toml`, N.
    noises_n: [f64; 2],
}

/// The largest bursts at a feed, µm.
struct BurstsUm {
    machine: f64,
    model: f64,
    /// Of the model with the noise of the machine's force.
    noisy: f64,
}

/// The bursts of the machine with a seed and of its model, at each feed.
fn of_seed(seed: u64) -> OfSeed {
    let mut machine = Machine::reference();
    machine.seed = seed;
    let folder = tempfile::tempdir().expect("a temporary folder can be made");
    let stand = Stand::in_process(&machine);
    identified_axes::record(&stand, folder.path()).expect("the machine can be recorded");
    let results = identified_axes::identify(&stand, folder.path());
    let results = results.unwrap_or_else(|why| panic!("{why}"));
    let text = identified_axes::model(&machine, &results);
    let mut model = Machine::parse("model.toml", &text).unwrap_or_else(|why| panic!("{why}"));
    model.seed = seed;
    let mut noisy = model.clone();
    for (axis, of_machine) in noisy.axes.iter_mut().zip(&machine.axes) {
        axis.actual.force_noise_n = of_machine.actual.force_noise_n;
    }
    let at = |feed: &f64| BurstsUm {
        machine: burst_um(&machine, *feed),
        model: burst_um(&model, *feed),
        noisy: burst_um(&noisy, *feed),
    };
    OfSeed {
        bursts: FEEDS.iter().map(at).collect(),
        noises_n: [0, 1].map(|axis| model.axes[axis].actual.force_noise_n),
    }
}

/// The largest burst of a circle without compensation, µm.
fn burst_um(machine: &Machine, feed_mm_min: f64) -> f64 {
    let stand = Stand::in_process(machine);
    let circle = Circle {
        radius_m: RADIUS_M,
        feed_m_per_s: feed_mm_min / 6.0e4,
        turns: 2,
        counter_clockwise: true,
    };
    let run = circle_test::run(&stand, &circle, &stand.uncompensated(), None);
    run.expect("the circle can be run")
        .report
        .figures
        .peak_max_um
}
