//! A station with alarms at given times, which says when they rang; and the leaf that drives it in
//! a thread.

use std::os::unix::net::UnixStream;
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use protocol::cob::AxisIds;
use protocol::message::NmtState;
use protocol::{CanFrame, Message, Station};
use quadrant_host::Pace;
use quadrant_host::port::{InProcessPort, Port};

pub(crate) fn ids() -> AxisIds {
    AxisIds::of_axis(0).unwrap()
}

/// Rings at its alarms, and answers nothing. An alarm that is past when a frame comes rings before
/// it is taken.
struct Probe {
    alarms_us: Vec<u64>,
    sync_due_us: Option<u64>,
}

impl Probe {
    fn ring(&mut self, now_us: u64, send: &mut dyn FnMut(CanFrame)) {
        if self
            .alarms_us
            .first()
            .is_some_and(|alarm_us| *alarm_us <= now_us)
        {
            self.alarms_us.remove(0);
            send(Message::PlantHeartbeat(NmtState::Operational).encode(ids()));
        }
    }
}

impl Station for Probe {
    fn ids(&self) -> AxisIds {
        ids()
    }

    fn boot(&mut self, _send: &mut dyn FnMut(CanFrame)) {}

    fn take(&mut self, _frame: &CanFrame, now_us: u64, send: &mut dyn FnMut(CanFrame)) {
        self.ring(now_us, send);
    }

    fn time(&mut self, now_us: u64, send: &mut dyn FnMut(CanFrame)) {
        self.ring(now_us, send);
    }

    fn wake_at_us(&self) -> Option<u64> {
        self.alarms_us.first().copied()
    }

    fn sync_due_us(&self) -> Option<u64> {
        self.sync_due_us
    }
}

/// A probe that is being driven.
pub(crate) struct Running {
    pub(crate) port: InProcessPort,
    begun: Instant,
    stop: UnixStream,
    node: JoinHandle<std::io::Result<()>>,
}

impl Running {
    /// With its alarms, and the time at which it says that SYNC is due.
    pub(crate) fn start(alarms_us: Vec<u64>, sync_due_us: Option<u64>, pace: Pace) -> Self {
        let (node_end, port) = InProcessPort::pair().unwrap();
        let (stop, stopped) = UnixStream::pair().unwrap();
        let begun = Instant::now();
        let node = std::thread::spawn(move || {
            quadrant_host::run(
                Box::new(Probe {
                    alarms_us,
                    sync_due_us,
                }),
                Port::InProcess(node_end),
                None,
                pace,
                &stopped,
            )
        });
        Self {
            port,
            begun,
            stop,
            node,
        }
    }

    /// Time since the start.
    pub(crate) fn elapsed(&self) -> Duration {
        self.begun.elapsed()
    }

    /// Waits for the next alarm; when it rang, or `None` after `patience`.
    pub(crate) fn rang(&self, patience: Duration) -> Option<Duration> {
        let end = Instant::now() + patience;
        while Instant::now() < end {
            if self.port.try_receive().unwrap().is_some() {
                return Some(self.elapsed());
            }
            std::thread::sleep(Duration::from_micros(200));
        }
        None
    }

    /// Asks it to stop, as a signal does.
    pub(crate) fn stop(self) {
        drop(self.stop);
        self.node.join().unwrap().unwrap();
    }
}
