//! Named columns of numbers, and the CSV that they are read from.

use std::path::Path;

use crate::error::IdentificationError;
use crate::record::source::Mapping;

type Outcome<T> = Result<T, IdentificationError>;

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
    /// Reads CSV, a row at a time: nothing but the numbers is kept.
    pub(crate) fn read(path: &Path) -> Outcome<Self> {
        let shown = path.display().to_string();
        let failed = |error: csv::Error| {
            IdentificationError::new(format!("{shown}: {error}; a record is CSV with a header"))
        };
        let mut reader = csv::ReaderBuilder::new()
            .trim(csv::Trim::All)
            .from_path(path)
            .map_err(failed)?;
        let header = reader.headers().map_err(failed)?;
        let header: Vec<String> = header.iter().map(String::from).collect();
        let mut columns = vec![Vec::new(); header.len()];
        let mut row = csv::StringRecord::new();
        while reader.read_record(&mut row).map_err(failed)? {
            for ((text, name), column) in row.iter().zip(&header).zip(&mut columns) {
                column.push(finite(text).ok_or_else(|| no_number(&shown, &row, name, text))?);
            }
        }
        Ok(Self {
            path: shown,
            header,
            columns,
        })
    }

    fn place(&self, name: &str) -> Option<usize> {
        self.header.iter().position(|known| known == name)
    }

    /// A column's values.
    pub(crate) fn column(&self, name: &str) -> Option<&[f64]> {
        self.columns.get(self.place(name)?).map(Vec::as_slice)
    }

    /// A column's values, which leave the table: its name stays, for messages.
    pub(crate) fn take(&mut self, name: &str) -> Option<Vec<f64>> {
        let place = self.place(name)?;
        Some(std::mem::take(&mut self.columns[place]))
    }

    /// The same, where a record must have it.
    pub(crate) fn take_required(&mut self, name: &str) -> Outcome<Vec<f64>> {
        self.take(name).ok_or_else(|| self.lacks(name))
    }

    /// That a column is not there.
    pub(crate) fn lacks(&self, name: &str) -> IdentificationError {
        IdentificationError::new(format!(
            "{}:1: no column {name}; the header has {}",
            self.path,
            self.header.join(", ")
        ))
    }

    /// The table with the columns of a mapping under our names and in our units.
    pub(crate) fn mapped(mut self, mapping: &Mapping) -> Outcome<Self> {
        for (name, source) in mapping {
            let form = source.form();
            let theirs = self.column(&form.name);
            let values = theirs.ok_or_else(|| self.lacks(&form.name))?;
            let ours = |value: &f64| form.scale * value + form.offset;
            let values = values.iter().map(ours).collect();
            self.put(name, values);
        }
        Ok(self)
    }

    fn put(&mut self, name: &str, values: Vec<f64>) {
        match self.place(name) {
            Some(place) => self.columns[place] = values,
            None => {
                self.header.push(name.into());
                self.columns.push(values);
            }
        }
    }
}

fn finite(text: &str) -> Option<f64> {
    text.parse().ok().filter(|value: &f64| value.is_finite())
}

fn no_number(path: &str, row: &csv::StringRecord, name: &str, text: &str) -> IdentificationError {
    let line = row.position().map_or(0, csv::Position::line);
    IdentificationError::new(format!(
        "{path}:{line}: column {name}: \"{text}\" is not a finite number; remove the row or fill the gap"
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::source::{Source, SourceForm};

    fn table(text: &str) -> Outcome<Table> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("train.csv");
        std::fs::write(&path, text).unwrap();
        Table::read(&path)
    }

    #[test]
    fn numbers_come_by_column_and_spaces_do_not_matter() {
        let table = table("time_s, force_n\n0, 1.5\n 0.1 ,-2e3\n").unwrap();
        assert_eq!(table.column("time_s"), Some(&[0.0, 0.1][..]));
        assert_eq!(table.column("force_n"), Some(&[1.5, -2.0e3][..]));
        assert_eq!(table.column("position_m"), None);
    }

    #[test]
    fn what_is_no_number_is_named_with_its_line_and_column() {
        let error = table("time_s,force_n\n0,1\n1,NaN\n")
            .unwrap_err()
            .to_string();
        assert!(
            error.contains("train.csv:3: column force_n: \"NaN\""),
            "{error}"
        );
    }

    #[test]
    fn a_mapped_column_has_our_name_and_unit_and_the_old_one_stays() {
        let form = SourceForm {
            name: "pos_mm".into(),
            scale: 1.0e-3,
            offset: 0.5,
            wraps_at: None,
        };
        let mapping = Mapping::from([("position_m".into(), Source::Form(form))]);
        let mut table = table("pos_mm\n1000\n").unwrap().mapped(&mapping).unwrap();
        assert_eq!(table.take_required("position_m").unwrap(), [1.5]);
        assert_eq!(table.column("pos_mm"), Some(&[1000.0][..]));
    }

    #[test]
    fn a_column_that_is_not_there_is_named_with_those_that_are() {
        let error = table("a,b\n1,2\n").unwrap().take_required("time_s");
        let error = error.unwrap_err().to_string();
        assert!(
            error.contains(":1: no column time_s; the header has a, b"),
            "{error}"
        );
    }
}
