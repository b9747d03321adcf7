//! A record as a table of named columns, and as CSV.

use std::fmt::Write as _;

/// A column.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    /// Its name, which ends in its unit.
    pub name: String,
    /// Digits after the point.
    pub decimals: usize,
    /// Values.
    pub values: Vec<f64>,
}

/// A table.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// Columns of one length.
    pub columns: Vec<Column>,
}

impl Table {
    /// A column by its name.
    #[must_use]
    pub fn column(&self, name: &str) -> Option<&[f64]> {
        let column = self.columns.iter().find(|column| column.name == name);
        column.map(|column| column.values.as_slice())
    }

    /// Place of the first column whose name begins so.
    #[must_use]
    pub fn place(&self, begin: &str) -> Option<usize> {
        self.columns
            .iter()
            .position(|column| column.name.starts_with(begin))
    }

    /// Number of rows.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.columns.first().map_or(0, |column| column.values.len())
    }

    /// As text, with a header.
    #[must_use]
    pub fn csv(&self) -> String {
        let names: Vec<&str> = self
            .columns
            .iter()
            .map(|column| column.name.as_str())
            .collect();
        let mut text = names.join(",");
        for row in 0..self.rows() {
            for (place, column) in self.columns.iter().enumerate() {
                let before = if place == 0 { '\n' } else { ',' };
                // Negative zero would make two files differ that say the same.
                let value = column.values[row] + 0.0;
                let _ = write!(text, "{before}{value:.*}", column.decimals);
            }
        }
        text.push('\n');
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_text_has_a_header_and_a_line_for_each_row() {
        let column = |name: &str, decimals, values: &[f64]| Column {
            name: name.into(),
            decimals,
            values: values.to_vec(),
        };
        let columns = vec![
            column("time_s", 3, &[0.0, 0.001]),
            column("x_m", 1, &[-0.0, 2.25]),
        ];
        let table = Table { columns };
        assert_eq!(table.csv(), "time_s,x_m\n0.000,0.0\n0.001,2.2\n");
        assert_eq!(table.place("x_"), Some(1));
    }
}
