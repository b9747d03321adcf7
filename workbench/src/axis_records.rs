//! Records of the axes over the bus: all axes move by their own excitation at the same time, and
//! each becomes a dataset folder that `identify` reads.

pub mod dataset_folder;

use plant_sim::Machine;

use crate::error::Outcome;
use crate::network::link::Link;
use crate::network::master::AxisCycle;
use crate::session::Session;
use crate::trajectory::Excitation;

/// Noise of records is another than that of circles.
pub const RECORDING_RUN: u64 = 1;

/// A record of one axis: rows of time, setpoint, motor position, load position, effort.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct AxisRecord {
    /// Rows.
    pub rows: Vec<(f64, AxisCycle)>,
}

/// Which of the two records of a dataset.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// The model is fitted on it.
    Train,
    /// It judges the model.
    Validate,
}

impl Part {
    /// Both, in the order of recording.
    pub const BOTH: [Self; 2] = [Self::Train, Self::Validate];

    /// Name of its file.
    #[must_use]
    pub const fn file(self) -> &'static str {
        match self {
            Self::Train => "train.csv",
            Self::Validate => "validate.csv",
        }
    }

    /// Each record has a noise stream of its own.
    const fn stream(self) -> u64 {
        match self {
            Self::Train => 1,
            Self::Validate => 2,
        }
    }
}

/// How all axes move in one of the records. It takes a while to choose that, so it is done before
/// an axis is enabled: a bus in clock pace does not wait.
pub struct Plan {
    /// Per axis.
    excitations: Vec<Excitation>,
    /// Until the last axis has done.
    duration_s: f64,
}

impl Plan {
    /// Of a record of a machine.
    #[must_use]
    pub fn of(machine: &Machine, part: Part) -> Self {
        let is_validation = part == Part::Validate;
        let of_axis = |axis| Excitation::of(axis, machine.period_s, is_validation);
        let excitations: Vec<_> = machine.axes.iter().map(of_axis).collect();
        let durations_s = excitations.iter().map(Excitation::duration_s);
        let duration_s = durations_s.fold(0.0, f64::max);
        Self {
            excitations,
            duration_s,
        }
    }

    fn setpoints(&self, time_s: f64) -> Vec<f64> {
        let at = |own: &Excitation| own.at(time_s);
        self.excitations.iter().map(at).collect()
    }
}

/// Moves all axes by their own excitation and records them together, one record per axis. A cycle
/// whose frames did not come is no row; times tell. What was recorded before a failure stays in
/// `records`.
///
/// # Errors
/// Where a drive faults, or the operator interrupts.
pub fn record<L: Link>(
    session: &mut Session<'_, L>,
    machine: &Machine,
    plan: &Plan,
    records: &mut Vec<AxisRecord>,
) -> Outcome<()> {
    records.clear();
    records.resize(machine.axes.len(), AxisRecord::default());
    session.go_to(&vec![0.0; machine.axes.len()])?;
    // Times are since the drive was switched on: what warms up does not start cold in the second
    // record.
    let origin_s = session.cycles() as f64 * machine.period_s;
    session.follow(
        plan.duration_s,
        |time_s| plan.setpoints(time_s),
        |time_s, axes| {
            let measured = records.iter_mut().zip(axes);
            for (record, axis) in measured.filter(|(_, axis)| axis.is_measured) {
                record.rows.push((origin_s + time_s, *axis));
            }
        },
    )
}
