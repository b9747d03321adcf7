//! The servo node as ARM code on an emulated Cortex-M4 (QEMU's mps2-an386), for two questions: does
//! it answer like the host's, and in how many instructions?
//!
//! The recording of a run on the host lies in memory ([`recording`]). Its events go into a servo
//! one by one, and every answer is compared with the recorded one, byte for byte. An event that is
//! to be measured goes first into [`REPEATS`] copies of the servo between two readings of SysTick:
//!
//! ```text
//! instructions = (ticks of REPEATS events − ticks of REPEATS empty events)
//!                · instructions per tick / REPEATS
//! ```
//!
//! With `-icount shift=0` one instruction takes one nanosecond, and SysTick at 25 MHz counts 40 of
//! them a tick, so that the copies bring the resolution below one instruction. The copies meet the
//! same state and the same frame, so every one of them runs the same instructions. Instructions are
//! not cycles: memory and pipeline cost nothing here.
//!
//! A commit is converted beside the cycle on a board, so its frame is measured without that, and
//! the conversion and the taking over of what comes of it apart.
//!
//! Report, a line each: `delay I T` (`I` instructions took `T` ticks), `empty N T` (`N` empty
//! events), `C T` for each measured event (class as in the recording), `commit T U` (a conversion
//! took `T`, taking it over `U`), `wrong E` for an event whose answer differs, `stack S` (bytes
//! that one of them took at most), `end E F` (events and answers compared). The exit code says
//! whether the image came to its end.
#![no_std]
#![no_main]

#[path = "../host.rs"]
mod host;
mod recording;
mod stack;

use core::hint::black_box;

use cortex_m::Peripherals;
use cortex_m::peripheral::SYST;
use cortex_m::peripheral::syst::SystClkSource;
use cortex_m_rt::entry;
use cortex_m_semihosting::debug::EXIT_SUCCESS;
use protocol::CanFrame;
use protocol::cob::AxisIds;
use servo::commit::Commit;
use servo::{Outbox, Servo};

use host::{exit, report};
use recording::{Class, Event, Events, FRAME};

/// Copies of the servo that take an event that is measured: 40 instructions a tick / 64 copies is
/// 0.6.
const REPEATS: usize = 64;
/// Rounds of the delay that tells how long a tick is: `subs` and `bne`, two instructions (cortex-m
/// 0.7.10, `asm::delay`).
const DELAY: u32 = 100_000;
/// SysTick counts 24 bits.
const SYSTICK: u32 = 0x00FF_FFFF;

#[entry]
fn main() -> ! {
    start(Peripherals::take().expect("main runs once").SYST);
    let ids = AxisIds::of_axis(0).expect("an axis 0");
    let mut servo = Servo::new(ids);
    report_clock(&servo);
    let (mut events, mut answers, mut stack) = (0_u32, 0_usize, 0_usize);
    for event in Events(recorded()) {
        if event.is_measured {
            report(format_args!(
                "{} {}",
                event.class as u8,
                measured(&servo, &event)
            ));
            report_commit(&servo, &event);
            stack = stack.max(stack_of(&servo, &event));
        }
        let out = happens(&mut servo, &event);
        if !is_as_recorded(&out, event.answers) {
            report(format_args!("wrong {events}"));
        }
        events += 1;
        answers += out.len();
    }
    report(format_args!("stack {stack}"));
    report(format_args!("end {events} {answers}"));
    exit(EXIT_SUCCESS)
}

fn start(mut systick: SYST) {
    systick.set_clock_source(SystClkSource::Core);
    systick.set_reload(SYSTICK);
    systick.clear_current();
    systick.enable_counter();
}

/// The recording that QEMU's loader has put into memory.
#[expect(
    unsafe_code,
    reason = "the loader's memory is known by its address alone"
)]
fn recorded() -> &'static [u8] {
    let place = core::ptr::with_exposed_provenance::<u8>(recording::ADDRESS);
    // SAFETY: the PSRAM of the machine lies there, initialised, outside of every section of the
    // image, and nobody writes to it.
    let space: &[u8] = unsafe { core::slice::from_raw_parts(place, recording::SPACE) };
    let (length, rest) = space.split_first_chunk().expect("16 MiB hold a length");
    rest.get(..u32::from_le_bytes(*length) as usize)
        .expect("the recording fits into the PSRAM")
}

fn report_clock(servo: &Servo) {
    let begin = SYST::get_current();
    cortex_m::asm::delay(DELAY);
    let delay = ticks_since(begin);
    report(format_args!("delay {} {delay}", 2 * DELAY));
    let frame = recording::from_bytes([0; FRAME]).expect("zeros are a frame");
    report(format_args!(
        "empty {REPEATS} {}",
        ticks_of(servo, nothing, &frame, 0)
    ));
}

fn ticks_since(begin: u32) -> u32 {
    begin.wrapping_sub(SYST::get_current()) & SYSTICK
}

fn measured(servo: &Servo, event: &Event<'_>) -> u32 {
    let now_us = event.now_us;
    let frame = frame_of(event);
    ticks_of(servo, happening(event.class), &frame, now_us)
}

const fn happening(class: Class) -> Happens {
    match class {
        Class::Time => passes,
        _ => takes,
    }
}

/// Bytes of stack that an event takes.
fn stack_of(servo: &Servo, event: &Event<'_>) -> usize {
    let (mut copy, frame, now_us) = (servo.clone(), frame_of(event), event.now_us);
    let event = happening(event.class);
    stack::taken_by(|| {
        black_box(event(&mut copy, &frame, now_us));
    })
}

/// Where an event asks for a conversion.
fn report_commit(servo: &Servo, event: &Event<'_>) {
    if event.class != Class::Other {
        return;
    }
    let mut asking = servo.clone();
    let _its_answer_comes_later = takes(&mut asking, &frame_of(event), event.now_us);
    let mut commit = Commit::default();
    if !asking.begin_commit(&mut commit) {
        return;
    }
    let conversion = ticks(&asking, |_| converts(&commit));
    commit.convert();
    let taking_over = ticks(&asking, |servo| servo.end_commit(&commit));
    report(format_args!("commit {conversion} {taking_over}"));
}

/// What a servo does about a frame at a time.
type Happens = for<'a> fn(&'a mut Servo, &CanFrame, u64) -> &'a [CanFrame];

/// Ticks of an event; one loop for all of them and for the empty one, so that what it takes itself
/// is the same.
#[inline(never)]
fn ticks_of(servo: &Servo, event: Happens, frame: &CanFrame, now_us: u64) -> u32 {
    ticks(servo, |servo| event(servo, frame, now_us))
}

/// Ticks in which an event happens to [`REPEATS`] copies of a servo.
fn ticks(servo: &Servo, event: impl Fn(&mut Servo) -> &[CanFrame]) -> u32 {
    let mut copies: [Servo; REPEATS] = core::array::from_fn(|_| servo.clone());
    let begin = SYST::get_current();
    for copy in &mut copies {
        let out = event(black_box(copy));
        black_box(&out);
    }
    ticks_since(begin)
}

/// The event that costs nothing: what is left is the harness.
#[inline(never)]
fn nothing<'a>(_: &'a mut Servo, _: &CanFrame, _: u64) -> &'a [CanFrame] {
    &[]
}

#[inline(never)]
fn takes<'a>(servo: &'a mut Servo, frame: &CanFrame, now_us: u64) -> &'a [CanFrame] {
    servo.hear(frame, now_us)
}

/// A conversion of a copy: making that is some 400 instructions of it.
#[inline(never)]
fn converts(commit: &Commit) -> &'static [CanFrame] {
    black_box(commit.clone()).convert();
    &[]
}

#[inline(never)]
fn passes<'a>(servo: &'a mut Servo, _: &CanFrame, now_us: u64) -> &'a [CanFrame] {
    servo.on_time(now_us)
}

/// What a servo says to an event, and to the conversion that it asks for: as where both are done at
/// once.
fn happens(servo: &mut Servo, event: &Event<'_>) -> Outbox {
    let said = match event.class {
        Class::Boot => servo.boot(),
        Class::Time => servo.on_time(event.now_us),
        Class::Sync | Class::Setpoint | Class::Feedback | Class::Other => {
            takes(servo, &frame_of(event), event.now_us)
        }
    };
    let mut out = Outbox::new();
    out.extend(said.iter().copied());
    let mut commit = Commit::default();
    if servo.begin_commit(&mut commit) {
        commit.convert();
        out.extend(servo.end_commit(&commit).iter().copied());
    }
    out
}

fn frame_of(event: &Event<'_>) -> CanFrame {
    recording::from_bytes(event.frame).expect("the recording holds frames")
}

fn is_as_recorded(out: &[CanFrame], answers: &[[u8; FRAME]]) -> bool {
    out.len() == answers.len()
        && out
            .iter()
            .zip(answers)
            .all(|(frame, answer)| recording::to_bytes(frame) == Some(*answer))
}
