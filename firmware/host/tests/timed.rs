//! At clock pace what the node does for a torque is timed. (A process has one executor, so each
//! test of one has a file.)

use std::os::unix::net::UnixStream;
use std::sync::mpsc::{Sender, channel};
use std::time::Duration;

use protocol::leaf::Timed;
use protocol::message::Torque;
use protocol::states::ControlWord;
use protocol::weight::TorqueMicroNm;
use protocol::{AxisIds, CanFrame, Message, Station, SyncCounter};
use quadrant_host::Pace;
use quadrant_host::port::{InProcessPort, Port};

/// What it takes for an answer, µs.
const SLOW_US: u64 = 20_000;

/// Answers every frame with a torque, after a while, and tells what was timed.
struct Answering {
    times: Sender<(Timed, u32)>,
}

impl Station for Answering {
    fn ids(&self) -> AxisIds {
        AxisIds::of_axis(0).unwrap()
    }

    fn boot(&mut self, _send: &mut dyn FnMut(CanFrame)) {}

    fn take(&mut self, _frame: &CanFrame, _now_us: u64, send: &mut dyn FnMut(CanFrame)) {
        std::thread::sleep(Duration::from_micros(SLOW_US));
        let torque = Torque {
            torque: TorqueMicroNm(0),
            control: ControlWord::default(),
            counter: SyncCounter::FIRST,
        };
        send(torque.encode(self.ids()));
    }

    fn time(&mut self, _now_us: u64, _send: &mut dyn FnMut(CanFrame)) {}

    fn wake_at_us(&self) -> Option<u64> {
        None
    }

    fn sync_due_us(&self) -> Option<u64> {
        None
    }

    fn took(&mut self, timed: Timed, ns: u32) {
        self.times.send((timed, ns)).unwrap();
    }
}

#[test]
fn what_a_node_does_for_a_torque_is_timed() {
    let (times, heard) = channel();
    let (node_end, port) = InProcessPort::pair().unwrap();
    let (stop, stopped) = UnixStream::pair().unwrap();
    let node = std::thread::spawn(move || {
        let answering = Box::new(Answering { times });
        quadrant_host::run(
            answering,
            Port::InProcess(node_end),
            None,
            Pace::Clock,
            &stopped,
        )
    });
    let sync = Message::Sync(SyncCounter::FIRST);
    port.send(&sync.encode(AxisIds::of_axis(0).unwrap()))
        .unwrap();
    let told = [(); 2].map(|()| heard.recv_timeout(Duration::from_secs(5)).unwrap());
    drop(stop);
    node.join().unwrap().unwrap();
    let [(first, cycle_ns), (second, whole_ns)] = told;
    assert_eq!(
        (first, second),
        (Timed::ControlCycle, Timed::ReceiveToTorque)
    );
    assert!(
        u64::from(cycle_ns) >= 1000 * SLOW_US && whole_ns >= cycle_ns,
        "{told:?}"
    );
}
