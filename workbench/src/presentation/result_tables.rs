//! What an identification found, as a sentence and as tables of text: the same for a page and for
//! the console.

use identification::{Errors, FreeRunErrors, Identification, Report};

/// Rows of cells; the first one is the head.
pub type TextTable = Vec<Vec<String>>;

/// A head, from its columns.
#[must_use]
pub fn head<const COLUMNS: usize>(columns: [&str; COLUMNS]) -> Vec<String> {
    columns.map(String::from).to_vec()
}

/// Millionths of the position's unit.
#[must_use]
pub fn position_error_unit(result: &Identification) -> &'static str {
    if result.position_unit == "rad" {
        "µrad"
    } else {
        "µm"
    }
}

/// One sentence about what was found.
#[must_use]
pub fn sentence(report: &Report) -> String {
    let found = if report.found.is_empty() {
        "nothing".to_owned()
    } else {
        report.found.join(", ")
    };
    let looks = &report.residual.looks_like;
    let rest = if report.verdict == "explained" {
        String::new()
    } else {
        format!("; unexplained: {looks}")
    };
    format!(
        "The declared model ({}) lacks: {found}{rest}",
        report.declared.join(", ")
    )
}

/// Errors before and after.
#[must_use]
pub fn error_table(result: &Identification) -> TextTable {
    let report = &result.report;
    let has_difference = report.train.position_difference_error_um_before.is_some();
    let unit = result.effort_unit;
    let mut rows = vec![head([
        "record",
        "force error before, %",
        "after, %",
        &format!("about reversals before, {unit}"),
        &format!("after, {unit}"),
    ])];
    if has_difference {
        rows[0].extend(head(["motor − load before, µm", "after, µm"]));
    }
    let row = |name: &str, errors: &Errors| error_row(name, errors, has_difference);
    rows.push(row("training", &report.train));
    rows.push(row("validation", &report.validate));
    if let Some(whole) = &report.whole {
        rows.push(row("whole file, fitted to all of it", whole));
    }
    rows
}

fn error_row(name: &str, errors: &Errors, has_difference: bool) -> Vec<String> {
    let mut row = vec![
        name.to_owned(),
        format!("{:.2}", errors.force_error_before_percent),
        format!("{:.2}", errors.force_error_after_percent),
        format!("{:.1}", errors.reversal_error_before),
        format!("{:.1}", errors.reversal_error_after),
    ];
    if has_difference {
        let um = |value: Option<f64>| value.map_or_else(String::new, |value| format!("{value:.3}"));
        row.push(um(errors.position_difference_error_um_before));
        row.push(um(errors.position_difference_error_um_after));
    }
    row
}

/// The force error by the protocols that papers use.
#[must_use]
pub fn protocol_table(report: &Report) -> TextTable {
    let mut rows = vec![head(["samples and fit", "declared, %", "extended, %"])];
    rows.extend(report.protocols.iter().map(|protocol| {
        let percent = |value: f64| format!("{value:.2}");
        vec![
            protocol.definition.to_owned(),
            percent(protocol.declared_percent),
            percent(protocol.extended_percent),
        ]
    }));
    rows
}

/// The candidates, by the share of the held-out error that they remove.
#[must_use]
pub fn candidate_table(report: &Report) -> TextTable {
    let mut rows = vec![head([
        "effect",
        "judged on",
        "share removed, %",
        "evidence t",
        "validation error alone, %",
        "physical",
    ])];
    rows.extend(report.candidates.iter().map(|candidate| {
        let mark = if candidate.accepted { "✓ " } else { "" };
        vec![
            format!("{mark}{}", candidate.effect),
            candidate.judged_on.to_owned(),
            format!("{:.1}", 100.0 * candidate.share.max(-9.99)),
            format!("{:.1}", candidate.evidence),
            candidate
                .validation_error_percent
                .map_or_else(|| "–".to_owned(), |error| format!("{error:.2}")),
            if candidate.physical { "yes" } else { "no" }.to_owned(),
        ]
    }));
    rows
}

/// The parameters of the extended model with their intervals.
#[must_use]
pub fn parameter_table(report: &Report) -> TextTable {
    let mut rows = vec![head(["parameter", "value", "low", "high", "unit"])];
    rows.extend(report.parameters.iter().map(|(name, parameter)| {
        let number = |value: f64| {
            if value.abs() >= 0.01 && value.abs() < 1.0e6 {
                format!("{value:.4}")
            } else {
                format!("{value:.4e}")
            }
        };
        vec![
            name.clone(),
            number(parameter.value),
            number(parameter.low),
            number(parameter.high),
            parameter.unit.clone(),
        ]
    }));
    rows
}

/// Errors of the free run on both records; empty where there was none.
#[must_use]
pub fn free_run_table(result: &Identification) -> TextTable {
    let Some(free_run) = &result.report.free_run else {
        return TextTable::new();
    };
    let percent =
        |value: Option<f64>| value.map_or_else(|| "–".to_owned(), |value| format!("{value:.3}"));
    let line = |name: &str, errors: &FreeRunErrors| {
        vec![
            name.to_owned(),
            format!("{:.3}", errors.position_error_um_before),
            format!("{:.3}", errors.position_error_um_after),
            percent(errors.tracking_error_percent_before),
            percent(errors.tracking_error_percent_after),
        ]
    };
    vec![
        head([
            "record",
            &format!("position error before, {} rms", position_error_unit(result)),
            &format!("after, {} rms", position_error_unit(result)),
            "of the tracking error before, %",
            "after, %",
        ]),
        line("training", &free_run.train),
        line("validation", &free_run.validate),
    ]
}

/// What each shape of friction leaves at reversals; empty where there was no free run.
#[must_use]
pub fn reversal_shape_table(result: &Identification) -> TextTable {
    let Some(free_run) = &result.report.free_run else {
        return TextTable::new();
    };
    let shapes = &free_run.reversals;
    let row = |name: &str, value: Option<f64>| {
        let left = value.map_or_else(|| "not tried".to_owned(), |value| format!("{value:.3}"));
        vec![name.to_owned(), left]
    };
    let unit = position_error_unit(result);
    vec![
        head(["shape", &format!("position error, {unit} rms")]),
        row("rigid friction with stick", Some(shapes.rigid_um)),
        row("bristle (presliding)", Some(shapes.bristle_um)),
        row("gap (backlash)", shapes.gap_um),
        row("bristle behind a gap", shapes.both_um),
    ]
}

/// Orders of the ripple that was found about reversals; empty where there was none.
#[must_use]
pub fn slow_ripple_table(result: &Identification) -> TextTable {
    let Some(ripple) = &result.report.slow_ripple else {
        return TextTable::new();
    };
    let amplitude = format!("amplitude, {}", result.effort_unit);
    let mut rows = vec![head(["order per revolution", &amplitude, "± (95 %)"])];
    rows.extend(ripple.orders.iter().map(|order| {
        vec![
            order.per_rev.to_string(),
            format!("{:.4}", order.amplitude),
            format!("{:.4}", order.half_width),
        ]
    }));
    rows
}
