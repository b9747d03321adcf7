//! One kind of error for the user: what, where, what to do, in one line.

use std::fmt;

/// Something that the user has to know, in one line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Failure(pub String);

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0.replace('\n', " "))
    }
}

impl std::error::Error for Failure {}

/// Shorthand.
pub type Outcome<T> = Result<T, Failure>;

impl Failure {
    /// A failure with a text.
    pub fn new(text: impl Into<String>) -> Self {
        Self(text.into())
    }

    /// A failure to write or read a file.
    pub fn file(path: &std::path::Path, error: &std::io::Error) -> Self {
        Self(format!(
            "{}: {error}; check the path and its permissions",
            path.display()
        ))
    }
}

impl From<plant_sim::MachineError> for Failure {
    fn from(error: plant_sim::MachineError) -> Self {
        Self(error.to_string())
    }
}

impl From<identification::IdentificationError> for Failure {
    fn from(error: identification::IdentificationError) -> Self {
        Self(error.to_string())
    }
}
