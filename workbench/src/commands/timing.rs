//! `quadrant timing`: how long the cycles of a machine take.

use crate::cli;
use crate::console;
use crate::error::Outcome;
use crate::interrupt::Interrupt;
use crate::output_files::{self, json, write};
use crate::presentation::plots::{Curve, Ink, Plot, curves, standalone};
use crate::session::Stand;
use crate::timing_test::{self, Spread, TimingReport};

/// Size of the plot, px.
const SIZE_PX: (f64, f64) = (900.0, 420.0);

/// Runs the machine, prints how long its cycles take and writes what was asked for.
///
/// # Errors
/// Where an argument, a file or the machine is wrong.
pub fn run(arguments: &cli::Timing, interrupt: &Interrupt) -> Outcome<()> {
    let (machine, place) = arguments.machine.machine_and_place()?;
    let stand = Stand {
        machine: &machine,
        place,
        interrupt: interrupt.clone(),
    };
    output_files::check([&arguments.json, &arguments.plot].map(Option::as_ref))?;
    let report = timing_test::run(&stand, f64::from(arguments.seconds))?;
    console::print_timing(&report);
    if let Some(path) = &arguments.json {
        write(path, &json(&report)?)?;
    }
    if let Some(path) = &arguments.plot {
        write(path, &standalone(&plot(&report)))?;
    }
    Ok(())
}

fn plot(report: &TimingReport) -> String {
    let title = format!(
        "{}, {}: {} cycles of {} µs, {} missed",
        report.machine, report.place, report.cycles, report.period_us, report.missed_cycles
    );
    let some = report.times.iter().filter(|spread| spread.count > 0);
    let list: Vec<Curve> = some
        .enumerate()
        .map(|(number, spread)| Curve::line(spread.of, Ink::Other(number), outline(spread)))
        .collect();
    let plot = Plot {
        is_logarithmic: true,
        ..Plot::new(&title, "duration, µs", "share of all, %", SIZE_PX)
    };
    curves(&plot, &list)
}

/// The outline of a histogram.
fn outline(spread: &Spread) -> Vec<(f64, f64)> {
    let mut points = Vec::new();
    let mut left = spread.min_us.max(1.0e-3);
    points.push((left, 0.0));
    for (upper_us, count) in &spread.histogram {
        let percent = 100.0 * *count as f64 / spread.count as f64;
        points.extend([(left, percent), (*upper_us, percent)]);
        left = *upper_us;
    }
    points.push((left, 0.0));
    points
}
