//! The executor's idle loop. Embassy's own waits for an event (`wfe`), which QEMU takes for a hint
//! to yield: the core then spins, and what reaches the UART waits for the emulator's lock, for
//! seconds where the machine has other work. Waiting for an interrupt (`wfi`) stops the core.

use core::sync::atomic::{AtomicBool, Ordering};

use embassy_executor::Spawner;
use embassy_executor::raw::Executor;
use static_cell::StaticCell;

/// A task has become ready.
static PENDING: AtomicBool = AtomicBool::new(false);

#[expect(unsafe_code, reason = "the name is the executor's interface")]
// SAFETY: the only definition of this symbol in the program, with the signature that
// embassy-executor declares.
#[unsafe(export_name = "__pender")]
fn pender(_context: *mut ()) {
    PENDING.store(true, Ordering::Release);
}

/// Runs the tasks that are spawned at its begin, for ever.
pub(crate) fn run(spawn: impl FnOnce(Spawner)) -> ! {
    static EXECUTOR: StaticCell<Executor> = StaticCell::new();
    let executor: &'static Executor = EXECUTOR.init(Executor::new(core::ptr::null_mut()));
    spawn(executor.spawner());
    loop {
        #[expect(unsafe_code, reason = "polling is the executor's interface")]
        // SAFETY: called here only, and never from within a task.
        unsafe {
            executor.poll();
        }
        // An interrupt between the look and the waiting ends the waiting, and is served behind it.
        cortex_m::interrupt::free(|_| {
            if !PENDING.swap(false, Ordering::Acquire) {
                cortex_m::asm::wfi();
            }
        });
    }
}
