//! The object dictionary: one table for the SDO server, the parameter set and `docs/objects.md`.
//!
//! A person commissions an axis in physical units, so a parameter is an integer number of decimal
//! steps: 5 m/s² is 5 000 000 steps of 1 µm/s². A write is checked against its range before it is
//! acknowledged and goes into the *staged* set only. [`COMMIT`] turns the staged set into machine
//! units of its own cycle time ([`crate::conversion`]) and makes it active as a whole.
//!
//! All parameters are INTEGER32, also where CiA 402 has UNSIGNED32, UNSIGNED8 or INTEGER16: a
//! client writes four bytes everywhere. Indices are those of CiA 301 and CiA 402-2 where these have
//! the object, 2xxxh elsewhere.

use protocol::leaf::{Durations, Timed};
use protocol::sdo::Address;

/// Step of a raw number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Unit {
    /// The step, for people.
    pub text: &'static str,
    /// Steps in one SI unit (m, s, N·m and what follows from them).
    pub per_si: u64,
}

const fn unit(text: &'static str, per_si: u64) -> Unit {
    Unit { text, per_si }
}

const CHOICE: Unit = unit("choice", 1);
const CYCLES: Unit = unit("cycles", 1);
const NUMBER: Unit = unit("1", 1);
const MILLIONTH: Unit = unit("1e-6", 1_000_000);
const Q29: Unit = unit("2^-29", 1 << 29);
const MILLISECOND: Unit = unit("ms", 1_000);
const MICROSECOND: Unit = unit("us", 1_000_000);
const NANOSECOND: Unit = unit("ns", 1_000_000_000);
const PER_SECOND: Unit = unit("1e-4 /s", 10_000);
const HERTZ: Unit = unit("1e-4 Hz", 10_000);
const INERTIA: Unit = unit("1e-7 N m/(m/s^2)", 10_000_000);
const MICRO_NM: Unit = unit("uN m", 1_000_000);
const MILLI_NM: Unit = unit("mN m", 1_000);
const VISCOUS: Unit = unit("1e-6 N m/(m/s)", 1_000_000);
const WINDUP: Unit = unit("0.01 nm/(N m)", 100_000_000_000);
const MILLIONTH_PER_M: Unit = unit("1e-6 /m", 1_000_000);
const MILLIONTH_PER_M2: Unit = unit("1e-6 /m^2", 1_000_000);
const TENTH_NANOMETRE: Unit = unit("0.1 nm", 10_000_000_000);
const NANOMETRE: Unit = unit("nm", 1_000_000_000);
const COUNT: Unit = unit("10 nm", 100_000_000);
const NANOMETRE_PER_S: Unit = unit("nm/s", 1_000_000_000);
const MICROMETRE_PER_S: Unit = unit("um/s", 1_000_000);
const MICROMETRE_PER_S2: Unit = unit("um/s^2", 1_000_000);
const MILLIMETRE_PER_S3: Unit = unit("mm/s^3", 1_000);

/// A row of the dictionary that holds a parameter.
#[derive(Clone, Copy, Debug)]
pub struct Entry {
    /// Where it is.
    pub address: Address,
    /// Which parameter.
    pub parameter: Parameter,
    /// Smallest raw value.
    pub min: i32,
    /// Largest raw value.
    pub max: i32,
}

/// Why a value does not fit its row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Misfit {
    /// Below the smallest value.
    TooLow,
    /// Above the largest value.
    TooHigh,
    /// Within the range, but not supported.
    Unsupported,
}

impl Entry {
    /// What it is.
    #[must_use]
    #[expect(clippy::as_conversions, reason = "a discriminant is its place")]
    pub fn name(&self) -> &'static str {
        NAMES
            .get(self.parameter as usize)
            .copied()
            .unwrap_or_default()
    }

    /// Step of the raw number.
    #[must_use]
    pub const fn unit(&self) -> Unit {
        self.parameter.unit()
    }

    /// Raw value after reset.
    #[must_use]
    #[expect(clippy::as_conversions, reason = "a discriminant is its place")]
    pub fn default(&self) -> i32 {
        DEFAULTS
            .get(self.parameter as usize)
            .copied()
            .unwrap_or_default()
    }

    /// Checks a raw value.
    ///
    /// # Errors
    /// [`Misfit`] where the row does not take the value.
    pub fn check(&self, value: i32) -> Result<(), Misfit> {
        let reserved =
            self.parameter == Parameter::QuickStopOption && QUICK_STOP_UNSUPPORTED.contains(&value);
        match value {
            _ if value < self.min => Err(Misfit::TooLow),
            _ if value > self.max => Err(Misfit::TooHigh),
            _ if reserved => Err(Misfit::Unsupported),
            _ => Ok(()),
        }
    }
}

/// 605Ah: 3 and 4 slow down at the current or voltage limit, which this drive does not do.
const QUICK_STOP_UNSUPPORTED: [i32; 2] = [3, 4];

macro_rules! parameters {
    ($($name:ident = ($index:literal, $subindex:literal), $text:literal, $unit:expr, $range:expr, $default:expr;)*) => {
        /// A parameter of the drive; its discriminant is its place in a
        /// [`crate::parameters::ParameterSet`].
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        #[repr(usize)]
        pub enum Parameter {
            $(#[doc = $text] $name,)*
        }

        impl Parameter {
            /// Coefficients of the torque filter: b0, b1, b2, a1, a2.
            pub const TORQUE_FILTER: [Self; 5] = [
                Self::FilterB0,
                Self::FilterB1,
                Self::FilterB2,
                Self::FilterA1,
                Self::FilterA2,
            ];

            /// Heights of the adaptive pulse where the axis turns forward.
            pub const ADAPTIVE_FORWARD: [Self; 9] = [
                Self::AdaptiveForward1,
                Self::AdaptiveForward2,
                Self::AdaptiveForward3,
                Self::AdaptiveForward4,
                Self::AdaptiveForward5,
                Self::AdaptiveForward6,
                Self::AdaptiveForward7,
                Self::AdaptiveForward8,
                Self::AdaptiveForward9,
            ];

            /// And where it turns backward.
            pub const ADAPTIVE_BACKWARD: [Self; 9] = [
                Self::AdaptiveBackward1,
                Self::AdaptiveBackward2,
                Self::AdaptiveBackward3,
                Self::AdaptiveBackward4,
                Self::AdaptiveBackward5,
                Self::AdaptiveBackward6,
                Self::AdaptiveBackward7,
                Self::AdaptiveBackward8,
                Self::AdaptiveBackward9,
            ];

            /// Time constants of the adaptive pulse.
            pub const ADAPTIVE_TIME: [Self; 9] = [
                Self::AdaptiveTime1,
                Self::AdaptiveTime2,
                Self::AdaptiveTime3,
                Self::AdaptiveTime4,
                Self::AdaptiveTime5,
                Self::AdaptiveTime6,
                Self::AdaptiveTime7,
                Self::AdaptiveTime8,
                Self::AdaptiveTime9,
            ];

            /// Its start delays.
            pub const ADAPTIVE_DELAY: [Self; 9] = [
                Self::AdaptiveDelay1,
                Self::AdaptiveDelay2,
                Self::AdaptiveDelay3,
                Self::AdaptiveDelay4,
                Self::AdaptiveDelay5,
                Self::AdaptiveDelay6,
                Self::AdaptiveDelay7,
                Self::AdaptiveDelay8,
                Self::AdaptiveDelay9,
            ];

            /// Levels of the friction elements.
            pub const FRICTION_LEVELS: [Self; 10] = [
                Self::FrictionLevel1,
                Self::FrictionLevel2,
                Self::FrictionLevel3,
                Self::FrictionLevel4,
                Self::FrictionLevel5,
                Self::FrictionLevel6,
                Self::FrictionLevel7,
                Self::FrictionLevel8,
                Self::FrictionLevel9,
                Self::FrictionLevel10,
            ];

            /// Ways of the friction elements.
            pub const FRICTION_WAYS: [Self; 10] = [
                Self::FrictionWay1,
                Self::FrictionWay2,
                Self::FrictionWay3,
                Self::FrictionWay4,
                Self::FrictionWay5,
                Self::FrictionWay6,
                Self::FrictionWay7,
                Self::FrictionWay8,
                Self::FrictionWay9,
                Self::FrictionWay10,
            ];

            /// Shares of the friction elements that are on the motor's side.
            pub const FRICTION_ON_MOTOR: [Self; 10] = [
                Self::FrictionOnMotor1,
                Self::FrictionOnMotor2,
                Self::FrictionOnMotor3,
                Self::FrictionOnMotor4,
                Self::FrictionOnMotor5,
                Self::FrictionOnMotor6,
                Self::FrictionOnMotor7,
                Self::FrictionOnMotor8,
                Self::FrictionOnMotor9,
                Self::FrictionOnMotor10,
            ];

            /// Amplitude, period and phase of each ripple.
            pub const RIPPLES: [[Self; 3]; 2] = [
                [Self::RippleTorque1, Self::RipplePeriod1, Self::RipplePhase1],
                [Self::RippleTorque2, Self::RipplePeriod2, Self::RipplePhase2],
            ];

            /// Factors on the friction levels over the speed.
            pub const LEVEL_FACTORS: [Self; 17] = [
                Self::LevelFactor0,
                Self::LevelFactor1,
                Self::LevelFactor2,
                Self::LevelFactor3,
                Self::LevelFactor4,
                Self::LevelFactor5,
                Self::LevelFactor6,
                Self::LevelFactor7,
                Self::LevelFactor8,
                Self::LevelFactor9,
                Self::LevelFactor10,
                Self::LevelFactor11,
                Self::LevelFactor12,
                Self::LevelFactor13,
                Self::LevelFactor14,
                Self::LevelFactor15,
                Self::LevelFactor16,
            ];

            /// Step of its raw number.
            #[must_use]
            pub const fn unit(self) -> Unit {
                match self {
                    $(Self::$name => $unit,)*
                }
            }
        }

        /// Number of parameters.
        pub const PARAMETERS: usize = DEFAULTS.len();

        /// Raw values after reset, in the order of the parameters.
        pub const DEFAULTS: &[i32] = &[$($default,)*];

        /// What the parameters are, apart from the table: no drive needs to know, and what is not
        /// asked for is not in its flash.
        static NAMES: [&str; PARAMETERS] = [$($text,)*];

        /// All parameters, in their order; what no drive needs to look up is not in it. The
        /// defaults move nothing: torque limit and gains are zero until a set is committed.
        pub static TABLE: [Entry; PARAMETERS] = [
            $(Entry {
                address: Address::new($index, $subindex),
                parameter: Parameter::$name,
                min: $range.0,
                max: $range.1,
            },)*
        ];
    };
}

const POSITIVE: (i32, i32) = (0, i32::MAX);
const EVERY: (i32, i32) = (i32::MIN, i32::MAX);
const SWITCH: (i32, i32) = (0, 1);
const FREQUENCY: (i32, i32) = (0, 10_000_000);
const TORQUE: i32 = controller::units::TorqueLimit::LARGEST_MICRO_NM;
const SIGNED_TORQUE: (i32, i32) = (-TORQUE, TORQUE);
/// A coefficient of the filter is below 4.
const COEFFICIENT: (i32, i32) = (-i32::MAX, i32::MAX);
/// What a position error of the law can hold: below 84 mm.
const WINDOW: (i32, i32) = (1, 8_000_000);
const MISSES: (i32, i32) = (0, 100);
/// A deceleration of zero would never stop.
const DECELERATION: (i32, i32) = (1, i32::MAX);
/// A turn either way.
const TURN: (i32, i32) = (-1_000_000, 1_000_000);
/// A slope of the level over the travel.
const SLOPE: (i32, i32) = (-700_000_000, 700_000_000);
/// Cycle times that the bus and the boards are made for, µs: 10 kHz to 50 Hz.
pub const PERIOD_US: (i32, i32) = (100, 20_000);
const BRAKE_US: (i32, i32) = (0, 2_000_000);

parameters! {
    CyclePeriod = (0x1006, 0), "cycle time that the set is made for", MICROSECOND, PERIOD_US, 1000;
    PositionSource = (0x2100, 1), "position source: 0 motor encoder, 1 load scale", CHOICE, SWITCH, 1;
    PositionGain = (0x2100, 2), "position gain Kv", PER_SECOND, FREQUENCY, 0;
    Inertia = (0x2100, 3), "inertia: motor torque per acceleration at the table", INERTIA, POSITIVE, 0;
    VelocityBandwidth = (0x2100, 4), "velocity bandwidth f: Kp = 2 pi f inertia", HERTZ, FREQUENCY, 0;
    IntegralCorner = (0x2100, 5), "integral corner fi: Ki = Kp 2 pi fi", HERTZ, FREQUENCY, 0;
    AccelerationShare = (0x2100, 6), "acceleration feedforward, share of the inertia", MILLIONTH, (0, 2_000_000), 1_000_000;
    VelocityFilterTime = (0x2100, 7), "velocity filter, time constant (0 off)", NANOSECOND, POSITIVE, 0;
    TorqueLimit = (0x2100, 8), "torque limit", MICRO_NM, (0, TORQUE), 0;
    RatedTorque = (0x6076, 0), "rated torque", MILLI_NM, (1, i32::MAX), 1000;
    Feed = (0x6092, 1), "feed constant: way of the table", NANOMETRE, (1, i32::MAX), 10_000_000;
    FeedRevolutions = (0x6092, 2), "feed constant: in so many shaft revolutions", NUMBER, (1, 65_535), 1;
    EncoderIncrements = (0x608F, 1), "encoder resolution: increments", NUMBER, (1, i32::MAX), 1_000_000;
    EncoderRevolutions = (0x608F, 2), "encoder resolution: in so many motor revolutions", NUMBER, (1, 65_535), 1;
    RelationOffset = (0x2103, 1), "load scale where the motor encoder is zero", COUNT, EVERY, 0;
    RelationWindow = (0x2103, 2), "allowed difference from that relation", COUNT, WINDOW, 100_000;
    PulseHeight = (0x2110, 1), "reversal pulse height", NANOMETRE_PER_S, (-i32::MAX, i32::MAX), 0;
    PulseTime = (0x2110, 2), "reversal pulse time constant (0: one cycle)", NANOSECOND, POSITIVE, 0;
    PulseStartDelay = (0x2110, 3), "reversal pulse start delay, to whole cycles", MICROSECOND, (0, 1_000_000), 0;
    PulseShortestWay = (0x2110, 4), "way after which a reversal has its pulse", TENTH_NANOMETRE, (0, 50_000_000), 200_000;
    PulseStop = (0x2110, 5), "time without motion after which a setpoint has stopped", MICROSECOND, (1, 1_000_000), 10_000;
    AdaptiveFirst = (0x2116, 0), "acceleration at the reversal of adaptive pulse 1; each other one is at four times that of the one before", MICROMETRE_PER_S2, (1, i32::MAX), 28;
    AdaptiveForward1 = (0x2117, 1), "adaptive pulse 1, height where the axis turns forward", NANOMETRE_PER_S, (-i32::MAX, i32::MAX), 0;
    AdaptiveForward2 = (0x2117, 2), "adaptive pulse 2, height where the axis turns forward", NANOMETRE_PER_S, (-i32::MAX, i32::MAX), 0;
    AdaptiveForward3 = (0x2117, 3), "adaptive pulse 3, height where the axis turns forward", NANOMETRE_PER_S, (-i32::MAX, i32::MAX), 0;
    AdaptiveForward4 = (0x2117, 4), "adaptive pulse 4, height where the axis turns forward", NANOMETRE_PER_S, (-i32::MAX, i32::MAX), 0;
    AdaptiveForward5 = (0x2117, 5), "adaptive pulse 5, height where the axis turns forward", NANOMETRE_PER_S, (-i32::MAX, i32::MAX), 0;
    AdaptiveForward6 = (0x2117, 6), "adaptive pulse 6, height where the axis turns forward", NANOMETRE_PER_S, (-i32::MAX, i32::MAX), 0;
    AdaptiveForward7 = (0x2117, 7), "adaptive pulse 7, height where the axis turns forward", NANOMETRE_PER_S, (-i32::MAX, i32::MAX), 0;
    AdaptiveForward8 = (0x2117, 8), "adaptive pulse 8, height where the axis turns forward", NANOMETRE_PER_S, (-i32::MAX, i32::MAX), 0;
    AdaptiveForward9 = (0x2117, 9), "adaptive pulse 9, height where the axis turns forward", NANOMETRE_PER_S, (-i32::MAX, i32::MAX), 0;
    AdaptiveBackward1 = (0x2118, 1), "adaptive pulse 1, height where the axis turns backward", NANOMETRE_PER_S, (-i32::MAX, i32::MAX), 0;
    AdaptiveBackward2 = (0x2118, 2), "adaptive pulse 2, height where the axis turns backward", NANOMETRE_PER_S, (-i32::MAX, i32::MAX), 0;
    AdaptiveBackward3 = (0x2118, 3), "adaptive pulse 3, height where the axis turns backward", NANOMETRE_PER_S, (-i32::MAX, i32::MAX), 0;
    AdaptiveBackward4 = (0x2118, 4), "adaptive pulse 4, height where the axis turns backward", NANOMETRE_PER_S, (-i32::MAX, i32::MAX), 0;
    AdaptiveBackward5 = (0x2118, 5), "adaptive pulse 5, height where the axis turns backward", NANOMETRE_PER_S, (-i32::MAX, i32::MAX), 0;
    AdaptiveBackward6 = (0x2118, 6), "adaptive pulse 6, height where the axis turns backward", NANOMETRE_PER_S, (-i32::MAX, i32::MAX), 0;
    AdaptiveBackward7 = (0x2118, 7), "adaptive pulse 7, height where the axis turns backward", NANOMETRE_PER_S, (-i32::MAX, i32::MAX), 0;
    AdaptiveBackward8 = (0x2118, 8), "adaptive pulse 8, height where the axis turns backward", NANOMETRE_PER_S, (-i32::MAX, i32::MAX), 0;
    AdaptiveBackward9 = (0x2118, 9), "adaptive pulse 9, height where the axis turns backward", NANOMETRE_PER_S, (-i32::MAX, i32::MAX), 0;
    AdaptiveTime1 = (0x2119, 1), "adaptive pulse 1, time constant (0: one cycle)", NANOSECOND, POSITIVE, 0;
    AdaptiveTime2 = (0x2119, 2), "adaptive pulse 2, time constant (0: one cycle)", NANOSECOND, POSITIVE, 0;
    AdaptiveTime3 = (0x2119, 3), "adaptive pulse 3, time constant (0: one cycle)", NANOSECOND, POSITIVE, 0;
    AdaptiveTime4 = (0x2119, 4), "adaptive pulse 4, time constant (0: one cycle)", NANOSECOND, POSITIVE, 0;
    AdaptiveTime5 = (0x2119, 5), "adaptive pulse 5, time constant (0: one cycle)", NANOSECOND, POSITIVE, 0;
    AdaptiveTime6 = (0x2119, 6), "adaptive pulse 6, time constant (0: one cycle)", NANOSECOND, POSITIVE, 0;
    AdaptiveTime7 = (0x2119, 7), "adaptive pulse 7, time constant (0: one cycle)", NANOSECOND, POSITIVE, 0;
    AdaptiveTime8 = (0x2119, 8), "adaptive pulse 8, time constant (0: one cycle)", NANOSECOND, POSITIVE, 0;
    AdaptiveTime9 = (0x2119, 9), "adaptive pulse 9, time constant (0: one cycle)", NANOSECOND, POSITIVE, 0;
    AdaptiveDelay1 = (0x211A, 1), "adaptive pulse 1, start delay, to whole cycles", MICROSECOND, (0, 1_000_000), 0;
    AdaptiveDelay2 = (0x211A, 2), "adaptive pulse 2, start delay, to whole cycles", MICROSECOND, (0, 1_000_000), 0;
    AdaptiveDelay3 = (0x211A, 3), "adaptive pulse 3, start delay, to whole cycles", MICROSECOND, (0, 1_000_000), 0;
    AdaptiveDelay4 = (0x211A, 4), "adaptive pulse 4, start delay, to whole cycles", MICROSECOND, (0, 1_000_000), 0;
    AdaptiveDelay5 = (0x211A, 5), "adaptive pulse 5, start delay, to whole cycles", MICROSECOND, (0, 1_000_000), 0;
    AdaptiveDelay6 = (0x211A, 6), "adaptive pulse 6, start delay, to whole cycles", MICROSECOND, (0, 1_000_000), 0;
    AdaptiveDelay7 = (0x211A, 7), "adaptive pulse 7, start delay, to whole cycles", MICROSECOND, (0, 1_000_000), 0;
    AdaptiveDelay8 = (0x211A, 8), "adaptive pulse 8, start delay, to whole cycles", MICROSECOND, (0, 1_000_000), 0;
    AdaptiveDelay9 = (0x211A, 9), "adaptive pulse 9, start delay, to whole cycles", MICROSECOND, (0, 1_000_000), 0;
    BacklashGap = (0x2111, 0), "backlash to compensate, the whole gap", TENTH_NANOMETRE, (0, 100_000_000), 0;
    CoulombTorque = (0x2112, 0), "Coulomb feedforward", MICRO_NM, SIGNED_TORQUE, 0;
    FrictionLevel1 = (0x2150, 1), "friction element 1, torque at which it slips", MICRO_NM, (0, TORQUE), 0;
    FrictionLevel2 = (0x2150, 2), "friction element 2, torque at which it slips", MICRO_NM, (0, TORQUE), 0;
    FrictionLevel3 = (0x2150, 3), "friction element 3, torque at which it slips", MICRO_NM, (0, TORQUE), 0;
    FrictionLevel4 = (0x2150, 4), "friction element 4, torque at which it slips", MICRO_NM, (0, TORQUE), 0;
    FrictionLevel5 = (0x2150, 5), "friction element 5, torque at which it slips", MICRO_NM, (0, TORQUE), 0;
    FrictionLevel6 = (0x2150, 6), "friction element 6, torque at which it slips", MICRO_NM, (0, TORQUE), 0;
    FrictionLevel7 = (0x2150, 7), "friction element 7, torque at which it slips", MICRO_NM, (0, TORQUE), 0;
    FrictionLevel8 = (0x2150, 8), "friction element 8, torque at which it slips", MICRO_NM, (0, TORQUE), 0;
    FrictionLevel9 = (0x2150, 9), "friction element 9, torque at which it slips", MICRO_NM, (0, TORQUE), 0;
    FrictionLevel10 = (0x2150, 10), "friction element 10, torque at which it slips", MICRO_NM, (0, TORQUE), 0;
    FrictionWay1 = (0x2151, 1), "friction element 1, way after which it slips", TENTH_NANOMETRE, (1, 10_000_000), 100_000;
    FrictionWay2 = (0x2151, 2), "friction element 2, way after which it slips", TENTH_NANOMETRE, (1, 10_000_000), 100_000;
    FrictionWay3 = (0x2151, 3), "friction element 3, way after which it slips", TENTH_NANOMETRE, (1, 10_000_000), 100_000;
    FrictionWay4 = (0x2151, 4), "friction element 4, way after which it slips", TENTH_NANOMETRE, (1, 10_000_000), 100_000;
    FrictionWay5 = (0x2151, 5), "friction element 5, way after which it slips", TENTH_NANOMETRE, (1, 10_000_000), 100_000;
    FrictionWay6 = (0x2151, 6), "friction element 6, way after which it slips", TENTH_NANOMETRE, (1, 10_000_000), 100_000;
    FrictionWay7 = (0x2151, 7), "friction element 7, way after which it slips", TENTH_NANOMETRE, (1, 10_000_000), 100_000;
    FrictionWay8 = (0x2151, 8), "friction element 8, way after which it slips", TENTH_NANOMETRE, (1, 10_000_000), 100_000;
    FrictionWay9 = (0x2151, 9), "friction element 9, way after which it slips", TENTH_NANOMETRE, (1, 10_000_000), 100_000;
    FrictionWay10 = (0x2151, 10), "friction element 10, way after which it slips", TENTH_NANOMETRE, (1, 10_000_000), 100_000;
    LevelFactor0 = (0x2152, 1), "factor on the friction levels at 0/16 of 2153h", MILLIONTH, (0, 3_900_000), 1_000_000;
    LevelFactor1 = (0x2152, 2), "factor on the friction levels at 1/16 of 2153h", MILLIONTH, (0, 3_900_000), 1_000_000;
    LevelFactor2 = (0x2152, 3), "factor on the friction levels at 2/16 of 2153h", MILLIONTH, (0, 3_900_000), 1_000_000;
    LevelFactor3 = (0x2152, 4), "factor on the friction levels at 3/16 of 2153h", MILLIONTH, (0, 3_900_000), 1_000_000;
    LevelFactor4 = (0x2152, 5), "factor on the friction levels at 4/16 of 2153h", MILLIONTH, (0, 3_900_000), 1_000_000;
    LevelFactor5 = (0x2152, 6), "factor on the friction levels at 5/16 of 2153h", MILLIONTH, (0, 3_900_000), 1_000_000;
    LevelFactor6 = (0x2152, 7), "factor on the friction levels at 6/16 of 2153h", MILLIONTH, (0, 3_900_000), 1_000_000;
    LevelFactor7 = (0x2152, 8), "factor on the friction levels at 7/16 of 2153h", MILLIONTH, (0, 3_900_000), 1_000_000;
    LevelFactor8 = (0x2152, 9), "factor on the friction levels at 8/16 of 2153h", MILLIONTH, (0, 3_900_000), 1_000_000;
    LevelFactor9 = (0x2152, 10), "factor on the friction levels at 9/16 of 2153h", MILLIONTH, (0, 3_900_000), 1_000_000;
    LevelFactor10 = (0x2152, 11), "factor on the friction levels at 10/16 of 2153h", MILLIONTH, (0, 3_900_000), 1_000_000;
    LevelFactor11 = (0x2152, 12), "factor on the friction levels at 11/16 of 2153h", MILLIONTH, (0, 3_900_000), 1_000_000;
    LevelFactor12 = (0x2152, 13), "factor on the friction levels at 12/16 of 2153h", MILLIONTH, (0, 3_900_000), 1_000_000;
    LevelFactor13 = (0x2152, 14), "factor on the friction levels at 13/16 of 2153h", MILLIONTH, (0, 3_900_000), 1_000_000;
    LevelFactor14 = (0x2152, 15), "factor on the friction levels at 14/16 of 2153h", MILLIONTH, (0, 3_900_000), 1_000_000;
    LevelFactor15 = (0x2152, 16), "factor on the friction levels at 15/16 of 2153h", MILLIONTH, (0, 3_900_000), 1_000_000;
    LevelFactor16 = (0x2152, 17), "factor on the friction levels at 16/16 of 2153h", MILLIONTH, (0, 3_900_000), 1_000_000;
    LevelSpan = (0x2153, 0), "speed at the end of the factors on the friction levels (0: all as at standstill)", MICROMETRE_PER_S, POSITIVE, 0;
    LevelLagWay = (0x2157, 1), "factor on the friction levels comes within this way (0: at once)", TENTH_NANOMETRE, (0, 10_000_000), 0;
    LevelLagTime = (0x2157, 2), "factor on the friction levels comes within this time (0: at once)", MICROSECOND, (0, 1_000_000), 0;
    ViscousTorque = (0x2154, 0), "viscous feedforward", VISCOUS, POSITIVE, 0;
    FrictionAhead = (0x2155, 1), "friction torque acts so long after its cycle has begun", MICROSECOND, (0, 100_000), 0;
    WindupAhead = (0x2155, 2), "wind-up of the screw is so far ahead of friction", MICROSECOND, (-100_000, 100_000), 0;
    FrictionDamping = (0x2155, 3), "damping of presliding over its stiffness", MICROSECOND, (0, 100_000), 0;
    Windup = (0x2156, 1), "wind-up of the screw per torque of friction", WINDUP, POSITIVE, 0;
    MotorInertia = (0x2156, 2), "inertia of the motor alone, for the wind-up", INERTIA, POSITIVE, 0;
    GapWidth = (0x2156, 3), "gap that the axis crosses where the torque behind it changes sign (0: none)", TENTH_NANOMETRE, (0, 10_000_000), 0;
    GapTorque = (0x2156, 4), "torque within which it is crossed, to either side", MICRO_NM, (1, TORQUE), 100_000;
    TableInertia = (0x2156, 5), "inertia of the table alone, for the gap", INERTIA, POSITIVE, 0;
    TableTorque = (0x2156, 6), "constant torque of the table, as a weight, for the gap", MICRO_NM, SIGNED_TORQUE, 0;
    GapVelocity = (0x2156, 7), "velocity from which on it is that torque; in proportion below, an eighth at least (0: always)", MICROMETRE_PER_S, POSITIVE, 0;
    LevelSlope = (0x2158, 1), "friction levels change along the travel, per way from position zero", MILLIONTH_PER_M, SLOPE, 0;
    LevelBend = (0x2158, 2), "and per square of that way", MILLIONTH_PER_M2, (-i32::MAX, i32::MAX), 0;
    LevelTuning = (0x2159, 1), "share of what a turn tells that the friction level is refined by (0 off)", MILLIONTH, (0, 1_000_000), 0;
    LevelSettling = (0x2159, 2), "time from a turn until it tells that", MICROSECOND, (0, 1_000_000), 120_000;
    LevelSettlingWay = (0x2159, 3), "way from a turn until it tells that", TENTH_NANOMETRE, (0, 50_000_000), 1_000_000;
    RippleTorque1 = (0x215A, 1), "ripple 1, amplitude", MICRO_NM, (0, TORQUE), 0;
    RipplePeriod1 = (0x215A, 2), "ripple 1, way from one period to the next", TENTH_NANOMETRE, (10_000, i32::MAX), 100_000_000;
    RipplePhase1 = (0x215A, 3), "ripple 1, phase at position zero, of a turn", MILLIONTH, TURN, 0;
    RippleTorque2 = (0x215A, 4), "ripple 2, amplitude", MICRO_NM, (0, TORQUE), 0;
    RipplePeriod2 = (0x215A, 5), "ripple 2, way from one period to the next", TENTH_NANOMETRE, (10_000, i32::MAX), 100_000_000;
    RipplePhase2 = (0x215A, 6), "ripple 2, phase at position zero, of a turn", MILLIONTH, TURN, 0;
    ViscousAsymmetry = (0x215B, 0), "viscous feedforward, how much more forward than backward, halved", VISCOUS, (-i32::MAX, i32::MAX), 0;
    LevelAsymmetry = (0x215C, 1), "friction levels, how much higher forward than backward, halved", MICRO_NM, SIGNED_TORQUE, 0;
    WayAsymmetry = (0x215C, 2), "ways after which elements slip, by which share longer forward, shorter backward", MILLIONTH, (-900_000, 900_000), 0;
    FrictionOnMotor1 = (0x215D, 1), "friction element 1, share of it on the motor's side, which winds nothing up", MILLIONTH, (0, 1_000_000), 0;
    FrictionOnMotor2 = (0x215D, 2), "friction element 2, share of it on the motor's side, which winds nothing up", MILLIONTH, (0, 1_000_000), 0;
    FrictionOnMotor3 = (0x215D, 3), "friction element 3, share of it on the motor's side, which winds nothing up", MILLIONTH, (0, 1_000_000), 0;
    FrictionOnMotor4 = (0x215D, 4), "friction element 4, share of it on the motor's side, which winds nothing up", MILLIONTH, (0, 1_000_000), 0;
    FrictionOnMotor5 = (0x215D, 5), "friction element 5, share of it on the motor's side, which winds nothing up", MILLIONTH, (0, 1_000_000), 0;
    FrictionOnMotor6 = (0x215D, 6), "friction element 6, share of it on the motor's side, which winds nothing up", MILLIONTH, (0, 1_000_000), 0;
    FrictionOnMotor7 = (0x215D, 7), "friction element 7, share of it on the motor's side, which winds nothing up", MILLIONTH, (0, 1_000_000), 0;
    FrictionOnMotor8 = (0x215D, 8), "friction element 8, share of it on the motor's side, which winds nothing up", MILLIONTH, (0, 1_000_000), 0;
    FrictionOnMotor9 = (0x215D, 9), "friction element 9, share of it on the motor's side, which winds nothing up", MILLIONTH, (0, 1_000_000), 0;
    FrictionOnMotor10 = (0x215D, 10), "friction element 10, share of it on the motor's side, which winds nothing up", MILLIONTH, (0, 1_000_000), 0;
    VelocityLimit = (0x607F, 0), "velocity limit of the axis", MICROMETRE_PER_S, POSITIVE, 0;
    AccelerationLimit = (0x60C5, 0), "acceleration limit of the axis", MICROMETRE_PER_S2, POSITIVE, 0;
    SlowDownDeceleration = (0x6084, 0), "deceleration of the slow-down ramp", MICROMETRE_PER_S2, DECELERATION, 5_000_000;
    QuickStopDeceleration = (0x6085, 0), "deceleration of the quick-stop ramp", MICROMETRE_PER_S2, DECELERATION, 5_000_000;
    RampJerk = (0x60A4, 1), "jerk of both ramps (0 not limited)", MILLIMETRE_PER_S3, POSITIVE, 0;
    // The geometric mean of a smooth path (50 m/s^3) and of a step of 5 m/s^2 within 1 ms; fits the
    // machine units at 20 ms too.
    StepJerk = (0x2114, 0), "jerk of a path above which the acceleration makes a step", MILLIMETRE_PER_S3, (1, i32::MAX), 500_000;
    PositionMin = (0x607D, 1), "software position limit, lower (INTEGER32 minimum: none)", COUNT, EVERY, i32::MIN;
    PositionMax = (0x607D, 2), "software position limit, upper (INTEGER32 maximum: none)", COUNT, EVERY, i32::MAX;
    SetpointPeriod = (0x60C2, 1), "setpoint period (0: every cycle)", NUMBER, (0, 255), 0;
    SetpointPeriodExponent = (0x60C2, 2), "setpoint period, power of ten of seconds", NUMBER, (-6, 0), -3;
    SetpointFilter = (0x2115, 0), "setpoint filter over 2^n cycles (0 off)", NUMBER, (0, 4), 0;
    FilterB0 = (0x2120, 1), "torque filter b0", Q29, COEFFICIENT, 1 << 29;
    FilterB1 = (0x2120, 2), "torque filter b1", Q29, COEFFICIENT, 0;
    FilterB2 = (0x2120, 3), "torque filter b2", Q29, COEFFICIENT, 0;
    FilterA1 = (0x2120, 4), "torque filter a1 (y0 = ... + a1 y1)", Q29, COEFFICIENT, 0;
    FilterA2 = (0x2120, 5), "torque filter a2 (y0 = ... + a2 y2)", Q29, COEFFICIENT, 0;
    FilterPeriod = (0x2120, 6), "cycle time that the torque filter is made for", MICROSECOND, PERIOD_US, 1000;
    SetpointMissesAllowed = (0x2130, 1), "setpoints missed in a row before the ramp", CYCLES, MISSES, 3;
    FeedbackMissesAllowed = (0x2130, 2), "feedbacks missed in a row before torque zero", CYCLES, MISSES, 3;
    RefusalsAllowed = (0x2130, 3), "setpoints refused in a row before the ramp", CYCLES, MISSES, 3;
    EncoderJumpLimit = (0x2130, 4), "encoder jump beyond the expected way", COUNT, WINDOW, 100_000;
    HeartbeatTimeout = (0x2130, 5), "plant heartbeat timeout (0: 450 periods)", MILLISECOND, (0, 60_000), 0;
    FollowingErrorWindow = (0x6065, 0), "following error window", COUNT, WINDOW, 100_000;
    SyncTimeout = (0x2131, 0), "SYNC timeout (0: 5 periods)", MICROSECOND, (0, 60_000_000), 0;
    StageCycles = (0x2132, 0), "power stage confirms within", CYCLES, (1, 100), 3;
    EnableWindow = (0x2133, 0), "setpoint may be so far from the axis at enable", COUNT, WINDOW, 10_000;
    BrakeOpening = (0x2140, 1), "brake opening time", MICROSECOND, BRAKE_US, 0;
    BrakeClosing = (0x2140, 2), "brake closing time", MICROSECOND, BRAKE_US, 0;
    PresetTorque = (0x2141, 1), "torque preset at enable", MICRO_NM, SIGNED_TORQUE, 0;
    PresetFromLast = (0x2141, 2), "torque preset: 0 as 2141h:1, 1 as before the last disable", CHOICE, SWITCH, 0;
    AbortConnectionOption = (0x6007, 0), "connection lost: 1 fault, 2 disable voltage, 3 quick stop (0, nothing, is not taken)", CHOICE, (1, 3), 1;
    QuickStopOption = (0x605A, 0), "quick stop: 0 disable, 1 slow down, 2 quick stop; 5, 6 as 1, 2 and stay", CHOICE, (0, 6), 2;
    ShutdownOption = (0x605B, 0), "shutdown: 0 disable, 1 slow down", CHOICE, SWITCH, 0;
    DisableOperationOption = (0x605C, 0), "disable operation: 0 disable, 1 slow down", CHOICE, SWITCH, 1;
    HaltOption = (0x605D, 0), "halt: 1 slow down, 2 quick stop", CHOICE, (1, 2), 1;
    FaultReactionOption = (0x605E, 0), "fault reaction: 0 disable, 1 slow down, 2 quick stop", CHOICE, (0, 2), 2;
}

/// Writing [`COMMIT_KEY`] makes the staged set active at the next cycle; reading gives the number
/// of commits.
pub const COMMIT: Address = Address::new(0x2F00, 0);
/// "cmit", as the bytes stand on the bus.
pub const COMMIT_KEY: u32 = u32::from_le_bytes(*b"cmit");
/// Which set an upload of a parameter reads: 0 staged, 1 active. UNSIGNED8.
pub const SET_READ: Address = Address::new(0x2F01, 0);
/// Row of the parameter that the last commit was refused for, as in `docs/objects.md`; 0 where it
/// was taken.
pub const REFUSED_ROW: Address = Address::new(0x2F02, 1);
/// Why it was refused: [`crate::parameters::SetError::code`].
pub const REFUSED_REASON: Address = Address::new(0x2F02, 2);
/// The SYNC period that the master declares, µs; 0: not declared. Not part of the set, active at
/// once.
pub const DECLARED_PERIOD: Address = Address::new(0x2102, 0);
/// Device type: CiA 402 servo drive.
pub const DEVICE_TYPE: Address = Address::new(0x1000, 0);
/// Value of [`DEVICE_TYPE`].
pub const DEVICE_TYPE_VALUE: u32 = 0x0002_0192;
/// Error register.
pub const ERROR_REGISTER: Address = Address::new(0x1001, 0);
/// Period of the servo's heartbeat, ms.
pub const HEARTBEAT_PERIOD: Address = Address::new(0x1017, 0);
/// Code of the last EMCY.
pub const ERROR_CODE: Address = Address::new(0x603F, 0);
/// Status word.
pub const STATUS_WORD: Address = Address::new(0x6041, 0);
/// Modes of operation display: 8, cyclic synchronous position.
pub const MODE_DISPLAY: Address = Address::new(0x6061, 0);
/// Actual position of the encoder that closes the loop, 10 nm.
pub const POSITION_ACTUAL: Address = Address::new(0x6064, 0);
/// Following error in 10 nm.
pub const FOLLOWING_ERROR: Address = Address::new(0x60F4, 0);
/// Motor encoder as a position at the table, 10 nm.
pub const MOTOR_POSITION: Address = Address::new(0x2201, 1);
/// Load scale, 10 nm.
pub const LOAD_POSITION: Address = Address::new(0x2201, 2);
/// What else there is to know about the last fault: the four bytes of its EMCY after code, counter.
pub const FAULT_DETAIL: Address = Address::new(0x2202, 0);
/// Factor on the levels of friction that turns have refined, 1e-6.
pub const REFINED_LEVEL: Address = Address::new(0x2159, 4);
/// Why the node started ([`protocol::leaf::StartedBy`]).
pub const STARTED_BY: Address = Address::new(0x2203, 1);
/// Deadlines that its leaf missed since.
pub const MISSED_DEADLINES: Address = Address::new(0x2203, 2);
/// The latest that the leaf was, µs.
pub const LATEST: Address = Address::new(0x2203, 3);
/// What the leaf has timed from the interrupt that takes a frame to the end of what it causes,
/// where that is a torque: [`protocol::leaf::Durations`], subindex 1 to 16.
pub const RECEIVE_TO_TORQUE_INDEX: u16 = 0x2204;
/// The same from when the node begins with what closes a cycle to when its torque is ready.
pub const CONTROL_CYCLE_INDEX: u16 = 0x2205;

/// What the leaf has timed at an index.
#[must_use]
pub const fn timed(index: u16) -> Option<Timed> {
    match index {
        RECEIVE_TO_TORQUE_INDEX => Some(Timed::ReceiveToTorque),
        CONTROL_CYCLE_INDEX => Some(Timed::ControlCycle),
        _ => None,
    }
}

/// What a write to an address clears, whatever is written: a count of durations.
#[must_use]
pub const fn cleared(address: Address) -> Option<Timed> {
    match address.subindex {
        1 => timed(address.index),
        _ => None,
    }
}

/// Whether an address is one of what the leaf has timed.
#[must_use]
pub fn is_timed(address: Address) -> bool {
    timed(address.index).is_some() && usize::from(address.subindex) <= Durations::NUMBERS
}

/// Counts since reset: [`crate::watchdog::Counts`], subindex 1 to 9.
pub const DIAGNOSTICS_INDEX: u16 = 0x2200;

/// What subindices 2 to 5 of what the leaf has timed say.
const LEAST: &str = "least of these times, ns";
const GREATEST: &str = "greatest of these times, ns";
const SUM: &str = "sum of these times, us; stops at its end";
const CLASSES: &str =
    "those below 1 us; subindices 6 to 15 below 2, 4, 8 to 1024 us, 16 from there on";

/// Objects beside the parameters that can be read, with what they say.
pub const READINGS: [(Address, &str); 40] = [
    (DEVICE_TYPE, "device type"),
    (ERROR_REGISTER, "error register"),
    (HEARTBEAT_PERIOD, "heartbeat period, ms"),
    (
        DECLARED_PERIOD,
        "SYNC period that the master declares, us; 0 not declared; writable, active at once",
    ),
    (Address::new(DIAGNOSTICS_INDEX, 1), "cycles computed"),
    (Address::new(DIAGNOSTICS_INDEX, 2), "cycles bridged"),
    (Address::new(DIAGNOSTICS_INDEX, 3), "cycles refused"),
    (
        Address::new(DIAGNOSTICS_INDEX, 4),
        "cycles closed by deadline",
    ),
    (Address::new(DIAGNOSTICS_INDEX, 5), "frames stale"),
    (Address::new(DIAGNOSTICS_INDEX, 6), "frames malformed"),
    (Address::new(DIAGNOSTICS_INDEX, 7), "frames implausible"),
    (Address::new(DIAGNOSTICS_INDEX, 8), "frames doubled"),
    (
        Address::new(DIAGNOSTICS_INDEX, 9),
        "implausible values of the load scale while the motor encoder closes the loop",
    ),
    (
        MOTOR_POSITION,
        "motor encoder as a position at the table, 10 nm",
    ),
    (LOAD_POSITION, "load scale, 10 nm"),
    (FAULT_DETAIL, "detail of the last fault"),
    (
        STARTED_BY,
        "why the node started: 0 power, 1 pin, 2 software, 3 watchdog, 4 panic, 5 processor fault, 6 low voltage",
    ),
    (MISSED_DEADLINES, "deadlines that the board missed since"),
    (LATEST, "the latest that the board was, us"),
    (
        Address::new(RECEIVE_TO_TORQUE_INDEX, 1),
        "frames that were timed from their interrupt to the end of what they caused, a torque with it; a write of anything clears 2204h",
    ),
    (Address::new(RECEIVE_TO_TORQUE_INDEX, 2), LEAST),
    (Address::new(RECEIVE_TO_TORQUE_INDEX, 3), GREATEST),
    (Address::new(RECEIVE_TO_TORQUE_INDEX, 4), SUM),
    (Address::new(RECEIVE_TO_TORQUE_INDEX, 5), CLASSES),
    (
        Address::new(CONTROL_CYCLE_INDEX, 1),
        "control cycles that were timed, from when the node began with them until their torque was ready; a write of anything clears 2205h",
    ),
    (Address::new(CONTROL_CYCLE_INDEX, 2), LEAST),
    (Address::new(CONTROL_CYCLE_INDEX, 3), GREATEST),
    (Address::new(CONTROL_CYCLE_INDEX, 4), SUM),
    (Address::new(CONTROL_CYCLE_INDEX, 5), CLASSES),
    (
        REFINED_LEVEL,
        "factor on the friction levels that turns have refined, 1e-6; another model sets it to one",
    ),
    (
        COMMIT,
        "number of commits; writing \"cmit\" (0x74696D63) commits",
    ),
    (
        SET_READ,
        "set that uploads of parameters read: 0 staged, 1 active; writable",
    ),
    (
        REFUSED_ROW,
        "row of the parameter that the last commit was refused for; 0 none",
    ),
    (REFUSED_REASON, "reason of that refusal"),
    (ERROR_CODE, "code of the last EMCY"),
    (STATUS_WORD, "status word"),
    (
        MODE_DISPLAY,
        "mode of operation: 8, cyclic synchronous position",
    ),
    (
        POSITION_ACTUAL,
        "position of the encoder that closes the loop, 10 nm",
    ),
    (FOLLOWING_ERROR, "following error, 10 nm"),
    (
        Address::new(DIAGNOSTICS_INDEX, 0),
        "highest subindex of the counts",
    ),
];

/// The row at an address.
#[must_use]
pub fn find(address: Address) -> Option<&'static Entry> {
    TABLE.iter().find(|entry| entry.address == address)
}

/// Whether any object has this index.
#[must_use]
pub fn index_exists(index: u16) -> bool {
    READINGS.iter().any(|(address, _)| address.index == index)
        || TABLE.iter().any(|entry| entry.address.index == index)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_object_has_an_address_of_its_own() {
        let parameters = TABLE.iter().map(|entry| entry.address);
        let mut addresses: Vec<Address> = parameters
            .chain(READINGS.iter().map(|(address, _)| *address))
            .collect();
        addresses.sort_unstable();
        let all = addresses.len();
        addresses.dedup();
        assert_eq!(addresses.len(), all);
    }

    #[test]
    fn every_default_fits_its_row_and_every_row_is_at_the_place_of_its_parameter() {
        for (place, entry) in TABLE.iter().enumerate() {
            assert_eq!(entry.parameter as usize, place, "{}", entry.name());
            assert_eq!(entry.check(entry.default()), Ok(()), "{}", entry.name());
        }
    }

    #[test]
    fn the_option_codes_are_those_that_the_drive_supports() {
        let taken = |parameter: Parameter| -> Vec<i32> {
            let entry = TABLE
                .iter()
                .find(|entry| entry.parameter == parameter)
                .unwrap();
            (-2..10)
                .filter(|value| entry.check(*value).is_ok())
                .collect()
        };
        assert_eq!(taken(Parameter::QuickStopOption), [0, 1, 2, 5, 6]);
        assert_eq!(taken(Parameter::ShutdownOption), [0, 1]);
        assert_eq!(taken(Parameter::DisableOperationOption), [0, 1]);
        assert_eq!(taken(Parameter::HaltOption), [1, 2]);
        assert_eq!(taken(Parameter::FaultReactionOption), [0, 1, 2]);
        assert_eq!(taken(Parameter::AbortConnectionOption), [1, 2, 3]);
    }
}
