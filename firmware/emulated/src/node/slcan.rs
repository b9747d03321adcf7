//! SLCAN, the serial line CAN of LAWICEL's CAN232 (manual 3, "Available commands"): one frame, one
//! line of hexadecimal digits.
//!
//! ```text
//! frame   = t iii l dd… | T iiiiiiii l dd…      data, standard or extended identifier
//!         | r iii l     | R iiiiiiii l          remote
//! line    = frame | command, then CR            0x0D; an adapter answers CR or z CR, BEL if it
//!                                               does not take it
//! ```
//!
//! This one file is part of two programs, the image and the bench that hands frames to it
//! (`hil-tests/src/emulated`).
#![allow(
    unreachable_pub,
    reason = "part of two programs: a module of a library in one of them"
)]

use embedded_can::{ExtendedId, Frame, Id, StandardId};
use heapless::Vec;
use protocol::CanFrame;

/// Ends every line.
pub const CR: u8 = b'\r';
/// The answer to a line that is not taken.
pub const BEL: u8 = 0x07;
/// The longest line: an extended data frame, and its end.
pub const LONGEST: usize = 1 + 8 + 1 + 16 + 1;

/// A line.
pub type Line = Vec<u8, LONGEST>;

const DIGITS: &[u8; 16] = b"0123456789ABCDEF";

/// The line of a frame, with its end.
pub fn line_of(frame: &CanFrame) -> Line {
    let mut line = Line::new();
    let (letter, id, digits) = match frame.id() {
        Id::Standard(id) => (b't', u32::from(id.as_raw()), 3),
        Id::Extended(id) => (b'T', id.as_raw(), 8),
    };
    let letter = if frame.is_remote_frame() {
        letter - (b't' - b'r')
    } else {
        letter
    };
    // A line has room for the longest frame.
    let _ = line.push(letter);
    push_hex(&mut line, u64::from(id), digits);
    push_hex(&mut line, frame.dlc() as u64, 1);
    for byte in frame.payload() {
        push_hex(&mut line, u64::from(*byte), 2);
    }
    let _ = line.push(CR);
    line
}

/// The frame of a line without its end; `None` for what is none.
pub fn frame_of(line: &[u8]) -> Option<CanFrame> {
    let (letter, rest) = line.split_first()?;
    let is_extended = letter.is_ascii_uppercase();
    let (id, rest) = rest.split_at_checked(if is_extended { 8 } else { 3 })?;
    let (length, data) = rest.split_at_checked(1)?;
    let length = usize::try_from(hex(length)?).ok().filter(|l| *l <= 8)?;
    let id = u32::try_from(hex(id)?).ok()?;
    let id: Id = if is_extended {
        ExtendedId::new(id)?.into()
    } else {
        StandardId::new(u16::try_from(id).ok()?)?.into()
    };
    match letter {
        b'r' | b'R' if data.is_empty() => CanFrame::new_remote(id, length),
        b't' | b'T' if data.len() == 2 * length => {
            let mut bytes = [0; 8];
            for (byte, digits) in bytes.iter_mut().zip(data.chunks(2)) {
                *byte = u8::try_from(hex(digits)?).ok()?;
            }
            CanFrame::new(id, bytes.get(..length)?)
        }
        _ => None,
    }
}

/// A number, highest digit first.
pub fn push_hex<const N: usize>(line: &mut Vec<u8, N>, value: u64, digits: u32) {
    for place in (0..digits).rev() {
        let digit = (value >> (4 * place)) & 0xF;
        let _ = line.push(DIGITS[digit as usize]);
    }
}

/// The number of some digits, one at least and sixteen at most.
pub fn hex(digits: &[u8]) -> Option<u64> {
    if digits.is_empty() || digits.len() > 16 {
        return None;
    }
    digits.iter().try_fold(0, |value, digit| {
        let digit = char::from(*digit).to_digit(16)?;
        Some(value << 4 | u64::from(digit))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_kind_of_frame_is_a_line_and_back() {
        let standard = StandardId::new(0x181).unwrap();
        let extended = ExtendedId::new(0x0604_0001).unwrap();
        let frames = [
            (CanFrame::new(standard, &[1, 0xAB]).unwrap(), "t181201AB\r"),
            (CanFrame::new(standard, &[]).unwrap(), "t1810\r"),
            (CanFrame::new_remote(standard, 8).unwrap(), "r1818\r"),
            (
                CanFrame::new(extended, &[0xFF; 8]).unwrap(),
                "T060400018FFFFFFFFFFFFFFFF\r",
            ),
            (CanFrame::new_remote(extended, 0).unwrap(), "R060400010\r"),
        ];
        for (frame, line) in frames {
            assert_eq!(line_of(&frame), line.as_bytes());
            assert_eq!(frame_of(line.trim_end().as_bytes()), Some(frame));
        }
    }

    #[test]
    fn what_is_no_frame_is_none() {
        for line in [
            "",
            "t",
            "t18",
            "t1819",
            "t1812",
            "t18120",
            "t181201A",
            "t181201ABC",
            "t8000",
            "x1810",
            "r18100",
            "T2000000000",
            "t18120/00",
        ] {
            assert_eq!(frame_of(line.as_bytes()), None, "{line}");
        }
    }
}
