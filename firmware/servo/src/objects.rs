//! The object dictionary: one table for the SDO server, the parameter set and `docs/objects.md`.
//!
//! Parameters are 32-bit machine numbers; the host turns SI gains into them. A write is checked against its range before it is
//! acknowledged and goes into the *staged* set only; [`COMMIT`] makes the staged set active as a whole.

use protocol::sdo::Address;

/// A parameter of the drive; its discriminant is its place in a [`crate::parameters::ParameterSet`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(usize)]
#[expect(missing_docs, reason = "TABLE says what each one is")]
pub enum Parameter {
    PositionSource,
    PositionGain,
    VelocityGain,
    IntegralGain,
    AccelerationGain,
    VelocityFilter,
    TorqueLimit,
    RatedTorque,
    WayWhole,
    WayFraction,
    PulseAmplitude,
    PulseDecay,
    PulseStartDelay,
    BacklashHalfGap,
    VelocityLimit,
    AccelerationLimit,
    CoulombTorque,
    FilterB0,
    FilterB1,
    FilterB2,
    FilterA1,
    FilterA2,
    SetpointMissesAllowed,
    FeedbackMissesAllowed,
    FollowingErrorWindow,
    EncoderJumpLimit,
    HeartbeatCycles,
    StopDeceleration,
    StopCycles,
    SyncTimeout,
}

/// Number of parameters.
pub const PARAMETERS: usize = 30;

/// A row of the dictionary that holds a parameter.
#[derive(Clone, Copy, Debug)]
pub struct Entry {
    /// Where it is.
    pub address: Address,
    /// Which parameter.
    pub parameter: Parameter,
    /// What it is.
    pub name: &'static str,
    /// Unit and scaling of the raw number.
    pub unit: &'static str,
    /// Smallest raw value.
    pub min: i32,
    /// Largest raw value.
    pub max: i32,
    /// Raw value after reset.
    pub default: i32,
}

const fn entry(
    (index, subindex): (u16, u8),
    parameter: Parameter,
    name: &'static str,
    unit: &'static str,
    (min, max): (i32, i32),
    default: i32,
) -> Entry {
    Entry { address: Address::new(index, subindex), parameter, name, unit, min, max, default }
}

const POSITIVE: (i32, i32) = (0, i32::MAX);
const ANY: (i32, i32) = (-i32::MAX, i32::MAX);
const ONE_Q29: i32 = 1 << 29;

/// All parameters. The defaults move nothing: every gain is zero until a set is committed.
pub const TABLE: [Entry; PARAMETERS] = [
    entry((0x2100, 1), Parameter::PositionSource, "position source", "0 motor encoder, 1 load scale", (0, 1), 1),
    entry((0x2100, 2), Parameter::PositionGain, "position gain Kv", "per cycle, 2^-24", (0, 1 << 24), 0),
    entry((0x2100, 3), Parameter::VelocityGain, "velocity gain Kp", "uN m per (10 nm/cycle), 2^-12", POSITIVE, 0),
    entry(
        (0x2100, 4),
        Parameter::IntegralGain,
        "integral gain Ki",
        "uN m per (10 nm/cycle) and cycle, 2^-12",
        POSITIVE,
        0,
    ),
    entry(
        (0x2100, 5),
        Parameter::AccelerationGain,
        "acceleration feedforward Ja",
        "uN m per (10 nm/cycle^2), 2^-8",
        POSITIVE,
        0,
    ),
    entry(
        (0x2100, 6),
        Parameter::VelocityFilter,
        "velocity filter, share of the new value",
        "2^-30",
        (1, 1 << 30),
        1 << 30,
    ),
    entry(
        (0x2100, 7),
        Parameter::TorqueLimit,
        "torque limit",
        "uN m",
        (0, controller::filter::TORQUE_LIMIT_MICRO_NM),
        0,
    ),
    entry((0x6076, 0), Parameter::RatedTorque, "rated torque", "mN m", (1, i32::MAX), 1000),
    entry((0x2101, 1), Parameter::WayWhole, "way per motor increment, whole", "10 nm", (0, 65_535), 1),
    entry((0x2101, 2), Parameter::WayFraction, "way per motor increment, fraction", "10 nm, 2^-31", POSITIVE, 0),
    entry((0x2110, 1), Parameter::PulseAmplitude, "reversal pulse height", "10 nm/cycle, 2^-12", ANY, 0),
    entry((0x2110, 2), Parameter::PulseDecay, "reversal pulse decay per cycle", "2^-30", (0, (1 << 30) - 1), 0),
    entry((0x2110, 3), Parameter::PulseStartDelay, "reversal pulse start delay", "cycles", (0, 10_000), 0),
    entry((0x2111, 1), Parameter::BacklashHalfGap, "half the backlash to compensate", "10 nm, 2^-8", POSITIVE, 0),
    entry((0x2111, 2), Parameter::VelocityLimit, "velocity limit of the axis", "10 nm/cycle, 2^-12", POSITIVE, 0),
    entry(
        (0x2111, 3),
        Parameter::AccelerationLimit,
        "acceleration limit of the axis",
        "10 nm/cycle^2, 2^-12",
        POSITIVE,
        0,
    ),
    entry((0x2112, 0), Parameter::CoulombTorque, "Coulomb feedforward", "uN m", ANY, 0),
    entry((0x2120, 1), Parameter::FilterB0, "torque filter b0", "2^-29", ANY, ONE_Q29),
    entry((0x2120, 2), Parameter::FilterB1, "torque filter b1", "2^-29", ANY, 0),
    entry((0x2120, 3), Parameter::FilterB2, "torque filter b2", "2^-29", ANY, 0),
    entry((0x2120, 4), Parameter::FilterA1, "torque filter a1 (y0 = ... + a1 y1)", "2^-29", ANY, 0),
    entry((0x2120, 5), Parameter::FilterA2, "torque filter a2 (y0 = ... + a2 y2)", "2^-29", ANY, 0),
    entry(
        (0x2130, 1),
        Parameter::SetpointMissesAllowed,
        "setpoints missed in a row before the stop",
        "cycles",
        (0, 100),
        3,
    ),
    entry(
        (0x2130, 2),
        Parameter::FeedbackMissesAllowed,
        "feedbacks missed in a row before torque zero",
        "cycles",
        (0, 100),
        3,
    ),
    entry((0x6065, 0), Parameter::FollowingErrorWindow, "following error window", "10 nm", (1, 8_000_000), 100_000),
    entry((0x2130, 3), Parameter::EncoderJumpLimit, "encoder jump beyond the expected way", "10 nm", POSITIVE, 100_000),
    entry((0x2130, 4), Parameter::HeartbeatCycles, "plant heartbeat timeout", "cycles", (101, 10_000), 250),
    entry(
        (0x2130, 5),
        Parameter::StopDeceleration,
        "deceleration of a controlled stop",
        "10 nm/cycle^2, 2^-12",
        (1, i32::MAX),
        1 << 21,
    ),
    entry((0x2130, 6), Parameter::StopCycles, "longest controlled stop", "cycles", (0, 10_000), 200),
    entry((0x2131, 0), Parameter::SyncTimeout, "SYNC timeout by wall clock", "us", (100, 60_000_000), 1_000_000),
];

/// Writing [`COMMIT_KEY`] makes the staged set active at the next cycle; reading gives the number of commits.
pub const COMMIT: Address = Address::new(0x2F00, 0);
/// "cmit", as the bytes stand on the bus.
pub const COMMIT_KEY: u32 = u32::from_le_bytes(*b"cmit");
/// Device type: CiA 402 servo drive.
pub const DEVICE_TYPE: Address = Address::new(0x1000, 0);
/// Value of [`DEVICE_TYPE`].
pub const DEVICE_TYPE_VALUE: u32 = 0x0002_0192;
/// Error register.
pub const ERROR_REGISTER: Address = Address::new(0x1001, 0);
/// Status word.
pub const STATUS_WORD: Address = Address::new(0x6041, 0);
/// Modes of operation display: 8, cyclic synchronous position.
pub const MODE_DISPLAY: Address = Address::new(0x6061, 0);
/// Actual position in 10 nm.
pub const POSITION_ACTUAL: Address = Address::new(0x6064, 0);
/// Following error in 10 nm.
pub const FOLLOWING_ERROR: Address = Address::new(0x60F4, 0);
/// Frames lost, stale, malformed, implausible and doubled since reset, subindex 1 to 5.
pub const DIAGNOSTICS_INDEX: u16 = 0x2200;

/// The row at an address.
#[must_use]
pub fn find(address: Address) -> Option<&'static Entry> {
    TABLE.iter().find(|entry| entry.address == address)
}

/// Whether any object has this index.
#[must_use]
pub fn index_exists(index: u16) -> bool {
    let single = [COMMIT, DEVICE_TYPE, ERROR_REGISTER, STATUS_WORD, MODE_DISPLAY, POSITION_ACTUAL, FOLLOWING_ERROR];
    index == DIAGNOSTICS_INDEX
        || single.iter().any(|address| address.index == index)
        || TABLE.iter().any(|entry| entry.address.index == index)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_is_in_the_order_of_the_parameters_and_its_defaults_are_in_range() {
        for (place, entry) in TABLE.iter().enumerate() {
            assert_eq!(entry.parameter as usize, place, "{}", entry.name);
            assert!(entry.min <= entry.default && entry.default <= entry.max, "{}", entry.name);
            assert_eq!(TABLE.iter().filter(|other| other.address == entry.address).count(), 1, "{}", entry.name);
        }
    }
}
