//! `quadrant identify`.

use std::path::Path;

use identification::{Dataset, Identification, IdentificationError};

use crate::cli;
use crate::error::{Failure, Outcome};
use crate::model_file::{self, Known};
use crate::presentation::page::{self, Page};
use crate::progress;

impl From<IdentificationError> for Failure {
    fn from(error: IdentificationError) -> Self {
        Self::new(error.to_string())
    }
}

/// Identifies a dataset and writes what was asked for.
///
/// # Errors
/// Where the dataset is wrong, or a file cannot be written.
pub fn run(arguments: &cli::Identify) -> Outcome<()> {
    let dataset = Dataset::read(
        &arguments.dataset,
        arguments.validate.as_deref(),
        arguments.declared.clone(),
    )?;
    let result = identification::identify(&dataset, &mut |text| progress::step(text))?;
    // Files first: whoever reads the output may stop early.
    let json = json(&result)?;
    if let Some(path) = &arguments.json {
        write(path, &json)?;
    }
    if let Some(folder) = &arguments.out {
        std::fs::create_dir_all(folder).map_err(|error| Failure::file(folder, &error))?;
        write(&folder.join("identification.json"), &json)?;
        write(&folder.join("prediction.csv"), &prediction_csv(&result))?;
        write(&folder.join("model.toml"), &model_toml(&dataset, &result))?;
        let mut page = Page::new(&format!("Identification of {}", dataset.name));
        page::identification(&mut page, "Result", &result)?;
        write(&folder.join("report.html"), &page.finish())?;
    }
    print(&result);
    if let Some(folder) = &arguments.out {
        println!("report: {}", folder.join("report.html").display());
    }
    Ok(())
}

/// The identified model: a machine file where the simulator has such an axis.
fn model_toml(dataset: &Dataset, result: &Identification) -> String {
    let mass_kg = result
        .report
        .parameters
        .get("inertia")
        .map_or(0.0, |inertia| inertia.value);
    match Known::of_dataset(dataset, mass_kg).filter(|_| mass_kg > 0.0) {
        Some(known) => model_file::text(&dataset.name, &[("X".to_owned(), known, result)]),
        None => model_file::parameters_only(&dataset.name, result),
    }
}

/// Writes a file.
///
/// # Errors
/// Where it cannot be written.
pub fn write(path: &Path, text: &str) -> Outcome<()> {
    std::fs::write(path, text).map_err(|error| Failure::file(path, &error))
}

/// The JSON text of a result.
///
/// # Errors
/// Never in practice: the form is plain data.
pub fn json(result: &Identification) -> Outcome<String> {
    serde_json::to_string_pretty(&result.report)
        .map(|text| text + "\n")
        .map_err(|error| Failure::new(error.to_string()))
}

/// Prints the result for people.
pub fn print(result: &Identification) {
    println!("{}", page::sentence(&result.report));
    for row in page::error_table(result) {
        let cells: Vec<String> = row
            .iter()
            .skip(1)
            .map(|cell| format!("{cell:>28}"))
            .collect();
        println!(
            "  {:<32}{}",
            row.first().map_or("", String::as_str),
            cells.join("")
        );
    }
    if let Some(free_run) = &result.report.free_run {
        let unit = if result.position_unit == "rad" {
            "µrad"
        } else {
            "µm"
        };
        let [train, validate] = [&free_run.train, &free_run.validate].map(|e| {
            format!(
                "{:.3} → {:.3}",
                e.position_error_um_before, e.position_error_um_after
            )
        });
        println!(
            "  free-run position error, {unit} rms: training {train}, validation {validate} (controller {})",
            free_run.controller
        );
    }
    for order in result
        .report
        .slow_ripple
        .iter()
        .flat_map(|ripple| &ripple.orders)
    {
        let (amplitude, half_width) = (order.amplitude, order.half_width);
        println!(
            "  torque ripple of order {} per rev: {amplitude:.4} ± {half_width:.4} {}",
            order.per_rev, result.effort_unit
        );
    }
    if let Some(ripple) = &result.report.slow_ripple {
        println!(
            "  about reversals (up to {:.1} {}/s): force error {:.2} → {:.2} % on the validation record",
            ripple.fastest,
            result.position_unit,
            ripple.validate_force_error_before_percent,
            ripple.validate_force_error_after_percent
        );
    }
    for warning in &result.report.warnings {
        println!("  note: {warning}");
    }
}

/// `prediction.csv` of the validation record.
#[must_use]
pub fn prediction_csv(result: &Identification) -> String {
    let curves = &result.curves;
    let mut text = format!("time_s,{},declared,extended\n", result.effort_column);
    for (((time, effort), declared), extended) in curves
        .time_s
        .iter()
        .zip(&curves.effort)
        .zip(&curves.declared)
        .zip(&curves.extended)
    {
        text.push_str(&format!("{time},{effort},{declared:.6},{extended:.6}\n"));
    }
    text
}
