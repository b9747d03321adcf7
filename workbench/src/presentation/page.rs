//! Self-contained HTML reports.

use std::fmt::Write as _;

use identification::{EffectCurve, Errors, FreeRunErrors, Identification, Report};

use crate::error::Outcome;
use crate::presentation::plots::{self, Curve};

const STYLE: &str = "body{font:15px/1.5 sans-serif;color:#222;max-width:1100px;margin:2em auto;padding:0 1em}\
h1{font-size:1.7em}h2{margin-top:2em;border-bottom:1px solid #bbb}table{border-collapse:collapse;margin:1em 0}\
td,th{border:1px solid #ccc;padding:.25em .7em;text-align:right}td:first-child,th:first-child{text-align:left}th{background:#f0f0f0}\
.good{background:#e8f5e9}.row{display:flex;flex-wrap:wrap;gap:1em}.row>div{flex:1 1 460px;min-width:0}.key{font-size:1.1em}small{color:#666}\
@media print{body{max-width:none;margin:0}h2{break-after:avoid}svg,table{break-inside:avoid}}";

/// An HTML page in the making.
pub struct Page(String);

impl Page {
    /// A page with a title.
    #[must_use]
    pub fn new(title: &str) -> Self {
        let title = escaped(title);
        Self(format!(
            "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>{title}</title><style>{STYLE}</style></head><body>\n<h1>{title}</h1>\n"
        ))
    }

    /// A heading.
    pub fn heading(&mut self, text: &str) {
        self.raw(&format!("<h2>{}</h2>\n", escaped(text)));
    }

    /// A paragraph.
    pub fn paragraph(&mut self, text: &str) {
        self.raw(&format!("<p>{}</p>\n", escaped(text)));
    }

    /// The sentence that matters.
    pub fn key(&mut self, text: &str) {
        self.raw(&format!("<p class=\"key\"><b>{}</b></p>\n", escaped(text)));
    }

    /// A table; the first row is the head. Rows whose first cell starts with `✓` are marked.
    pub fn table(&mut self, rows: &[Vec<String>]) {
        self.raw("<table>\n");
        for (index, row) in rows.iter().enumerate() {
            let tag = if index == 0 { "th" } else { "td" };
            let class = if row.first().is_some_and(|cell| cell.starts_with('✓')) {
                " class=\"good\""
            } else {
                ""
            };
            let cells: String = row.iter().fold(String::new(), |mut cells, cell| {
                let _ = write!(cells, "<{tag}>{}</{tag}>", escaped(cell));
                cells
            });
            self.raw(&format!("<tr{class}>{cells}</tr>\n"));
        }
        self.raw("</table>\n");
    }

    /// Pictures side by side, where the page is wide enough.
    pub fn pictures(&mut self, pictures: &[String]) {
        self.raw("<div class=\"row\">");
        for picture in pictures {
            self.raw(&format!("<div>{picture}</div>"));
        }
        self.raw("</div>\n");
    }

    /// The finished page.
    #[must_use]
    pub fn finish(mut self) -> String {
        self.raw("</body></html>\n");
        self.0
    }

    fn raw(&mut self, text: &str) {
        self.0.push_str(text);
    }
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
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

/// The chapters of an identification.
///
/// # Errors
/// Where a plot cannot be drawn.
pub fn identification(page: &mut Page, title: &str, result: &Identification) -> Outcome<()> {
    let report = &result.report;
    page.heading(title);
    page.key(&sentence(report));
    page.table(&error_table(result));
    page.pictures(&residual_pictures(result)?);
    page.pictures(&[time_picture(result)?]);
    page.pictures(&effect_pictures(result)?);
    free_run(page, result)?;
    slow_ripple(page, result);
    page.paragraph("The force error by the protocols that papers use:");
    page.table(&protocol_table(report));
    page.paragraph(
        "Candidates, by the share of the held-out error that they remove (blocks of 1 s left out of the fit):",
    );
    page.table(&candidate_table(report));
    page.paragraph(
        "Parameters of the extended model, with 95 % intervals (jackknife over blocks of 1 s, nonlinear ones linearised; low = high where there is none):",
    );
    page.table(&parameter_table(report));
    for warning in &report.warnings {
        page.paragraph(&format!("Note: {warning}."));
    }
    Ok(())
}

/// Each effect that was found in the effort: what the model without it leaves, and the effect.
fn effect_pictures(result: &Identification) -> Outcome<Vec<String>> {
    let picture = |curve: &EffectCurve| {
        let dots = |which: usize, name: &str| Curve {
            name: name.into(),
            points: curve
                .points
                .iter()
                .map(|point| (point[0], point[which]))
                .collect(),
            dots: true,
        };
        let list = [dots(1, "residual without it"), dots(2, "the effect")];
        let title = format!("{}: {} (training)", curve.effect, curve.equation);
        plots::curves(
            &title,
            &curve.against,
            result.effort_unit,
            (540, 360),
            &list,
        )
    };
    result.curves.effects.iter().map(picture).collect()
}

/// Free-run simulation: errors, shapes at reversals, picture.
fn free_run(page: &mut Page, result: &Identification) -> Outcome<()> {
    let Some(free_run) = &result.report.free_run else {
        return Ok(());
    };
    let known = free_run.controller == "known";
    let unit = if result.position_unit == "rad" {
        "µrad"
    } else {
        "µm"
    };
    page.paragraph(if known {
        "Free run: the whole axis simulated in closed loop from the setpoints alone, parameters fitted to the positions of the training record:"
    } else {
        "The controller is not known: the recorded effort was applied and a soft controller kept the simulation near the record. No free run, but models compare:"
    });
    let percent =
        |value: Option<f64>| value.map_or_else(|| "–".to_owned(), |value| format!("{value:.3}"));
    let head = [
        "record".to_owned(),
        format!("position error before, {unit} rms"),
        format!("after, {unit} rms"),
        "of the tracking error before, %".to_owned(),
        "after, %".to_owned(),
    ];
    let line = |name: &str, errors: &FreeRunErrors| {
        vec![
            name.to_owned(),
            format!("{:.3}", errors.position_error_um_before),
            format!("{:.3}", errors.position_error_um_after),
            percent(errors.tracking_error_percent_before),
            percent(errors.tracking_error_percent_after),
        ]
    };
    page.table(&[
        head.to_vec(),
        line("training", &free_run.train),
        line("validation", &free_run.validate),
    ]);
    let shapes = &free_run.reversals;
    let row = |name: &str, value: Option<f64>| {
        vec![
            name.to_owned(),
            value.map_or_else(|| "not tried".to_owned(), |value| format!("{value:.3}")),
        ]
    };
    page.paragraph(
        "What acts at reversals, by what the free run leaves on blocks that were not fitted:",
    );
    page.table(&[
        vec!["shape".to_owned(), format!("position error, {unit} rms")],
        row("rigid friction with stick", Some(shapes.rigid_um)),
        row("bristle (presliding)", Some(shapes.bristle_um)),
        row("gap (backlash)", shapes.gap_um),
        row("bristle behind a gap", shapes.both_um),
    ]);
    let curve = |which: usize, name: &str| Curve {
        name: name.into(),
        points: result
            .curves
            .free_run
            .iter()
            .map(|point| (point[0], point[which]))
            .collect(),
        dots: false,
    };
    let list = [curve(1, "declared"), curve(2, "extended")];
    page.pictures(&[plots::curves(
        "Free run on the validation record: simulated − recorded",
        "time, s",
        unit,
        (1080, 300),
        &list,
    )?]);
    Ok(())
}

/// Ripple that was found about the reversals of an axis that is never slow for long.
fn slow_ripple(page: &mut Page, result: &Identification) {
    let Some(ripple) = &result.report.slow_ripple else {
        return;
    };
    page.paragraph(&format!(
        "Torque ripple about the reversals (samples up to {:.3} {}/s, low-pass {} Hz): force error {:.2} → {:.2} % on the training record, {:.2} → {:.2} % on the validation record:",
        ripple.fastest,
        result.position_unit,
        ripple.cutoff_hz,
        ripple.train_force_error_before_percent,
        ripple.train_force_error_after_percent,
        ripple.validate_force_error_before_percent,
        ripple.validate_force_error_after_percent
    ));
    let mut rows = vec![vec![
        "order per revolution".to_owned(),
        format!("amplitude, {}", result.effort_unit),
        "± (95 %)".to_owned(),
    ]];
    rows.extend(ripple.orders.iter().map(|order| {
        vec![
            order.per_rev.to_string(),
            format!("{:.4}", order.amplitude),
            format!("{:.4}", order.half_width),
        ]
    }));
    page.table(&rows);
}

/// Errors before and after.
#[must_use]
pub fn error_table(result: &Identification) -> Vec<Vec<String>> {
    let report = &result.report;
    let unit = result.effort_unit;
    let mut rows = vec![
        ["record", "force error before, %", "after, %"]
            .map(String::from)
            .to_vec(),
    ];
    rows[0].extend([
        format!("about reversals before, {unit}"),
        format!("after, {unit}"),
    ]);
    let has_difference = report.train.position_difference_error_um_before.is_some();
    if has_difference {
        rows[0].extend(["motor − load before, µm".to_owned(), "after, µm".to_owned()]);
    }
    let mut add = |name: &str, errors: &Errors| {
        let mut row = vec![
            name.to_owned(),
            format!("{:.2}", errors.force_error_before_percent),
            format!("{:.2}", errors.force_error_after_percent),
            format!("{:.1}", errors.reversal_error_before),
            format!("{:.1}", errors.reversal_error_after),
        ];
        if has_difference {
            let um =
                |value: Option<f64>| value.map_or_else(String::new, |value| format!("{value:.3}"));
            row.push(um(errors.position_difference_error_um_before));
            row.push(um(errors.position_difference_error_um_after));
        }
        rows.push(row);
    };
    add("training", &report.train);
    add("validation", &report.validate);
    if let Some(whole) = &report.whole {
        add("whole file, fitted to all of it", whole);
    }
    rows
}

fn protocol_table(report: &Report) -> Vec<Vec<String>> {
    let mut rows = vec![
        ["samples and fit", "declared, %", "extended, %"]
            .map(String::from)
            .to_vec(),
    ];
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

fn candidate_table(report: &Report) -> Vec<Vec<String>> {
    let mut rows = vec![
        [
            "effect",
            "judged on",
            "share removed, %",
            "evidence t",
            "validation error alone, %",
            "physical",
        ]
        .map(String::from)
        .to_vec(),
    ];
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

fn parameter_table(report: &Report) -> Vec<Vec<String>> {
    let mut rows = vec![
        ["parameter", "value", "low", "high", "unit"]
            .map(String::from)
            .to_vec(),
    ];
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

fn residual_pictures(result: &Identification) -> Outcome<Vec<String>> {
    let unit = result.position_unit;
    let against = |column: usize, name: &str, label: &str| {
        let dots = |which: usize, name: &str| Curve {
            name: name.into(),
            points: result
                .curves
                .moving
                .iter()
                .map(|row| (row[column], row[which]))
                .collect(),
            dots: true,
        };
        let list = [dots(2, "declared"), dots(3, "extended")];
        plots::curves(
            &format!("Residual against {name} (validation)"),
            label,
            result.effort_unit,
            (540, 360),
            &list,
        )
    };
    Ok(vec![
        against(0, "velocity", &format!("velocity, {unit}/s"))?,
        against(1, "position", &format!("position, {unit}"))?,
    ])
}

fn time_picture(result: &Identification) -> Outcome<String> {
    let curves = &result.curves;
    let over = |name: &str, values: &[f64]| Curve {
        name: name.into(),
        points: curves
            .time_s
            .iter()
            .copied()
            .zip(values.iter().copied())
            .collect(),
        dots: false,
    };
    let list = [
        over("declared", &curves.declared),
        over("extended", &curves.extended),
        over("recorded", &curves.effort),
    ];
    plots::curves(
        "Effort on the validation record",
        "time, s",
        result.effort_unit,
        (1080, 340),
        &list,
    )
}
