//! What a servo heard and answered, as bytes: the host writes them, the image reads them.
//!
//! ```text
//! recording = number of bytes that follow (u32), event, event, …
//! event     = class (u8), measured (u8), time in µs (u64), frame,
//!             number of answers (u8), frame, frame, …
//! frame     = identifier (u16), length (u8), data (8 bytes)           all little-endian
//! ```
//!
//! Boot-up and passing time have no frame; a frame of zeros stands in its place. This one file is
//! part of two programs, the image and the tests that record (`hil-tests/src/emulated`), so that
//! there is one description of the format.
#![allow(
    dead_code,
    unreachable_pub,
    reason = "each of the two programs uses its half: one writes, the other reads"
)]

use embedded_can::{Frame, Id, StandardId};
use protocol::CanFrame;

/// Bytes of a frame.
pub const FRAME: usize = 11;
/// Where QEMU's loader puts the recording: the PSRAM of the mps2-an386.
pub const ADDRESS: usize = 0x2100_0000;
/// Size of that PSRAM.
pub const SPACE: usize = 16 << 20;

/// What happens to the servo. The discriminant is the byte in the recording and in the image's
/// report.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub enum Class {
    /// It boots.
    Boot,
    /// Time passes.
    Time,
    /// A SYNC comes.
    Sync,
    /// A setpoint comes.
    Setpoint,
    /// A feedback comes.
    Feedback,
    /// Any other frame comes.
    Other,
}

impl Class {
    /// All classes; the place of each is its byte.
    pub const ALL: [Self; 6] = [
        Self::Boot,
        Self::Time,
        Self::Sync,
        Self::Setpoint,
        Self::Feedback,
        Self::Other,
    ];

    /// The class of a byte.
    pub fn from_byte(byte: u8) -> Option<Self> {
        Self::ALL.get(usize::from(byte)).copied()
    }
}

/// A frame as it stands in the recording; `None` for what no node of ours sends or hears.
pub fn to_bytes(frame: &CanFrame) -> Option<[u8; FRAME]> {
    let Id::Standard(id) = frame.id() else {
        return None;
    };
    let mut bytes = [0; FRAME];
    let (head, data) = bytes.split_at_mut(3);
    head[..2].copy_from_slice(&id.as_raw().to_le_bytes());
    head[2] = u8::try_from(frame.dlc())
        .ok()
        .filter(|_| !frame.is_remote_frame())?;
    data[..frame.dlc()].copy_from_slice(frame.data());
    Some(bytes)
}

/// The frame of some bytes.
pub fn from_bytes([low, high, length, data @ ..]: [u8; FRAME]) -> Option<CanFrame> {
    let id = StandardId::new(u16::from_le_bytes([low, high]))?;
    CanFrame::new(id, data.get(..usize::from(length))?)
}

/// An event, read where it lies.
#[derive(Clone, Copy, Debug)]
pub struct Event<'a> {
    /// What happens.
    pub class: Class,
    /// Whether its instructions are wanted.
    pub is_measured: bool,
    /// When.
    pub now_us: u64,
    /// The frame that comes, if one does.
    pub frame: [u8; FRAME],
    /// What the host's servo answered.
    pub answers: &'a [[u8; FRAME]],
}

impl Event<'_> {
    /// Adds the event to a recording.
    pub fn write(&self, out: &mut impl Extend<u8>) {
        out.extend([self.class as u8, u8::from(self.is_measured)]);
        out.extend(self.now_us.to_le_bytes());
        out.extend(self.frame);
        out.extend([u8::try_from(self.answers.len()).unwrap_or(u8::MAX)]);
        self.answers.iter().for_each(|answer| out.extend(*answer));
    }
}

/// Reads the events of a recording; ends where they end, or where the bytes make no sense.
#[derive(Clone, Debug)]
pub struct Events<'a>(pub &'a [u8]);

impl<'a> Iterator for Events<'a> {
    type Item = Event<'a>;

    fn next(&mut self) -> Option<Event<'a>> {
        let ([class, measured], rest) = self.0.split_first_chunk()?;
        let (now_us, rest) = rest.split_first_chunk()?;
        let (frame, rest) = rest.split_first_chunk()?;
        let (answers, rest) = rest.split_first()?;
        let (answers, rest) = rest.split_at_checked(FRAME * usize::from(*answers))?;
        self.0 = rest;
        Some(Event {
            class: Class::from_byte(*class)?,
            is_measured: *measured != 0,
            now_us: u64::from_le_bytes(*now_us),
            frame: *frame,
            answers: answers.as_chunks().0,
        })
    }
}
