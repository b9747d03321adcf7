//! What a leaf reports of itself can be read from the node.

use protocol::leaf::{LeafReport, StartedBy, Timed};
use protocol::message::{self, Decoded, NmtCommand};
use protocol::sdo::{Address, Expedited, Request, Response};
use protocol::{AxisIds, Message, Station};
use servo::{Servo, objects};

/// What the node says of an object.
fn said(servo: &mut Servo, address: Address) -> u32 {
    let ids = servo.ids();
    let asked = Message::SdoRequest(Request::Upload(address)).encode(ids);
    let frames = servo.on_frame(&asked, 0).to_vec();
    match message::decode(ids, &frames[0]).unwrap() {
        Decoded::Message(Message::SdoResponse(Response::Uploaded(of, value))) => {
            assert_eq!(of, address);
            value.to_u32()
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn what_a_leaf_reports_is_read_and_outlives_a_reset_of_the_node() {
    let ids = AxisIds::of_axis(0).unwrap();
    let mut servo = Servo::new(ids);
    servo.report(LeafReport {
        started_by: StartedBy::Watchdog,
        missed_deadlines: 7,
        latest_us: 2900,
    });
    for _ in 0..2 {
        let told = [
            objects::STARTED_BY,
            objects::MISSED_DEADLINES,
            objects::LATEST,
        ]
        .map(|address| said(&mut servo, address));
        assert_eq!(told, [3, 7, 2900]);
        let reset = Message::Nmt(NmtCommand::ResetNode, None).encode(ids);
        assert_eq!(servo.on_frame(&reset, 0).len(), 1, "its boot-up");
    }
}

#[test]
fn what_a_leaf_has_timed_is_read_by_class_and_cleared_by_a_write() {
    let ids = AxisIds::of_axis(0).unwrap();
    let mut servo = Servo::new(ids);
    servo.took(Timed::ControlCycle, 21_000);
    servo.took(Timed::ControlCycle, 19_000);
    servo.took(Timed::ReceiveToTorque, 40_000);
    let index = objects::CONTROL_CYCLE_INDEX;
    let numbers = |servo: &mut Servo, index: u16| -> Vec<u32> {
        (0..=16)
            .map(|sub| said(servo, Address::new(index, sub)))
            .collect()
    };
    let told = numbers(&mut servo, index);
    assert_eq!(told[..5], [16, 2, 19_000, 21_000, 40]);
    assert_eq!(told[5..], [0, 0, 0, 0, 0, 2, 0, 0, 0, 0, 0, 0]);
    for (address, is_written) in [
        (Address::new(index, 1), true),
        (Address::new(index, 7), false),
        (Address::new(index, 0), false),
    ] {
        let asked = Message::SdoRequest(Request::Download(address, Expedited::u32(0))).encode(ids);
        let answer = message::decode(ids, &servo.on_frame(&asked, 0)[0]).unwrap();
        let written = Decoded::Message(Message::SdoResponse(Response::Downloaded(address)));
        assert_eq!(answer == written, is_written, "{address:?}");
    }
    assert_eq!(numbers(&mut servo, index)[1..], [0; 16]);
    assert_eq!(
        said(
            &mut servo,
            Address::new(objects::RECEIVE_TO_TORQUE_INDEX, 1)
        ),
        1
    );
}
