//! The `quadrant` program for scenarios that run every node as a process of its own, and the way
//! into a kernel that has vcan.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Duration;

use bus::CanPort;
use protocol::CanFrame;
use scope::Scope;

/// Builds the program into a target folder, the one of the running tests; gives its path.
///
/// `certify` takes the release build that a user runs. The
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

/// Longest time in which node processes boot.
const LONGEST_BOOT: Duration = Duration::from_mins(1);

/// Waits for frames on an interface, in any order: the boot-up messages of nodes. Counting frames
/// would not do: a node that has booted begins its heartbeats while others are still being loaded.
///
/// # Panics
/// Where one of them does not come.
pub fn await_frames(listener: &CanPort, mut missing: Vec<CanFrame>) {
    let mut left = LONGEST_BOOT;
    while !missing.is_empty() {
        let heard = listener.receive_within(&mut left);
        let heard = heard.expect("the interface is there");
        let heard = heard.unwrap_or_else(|| panic!("no boot-up: {missing:?}"));
        missing.retain(|boot_up| *boot_up != heard);
    }
}

/// Runs ignored tests of the running test binary where the kernel has vcan (`scripts/with-vcan`),
/// with the program that [`quadrant`] builds as `QUADRANT_PROGRAM`; gives what they printed. `more`
/// are other variables of the script.
///
/// # Panics
/// Where they fail, with what they printed before.
#[must_use]
pub fn ignored_tests_under_vcan(
    target: &Path,
    arguments: &[&str],
    more: &[(&str, &OsStr)],
) -> String {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"))
        .parent()
        .expect("the crate lies in the workspace");
    let mut scenarios = Command::new(root.join("scripts/with-vcan"));
    scenarios
        .arg(std::env::current_exe().expect("a program knows its path"))
        .args(["--ignored", "--nocapture"])
        .args(arguments)
        .current_dir(root)
        .env("QUADRANT_PROGRAM", quadrant(target))
        .env("VCAN_TIMEOUT", "600")
        .envs(more.iter().copied())
        .stdin(Stdio::null());
    let ran = scenarios.output().expect("the script can be started");
    let out = String::from_utf8_lossy(&ran.stdout).into_owned();
    println!("{out}{}", String::from_utf8_lossy(&ran.stderr));
    assert!(
        ran.status.success(),
        "scenarios over vcan failed ({})",
        ran.status
    );
    out
}
