//! Faults that a node can latch, with their EMCY error codes (CiA 301 table 26, CiA 402-2 §A.3).
//!
//! One table makes the enum, its list, its codes and its texts, so that a fault cannot be forgotten
//! in one of them.

macro_rules! faults {
    ($($(#[$doc:meta])* $name:ident = $code:literal, $emergency:literal, $text:literal;)*) => {
        /// Why a node went to its safe state, or refused to leave it.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        #[repr(u8)]
        pub enum Fault {
            $($(#[$doc])* $name = $code,)*
        }

        impl Fault {
            /// All faults, by code.
            pub const ALL: &'static [Self] = &[$(Self::$name,)*];

            /// The code in the status and EMCY frames.
            #[must_use]
            pub const fn code(self) -> u8 {
                match self {
                    $(Self::$name => $code,)*
                }
            }

            /// The fault of a code; `None` for 0 (no fault) and unknown ones.
            #[must_use]
            pub const fn from_code(code: u8) -> Option<Self> {
                match code {
                    $($code => Some(Self::$name),)*
                    _ => None,
                }
            }

            /// EMCY error code.
            #[must_use]
            pub const fn emergency_code(self) -> u16 {
                match self {
                    $(Self::$name => $emergency,)*
                }
            }

            /// What happened and what clears it, for people.
            #[must_use]
            pub const fn text(self) -> &'static str {
                match self {
                    $(Self::$name => $text,)*
                }
            }
        }
    };
}

faults! {
    /// No fresh setpoint for the stated number of cycles.
    SetpointMissing = 1, 0x8250, "no fresh setpoint; check the workbench, then reset the fault";
    /// No fresh feedback for the stated number of cycles.
    FeedbackMissing = 2, 0x8250, "no fresh feedback; check the plant and its bus, then reset the fault";
    /// No fresh torque command for the stated number of cycles (latched by the plant).
    TorqueMissing = 3, 0x8250, "no fresh torque command; check the servo, then reset the fault";
    /// Following error beyond its window.
    FollowingError = 4, 0x8611, "following error beyond its window; check limits and gains, then reset the fault";
    /// Encoder jumped farther than the axis can move, for the stated number of cycles.
    EncoderJump = 5, 0x7305, "encoder jumped farther than the axis can move; check the encoder, then reset the fault";
    /// Frames with a stale SYNC counter for the stated number of cycles.
    StaleCounter = 6, 0xFF02, "frames carry an old SYNC counter; check the sender, then reset the fault";
    /// SYNC itself is gone, by time (objects 1006h and 2131h).
    SyncMissing = 7, 0x8700, "SYNC is gone; restart the SYNC producer, then reset the fault";
    /// The peer's heartbeat is gone.
    HeartbeatLost = 8, 0x8130, "the peer's heartbeat is gone; restart the peer, then reset the fault";
    /// The peer reported an emergency.
    PeerFault = 9, 0xFF01, "the peer reported an emergency; clear it there, then reset the fault";
    /// Frames that cannot be decoded for the stated number of cycles.
    MalformedFrame = 10, 0x8210, "frames cannot be decoded; check the sender's mapping, then reset the fault";
    /// Setpoints that the axis' limits make impossible, for the stated number of cycles.
    SetpointImplausible = 11, 0x8612, "setpoints need more than the axis' acceleration limit; check the path and the cycle time, then reset the fault";
    /// The power stage did not confirm that it is enabled.
    StageRefused = 12, 0x5400, "the power stage did not confirm; check its supply and its fault, then reset the fault";
    /// The power stage dropped out while the loop was closed.
    StageLost = 13, 0x5410, "the power stage dropped out; check its supply and its fault, then reset the fault";
    /// Enable was refused: the setpoint is farther from the axis than the window (object 2133h).
    ReferenceTooFar = 14, 0x8680, "the setpoint is too far from where the axis stands; send the actual position, then enable again";
    /// Enable was refused: the parameter set was made for another cycle time than that of SYNC.
    CycleTimeMismatch = 15, 0x6320, "the parameter set was made for another cycle time (1006h); download one for this cycle, then enable again";
    /// Load scale and motor encoder are not where their relation (object 2103h) says.
    EncoderRelation = 16, 0x7300, "scale and motor encoder do not fit their relation (2103h); reference the axis or correct the parameter, then reset the fault";
    /// A limit was passed that had been lowered, or reached, in motion.
    LimitOverrun = 17, 0x8612, "the axis ran into a limit in motion; check limits and path, then reset the fault";
    /// The brake did not do what it was told in time.
    BrakeFailed = 18, 0xFF10, "the brake did not open or close in time; check it, then reset the fault";
}
