//! Records of the axes over the bus, as dataset folders that `identify` reads.

use std::fmt::Write as _;
use std::path::Path;

use plant_sim::Machine;
use plant_sim::machine::{MachineAxis, PositionSensor};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};

use crate::error::{Failure, Outcome};
use crate::excitation::{self, Burst};
use crate::master::AxisCycle;
use crate::run::Session;

/// A record of one axis: rows of time, setpoint, motor position, load position, effort.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct AxisRecord {
    /// Rows.
    pub rows: Vec<(f64, AxisCycle)>,
}

/// Moves all axes by their own bursts and records them together.
///
/// # Errors
/// Where a drive faults.
pub fn record(session: &mut Session<'_>, machine: &Machine, validation: bool) -> Outcome<Vec<AxisRecord>> {
    let bursts: Vec<Vec<Burst>> =
        machine.axes.iter().map(|axis| excitation::bursts(&axis.limits, validation)).collect();
    let duration_s = bursts.iter().map(|bursts| excitation::duration_s(bursts)).fold(0.0, f64::max);
    session.go_to(&vec![0.0; machine.axes.len()])?;
    // Times are since the drive was switched on: what warms up does not start cold in the second record.
    let origin_s = session.cycles() as f64 * machine.period_s;
    let mut records = vec![AxisRecord::default(); machine.axes.len()];
    session.follow(
        duration_s,
        |time_s| bursts.iter().map(|bursts| excitation::at(bursts, time_s)).collect(),
        |time_s, axes| {
            for (record, axis) in records.iter_mut().zip(axes) {
                record.rows.push((origin_s + time_s, *axis));
            }
        },
    )?;
    Ok(records)
}

/// Writes the two records of an axis as a dataset folder. The effort is what a drive's current sensor would show: the active command with the
/// sensor's noise, seeded by the machine.
///
/// # Errors
/// Where the folder cannot be written.
pub fn write_dataset(
    folder: &Path,
    machine: &Machine,
    axis: &MachineAxis,
    train: &AxisRecord,
    validate: &AxisRecord,
) -> Outcome<()> {
    std::fs::create_dir_all(folder).map_err(|error| Failure::file(folder, &error))?;
    for (name, record, stream) in [("train.csv", train, 1), ("validate.csv", validate, 2)] {
        let path = folder.join(name);
        let text = csv(record, axis.force_record_noise_n, machine.seed.wrapping_add(stream));
        std::fs::write(&path, text).map_err(|error| Failure::file(&path, &error))?;
    }
    let path = folder.join("dataset.toml");
    std::fs::write(&path, dataset_toml(machine, axis)).map_err(|error| Failure::file(&path, &error))
}

fn csv(record: &AxisRecord, noise_n: f64, seed: u64) -> String {
    let mut noise = ChaCha8Rng::seed_from_u64(seed);
    let mut text = String::from("time_s,reference_m,position_m,load_position_m,force_n\n");
    for (time_s, row) in &record.rows {
        let sample: f64 = StandardNormal.sample(&mut noise);
        let effort = row.force_n + noise_n * sample;
        // Writing to a String cannot fail.
        let _ = writeln!(text, "{time_s:.6},{:.11},{:.10},{:.9},{effort:.3}", row.reference_m, row.motor_m, row.load_m);
    }
    text
}

/// What an engineer knows of the axis before it moves: units, encoders, current loop, declared effects. Nothing of the simulator's own.
fn dataset_toml(machine: &Machine, axis: &MachineAxis) -> String {
    let actual = &axis.actual;
    let sensor = match axis.gains.position_sensor {
        PositionSensor::Motor => "motor",
        PositionSensor::Load => "load",
    };
    let declared = axis.declared.iter().map(|name| format!("\"{name}\"")).collect::<Vec<_>>().join(", ");
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
