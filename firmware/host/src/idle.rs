//! The executor's idle loop and its clock: one thread, one `ppoll` for all descriptors, the next
//! alarm and the patience of whoever waits.
//!
//! A reader thread per socket costs three context switches a frame; here the thread that runs the
//! node is the one that the kernel wakes. *Patience* is a timeout of the `ppoll` itself: it starts
//! anew with every frame and reads no clock, which may be a system call. The clock is read only
//! while an alarm is set (clock pace, or a partner that is gone).

use std::cell::{Cell, RefCell};
use std::io;
use std::os::fd::{AsRawFd, RawFd};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, OnceLock, PoisonError};
use std::task::Waker;
use std::time::{Duration, Instant};

use bus::socket::{Waited, readable, wait};
use embassy_executor::raw::Executor;
use embassy_time_driver::Driver;
use embassy_time_queue_utils::Queue;

/// Set whenever a task becomes ready; the executor calls it by this name.
static PENDING: AtomicBool = AtomicBool::new(false);

// Every waker fires on the executor's own thread, in `Clock::expire` or `wait_and_wake`, so a flag
// is enough. A second thread that wakes tasks would need a descriptor in the poll set.
#[expect(unsafe_code, reason = "the name is the executor's interface")]
// SAFETY: the only definition of this symbol in the program, with the signature that
// embassy-executor declares.
#[unsafe(export_name = "__pender")]
fn pender(_context: *mut ()) {
    PENDING.store(true, Ordering::Release);
}

struct Clock {
    start: OnceLock<Instant>,
    queue: Mutex<Queue>,
    has_alarm: AtomicBool,
}

embassy_time_driver::time_driver_impl!(static CLOCK: Clock = Clock {
    start: OnceLock::new(),
    queue: Mutex::new(Queue::new()),
    has_alarm: AtomicBool::new(false),
});

impl Driver for Clock {
    fn now(&self) -> u64 {
        u64::try_from(self.start.get_or_init(Instant::now).elapsed().as_micros())
            .unwrap_or(u64::MAX)
    }

    fn schedule_wake(&self, at: u64, waker: &Waker) {
        // The idle loop asks for the next alarm itself before it sleeps.
        self.queue
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .schedule_wake(at, waker);
        self.has_alarm.store(true, Ordering::Release);
    }
}

impl Clock {
    /// Wakes what is due; time until the next alarm, if there is one.
    fn expire(&self) -> Option<Duration> {
        if !self.has_alarm.load(Ordering::Acquire) {
            return None;
        }
        let now = self.now();
        let next = self
            .queue
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .next_expiration(now);
        self.has_alarm.store(next != u64::MAX, Ordering::Release);
        (next != u64::MAX).then(|| Duration::from_micros(next.saturating_sub(now)))
    }
}

/// A task that waits for a descriptor.
struct Waiting {
    fd: RawFd,
    patience: Option<Duration>,
    waker: Waker,
}

thread_local! {
    static WAITING: RefCell<Vec<Waiting>> = const { RefCell::new(Vec::new()) };
    static RAN_OUT: Cell<bool> = const { Cell::new(false) };
}

/// Asks the idle loop to wake a task when a descriptor is readable, or when nothing at all happened
/// for as long as its patience; one entry per descriptor.
pub fn wake_when_readable(descriptor: &impl AsRawFd, patience: Option<Duration>, waker: &Waker) {
    let fd = descriptor.as_raw_fd();
    WAITING.with_borrow_mut(|all| match all.iter_mut().find(|known| known.fd == fd) {
        Some(known) => {
            *known = Waiting {
                fd,
                patience,
                waker: waker.clone(),
            }
        }
        None => all.push(Waiting {
            fd,
            patience,
            waker: waker.clone(),
        }),
    });
}

/// Whether the last waiting ended because patience ran out; told once.
pub fn patience_ran_out() -> bool {
    RAN_OUT.replace(false)
}

/// Runs the executor until `done`, or until `stop` is readable.
///
/// # Errors
/// Where the kernel refuses to wait.
pub fn run(
    executor: &'static Executor,
    stop: &impl AsRawFd,
    done: impl Fn() -> bool,
) -> io::Result<()> {
    loop {
        PENDING.store(false, Ordering::Release);
        #[expect(unsafe_code, reason = "polling is the executor's interface")]
        // SAFETY: called here only, on one thread, never from within a task.
        unsafe {
            executor.poll();
        }
        if done() {
            return Ok(());
        }
        let alarm = CLOCK.expire();
        let alarm = if PENDING.load(Ordering::Acquire) {
            Some(Duration::ZERO)
        } else {
            alarm
        };
        if wait_and_wake(alarm, stop.as_raw_fd())? {
            return Ok(());
        }
    }
}

/// Waits until a descriptor is ready, the alarm is due or patience runs out, and wakes whom it
/// concerns; tells whether `stop` is readable.
fn wait_and_wake(alarm: Option<Duration>, stop: RawFd) -> io::Result<bool> {
    let (mut entries, patience) = WAITING.with_borrow(|all| {
        let entries: Vec<libc::pollfd> = std::iter::once(stop)
            .chain(all.iter().map(|one| one.fd))
            .map(readable)
            .collect();
        (entries, all.iter().filter_map(|one| one.patience).min())
    });
    let patience_ends_first =
        patience.is_some_and(|patience| alarm.is_none_or(|alarm| patience <= alarm));
    match wait(
        &mut entries,
        if patience_ends_first { patience } else { alarm },
    )? {
        Waited::Interrupted => Ok(false),
        Waited::TimedOut => {
            if patience_ends_first {
                RAN_OUT.set(true);
                wake(|_| true);
            }
            Ok(false)
        }
        Waited::Ready => {
            let is_ready = |fd| {
                entries
                    .iter()
                    .any(|entry| entry.fd == fd && entry.revents != 0)
            };
            wake(|one| is_ready(one.fd));
            Ok(is_ready(stop))
        }
    }
}

fn wake(concerns: impl Fn(&Waiting) -> bool) {
    WAITING.with_borrow_mut(|all| {
        all.extract_if(.., |one| concerns(one))
            .for_each(|one| one.waker.wake());
    });
}
