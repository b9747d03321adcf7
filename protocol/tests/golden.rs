//! Golden frames, the agreement of codec and table, and the DBC at the crate root.

use embedded_can::{Frame, StandardId};
use proptest::prelude::*;
use protocol::cob::{AxisIds, FrameKind, NodeId};
use protocol::message::{
    Decoded, EmergencyMessage, Feedback, NmtCommand, NmtState, PlantStatus, Setpoint, Status,
    Torque, decode, decode_as,
};
use protocol::sdo;
use protocol::states::{BrakeState, ControlWord, DriveState, StatusWord};
use protocol::table::{FRAMES, Signal};
use protocol::weight::{
    FollowingError24, LoadIncrements24, MotorIncrements, SetpointFine, TorqueMicroNm,
    TorquePerMille,
};
use protocol::{CanFrame, Fault, Message, SyncCounter};

fn axis(index: u8) -> AxisIds {
    AxisIds::of_axis(index).unwrap()
}

fn count(value: u8) -> SyncCounter {
    SyncCounter::new(value).unwrap()
}

fn hex(frame: &CanFrame) -> String {
    let embedded_can::Id::Standard(id) = frame.id() else {
        panic!("extended")
    };
    let data = frame
        .payload()
        .iter()
        .fold(String::new(), |text, byte| text + &format!("{byte:02X}"));
    format!("{:03X}#{data}", id.as_raw())
}

/// Each frame as candump writes it. A change here breaks every node in the field.
fn golden() -> Vec<(Message, &'static str)> {
    let feedback = Feedback {
        motor: MotorIncrements(-1_048_576),
        load: LoadIncrements24::from_counts(-1_000_000),
        counter: count(240),
    };
    let torque = Torque {
        torque: TorqueMicroNm(636_620),
        control: ControlWord::ENABLE_OPERATION,
        counter: count(1),
    };
    let setpoint = Setpoint {
        control: ControlWord::ENABLE_OPERATION,
        counter: count(2),
        position: SetpointFine::saturating(-2_560_000_000),
    };
    let plant_status = PlantStatus {
        status: StatusWord::of(DriveState::OperationEnabled).with(StatusWord::VOLTAGE_ENABLED),
        brake: BrakeState::Open,
        fault: None,
        torque: TorqueMicroNm(-2500),
    };
    let status = Status {
        status: StatusWord::of(DriveState::Fault),
        following_error: FollowingError24::saturating(-2),
        torque: TorquePerMille(-44),
        fault: Some(Fault::FeedbackMissing),
    };
    let emergency = EmergencyMessage::new(
        0x8611,
        canopen_rs::emcy::ErrorRegister(0x21),
        [Fault::FollowingError.code(), 1, 2, 3, 4],
    );
    vec![
        (Message::Nmt(NmtCommand::StartRemoteNode, None), "000#0100"),
        (
            Message::Nmt(NmtCommand::ResetCommunication, NodeId::new(0x11)),
            "000#8211",
        ),
        (Message::Sync(count(7)), "080#07"),
        (Message::Feedback(feedback), "191#0000F0FFC0BDF0F0"),
        (Message::Torque(torque), "211#CCB609000F0001"),
        (Message::Setpoint(setpoint), "201#0F000200806967FF"),
        (Message::PlantStatus(plant_status), "291#370003003CF6FFFF"),
        (Message::Status(status), "381#0800FEFFFFD4FF02"),
        (Message::ServoHeartbeat(NmtState::Operational), "701#05"),
        (Message::PlantHeartbeat(NmtState::Initialising), "711#00"),
        (Message::ServoEmergency(emergency), "081#1186210401020304"),
        (Message::PlantEmergency(emergency), "091#1186210401020304"),
        (
            Message::SdoRequest(sdo::Request::Upload(sdo::Address::new(0x1000, 0))),
            "601#4000100000000000",
        ),
        (
            Message::SdoResponse(sdo::Response::Aborted(
                sdo::Address::new(0x2100, 3),
                sdo::AbortCode::ValueTooHigh.value(),
            )),
            "581#8000210331000906",
        ),
    ]
}

#[test]
fn every_message_has_its_golden_bytes_and_comes_back() {
    for (message, wanted) in golden() {
        let frame = message.encode(axis(0));
        assert_eq!(hex(&frame), wanted, "{message:?}");
        assert_eq!(decode(axis(0), &frame), Ok(Decoded::Message(message)));
    }
}

#[test]
fn the_second_axis_does_not_take_the_frames_of_the_first() {
    for (message, _) in golden() {
        let frame = message.encode(axis(0));
        let broadcast = matches!(message.kind(), FrameKind::Nmt | FrameKind::Sync);
        assert_eq!(
            decode(axis(1), &frame) == Ok(Decoded::Foreign),
            !broadcast,
            "{message:?}"
        );
    }
}

fn extract(payload: &[u8], signal: &Signal) -> i64 {
    let mut bytes = [0; 8];
    bytes[..payload.len()].copy_from_slice(payload);
    let raw = i128::from(u64::from_le_bytes(bytes)) >> signal.start & ((1 << signal.length) - 1);
    let sign = signal.signed && raw >> (signal.length - 1) == 1;
    i64::try_from(if sign {
        raw - (1 << signal.length)
    } else {
        raw
    })
    .unwrap()
}

fn signal_of(message: Message, name: &str) -> i64 {
    let spec = FRAMES
        .iter()
        .find(|spec| spec.kind == message.kind())
        .unwrap();
    let signal = spec
        .signals
        .iter()
        .find(|signal| signal.name == name)
        .unwrap();
    extract(message.encode(axis(0)).payload(), signal)
}

proptest! {
    #[test]
    fn the_table_reads_what_the_codec_wrote(
        motor in any::<i32>(), load in any::<i32>(), torque in any::<i32>(), counter in 1_u8..=240,
        position in -SetpointFine::LIMIT..=SetpointFine::LIMIT, control in any::<u16>(), error in any::<i32>(),
    ) {
        let counter = count(counter);
        let feedback = Message::Feedback(Feedback {
            motor: MotorIncrements(motor), load: LoadIncrements24::from_counts(load.into()), counter });
        prop_assert_eq!(signal_of(feedback, "MotorPosition"), i64::from(motor));
        prop_assert_eq!(signal_of(feedback, "LoadPositionLow24"), i64::from(load).rem_euclid(1 << 24));
        prop_assert_eq!(signal_of(feedback, "Counter"), i64::from(counter.get()));
        let command = Message::Torque(Torque { torque: TorqueMicroNm(torque), control: ControlWord(control), counter });
        prop_assert_eq!(signal_of(command, "TorqueCommand"), i64::from(torque));
        prop_assert_eq!(signal_of(command, "ControlWord"), i64::from(control));
        let setpoint = Message::Setpoint(Setpoint {
            control: ControlWord(control), counter, position: SetpointFine::saturating(position) });
        prop_assert_eq!(signal_of(setpoint, "PositionSetpoint"), position);
        let status = Message::Status(Status {
            status: StatusWord::of(DriveState::OperationEnabled), fault: None, torque: TorquePerMille(-7),
            following_error: FollowingError24::saturating(error) });
        prop_assert_eq!(signal_of(status, "FollowingError"), i64::from(error.clamp(-8_388_607, 8_388_607)));
        prop_assert_eq!(signal_of(status, "Torque"), -7);
    }

    #[test]
    fn any_frame_decodes_to_a_message_or_to_a_named_error(
        id in 0_u16..0x800, data in proptest::collection::vec(any::<u8>(), 0..=8), remote in any::<bool>(),
    ) {
        let id = StandardId::new(id).unwrap();
        let frame = if remote { CanFrame::new_remote(id, data.len()).unwrap() } else { CanFrame::new(id, &data).unwrap() };
        match decode(axis(0), &frame) {
            Ok(Decoded::Message(message)) => {
                prop_assert_eq!(Some(message.kind()), axis(0).classify(id));
                prop_assert!(!remote);
            }
            Ok(Decoded::Foreign) => prop_assert_eq!(axis(0).classify(id), None),
            Err(error) => prop_assert!(error.to_string().contains(error.field)),
        }
    }
}

#[test]
fn a_wrong_length_is_named() {
    let short = CanFrame::of(axis(0).identifier(FrameKind::Feedback), [1, 2, 3]);
    let error = decode_as(FrameKind::Feedback, &short).unwrap_err();
    assert_eq!(
        error.to_string(),
        "Feedback frame: length must be 8 bytes, got 3"
    );
}

#[test]
fn the_signals_of_a_frame_fill_it_without_overlap() {
    for spec in FRAMES {
        let mut next = 0;
        for signal in spec.signals {
            assert_eq!(signal.start, next, "{} {}", spec.name, signal.name);
            next += signal.length;
        }
        assert_eq!(next, spec.length * 8, "{}", spec.name);
    }
}

#[test]
fn the_dbc_at_the_crate_root_is_the_table() {
    let mut text = String::new();
    protocol::dbc::write(&mut text, &[axis(0), axis(1)]).unwrap();
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/quadrant.dbc");
    if std::env::var_os("QUADRANT_BLESS").is_some() {
        std::fs::write(path, &text).unwrap();
    }
    assert_eq!(
        std::fs::read_to_string(path).unwrap_or_default(),
        text,
        "run with QUADRANT_BLESS=1 and review the change"
    );
}

#[test]
fn an_extended_frame_with_the_same_low_bits_is_other_peoples_traffic() {
    for (message, _) in golden() {
        let frame = message.encode(axis(0));
        let id =
            embedded_can::ExtendedId::new(u32::from(axis(0).identifier(message.kind()).as_raw()))
                .unwrap();
        let twin = CanFrame::new(id, frame.payload()).unwrap();
        assert_eq!(decode(axis(0), &twin), Ok(Decoded::Foreign), "{message:?}");
    }
}
