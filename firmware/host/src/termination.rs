//! SIGTERM and SIGINT as a descriptor that becomes readable, so that a node ends between two frames
//! and says nothing more; its peers' watchdogs act.

use std::io;
use std::mem::MaybeUninit;
use std::os::fd::{AsRawFd, FromRawFd, OwnedFd, RawFd};

/// Readable once somebody asked the process to end.
#[derive(Debug)]
pub struct Termination(OwnedFd);

impl Termination {
    /// Takes both signals away from their default action, which ends the process wherever it
    /// stands. Threads inherit this, so it comes before any.
    ///
    /// # Errors
    /// The kernel's.
    pub fn catch() -> io::Result<Self> {
        let mut signals = MaybeUninit::uninit();
        #[expect(unsafe_code, reason = "signalfd has no safe wrapper here")]
        // SAFETY: `signals` is initialised by sigemptyset before anything reads it, and outlives
        // the calls; the descriptor is new and owned by nobody else.
        unsafe {
            libc::sigemptyset(signals.as_mut_ptr());
            libc::sigaddset(signals.as_mut_ptr(), libc::SIGTERM);
            libc::sigaddset(signals.as_mut_ptr(), libc::SIGINT);
            if libc::sigprocmask(libc::SIG_BLOCK, signals.as_ptr(), std::ptr::null_mut()) != 0 {
                return Err(io::Error::last_os_error());
            }
            match libc::signalfd(-1, signals.as_ptr(), libc::SFD_CLOEXEC | libc::SFD_NONBLOCK) {
                -1 => Err(io::Error::last_os_error()),
                fd => Ok(Self(OwnedFd::from_raw_fd(fd))),
            }
        }
    }
}

impl AsRawFd for Termination {
    fn as_raw_fd(&self) -> RawFd {
        self.0.as_raw_fd()
    }
}
