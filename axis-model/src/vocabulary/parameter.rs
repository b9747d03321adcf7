//! A parameter of an effect: its name, its dimension, its range, its words.

use std::fmt;

use super::EffectName;
use crate::dimension::Dimension;

/// A row of the vocabulary.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameter {
    /// Effect that it belongs to.
    pub effect: EffectName,
    /// Its name within the effect: `amplitude`.
    pub name: &'static str,
    /// What it is, for people.
    pub words: &'static str,
    /// What it is measured in.
    pub dimension: Dimension,
    /// Smallest value that a machine file may state, SI units of a linear axis.
    pub min: f64,
    /// Largest value that a machine file may state.
    pub max: f64,
    /// Whether an effect is complete without it.
    pub optional: bool,
}

impl Parameter {
    /// Its key in a machine file, with the unit at its end: `amplitude_n`.
    #[must_use]
    pub fn key(&self) -> String {
        format!("{}{}", self.name, self.dimension.key_end())
    }

    /// Its name in a report: `torque_ripple_amplitude`, or that of the effect where they are the
    /// same: `coulomb`.
    #[must_use]
    pub fn report_name(&self) -> String {
        if self.name == self.effect.as_str() {
            self.name.into()
        } else {
            format!("{}_{}", self.effect, self.name)
        }
    }

    /// Refuses a value outside the range.
    ///
    /// # Errors
    /// [`ParameterError`] with key, range and value.
    pub fn check(&self, value: f64) -> Result<(), ParameterError> {
        if value >= self.min && value <= self.max {
            return Ok(());
        }
        let (min, max) = (self.min, self.max);
        Err(ParameterError {
            key: self.key(),
            text: format!("must be {min} to {max} in the unit of its name, got {value}"),
        })
    }
}

/// Why the parameters of an effect cannot be taken.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ParameterError {
    /// The key, as it was written or as it should be.
    pub key: String,
    /// What is wrong, what was wanted.
    pub text: String,
}

impl fmt::Display for ParameterError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.key, self.text)
    }
}

impl std::error::Error for ParameterError {}
