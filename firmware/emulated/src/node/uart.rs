//! The first UART of the mps2-an386: ARM's CMSDK APB UART (Cortex-M System Design Kit, DDI 0479,
//! 4.3). Received bytes go from the interrupt into a pipe; sending waits for the register, which
//! the emulator empties at once.
//!
//! The machine has no device crate, and this is its only interrupt, so the default handler serves
//! it.

use cortex_m::interrupt::InterruptNumber;
use cortex_m::peripheral::NVIC;
use cortex_m_rt::exception;
use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use embassy_sync::pipe::Pipe;

/// Its place on the bus, and its registers behind that.
const BASE: usize = 0x4000_4000;
const DATA: usize = 0x00;
const STATE: usize = 0x04;
const CONTROL: usize = 0x08;
const INTERRUPT_CLEAR: usize = 0x0C;
const DIVIDER: usize = 0x10;

const TRANSMIT_FULL: u32 = 1 << 0;
const RECEIVE_FULL: u32 = 1 << 1;
const ENABLE: u32 = 1 << 0 | 1 << 1;
const RECEIVE_INTERRUPT: u32 = 1 << 3;
const RECEIVED_INTERRUPT: u32 = 1 << 1;
/// The smallest that the hardware takes; the emulator knows no bit time.
const SMALLEST_DIVIDER: u32 = 16;

/// Some forty lines; the bench waits for an answer to each.
static RECEIVED: Pipe<CriticalSectionRawMutex, 1024> = Pipe::new();

/// The receive interrupt of the first UART.
#[derive(Clone, Copy)]
struct Receives;

#[expect(
    unsafe_code,
    reason = "the number of an interrupt is a promise to the NVIC"
)]
// SAFETY: QEMU wires the first UART's receive interrupt to number 0 (hw/arm/mps2.c).
unsafe impl InterruptNumber for Receives {
    fn number(self) -> u16 {
        0
    }
}

fn read(register: usize) -> u32 {
    let place = core::ptr::with_exposed_provenance::<u32>(BASE + register);
    #[expect(unsafe_code, reason = "a register is known by its address alone")]
    // SAFETY: the UART's registers lie there, one word each, and reading has no effect on memory.
    unsafe {
        place.read_volatile()
    }
}

fn write(register: usize, value: u32) {
    let place = core::ptr::with_exposed_provenance_mut::<u32>(BASE + register);
    #[expect(unsafe_code, reason = "a register is known by its address alone")]
    // SAFETY: as above; the UART writes to no memory.
    unsafe {
        place.write_volatile(value);
    }
}

/// Switches it on.
pub(crate) fn start() {
    write(DIVIDER, SMALLEST_DIVIDER);
    write(CONTROL, ENABLE | RECEIVE_INTERRUPT);
    #[expect(
        unsafe_code,
        reason = "unmasking may break a critical section by masking"
    )]
    // SAFETY: nothing here relies on this interrupt being masked.
    unsafe {
        NVIC::unmask(Receives);
    }
}

/// Bytes that came, one at least.
pub(crate) async fn receive(bytes: &mut [u8]) -> usize {
    RECEIVED.read(bytes).await
}

/// Sends bytes.
pub(crate) fn send(bytes: &[u8]) {
    for byte in bytes {
        while read(STATE) & TRANSMIT_FULL != 0 {}
        write(DATA, u32::from(*byte));
    }
}

#[allow(
    unsafe_code,
    reason = "cortex-m-rt wants this signature; its macro copies the attribute to where `expect` finds nothing"
)]
#[exception]
unsafe fn DefaultHandler(_number: i16) {
    write(INTERRUPT_CLEAR, RECEIVED_INTERRUPT);
    while read(STATE) & RECEIVE_FULL != 0 {
        let [byte, ..] = read(DATA).to_le_bytes();
        // A line too many is a line that lacks a byte, and is refused.
        let _ = RECEIVED.try_write(&[byte]);
    }
}
