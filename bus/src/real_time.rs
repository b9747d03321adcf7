//! Real-time scheduling and locked memory, as far as the system permits.
//!
//! A thread that beats a clock must not wait for others, nor for a page from the disk: `SCHED_FIFO`
//! (sched(7)) and memory that stays (mlockall(2)). Both need a privilege; without it the thread
//! goes on as before, and says so.

use std::io;

/// Priority among real-time threads: above those of the kernel's own default (50) there is nothing
/// to gain, since it delivers the frames.
const PRIORITY: libc::c_int = 49;

/// The present thread runs in real time until this is dropped, where the system permits it; threads
/// that it starts do not. One that runs in real time already stays as it is. To be dropped by the
/// thread that asked.
#[derive(Debug)]
pub struct RealTime {
    scheduled: io::Result<()>,
    is_given_back: bool,
    locked: io::Result<()>,
}

impl RealTime {
    /// Asks for it.
    #[must_use]
    pub fn begin() -> Self {
        let before = policy();
        let is_usual = before == libc::SCHED_OTHER;
        let scheduled = match before {
            libc::SCHED_FIFO | libc::SCHED_RR => Ok(()),
            _ => schedule(libc::SCHED_FIFO | libc::SCHED_RESET_ON_FORK, PRIORITY),
        };
        Self {
            is_given_back: is_usual && scheduled.is_ok(),
            scheduled,
            locked: lock(),
        }
    }

    /// What was permitted, and why not more.
    #[must_use]
    pub fn granted(&self) -> String {
        let scheduling = match &self.scheduled {
            Ok(()) => "real-time scheduling".to_owned(),
            Err(error) => format!("ordinary scheduling (SCHED_FIFO: {error})"),
        };
        let memory = match &self.locked {
            Ok(()) => "memory locked".to_owned(),
            Err(error) => format!("memory not locked ({error})"),
        };
        format!("{scheduling}, {memory}")
    }
}

impl Drop for RealTime {
    fn drop(&mut self) {
        if self.is_given_back {
            // Back to what every thread may have: it cannot be refused.
            let _ = schedule(libc::SCHED_OTHER, 0);
        }
        if self.locked.is_ok() {
            #[expect(unsafe_code, reason = "munlockall has no safe wrapper here")]
            // SAFETY: no arguments; it only lets pages be swapped again.
            unsafe {
                libc::munlockall();
            }
        }
    }
}

/// That of the present thread.
fn policy() -> libc::c_int {
    #[expect(unsafe_code, reason = "sched_getscheduler has no safe wrapper here")]
    // SAFETY: 0 is the present thread.
    let policy = unsafe { libc::sched_getscheduler(0) };
    policy & !libc::SCHED_RESET_ON_FORK
}

fn schedule(policy: libc::c_int, priority: libc::c_int) -> io::Result<()> {
    let parameters = libc::sched_param {
        sched_priority: priority,
    };
    #[expect(unsafe_code, reason = "sched_setscheduler has no safe wrapper here")]
    // SAFETY: 0 is the present thread; the parameters live for the time of the call.
    let outcome = unsafe { libc::sched_setscheduler(0, policy, &raw const parameters) };
    told(outcome)
}

/// Only what is there: with what comes later, an allocation beyond the limit would fail.
fn lock() -> io::Result<()> {
    #[expect(unsafe_code, reason = "mlockall has no safe wrapper here")]
    // SAFETY: a flag; no memory is handed over.
    let outcome = unsafe { libc::mlockall(libc::MCL_CURRENT) };
    told(outcome)
}

fn told(outcome: libc::c_int) -> io::Result<()> {
    if outcome == 0 {
        Ok(())
    } else {
        Err(io::Error::last_os_error())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_thread_runs_in_real_time_where_it_may_and_only_for_so_long() {
        let before = policy();
        let real_time = RealTime::begin();
        let granted = real_time.granted();
        let is_granted = real_time.scheduled.is_ok();
        let runs = [libc::SCHED_FIFO, libc::SCHED_RR].contains(&policy());
        assert_eq!(runs, is_granted, "{granted}");
        let of_another = std::thread::spawn(policy).join().unwrap();
        assert!(of_another == before || before != libc::SCHED_OTHER);
        assert_eq!(granted.starts_with("real-time"), is_granted, "{granted}");
        drop(real_time);
        assert_eq!(policy(), before);
    }
}
