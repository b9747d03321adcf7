//! What an identification found, as a sentence and as tables of text: the same for a page and for
//! the console.

use axis_model::Estimate;
use identification::{
    Errors, FreeRun, FreeRunErrors, Identification, Report, UnknownParameter, figures,
};

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
        let unit = position_error_unit(result);
        rows[0].extend(head([
            &format!("motor − load before, {unit}"),
            &format!("after, {unit}"),
        ]));
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
        figures::error(errors.force_error_before_percent),
        figures::error(errors.force_error_after_percent),
        figures::error(errors.reversal_error_before),
        figures::error(errors.reversal_error_after),
    ];
    if has_difference {
        let um = |value: Option<f64>| value.map_or_else(String::new, figures::error);
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
        vec![
            protocol.definition.to_owned(),
            figures::error(protocol.declared_percent),
            figures::error(protocol.extended_percent),
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
        "force error with it alone, validation, %",
        "motor − load left with it alone, %",
        "physical",
    ])];
    rows.extend(report.candidates.iter().map(|candidate| {
        let mark = if candidate.accepted { "✓ " } else { "" };
        vec![
            format!("{mark}{}", candidate.effect),
            candidate.judged_on.to_owned(),
            figures::error(100.0 * candidate.share),
            figures::error(candidate.evidence),
            or_dash(candidate.validation_error_percent),
            or_dash(candidate.difference_left_percent),
            if candidate.physical { "yes" } else { "no" }.to_owned(),
        ]
    }));
    rows
}

/// A figure; a dash where there is none.
fn or_dash(value: Option<f64>) -> String {
    value.map_or_else(|| "–".to_owned(), figures::error)
}

/// Each effect that was found, with what is left of the outputs on which it shows.
#[must_use]
pub fn shown_table(report: &Report) -> TextTable {
    let mut rows = vec![head([
        "effect",
        "shows on",
        "left without it",
        "left with it",
        "unit",
    ])];
    rows.extend(report.shown.iter().map(|row| {
        vec![
            row.effect.clone(),
            row.on.to_owned(),
            figures::error(row.without),
            figures::error(row.with),
            row.unit.to_owned(),
        ]
    }));
    rows
}

/// The parameters of the extended model with their intervals, and the output of each.
#[must_use]
pub fn parameter_table(report: &Report) -> TextTable {
    let columns = ["parameter", "value", "low", "high", "unit", "from"];
    let row = |name: &str, [value, low, high]: [String; 3], unit: &str| {
        let from = report.parameters_from.get(name).copied();
        let [name, unit, from] = [name, unit, from.unwrap_or_default()].map(str::to_owned);
        vec![name, value, low, high, unit, from]
    };
    let mut rows = vec![head(columns)];
    let known = report.parameters.known.iter();
    rows.extend(known.map(|(name, known)| row(name, with_interval(known), &known.unit)));
    let unknown = report.parameters.unknown.iter();
    rows.extend(unknown.map(|(name, unknown)| row(name, without_value(unknown), &unknown.unit)));
    rows
}

/// Value and ends; a value without an interval has none.
fn with_interval(known: &Estimate) -> [String; 3] {
    let [value, low, high] = figures::estimate(known);
    let has_interval = known.low < known.high;
    let end = |end: String| if has_interval { end } else { "–".into() };
    [value, end(low), end(high)]
}

fn without_value(unknown: &UnknownParameter) -> [String; 3] {
    let ends = [unknown.low, unknown.high].map(figures::error);
    let [low, high] = ends;
    ["unknown".into(), low, high]
}

/// Who drove the simulation, and what its errors are worth.
#[must_use]
pub fn free_run_sentence(free_run: &FreeRun) -> String {
    let misfit = free_run.controller_misfit_percent.map(figures::error);
    let misfit = misfit.unwrap_or_default();
    let followed = "the recorded effort was applied and a soft controller kept the simulation near the record. No free run, but models compare:";
    match free_run.controller {
        "known" => format!(
            "Free run: the whole axis simulated in closed loop from the setpoints alone, with the controller of dataset.toml (it leaves {misfit} % of the recorded effort), parameters fitted to the positions of the training record:"
        ),
        "not described" => format!(
            "dataset.toml describes no whole controller, or the record has no setpoints: {followed}"
        ),
        "hidden by noise" => format!(
            "The controller of dataset.toml leaves {misfit} % of the recorded effort, most of it noise from row to row: {followed}"
        ),
        _ => format!(
            "The controller of dataset.toml does not give the recorded effort (it leaves {misfit} %): {followed}"
        ),
    }
}

/// Errors of the free run on both records; empty where there was none.
#[must_use]
pub fn free_run_table(result: &Identification) -> TextTable {
    let Some(free_run) = &result.report.free_run else {
        return TextTable::new();
    };
    let line = |name: &str, errors: &FreeRunErrors| {
        vec![
            name.to_owned(),
            figures::error(errors.position_error_um_before),
            figures::error(errors.position_error_um_after),
            or_dash(errors.tracking_error_um),
        ]
    };
    vec![
        head([
            "record",
            &format!("position error before, {} rms", position_error_unit(result)),
            &format!("after, {} rms", position_error_unit(result)),
            &format!(
                "setpoint − position of the record, {} rms",
                position_error_unit(result)
            ),
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
    let row = |name: &str, position: Option<f64>, effort: Option<f64>| {
        let left = position.map_or_else(|| "not tried".to_owned(), figures::error);
        vec![name.to_owned(), left, or_dash(effort)]
    };
    let (length, effort) = (position_error_unit(result), result.effort_unit);
    let (rigid, bristle) = (shapes.rigid_effort, shapes.bristle_effort);
    vec![
        head([
            "shape",
            &format!("simulated position, {length} rms"),
            &format!("effort about reversals, {effort} rms"),
        ]),
        row("rigid friction with stick", Some(shapes.rigid_um), rigid),
        row("bristle (presliding)", Some(shapes.bristle_um), bristle),
        row("gap (backlash)", shapes.gap_um, None),
        row("bristle behind a gap", shapes.both_um, None),
    ]
}

/// Orders of the ripple that was found about reversals; empty where there was none.
#[must_use]
pub fn slow_ripple_table(result: &Identification) -> TextTable {
    let Some(ripple) = &result.report.slow_ripple else {
        return TextTable::new();
    };
    let amplitude = format!("amplitude, {}", result.effort_unit);
    let mut rows = vec![head(["order per revolution", &amplitude, "low", "high"])];
    rows.extend(ripple.orders.iter().map(|order| {
        let [amplitude, low, high] = figures::estimate(&order.estimate(result.effort_unit));
        vec![order.per_rev.to_string(), amplitude, low, high]
    }));
    rows
}
