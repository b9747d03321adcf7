//! The executor's idle loop and its clock: one thread, one `ppoll` for all descriptors and the next alarm.
//!
//! A reader thread per socket costs three context switches a frame; here the thread that runs the node is the one that the kernel wakes.
//! `ppoll`, not `poll`: the latter counts in milliseconds.

use std::cell::RefCell;
use std::io;
use std::os::fd::{AsRawFd, RawFd};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, OnceLock, PoisonError};
use std::task::Waker;
use std::time::{Duration, Instant};

use embassy_executor::raw::Executor;
use embassy_time_driver::Driver;
use embassy_time_queue_utils::Queue;

/// Set whenever a task becomes ready; the executor calls it by this name.
static PENDING: AtomicBool = AtomicBool::new(false);

// Every waker fires on the executor's own thread, in `Clock::expire` or `wake_ready`, so a flag is enough. A second thread that wakes tasks would need a
// descriptor in the poll set.
#[expect(unsafe_code, reason = "the name is the executor's interface")]
// SAFETY: the only definition of this symbol in the program, with the signature that embassy-executor declares.
#[unsafe(export_name = "__pender")]
fn pender(_context: *mut ()) {
    PENDING.store(true, Ordering::Release);
}

struct Clock {
    start: OnceLock<Instant>,
    queue: Mutex<Queue>,
}

embassy_time_driver::time_driver_impl!(static CLOCK: Clock = Clock { start: OnceLock::new(), queue: Mutex::new(Queue::new()) });

impl Driver for Clock {
    fn now(&self) -> u64 {
        u64::try_from(self.start.get_or_init(Instant::now).elapsed().as_micros()).unwrap_or(u64::MAX)
    }

    fn schedule_wake(&self, at: u64, waker: &Waker) {
        // The idle loop asks for the next alarm itself before it sleeps.
        self.queue.lock().unwrap_or_else(PoisonError::into_inner).schedule_wake(at, waker);
    }
}

impl Clock {
    /// Wakes what is due; time until the next alarm.
    fn expire(&self) -> Option<Duration> {
        let now = self.now();
        let next = self.queue.lock().unwrap_or_else(PoisonError::into_inner).next_expiration(now);
        (next != u64::MAX).then(|| Duration::from_micros(next.saturating_sub(now)))
    }
}

thread_local! {
    static WAITING: RefCell<Vec<(RawFd, Waker)>> = const { RefCell::new(Vec::new()) };
}

/// Asks the idle loop to wake a task when a descriptor is readable; one entry per descriptor.
pub fn wake_when_readable(descriptor: &impl AsRawFd, waker: &Waker) {
    let fd = descriptor.as_raw_fd();
    WAITING.with_borrow_mut(|waiting| match waiting.iter_mut().find(|(known, _)| *known == fd) {
        Some((_, known)) => known.clone_from(waker),
        None => waiting.push((fd, waker.clone())),
    });
}

/// Runs the executor until `done`.
///
/// # Errors
/// Where the kernel refuses to wait.
pub fn run(executor: &'static Executor, done: impl Fn() -> bool) -> io::Result<()> {
    let (mut next, mut wakes) = (None, 0_u32);
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
        // Reading the clock may be a system call: not after every frame. An alarm is late by a few frames at most.
        if wakes == 0 {
            next = CLOCK.expire();
        }
        let timeout = if PENDING.load(Ordering::Acquire) { Some(Duration::ZERO) } else { next };
        let by_frame = wake_ready(timeout)?;
        wakes = if by_frame { (wakes + 1) % WAKES_PER_CLOCK } else { 0 };
    }
}

/// Wakes by frames between two looks at the clock.
const WAKES_PER_CLOCK: u32 = 8;

/// Waits and wakes; tells whether a descriptor was ready. With several descriptors ready, the ones that are not are woken once for nothing.
fn wake_ready(timeout: Option<Duration>) -> io::Result<bool> {
    let descriptors: Vec<RawFd> = WAITING.with_borrow(|waiting| waiting.iter().map(|(fd, _)| *fd).collect());
    let ready = bus::socket::wait_readable(&descriptors, timeout)?;
    if ready {
        WAITING.with_borrow_mut(|waiting| waiting.drain(..).for_each(|(_, waker)| waker.wake()));
    }
    Ok(ready)
}
