//! The wish of the operator (Ctrl-C) or of the system (SIGTERM) that the machine stops.
//!
//! A token that is passed down to whoever moves axes and polled there once per cycle: below the
//! leaves there is no signal, no global and no process exit. `main` connects it to the signals,
//! tests raise it themselves.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use crate::error::{Failure, Outcome};

/// Whether, and by which signal, the work was asked to end. Clones share one state.
#[derive(Clone, Debug, Default)]
pub struct Interrupt(Arc<AtomicUsize>);

/// No signal has the number zero (POSIX `kill`: zero only asks whether a process exists).
const NONE: usize = 0;

impl Interrupt {
    /// A token that nobody raises unless he calls [`Self::raise`].
    #[must_use]
    pub fn never() -> Self {
        Self::default()
    }

    /// Raises the token, by the number of a signal.
    pub fn raise(&self, signal: i32) {
        self.0
            .store(usize::try_from(signal).unwrap_or(NONE), Ordering::SeqCst);
    }

    /// The number of the signal, once it was raised.
    #[must_use]
    pub fn signal(&self) -> Option<i32> {
        i32::try_from(self.0.load(Ordering::SeqCst))
            .ok()
            .filter(|signal| *signal != 0)
    }

    /// Whether it was raised.
    #[must_use]
    pub fn is_raised(&self) -> bool {
        self.signal().is_some()
    }

    /// Ends work between two motions.
    ///
    /// # Errors
    /// Where the token was raised.
    pub fn check(&self) -> Outcome<()> {
        if self.is_raised() {
            Err(self.failure("nothing was moving"))
        } else {
            Ok(())
        }
    }

    /// What to tell whoever raised it, and what became of the axes.
    #[must_use]
    pub fn failure(&self, axes: &str) -> Failure {
        let name = match self.signal() {
            Some(libc::SIGINT) => "SIGINT".to_owned(),
            Some(libc::SIGTERM) => "SIGTERM".to_owned(),
            Some(other) => format!("signal {other}"),
            None => "nobody".to_owned(),
        };
        Failure::new(format!("interrupted by {name}; {axes}"))
    }

    /// Where a signal handler writes the number of the signal.
    #[must_use]
    pub fn cell(&self) -> Arc<AtomicUsize> {
        Arc::clone(&self.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_raised_token_is_seen_by_every_clone_and_names_its_signal() {
        let token = Interrupt::never();
        let clone = token.clone();
        assert!(clone.check().is_ok());
        token.raise(libc::SIGTERM);
        assert_eq!(clone.signal(), Some(libc::SIGTERM));
        assert!(
            clone
                .check()
                .unwrap_err()
                .to_string()
                .starts_with("interrupted by SIGTERM")
        );
    }
}
