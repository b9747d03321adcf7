//! Machine files: TOML in SI units, actual and declared effects apart.
//!
//! `docs/machine-files.md` explains every key. Unknown keys, missing keys, wrong types and
//! impossible values are errors that name key and line. An axis may say `like = "X"` and leave out
//! everything else.

use std::fmt;
use std::ops::Range;
use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::axis::{AxisParameters, Mounting};
use crate::brake::BrakeParameters;
use crate::effects::Effects;
use crate::friction::{Law, Sliding};
use crate::stops::StopsForm;

/// Why a machine file cannot be used.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MachineError {
    /// File name, as the user gave it.
    pub file: String,
    /// Line, counted from 1; 0 where the whole file is meant.
    pub line: usize,
    /// What is wrong, what was wanted, what to do.
    pub text: String,
}

impl fmt::Display for MachineError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.line == 0 {
            write!(f, "{}: {}", self.file, self.text)
        } else {
            write!(f, "{}:{}: {}", self.file, self.line, self.text)
        }
    }
}

impl std::error::Error for MachineError {}

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

/// Frame format and bit rates of the machine's buses.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(tag = "format", rename_all = "kebab-case", deny_unknown_fields)]
pub enum Bus {
    /// Classic CAN.
    Classic {
        /// Bit rate, bit/s.
        bit_rate: u32,
    },
    /// CAN FD with bit rate switching.
    Fd {
        /// Arbitration bit rate, bit/s.
        nominal_rate: u32,
        /// Data bit rate, bit/s.
        data_rate: u32,
    },
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
    /// What its model says.
    pub declared: Vec<String>,
}

/// Limits of an axis.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Limits {
    /// Velocity, m/s.
    pub velocity_m_per_s: f64,
    /// Acceleration, m/s².
    pub acceleration_m_per_s2: f64,
    /// Travel to either side of zero, m.
    pub travel_m: f64,
}

/// Which encoder closes the position loop.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum PositionSensor {
    /// Motor encoder: mechanics outside the loop.
    Motor,
    /// Load scale: mechanics inside the loop.
    Load,
}

/// Gains of the drive in SI units.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Gains {
    /// Which encoder closes the position loop.
    pub position_sensor: PositionSensor,
    /// Kv.
    pub position_gain_per_s: f64,
    /// Bandwidth of the velocity loop: proportional gain = inertia · 2π · this.
    pub velocity_bandwidth_hz: f64,
    /// Corner of the integral part.
    pub velocity_integral_hz: f64,
    /// Share of the new difference quotient in the velocity filter, 0…1.
    pub velocity_filter: f64,
    /// Low-pass on the torque, if any.
    #[serde(default)]
    pub torque_low_pass_hz: Option<f64>,
    /// Notch on the torque, if any.
    #[serde(default)]
    pub torque_notch_hz: Option<f64>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct FileForm {
    name: String,
    #[serde(default)]
    seed: u64,
    bus: Bus,
    #[serde(rename = "loop")]
    timing: Timing,
    axis: Vec<toml::Spanned<AxisForm>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Timing {
    period_s: f64,
}

#[derive(Clone, Deserialize)]
#[serde(deny_unknown_fields)]
struct AxisForm {
    name: String,
    like: Option<String>,
    interface: Option<String>,
    mechanics: Option<MechanicsForm>,
    encoders: Option<EncodersForm>,
    actuator: Option<ActuatorForm>,
    brake: Option<BrakeParameters>,
    stops: Option<StopsForm>,
    limits: Option<Limits>,
    gains: Option<Gains>,
    actual: Option<ActualForm>,
    declared: Option<DeclaredForm>,
    /// What an identification said, for people: with intervals and units. The simulator reads
    /// `actual`.
    #[serde(rename = "identified")]
    _identified: Option<toml::Table>,
}

#[derive(Clone, Deserialize)]
#[serde(deny_unknown_fields)]
struct MechanicsForm {
    lead_m_per_rev: f64,
    motor_inertia_kg: f64,
    table_mass_kg: f64,
    screw_stiffness_n_per_m: f64,
    screw_damping_n_s_per_m: f64,
    backlash_m: f64,
    #[serde(default)]
    gravity_n: f64,
    #[serde(default)]
    start_m: f64,
}

#[derive(Clone, Deserialize)]
#[serde(deny_unknown_fields)]
struct EncodersForm {
    motor_counts_per_rev: u32,
    load_resolution_m: f64,
    #[serde(default)]
    motor_zero_m: f64,
    #[serde(default)]
    load_zero_m: f64,
}

#[derive(Clone, Deserialize)]
#[serde(deny_unknown_fields)]
struct ActuatorForm {
    current_loop_time_constant_s: f64,
    force_limit_n: f64,
    force_noise_n: f64,
    force_record_noise_n: f64,
}

#[derive(Clone, Deserialize)]
#[serde(deny_unknown_fields)]
struct ActualForm {
    sliding: Sliding,
    friction: Law,
    #[serde(default)]
    effects: Effects,
}

#[derive(Clone, Deserialize)]
#[serde(deny_unknown_fields)]
struct DeclaredForm {
    effects: Vec<String>,
}

/// Longest control cycle of a machine file.
const LONGEST_PERIOD_S: f64 = 0.02;

/// Names that `[axis.declared] effects` may list.
pub const DECLARABLE: [&str; 17] = [
    "inertia",
    "viscous",
    "coulomb",
    "offset",
    "coulomb_asymmetry",
    "viscous_asymmetry",
    "stribeck",
    "presliding",
    "backlash",
    "compliance",
    "torque_ripple",
    "pitch_error",
    "position_dependent_friction",
    "friction_drift",
    "quadratic_drag",
    "torque_saturation",
    "delay",
];

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
        let everywhere = 0..text.len();
        source.range(
            &everywhere,
            "period_s",
            form.timing.period_s,
            1.0e-4,
            LONGEST_PERIOD_S,
        )?;
        if form.axis.is_empty() || form.axis.len() > 16 {
            return Err(source.error(&everywhere, "axis", "a machine has 1 to 16 [[axis]] tables"));
        }
        let axes = form
            .axis
            .iter()
            .map(|axis| source.axis(axis, &form.axis))
            .collect::<Result<_, _>>()?;
        source.bus(&everywhere, form.bus)?;
        Ok(Self {
            name: form.name,
            seed: form.seed,
            bus: form.bus,
            period_s: form.timing.period_s,
            axes,
        })
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

struct Source<'a> {
    file: &'a str,
    text: &'a str,
}

impl Source<'_> {
    fn syntax(&self, error: &toml::de::Error) -> MachineError {
        let line = error.span().map_or(0, |span| self.line(span.start));
        let text = error.message().replace('\n', ", ");
        let shown = self
            .text
            .lines()
            .nth(line.saturating_sub(1))
            .unwrap_or("")
            .trim();
        let at = if shown.is_empty() {
            String::new()
        } else {
            format!(" at `{shown}`")
        };
        MachineError {
            file: self.file.into(),
            line,
            text: format!("{text}{at}; see docs/machine-files.md"),
        }
    }

    fn line(&self, offset: usize) -> usize {
        self.text
            .get(..offset)
            .map_or(0, |before| before.matches('\n').count() + 1)
    }

    /// An error at the line of a key within a part of the file.
    fn error(&self, part: &Range<usize>, key: &str, text: impl Into<String>) -> MachineError {
        let lines = self
            .text
            .get(part.clone())
            .unwrap_or("")
            .lines()
            .enumerate();
        let starts = |line: &str| {
            line.trim_start()
                .strip_prefix(key)
                .is_some_and(|rest| rest.trim_start().starts_with('='))
        };
        let within = lines
            .into_iter()
            .find(|(_, line)| starts(line))
            .map_or(0, |(line, _)| line);
        MachineError {
            file: self.file.into(),
            line: self.line(part.start) + within,
            text: format!("{key}: {}", text.into()),
        }
    }

    fn range(
        &self,
        part: &Range<usize>,
        key: &str,
        value: f64,
        min: f64,
        max: f64,
    ) -> Result<(), MachineError> {
        if value >= min && value <= max {
            return Ok(());
        }
        Err(self.error(
            part,
            key,
            format!("must be {min} to {max} in the unit of its name, got {value}"),
        ))
    }

    fn bus(&self, part: &Range<usize>, bus: Bus) -> Result<(), MachineError> {
        let rates = match bus {
            Bus::Classic { bit_rate } => vec![("bit_rate", bit_rate, 1_000_000)],
            Bus::Fd {
                nominal_rate,
                data_rate,
            } => {
                vec![
                    ("nominal_rate", nominal_rate, 1_000_000),
                    ("data_rate", data_rate, 8_000_000),
                ]
            }
        };
        rates.into_iter().try_for_each(|(key, rate, max)| {
            self.range(part, key, f64::from(rate), 10_000.0, f64::from(max))
        })
    }

    fn axis(
        &self,
        axis: &toml::Spanned<AxisForm>,
        all: &[toml::Spanned<AxisForm>],
    ) -> Result<MachineAxis, MachineError> {
        let part = &axis.span();
        let own = axis.get_ref();
        let model = match &own.like {
            None => own.clone(),
            Some(like) => self.modelled(part, own, like, all)?,
        };
        let part = &self.span_of(own.like.as_ref(), part, all);
        let missing = |key: &str| {
            self.error(
                part,
                "name",
                format!("axis {} lacks [axis.{key}]", own.name),
            )
        };
        let mechanics = model.mechanics.ok_or_else(|| missing("mechanics"))?;
        let encoders = model.encoders.ok_or_else(|| missing("encoders"))?;
        let actuator = model.actuator.ok_or_else(|| missing("actuator"))?;
        let actual = model
            .actual
            .ok_or_else(|| missing("actual.sliding] and [axis.actual.friction"))?;
        let limits = model.limits.ok_or_else(|| missing("limits"))?;
        let gains = model.gains.ok_or_else(|| missing("gains"))?;
        let declared = model.declared.ok_or_else(|| missing("declared"))?;
        self.check_mechanics(part, &mechanics)?;
        self.check_actual(part, &actual)?;
        self.check_drive(part, &encoders, &actuator, &limits, &gains)?;
        self.check_sub_step(part, &mechanics, &actual.friction)?;
        self.check_increments(part, &mechanics, &encoders, &limits)?;
        let mounting = self.mounting(
            part,
            &mechanics,
            &encoders,
            &limits,
            (model.brake, model.stops),
        )?;
        self.check_declared(part, &declared)?;
        Ok(MachineAxis {
            name: own.name.clone(),
            interface: own.interface.clone(),
            actual: parameters(&mechanics, &encoders, &actuator, actual, mounting),
            force_record_noise_n: actuator.force_record_noise_n,
            limits,
            gains,
            declared: declared.effects,
        })
    }

    fn modelled(
        &self,
        part: &Range<usize>,
        own: &AxisForm,
        like: &str,
        all: &[toml::Spanned<AxisForm>],
    ) -> Result<AxisForm, MachineError> {
        let model = all
            .iter()
            .map(toml::Spanned::get_ref)
            .find(|axis| axis.name == like && axis.like.is_none());
        let Some(model) = model else {
            return Err(self.error(
                part,
                "like",
                format!("there is no axis \"{like}\" with tables of its own"),
            ));
        };
        let own = own.clone();
        Ok(AxisForm {
            mechanics: own.mechanics.or_else(|| model.mechanics.clone()),
            encoders: own.encoders.or_else(|| model.encoders.clone()),
            actuator: own.actuator.or_else(|| model.actuator.clone()),
            brake: own.brake.or(model.brake),
            stops: own.stops.or(model.stops),
            limits: own.limits.or(model.limits),
            gains: own.gains.or(model.gains),
            actual: own.actual.or_else(|| model.actual.clone()),
            declared: own.declared.or_else(|| model.declared.clone()),
            ..own
        })
    }

    /// Part of the file in which to look for a key: from the axis (or its model) to the next
    /// `[[axis]]`.
    fn span_of(
        &self,
        like: Option<&String>,
        own: &Range<usize>,
        all: &[toml::Spanned<AxisForm>],
    ) -> Range<usize> {
        let model = all.iter().find(|axis| Some(&axis.get_ref().name) == like);
        let start = model.map_or(own.start, |axis| axis.span().start);
        let end = self
            .text
            .get(start + 1..)
            .and_then(|rest| rest.find("[[axis]]"))
            .map_or(self.text.len(), |at| start + 1 + at);
        start..end
    }

    fn check_mechanics(
        &self,
        part: &Range<usize>,
        form: &MechanicsForm,
    ) -> Result<(), MachineError> {
        self.range(part, "lead_m_per_rev", form.lead_m_per_rev, 1.0e-4, 1.0)?;
        self.range(
            part,
            "motor_inertia_kg",
            form.motor_inertia_kg,
            1.0e-3,
            1.0e6,
        )?;
        self.range(part, "table_mass_kg", form.table_mass_kg, 1.0e-3, 1.0e6)?;
        self.range(
            part,
            "screw_stiffness_n_per_m",
            form.screw_stiffness_n_per_m,
            1.0e4,
            1.0e12,
        )?;
        self.range(
            part,
            "screw_damping_n_s_per_m",
            form.screw_damping_n_s_per_m,
            0.0,
            1.0e7,
        )?;
        self.range(part, "backlash_m", form.backlash_m, 0.0, 0.01)
    }

    fn check_actual(&self, part: &Range<usize>, form: &ActualForm) -> Result<(), MachineError> {
        let sliding = &form.sliding;
        self.range(part, "coulomb_n", sliding.coulomb_n, 0.0, 1.0e6)?;
        self.range(part, "static_n", sliding.static_n, sliding.coulomb_n, 1.0e6)?;
        self.range(
            part,
            "stribeck_velocity_m_per_s",
            sliding.stribeck_velocity_m_per_s,
            1.0e-6,
            1.0,
        )?;
        self.range(
            part,
            "viscous_n_s_per_m",
            sliding.viscous_n_s_per_m,
            0.0,
            1.0e7,
        )?;
        self.range(
            part,
            "coulomb_asymmetry",
            sliding.coulomb_asymmetry,
            -0.9,
            0.9,
        )?;
        self.range(
            part,
            "viscous_asymmetry",
            sliding.viscous_asymmetry,
            -0.9,
            0.9,
        )?;
        self.range(
            part,
            "quadratic_drag_n_s2_per_m2",
            sliding.quadratic_drag_n_s2_per_m2,
            0.0,
            1.0e7,
        )?;
        self.check_effects(part, &form.effects)?;
        match &form.friction {
            Law::Coulomb => Ok(()),
            Law::LuGre {
                bristle_stiffness_n_per_m,
                bristle_damping_n_s_per_m,
            } => {
                self.range(part, "coulomb_n", sliding.coulomb_n, 1.0e-3, 1.0e6)?;
                self.range(
                    part,
                    "bristle_stiffness_n_per_m",
                    *bristle_stiffness_n_per_m,
                    1.0e3,
                    1.0e12,
                )?;
                self.range(
                    part,
                    "bristle_damping_n_s_per_m",
                    *bristle_damping_n_s_per_m,
                    0.0,
                    1.0e7,
                )
            }
            Law::MaxwellSlip {
                stiffness_n_per_m,
                share,
            } => self.check_maxwell(part, stiffness_n_per_m, share),
        }
    }

    fn check_effects(&self, part: &Range<usize>, effects: &Effects) -> Result<(), MachineError> {
        self.range(part, "delay_s", effects.delay_s, 0.0, 1.0e-3)?;
        self.range(part, "offset_n", effects.offset_n, -1.0e6, 1.0e6)?;
        self.range(
            part,
            "torque_saturation_per_n",
            effects.torque_saturation_per_n,
            0.0,
            1.0,
        )?;
        self.range(
            part,
            "position_dependent_friction_per_m",
            effects.position_dependent_friction_per_m,
            -100.0,
            100.0,
        )?;
        if let Some(ripple) = effects.torque_ripple {
            self.range(part, "torque_ripple", ripple.amplitude_n, 0.0, 1.0e6)?;
            self.range(part, "torque_ripple", ripple.order_per_rev, 1.0e-3, 1.0e4)?;
            self.range(part, "torque_ripple", ripple.phase_rad, -1.0e3, 1.0e3)?;
        }
        if let Some(pitch) = effects.pitch_error {
            self.range(part, "pitch_error", pitch.amplitude_m, 0.0, 1.0e-3)?;
            self.range(part, "pitch_error", pitch.period_m, 1.0e-5, 10.0)?;
        }
        if let Some(drift) = effects.friction_drift {
            self.range(part, "friction_drift", drift.gain, -0.9, 10.0)?;
            self.range(part, "friction_drift", drift.time_constant_s, 1.0e-3, 1.0e6)?;
        }
        Ok(())
    }

    /// The sub-step has to resolve the fastest vibration: ω · dt below one half.
    fn check_sub_step(
        &self,
        part: &Range<usize>,
        mechanics: &MechanicsForm,
        friction: &Law,
    ) -> Result<(), MachineError> {
        let (m1, m2) = (mechanics.motor_inertia_kg, mechanics.table_mass_kg);
        let bristles = match friction {
            Law::Coulomb => 0.0,
            Law::LuGre {
                bristle_stiffness_n_per_m,
                ..
            } => *bristle_stiffness_n_per_m,
            Law::MaxwellSlip {
                stiffness_n_per_m, ..
            } => stiffness_n_per_m.iter().sum(),
        };
        let stiffest =
            |mass: f64| 0.25 * mass / (crate::axis::SUB_STEP_S * crate::axis::SUB_STEP_S);
        let screw = stiffest(m1 * m2 / (m1 + m2));
        if mechanics.screw_stiffness_n_per_m > screw {
            return Err(self.error(
                part,
                "screw_stiffness_n_per_m",
                format!(
                    "with these masses the simulation resolves at most {screw:.3e} N/m, got {:.3e}",
                    mechanics.screw_stiffness_n_per_m
                ),
            ));
        }
        if bristles > stiffest(m2) {
            return Err(self.error(
                part,
                "law",
                format!("with this table mass the simulation resolves friction stiffness up to {:.3e} N/m, got {bristles:.3e}", stiffest(m2)),
            ));
        }
        Ok(())
    }

    /// The feedback carries the low 32 bits of the increments and the drive unwraps them: one cycle
    /// at the velocity limit, 20 ms at most, has to stay below half of that.
    fn check_increments(
        &self,
        part: &Range<usize>,
        mechanics: &MechanicsForm,
        encoders: &EncodersForm,
        limits: &Limits,
    ) -> Result<(), MachineError> {
        let counts_per_m = f64::from(encoders.motor_counts_per_rev) / mechanics.lead_m_per_rev;
        let increments = limits.velocity_m_per_s * LONGEST_PERIOD_S * counts_per_m;
        if increments < f64::from(i32::MAX) {
            return Ok(());
        }
        Err(self.error(
            part,
            "motor_counts_per_rev",
            format!("{increments:.3e} increments in 20 ms at the velocity limit: the drive cannot unwrap the 32 bits of the feedback"),
        ))
    }

    fn mounting(
        &self,
        part: &Range<usize>,
        mechanics: &MechanicsForm,
        encoders: &EncodersForm,
        limits: &Limits,
        (brake, stops): (Option<BrakeParameters>, Option<StopsForm>),
    ) -> Result<Mounting, MachineError> {
        self.range(part, "gravity_n", mechanics.gravity_n, -1.0e6, 1.0e6)?;
        self.range(
            part,
            "start_m",
            mechanics.start_m,
            -limits.travel_m,
            limits.travel_m,
        )?;
        self.range(part, "motor_zero_m", encoders.motor_zero_m, -100.0, 100.0)?;
        self.range(part, "load_zero_m", encoders.load_zero_m, -100.0, 100.0)?;
        brake.map_or(Ok(()), |brake| self.check_brake(part, &brake))?;
        stops.map_or(Ok(()), |stops| {
            self.check_stops(part, &stops, mechanics, limits)
        })?;
        Ok(Mounting {
            gravity_n: mechanics.gravity_n,
            brake,
            stops: stops.map(|form| form.stops(limits.travel_m)),
            start_m: mechanics.start_m,
            motor_zero_m: encoders.motor_zero_m,
            load_zero_m: encoders.load_zero_m,
        })
    }

    fn check_brake(
        &self,
        part: &Range<usize>,
        brake: &BrakeParameters,
    ) -> Result<(), MachineError> {
        self.range(part, "rated_force_n", brake.rated_force_n, 1.0e-3, 1.0e6)?;
        self.range(part, "open_s", brake.open_s, 0.0, 1.0)?;
        self.range(part, "close_s", brake.close_s, 0.0, 1.0)?;
        self.range(part, "rise_s", brake.rise_s, 0.0, brake.close_s)
    }

    /// The sub-step has to resolve the stop as well: ω · dt below one half, and no more than half
    /// of the velocity damped away in one.
    fn check_stops(
        &self,
        part: &Range<usize>,
        form: &StopsForm,
        mechanics: &MechanicsForm,
        limits: &Limits,
    ) -> Result<(), MachineError> {
        let (mass, dt_s) = (mechanics.table_mass_kg, crate::axis::SUB_STEP_S);
        self.range(
            part,
            "stop_m",
            form.position_m(limits.travel_m),
            mechanics.start_m.abs(),
            10.1,
        )?;
        let stiffest = 0.25 * mass / (dt_s * dt_s);
        self.range(
            part,
            "stop_stiffness_n_per_m",
            form.stop_stiffness_n_per_m,
            1.0e3,
            stiffest,
        )?;
        self.range(
            part,
            "stop_damping_n_s_per_m",
            form.stop_damping_n_s_per_m,
            0.0,
            0.5 * mass / dt_s,
        )
    }

    fn check_maxwell(
        &self,
        part: &Range<usize>,
        stiffness: &[f64],
        share: &[f64],
    ) -> Result<(), MachineError> {
        if stiffness.is_empty() || stiffness.len() != share.len() {
            return Err(self.error(
                part,
                "share",
                "must have as many elements as stiffness_n_per_m, at least one",
            ));
        }
        if (share.iter().sum::<f64>() - 1.0).abs() > 1.0e-6
            || share.iter().any(|share| *share <= 0.0)
        {
            return Err(self.error(part, "share", "the shares must be positive and add up to 1"));
        }
        stiffness
            .iter()
            .try_for_each(|k| self.range(part, "stiffness_n_per_m", *k, 1.0e3, 1.0e12))
    }

    fn check_drive(
        &self,
        part: &Range<usize>,
        encoders: &EncodersForm,
        actuator: &ActuatorForm,
        limits: &Limits,
        gains: &Gains,
    ) -> Result<(), MachineError> {
        self.range(
            part,
            "motor_counts_per_rev",
            f64::from(encoders.motor_counts_per_rev),
            100.0,
            1.0e8,
        )?;
        self.range(
            part,
            "load_resolution_m",
            encoders.load_resolution_m,
            1.0e-10,
            1.0e-4,
        )?;
        self.range(
            part,
            "current_loop_time_constant_s",
            actuator.current_loop_time_constant_s,
            0.0,
            0.01,
        )?;
        self.range(part, "force_limit_n", actuator.force_limit_n, 1.0e-3, 1.0e6)?;
        self.range(
            part,
            "force_noise_n",
            actuator.force_noise_n,
            0.0,
            actuator.force_limit_n,
        )?;
        self.range(
            part,
            "force_record_noise_n",
            actuator.force_record_noise_n,
            0.0,
            actuator.force_limit_n,
        )?;
        self.range(
            part,
            "velocity_m_per_s",
            limits.velocity_m_per_s,
            1.0e-4,
            5.0,
        )?;
        self.range(
            part,
            "acceleration_m_per_s2",
            limits.acceleration_m_per_s2,
            1.0e-3,
            200.0,
        )?;
        self.range(part, "travel_m", limits.travel_m, 1.0e-3, 10.0)?;
        self.range(
            part,
            "position_gain_per_s",
            gains.position_gain_per_s,
            0.0,
            1000.0,
        )?;
        self.range(
            part,
            "velocity_bandwidth_hz",
            gains.velocity_bandwidth_hz,
            0.1,
            1000.0,
        )?;
        self.range(
            part,
            "velocity_integral_hz",
            gains.velocity_integral_hz,
            0.0,
            500.0,
        )?;
        self.range(part, "velocity_filter", gains.velocity_filter, 0.01, 1.0)
    }

    fn check_declared(&self, part: &Range<usize>, form: &DeclaredForm) -> Result<(), MachineError> {
        match form
            .effects
            .iter()
            .find(|name| !DECLARABLE.contains(&name.as_str()))
        {
            None => Ok(()),
            Some(name) => Err(self.error(
                part,
                "effects",
                format!(
                    "unknown effect \"{name}\"; known: {}",
                    DECLARABLE.join(", ")
                ),
            )),
        }
    }
}

fn parameters(
    mechanics: &MechanicsForm,
    encoders: &EncodersForm,
    actuator: &ActuatorForm,
    actual: ActualForm,
    mounting: Mounting,
) -> AxisParameters {
    AxisParameters {
        mechanics: crate::mechanics::Mechanics {
            motor_inertia_kg: mechanics.motor_inertia_kg,
            table_mass_kg: mechanics.table_mass_kg,
            screw_stiffness_n_per_m: mechanics.screw_stiffness_n_per_m,
            screw_damping_n_s_per_m: mechanics.screw_damping_n_s_per_m,
            backlash_m: mechanics.backlash_m,
        },
        lead_m_per_rev: mechanics.lead_m_per_rev,
        sliding: actual.sliding,
        law: actual.friction,
        effects: actual.effects,
        motor_encoder_counts_per_rev: encoders.motor_counts_per_rev,
        load_encoder_resolution_m: encoders.load_resolution_m,
        current_loop_time_constant_s: actuator.current_loop_time_constant_s,
        force_limit_n: actuator.force_limit_n,
        force_noise_n: actuator.force_noise_n,
        mounting,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
