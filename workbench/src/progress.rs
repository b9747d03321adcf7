//! Progress on long work, on stderr and only where that is a terminal (or `QUADRANT_PROGRESS` asks
//! for it).

use std::io::IsTerminal;

/// A line about what is being done now.
pub fn step(text: &str) {
    if std::io::stderr().is_terminal() || std::env::var_os("QUADRANT_PROGRESS").is_some() {
        eprintln!("  … {text}");
    }
}
