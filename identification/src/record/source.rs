//! Where columns come from: under other names and in other units (`[columns]` in `dataset.toml`).

use std::collections::BTreeMap;

use serde::Deserialize;

/// Where our columns come from, by our name.
pub(crate) type Mapping = BTreeMap<String, Source>;

/// A column of another name, or of another name and unit.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(untagged)]
pub(crate) enum Source {
    /// The name alone.
    Name(String),
    /// With its unit.
    Form(SourceForm),
}

/// `name · scale + offset` in our unit; a signal of a bus log that wraps is unwrapped first.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct SourceForm {
    /// Column of the CSV, or `Message.Signal` of the DBC.
    pub(crate) name: String,
    /// Ours over theirs.
    #[serde(default = "one")]
    pub(crate) scale: f64,
    /// Added after scaling.
    #[serde(default)]
    pub(crate) offset: f64,
    /// The range after which the signal begins again, in its own unit.
    pub(crate) wraps_at: Option<f64>,
}

const fn one() -> f64 {
    1.0
}

impl Source {
    /// The long form.
    pub(crate) fn form(&self) -> SourceForm {
        match self {
            Self::Name(name) => SourceForm {
                name: name.clone(),
                scale: 1.0,
                offset: 0.0,
                wraps_at: None,
            },
            Self::Form(form) => form.clone(),
        }
    }
}
