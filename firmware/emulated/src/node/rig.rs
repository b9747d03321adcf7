//! What the bench says beside SLCAN, so that a node has the bench's time instead of its own.
//!
//! ```text
//! @ time CR      to the node: the time of what follows, µs, hexadecimal
//! ~ CR           to the node: time passes
//! w wake due CR  from the node, before it is ready again: when it wants to be woken and when it
//!                waits for SYNC, 16 digits each, or 16 times '-'
//! ```
//!
//! No SLCAN adapter uses these letters, and a kernel ignores them. This one file is part of two
//! programs, as `slcan.rs`.
#![allow(
    unreachable_pub,
    dead_code,
    reason = "part of two programs, of which each uses its half"
)]

use heapless::Vec;

use super::slcan::{CR, hex, push_hex};

/// Begins a line with the time.
pub const AT: u8 = b'@';
/// Time passes.
pub const PASSES: u8 = b'~';
/// Begins a line with what the node waits for.
pub const WAITS: u8 = b'w';
/// Letter and two times.
pub const LONGEST: usize = 1 + 2 * DIGITS + 1;
const DIGITS: usize = 16;

/// The line of two times.
pub fn line_of(times_us: [Option<u64>; 2]) -> Vec<u8, LONGEST> {
    let mut line = Vec::new();
    let _ = line.push(WAITS);
    for time_us in times_us {
        match time_us {
            Some(time_us) => push_hex(&mut line, time_us, 16),
            None => {
                let _ = line.extend_from_slice(&[b'-'; DIGITS]);
            }
        }
    }
    let _ = line.push(CR);
    line
}

/// The two times of a line behind its letter, without its end; `None` for what is no such line.
pub fn times_of(digits: &[u8]) -> Option<[Option<u64>; 2]> {
    let (first, second) = digits.split_at_checked(DIGITS)?;
    let time = |digits: &[u8]| {
        if digits == [b'-'; DIGITS] {
            Some(None)
        } else {
            hex(digits).map(Some)
        }
    };
    Some([time(first)?, time(second)?])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_a_line_and_back() {
        for times in [[None, None], [Some(0), Some(u64::MAX)], [Some(1300), None]] {
            let line = line_of(times);
            assert_eq!(times_of(&line[1..line.len() - 1]), Some(times));
        }
        assert_eq!(times_of(b"12"), None);
    }
}
