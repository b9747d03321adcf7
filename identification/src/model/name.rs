//! What a part of a model is called.
//!
//! An effect has a name of the list that all programs share. A structure without a name (a force
//! over time) has a description for people: it keeps named effects from absorbing it.

use std::fmt;

use axis_model::EffectName;

use crate::record::dataset::Dataset;

/// What a part is called.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(crate) enum Called {
    /// An effect of the list.
    Effect(EffectName),
    /// No effect of the list: a description.
    Structure(&'static str),
}

impl Called {
    /// As in files and reports.
    #[must_use]
    pub(crate) const fn as_str(self) -> &'static str {
        match self {
            Self::Effect(name) => name.as_str(),
            Self::Structure(description) => description,
        }
    }

    /// The name, where it has one.
    #[must_use]
    pub(crate) const fn name(self) -> Option<EffectName> {
        match self {
            Self::Effect(name) => Some(name),
            Self::Structure(_) => None,
        }
    }

    /// Whether a dataset declares it.
    #[must_use]
    pub(crate) fn is_declared_in(self, dataset: &Dataset) -> bool {
        self.name().is_some_and(|name| dataset.declares(name))
    }
}

impl PartialEq<EffectName> for Called {
    fn eq(&self, name: &EffectName) -> bool {
        self.name() == Some(*name)
    }
}

impl From<EffectName> for Called {
    fn from(name: EffectName) -> Self {
        Self::Effect(name)
    }
}

impl fmt::Display for Called {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.as_str())
    }
}
