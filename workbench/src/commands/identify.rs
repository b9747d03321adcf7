//! `quadrant identify`: which effect does the declared model of a recorded axis lack? Offline.

use std::io::Write as _;
use std::path::Path;

use identification::{Dataset, Identification};

use crate::cli;
use crate::console;
use crate::error::{Failure, Outcome};
use crate::model_file::{self, Known};
use crate::output_files::{self, claim_folder, json, make_folder, write};
use crate::presentation::page::Page;
use crate::presentation::result_chapters::add_identification;
use crate::progress;
use crate::say;

/// What `--out` leaves.
const FILES: [&str; 4] = [
    "identification.json",
    "prediction.csv",
    "model.toml",
    "report.html",
];

/// Identifies a dataset, writes what was asked for and prints the result.
///
/// # Errors
/// Where the dataset is wrong, or a file cannot be written.
pub fn run(arguments: &cli::Identify) -> Outcome<()> {
    output_files::check([arguments.json.as_ref()])?;
    if let Some(folder) = &arguments.out {
        claim_folder(folder, "identify", &FILES.map(String::from))?;
    }
    let dataset = Dataset::read(
        &arguments.dataset,
        arguments.validate.as_deref(),
        arguments.declared.clone(),
    )?;
    let work = progress::Work::begins();
    let result = identification::identify(&dataset, &mut |step| {
        work.step(&step.to_string(), step.done());
    })?;
    // Files first: whoever reads the output may stop early.
    if let Some(path) = &arguments.json {
        write(path, &json(&result.report)?)?;
    }
    if let Some(folder) = &arguments.out {
        write_folder(folder, &dataset, &result)?;
    }
    console::print_identification(&result);
    if let Some(folder) = &arguments.out {
        say!("report: {}", folder.join("report.html").display());
    }
    Ok(())
}

/// Writes everything that is said of a result into a folder.
///
/// # Errors
/// Where a file cannot be written.
pub fn write_folder(folder: &Path, dataset: &Dataset, result: &Identification) -> Outcome<()> {
    make_folder(folder)?;
    write(&folder.join("identification.json"), &json(&result.report)?)?;
    write_prediction(&folder.join("prediction.csv"), result)?;
    write(&folder.join("model.toml"), &model_toml(dataset, result))?;
    let mut page = Page::new(&format!("Identification of {}", dataset.name));
    add_identification(&mut page, "Result", result);
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

/// `prediction.csv` of the validation record, a row at a time: it may have a million.
fn write_prediction(path: &Path, result: &Identification) -> Outcome<()> {
    let failed = |error: std::io::Error| Failure::file(path, &error);
    let file = std::fs::File::create(path).map_err(failed)?;
    let mut file = std::io::BufWriter::new(file);
    write_rows(&mut file, result)
        .and_then(|()| file.flush())
        .map_err(failed)
}

fn write_rows(file: &mut impl std::io::Write, result: &Identification) -> std::io::Result<()> {
    let curves = &result.curves;
    writeln!(file, "time_s,{},declared,extended", result.effort_column)?;
    let recorded = curves.time_s.iter().zip(&curves.effort);
    let predicted = curves.declared.iter().zip(&curves.extended);
    for ((time, effort), (declared, extended)) in recorded.zip(predicted) {
        writeln!(file, "{time},{effort},{declared:.6},{extended:.6}")?;
    }
    Ok(())
}
