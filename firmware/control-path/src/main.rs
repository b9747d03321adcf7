//! The control path alone, for one question: can it panic?
//!
//! The panic handler calls a symbol that does not exist, so the image links only if no panic is
//! reachable from any entry point. Linked for soft float, so that a float would show as an
//! `__aeabi_f…` symbol. Built with optimisation: the proof is one of the optimised program, which
//! is the one that runs. (The bus load computation of `protocol` is not part of the control path:
//! the workbench calls it, with 64-bit divisions.) Inputs and states come in by reference and as
//! plain numbers, so that nothing folds away.
#![no_std]
#![no_main]

use core::mem::MaybeUninit;

use embedded_can::{ExtendedId, Frame, StandardId};
use protocol::cob::AxisIds;
use protocol::{CanFrame, Station};
use servo::Servo;

/// Where the node's frames go: a leaf's business, called as it is.
type Send = extern "C" fn(&CanFrame);

#[expect(
    unsafe_code,
    reason = "a symbol that does not exist can only be declared"
)]
unsafe extern "C" {
    safe fn a_panic_is_reachable_from_the_control_path() -> !;
}

#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    a_panic_is_reachable_from_the_control_path()
}

/// A servo of any axis.
#[expect(unsafe_code, reason = "an entry point keeps its name")]
#[unsafe(no_mangle)]
extern "C" fn entry_new(axis: u8, place: &mut MaybeUninit<Servo>) -> bool {
    match AxisIds::of_axis(axis) {
        Some(ids) => {
            place.write(Servo::new(ids));
            true
        }
        None => false,
    }
}

/// Its boot-up.
#[expect(unsafe_code, reason = "an entry point keeps its name")]
#[unsafe(no_mangle)]
extern "C" fn entry_boot(servo: &mut Servo, send: Send) {
    Station::boot(servo, &mut |frame| send(&frame));
}

/// Any frame that a bus can carry.
#[expect(unsafe_code, reason = "an entry point keeps its name")]
#[unsafe(no_mangle)]
extern "C" fn entry_frame(
    servo: &mut Servo,
    id: u32,
    flags: u8,
    data: &[u8; 8],
    length: u8,
    now_us: u64,
    send: Send,
) {
    let data = data.get(..usize::from(length)).unwrap_or(data);
    let frame = match (flags & 1, flags & 2) {
        (0, 0) => StandardId::new((id & 0x7FF) as u16).and_then(|id| CanFrame::new(id, data)),
        (0, _) => {
            StandardId::new((id & 0x7FF) as u16).and_then(|id| CanFrame::new_remote(id, data.len()))
        }
        _ => ExtendedId::new(id & 0x1FFF_FFFF).and_then(|id| CanFrame::new(id, data)),
    };
    if let Some(frame) = frame {
        servo.take(&frame, now_us, &mut |frame| send(&frame));
    }
}

/// Any time.
#[expect(unsafe_code, reason = "an entry point keeps its name")]
#[unsafe(no_mangle)]
extern "C" fn entry_time(servo: &mut Servo, now_us: u64, send: Send) {
    servo.time(now_us, &mut |frame| send(&frame));
}

/// When it is due next and when it waits for SYNC; zero for never.
#[expect(unsafe_code, reason = "an entry point keeps its name")]
#[unsafe(no_mangle)]
extern "C" fn entry_due(servo: &Servo, sync_due_us: &mut u64) -> u64 {
    *sync_due_us = servo.sync_due_us().unwrap_or(0);
    servo.wake_at_us().unwrap_or(0)
}
