//! CSV with a header, and columns under other names.

use std::collections::BTreeMap;
use std::path::Path;

use serde::Deserialize;

use crate::error::IdentificationError;

type Outcome<T> = Result<T, IdentificationError>;

/// Where our columns come from, by our name: `[columns]` in `dataset.toml`.
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

/// Named columns of numbers.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Table {
    /// The file, for messages.
    pub(crate) path: String,
    /// Names.
    pub(crate) header: Vec<String>,
    /// Values.
    pub(crate) columns: Vec<Vec<f64>>,
}

impl Table {
    pub(crate) fn read(path: &Path) -> Outcome<Self> {
        let shown = path.display().to_string();
        let failed = |error: csv::Error| {
            IdentificationError::new(format!("{shown}: {error}; a record is CSV with a header"))
        };
        let mut reader = csv::ReaderBuilder::new()
            .trim(csv::Trim::All)
            .from_path(path)
            .map_err(failed)?;
        let header: Vec<String> = reader
            .headers()
            .map_err(failed)?
            .iter()
            .map(String::from)
            .collect();
        let mut columns = vec![Vec::new(); header.len()];
        for row in reader.records() {
            let row = row.map_err(failed)?;
            let line = row.position().map_or(0, csv::Position::line);
            for ((text, name), column) in row.iter().zip(&header).zip(&mut columns) {
                let value = text.parse::<f64>().ok().filter(|value| value.is_finite());
                column.push(value.ok_or_else(|| {
                    IdentificationError::new(format!(
                        "{shown}:{line}: column {name}: \"{text}\" is not a finite number; remove the row or fill the gap"
                    ))
                })?);
            }
        }
        Ok(Self {
            path: shown,
            header,
            columns,
        })
    }

    pub(crate) fn column(&self, name: &str) -> Option<Vec<f64>> {
        let place = self.header.iter().position(|known| known == name)?;
        self.columns.get(place).cloned()
    }

    pub(crate) fn required(&self, name: &str) -> Outcome<Vec<f64>> {
        self.column(name).ok_or_else(|| {
            IdentificationError::new(format!(
                "{}:1: no column {name}; the header has {}",
                self.path,
                self.header.join(", ")
            ))
        })
    }

    /// The table with the columns of a mapping under our names and in our units.
    pub(crate) fn mapped(mut self, mapping: &Mapping) -> Outcome<Self> {
        for (name, source) in mapping {
            let form = source.form();
            let values = self
                .required(&form.name)?
                .into_iter()
                .map(|value| form.scale * value + form.offset)
                .collect();
            match self.header.iter().position(|known| known == name) {
                Some(place) => self.columns[place] = values,
                None => {
                    self.header.push(name.clone());
                    self.columns.push(values);
                }
            }
        }
        Ok(self)
    }
}
