//! QEMU's mps2-an386, a Cortex-M4F, and the images that run on it.
//!
//! QEMU is installed where it is missing (Debian: `qemu-system-arm`).

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::Mutex;
use std::time::{Duration, Instant};

use super::recording;
use crate::targets;

/// The drive board's target.
pub const TARGET: &str = "thumbv7em-none-eabihf";
/// The profile that its image ships with.
pub const PROFILE: &str = "firmware";
/// A replay takes some ten seconds; one that hangs is ended.
const PATIENCE: Duration = Duration::from_mins(5);

/// Builds the images of `firmware/emulated` in a target folder of their own beside that of the
/// running program, so that features and locks of the host's build do not meet them; gives the
/// folder in which they lie by their names.
///
/// # Panics
/// Where it does not compile.
#[must_use]
pub fn images(target: &Path, profile: &str) -> PathBuf {
    let folder = target.join("cortex-m");
    targets::install(TARGET);
    let mut cargo = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    cargo
        .args(["build", "--locked", "--package", "emulated"])
        .args(["--target", TARGET, "--profile", profile, "--target-dir"])
        .arg(&folder)
        .current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))
        .env_remove("RUSTFLAGS");
    let built = cargo.output().expect("cargo can be started");
    assert!(
        built.status.success(),
        "the images do not compile: {}",
        String::from_utf8_lossy(&built.stderr)
    );
    folder.join(TARGET).join(profile)
}

/// The emulator without image, serial line and clock.
///
/// # Panics
/// Where it is missing and cannot be installed.
#[must_use]
pub fn qemu() -> Command {
    have_qemu();
    let mut qemu = Command::new("qemu-system-arm");
    qemu.args(["-machine", "mps2-an386", "-display", "none"]);
    qemu.args(["-monitor", "none"]).stdin(Stdio::null());
    qemu
}

fn have_qemu() {
    // Packages are installed by one at a time.
    static INSTALLS: Mutex<()> = Mutex::new(());
    let _installs = INSTALLS.lock();
    let is_there = |program: &str| {
        Command::new(program)
            .arg("--version")
            .stdout(Stdio::null())
            .status()
            .is_ok()
    };
    if is_there("qemu-system-arm") {
        return;
    }
    eprintln!("installing qemu-system-arm");
    let install = "run() { if [ \"$(id -u)\" = 0 ]; then \"$@\"; else sudo -n \"$@\"; fi; }
        run apt-get -qq update; run env DEBIAN_FRONTEND=noninteractive \
        apt-get -qq -y -o DPkg::Lock::Timeout=300 --no-install-recommends install qemu-system-arm >&2";
    let installed = Command::new("sh").args(["-c", install]).status();
    assert!(
        installed.is_ok_and(|status| status.success()) && is_there("qemu-system-arm"),
        "qemu-system-arm is missing and cannot be installed: install QEMU's ARM system emulator"
    );
}

/// Runs an image on a recording; gives what it reports.
///
/// # Panics
/// Where it does not come to its end.
#[must_use]
pub fn replay(image: &Path, recording: &Path) -> String {
    let loader = format!(
        "loader,file={},addr={:#x},force-raw=on",
        recording.display(),
        recording::ADDRESS
    );
    report(image, &["-device", &loader])
}

/// Runs an image to its end, one instruction a nanosecond; gives what it reports.
///
/// # Panics
/// Where it does not come to its end.
#[must_use]
pub fn report(image: &Path, arguments: &[&str]) -> String {
    let mut qemu = qemu();
    qemu.args(["-icount", "shift=0", "-serial", "none"])
        .args(["-semihosting-config", "enable=on,target=native"])
        .args(arguments)
        .arg("-kernel")
        .arg(image)
        .stdout(Stdio::piped());
    let mut qemu = qemu.spawn().expect("qemu-system-arm starts");
    let mut output = qemu.stdout.take().expect("a pipe");
    let reader = std::thread::spawn(move || {
        std::io::read_to_string(&mut output).expect("the report is text")
    });
    let begun = Instant::now();
    let status = loop {
        if let Some(status) = qemu.try_wait().expect("a child can be asked") {
            break status;
        }
        if begun.elapsed() > PATIENCE {
            qemu.kill().expect("a child can be ended");
        }
        std::thread::sleep(Duration::from_millis(20));
    };
    let report = reader.join().expect("the reader ends with the pipe");
    assert!(
        status.success(),
        "the image did not come to its end: {status}\n{}",
        last_lines(&report)
    );
    report
}

fn last_lines(report: &str) -> String {
    let lines: Vec<&str> = report.lines().collect();
    lines[lines.len().saturating_sub(5)..].join("\n")
}
