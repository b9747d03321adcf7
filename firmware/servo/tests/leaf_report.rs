//! What a leaf reports of itself can be read from the node.

use protocol::leaf::{LeafReport, StartedBy};
use protocol::message::{self, Decoded, NmtCommand};
use protocol::sdo::{Address, Request, Response};
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
