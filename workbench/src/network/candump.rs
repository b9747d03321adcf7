//! Candump logs of a run, and the DBC with which other people's tools read them.

use std::io::Write as _;
use std::path::Path;

use bus::BusLog;
use plant_sim::Machine;

use super::link::axis_ids;
use crate::error::{Failure, Outcome};

/// Writes the logs of all buses into one candump log.
///
/// # Errors
/// Where it cannot be written.
pub fn write_logs(path: &Path, logs: &[BusLog]) -> Outcome<()> {
    let failed = |error: std::io::Error| Failure::file(path, &error);
    let mut file = std::io::BufWriter::new(std::fs::File::create(path).map_err(failed)?);
    logs.iter()
        .try_for_each(|log| log.write(&mut file))
        .map_err(failed)?;
    file.flush().map_err(failed)
}

/// The DBC of a machine's nodes.
///
/// # Errors
/// Beyond 16 axes.
pub fn dbc(machine: &Machine) -> Outcome<String> {
    let axes = (0..machine.axes.len())
        .map(axis_ids)
        .collect::<Outcome<Vec<_>>>()?;
    let mut text = String::new();
    protocol::dbc::write(&mut text, &axes).map_err(|error| Failure::new(error.to_string()))?;
    Ok(text)
}
