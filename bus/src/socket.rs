//! A port on a CAN interface of the kernel (SocketCAN).
//!
//! The kernel filters by identifier, so that a process wakes only for frames that concern it.
//! Filters match 11-bit identifiers with or without RTR: a remote frame has to reach the decoder,
//! which refuses it by name.

use std::io::{self, ErrorKind};
use std::os::fd::{AsRawFd, RawFd};
use std::time::Duration;

use embedded_can::{Frame, Id, StandardId};
use protocol::CanFrame;
use socketcan::{CanFilter, CanSocket, Socket, SocketOptions};

/// A non-blocking port.
#[derive(Debug)]
pub struct CanPort {
    socket: CanSocket,
}

/// How long a full transmit queue is waited for.
const QUEUE_FULL_WAIT: Duration = Duration::from_micros(200);
/// How often, before the bus counts as dead: one second.
const QUEUE_FULL_TRIES: u32 = 5000;

impl CanPort {
    /// Opens an interface for the given identifiers; all of them where `accept` is empty.
    ///
    /// # Errors
    /// The kernel's, with the interface's name and what to do.
    pub fn open(interface: &str, accept: &[StandardId]) -> io::Result<Self> {
        let socket = CanSocket::open(interface).map_err(|error| explained(interface, &error))?;
        if !accept.is_empty() {
            let mask = libc::CAN_SFF_MASK | libc::CAN_EFF_FLAG;
            let filter = |id: &StandardId| CanFilter::new(u32::from(id.as_raw()), mask);
            socket.set_filters(&accept.iter().map(filter).collect::<Vec<_>>())?;
        }
        socket.set_recv_own_msgs(false)?;
        socket.set_nonblocking(true)?;
        Ok(Self { socket })
    }

    /// A frame that is there already; `None` where there is none.
    ///
    /// # Errors
    /// The kernel's (interface down, for example).
    pub fn try_receive(&self) -> io::Result<Option<CanFrame>> {
        loop {
            match self.socket.read_frame() {
                Ok(frame) => {
                    if let Some(frame) = from_socket(&frame) {
                        return Ok(Some(frame));
                    }
                }
                Err(error) if error.kind() == ErrorKind::WouldBlock => return Ok(None),
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) => return Err(error),
            }
        }
    }

    /// Waits for a frame; `None` after the timeout, or where a signal came first.
    ///
    /// # Errors
    /// The kernel's.
    pub fn receive(&self, timeout: Duration) -> io::Result<Option<CanFrame>> {
        if let Some(frame) = self.try_receive()? {
            return Ok(Some(frame));
        }
        wait(&mut [readable(self.as_raw_fd())], Some(timeout))?;
        self.try_receive()
    }

    /// The same with a timeout that several calls share.
    ///
    /// # Errors
    /// The kernel's.
    pub fn receive_within(&self, left: &mut Duration) -> io::Result<Option<CanFrame>> {
        if let Some(frame) = self.try_receive()? {
            return Ok(Some(frame));
        }
        wait_within(&mut [readable(self.as_raw_fd())], left)?;
        self.try_receive()
    }

    /// Sends a frame; waits where the interface's queue is full.
    ///
    /// # Errors
    /// The kernel's, or `TimedOut` where the queue stays full for a second: nobody acknowledges on
    /// this bus.
    pub fn send(&self, frame: &CanFrame) -> io::Result<()> {
        let frame = to_socket(frame)?;
        for _ in 0..QUEUE_FULL_TRIES {
            match self.socket.write_frame(&frame) {
                Ok(()) => return Ok(()),
                Err(error) if is_full(&error) => std::thread::sleep(QUEUE_FULL_WAIT),
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) => return Err(error),
            }
        }
        Err(io::Error::new(
            ErrorKind::TimedOut,
            "the transmit queue stays full: is another node on the bus to acknowledge frames?",
        ))
    }
}

impl AsRawFd for CanPort {
    fn as_raw_fd(&self) -> RawFd {
        self.socket.as_raw_fd()
    }
}

fn is_full(error: &io::Error) -> bool {
    error.kind() == ErrorKind::WouldBlock || error.raw_os_error() == Some(libc::ENOBUFS)
}

fn explained(interface: &str, error: &io::Error) -> io::Error {
    let what_to_do = match error.raw_os_error() {
        Some(libc::ENODEV) => {
            "there is no such interface; `ip link add dev vcan0 type vcan && ip link set up vcan0` makes a virtual one"
        }
        Some(libc::EAFNOSUPPORT) => {
            "this kernel has no CAN; `sudo modprobe vcan`, or run under scripts/with-vcan"
        }
        _ => "check the interface with `ip -details link show`",
    };
    io::Error::new(
        error.kind(),
        format!("cannot open CAN interface {interface}: {error}; {what_to_do}"),
    )
}

fn from_socket(frame: &socketcan::CanFrame) -> Option<CanFrame> {
    match frame {
        socketcan::CanFrame::Data(frame) => CanFrame::new(frame.id(), frame.data()),
        socketcan::CanFrame::Remote(frame) => CanFrame::new_remote(frame.id(), frame.dlc()),
        // An error frame is the controller's news about the bus, not a message of a node.
        socketcan::CanFrame::Error(_) => None,
    }
}

fn to_socket(frame: &CanFrame) -> io::Result<socketcan::CanFrame> {
    let id: Id = frame.id();
    let made = if frame.is_remote_frame() {
        socketcan::CanFrame::new_remote(id, frame.dlc())
    } else {
        socketcan::CanFrame::new(id, frame.payload())
    };
    made.ok_or_else(|| io::Error::new(ErrorKind::InvalidInput, "not a classic CAN frame"))
}

/// How a waiting ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Waited {
    /// A descriptor is readable, or its other end is gone.
    Ready,
    /// The timeout is over.
    TimedOut,
    /// A signal came.
    Interrupted,
}

/// Asks [`wait`] for a descriptor that is readable.
#[must_use]
pub const fn readable(fd: RawFd) -> libc::pollfd {
    libc::pollfd {
        fd,
        events: libc::POLLIN,
        revents: 0,
    }
}

/// Waits until a descriptor is ready (its `revents` tell which), or the timeout is over; without a
/// timeout for as long as it takes.
///
/// # Errors
/// The kernel's.
pub fn wait(entries: &mut [libc::pollfd], timeout: Option<Duration>) -> io::Result<Waited> {
    poll(entries, timeout.map(timespec).as_mut())
}

/// The same with a timeout from which the time of the waiting is taken, so that several waits share
/// it without a look at the clock.
///
/// # Errors
/// The kernel's.
pub fn wait_within(entries: &mut [libc::pollfd], left: &mut Duration) -> io::Result<Waited> {
    let mut limit = timespec(*left);
    let waited = poll(entries, Some(&mut limit));
    let nanos = u32::try_from(limit.tv_nsec).unwrap_or(0);
    *left = Duration::new(u64::try_from(limit.tv_sec).unwrap_or(0), nanos);
    waited
}

fn timespec(timeout: Duration) -> libc::timespec {
    libc::timespec {
        tv_sec: libc::time_t::try_from(timeout.as_secs()).unwrap_or(libc::time_t::MAX),
        tv_nsec: libc::c_long::from(timeout.subsec_nanos()),
    }
}

/// `ppoll`, not `poll`, which counts in milliseconds; and the system call itself, which writes the
/// time that is left into the limit (ppoll(2), "C library/kernel differences").
fn poll(entries: &mut [libc::pollfd], limit: Option<&mut libc::timespec>) -> io::Result<Waited> {
    let limit = limit.map_or(std::ptr::null_mut(), std::ptr::from_mut);
    let no_mask = std::ptr::null::<libc::sigset_t>();
    #[expect(unsafe_code, reason = "the raw ppoll has no safe wrapper")]
    // SAFETY: `entries` holds that number of valid pollfd for the time of the call, `limit` is null
    // or points to a timespec that lives as long and is ours to be written; without a mask its size
    // is not looked at.
    let ready = unsafe {
        libc::syscall(
            libc::SYS_ppoll,
            entries.as_mut_ptr(),
            entries.len(),
            limit,
            no_mask,
            0_usize,
        )
    };
    match ready {
        -1 => {
            let error = io::Error::last_os_error();
            if error.kind() == ErrorKind::Interrupted {
                Ok(Waited::Interrupted)
            } else {
                Err(error)
            }
        }
        0 => Ok(Waited::TimedOut),
        _ => Ok(Waited::Ready),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::os::unix::net::UnixDatagram;

    #[test]
    fn waits_share_a_time_and_a_frame_does_not_start_it_anew() {
        let (ours, theirs) = UnixDatagram::pair().unwrap();
        let mut left = Duration::from_millis(60);
        let sender = std::thread::spawn(move || {
            std::thread::sleep(Duration::from_millis(20));
            theirs.send(&[1]).unwrap();
            theirs
        });
        let mut entries = [readable(ours.as_raw_fd())];
        assert_eq!(wait_within(&mut entries, &mut left).unwrap(), Waited::Ready);
        assert!(left <= Duration::from_millis(41), "{left:?}");
        ours.recv(&mut [0]).unwrap();
        assert_eq!(
            wait_within(&mut entries, &mut left).unwrap(),
            Waited::TimedOut
        );
        assert_eq!(left, Duration::ZERO);
        drop(sender.join());
    }
}
