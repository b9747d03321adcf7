//! What can be wrong with a record, in one line: file, line, column, what was wanted, what to do.

use std::fmt;

/// Why a record or a dataset cannot be used.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct IdentificationError(pub String);

impl fmt::Display for IdentificationError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0.replace('\n', " "))
    }
}

impl std::error::Error for IdentificationError {}

impl IdentificationError {
    /// An error with a text.
    pub fn new(text: impl Into<String>) -> Self {
        Self(text.into())
    }
}
