//! The text of a machine file: where a key stands, and errors that say it.

use std::fmt;

use toml::Spanned;

use crate::ranges::{Quantity, Ranged};

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

/// A machine file.
#[derive(Clone, Copy)]
pub(super) struct Source<'a> {
    /// Its name, as the user gave it.
    pub file: &'a str,
    /// Its text.
    pub text: &'a str,
}

/// Where a table begins, as an offset into the text.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Start(usize);

impl Start {
    /// Of a table that was read.
    pub(super) fn of<T>(table: &Spanned<T>) -> Self {
        Self(table.span().start)
    }
}

impl Source<'_> {
    /// What the TOML reader refused, with the line that it means.
    pub(super) fn syntax(&self, error: &toml::de::Error) -> MachineError {
        let line = error.span().map_or(0, |span| self.line(span.start));
        let text = error.message().replace('\n', ", ");
        let shown = self.text.lines().nth(line.saturating_sub(1));
        let shown = shown.unwrap_or("").trim();
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
        let before = self.text.get(..offset);
        before.map_or(0, |before| before.matches('\n').count() + 1)
    }

    /// An error at the line of a key: the first one from the start of its table on, or that start
    /// where the table does not give the key.
    pub(super) fn error(&self, table: Start, key: &str, text: impl fmt::Display) -> MachineError {
        let is_key = |line: &str| {
            let rest = line.trim_start().strip_prefix(key);
            rest.is_some_and(|rest| rest.trim_start().starts_with('='))
        };
        let lines = self.text.get(table.0..).unwrap_or("").lines().enumerate();
        let own = lines.take_while(|(at, line)| *at == 0 || !line.starts_with('['));
        let within = own.into_iter().find(|(_, line)| is_key(line));
        MachineError {
            file: self.file.into(),
            line: self.line(table.0) + within.map_or(0, |(line, _)| line),
            text: format!("{key}: {text}"),
        }
    }

    /// Refuses the first quantity of a table that is outside its range.
    pub(super) fn check<T: Ranged>(&self, table: &Spanned<T>) -> Result<(), MachineError> {
        let quantities = table.get_ref().quantities();
        let mut quantities = quantities.into_iter();
        quantities.try_for_each(|quantity| self.within(Start::of(table), quantity))
    }

    /// Refuses a quantity outside its range.
    pub(super) fn within(&self, table: Start, quantity: Quantity) -> Result<(), MachineError> {
        if quantity.fits() {
            return Ok(());
        }
        let Quantity {
            key,
            value,
            min,
            max,
        } = quantity;
        let text = format!("must be {min} to {max} in the unit of its name, got {value}");
        Err(self.error(table, key, text))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SOURCE: Source<'static> = Source {
        file: "m.toml",
        text: "name = \"a\"\n[one]\nmass = 1\n[two]\nmassive = 2\nmass = 3\n[three]\nmass = 4\n",
    };

    fn line(table: &str, key: &str) -> usize {
        let start = SOURCE.text.find(table).unwrap();
        SOURCE.error(Start(start), key, "").line
    }

    #[test]
    fn a_key_is_looked_for_in_its_own_table() {
        assert_eq!(line("[one]", "mass"), 3);
        assert_eq!(line("[two]", "mass"), 6);
        assert_eq!(line("[two]", "weight"), 4, "not given: the table itself");
        assert_eq!(line("[one]", "massive"), 2, "it is in another table");
    }

    #[test]
    fn a_value_outside_its_range_is_told_with_key_range_and_value() {
        let start = Start(SOURCE.text.find("[three]").unwrap());
        let quantity = |value| Quantity::new("mass", value, (1.0, 2.5));
        assert_eq!(SOURCE.within(start, quantity(2.5)), Ok(()));
        let error = SOURCE.within(start, quantity(4.0)).unwrap_err();
        assert_eq!(
            error.to_string(),
            "m.toml:8: mass: must be 1 to 2.5 in the unit of its name, got 4"
        );
    }
}
