//! Compensation files: what `tune` and `commission` write and `circle` and the drive read.

mod adaptive;

use std::ops::RangeInclusive;
use std::path::Path;

use serde::{Deserialize, Serialize};
use servo::objects::Parameter;

use crate::error::{Failure, Outcome};
pub use adaptive::{Adaptive, POINTS};

/// Elements of the drive's friction model.
pub const ELEMENTS: usize = Parameter::FRICTION_LEVELS.len();
/// Speeds at which the drive has a factor on the levels.
pub const LEVELS: usize = Parameter::LEVEL_FACTORS.len();

/// What the drive can hold of a slope of the level, per m.
pub const SLOPES_PER_M: RangeInclusive<f64> = -700.0..=700.0;
/// And of its bend, per m².
pub const BENDS_PER_M2: RangeInclusive<f64> = -2000.0..=2000.0;
/// And of the share by which ways are longer one way, shorter the other.
pub const WAY_ASYMMETRIES: RangeInclusive<f64> = -0.9..=0.9;
/// And of a gap, m.
pub const GAPS_M: RangeInclusive<f64> = 0.0..=1.0e-3;
/// And of the period of a ripple, m.
pub const PERIODS_M: RangeInclusive<f64> = 1.0e-6..=0.2;
/// Ways after which an element may slip, m.
pub(crate) const SHORTEST_SLIP_M: f64 = 1.0e-9;
pub(crate) const LONGEST_SLIP_M: f64 = 1.0e-3;

/// The paper's pulse in SI units.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Pulse {
    /// Δn, as a velocity at the table.
    pub height_m_per_s: f64,
    /// `T_comp`.
    pub time_constant_s: f64,
    /// Time from the reversal to the start of the pulse.
    pub start_delay_s: f64,
}

impl Pulse {
    /// No pulse.
    pub const OFF: Self = Self {
        height_m_per_s: 0.0,
        time_constant_s: 0.0,
        start_delay_s: 0.0,
    };
}

/// Friction as the drive's model has it, in SI units at the table.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Model {
    /// Levels at which the elements slip, N.
    pub level_n: [f64; ELEMENTS],
    /// Ways after which they slip, m.
    pub slip_m: [f64; ELEMENTS],
    /// Shares of them that are of the motor's own side, which winds nothing up.
    #[serde(default)]
    pub motor_share: [f64; ELEMENTS],
    /// Factors on the levels at speeds from standstill to the span.
    pub factor: [f64; LEVELS],
    /// Speed of the last factor.
    pub span_m_per_s: f64,
    /// Factors come within this way; zero: at once.
    pub lag_m: f64,
    /// Factors come within this time; zero: at once.
    pub lag_s: f64,
    /// Viscous friction.
    pub viscous_n_s_per_m: f64,
    /// Stiffness of the screw that friction of the table winds up.
    pub stiffness_n_per_m: f64,
    /// Gap behind the motor, m; zero: none.
    #[serde(default)]
    pub gap_m: f64,
    /// Force within which it is crossed, to either side.
    #[serde(default = "crossing_force_n")]
    pub gap_force_n: f64,
    /// Velocity from which on it is that force; in proportion below, an eighth at least. Zero:
    /// always.
    #[serde(default)]
    pub gap_velocity_m_per_s: f64,
    /// What of the inertia is behind the gap.
    #[serde(default)]
    pub table_mass_kg: f64,
    /// Constant force behind it, as a weight.
    #[serde(default)]
    pub table_force_n: f64,
    /// What of the inertia is the motor's.
    pub motor_inertia_kg: f64,
    /// From the begin of its cycle until the torque acts as friction does.
    pub ahead_s: f64,
    /// Damping of presliding over its stiffness.
    pub damping_s: f64,
    /// The wind-up of the screw is so far ahead of friction.
    pub windup_ahead_s: f64,
    /// Levels change along the travel by this share of that at position zero, per way from there.
    #[serde(default)]
    pub slope_per_m: f64,
    /// And by this per square of that way.
    #[serde(default)]
    pub bend_per_m2: f64,
    /// Share of what each turn tells that the drive refines the levels by; zero: it does not.
    #[serde(default)]
    pub self_tuning: f64,
    /// How much more viscous friction there is forward than backward, halved.
    #[serde(default)]
    pub viscous_asymmetry_n_s_per_m: f64,
    /// How much higher levels are forward than backward, halved.
    #[serde(default)]
    pub level_asymmetry_n: f64,
    /// By which share elements slip after a longer way forward, and after a shorter one backward.
    #[serde(default)]
    pub way_asymmetry: f64,
    /// Ripple of the force.
    #[serde(default)]
    pub ripple: [Ripple; RIPPLES],
}

/// A force within which a gap is crossed, where no file says otherwise.
const fn crossing_force_n() -> f64 {
    50.0
}

/// Waves of the force over the position that the drive has.
pub const RIPPLES: usize = Parameter::RIPPLES.len();

/// `A sin(2π x / period + phase)`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Ripple {
    /// Amplitude; zero: none.
    pub amplitude_n: f64,
    /// Way from one period to the next.
    pub period_m: f64,
    /// Phase at position zero, of a turn.
    pub phase_turns: f64,
}

impl Ripple {
    /// None.
    pub const NONE: Self = Self {
        amplitude_n: 0.0,
        period_m: 0.010,
        phase_turns: 0.0,
    };
}

impl Default for Ripple {
    fn default() -> Self {
        Self::NONE
    }
}

/// Share with which drives refine themselves: five sixths of what a level is off by are gone after
/// five turns, and a turn that noise makes wrong by a percent makes the level so by a third of it.
pub const SELF_TUNING: f64 = 0.3;

impl Model {
    /// Level of sliding friction, N.
    #[must_use]
    pub fn level_n(&self) -> f64 {
        self.level_n.iter().sum()
    }

    /// Share of that which is of the motor's own side.
    #[must_use]
    pub fn on_motor(&self) -> f64 {
        let pairs = self.level_n.iter().zip(&self.motor_share);
        let motor_n: f64 = pairs.map(|(level_n, share)| level_n * share).sum();
        if motor_n > 0.0 {
            motor_n / self.level_n()
        } else {
            0.0
        }
    }

    /// The same with all levels times a factor, and springs as stiff as before.
    #[must_use]
    pub fn times(&self, factor: f64) -> Self {
        let slip_m = |slip_m: f64| (factor * slip_m).clamp(SHORTEST_SLIP_M, LONGEST_SLIP_M);
        Self {
            level_n: self.level_n.map(|level_n| factor * level_n),
            slip_m: self.slip_m.map(slip_m),
            level_asymmetry_n: factor * self.level_asymmetry_n,
            gap_force_n: (factor * self.gap_force_n).max(1.0),
            ..*self
        }
    }

    /// Level of the table's friction.
    #[must_use]
    pub fn table_n(&self) -> f64 {
        let of_table = self.level_n.iter().zip(&self.motor_share);
        of_table
            .map(|(level_n, motor)| level_n * (1.0 - motor))
            .sum()
    }

    /// A model that says nothing.
    pub const OFF: Self = Self {
        level_n: [0.0; ELEMENTS],
        slip_m: [1.0e-5; ELEMENTS],
        motor_share: [0.0; ELEMENTS],
        factor: [1.0; LEVELS],
        span_m_per_s: 0.0,
        lag_m: 0.0,
        lag_s: 0.0,
        viscous_n_s_per_m: 0.0,
        stiffness_n_per_m: f64::INFINITY,
        gap_m: 0.0,
        gap_force_n: crossing_force_n(),
        gap_velocity_m_per_s: 0.0,
        table_mass_kg: 0.0,
        table_force_n: 0.0,
        motor_inertia_kg: 0.0,
        ahead_s: 0.0,
        damping_s: 0.0,
        windup_ahead_s: 0.0,
        slope_per_m: 0.0,
        bend_per_m2: 0.0,
        self_tuning: 0.0,
        viscous_asymmetry_n_s_per_m: 0.0,
        level_asymmetry_n: 0.0,
        way_asymmetry: 0.0,
        ripple: [Ripple::NONE; RIPPLES],
    };
}

/// What the drive does about reversals.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(tag = "method", rename_all = "kebab-case", deny_unknown_fields)]
pub enum Compensation {
    /// Velocity and acceleration feedforward only.
    #[default]
    None,
    /// A force in the commanded direction.
    Coulomb {
        /// The force, N.
        force_n: f64,
    },
    /// The paper's pulse on the speed setpoint.
    Pulse(Pulse),
    /// That pulse over the acceleration at the reversal.
    Adaptive(Box<Adaptive>),
    /// A model of the friction, and of what it does to the screw.
    Model(Box<Model>),
}

/// Compensation of one axis.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AxisCompensation {
    /// Reversal compensation.
    pub reversal: Compensation,
    /// Gap to compensate on the setpoint, m; zero for none.
    #[serde(default)]
    pub backlash_m: f64,
}

/// The same with models that the drives refine; `None` where no axis has a model.
#[must_use]
pub fn self_tuning(axes: &[AxisCompensation]) -> Option<Vec<AxisCompensation>> {
    let is_model = |axis: &AxisCompensation| matches!(axis.reversal, Compensation::Model(_));
    let refining = axes.iter().map(AxisCompensation::self_tuning);
    axes.iter().any(is_model).then(|| refining.collect())
}

/// The method of a compensation, in a word.
#[must_use]
pub fn method(axes: &[AxisCompensation]) -> &'static str {
    match axes.first().map(|axis| &axis.reversal) {
        None | Some(Compensation::None) => "none",
        Some(Compensation::Coulomb { .. }) => "coulomb",
        Some(Compensation::Model(_)) => "model",
        Some(Compensation::Pulse(_)) => "pulse",
        Some(Compensation::Adaptive(_)) => "adaptive",
    }
}

impl AxisCompensation {
    /// The same, its model refined by the drive.
    fn self_tuning(&self) -> Self {
        let Compensation::Model(model) = &self.reversal else {
            return self.clone();
        };
        let share = if model.self_tuning > 0.0 {
            model.self_tuning
        } else {
            SELF_TUNING
        };
        let model = Model {
            self_tuning: share,
            ..**model
        };
        Self {
            reversal: Compensation::Model(Box::new(model)),
            ..self.clone()
        }
    }
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct CompensationFile {
    axis: Vec<NamedAxis>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct NamedAxis {
    name: String,
    reversal: Compensation,
    #[serde(default)]
    backlash_m: f64,
}

/// Reads a compensation file for the axes of a machine.
///
/// # Errors
/// One line with file, line and key.
pub fn read(path: &Path, axes: &[String]) -> Outcome<Vec<AxisCompensation>> {
    let text = std::fs::read_to_string(path).map_err(|error| Failure::file(path, &error))?;
    let form: CompensationFile = toml::from_str(&text).map_err(|error| {
        let line = error.span().map_or(0, |span| {
            text[..span.start.min(text.len())].matches('\n').count() + 1
        });
        Failure::new(format!("{}:{line}: {}", path.display(), error.message()))
    })?;
    let of_axis = |name: &String| {
        let found = form.axis.iter().find(|axis| axis.name == *name);
        let lacking = || {
            Failure::new(format!(
                "{}: no [[axis]] named \"{name}\"; run tune for this machine",
                path.display()
            ))
        };
        let axis = found.ok_or_else(lacking)?;
        check(path, axis)?;
        Ok(AxisCompensation {
            reversal: axis.reversal.clone(),
            backlash_m: axis.backlash_m,
        })
    };
    axes.iter().map(of_axis).collect()
}

/// A number that makes no sense: its key, what it must be, what it is.
struct Wrong(&'static str, &'static str, f64);

fn check(path: &Path, axis: &NamedAxis) -> Outcome<()> {
    let checked = check_reversal(&axis.reversal).and_then(|()| {
        let gap_m = axis.backlash_m;
        expect(
            (0.0..=0.01).contains(&gap_m),
            Wrong("backlash_m", "0 to 0.01 m", gap_m),
        )?;
        let crosses = matches!(&axis.reversal, Compensation::Model(model) if model.gap_m > 0.0);
        expect(
            gap_m <= 0.0 || !crosses,
            Wrong("backlash_m", "0 where the model crosses gap_m", gap_m),
        )
    });
    checked.map_err(|Wrong(key, wanted, got)| {
        Failure::new(format!(
            "{}: axis {}: {key} must be {wanted}, got {got}",
            path.display(),
            axis.name
        ))
    })
}

fn check_reversal(reversal: &Compensation) -> Result<(), Wrong> {
    match reversal {
        Compensation::None => Ok(()),
        Compensation::Coulomb { force_n } => expect(
            force_n.is_finite(),
            Wrong("force_n", "a finite number of newtons", *force_n),
        ),
        Compensation::Pulse(pulse) => check_pulse(*pulse),
        Compensation::Adaptive(adaptive) => adaptive.check(),
        Compensation::Model(model) => check_model(model),
    }
}

fn check_pulse(pulse: Pulse) -> Result<(), Wrong> {
    let Pulse {
        height_m_per_s: height,
        time_constant_s: time,
        start_delay_s: delay,
    } = pulse;
    expect(
        time > 0.0 && time.is_finite(),
        Wrong("time_constant_s", "above zero", time),
    )?;
    expect(
        (0.0..=10.0).contains(&delay),
        Wrong("start_delay_s", "0 to 10 s", delay),
    )?;
    expect(
        height.is_finite(),
        Wrong("height_m_per_s", "a finite velocity", height),
    )
}

/// Whether each of some values lies in a range.
fn each(
    key: &'static str,
    wanted: &'static str,
    values: &[f64],
    range: RangeInclusive<f64>,
) -> Result<(), Wrong> {
    let wrong = values.iter().find(|value| !range.contains(*value));
    wrong.map_or(Ok(()), |value| Err(Wrong(key, wanted, *value)))
}

fn check_model(model: &Model) -> Result<(), Wrong> {
    let slips_m = SHORTEST_SLIP_M..=LONGEST_SLIP_M;
    each("level_n", "0 to 1e6 N", &model.level_n, 0.0..=1.0e6)?;
    each("slip_m", "1e-9 to 1e-3 m", &model.slip_m, slips_m)?;
    each("motor_share", "0 to 1", &model.motor_share, 0.0..=1.0)?;
    each("ahead_s", "0 to 0.1 s", &[model.ahead_s], 0.0..=0.1)?;
    each("damping_s", "0 to 0.1 s", &[model.damping_s], 0.0..=0.1)?;
    each("self_tuning", "0 to 1", &[model.self_tuning], 0.0..=1.0)?;
    check_levels(model)?;
    check_screw(model)?;
    check_ripple(&model.ripple)
}

fn check_levels(model: &Model) -> Result<(), Wrong> {
    each("factor", "0 to 3.9", &model.factor, 0.0..=3.9)?;
    let [span, viscous] = [model.span_m_per_s, model.viscous_n_s_per_m];
    each("span_m_per_s", "0 to 10 m/s", &[span], 0.0..=10.0)?;
    let wanted = "0 to 1e7 N s/m";
    each("viscous_n_s_per_m", wanted, &[viscous], 0.0..=1.0e7)?;
    each("lag_m", "0 to 1e-3 m", &[model.lag_m], 0.0..=1.0e-3)?;
    each("lag_s", "0 to 1 s", &[model.lag_s], 0.0..=1.0)?;
    let (slope, bend) = (model.slope_per_m, model.bend_per_m2);
    each("slope_per_m", "-700 to 700 /m", &[slope], SLOPES_PER_M)?;
    each("bend_per_m2", "-2000 to 2000 /m2", &[bend], BENDS_PER_M2)?;
    let (wanted, viscous) = ("-1e7 to 1e7 N s/m", model.viscous_asymmetry_n_s_per_m);
    each(
        "viscous_asymmetry_n_s_per_m",
        wanted,
        &[viscous],
        -1.0e7..=1.0e7,
    )?;
    let (wanted, level) = ("-1e6 to 1e6 N", model.level_asymmetry_n);
    each("level_asymmetry_n", wanted, &[level], -1.0e6..=1.0e6)?;
    let way = model.way_asymmetry;
    each("way_asymmetry", "-0.9 to 0.9", &[way], WAY_ASYMMETRIES)
}

fn check_screw(model: &Model) -> Result<(), Wrong> {
    let stiffness = model.stiffness_n_per_m;
    expect(
        stiffness > 0.0,
        Wrong("stiffness_n_per_m", "above zero", stiffness),
    )?;
    let ahead = model.windup_ahead_s;
    each("windup_ahead_s", "-0.1 to 0.1 s", &[ahead], -0.1..=0.1)?;
    each("gap_m", "0 to 1e-3 m", &[model.gap_m], GAPS_M)?;
    let force = model.gap_force_n;
    each("gap_force_n", "1 to 1e6 N", &[force], 1.0..=1.0e6)?;
    let velocity = model.gap_velocity_m_per_s;
    each(
        "gap_velocity_m_per_s",
        "0 to 10 m/s",
        &[velocity],
        0.0..=10.0,
    )?;
    let (table, motor) = (model.table_mass_kg, model.motor_inertia_kg);
    each("table_mass_kg", "0 to 1e6 kg", &[table], 0.0..=1.0e6)?;
    let force = model.table_force_n;
    each("table_force_n", "-1e6 to 1e6 N", &[force], -1.0e6..=1.0e6)?;
    each("motor_inertia_kg", "0 to 1e6 kg", &[motor], 0.0..=1.0e6)
}

fn check_ripple(ripple: &[Ripple; RIPPLES]) -> Result<(), Wrong> {
    let [amplitudes, periods, phases] = [
        ripple.map(|own| own.amplitude_n),
        ripple.map(|own| own.period_m),
        ripple.map(|own| own.phase_turns),
    ];
    each("amplitude_n", "0 to 1e6 N", &amplitudes, 0.0..=1.0e6)?;
    each("period_m", "1e-6 to 0.2 m", &periods, PERIODS_M)?;
    each("phase_turns", "-1 to 1", &phases, -1.0..=1.0)
}

fn expect(holds: bool, otherwise: Wrong) -> Result<(), Wrong> {
    if holds { Ok(()) } else { Err(otherwise) }
}

/// The text of a compensation file.
///
/// # Errors
/// Never in practice: the form is plain data.
pub fn text(axes: &[String], compensation: &[AxisCompensation]) -> Outcome<String> {
    let named = axes.iter().zip(compensation);
    let axis = named.map(|(name, c)| NamedAxis {
        name: name.clone(),
        reversal: c.reversal.clone(),
        backlash_m: c.backlash_m,
    });
    toml::to_string(&CompensationFile {
        axis: axis.collect(),
    })
    .map_err(|error| Failure::new(error.to_string()))
}

#[cfg(test)]
mod tests {
    use super::*;

    const PULSE: Pulse = Pulse {
        height_m_per_s: -2.0e-3,
        time_constant_s: 5.0e-3,
        start_delay_s: 0.0,
    };

    const MODEL: Model = Model {
        level_n: [40.0; ELEMENTS],
        factor: [1.2; LEVELS],
        span_m_per_s: 4.0e-3,
        windup_ahead_s: -2.0e-4,
        ..Model::OFF
    };

    fn names() -> Vec<String> {
        ["X", "Y"].map(String::from).to_vec()
    }

    fn of(reversal: Compensation) -> AxisCompensation {
        AxisCompensation {
            reversal,
            backlash_m: 1.0e-5,
        }
    }

    fn read_back(compensation: &[AxisCompensation]) -> Outcome<Vec<AxisCompensation>> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("compensation.toml");
        std::fs::write(&path, text(&names(), compensation).unwrap()).unwrap();
        read(&path, &names())
    }

    #[test]
    fn what_was_written_is_read_again() {
        let written = [
            of(Compensation::Pulse(PULSE)),
            of(Compensation::Model(Box::new(MODEL))),
        ];
        assert_eq!(read_back(&written).unwrap(), written);
        let adaptive = Adaptive {
            forward_m_per_s: [1.0e-3; POINTS],
            ..Adaptive::OFF
        };
        let written = [
            of(Compensation::None),
            of(Compensation::Adaptive(Box::new(adaptive))),
        ];
        assert_eq!(read_back(&written).unwrap(), written);
        let none = [AxisCompensation::default(), AxisCompensation::default()];
        assert_eq!(read_back(&none).unwrap(), none);
    }

    #[test]
    fn a_number_that_makes_no_sense_is_refused_by_axis_and_key() {
        let pulse = |change: fn(&mut Pulse)| {
            let mut pulse = PULSE;
            change(&mut pulse);
            of(Compensation::Pulse(pulse))
        };
        let model = |change: fn(&mut Model)| {
            let mut model = MODEL;
            change(&mut model);
            of(Compensation::Model(Box::new(model)))
        };
        let gap = AxisCompensation {
            backlash_m: 0.011,
            ..of(Compensation::None)
        };
        for (wrong, key) in [
            (
                pulse(|pulse| pulse.time_constant_s = 0.0),
                "time_constant_s",
            ),
            (pulse(|pulse| pulse.start_delay_s = 10.1), "start_delay_s"),
            (
                pulse(|pulse| pulse.height_m_per_s = f64::INFINITY),
                "height_m_per_s",
            ),
            (of(Compensation::Coulomb { force_n: f64::NAN }), "force_n"),
            (model(|model| model.level_n[3] = -1.0), "level_n"),
            (model(|model| model.slip_m[9] = 0.0), "slip_m"),
            (model(|model| model.factor[16] = 4.0), "factor"),
            (
                model(|model| model.stiffness_n_per_m = 0.0),
                "stiffness_n_per_m",
            ),
            (
                model(|model| model.gap_velocity_m_per_s = -1.0),
                "gap_velocity_m_per_s",
            ),
            (
                model(|model| model.windup_ahead_s = f64::NAN),
                "windup_ahead_s",
            ),
            (gap, "backlash_m"),
        ] {
            let refusal = read_back(&[AxisCompensation::default(), wrong]).unwrap_err();
            let text = refusal.to_string();
            assert!(text.contains(&format!("axis Y: {key} must be")), "{text}");
        }
    }
}
