//! What the board does when it cannot go on: it stops transmitting, notes why in memory that a
//! reset leaves alone, and resets.
//!
//! A node that says nothing more is what the plant's watchdog waits for. Why it started is an
//! object after boot (2203h:01).

use core::panic::PanicInfo;
use core::sync::atomic::{AtomicU32, Ordering};

use board_timing::SYSTEM_HZ;
use cortex_m::peripheral::SCB;
use cortex_m_rt::{ExceptionFrame, exception};
use defmt::error;
use embassy_stm32::interrupt::InterruptExt;
use embassy_stm32::{interrupt, pac};
use protocol::leaf::StartedBy;

/// "Qua", and a code in the last byte: nothing that memory holds by itself after power-up.
const MARK: u32 = 0x5175_6100;
const CODE: u32 = 0xFF;

#[expect(unsafe_code, reason = "the section is what leaves it alone at a reset")]
// SAFETY: `.uninit` is RAM that nothing initialises; every content of a word is valid.
#[unsafe(link_section = ".uninit.last_words")]
static LAST_WORDS: AtomicU32 = AtomicU32::new(0);

/// Stops transmitting and notes why.
fn fall_silent(why: StartedBy) {
    pac::FDCAN1.cccr().modify(|w| w.set_init(true));
    LAST_WORDS.store(MARK | u32::from(why.code()), Ordering::Relaxed);
}

fn end(why: StartedBy) -> ! {
    fall_silent(why);
    SCB::sys_reset()
}

/// Why the board started; told once, since the flags are cleared.
pub(crate) fn started_by() -> StartedBy {
    let flags = pac::RCC.csr().read();
    pac::RCC.csr().modify(|w| w.set_rmvf(true));
    let words = LAST_WORDS.swap(0, Ordering::Relaxed);
    let said = u8::try_from(words & CODE)
        .ok()
        .filter(|_| words & !CODE == MARK)
        .and_then(StartedBy::from_code);
    if flags.iwdgrstf() {
        StartedBy::Watchdog
    } else if flags.sftrstf() {
        said.unwrap_or(StartedBy::Software)
    } else if flags.borrstf() {
        StartedBy::Power
    } else {
        StartedBy::Pin
    }
}

/// Waits until the supply is there, and watches it from then on: 2.9 V falling (RM0440 §6.2.2,
/// PLS 110).
pub(crate) fn watch_supply() {
    pac::PWR.cr2().modify(|w| {
        w.set_pls(0b110);
        w.set_pvde(true);
    });
    loop {
        // The detector needs some microseconds.
        cortex_m::asm::delay(SYSTEM_HZ / 10_000);
        if !pac::PWR.sr2().read().pvdo() {
            break;
        }
    }
    // EXTI line 16 is the detector's output; it rises when the supply falls.
    pac::EXTI.pr(0).write(|w| w.set_line(16, true));
    pac::EXTI.rtsr(0).modify(|w| w.set_line(16, true));
    pac::EXTI.imr(0).modify(|w| w.set_line(16, true));
    interrupt::PVD_PVM.unpend();
    #[expect(
        unsafe_code,
        reason = "unmasking may break a critical section by masking"
    )]
    // SAFETY: nothing here relies on this interrupt being masked.
    unsafe {
        interrupt::PVD_PVM.enable();
    }
    if pac::PWR.sr2().read().pvdo() {
        end(StartedBy::LowVoltage);
    }
}

#[allow(unsafe_code, reason = "embassy's handlers are unsafe to call")]
#[interrupt]
unsafe fn PVD_PVM() {
    end(StartedBy::LowVoltage)
}

#[allow(
    unsafe_code,
    reason = "cortex-m-rt wants this signature; its macro copies the attribute to where `expect` finds nothing"
)]
#[exception]
unsafe fn HardFault(_frame: &ExceptionFrame) -> ! {
    end(StartedBy::HardFault)
}

#[panic_handler]
fn panic(info: &PanicInfo<'_>) -> ! {
    fall_silent(StartedBy::Panic);
    error!("{}", defmt::Display2Format(info));
    SCB::sys_reset()
}
