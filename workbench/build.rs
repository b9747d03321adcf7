//! The commit that the program was built from, for the reports that it writes; `+changes` where the
//! sources are not those of the commit.

use std::path::Path;
use std::process::Command;

/// What a commit moves, and what the program is made of.
const SEEN: [&str; 14] = [
    "../.git/HEAD",
    "../.git/logs/HEAD",
    "../Cargo.lock",
    "../axis-model/src",
    "../bus/src",
    "../firmware/board-timing/src",
    "../firmware/controller/src",
    "../firmware/host/src",
    "../firmware/servo/src",
    "../identification/src",
    "../plant-sim/src",
    "../protocol/src",
    "build.rs",
    "src",
];

fn main() {
    for place in SEEN.iter().filter(|place| Path::new(place).exists()) {
        println!("cargo:rerun-if-changed={place}");
    }
    let commit = git(&["rev-parse", "--short=10", "HEAD"]);
    let sources = SEEN.iter().filter(|place| !place.contains(".git"));
    let status = ["status", "--porcelain", "--untracked-files=no", "--"].into_iter();
    let changes = git(&status.chain(sources.copied()).collect::<Vec<_>>());
    let is_changed = changes.is_some_and(|changes| !changes.is_empty());
    let mark = if is_changed { "+changes" } else { "" };
    let commit = commit.as_deref().unwrap_or("unknown");
    println!("cargo:rustc-env=QUADRANT_COMMIT={commit}{mark}");
}

/// What git says; nothing where there is none, or no repository.
fn git(arguments: &[&str]) -> Option<String> {
    let output = Command::new("git").args(arguments).output().ok()?;
    let said = output.status.success().then_some(output.stdout)?;
    Some(String::from_utf8(said).ok()?.trim().to_owned())
}
