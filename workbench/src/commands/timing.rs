//! `quadrant timing`: how long the cycles of a machine take.

use crate::cli;
use crate::console;
use crate::error::Outcome;
use crate::interrupt::Interrupt;
use crate::output_files::{json, write};
use crate::presentation::plots::{self, Curve};
use crate::session::Stand;
use crate::timing_test::{self, Spread, TimingReport};

/// Size of the plot, px.
const SIZE: (u32, u32) = (900, 420);

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
    let report = timing_test::run(&stand, f64::from(arguments.seconds))?;
    console::print_timing(&report);
    if let Some(path) = &arguments.json {
        write(path, &json(&report)?)?;
    }
    if let Some(path) = &arguments.plot {
        write(path, &plots::standalone(&plot(&report)?))?;
    }
    Ok(())
}

fn plot(report: &TimingReport) -> Outcome<String> {
    let title = format!(
        "{}, {}: {} cycles of {} µs, {} missed",
        report.machine, report.place, report.cycles, report.period_us, report.missed_cycles
    );
    let some = report.times.iter().filter(|spread| spread.count > 0);
    let curves: Vec<Curve> = some.map(outline).collect();
    let x = "duration, µs, as a power of ten";
    plots::curves(&title, x, "share of all, %", SIZE, &curves)
}

/// The outline of a histogram over the logarithm of the duration.
fn outline(spread: &Spread) -> Curve {
    let mut points = Vec::new();
    let mut left = spread.min_us.max(1.0e-3).log10();
    points.push((left, 0.0));
    for (upper_us, count) in &spread.histogram {
        let percent = 100.0 * *count as f64 / spread.count as f64;
        let right = upper_us.log10();
        points.extend([(left, percent), (right, percent)]);
        left = right;
    }
    points.push((left, 0.0));
    Curve {
        name: spread.of.to_owned(),
        points,
        dots: false,
    }
}
