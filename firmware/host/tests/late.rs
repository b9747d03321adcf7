//! At clock pace a deadline that is missed is counted, and the node can tell.

use std::os::unix::net::UnixStream;
use std::sync::mpsc::{Sender, channel};
use std::time::Duration;

use protocol::leaf::LeafReport;
use protocol::{AxisIds, CanFrame, Station};
use quadrant_host::Pace;
use quadrant_host::port::{InProcessPort, Port};

/// What it takes too long for, µs.
const SLOW_US: u64 = 20_000;

/// Takes its time once, when it is woken the second time.
struct Slow {
    woken: u64,
    reports: Sender<LeafReport>,
}

impl Station for Slow {
    fn ids(&self) -> AxisIds {
        AxisIds::of_axis(0).unwrap()
    }

    fn boot(&mut self, _send: &mut dyn FnMut(CanFrame)) {}

    fn take(&mut self, _frame: &CanFrame, _now_us: u64, _send: &mut dyn FnMut(CanFrame)) {}

    fn time(&mut self, _now_us: u64, _send: &mut dyn FnMut(CanFrame)) {
        self.woken += 1;
        if self.woken == 2 {
            std::thread::sleep(Duration::from_micros(SLOW_US));
        }
    }

    fn wake_at_us(&self) -> Option<u64> {
        (self.woken < 3).then(|| 100_000 * (self.woken + 1))
    }

    fn sync_due_us(&self) -> Option<u64> {
        None
    }

    fn report(&mut self, leaf: LeafReport) {
        self.reports.send(leaf).unwrap();
    }
}

#[test]
fn what_a_node_is_late_with_is_counted() {
    let (reports, heard) = channel();
    let (node_end, _port) = InProcessPort::pair().unwrap();
    let (stop, stopped) = UnixStream::pair().unwrap();
    let node = std::thread::spawn(move || {
        let slow = Box::new(Slow { woken: 0, reports });
        quadrant_host::run(slow, Port::InProcess(node_end), None, Pace::Clock, &stopped)
    });
    let told: Vec<LeafReport> = (0..3)
        .map(|_| heard.recv_timeout(Duration::from_secs(5)).unwrap())
        .collect();
    drop(stop);
    node.join().unwrap().unwrap();
    // A busy machine may be late by itself.
    assert!(
        told[1].missed_deadlines > told[0].missed_deadlines,
        "{told:?}"
    );
    assert!(u64::from(told[1].latest_us) >= SLOW_US, "{told:?}");
    assert!(told[2].latest_us >= told[1].latest_us, "{told:?}");
}
