//! Results on stdout, for people. Machines get JSON.

use board_timing::contract::RECEIVE_TO_TORQUE_US;
use comfy_table::presets::NOTHING;
use comfy_table::{CellAlignment, ContentArrangement, Table};
use identification::{Identification, figures};

use crate::ballbar::{Cause, REVERSALS};
use crate::circle_test::CircleReport;
use crate::contour_test::ContourReport;
use crate::drive_times::DriveTimes;
use crate::presentation::compensation_words::in_words;
use crate::presentation::result_tables::{TextTable, error_table, position_error_unit, sentence};
use crate::say;
use crate::timing_test::{Spread, TimingReport};
use crate::tuning::Tuned;

/// So many causes are told; all of them are in the JSON form.
const SHOWN_CAUSES: usize = 4;

/// Prints the figures of a circle.
pub fn print_circle(report: &CircleReport) {
    let figures = &report.figures;
    say!(
        "circle R {} mm, F {} mm/min, compensation {}; deviation of the {}",
        report.radius_mm,
        report.feed_mm_min,
        report.compensation,
        report.deviation_of
    );
    for ((_, _, name), peak) in REVERSALS.iter().zip(figures.peak_um) {
        say!("  burst, {name:<18}{peak:>10.2} µm");
    }
    let one = |name: &str, value: f64| say!("  {name:<26}{value:>10.2} µm");
    let two = |name: &str, [a, b]: [f64; 2]| say!("  {name:<26}{a:>10.2} / {b:.2} µm");
    one("largest burst", figures.peak_max_um);
    one("circular deviation G", figures.circular_deviation_g_um);
    if let Some(h_um) = figures.circular_hysteresis_h_um {
        one("circular hysteresis H", h_um);
    }
    let (fmax_um, fmin_um) = (
        figures.radial_deviation_fmax_um,
        figures.radial_deviation_fmin_um,
    );
    two("radial deviation Fmax/Fmin", [fmax_um, fmin_um]);
    two("step X / Y", figures.step_um);
    one("ellipse", figures.ellipse_um);
    let causes: Vec<&Cause> = report
        .causes
        .iter()
        .filter(|own| own.um.is_some())
        .collect();
    say!("  causes, by the circular deviation that each alone would make:");
    for cause in causes.iter().take(SHOWN_CAUSES) {
        let (um, share) = (cause.um.unwrap_or(0.0), cause.share_percent.unwrap_or(0.0));
        say!("    {:<24}{um:>10.2} µm {share:>4.0} %", cause.cause);
    }
    let blind = report.causes.iter().filter(|own| own.um.is_none());
    let blind: Vec<&str> = blind.map(|own| own.cause.as_str()).collect();
    if !blind.is_empty() {
        say!("    not measured: {}", blind.join(", "));
    }
    for level in report.refined_levels.iter().flatten() {
        say!("  refined level of friction {level:>10.3}");
    }
    let load = report.bus_load_percent;
    say!("  bus load, computed        {load:>10.1} %");
    if report.missed_cycles > 0 {
        say!("  missed cycles             {:>10}", report.missed_cycles);
    }
}

/// Prints the figures of a contour.
pub fn print_contour(report: &ContourReport) {
    say!(
        "contour of {:.1} mm, F {} mm/min, compensation {}; error of the {}",
        report.length_mm,
        report.feed_mm_min,
        report.compensation,
        report.error_of
    );
    let [x_mm, y_mm] = report.largest_at_mm;
    say!(
        "  largest contour error   {:>10.2} µm  at {x_mm:.2} / {y_mm:.2} mm",
        report.largest_um
    );
    say!("  root mean square        {:>10.2} µm", report.rms_um);
    let [x, y] = report.reversals;
    say!("  reversals X / Y         {x:>10} / {y}");
    if report.missed_cycles > 0 {
        say!("  missed cycles           {:>10}", report.missed_cycles);
    }
}

/// Longest bar of a histogram, letters.
const LONGEST_BAR: f64 = 50.0;

/// Prints how long cycles take.
pub fn print_timing(report: &TimingReport) {
    say!(
        "{} cycles of {} µs, {}, pace {}; {} missed",
        report.cycles,
        report.period_us,
        report.place,
        report.pace,
        report.missed_cycles
    );
    if let Some(scheduling) = &report.scheduling {
        say!("{scheduling}");
    }
    say!(
        "  {:<32}{:>9}{:>10}{:>10}{:>10}{:>10}",
        "µs",
        "count",
        "p50",
        "p99",
        "p99.9",
        "max"
    );
    for spread in &report.times {
        say!(
            "  {:<32}{:>9}{:>10.2}{:>10.2}{:>10.2}{:>10.2}",
            spread.of,
            spread.count,
            spread.p50_us,
            spread.p99_us,
            spread.p99_9_us,
            spread.max_us
        );
    }
    say!("  bus load, computed {:>6.1} %", report.bus_load_percent);
    for drive in report.drives.iter().filter(|drive| drive.latest_us > 0) {
        say!(
            "  drive of {}: {} deadlines missed by more than {RECEIVE_TO_TORQUE_US} µs since it started, the latest {} µs late",
            drive.axis,
            drive.missed_deadlines,
            drive.latest_us
        );
    }
    for drive in &report.drives {
        drive
            .times
            .iter()
            .for_each(|times| print_drive_times(&drive.axis, times));
    }
    let late = report
        .times
        .iter()
        .find(|spread| spread.of.starts_with("lateness"));
    report
        .times
        .first()
        .into_iter()
        .chain(late)
        .for_each(print_histogram);
}

/// What a drive has timed of itself, in a line and one of classes.
fn print_drive_times(axis: &str, times: &DriveTimes) {
    say!(
        "  drive of {axis} by its own clock, {}: {} times, least {:.2}, mean {:.2}, most {:.2} µs",
        times.of,
        times.count,
        times.min_us,
        times.mean_us,
        times.max_us
    );
    let class = |(end_us, count): &(Option<f64>, u32)| match end_us {
        Some(end_us) => format!("{count} below {end_us}"),
        None => format!("{count} longer"),
    };
    let classes: Vec<String> = times.histogram.iter().map(class).collect();
    say!("    {} µs", classes.join(", "));
}

fn print_histogram(spread: &Spread) {
    if spread.count == 0 {
        return;
    }
    say!("  {}, up to µs:", spread.of);
    for (upper_us, count) in &spread.histogram {
        // One of ten thousand shows as well.
        let letters = (LONGEST_BAR * *count as f64 / spread.count as f64).ceil();
        say!(
            "  {upper_us:>10.2} {count:>8} {}",
            "#".repeat(letters as usize)
        );
    }
}

/// How much less, or more, there is after than before.
fn change(before: f64, after: f64) -> String {
    let less = 100.0 * (1.0 - after / before);
    let word = if less < 0.0 { "more" } else { "less" };
    format!("{:.0} % {word}", less.abs())
}

/// Prints what tuning found.
pub fn print_tuned(names: &[String], tuned: &Tuned) {
    let bursts_um = tuned.before_um.into_iter().zip(tuned.after_um);
    for ((name, compensation), (before, after)) in
        names.iter().zip(&tuned.compensation).zip(bursts_um)
    {
        say!(
            "axis {name}: {}: burst {before:.2} µm → {after:.2} µm ({})",
            in_words(&compensation.reversal),
            change(before, after)
        );
    }
    say!("{} circles", tuned.circles);
}

/// Prints what an axis lacks.
pub fn print_identification(result: &Identification) {
    say!("{}", sentence(&result.report));
    print_errors(result);
    print_shown(result);
    print_free_run(result);
    print_slow_ripple(result);
    for warning in &result.report.warnings {
        say!("  note: {warning}");
    }
}

fn print_errors(result: &Identification) {
    print_table(&error_table(result));
}

/// Widest line, letters.
const WIDEST: u16 = 100;

/// Prints a table; its first row is the head. Cells wrap where it would be wider than a terminal.
pub fn print_table(rows: &TextTable) {
    let mut table = Table::new();
    table
        .load_preset(NOTHING)
        .set_content_arrangement(ContentArrangement::Dynamic)
        .set_width(WIDEST);
    table.add_rows(rows);
    for column in table.column_iter_mut().skip(1) {
        column.set_cell_alignment(CellAlignment::Right);
    }
    for line in table.lines() {
        say!(" {}", line.trim_end());
    }
}

/// Where each effect shows that was found.
fn print_shown(result: &Identification) {
    for row in &result.report.shown {
        say!(
            "  {:<32}{} → {} {} without and with it, {}, training",
            row.effect,
            figures::error(row.without),
            figures::error(row.with),
            row.unit,
            row.on,
        );
    }
}

fn print_free_run(result: &Identification) {
    let Some(free_run) = &result.report.free_run else {
        return;
    };
    let [train, validate] = [&free_run.train, &free_run.validate].map(|errors| {
        format!(
            "{} → {}",
            figures::error(errors.position_error_um_before),
            figures::error(errors.position_error_um_after)
        )
    });
    let (what, why) = match free_run.controller {
        "known" => ("free run", "by the controller of dataset.toml".to_owned()),
        why => (
            "simulation kept near the record",
            format!("controller {why}"),
        ),
    };
    say!(
        "  {what}, position error, {} rms: training {train}, validation {validate} ({why})",
        position_error_unit(result),
    );
}

fn print_slow_ripple(result: &Identification) {
    let Some(ripple) = &result.report.slow_ripple else {
        return;
    };
    for order in &ripple.orders {
        let [amplitude, low, high] = figures::estimate(&order.estimate(result.effort_unit));
        say!(
            "  torque ripple of order {} per rev: {amplitude} ({low} to {high}) {}",
            order.per_rev,
            result.effort_unit
        );
    }
    say!(
        "  about reversals (up to {} {}/s): force error {} → {} % on the validation record",
        figures::error(ripple.fastest),
        result.position_unit,
        figures::error(ripple.validate_force_error_before_percent),
        figures::error(ripple.validate_force_error_after_percent)
    );
}
