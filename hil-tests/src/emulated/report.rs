//! What the image says of a recording.

use super::recording::Class;

/// An instruction takes 1 ns of virtual time (`-icount shift=0`), a tick of SysTick 40 ns (25 MHz).
const INSTRUCTIONS_PER_TICK: f64 = 40.0;
/// What the empty event takes itself, and what is taken off each event with it: a function that
/// keeps a frame pointer and returns an empty list. (`scripts/where-instructions` counts events
/// without it.)
const EMPTY: f64 = 5.0;

/// What the image reports, in instructions.
#[derive(Debug, Default)]
pub struct Report {
    /// Events that were measured, and what each of them took.
    pub events: Vec<(Class, f64)>,
    /// Commits: what a conversion took, and taking over what came of it.
    pub commits: Vec<[f64; 2]>,
    /// Bytes of stack that a measured event took at most.
    pub stack_bytes: u32,
    /// Events whose answers differ.
    pub wrong: Vec<u32>,
    /// Events that were played.
    pub replayed: u32,
    /// Answers that were compared.
    pub compared: u32,
}

impl Report {
    /// Reads what the image says.
    ///
    /// # Panics
    /// On lines that it does not write, and where its clock does not count instructions.
    #[must_use]
    pub fn of(text: &str) -> Self {
        let mut run = Self::default();
        let (mut empty, mut repeats) = (0.0, 1.0);
        let number = |text: &str| text.parse::<f64>().expect("the image reports numbers");
        let each = |ticks: f64, empty: f64, repeats: f64| {
            (ticks - empty) * INSTRUCTIONS_PER_TICK / repeats + EMPTY
        };
        for line in text.lines() {
            match line.split(' ').collect::<Vec<_>>()[..] {
                ["delay", instructions, ticks] => check_clock(number(instructions), number(ticks)),
                ["empty", times, ticks] => (repeats, empty) = (number(times), number(ticks)),
                ["commit", conversion, taking_over] => run.commits.push(
                    [conversion, taking_over].map(|ticks| each(number(ticks), empty, repeats)),
                ),
                ["stack", bytes] => run.stack_bytes = number(bytes) as u32,
                ["wrong", event] => run.wrong.push(number(event) as u32),
                ["end", events, frames] => {
                    (run.replayed, run.compared) = (number(events) as u32, number(frames) as u32);
                }
                [class, ticks] => {
                    let class = class
                        .parse()
                        .ok()
                        .and_then(Class::from_byte)
                        .expect("a class of the recording");
                    run.events
                        .push((class, each(number(ticks), empty, repeats)));
                }
                _ => panic!("the image reports \"{line}\""),
            }
        }
        run
    }
}

/// Without `-icount shift=0`, or on another clock, the figures would be noise.
fn check_clock(instructions: f64, ticks: f64) {
    let per_tick = instructions / ticks;
    let is_right = (per_tick / INSTRUCTIONS_PER_TICK - 1.0).abs() < 1.0e-3;
    assert!(
        is_right,
        "SysTick counts {per_tick:.2} instructions a tick, not {INSTRUCTIONS_PER_TICK}"
    );
}
