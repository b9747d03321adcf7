//! Where the node's frames come from: a CAN interface, or the in-process bus.

use std::future::poll_fn;
use std::io::{self, ErrorKind};
use std::os::fd::{AsRawFd, RawFd};
use std::os::unix::net::UnixDatagram;
use std::task::Poll;
use std::time::Duration;

use bus::CanPort;
use embedded_can::{ExtendedId, Frame, Id, StandardId};
use protocol::CanFrame;

use crate::idle::{patience_ran_out, wake_when_readable};

/// A port of the node.
#[derive(Debug)]
pub enum Port {
    /// A CAN interface.
    Can(CanPort),
    /// A bus within this process (or between two that share a socket): one datagram per frame.
    InProcess(InProcessPort),
}

impl Port {
    /// The next frame; `None` where nothing happened for as long as `patience`.
    ///
    /// # Errors
    /// Where the interface is gone.
    pub async fn receive(&self, patience: Option<Duration>) -> io::Result<Option<CanFrame>> {
        poll_fn(|context| {
            let ran_out = patience_ran_out();
            match self.try_receive() {
                Ok(None) if !ran_out => {
                    wake_when_readable(self, patience, context.waker());
                    Poll::Pending
                }
                received => Poll::Ready(received),
            }
        })
        .await
    }

    fn try_receive(&self) -> io::Result<Option<CanFrame>> {
        match self {
            Self::Can(port) => port.try_receive(),
            Self::InProcess(port) => port.try_receive(),
        }
    }

    /// Sends a frame.
    ///
    /// # Errors
    /// Where the interface does not take it.
    pub fn send(&self, frame: &CanFrame) -> io::Result<()> {
        match self {
            Self::Can(port) => port.send(frame),
            Self::InProcess(port) => port.send(frame),
        }
    }
}

impl AsRawFd for Port {
    fn as_raw_fd(&self) -> RawFd {
        match self {
            Self::Can(port) => port.as_raw_fd(),
            Self::InProcess(port) => port.0.as_raw_fd(),
        }
    }
}

/// One end of an in-process bus.
#[derive(Debug)]
pub struct InProcessPort(UnixDatagram);

impl InProcessPort {
    /// Both ends of a bus.
    ///
    /// # Errors
    /// The kernel's.
    pub fn pair() -> io::Result<(Self, Self)> {
        let (a, b) = UnixDatagram::pair()?;
        a.set_nonblocking(true)?;
        b.set_nonblocking(true)?;
        Ok((Self(a), Self(b)))
    }

    /// A frame that is there already.
    ///
    /// # Errors
    /// The kernel's.
    pub fn try_receive(&self) -> io::Result<Option<CanFrame>> {
        let mut bytes = [0; 16];
        match self.0.recv(&mut bytes) {
            Ok(length) => Ok(unpack(&bytes[..length])),
            Err(error) if error.kind() == ErrorKind::WouldBlock => Ok(None),
            Err(error) => Err(error),
        }
    }

    /// Sends a frame.
    ///
    /// # Errors
    /// The kernel's.
    pub fn send(&self, frame: &CanFrame) -> io::Result<()> {
        self.0.send(&pack(frame)).map(drop)
    }
}

impl AsRawFd for InProcessPort {
    fn as_raw_fd(&self) -> RawFd {
        self.0.as_raw_fd()
    }
}

/// Identifier with the extended flag in bit 31 and the remote flag in bit 30, data length, data.
fn pack(frame: &CanFrame) -> Vec<u8> {
    let id = match frame.id() {
        Id::Standard(id) => u32::from(id.as_raw()),
        Id::Extended(id) => id.as_raw() | 1 << 31,
    };
    let id = if frame.is_remote_frame() {
        id | 1 << 30
    } else {
        id
    };
    let length = u8::try_from(frame.dlc()).unwrap_or(8);
    [&id.to_le_bytes()[..], &[length], frame.payload()].concat()
}

fn unpack(bytes: &[u8]) -> Option<CanFrame> {
    let (head, rest) = bytes.split_first_chunk::<4>()?;
    let (length, data) = rest.split_first()?;
    let head = u32::from_le_bytes(*head);
    let low = head & 0x1FFF_FFFF;
    let id: Id = if head >> 31 == 1 {
        ExtendedId::new(low)?.into()
    } else {
        StandardId::new(u16::try_from(low).ok()?)?.into()
    };
    if head >> 30 & 1 == 1 {
        CanFrame::new_remote(id, usize::from(*length))
    } else {
        CanFrame::new(id, data)
    }
}
