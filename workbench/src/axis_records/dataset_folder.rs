//! The folder of a dataset: `train.csv`, `validate.csv`, and `dataset.toml` that says what they
//! are.

use std::fmt::Write as _;
use std::path::Path;

use plant_sim::Machine;
use plant_sim::machine::{MachineAxis, PositionSensor};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};

use super::{AxisRecord, Part};
use crate::error::{Failure, Outcome};
use crate::output_files::{make_folder, write};

/// The dataset of one axis.
#[derive(Clone, Copy, Debug)]
pub struct DatasetFolder<'a> {
    /// Where it lies.
    pub path: &'a Path,
    /// The machine.
    pub machine: &'a Machine,
    /// The axis.
    pub axis: &'a MachineAxis,
}

impl DatasetFolder<'_> {
    /// Writes a record of the axis, and what the dataset is. The effort is what a drive's current
    /// sensor would show: the active command with the sensor's noise, seeded by the machine. A
    /// record that `broke_off` says so in `dataset.toml`.
    ///
    /// # Errors
    /// Where the folder cannot be written.
    pub fn write(
        &self,
        part: Part,
        record: &AxisRecord,
        broke_off: Option<&Failure>,
    ) -> Outcome<()> {
        make_folder(self.path)?;
        let seed = self.machine.seed.wrapping_add(part.stream());
        let text = csv(record, self.axis.force_record_noise_n, seed);
        write(&self.path.join(part.file()), &text)?;
        let note = broke_off.map_or_else(String::new, |why| {
            format!("# {} broke off: {why}\n", part.file())
        });
        let text = note + &dataset_toml(self.machine, self.axis);
        write(&self.path.join("dataset.toml"), &text)
    }
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
    let quoted = axis.declared.iter().map(|name| format!("\"{name}\""));
    let declared = quoted.collect::<Vec<_>>().join(", ");
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
