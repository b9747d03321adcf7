//! candump logs: `(seconds.microseconds) interface identifier#data`, the format of `candump -l`.

use std::fmt::Write as _;
use std::io;

use embedded_can::{Frame, Id};
use protocol::CanFrame;

/// Frames of one interface with their times.
#[derive(Clone, Debug, Default)]
pub struct BusLog {
    interface: String,
    frames: Vec<(u64, CanFrame)>,
}

impl BusLog {
    /// An empty log of an interface.
    #[must_use]
    pub fn new(interface: &str) -> Self {
        Self {
            interface: interface.into(),
            frames: Vec::new(),
        }
    }

    /// Adds a frame.
    pub fn push(&mut self, at_us: u64, frame: &CanFrame) {
        self.frames.push((at_us, *frame));
    }

    /// The frames in the order of the bus.
    #[must_use]
    pub fn frames(&self) -> &[(u64, CanFrame)] {
        &self.frames
    }

    /// Writes the log.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn write(&self, out: &mut impl io::Write) -> io::Result<()> {
        let mut line = String::new();
        for (at_us, frame) in &self.frames {
            line.clear();
            text(&mut line, &self.interface, *at_us, frame);
            out.write_all(line.as_bytes())?;
        }
        Ok(())
    }
}

fn text(line: &mut String, interface: &str, at_us: u64, frame: &CanFrame) {
    let (seconds, micros) = (at_us / 1_000_000, at_us % 1_000_000);
    // Writing to a String cannot fail.
    let _ = write!(line, "({seconds:010}.{micros:06}) {interface} ");
    let _ = match frame.id() {
        Id::Standard(id) => write!(line, "{:03X}#", id.as_raw()),
        Id::Extended(id) => write!(line, "{:08X}#", id.as_raw()),
    };
    if frame.is_remote_frame() {
        let _ = write!(line, "R{}", frame.dlc());
    }
    for byte in frame.payload() {
        let _ = write!(line, "{byte:02X}");
    }
    line.push('\n');
}

#[cfg(test)]
mod tests {
    use super::*;
    use protocol::{AxisIds, Message, SyncCounter};

    #[test]
    fn a_line_is_what_candump_writes() {
        let mut log = BusLog::new("can0");
        log.push(
            1_000_250,
            &Message::Sync(SyncCounter::FIRST).encode(AxisIds::of_axis(0).unwrap()),
        );
        let mut out = Vec::new();
        log.write(&mut out).unwrap();
        assert_eq!(
            String::from_utf8(out).unwrap(),
            "(0000000001.000250) can0 080#01\n"
        );
    }
}
