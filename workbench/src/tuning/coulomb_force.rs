//! Coulomb friction of every axis as its declared model sees it on a record, for the bare
//! feedforward of a force in the commanded direction.

use std::path::Path;

use identification::Dataset;
use plant_sim::machine::MachineAxis;

use crate::axis_records::dataset_folder::DatasetFolder;
use crate::axis_records::{self, AxisRecord, Part, Plan, RECORDING_RUN};
use crate::compensation::{AxisCompensation, Compensation};
use crate::error::Outcome;
use crate::progress;
use crate::session::Stand;

/// Records the axes and gives a Coulomb compensation for each.
///
/// # Errors
/// Where the machine cannot be recorded, or a record has no friction to find.
pub fn measured(stand: &Stand<'_>) -> Outcome<Vec<AxisCompensation>> {
    progress::step("recording the axes for their Coulomb friction");
    let mut records = Vec::new();
    let plan = Plan::of(stand.machine, Part::Train);
    let session = stand.connect(RECORDING_RUN)?;
    session.perform(&stand.uncompensated(), None, |session| {
        axis_records::record(session, stand.machine, &plan, &mut records)
    })?;
    let folder = std::env::temp_dir().join(format!("quadrant-{}", std::process::id()));
    let axes = stand.machine.axes.iter().zip(&records);
    let found = axes
        .map(|(axis, record)| of_axis(&folder, stand, axis, record))
        .collect();
    // The folder is in the system's temporary directory: leaving it behind is untidy, not wrong.
    let _ = std::fs::remove_dir_all(&folder);
    found
}

/// One record serves as both parts: nothing is judged on the second one here.
fn of_axis(
    path: &Path,
    stand: &Stand<'_>,
    axis: &MachineAxis,
    record: &AxisRecord,
) -> Outcome<AxisCompensation> {
    let folder = DatasetFolder {
        path,
        machine: stand.machine,
        axis,
    };
    for part in Part::BOTH {
        folder.write(part, record, None)?;
    }
    let dataset = Dataset::read(path, None, None)?;
    let force_n = identification::declared_coulomb(&dataset)?;
    Ok(AxisCompensation {
        reversal: Compensation::Coulomb { force_n },
        backlash_m: 0.0,
    })
}
