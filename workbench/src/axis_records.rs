//! Records of the axes over the bus: all axes move by their own bursts at the same time, and each
//! becomes a dataset folder that `identify` reads.

pub mod dataset_folder;

use plant_sim::Machine;

use crate::error::Outcome;
use crate::network::link::Link;
use crate::network::master::AxisCycle;
use crate::session::Session;
use crate::trajectory::sine_bursts::{self, Burst};

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

/// Moves all axes by their own bursts and records them together, one record per axis. What was
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
    let bursts: Vec<Vec<Burst>> = machine
        .axes
        .iter()
        .map(|axis| sine_bursts::bursts(&axis.limits, part == Part::Validate))
        .collect();
    let durations_s = bursts.iter().map(|bursts| sine_bursts::duration_s(bursts));
    let duration_s = durations_s.fold(0.0, f64::max);
    let setpoints = |time_s: f64| -> Vec<f64> {
        bursts
            .iter()
            .map(|own| sine_bursts::at(own, time_s))
            .collect()
    };
    records.clear();
    records.resize(machine.axes.len(), AxisRecord::default());
    session.go_to(&vec![0.0; machine.axes.len()])?;
    // Times are since the drive was switched on: what warms up does not start cold in the second
    // record.
    let origin_s = session.cycles() as f64 * machine.period_s;
    session.follow(duration_s, setpoints, |time_s, axes| {
        for (record, axis) in records.iter_mut().zip(axes) {
            record.rows.push((origin_s + time_s, *axis));
        }
    })
}
