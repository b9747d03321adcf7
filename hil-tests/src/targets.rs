//! Cortex-M targets for the toolchain: the one place that installs them.
//!
//! A machine with a stock toolchain has only the host's standard library. `rustup target add`
//! fetches another one, but rustup does not lock: two at once rename the same downloads away from
//! each other, and one of them fails. Tests run at once, in threads and in processes, so here
//! everybody waits for the lock on the folder that rustup writes to. Adding a target that is there
//! costs some milliseconds and no network.

use std::ffi::OsStr;
use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Makes sure that the toolchain can compile for a target.
///
/// # Panics
/// Where the target cannot be had: the message says what is missing and what to do.
pub fn install(target: &str) {
    install_with("rustup".as_ref(), target).unwrap_or_else(|why| panic!("{why}"));
}

/// Adds the target with a rustup under the toolchain's lock, then looks whether it is there.
fn install_with(rustup: &OsStr, target: &str) -> Result<(), String> {
    let libraries = libraries(target)?;
    let _lock = locked(&libraries)?;
    let added = Command::new(rustup)
        .args(["target", "add", target])
        .output();
    let why = match added {
        Ok(added) if added.status.success() => {
            "rustup serves another toolchain than the one on the path".to_owned()
        }
        Ok(added) => String::from_utf8_lossy(&added.stderr).trim().to_owned(),
        Err(error) if error.kind() == io::ErrorKind::NotFound => {
            "there is no rustup on the path".to_owned()
        }
        Err(error) => error.to_string(),
    };
    if has_core(&libraries) {
        return Ok(());
    }
    Err(format!(
        "target {target} is not in {}: {why}. Install it with `rustup target add {target}` (https://rustup.rs), or from where your toolchain came from",
        libraries.display()
    ))
}

/// Where the toolchain on the path keeps the target's libraries, there or not.
fn libraries(target: &str) -> Result<PathBuf, String> {
    let asked = Command::new("rustc")
        .args(["--print", "target-libdir", "--target", target])
        .output();
    let asked = asked.map_err(|error| format!("rustc: {error}"))?;
    let text = String::from_utf8_lossy(&asked.stdout);
    if asked.status.success() {
        Ok(text.trim().into())
    } else {
        Err(String::from_utf8_lossy(&asked.stderr).into())
    }
}

/// Waits for the lock on `lib/rustlib`, two levels above a target's libraries. A lock on the folder
/// itself leaves no file behind.
fn locked(libraries: &Path) -> Result<File, String> {
    let folder = libraries.ancestors().nth(2).unwrap_or(libraries);
    let lock = File::open(folder).and_then(|folder| folder.lock().map(|()| folder));
    lock.map_err(|error| format!("cannot lock {}: {error}", folder.display()))
}

/// Whether the target's `core` is there.
fn has_core(libraries: &Path) -> bool {
    let names = std::fs::read_dir(libraries)
        .into_iter()
        .flatten()
        .flatten()
        .map(|entry| entry.file_name());
    names
        .into_iter()
        .any(|name| name.to_string_lossy().starts_with("libcore-"))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A target that nobody here installs.
    const NEVER: &str = "armv5te-none-eabi";

    #[test]
    fn without_rustup_the_error_says_what_to_do() {
        let why = install_with("no-such-rustup".as_ref(), NEVER).unwrap_err();
        assert!(
            why.contains("no rustup") && why.contains(&format!("rustup target add {NEVER}")),
            "{why}"
        );
    }

    #[test]
    fn without_rustup_a_target_that_is_there_is_enough() {
        let asked = Command::new("rustc")
            .args(["--print", "host-tuple"])
            .output()
            .unwrap();
        let host = String::from_utf8(asked.stdout).unwrap();
        assert_eq!(install_with("no-such-rustup".as_ref(), host.trim()), Ok(()));
    }

    #[test]
    fn two_never_install_at_once() {
        let folder = libraries(NEVER).unwrap();
        let first = locked(&folder).unwrap();
        let second = File::open(folder.ancestors().nth(2).unwrap()).unwrap();
        assert!(matches!(
            second.try_lock(),
            Err(std::fs::TryLockError::WouldBlock)
        ));
        drop(first);
        second.lock().unwrap();
    }
}
