//! What the leaf that runs the node knows and the node does not: objects 2203h.

/// Why the node started.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u8)]
pub enum StartedBy {
    /// Power came, or a program began.
    #[default]
    Power = 0,
    /// The reset pin, or a debugger.
    Pin = 1,
    /// Software asked for it.
    Software = 2,
    /// The watchdog: the control executor missed a deadline beyond its contract, or hung.
    Watchdog = 3,
    /// A panic.
    Panic = 4,
    /// A fault of the processor.
    HardFault = 5,
    /// The supply fell below its limit.
    LowVoltage = 6,
}

impl StartedBy {
    /// All of them; the place of each is its code.
    pub const ALL: [Self; 7] = [
        Self::Power,
        Self::Pin,
        Self::Software,
        Self::Watchdog,
        Self::Panic,
        Self::HardFault,
        Self::LowVoltage,
    ];

    /// The code of the object.
    #[must_use]
    #[expect(clippy::as_conversions, reason = "the discriminant")]
    pub const fn code(self) -> u8 {
        self as u8
    }

    /// The cause of a code.
    #[must_use]
    pub fn from_code(code: u8) -> Option<Self> {
        Self::ALL.get(usize::from(code)).copied()
    }
}

/// What a leaf reports.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LeafReport {
    /// Why it started.
    pub started_by: StartedBy,
    /// Deadlines that it missed since.
    pub missed_deadlines: u32,
    /// The latest that it was, µs.
    pub latest_us: u32,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Servo, objects};
    use protocol::message::{self, Decoded, NmtCommand};
    use protocol::sdo::{Address, Request, Response};
    use protocol::{AxisIds, Message};

    #[test]
    fn a_cause_is_its_code_and_back() {
        for cause in StartedBy::ALL {
            assert_eq!(StartedBy::from_code(cause.code()), Some(cause));
        }
        assert_eq!(StartedBy::from_code(7), None);
    }

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
}
