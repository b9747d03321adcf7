//! Keeps every entry point and fails the link where one is missing.

use std::path::PathBuf;
use std::{env, fs};

/// Entry points of the control path, as `src/main.rs` exports them.
const ENTRIES: [&str; 5] = [
    "entry_new",
    "entry_boot",
    "entry_frame",
    "entry_time",
    "entry_due",
];

fn main() {
    let out = PathBuf::from(env::var_os("OUT_DIR").expect("cargo sets OUT_DIR"));
    let keep = |entry: &str| {
        format!("EXTERN({entry})\nASSERT(DEFINED({entry}), \"entry {entry} is missing\")\n")
    };
    let script: String = std::iter::once("ENTRY(entry_frame)\n".to_owned())
        .chain(ENTRIES.into_iter().map(keep))
        .collect();
    fs::write(out.join("control-path-entries.x"), script).expect("OUT_DIR is writable");
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rustc-link-search={}", out.display());
    for argument in ["--gc-sections", "-Tcontrol-path-entries.x"] {
        println!("cargo::rustc-link-arg-bins={argument}");
    }
}
