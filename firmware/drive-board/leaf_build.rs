//! The build script of every board: link arguments, here and not in RUSTFLAGS, which an exported
//! variable would silently replace.

use std::path::PathBuf;
use std::{env, fs};

fn main() {
    let out = PathBuf::from(env::var_os("OUT_DIR").expect("cargo sets OUT_DIR"));
    let here =
        PathBuf::from(env::var_os("CARGO_MANIFEST_DIR").expect("cargo sets CARGO_MANIFEST_DIR"));
    let memory = here.join("../../memory.x");
    fs::copy(&memory, out.join("memory.x")).expect("memory.x stands at the workspace root");
    fs::copy(
        here.join("../drive-board/checks.x"),
        out.join("board-checks.x"),
    )
    .expect("checks.x stands beside this script");
    println!("cargo::rerun-if-changed={}", memory.display());
    println!("cargo::rerun-if-changed=../drive-board/checks.x");
    println!("cargo::rustc-link-search={}", out.display());
    for argument in ["--nmagic", "-Tlink.x", "-Tdefmt.x", "-Tboard-checks.x"] {
        println!("cargo::rustc-link-arg-bins={argument}");
    }
}
