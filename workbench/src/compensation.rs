//! Compensation files: what `tune` and `commission` write and `circle` and the drive read.

use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::error::{Failure, Outcome};

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

/// What the drive does about reversals.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
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
}

/// Compensation of one axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AxisCompensation {
    /// Reversal compensation.
    pub reversal: Compensation,
    /// Gap to compensate on the setpoint, m; zero for none.
    #[serde(default)]
    pub backlash_m: f64,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct FileForm {
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
    let form: FileForm = toml::from_str(&text).map_err(|error| {
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
            reversal: axis.reversal,
            backlash_m: axis.backlash_m,
        })
    };
    axes.iter().map(of_axis).collect()
}

fn check(path: &Path, axis: &NamedAxis) -> Outcome<()> {
    let wrong = |key: &str, wanted: &str, got: f64| {
        Failure::new(format!(
            "{}: axis {}: {key} must be {wanted}, got {got}",
            path.display(),
            axis.name
        ))
    };
    match axis.reversal {
        Compensation::None => {}
        Compensation::Coulomb { force_n } if !force_n.is_finite() => {
            return Err(wrong("force_n", "a finite number of newtons", force_n));
        }
        Compensation::Coulomb { .. } => {}
        Compensation::Pulse(pulse) => {
            if !(pulse.time_constant_s > 0.0 && pulse.time_constant_s.is_finite()) {
                return Err(wrong(
                    "time_constant_s",
                    "above zero",
                    pulse.time_constant_s,
                ));
            }
            if !(0.0..=10.0).contains(&pulse.start_delay_s) {
                return Err(wrong("start_delay_s", "0 to 10 s", pulse.start_delay_s));
            }
            if !pulse.height_m_per_s.is_finite() {
                return Err(wrong(
                    "height_m_per_s",
                    "a finite velocity",
                    pulse.height_m_per_s,
                ));
            }
        }
    }
    if !(0.0..=0.01).contains(&axis.backlash_m) {
        return Err(wrong("backlash_m", "0 to 0.01 m", axis.backlash_m));
    }
    Ok(())
}

/// The text of a compensation file.
///
/// # Errors
/// Never in practice: the form is plain data.
pub fn text(axes: &[String], compensation: &[AxisCompensation]) -> Outcome<String> {
    let named = axes.iter().zip(compensation);
    let axis = named.map(|(name, c)| NamedAxis {
        name: name.clone(),
        reversal: c.reversal,
        backlash_m: c.backlash_m,
    });
    toml::to_string(&FileForm {
        axis: axis.collect(),
    })
    .map_err(|error| Failure::new(error.to_string()))
}
