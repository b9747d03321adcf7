//! The frame table: one row per frame, one row per signal.
//!
//! Bus load, `quadrant.dbc` and `docs/frames.md` are all made from this table. That the codec of
//! [`crate::message`] lays its bytes out the same way is a test.

use crate::cob::FrameKind;
use crate::weight::{
    FollowingError24, LoadIncrements24, MotorIncrements, SetpointFine, TorqueMicroNm,
    TorquePerMille, Weight,
};

/// Who sends a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sender {
    /// The workbench: NMT master, SYNC producer, SDO client.
    Workbench,
    /// The servo of the axis.
    Servo,
    /// The plant of the axis.
    Plant,
}

/// How often a frame is sent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rate {
    /// Once in so many cycles, and once per bus (SYNC) or per axis (all others).
    EveryCycles(u16),
    /// Only on an event: NMT, EMCY, SDO. Not counted as cyclic load.
    OnEvent,
}

/// A signal in a frame; little endian, as everything in CANopen.
#[derive(Clone, Copy, Debug)]
pub struct Signal {
    /// Name in the DBC.
    pub name: &'static str,
    /// First bit.
    pub start: u8,
    /// Number of bits.
    pub length: u8,
    /// Two's complement.
    pub signed: bool,
    /// What one count is worth.
    pub weight: Weight,
    /// What it is, for people.
    pub text: &'static str,
}

/// A frame.
#[derive(Clone, Copy, Debug)]
pub struct FrameSpec {
    /// Which frame.
    pub kind: FrameKind,
    /// Name in the DBC.
    pub name: &'static str,
    /// Who sends it.
    pub sender: Sender,
    /// Data bytes.
    pub length: u8,
    /// How often.
    pub rate: Rate,
    /// What is in it.
    pub signals: &'static [Signal],
}

/// A status frame goes out every so many cycles.
pub const STATUS_EVERY_CYCLES: u16 = 10;
/// A plant status goes out on change, and every so many cycles.
pub const PLANT_STATUS_EVERY_CYCLES: u16 = 10;
/// A heartbeat goes out every so many cycles.
pub const HEARTBEAT_EVERY_CYCLES: u16 = 100;

const fn unsigned(name: &'static str, start: u8, length: u8, text: &'static str) -> Signal {
    Signal {
        name,
        start,
        length,
        signed: false,
        weight: Weight::ONE,
        text,
    }
}

const fn scaled(
    name: &'static str,
    start: u8,
    length: u8,
    signed: bool,
    weight: Weight,
    text: &'static str,
) -> Signal {
    Signal {
        name,
        start,
        length,
        signed,
        weight,
        text,
    }
}

const COUNTER: &str = "SYNC counter of the cycle, 1 to 240";

const NMT: &[Signal] = &[
    unsigned(
        "Command",
        0,
        8,
        "1 start, 2 stop, 128 pre-operational, 129 reset node, 130 reset communication",
    ),
    unsigned("Node", 8, 8, "addressed node, 0 for all"),
];
const SYNC: &[Signal] = &[unsigned("Counter", 0, 8, COUNTER)];
const FEEDBACK: &[Signal] = &[
    scaled(
        "MotorPosition",
        0,
        32,
        true,
        MotorIncrements::WEIGHT,
        "motor encoder",
    ),
    scaled(
        "LoadPositionLow24",
        32,
        24,
        false,
        LoadIncrements24::WEIGHT,
        "load scale modulo 2^24",
    ),
    unsigned("Counter", 56, 8, COUNTER),
];
const TORQUE: &[Signal] = &[
    scaled(
        "TorqueCommand",
        0,
        32,
        true,
        TorqueMicroNm::WEIGHT,
        "motor torque",
    ),
    unsigned(
        "ControlWord",
        32,
        16,
        "CiA 402 control word of the plant's torque drive; bit 11 releases the brake",
    ),
    unsigned("Counter", 48, 8, COUNTER),
];
const SETPOINT: &[Signal] = &[
    unsigned("ControlWord", 0, 16, "CiA 402 control word of the axis"),
    unsigned("Counter", 16, 8, COUNTER),
    scaled(
        "PositionSetpoint",
        24,
        40,
        true,
        SetpointFine::WEIGHT,
        "position setpoint, due in the cycle of Counter",
    ),
];
const PLANT_STATUS: &[Signal] = &[
    unsigned(
        "StatusWord",
        0,
        16,
        "CiA 402 status word of the torque drive",
    ),
    unsigned("Brake", 16, 8, "0 not fitted, 1 closed, 2 moving, 3 open"),
    unsigned("Fault", 24, 8, "latched fault, 0 for none"),
    scaled(
        "ActualTorque",
        32,
        32,
        true,
        TorqueMicroNm::WEIGHT,
        "motor torque that acts",
    ),
];
const STATUS: &[Signal] = &[
    unsigned("StatusWord", 0, 16, "CiA 402 status word"),
    scaled(
        "FollowingError",
        16,
        24,
        true,
        FollowingError24::WEIGHT,
        "setpoint - measurement",
    ),
    scaled(
        "Torque",
        40,
        16,
        true,
        TorquePerMille::WEIGHT,
        "commanded torque",
    ),
    unsigned("Fault", 56, 8, "latched fault, 0 for none"),
];
const HEARTBEAT: &[Signal] = &[unsigned(
    "NmtState",
    0,
    8,
    "0 boot-up, 4 stopped, 5 operational, 127 pre-operational",
)];
const EMERGENCY: &[Signal] = &[
    unsigned("ErrorCode", 0, 16, "CiA 301 error code, 0 for error reset"),
    unsigned("ErrorRegister", 16, 8, "object 1001h"),
    unsigned("Fault", 24, 8, "fault code as in the status frame"),
    unsigned(
        "Detail",
        32,
        32,
        "SYNC counter of the cycle in which it was latched",
    ),
];
const SDO: &[Signal] = &[
    unsigned("Command", 0, 8, "command specifier"),
    unsigned("Index", 8, 16, "object index"),
    unsigned("Subindex", 24, 8, "object subindex"),
    unsigned("Data", 32, 32, "expedited data or abort code"),
];

const fn row(
    kind: FrameKind,
    name: &'static str,
    sender: Sender,
    length: u8,
    rate: Rate,
    signals: &'static [Signal],
) -> FrameSpec {
    FrameSpec {
        kind,
        name,
        sender,
        length,
        rate,
        signals,
    }
}

const CYCLIC: Rate = Rate::EveryCycles(1);
const BEAT: Rate = Rate::EveryCycles(HEARTBEAT_EVERY_CYCLES);

/// Every frame of an axis, in order of priority on the bus.
#[rustfmt::skip]
pub const FRAMES: [FrameSpec; 13] = [
    row(FrameKind::Nmt, "Nmt", Sender::Workbench, 2, Rate::OnEvent, NMT),
    row(FrameKind::Sync, "Sync", Sender::Workbench, 1, CYCLIC, SYNC),
    row(FrameKind::ServoEmergency, "ServoEmergency", Sender::Servo, 8, Rate::OnEvent, EMERGENCY),
    row(FrameKind::PlantEmergency, "PlantEmergency", Sender::Plant, 8, Rate::OnEvent, EMERGENCY),
    row(FrameKind::Feedback, "Feedback", Sender::Plant, 8, CYCLIC, FEEDBACK),
    row(FrameKind::Setpoint, "Setpoint", Sender::Workbench, 8, CYCLIC, SETPOINT),
    row(FrameKind::Torque, "Torque", Sender::Servo, 7, CYCLIC, TORQUE),
    row(FrameKind::PlantStatus, "PlantStatus", Sender::Plant, 8, Rate::EveryCycles(PLANT_STATUS_EVERY_CYCLES), PLANT_STATUS),
    row(FrameKind::Status, "Status", Sender::Servo, 8, Rate::EveryCycles(STATUS_EVERY_CYCLES), STATUS),
    row(FrameKind::SdoResponse, "SdoResponse", Sender::Servo, 8, Rate::OnEvent, SDO),
    row(FrameKind::SdoRequest, "SdoRequest", Sender::Workbench, 8, Rate::OnEvent, SDO),
    row(FrameKind::ServoHeartbeat, "ServoHeartbeat", Sender::Servo, 1, BEAT, HEARTBEAT),
    row(FrameKind::PlantHeartbeat, "PlantHeartbeat", Sender::Plant, 1, BEAT, HEARTBEAT),
];
