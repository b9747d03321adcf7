//! Records of all axes of a machine, and what each axis lacks by them.
//!
//! Every record is on disk as soon as it ends or breaks off. Axes are identified at the same time,
//! each in a thread of its own: their records have nothing in common.

use std::path::{Path, PathBuf};
use std::thread::JoinHandle;
use std::time::Duration;

use identification::{Dataset, Identification, IdentificationError, Step};
use plant_sim::Machine;
use plant_sim::machine::MachineAxis;

use crate::axis_records::dataset_folder::DatasetFolder;
use crate::axis_records::{self, AxisRecord, Part, Plan, RECORDING_RUN};
use crate::error::{Failure, Outcome};
use crate::interrupt::Interrupt;
use crate::model_file::{self, Known};
use crate::progress;
use crate::session::{Session, Stand};

/// How often the computation is asked whether it is done, and the operator whether he still wants
/// it.
const ASK_EVERY: Duration = Duration::from_millis(50);

/// The dataset folder of an axis.
fn records_folder(out: &Path, axis: &MachineAxis) -> PathBuf {
    out.join(format!("records-{}", axis.name))
}

/// Training and validation record of all axes, below `out`.
///
/// # Errors
/// Where a file or the machine is wrong, or the operator interrupts.
pub fn record(stand: &Stand<'_>, out: &Path) -> Outcome<()> {
    progress::step("choosing what to move");
    let plans = Part::BOTH.map(|part| (part, Plan::of(stand.machine, part)));
    let session = stand.connect(RECORDING_RUN)?;
    let log = out.join("records.candump.log");
    session.perform(&stand.uncompensated(), Some(&log), |session| {
        plans
            .iter()
            .try_for_each(|(part, plan)| record_part(session, stand.machine, *part, plan, out))
    })
}

fn record_part(
    session: &mut Session<'_>,
    machine: &Machine,
    part: Part,
    plan: &Plan,
    out: &Path,
) -> Outcome<()> {
    progress::step(match part {
        Part::Train => "recording: slow and fast runs, reversals",
        Part::Validate => "recording the validation record",
    });
    let mut records = Vec::new();
    let outcome = axis_records::record(session, machine, plan, &mut records);
    session.meanwhile(|| {
        let records = machine.axes.iter().zip(&records);
        records.into_iter().try_for_each(|(axis, record)| {
            let folder = DatasetFolder {
                path: &records_folder(out, axis),
                machine,
                axis,
            };
            folder.write(part, record, outcome.as_ref().err())
        })
    })??;
    outcome.map_err(|failure| broke_off(&failure, part, &records, out))
}

fn broke_off(failure: &Failure, part: Part, records: &[AxisRecord], out: &Path) -> Failure {
    let rows = records.first().map_or(0, |record| record.rows.len());
    let (file, out) = (part.file(), out.display());
    Failure::new(format!(
        "{failure}; {file} broke off after {rows} rows, what was recorded is in {out}"
    ))
}

/// What each axis lacks, by its records below `out`.
///
/// # Errors
/// Where a record is wrong, or the operator interrupts.
pub fn identify(stand: &Stand<'_>, out: &Path) -> Outcome<Vec<Identification>> {
    each_axis(stand, out, "identifying", identification::identify)
}

/// The declared model alone of each axis, by the same records.
///
/// # Errors
/// As [`identify`].
pub fn declared(stand: &Stand<'_>, out: &Path) -> Outcome<Vec<Identification>> {
    let mut results = each_axis(
        stand,
        out,
        "declared model of",
        identification::fit_declared,
    )?;
    results.iter_mut().for_each(without_what_was_found);
    Ok(results)
}

/// What reversals show of a bristle or a gap is no part of a declared model that lacks it.
fn without_what_was_found(result: &mut Identification) {
    let found = &result.report.found;
    result
        .effects
        .retain(|effect| !found.iter().any(|name| name == effect.name().as_str()));
}

/// A fit of a dataset that tells of its steps.
type Fit = fn(&Dataset, &mut dyn FnMut(&Step)) -> Result<Identification, IdentificationError>;

fn each_axis(stand: &Stand<'_>, out: &Path, doing: &str, fit: Fit) -> Outcome<Vec<Identification>> {
    let works = stand.machine.axes.iter().map(|axis| {
        let dataset = Dataset::read(&records_folder(out, axis), None, None)?;
        Ok(begin(&axis.name, dataset, doing, fit))
    });
    let works = works.collect::<Outcome<Vec<_>>>()?;
    works
        .into_iter()
        .map(|work| end(work, &stand.interrupt))
        .collect()
}

/// An identification that is being computed.
type Work = JoinHandle<Result<Identification, IdentificationError>>;

fn begin(axis: &str, dataset: Dataset, doing: &str, fit: Fit) -> Work {
    progress::step(&format!("{doing} axis {axis}"));
    let axis = axis.to_owned();
    std::thread::spawn(move || {
        let work = progress::Work::begins();
        fit(&dataset, &mut |step| {
            work.step(&format!("axis {axis}: {step}"), step.done());
        })
    })
}

/// Waits for a result. Nothing moves meanwhile, so an interruption need not wait for it.
fn end(work: Work, interrupt: &Interrupt) -> Outcome<Identification> {
    while !work.is_finished() {
        interrupt.check()?;
        std::thread::sleep(ASK_EVERY);
    }
    match work.join() {
        Ok(result) => Ok(result?),
        Err(panic) => std::panic::resume_unwind(panic),
    }
}

/// The identified models as a machine file.
#[must_use]
pub fn model(machine: &Machine, results: &[Identification]) -> String {
    let of_axis = |(axis, result): (&MachineAxis, _)| {
        let known = Known::of_machine(axis, machine.period_s);
        (axis.name.clone(), known, result)
    };
    let models: Vec<(String, Known, &Identification)> =
        machine.axes.iter().zip(results).map(of_axis).collect();
    model_file::text(&format!("{}, identified", machine.name), &models)
}
