//! The node on the executor says byte for byte what the node says when it is driven directly.

use std::os::unix::net::UnixStream;
use std::time::{Duration, Instant};

use embedded_can::{Frame, Id};
use protocol::cob::{AxisIds, FrameKind};
use protocol::message::{Feedback, NmtCommand, Setpoint};
use protocol::states::ControlWord;
use protocol::weight::{LoadIncrements24, MotorIncrements, SetpointFine};
use protocol::{CanFrame, Message, Station, SyncCounter};
use quadrant_host::Pace;
use quadrant_host::port::{InProcessPort, Port};
use servo::Servo;

fn ids() -> AxisIds {
    AxisIds::of_axis(0).unwrap()
}

fn cycle(counter: SyncCounter) -> [CanFrame; 3] {
    let setpoint = Setpoint {
        control: ControlWord::SHUTDOWN,
        counter: counter.next(),
        position: SetpointFine::saturating(0),
    };
    let feedback = Feedback {
        motor: MotorIncrements(7),
        load: LoadIncrements24::from_counts(7),
        counter,
    };
    [
        Message::Sync(counter),
        Message::Setpoint(setpoint),
        Message::Feedback(feedback),
    ]
    .map(|m| m.encode(ids()))
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
    let mut wanted: Vec<CanFrame> = Vec::new();
    Station::boot(&mut direct, &mut |frame| wanted.push(frame));
    let mut now_us = 0;
    for frame in traffic() {
        // Bus time: one period per SYNC, from the first one on.
        if frame.id() == Id::Standard(ids().identifier(FrameKind::Sync)) {
            now_us = direct.sync_due_us().unwrap_or(now_us);
        }
        direct.take(&frame, now_us, &mut |frame| wanted.push(frame));
    }

    let (node_end, our_end) = InProcessPort::pair().unwrap();
    let (stop, stopped) = UnixStream::pair().unwrap();
    let pace = Pace::Lockstep {
        deadline: Duration::from_secs(20),
    };
    let node = std::thread::spawn(move || {
        quadrant_host::run(
            Box::new(Servo::new(ids())),
            Port::InProcess(node_end),
            None,
            pace,
            &stopped,
        )
    });
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
    drop(stop);
    node.join().unwrap().unwrap();
    assert_eq!(got, wanted);
}
