//! Which program has made a report, and when.

/// Version and commit of the program.
#[must_use]
pub fn program() -> String {
    format!(
        "quadrant {}, commit {}",
        env!("CARGO_PKG_VERSION"),
        env!("QUADRANT_COMMIT")
    )
}

/// The time, UTC, to the minute.
#[must_use]
pub fn now() -> String {
    let now = jiff::Timestamp::now();
    now.strftime("%Y-%m-%d %H:%M UTC").to_string()
}
