//! Files that commands leave behind.

use std::path::Path;

use serde::Serialize;

use crate::error::{Failure, Outcome};

/// Writes a file.
///
/// # Errors
/// Where it cannot be written.
pub fn write(path: &Path, text: &str) -> Outcome<()> {
    std::fs::write(path, text).map_err(|error| Failure::file(path, &error))
}

/// Makes a folder, and those above it.
///
/// # Errors
/// Where it cannot be made.
pub fn make_folder(path: &Path) -> Outcome<()> {
    std::fs::create_dir_all(path).map_err(|error| Failure::file(path, &error))
}

/// The JSON text of a result.
///
/// # Errors
/// Never in practice: results are plain data.
pub fn json(result: &impl Serialize) -> Outcome<String> {
    serde_json::to_string_pretty(result)
        .map(|text| text + "\n")
        .map_err(|error| Failure::new(error.to_string()))
}
