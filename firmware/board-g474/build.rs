//! Link arguments: here and not in RUSTFLAGS, which an exported variable would silently replace.

use std::path::PathBuf;
use std::{env, fs};

fn main() {
    let out = PathBuf::from(env::var_os("OUT_DIR").expect("cargo sets OUT_DIR"));
    let here =
        PathBuf::from(env::var_os("CARGO_MANIFEST_DIR").expect("cargo sets CARGO_MANIFEST_DIR"));
    let memory = here.join("../../memory.x");
    fs::copy(&memory, out.join("memory.x")).expect("memory.x stands at the workspace root");
    fs::copy(here.join("checks.x"), out.join("board-g474-checks.x"))
        .expect("checks.x stands beside build.rs");
    println!("cargo::rerun-if-changed={}", memory.display());
    println!("cargo::rerun-if-changed=checks.x");
    println!("cargo::rustc-link-search={}", out.display());
    for argument in ["--nmagic", "-Tlink.x", "-Tdefmt.x", "-Tboard-g474-checks.x"] {
        println!("cargo::rustc-link-arg-bins={argument}");
    }
}
