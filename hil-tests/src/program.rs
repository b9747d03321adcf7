//! The `quadrant` program for scenarios that run every node as a process of its own.

use std::path::{Path, PathBuf};
use std::process::Command;

use scope::Scope;

/// Builds the program into a target folder, the one of the running tests; gives its path.
///
/// `certify` takes the release build that a user runs: 85 s on two cores, mostly its link. The
/// other scopes take the program that `cargo test` has built for the workbench's own tests
/// (2026-11-21: 0.2 s): asking for one of those tests selects the same features, so nothing is
/// compiled twice.
///
/// # Panics
/// Where it does not compile.
#[must_use]
pub fn quadrant(target: &Path) -> PathBuf {
    let as_tested = (
        ["test", "--no-run", "--test", "bad_input"].as_slice(),
        "debug/quadrant",
    );
    let as_used = (
        [
            "build",
            "--release",
            "--package",
            "workbench",
            "--bin",
            "quadrant",
        ]
        .as_slice(),
        "release/quadrant",
    );
    let (command, program) = Scope::now().pick(as_tested, as_tested, as_used);
    let mut cargo = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    cargo
        .args(command)
        .args(["--locked", "--target-dir"])
        .arg(target);
    let built = cargo
        .current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))
        .output()
        .expect("cargo can be started");
    assert!(
        built.status.success(),
        "{}",
        String::from_utf8_lossy(&built.stderr)
    );
    target.join(program)
}
