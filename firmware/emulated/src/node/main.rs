//! The drive node on an emulated Cortex-M4 (QEMU's mps2-an386), on embassy-executor: the same
//! sans-I/O node as on the board, with CAN frames as SLCAN lines over the UART ([`slcan`]).
//!
//! ```text
//! kernel's slcan or a bench ─▶ UART ─▶ interrupt ─▶ pipe ─▶ channel ─▶ UART
//! ```
//!
//! In lock-step; the line can be `slcand`'s, so that the node is on a SocketCAN interface, or that
//! of a bench, which may say the time as well ([`rig`]). Unlike the host's leaf it does not follow
//! the clock once the workbench is gone: it does what is due next, once a deadline.
#![no_std]
#![no_main]

mod channel;
#[expect(dead_code, reason = "it says nothing but why it cannot go on")]
#[path = "../host.rs"]
mod host;
mod idle;
mod rig;
mod slcan;
mod uart;

use cortex_m::Peripherals;
use cortex_m_rt::{entry, exception};
use embassy_futures::select::{Either, select};
use embassy_time::{Duration, Instant, Timer};
use protocol::cob::AxisIds;
use systick_timer::SystickDriver;

use channel::Channel;

/// The machine's clock.
const CLOCK_HZ: u64 = 25_000_000;
/// SysTick counts a millisecond of it.
const RELOAD: u32 = 24_999;
/// A deadline is a thousand of these, ten seconds: longer than a guest that shares its processor
/// pauses.
const INTERVAL: Duration = Duration::from_millis(10);

embassy_time_driver::time_driver_impl!(static CLOCK: SystickDriver<4> = SystickDriver::new(CLOCK_HZ, RELOAD));

#[exception]
fn SysTick() {
    CLOCK.systick_interrupt();
}

#[entry]
fn main() -> ! {
    let mut peripherals = Peripherals::take().expect("main runs once");
    CLOCK.start(&mut peripherals.SYST);
    uart::start();
    idle::run(|spawner| spawner.spawn(node().expect("a task for the node")))
}

#[embassy_executor::task]
async fn node() {
    let mut channel = Channel::new(AxisIds::of_axis(0).expect("an axis 0"));
    let (mut bytes, mut next) = ([0; 64], Instant::now() + INTERVAL);
    loop {
        match select(uart::receive(&mut bytes), Timer::at(next)).await {
            Either::First(count) => {
                for byte in &bytes[..count] {
                    channel.hear(*byte, &mut uart::send);
                }
            }
            Either::Second(()) => {
                next += INTERVAL;
                channel.interval_passed(&mut uart::send);
            }
        }
    }
}
