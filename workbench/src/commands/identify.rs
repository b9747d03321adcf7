//! `quadrant identify`: which effect does the declared model of a recorded axis lack? Offline.

use std::fmt::Write as _;
use std::path::Path;

use identification::{Dataset, Identification};

use crate::cli;
use crate::console;
use crate::error::Outcome;
use crate::model_file::{self, Known};
use crate::output_files::{json, make_folder, write};
use crate::presentation::page::Page;
use crate::presentation::result_chapters::add_identification;
use crate::progress;

/// Identifies a dataset, writes what was asked for and prints the result.
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
    if let Some(path) = &arguments.json {
        write(path, &json(&result.report)?)?;
    }
    if let Some(folder) = &arguments.out {
        write_folder(folder, &dataset, &result)?;
    }
    console::print_identification(&result);
    if let Some(folder) = &arguments.out {
        println!("report: {}", folder.join("report.html").display());
    }
    Ok(())
}

fn write_folder(folder: &Path, dataset: &Dataset, result: &Identification) -> Outcome<()> {
    make_folder(folder)?;
    write(&folder.join("identification.json"), &json(&result.report)?)?;
    write(&folder.join("prediction.csv"), &prediction_csv(result))?;
    write(&folder.join("model.toml"), &model_toml(dataset, result))?;
    let mut page = Page::new(&format!("Identification of {}", dataset.name));
    add_identification(&mut page, "Result", result)?;
    write(&folder.join("report.html"), &page.finish())
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

/// `prediction.csv` of the validation record.
fn prediction_csv(result: &Identification) -> String {
    let curves = &result.curves;
    let mut text = format!("time_s,{},declared,extended\n", result.effort_column);
    let recorded = curves.time_s.iter().zip(&curves.effort);
    let predicted = curves.declared.iter().zip(&curves.extended);
    for ((time, effort), (declared, extended)) in recorded.zip(predicted) {
        // Writing to a String cannot fail.
        let _ = writeln!(text, "{time},{effort},{declared:.6},{extended:.6}");
    }
    text
}
