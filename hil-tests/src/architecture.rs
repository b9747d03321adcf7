//! What depends on what: circles between files, crates and folders, the order of rooms, and the
//! size of functions.
//!
//! A crate is read as text and parsed with `syn`, so nothing is compiled. [`sources`] finds the
//! files, [`mentions`] the paths that a file writes down, [`resolve`] the file in which a path
//! ends, [`graph`] the circles, [`crates`] the same between crates, [`rooms`] the direction between
//! the folders of a crate, [`shape`] the length of functions and the share of tests.
//!
//! Two things do not count as a dependency. A file may use its parent, because a module and its
//! parts are one thought. What stands under `cfg(test)` may use anything.

pub mod crates;
pub mod graph;
pub mod mentions;
pub mod resolve;
pub mod rooms;
pub mod shape;
pub mod sources;

pub use graph::{Circle, Graph};
pub use sources::Sources;

/// The folder that holds the workspace.
#[must_use]
pub fn workspace() -> std::path::PathBuf {
    std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}
