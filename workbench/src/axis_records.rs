//! Records of the axes over the bus: all axes move by their own sines at the same time, and each
//! becomes a dataset folder that `identify` reads.

pub mod dataset_folder;

use plant_sim::Machine;
use plant_sim::machine::MachineAxis;

use crate::error::Outcome;
use crate::network::link::Link;
use crate::network::master::AxisCycle;
use crate::session::Session;
use crate::trajectory::windowed_sines::{self, WindowedSine};

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

/// How all axes move.
struct Plan {
    /// Per axis.
    sines: Vec<Vec<WindowedSine>>,
    /// Until the last axis has done.
    duration_s: f64,
}

impl Plan {
    fn of(machine: &Machine, part: Part) -> Self {
        let is_validation = part == Part::Validate;
        let of_axis = |axis: &MachineAxis| windowed_sines::sequence(&axis.limits, is_validation);
        let sines: Vec<_> = machine.axes.iter().map(of_axis).collect();
        let durations_s = sines.iter().map(|own| windowed_sines::duration_s(own));
        let duration_s = durations_s.fold(0.0, f64::max);
        Self { sines, duration_s }
    }

    fn setpoints(&self, time_s: f64) -> Vec<f64> {
        let at = |own: &Vec<WindowedSine>| windowed_sines::at(own, time_s);
        self.sines.iter().map(at).collect()
    }
}

/// Moves all axes by their own sines and records them together, one record per axis. What was
/// recorded before a failure stays in `records`.
///
/// # Errors
/// Where a drive faults, or the operator interrupts.
pub fn record<L: Link>(
    session: &mut Session<'_, L>,
    machine: &Machine,
    part: Part,
    records: &mut Vec<AxisRecord>,
) -> Outcome<()> {
    let plan = Plan::of(machine, part);
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
            for (record, axis) in records.iter_mut().zip(axes) {
                record.rows.push((origin_s + time_s, *axis));
            }
        },
    )
}
