//! The node on the executor says byte for byte what the node says when it is driven directly.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use protocol::cob::AxisIds;
use protocol::message::{Feedback, NmtCommand, Setpoint};
use protocol::states::ControlWord;
use protocol::weight::{LoadIncrements24, MotorIncrements, SetpointFine};
use protocol::{CanFrame, Message, SyncCounter};
use quadrant_host::port::{InProcessPort, Port};
use servo::Servo;

static STOP: AtomicBool = AtomicBool::new(false);

fn ids() -> AxisIds {
    AxisIds::of_axis(0).unwrap()
}

fn cycle(counter: SyncCounter) -> [CanFrame; 3] {
    let setpoint =
        Setpoint { control: ControlWord::SHUTDOWN, counter: counter.next(), position: SetpointFine::saturating(0) };
    let feedback = Feedback { motor: MotorIncrements(7), load: LoadIncrements24::from_counts(7), counter };
    [Message::Sync(counter), Message::Setpoint(setpoint), Message::Feedback(feedback)].map(|m| m.encode(ids()))
}

fn traffic() -> Vec<CanFrame> {
    let mut counter = SyncCounter::FIRST;
    let mut frames = vec![Message::Nmt(NmtCommand::StartRemoteNode, None).encode(ids())];
    for _ in 0..250 {
        frames.extend(cycle(counter));
        counter = counter.next();
    }
    frames
}

#[test]
fn the_executor_adds_nothing_and_loses_nothing() {
    let mut direct = Servo::new(ids());
    let mut wanted: Vec<CanFrame> = direct.boot().to_vec();
    wanted.extend(traffic().iter().flat_map(|frame| direct.on_frame(frame, 0)));

    let (node_end, our_end) = InProcessPort::pair().unwrap();
    let stop = || STOP.load(Ordering::Relaxed);
    let node = std::thread::spawn(move || quadrant_host::run(Servo::new(ids()), Port::InProcess(node_end), None, stop));
    let mut got = Vec::new();
    let patience = Instant::now() + Duration::from_secs(20);
    for frame in traffic() {
        while our_end.send(&frame).is_err() {
            assert!(Instant::now() < patience, "the node does not read");
            std::thread::yield_now();
        }
        while let Some(frame) = our_end.try_receive().unwrap() {
            got.push(frame);
        }
    }
    while got.len() < wanted.len() && Instant::now() < patience {
        got.extend(our_end.try_receive().unwrap());
    }
    STOP.store(true, Ordering::Relaxed);
    node.join().unwrap().unwrap();
    assert_eq!(got, wanted);
}
