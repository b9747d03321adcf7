//! What an image owes the host that runs it: lines, an exit code, and the reason where it cannot go
//! on. Semihosting.

use core::fmt::{self, Write as _};
use core::panic::PanicInfo;

use cortex_m_rt::{ExceptionFrame, exception};
use cortex_m_semihosting::debug::{self, EXIT_FAILURE};
use cortex_m_semihosting::hio;

/// A line to the host: one semihosting call, whatever it is made of.
pub(crate) fn report(line: fmt::Arguments<'_>) {
    let mut text = heapless::String::<64>::new();
    writeln!(text, "{line}").expect("a line has 64 bytes at most");
    let sent = hio::hstdout().and_then(|mut host| host.write_all(text.as_bytes()));
    sent.expect("the host takes every line");
}

pub(crate) fn exit(status: debug::ExitStatus) -> ! {
    loop {
        debug::exit(status);
    }
}

#[panic_handler]
fn panic(info: &PanicInfo<'_>) -> ! {
    if let Ok(mut host) = hio::hstdout() {
        let _ = writeln!(host, "{info}");
    }
    exit(EXIT_FAILURE)
}

#[allow(
    unsafe_code,
    reason = "cortex-m-rt wants this signature; its macro copies the attribute to where `expect` finds nothing"
)]
#[exception]
unsafe fn HardFault(frame: &ExceptionFrame) -> ! {
    panic!("hard fault at {:#010x}", frame.pc())
}
