//! `dataset.toml`: its form, and the ranges of its numbers.

mod key_slips;

use std::path::Path;

use serde::Deserialize;

use crate::error::IdentificationError;
use crate::record::bus_log::BusForm;
use crate::record::source::Mapping;
use crate::record::units::{AxisKind, EffortHold};

type Outcome<T> = Result<T, IdentificationError>;

/// What `time_s` counts from; it matters to what warms up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum TimeFrom {
    /// Every record starts cold.
    #[default]
    Record,
    /// The machine was switched on at zero.
    PowerOn,
}

/// `dataset.toml`. Other keys are kept for people (source, licence, notes).
#[derive(Clone, Debug, Default, Deserialize)]
pub(crate) struct DatasetForm {
    pub(crate) name: Option<String>,
    pub(crate) sample_period_s: Option<f64>,
    #[serde(default)]
    pub(crate) effort_hold: EffortHold,
    pub(crate) effort_lag_s: Option<f64>,
    #[serde(default)]
    pub(crate) time_from: TimeFrom,
    #[serde(default)]
    pub(crate) columns: Mapping,
    pub(crate) bus: Option<BusForm>,
    #[serde(default)]
    pub(crate) axis: AxisForm,
    pub(crate) controller: Option<ControllerForm>,
    pub(crate) declared: Option<DeclaredForm>,
}

/// `[axis]`.
#[derive(Clone, Copy, Debug, Default, Deserialize)]
pub(crate) struct AxisForm {
    #[serde(default)]
    pub(crate) kind: AxisKind,
    pub(crate) lead_m_per_rev: Option<f64>,
    encoder_resolution_m: Option<f64>,
    encoder_resolution_rad: Option<f64>,
    load_encoder_resolution_m: Option<f64>,
    load_encoder_resolution_rad: Option<f64>,
    moving_above_m_s: Option<f64>,
    moving_above_rad_s: Option<f64>,
}

impl AxisForm {
    /// Velocity above which a sample counts as moving, in the unit of the axis: stated, or that of
    /// its kind.
    pub(crate) fn moving_velocity(&self) -> f64 {
        let stated = match self.kind {
            AxisKind::Linear => self.moving_above_m_s,
            AxisKind::Rotary => self.moving_above_rad_s,
        };
        stated.unwrap_or(self.kind.moving_velocity())
    }

    /// Resolution of the motor encoder and of the load scale, in the unit of the axis.
    pub(crate) fn resolutions(&self) -> (Option<f64>, Option<f64>) {
        match self.kind {
            AxisKind::Linear => (self.encoder_resolution_m, self.load_encoder_resolution_m),
            AxisKind::Rotary => (
                self.encoder_resolution_rad,
                self.load_encoder_resolution_rad,
            ),
        }
    }
}

/// The controller of the recorded axis, where it is known.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
pub struct ControllerForm {
    /// Position gain, 1/s.
    pub position_gain_per_s: Option<f64>,
    /// Velocity gain, N·s/m.
    pub velocity_gain_n_s_per_m: Option<f64>,
    /// Velocity gain of a controller with a voltage at its output, V·s/m.
    pub velocity_gain_v_s_per_m: Option<f64>,
    /// Integral gain of the velocity loop, 1/s.
    pub integral_per_s: Option<f64>,
    /// Share of the new difference quotient in the velocity.
    pub velocity_filter: Option<f64>,
    /// Acceleration feedforward, kg.
    pub acceleration_feedforward_kg: Option<f64>,
    /// Limit of the force, N.
    pub force_limit_n: Option<f64>,
    /// `motor` or `load`.
    pub position_sensor: Option<String>,
    /// `motor` or `load`: whose velocity the velocity loop takes; without it that of the position
    /// loop.
    pub velocity_sensor: Option<String>,
}

/// `[declared]`.
#[derive(Clone, Debug, Default, Deserialize)]
pub(crate) struct DeclaredForm {
    #[serde(default)]
    pub(crate) effects: Vec<String>,
}

/// A number of the form: its section and key, and the range that it must lie in, in the unit of its
/// name.
pub(crate) struct Number {
    pub(crate) section: &'static str,
    pub(crate) key: &'static str,
    low: f64,
    high: f64,
}

const fn number(section: &'static str, key: &'static str, low: f64, high: f64) -> Number {
    Number {
        section,
        key,
        low,
        high,
    }
}

/// Every number, in the order in which they are checked. The ranges are wide: they catch a wrong
/// unit (milliseconds, millimetres), not an unusual machine.
#[rustfmt::skip]
pub(crate) const NUMBERS: [Number; 16] = [
    number("", "sample_period_s", 1.0e-6, 1.0),
    number("", "effort_lag_s", 0.0, 0.1),
    number("axis", "lead_m_per_rev", 1.0e-5, 1.0),
    number("axis", "encoder_resolution_m", 0.0, 1.0e-2),
    number("axis", "encoder_resolution_rad", 0.0, 1.0),
    number("axis", "load_encoder_resolution_m", 0.0, 1.0e-2),
    number("axis", "load_encoder_resolution_rad", 0.0, 1.0),
    number("axis", "moving_above_m_s", 1.0e-7, 0.1),
    number("axis", "moving_above_rad_s", 1.0e-6, 10.0),
    number("controller", "position_gain_per_s", 0.0, 1.0e6),
    number("controller", "velocity_gain_n_s_per_m", 0.0, 1.0e12),
    number("controller", "velocity_gain_v_s_per_m", 0.0, 1.0e12),
    number("controller", "integral_per_s", 0.0, 1.0e6),
    number("controller", "velocity_filter", 1.0e-6, 1.0),
    number("controller", "acceleration_feedforward_kg", 0.0, 1.0e9),
    number("controller", "force_limit_n", 1.0e-6, 1.0e9),
];

/// Reads the form; beside it, what is odd in the file but no reason to refuse it.
pub(crate) fn read(path: &Path) -> Outcome<(DatasetForm, Vec<String>)> {
    let shown = path.display();
    let text = std::fs::read_to_string(path).map_err(|error| {
        IdentificationError::new(format!("{shown}: {error}; a dataset needs this file"))
    })?;
    let form: DatasetForm = toml::from_str(&text).map_err(|error| {
        let line = error.span().map_or(0, |span| line_of(&text, span.start));
        IdentificationError::new(format!("{shown}:{line}: {}", error.message()))
    })?;
    let table: toml::Table = text.parse().unwrap_or_default();
    check_numbers(path, &table)?;
    Ok((form, key_slips::notes(path, &text, &table)))
}

fn line_of(text: &str, byte: usize) -> usize {
    let before = text.get(..byte);
    before.map_or(0, |before| before.matches('\n').count()) + 1
}

/// A section of the file; the keys above the first section have an empty name.
pub(crate) fn section<'a>(table: &'a toml::Table, name: &str) -> Option<&'a toml::Table> {
    if name.is_empty() {
        Some(table)
    } else {
        table.get(name)?.as_table()
    }
}

fn check_numbers(path: &Path, table: &toml::Table) -> Outcome<()> {
    for Number {
        section: name,
        key,
        low,
        high,
    } in NUMBERS
    {
        let value = section(table, name).and_then(|part| as_number(part.get(key)?));
        if let Some(value) = value.filter(|value| !(low..=high).contains(value)) {
            return Err(IdentificationError::new(format!(
                "{}: {key} must be {low} to {high} in the unit of its name, got {value}",
                path.display()
            )));
        }
    }
    Ok(())
}

fn as_number(value: &toml::Value) -> Option<f64> {
    value
        .as_float()
        .or_else(|| value.as_integer().map(|whole| whole as f64))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn form(text: &str) -> Outcome<(DatasetForm, Vec<String>)> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("dataset.toml");
        std::fs::write(&path, text).unwrap();
        read(&path)
    }

    #[test]
    fn every_number_is_a_key_of_the_form_and_its_range_is_asked_at_both_ends() {
        for Number {
            section,
            key,
            low,
            high,
        } in NUMBERS
        {
            let header = if section.is_empty() {
                String::new()
            } else {
                format!("[{section}]\n")
            };
            let with = |value: f64| form(&format!("{header}{key} = {value:?}\n"));
            assert!(with(low).is_ok() && with(high).is_ok(), "{key}");
            for beyond in [low - 1.0e-7, high * 1.001] {
                let error = with(beyond).unwrap_err().to_string();
                assert!(
                    error.contains(&format!("{key} must be {low} to {high}")),
                    "{error}"
                );
            }
            // A key that serde does not know would take a text.
            let error = form(&format!("{header}{key} = \"text\"\n"));
            assert!(error.is_err(), "{key}");
        }
    }

    #[test]
    fn a_whole_number_is_a_number() {
        let error = form("sample_period_s = 4\n").unwrap_err().to_string();
        assert!(error.contains("got 4"), "{error}");
    }

    #[test]
    fn what_is_no_toml_is_named_with_its_line() {
        let error = form("name = \"a\"\neffort_hold = \"first\"\n").unwrap_err();
        assert!(error.to_string().contains("dataset.toml:2:"), "{error}");
    }

    #[test]
    fn an_axis_moves_from_what_is_stated_on_or_from_what_is_usual_for_its_kind() {
        let text = "[axis]\nmoving_above_m_s = 1e-4\nmoving_above_rad_s = 0.02\n";
        let of = |text: &str| form(text).unwrap().0.axis.moving_velocity();
        assert_eq!(of(text), 1.0e-4);
        assert_eq!(of(&format!("{text}kind = \"rotary\"\n")), 0.02);
        assert_eq!(of(""), 1.0e-3);
        assert_eq!(of("[axis]\nkind = \"rotary\"\n"), 0.1);
        let error = form("[axis]\nmoving_above_m_s = 0\n").unwrap_err();
        assert!(error.to_string().contains("moving_above_m_s"), "{error}");
    }

    #[test]
    fn the_resolution_is_that_of_the_unit_of_the_axis() {
        let text = "[axis]\nencoder_resolution_m = 1e-6\nencoder_resolution_rad = 1e-4\n";
        let of = |text: &str| form(text).unwrap().0.axis.resolutions().0;
        assert_eq!(of(text), Some(1.0e-6));
        assert_eq!(of(&format!("{text}kind = \"rotary\"\n")), Some(1.0e-4));
    }
}
