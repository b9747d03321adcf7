//! Machine files: TOML in SI units, actual and declared effects apart.
//!
//! `docs/machine-files.md` explains every key. Unknown keys, missing keys, wrong types and
//! impossible values are errors that name key and line. An axis may say `like = "X"` and leave out
//! everything else.
//!
//! - `source`: where a key stands, and the error that says it; `forms`: the tables as written,
//!   each quantity with its range; `actual`: what an axis really has, from the vocabulary of
//!   effects; `together`: one axis, and what has to go together across its tables.

use std::path::Path;

use axis_model::EffectName;

use crate::axis::AxisParameters;

mod actual;
mod forms;
mod source;
mod together;

pub use actual::refusal;
pub use forms::{
    ActuatorForm, Bus, EncodersForm, Gains, Geometry, Limits, MechanicsForm, PositionSensor, Timing,
};
pub use source::MachineError;

use forms::FileForm;
use source::{Source, Start};

/// Most axes of a machine: node ids end with a hexadecimal digit.
const MOST_AXES: usize = 16;

/// A machine: its buses, its loop and its axes.
#[derive(Clone, Debug, PartialEq)]
pub struct Machine {
    /// Name.
    pub name: String,
    /// Seed of all noise.
    pub seed: u64,
    /// Frame format and bit rates.
    pub bus: Bus,
    /// Cycle time, s.
    pub period_s: f64,
    /// Axes, in the order of their node ids.
    pub axes: Vec<MachineAxis>,
}

/// An axis as its file describes it.
#[derive(Clone, Debug, PartialEq)]
pub struct MachineAxis {
    /// Name: X, Y, …
    pub name: String,
    /// CAN interface of the axis; axes with the same one share a bus.
    pub interface: Option<String>,
    /// What the axis really is: for the simulator only.
    pub actual: AxisParameters,
    /// Noise of the recorded effort, N.
    pub force_record_noise_n: f64,
    /// Limits.
    pub limits: Limits,
    /// Gains of the drive.
    pub gains: Gains,
    /// How it stands to the others, and how true its scale is.
    pub geometry: Geometry,
    /// What its model says.
    pub declared: Vec<EffectName>,
}

impl Machine {
    /// The built-in reference machine.
    ///
    /// # Panics
    /// Never: the built-in file is checked by a test.
    #[must_use]
    pub fn reference() -> Self {
        Self::parse("built-in reference machine", include_str!("reference.toml"))
            .expect("the built-in machine is valid")
    }

    /// Text of the built-in reference machine, as a file to start from.
    #[must_use]
    pub const fn reference_text() -> &'static str {
        include_str!("reference.toml")
    }

    /// Reads a machine file.
    ///
    /// # Errors
    /// [`MachineError`] with file, line and key.
    pub fn read(path: &Path) -> Result<Self, MachineError> {
        let file = path.display().to_string();
        let text = std::fs::read_to_string(path).map_err(|error| MachineError {
            file: file.clone(),
            line: 0,
            text: format!("cannot read the machine file: {error}; check the path"),
        })?;
        Self::parse(&file, &text)
    }

    /// Parses the text of a machine file; `file` is for the error message.
    ///
    /// # Errors
    /// [`MachineError`] with line and key.
    pub fn parse(file: &str, text: &str) -> Result<Self, MachineError> {
        let source = Source { file, text };
        let form: FileForm = toml::from_str(text).map_err(|error| source.syntax(&error))?;
        source.check(&form.timing)?;
        source.check(&form.bus)?;
        if form.axis.is_empty() || form.axis.len() > MOST_AXES {
            let text = "a machine has 1 to 16 [[axis]] tables";
            return Err(source.error(Start::default(), "axis", text));
        }
        let axes = form.axis.iter();
        Ok(Self {
            name: form.name.clone(),
            seed: form.seed,
            bus: *form.bus.get_ref(),
            period_s: form.timing.get_ref().period_s,
            axes: axes
                .map(|axis| together::axis(source, axis, &form.axis))
                .collect::<Result<_, _>>()?,
        })
    }

    /// Where the first two axes have moved the table, when each is where it says, m: out of square
    /// and by untrue scales. What an instrument at the table sees of a plane.
    #[must_use]
    pub fn in_plane(&self, [x_m, y_m]: [f64; 2]) -> [f64; 2] {
        let of = |place: usize| self.axes.get(place).map(|axis| axis.geometry);
        let [x, y] = [0, 1].map(|place| of(place).unwrap_or_default());
        let stretched = |at_m: f64, own: Geometry| at_m * (1.0 + 1.0e-6 * own.scale_ppm);
        [
            stretched(x_m, x) + y.squareness_rad * y_m,
            stretched(y_m, y) + x.squareness_rad * x_m,
        ]
    }

    /// Format and bit rates as the load computation wants them.
    #[must_use]
    pub const fn bus_format(&self) -> protocol::load::BusFormat {
        match self.bus {
            Bus::Classic { bit_rate } => protocol::load::BusFormat::Classic { bit_rate },
            Bus::Fd {
                nominal_rate,
                data_rate,
            } => protocol::load::BusFormat::Fd {
                nominal_rate,
                data_rate,
            },
        }
    }

    /// Largest number of axes that share one bus; axes without `interface` have a bus of their own
    /// each.
    #[must_use]
    pub fn axes_per_bus(&self) -> u8 {
        let shared = |axis: &MachineAxis| match &axis.interface {
            None => 1,
            name => self
                .axes
                .iter()
                .filter(|other| other.interface == *name)
                .count(),
        };
        u8::try_from(self.axes.iter().map(shared).max().unwrap_or(1)).unwrap_or(u8::MAX)
    }

    /// Computed cyclic load of the fullest bus, per mille.
    #[must_use]
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "period_s is within 0.1 to 20 ms"
    )]
    pub fn bus_load_per_mille(&self) -> u32 {
        let cycle_ns = (self.period_s * 1.0e9).round() as u64;
        protocol::load::cyclic_load_per_mille(self.bus_format(), self.axes_per_bus(), cycle_ns)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::axis::Mounting;
    use crate::brake::BrakeParameters;

    fn error_of(replace: &str, by: &str) -> String {
        let text = Machine::reference_text();
        assert!(text.contains(replace), "{replace}");
        Machine::parse("m.toml", &text.replacen(replace, by, 1))
            .unwrap_err()
            .to_string()
    }

    #[test]
    fn the_reference_machine_has_two_equal_axes_and_half_a_bus_each() {
        let machine = Machine::reference();
        assert_eq!(machine.axes.len(), 2);
        assert_eq!(machine.axes[0].actual, machine.axes[1].actual);
        assert_eq!(
            (machine.axes_per_bus(), machine.bus_load_per_mille()),
            (1, 488)
        );
    }

    #[test]
    fn an_axis_out_of_square_and_a_long_scale_move_the_table_and_are_not_taken_over_by_like() {
        let text = Machine::reference_text().replacen(
            "[[axis]]\nname = \"Y\"",
            "[axis.geometry]\nscale_ppm = 50.0\n\n[[axis]]\nname = \"Y\"",
            1,
        ) + "\n[axis.geometry]\nsquareness_rad = 2.0e-5\n";
        let machine = Machine::parse("m.toml", &text).unwrap();
        let [x_m, y_m] = machine.in_plane([0.1, 0.2]);
        assert!((x_m - (0.1 + 5.0e-6 + 4.0e-6)).abs() < 1.0e-15, "{x_m}");
        assert_eq!(y_m, 0.2);
        let wrong = text.replace("2.0e-5", "2.0");
        let refusal = Machine::parse("m.toml", &wrong).unwrap_err().to_string();
        assert!(refusal.contains("squareness_rad"), "{refusal}");
    }

    #[test]
    fn a_vertical_axis_says_so_in_its_file() {
        let text = Machine::reference_text()
            .replacen(
                "backlash_m = 0.0",
                "backlash_m = 0.0\ngravity_n = -2500.0\nstart_m = 0.1",
                1,
            )
            .replacen(
                "[axis.actuator]",
                "[axis.brake]\nrated_force_n = 4000.0\n[axis.stops]\n[axis.actuator]",
                1,
            );
        let machine = Machine::parse("m.toml", &text).unwrap();
        let mounting = machine.axes[0].actual.mounting;
        let brake = BrakeParameters {
            rated_force_n: 4000.0,
            open_s: 0.030,
            close_s: 0.040,
            rise_s: 0.0,
        };
        assert_eq!(
            (mounting.gravity_n, mounting.start_m, mounting.brake),
            (-2500.0, 0.1, Some(brake))
        );
        assert_eq!(
            mounting.stops.map(|stops| stops.position_m),
            Some(0.255),
            "5 mm behind the travel"
        );
        assert_eq!(machine.axes[1].actual.mounting, mounting, "Y is like X");
        assert_eq!(
            Machine::reference().axes[0].actual.mounting,
            Mounting::default()
        );
    }

    #[test]
    fn a_brake_or_a_stop_that_cannot_be_is_an_error_with_key_and_line() {
        let with = |lines: &str| error_of("[axis.actuator]", &format!("{lines}\n[axis.actuator]"));
        let at = Machine::reference_text()
            .lines()
            .position(|line| line == "[axis.actuator]")
            .unwrap()
            + 1;
        let brake = with("[axis.brake]\nrated_force_n = 0.0");
        assert!(
            brake.starts_with(&format!(
                "m.toml:{}: rated_force_n: must be 0.001 to",
                at + 1
            )),
            "{brake}"
        );
        assert!(
            with("[axis.brake]\nrated_force_n = 1.0\nrise_s = 0.05")
                .contains("rise_s: must be 0 to 0.04")
        );
        assert!(
            with("[axis.brake]\nrated_force_n = 1.0\nopens_s = 0.05")
                .contains("unknown field `opens_s`")
        );
        assert!(with("[axis.brake]").contains("missing field `rated_force_n`"));
        assert!(
            with("[axis.stops]\nstop_stiffness_n_per_m = 1e12")
                .contains(": stop_stiffness_n_per_m: must be 1000")
        );
        assert!(
            error_of("backlash_m = 0.0", "backlash_m = 0.0\nstart_m = 0.3")
                .contains("start_m: must be -0.25")
        );
        assert!(
            error_of("backlash_m = 0.0", "backlash_m = 0.0\ngravity_n = 1e7")
                .contains("gravity_n: must be")
        );
        assert!(
            error_of("1048576", "1048576\nload_zero_m = 1e3")
                .contains("load_zero_m: must be -100 to 100")
        );
    }

    #[test]
    fn errors_name_key_and_line() {
        let line = |needle: &str| {
            Machine::reference_text()
                .lines()
                .position(|line| line.starts_with(needle))
                .unwrap()
                + 1
        };
        let at = line("table_mass_kg");
        assert_eq!(
            error_of("table_mass_kg = 300.0", "table_mass_kg = -3.0"),
            format!(
                "m.toml:{at}: table_mass_kg: must be 0.001 to 1000000 in the unit of its name, got -3"
            )
        );
        assert!(
            error_of("table_mass_kg = 300.0", "table_mass = 300.0")
                .starts_with(&format!("m.toml:{at}: unknown field `table_mass`"))
        );
        assert!(error_of("\"offset\"", "\"ofset\"").contains("unknown effect \"ofset\""));
        assert!(error_of("like = \"X\"", "like = \"Z\"").contains("there is no axis \"Z\""));
        assert!(
            error_of("coulomb_n = 400.0", "coulomb_n = \"400\"").contains("coulomb_n = \"400\"")
        );
    }
}
