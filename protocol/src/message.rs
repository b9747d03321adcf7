//! Typed messages and their total codec.
//!
//! [`decode`] takes any frame of an axis and gives a value or an error that names the field;
//! [`Message::encode`] cannot fail, because an illegal message cannot be built. The byte layout is
//! that of [`crate::table`], and a test holds the two together bit by bit.

use core::fmt;

pub use canopen_rs::emcy::{EmergencyMessage, ErrorRegister};
pub use canopen_rs::nmt::{NmtCommand, NmtState};

use embedded_can::{Frame, Id};

use crate::cob::{AxisIds, FrameKind, NodeId};
use crate::counter::SyncCounter;
use crate::fault::Fault;
use crate::frame::CanFrame;
use crate::sdo;
use crate::states::{BrakeState, ControlWord, StatusWord};
use crate::weight::{
    FollowingError24, LoadIncrements24, MotorIncrements, SetpointFine, TorqueMicroNm,
    TorquePerMille,
};

/// Encoder positions of one cycle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Feedback {
    /// Motor encoder.
    pub motor: MotorIncrements,
    /// Load scale, modulo 2^24.
    pub load: LoadIncrements24,
    /// Cycle in which both were sampled.
    pub counter: SyncCounter,
}

/// Torque command of one cycle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Torque {
    /// Commanded motor torque.
    pub torque: TorqueMicroNm,
    /// Control word of the plant's torque drive.
    pub control: ControlWord,
    /// Cycle whose feedback it answers.
    pub counter: SyncCounter,
}

/// Position setpoint of one cycle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Setpoint {
    /// Control word of the axis.
    pub control: ControlWord,
    /// Cycle in which the setpoint is due; it is sent one cycle early.
    pub counter: SyncCounter,
    /// Position.
    pub position: SetpointFine,
}

/// State of the plant's power stage and brake.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PlantStatus {
    /// Status word of the torque drive.
    pub status: StatusWord,
    /// Where its brake stands.
    pub brake: BrakeState,
    /// Latched fault, if any.
    pub fault: Option<Fault>,
    /// Torque that acts.
    pub torque: TorqueMicroNm,
}

/// Drive status.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Status {
    /// Status word.
    pub status: StatusWord,
    /// Setpoint − measurement.
    pub following_error: FollowingError24,
    /// Commanded torque.
    pub torque: TorquePerMille,
    /// Latched fault, if any.
    pub fault: Option<Fault>,
}

/// Everything that Quadrant's nodes say to each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Message {
    /// NMT command to one node, or to all where `None`.
    Nmt(NmtCommand, Option<NodeId>),
    /// SYNC.
    Sync(SyncCounter),
    /// Encoder positions.
    Feedback(Feedback),
    /// Torque command.
    Torque(Torque),
    /// Position setpoint.
    Setpoint(Setpoint),
    /// State of power stage and brake.
    PlantStatus(PlantStatus),
    /// Drive status.
    Status(Status),
    /// Heartbeat or boot-up of the servo.
    ServoHeartbeat(NmtState),
    /// Heartbeat or boot-up of the plant.
    PlantHeartbeat(NmtState),
    /// Emergency of the servo.
    ServoEmergency(EmergencyMessage),
    /// Emergency of the plant.
    PlantEmergency(EmergencyMessage),
    /// SDO request to the servo.
    SdoRequest(sdo::Request),
    /// SDO response of the servo.
    SdoResponse(sdo::Response),
}

/// Why a frame is not a message: the field, what was wanted, what came.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DecodeError {
    /// Which kind of frame.
    pub kind: FrameKind,
    /// Which field of it.
    pub field: &'static str,
    /// What the table wants.
    pub wanted: &'static str,
    /// What came.
    pub got: u32,
}

impl fmt::Display for DecodeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{:?} frame: {} must be {}, got {}",
            self.kind, self.field, self.wanted, self.got
        )
    }
}

impl core::error::Error for DecodeError {}

/// What a frame turned out to be on an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Decoded {
    /// One of ours.
    Message(Message),
    /// Other people's traffic: extended identifiers and identifiers that this axis does not use.
    Foreign,
}

/// Decodes a frame as seen on an axis.
///
/// # Errors
/// [`DecodeError`] where the identifier is ours and the content is not.
pub fn decode(ids: AxisIds, frame: &CanFrame) -> Result<Decoded, DecodeError> {
    match kind_of(ids, frame) {
        None => Ok(Decoded::Foreign),
        Some(kind) => decode_as(kind, frame).map(Decoded::Message),
    }
}

/// What a frame is on an axis; `None` for other people's traffic.
#[must_use]
pub fn kind_of(ids: AxisIds, frame: &CanFrame) -> Option<FrameKind> {
    match frame.id() {
        Id::Standard(id) => ids.classify(id),
        Id::Extended(_) => None,
    }
}

/// Decodes a frame of a known kind.
///
/// # Errors
/// [`DecodeError`] with the first field that is wrong.
pub fn decode_as(kind: FrameKind, frame: &CanFrame) -> Result<Message, DecodeError> {
    match kind {
        FrameKind::Nmt => nmt(bytes(kind, frame, "2 bytes")?),
        FrameKind::Sync => SyncCounter::decode(frame).map(Message::Sync),
        FrameKind::Feedback => Feedback::decode(frame).map(Message::Feedback),
        FrameKind::Torque => Torque::decode(frame).map(Message::Torque),
        FrameKind::Setpoint => Setpoint::decode(frame).map(Message::Setpoint),
        FrameKind::PlantStatus => plant_status(bytes(kind, frame, "8 bytes")?),
        FrameKind::Status => status(bytes(kind, frame, "8 bytes")?),
        FrameKind::ServoHeartbeat => heartbeat(kind, frame).map(Message::ServoHeartbeat),
        FrameKind::PlantHeartbeat => heartbeat(kind, frame).map(Message::PlantHeartbeat),
        FrameKind::ServoEmergency => emergency(kind, frame).map(Message::ServoEmergency),
        FrameKind::PlantEmergency => emergency(kind, frame).map(Message::PlantEmergency),
        FrameKind::SdoRequest => {
            bytes(kind, frame, "8 bytes").map(|b| Message::SdoRequest(sdo::Request::decode(b)))
        }
        FrameKind::SdoResponse => {
            bytes(kind, frame, "8 bytes").map(|b| Message::SdoResponse(sdo::Response::decode(b)))
        }
    }
}

/// The bytes of a data frame of a fixed length.
fn bytes<const N: usize>(
    kind: FrameKind,
    frame: &CanFrame,
    wanted: &'static str,
) -> Result<[u8; N], DecodeError> {
    let payload = frame.payload().try_into().ok();
    payload.ok_or_else(|| not_of_its_length(kind, frame, wanted))
}

#[cold]
fn not_of_its_length(kind: FrameKind, frame: &CanFrame, wanted: &'static str) -> DecodeError {
    if frame.is_remote_frame() {
        return DecodeError {
            kind,
            field: "RTR",
            wanted: "a data frame",
            got: 1,
        };
    }
    DecodeError {
        kind,
        field: "length",
        wanted,
        got: u32::try_from(frame.dlc()).unwrap_or(u32::MAX),
    }
}

fn counter(kind: FrameKind, value: u8) -> Result<SyncCounter, DecodeError> {
    SyncCounter::new(value).ok_or(DecodeError {
        kind,
        field: "counter",
        wanted: "1 to 240",
        got: u32::from(value),
    })
}

fn nmt([command, node]: [u8; 2]) -> Result<Message, DecodeError> {
    let error = |field, wanted, got| DecodeError {
        kind: FrameKind::Nmt,
        field,
        wanted,
        got: u32::from(got),
    };
    let known = NmtCommand::from_byte(command)
        .map_err(|_| error("command", "1, 2, 128, 129 or 130", command))?;
    if node > 127 {
        return Err(error("node", "0 to 127", node));
    }
    Ok(Message::Nmt(known, NodeId::new(node)))
}

impl SyncCounter {
    /// What a SYNC carries.
    ///
    /// # Errors
    /// [`DecodeError`] with the first field that is wrong.
    pub fn decode(frame: &CanFrame) -> Result<Self, DecodeError> {
        let [count] = bytes(FrameKind::Sync, frame, "1 byte")?;
        counter(FrameKind::Sync, count)
    }
}

impl Feedback {
    /// What a frame of this kind carries.
    ///
    /// # Errors
    /// [`DecodeError`] with the first field that is wrong.
    pub fn decode(frame: &CanFrame) -> Result<Self, DecodeError> {
        let [a, b, c, d, e, f, g, count] = bytes(FrameKind::Feedback, frame, "8 bytes")?;
        Ok(Self {
            motor: MotorIncrements(i32::from_le_bytes([a, b, c, d])),
            load: LoadIncrements24::from_counts(i64::from(u32::from_le_bytes([e, f, g, 0]))),
            counter: counter(FrameKind::Feedback, count)?,
        })
    }
}

impl Torque {
    /// What a frame of this kind carries.
    ///
    /// # Errors
    /// [`DecodeError`] with the first field that is wrong.
    pub fn decode(frame: &CanFrame) -> Result<Self, DecodeError> {
        let [a, b, c, d, e, f, count] = bytes(FrameKind::Torque, frame, "7 bytes")?;
        Ok(Self {
            torque: TorqueMicroNm(i32::from_le_bytes([a, b, c, d])),
            control: ControlWord(u16::from_le_bytes([e, f])),
            counter: counter(FrameKind::Torque, count)?,
        })
    }
}

impl Setpoint {
    /// What a frame of this kind carries.
    ///
    /// # Errors
    /// [`DecodeError`] with the first field that is wrong.
    pub fn decode(frame: &CanFrame) -> Result<Self, DecodeError> {
        let [a, b, count, c, d, e, f, g] = bytes(FrameKind::Setpoint, frame, "8 bytes")?;
        Ok(Self {
            control: ControlWord(u16::from_le_bytes([a, b])),
            counter: counter(FrameKind::Setpoint, count)?,
            position: SetpointFine::from_bytes([c, d, e, f, g]),
        })
    }
}

fn status_word(kind: FrameKind, bytes: [u8; 2]) -> Result<StatusWord, DecodeError> {
    let word = StatusWord(u16::from_le_bytes(bytes));
    let error = DecodeError {
        kind,
        field: "status word",
        wanted: "a CiA 402 state",
        got: u32::from(word.0),
    };
    word.state().map(|_| word).ok_or(error)
}

fn fault(kind: FrameKind, code: u8) -> Result<Option<Fault>, DecodeError> {
    let error = DecodeError {
        kind,
        field: "fault",
        wanted: "a known fault code",
        got: u32::from(code),
    };
    if code == 0 {
        Ok(None)
    } else {
        Fault::from_code(code).map(Some).ok_or(error)
    }
}

fn plant_status([a, b, brake, code, c, d, e, f]: [u8; 8]) -> Result<Message, DecodeError> {
    let kind = FrameKind::PlantStatus;
    let error = DecodeError {
        kind,
        field: "brake",
        wanted: "0 to 3",
        got: u32::from(brake),
    };
    Ok(Message::PlantStatus(PlantStatus {
        status: status_word(kind, [a, b])?,
        brake: BrakeState::from_code(brake).ok_or(error)?,
        fault: fault(kind, code)?,
        torque: TorqueMicroNm(i32::from_le_bytes([c, d, e, f])),
    }))
}

fn status([a, b, c, d, e, f, g, code]: [u8; 8]) -> Result<Message, DecodeError> {
    Ok(Message::Status(Status {
        status: status_word(FrameKind::Status, [a, b])?,
        following_error: FollowingError24::from_bytes([c, d, e]),
        torque: TorquePerMille(i16::from_le_bytes([f, g])),
        fault: fault(FrameKind::Status, code)?,
    }))
}

fn heartbeat(kind: FrameKind, frame: &CanFrame) -> Result<NmtState, DecodeError> {
    let [state] = bytes(kind, frame, "1 byte")?;
    let error = DecodeError {
        kind,
        field: "NMT state",
        wanted: "0, 4, 5 or 127",
        got: u32::from(state),
    };
    NmtState::from_wire(state).map_err(|_| error)
}

fn emergency(kind: FrameKind, frame: &CanFrame) -> Result<EmergencyMessage, DecodeError> {
    let payload: [u8; 8] = bytes(kind, frame, "8 bytes")?;
    EmergencyMessage::decode(&payload).map_err(|_| DecodeError {
        kind,
        field: "length",
        wanted: "8 bytes",
        got: 8,
    })
}

impl Message {
    /// Which kind of frame carries the message.
    #[must_use]
    pub const fn kind(&self) -> FrameKind {
        match self {
            Self::Nmt(..) => FrameKind::Nmt,
            Self::Sync(_) => FrameKind::Sync,
            Self::Feedback(_) => FrameKind::Feedback,
            Self::Torque(_) => FrameKind::Torque,
            Self::Setpoint(_) => FrameKind::Setpoint,
            Self::PlantStatus(_) => FrameKind::PlantStatus,
            Self::Status(_) => FrameKind::Status,
            Self::ServoHeartbeat(_) => FrameKind::ServoHeartbeat,
            Self::PlantHeartbeat(_) => FrameKind::PlantHeartbeat,
            Self::ServoEmergency(_) => FrameKind::ServoEmergency,
            Self::PlantEmergency(_) => FrameKind::PlantEmergency,
            Self::SdoRequest(_) => FrameKind::SdoRequest,
            Self::SdoResponse(_) => FrameKind::SdoResponse,
        }
    }

    /// The frame of the message on an axis.
    #[must_use]
    pub fn encode(&self, ids: AxisIds) -> CanFrame {
        let id = ids.identifier(self.kind());
        match *self {
            Self::Nmt(command, node) => {
                CanFrame::of(id, [nmt_code(command), node.map_or(0, NodeId::get)])
            }
            Self::Sync(count) => CanFrame::of(id, [count.get()]),
            Self::Feedback(feedback) => CanFrame::full(id, feedback.bytes()),
            Self::Torque(torque) => torque.encode(ids),
            Self::Setpoint(setpoint) => CanFrame::full(id, setpoint.bytes()),
            Self::PlantStatus(status) => CanFrame::full(id, status.bytes()),
            Self::Status(status) => status.encode(ids),
            Self::ServoHeartbeat(state) | Self::PlantHeartbeat(state) => {
                CanFrame::of(id, canopen_rs::nmt::encode_heartbeat(state))
            }
            Self::ServoEmergency(message) | Self::PlantEmergency(message) => {
                CanFrame::full(id, message.encode())
            }
            Self::SdoRequest(request) => CanFrame::full(id, request.encode()),
            Self::SdoResponse(response) => CanFrame::full(id, response.encode()),
        }
    }
}

const fn nmt_code(command: NmtCommand) -> u8 {
    match command {
        NmtCommand::StartRemoteNode => 0x01,
        NmtCommand::StopRemoteNode => 0x02,
        NmtCommand::EnterPreOperational => 0x80,
        NmtCommand::ResetNode => 0x81,
        NmtCommand::ResetCommunication => 0x82,
    }
}

impl Feedback {
    const fn bytes(self) -> [u8; 8] {
        let [a, b, c, d] = self.motor.0.to_le_bytes();
        let [e, f, g, _] = self.load.bits().to_le_bytes();
        [a, b, c, d, e, f, g, self.counter.get()]
    }
}

impl Torque {
    /// The frame of a torque command on an axis.
    #[must_use]
    pub fn encode(self, ids: AxisIds) -> CanFrame {
        let [a, b, c, d] = self.torque.0.to_le_bytes();
        let [e, f] = self.control.0.to_le_bytes();
        let payload = [a, b, c, d, e, f, self.counter.get()];
        CanFrame::of(ids.identifier(FrameKind::Torque), payload)
    }
}

impl Setpoint {
    const fn bytes(self) -> [u8; 8] {
        let [a, b] = self.control.0.to_le_bytes();
        let [c, d, e, f, g] = self.position.to_bytes();
        [a, b, self.counter.get(), c, d, e, f, g]
    }
}

impl PlantStatus {
    fn bytes(self) -> [u8; 8] {
        let [a, b] = self.status.0.to_le_bytes();
        let [c, d, e, f] = self.torque.0.to_le_bytes();
        [
            a,
            b,
            self.brake.code(),
            self.fault.map_or(0, Fault::code),
            c,
            d,
            e,
            f,
        ]
    }
}

impl Status {
    /// The frame of a status on an axis.
    #[must_use]
    pub fn encode(self, ids: AxisIds) -> CanFrame {
        CanFrame::full(ids.identifier(FrameKind::Status), self.bytes())
    }

    fn bytes(self) -> [u8; 8] {
        let [a, b] = self.status.0.to_le_bytes();
        let [c, d, e] = self.following_error.to_bytes();
        let [f, g] = self.torque.0.to_le_bytes();
        [a, b, c, d, e, f, g, self.fault.map_or(0, Fault::code)]
    }
}
