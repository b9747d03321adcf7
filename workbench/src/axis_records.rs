//! Records of the axes over the bus, as dataset folders that `identify` reads.

use std::fmt::Write as _;
use std::path::Path;

use plant_sim::Machine;
use plant_sim::machine::{MachineAxis, PositionSensor};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};

use crate::commands::identify::write;
use crate::error::{Failure, Outcome};
use crate::network::link::Link;
use crate::network::master::AxisCycle;
use crate::session::Session;
use crate::trajectory::sine_bursts::{self, Burst};

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
    let duration_s = bursts
        .iter()
        .map(|bursts| sine_bursts::duration_s(bursts))
        .fold(0.0, f64::max);
    records.clear();
    records.resize(machine.axes.len(), AxisRecord::default());
    session.go_to(&vec![0.0; machine.axes.len()])?;
    // Times are since the drive was switched on: what warms up does not start cold in the second
    // record.
    let origin_s = session.cycles() as f64 * machine.period_s;
    session.follow(
        duration_s,
        |time_s| {
            bursts
                .iter()
                .map(|bursts| sine_bursts::at(bursts, time_s))
                .collect()
        },
        |time_s, axes| {
            for (record, axis) in records.iter_mut().zip(axes) {
                record.rows.push((origin_s + time_s, *axis));
            }
        },
    )
}

/// Writes a record of an axis, and what the dataset is, into its folder. The effort is what a
/// drive's current sensor would show: the active command with the sensor's noise, seeded by the
/// machine. A record that `broke_off` says so in `dataset.toml`.
///
/// # Errors
/// Where the folder cannot be written.
pub fn write_part(
    folder: &Path,
    machine: &Machine,
    axis: &MachineAxis,
    (part, record): (Part, &AxisRecord),
    broke_off: Option<&Failure>,
) -> Outcome<()> {
    std::fs::create_dir_all(folder).map_err(|error| Failure::file(folder, &error))?;
    let text = csv(
        record,
        axis.force_record_noise_n,
        machine.seed.wrapping_add(part.stream()),
    );
    write(&folder.join(part.file()), &text)?;
    let note = broke_off.map_or_else(String::new, |why| {
        format!("# {} broke off: {why}\n", part.file())
    });
    write(
        &folder.join("dataset.toml"),
        &(note + &dataset_toml(machine, axis)),
    )
}

fn csv(record: &AxisRecord, noise_n: f64, seed: u64) -> String {
    let mut noise = ChaCha8Rng::seed_from_u64(seed);
    let mut text = String::from("time_s,reference_m,position_m,load_position_m,force_n\n");
    for (time_s, row) in &record.rows {
        let sample: f64 = StandardNormal.sample(&mut noise);
        let effort = row.force_n + noise_n * sample;
        // Writing to a String cannot fail.
        let _ = writeln!(
            text,
            "{time_s:.6},{:.11},{:.10},{:.9},{effort:.3}",
            row.reference_m, row.motor_m, row.load_m
        );
    }
    text
}

/// What an engineer knows of the axis before it moves: units, encoders, current loop, declared
/// effects. Nothing of the simulator's own.
fn dataset_toml(machine: &Machine, axis: &MachineAxis) -> String {
    let actual = &axis.actual;
    let sensor = match axis.gains.position_sensor {
        PositionSensor::Motor => "motor",
        PositionSensor::Load => "load",
    };
    let declared = axis
        .declared
        .iter()
        .map(|name| format!("\"{name}\""))
        .collect::<Vec<_>>()
        .join(", ");
    format!(
        "name = \"{}-{}\"\nsample_period_s = {}\neffort_hold = \"zero-order\"\ntime_from = \"power-on\"\neffort_lag_s = {}   # current loop, first order\n\n\
         [axis]\nkind = \"linear\"\nlead_m_per_rev = {}\nencoder_resolution_m = {:e}\nload_encoder_resolution_m = {:e}\n\n\
         [controller]\nposition_gain_per_s = {}\nposition_sensor = \"{sensor}\"\n\n[declared]\neffects = [{declared}]\n",
        machine.name,
        axis.name,
        machine.period_s,
        actual.current_loop_time_constant_s,
        actual.lead_m_per_rev,
        actual.lead_m_per_rev / f64::from(actual.motor_encoder_counts_per_rev),
        actual.load_encoder_resolution_m,
        axis.gains.position_gain_per_s,
    )
}
