//! Results on stdout, for people. Machines get JSON.

use board_timing::contract::RECEIVE_TO_TORQUE_US;
use identification::{Identification, figures};

use crate::ballbar::REVERSALS;
use crate::circle_test::CircleReport;
use crate::compensation::{Compensation, Model};
use crate::contour_test::ContourReport;
use crate::presentation::result_tables::{error_table, position_error_unit, sentence};
use crate::timing_test::{Spread, TimingReport};
use crate::tuning::Tuned;

/// Prints the figures of a circle.
pub fn print_circle(report: &CircleReport) {
    let figures = &report.figures;
    println!(
        "circle R {} mm, F {} mm/min, compensation {}; deviation of the {}",
        report.radius_mm, report.feed_mm_min, report.compensation, report.deviation_of
    );
    for ((_, _, name), peak) in REVERSALS.iter().zip(figures.peak_um) {
        println!("  burst, {name:<18}{peak:>10.2} µm");
    }
    let one = |name: &str, value: f64| println!("  {name:<26}{value:>10.2} µm");
    let two = |name: &str, [a, b]: [f64; 2]| println!("  {name:<26}{a:>10.2} / {b:.2} µm");
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
    for level in report.refined_levels.iter().flatten() {
        println!("  refined level of friction {level:>10.3}");
    }
    let load = report.bus_load_percent;
    println!("  bus load, computed        {load:>10.1} %");
    if report.missed_cycles > 0 {
        println!("  missed cycles             {:>10}", report.missed_cycles);
    }
}

/// Prints the figures of a contour.
pub fn print_contour(report: &ContourReport) {
    println!(
        "contour of {:.1} mm, F {} mm/min, compensation {}; error of the {}",
        report.length_mm, report.feed_mm_min, report.compensation, report.error_of
    );
    let [x_mm, y_mm] = report.largest_at_mm;
    println!(
        "  largest contour error   {:>10.2} µm  at {x_mm:.2} / {y_mm:.2} mm",
        report.largest_um
    );
    println!("  root mean square        {:>10.2} µm", report.rms_um);
    let [x, y] = report.reversals;
    println!("  reversals X / Y         {x:>10} / {y}");
    if report.missed_cycles > 0 {
        println!("  missed cycles           {:>10}", report.missed_cycles);
    }
}

/// Longest bar of a histogram, letters.
const LONGEST_BAR: f64 = 50.0;

/// Prints how long cycles take.
pub fn print_timing(report: &TimingReport) {
    println!(
        "{} cycles of {} µs, {}, pace {}; {} missed",
        report.cycles, report.period_us, report.place, report.pace, report.missed_cycles
    );
    if let Some(scheduling) = &report.scheduling {
        println!("{scheduling}");
    }
    println!(
        "  {:<32}{:>9}{:>10}{:>10}{:>10}{:>10}",
        "µs", "count", "p50", "p99", "p99.9", "max"
    );
    for spread in &report.times {
        println!(
            "  {:<32}{:>9}{:>10.2}{:>10.2}{:>10.2}{:>10.2}",
            spread.of, spread.count, spread.p50_us, spread.p99_us, spread.p99_9_us, spread.max_us
        );
    }
    println!("  bus load, computed {:>6.1} %", report.bus_load_percent);
    for drive in report.drives.iter().filter(|drive| drive.latest_us > 0) {
        println!(
            "  drive of {}: {} deadlines missed by more than {RECEIVE_TO_TORQUE_US} µs since it started, the latest {} µs late",
            drive.axis, drive.missed_deadlines, drive.latest_us
        );
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

fn print_histogram(spread: &Spread) {
    if spread.count == 0 {
        return;
    }
    println!("  {}, up to µs:", spread.of);
    for (upper_us, count) in &spread.histogram {
        // One of ten thousand shows as well.
        let letters = (LONGEST_BAR * *count as f64 / spread.count as f64).ceil();
        println!(
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

/// A compensation in a few words.
fn parameters(reversal: &Compensation) -> String {
    match reversal {
        Compensation::None => "no compensation".into(),
        Compensation::Coulomb { force_n } => format!("Coulomb {force_n:.0} N"),
        Compensation::Pulse(pulse) => format!(
            "{:.3} mm/s, {:.1} ms, start delay {:.1} ms",
            1.0e3 * pulse.height_m_per_s,
            1.0e3 * pulse.time_constant_s,
            1.0e3 * pulse.start_delay_s
        ),
        Compensation::Adaptive(own) => format!(
            "pulses over the acceleration: forward {}, backward {} mm/s, {} ms, start delay {} ms at {} mm/s²",
            span(1.0e3, &own.forward_m_per_s),
            span(1.0e3, &own.backward_m_per_s),
            span(1.0e3, &own.time_constant_s),
            span(1.0e3, &own.start_delay_s),
            span(1.0e3, &own.accelerations_m_per_s2()),
        ),
        Compensation::Model(model) => format!(
            "model of {:.1} N ({:.0} N at standstill), viscous {:.0} N s/m, screw {:.1} N/µm{}",
            model.level_n(),
            model.level_n() * model.factor[0],
            model.viscous_n_s_per_m,
            1.0e-6 * model.stiffness_n_per_m,
            on_motor(model)
        ),
    }
}

/// How much of the friction is of the motor's own side, where some is.
fn on_motor(model: &Model) -> String {
    let share = 100.0 * model.on_motor();
    if share > 0.0 {
        format!(", {share:.0} % of the friction on the motor's side")
    } else {
        String::new()
    }
}

/// First and last of some values, in a unit of which there are so many in the SI unit.
fn span(per_si: f64, values: &[f64]) -> String {
    let [first, .., last] = values else {
        return "none".into();
    };
    format!("{:.3} to {:.3}", per_si * first, per_si * last)
}

/// Prints what tuning found.
pub fn print_tuned(names: &[String], tuned: &Tuned) {
    let bursts_um = tuned.before_um.into_iter().zip(tuned.after_um);
    for ((name, compensation), (before, after)) in
        names.iter().zip(&tuned.compensation).zip(bursts_um)
    {
        println!(
            "axis {name}: {}: burst {before:.2} µm → {after:.2} µm ({})",
            parameters(&compensation.reversal),
            change(before, after)
        );
    }
    println!("{} circles", tuned.circles);
}

/// Prints what an axis lacks.
pub fn print_identification(result: &Identification) {
    println!("{}", sentence(&result.report));
    print_errors(result);
    print_shown(result);
    print_free_run(result);
    print_slow_ripple(result);
    for warning in &result.report.warnings {
        println!("  note: {warning}");
    }
}

fn print_errors(result: &Identification) {
    for row in error_table(result) {
        let (name, figures) = row
            .split_first()
            .map_or(("", &[][..]), |(name, figures)| (name.as_str(), figures));
        print!("  {name:<32}");
        for cell in figures {
            print!("{cell:>28}");
        }
        println!();
    }
}

/// Where each effect shows that was found.
fn print_shown(result: &Identification) {
    for row in &result.report.shown {
        println!(
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
    println!(
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
        println!(
            "  torque ripple of order {} per rev: {amplitude} ({low} to {high}) {}",
            order.per_rev, result.effort_unit
        );
    }
    println!(
        "  about reversals (up to {} {}/s): force error {} → {} % on the validation record",
        figures::error(ripple.fastest),
        result.position_unit,
        figures::error(ripple.validate_force_error_before_percent),
        figures::error(ripple.validate_force_error_after_percent)
    );
}
