//! The folder of a dataset: `train.csv`, `validate.csv`, and `dataset.toml` that says what they
//! are.

use std::f64::consts::TAU;
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

/// What an engineer knows of the axis before it moves: units, encoders, current loop, the
/// controller that is downloaded, declared effects. Nothing of the simulator's own.
fn dataset_toml(machine: &Machine, axis: &MachineAxis) -> String {
    let actual = &axis.actual;
    let controller = controller_toml(axis);
    let quoted = axis.declared.iter().map(|name| format!("\"{name}\""));
    let declared = quoted.collect::<Vec<_>>().join(", ");
    format!(
        "name = \"{}-{}\"\nsample_period_s = {}\neffort_hold = \"zero-order\"\ntime_from = \"power-on\"\neffort_lag_s = {}   # current loop, first order\n\n\
         [axis]\nkind = \"linear\"\nlead_m_per_rev = {}\nencoder_resolution_m = {:e}\nload_encoder_resolution_m = {:e}\n\n\
         {controller}\n[declared]\neffects = [{declared}]\n",
        machine.name,
        axis.name,
        machine.period_s,
        actual.current_loop_time_constant_s,
        actual.lead_m_per_rev,
        actual.lead_m_per_rev / f64::from(actual.motor_encoder_counts_per_rev),
        actual.load_encoder_resolution_m,
    )
}

/// The controller that the drive gets: its velocity loop takes the motor's velocity, and its
/// feedforward the inertia that the drive is told.
fn controller_toml(axis: &MachineAxis) -> String {
    let gains = &axis.gains;
    let sensor = match gains.position_sensor {
        PositionSensor::Motor => "motor",
        PositionSensor::Load => "load",
    };
    let inertia_kg = axis.actual.inertia().inertia;
    format!(
        "[controller]\nposition_gain_per_s = {}\nvelocity_gain_n_s_per_m = {}\nintegral_per_s = {}\nvelocity_filter = {}\n\
         acceleration_feedforward_kg = {inertia_kg}\nposition_sensor = \"{sensor}\"\nvelocity_sensor = \"motor\"\n",
        gains.position_gain_per_s,
        TAU * gains.velocity_bandwidth_hz * inertia_kg,
        TAU * gains.velocity_integral_hz,
        gains.velocity_filter,
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::network::master::AxisCycle;

    fn record() -> AxisRecord {
        let row = |i: u32| (1.0e-3 * f64::from(i), AxisCycle::default());
        AxisRecord {
            rows: (0..100).map(row).collect(),
        }
    }

    fn written(part: Part, broke_off: Option<&Failure>) -> (String, String) {
        let machine = Machine::reference();
        let path = tempfile::tempdir().unwrap();
        let folder = DatasetFolder {
            path: path.path(),
            machine: &machine,
            axis: &machine.axes[0],
        };
        folder.write(part, &record(), broke_off).unwrap();
        let read = |name: &str| std::fs::read_to_string(path.path().join(name)).unwrap();
        (read(part.file()), read("dataset.toml"))
    }

    #[test]
    fn the_noise_of_a_part_is_its_own_and_comes_again_with_the_same_seed() {
        let (train, _) = written(Part::Train, None);
        assert_eq!(train.lines().count(), 101);
        assert_eq!(train, written(Part::Train, None).0);
        assert_ne!(train, written(Part::Validate, None).0);
    }

    #[test]
    fn a_dataset_carries_the_gains_that_the_drive_gets() {
        let (_, toml) = written(Part::Train, None);
        let form: toml::Table = toml.parse().unwrap();
        let controller = &form["controller"];
        let (axis, number) = (&Machine::reference().axes[0], |key: &str| {
            let value = &controller[key];
            let whole = value.as_integer().map(|whole| f64::from(whole as i32));
            value.as_float().or(whole).unwrap()
        });
        let (gains, kg) = (&axis.gains, axis.actual.inertia().inertia);
        for (key, wanted) in [
            ("position_gain_per_s", gains.position_gain_per_s),
            (
                "velocity_gain_n_s_per_m",
                TAU * gains.velocity_bandwidth_hz * kg,
            ),
            ("integral_per_s", TAU * gains.velocity_integral_hz),
            ("velocity_filter", gains.velocity_filter),
            ("acceleration_feedforward_kg", kg),
        ] {
            assert!((number(key) / wanted - 1.0).abs() < 1.0e-12, "{key}");
        }
        assert_eq!(controller["velocity_sensor"].as_str(), Some("motor"));
    }

    #[test]
    fn a_dataset_says_that_its_record_broke_off_and_is_a_dataset_all_the_same() {
        let why = Failure::new("axis Y: no torque");
        let (_, toml) = written(Part::Train, Some(&why));
        assert!(
            toml.starts_with("# train.csv broke off: axis Y: no torque\n"),
            "{toml}"
        );
        let form: toml::Table = toml.parse().unwrap();
        assert_eq!(form["effort_hold"].as_str(), Some("zero-order"));
    }
}
