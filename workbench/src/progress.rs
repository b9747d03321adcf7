//! Progress on long work, on stderr and only where that is a terminal (or `QUADRANT_PROGRESS` asks
//! for it).

use std::io::IsTerminal;
use std::time::{Duration, Instant};

/// A line about what is being done now.
pub fn step(text: &str) {
    if std::io::stderr().is_terminal() || std::env::var_os("QUADRANT_PROGRESS").is_some() {
        eprintln!("  … {text}");
    }
}

/// Long work of many equal parts, which tells of itself every now and then.
pub struct Long {
    work: Work,
    told: Instant,
    parts: f64,
}

/// Nobody has to wait longer for a line.
const EVERY: Duration = SHORT;

impl Long {
    /// Work of so many parts that begins now.
    #[must_use]
    pub fn of(parts: f64) -> Self {
        Self {
            work: Work::begins(),
            told: Instant::now(),
            parts,
        }
    }

    /// Tells how much of it is done, where it is time to.
    pub fn at(&mut self, part: f64) {
        if self.told.elapsed() >= EVERY {
            self.told = Instant::now();
            self.work.step("moving", part / self.parts);
        }
    }
}

/// Work whose steps know what share of it is done.
pub struct Work(Instant);

/// Nothing is said of the rest before this time: it would be a guess from a beginning.
const SHORT: Duration = Duration::from_secs(2);

impl Work {
    /// Work that begins now.
    #[must_use]
    pub fn begins() -> Self {
        Self(Instant::now())
    }

    /// A line about a step, with what is left where that is known.
    pub fn step(&self, text: &str, done: f64) {
        step(&format!("{text}{}", left(self.0.elapsed(), done)));
    }
}

/// Share and time left, for work that takes longer.
fn left(elapsed: Duration, done: f64) -> String {
    if elapsed < SHORT || done <= 0.0 {
        return String::new();
    }
    let left_s = elapsed.as_secs_f64() * (1.0 - done) / done;
    format!(" ({:.0} % done, about {left_s:.0} s left)", 100.0 * done)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_left_follows_from_what_was_needed_so_far() {
        let after = |seconds: u64, done: f64| left(Duration::from_secs(seconds), done);
        assert_eq!(after(5, 0.25), " (25 % done, about 15 s left)");
        assert_eq!(after(1, 0.25), "");
        assert_eq!(after(5, 0.0), "");
    }
}
