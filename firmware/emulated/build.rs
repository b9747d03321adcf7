//! Link arguments: here and not in RUSTFLAGS, which an exported variable would silently replace.
//!
//! cortex-m-rt's own script includes `memory.x`, and the linker takes the first one that it finds:
//! the drive board's, at the workspace root, where it runs. So this leaf brings a whole script,
//! under a name that nobody else has.

use std::path::PathBuf;
use std::{env, fs};

const SCRIPT: &str = "mps2-an386.x";

fn main() {
    let out = PathBuf::from(env::var_os("OUT_DIR").expect("cargo sets OUT_DIR"));
    let here =
        PathBuf::from(env::var_os("CARGO_MANIFEST_DIR").expect("cargo sets CARGO_MANIFEST_DIR"));
    fs::copy(here.join(SCRIPT), out.join(SCRIPT)).expect("the script stands beside build.rs");
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-changed={SCRIPT}");
    println!("cargo::rustc-link-search={}", out.display());
    for argument in ["--nmagic", "-Tmps2-an386.x"] {
        println!("cargo::rustc-link-arg-bins={argument}");
    }
}
