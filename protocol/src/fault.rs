//! Faults that a node can latch, with their EMCY error codes (CiA 301 table 26, CiA 402-2 §A.3).

/// Why a node went to its safe state.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u8)]
pub enum Fault {
    /// No fresh setpoint for the stated number of cycles.
    SetpointMissing = 1,
    /// No fresh feedback for the stated number of cycles.
    FeedbackMissing = 2,
    /// No fresh torque command for the stated number of cycles (latched by the plant).
    TorqueMissing = 3,
    /// Following error beyond its window.
    FollowingError = 4,
    /// Encoder jumped farther than the axis can move, for the stated number of cycles.
    EncoderJump = 5,
    /// Frames with a stale SYNC counter for the stated number of cycles.
    StaleCounter = 6,
    /// SYNC itself is gone, by wall clock (object 1006h).
    SyncMissing = 7,
    /// The peer's heartbeat is gone, counted in cycles.
    HeartbeatLost = 8,
    /// The peer reported an emergency.
    PeerFault = 9,
    /// Frames that cannot be decoded for the stated number of cycles.
    MalformedFrame = 10,
}

impl Fault {
    /// All faults, by code.
    pub const ALL: [Self; 10] = [
        Self::SetpointMissing,
        Self::FeedbackMissing,
        Self::TorqueMissing,
        Self::FollowingError,
        Self::EncoderJump,
        Self::StaleCounter,
        Self::SyncMissing,
        Self::HeartbeatLost,
        Self::PeerFault,
        Self::MalformedFrame,
    ];

    /// The code in the status and EMCY frames.
    #[must_use]
    #[expect(clippy::as_conversions, reason = "repr(u8): the discriminant is the code")]
    pub const fn code(self) -> u8 {
        self as u8
    }

    /// The fault of a code; `None` for 0 (no fault) and unknown ones.
    #[must_use]
    pub fn from_code(code: u8) -> Option<Self> {
        Self::ALL.into_iter().find(|fault| fault.code() == code)
    }

    /// EMCY error code.
    #[must_use]
    pub const fn emergency_code(self) -> u16 {
        match self {
            Self::SetpointMissing | Self::FeedbackMissing | Self::TorqueMissing => 0x8250,
            Self::FollowingError => 0x8611,
            Self::EncoderJump => 0x7305,
            Self::StaleCounter => 0xFF02,
            Self::SyncMissing => 0x8700,
            Self::HeartbeatLost => 0x8130,
            Self::PeerFault => 0xFF01,
            Self::MalformedFrame => 0x8210,
        }
    }

    /// What happened and what clears it, for people.
    #[must_use]
    pub const fn text(self) -> &'static str {
        match self {
            Self::SetpointMissing => "no fresh setpoint; check the workbench, then reset the fault",
            Self::FeedbackMissing => "no fresh feedback; check the plant and its bus, then reset the fault",
            Self::TorqueMissing => "no fresh torque command; check the servo, then reset the fault",
            Self::FollowingError => "following error beyond its window; check limits and gains, then reset the fault",
            Self::EncoderJump => {
                "encoder jumped farther than the axis can move; check the encoder, then reset the fault"
            }
            Self::StaleCounter => "frames carry an old SYNC counter; check the sender, then reset the fault",
            Self::SyncMissing => "SYNC is gone; restart the SYNC producer, then reset the fault",
            Self::HeartbeatLost => "the peer's heartbeat is gone; restart the peer, then reset the fault",
            Self::PeerFault => "the peer reported an emergency; clear it there, then reset the fault",
            Self::MalformedFrame => "frames cannot be decoded; check the sender's mapping, then reset the fault",
        }
    }
}
