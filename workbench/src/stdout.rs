//! Results on stdout. A full disk behind it must not end a program whose axes move: what could not
//! be written is told at the end.

use std::fmt::Arguments;
use std::io::Write as _;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::error::{Failure, Outcome};

static FAILED: OnceLock<String> = OnceLock::new();
/// Whether this is the program's stdout, and not that of a test, which has its own way of catching
/// it.
static IS_OURS: AtomicBool = AtomicBool::new(false);

/// From now on a failure to write is kept until [`finish`].
pub fn take_over() {
    IS_OURS.store(true, Ordering::Relaxed);
}

/// Writes a line of results.
#[macro_export]
macro_rules! say {
    ($($text:tt)*) => { $crate::stdout::line(format_args!($($text)*)) };
}

/// Writes a line.
pub fn line(text: Arguments<'_>) {
    text_and_end(text, "\n");
}

/// Writes a text as it is.
pub fn text(text: Arguments<'_>) {
    text_and_end(text, "");
}

fn text_and_end(text: Arguments<'_>, end: &str) {
    if !IS_OURS.load(Ordering::Relaxed) {
        print!("{text}{end}");
        return;
    }
    let mut out = std::io::stdout().lock();
    let written = out
        .write_fmt(text)
        .and_then(|()| out.write_all(end.as_bytes()));
    if let Err(error) = written {
        FAILED.get_or_init(|| error.to_string());
    }
}

/// Whether everything has been written.
///
/// # Errors
/// The first that was not.
pub fn finish() -> Outcome<()> {
    if let Err(error) = std::io::stdout().flush() {
        FAILED.get_or_init(|| error.to_string());
    }
    match FAILED.get() {
        Some(error) => Err(Failure::new(format!(
            "stdout: {error}; results were lost there, files are whole"
        ))),
        None => Ok(()),
    }
}
