//! The drive's state words: CiA 402-2 (IEC 61800-7-201) state machine on the wire.
//!
//! Only the values stand here; who moves from which state to which is the servo's business.

/// Power drive states, CiA 402-2 §4.2.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum DriveState {
    /// No torque; waiting for `shutdown`.
    SwitchOnDisabled,
    /// No torque; waiting for `switch on`.
    ReadyToSwitchOn,
    /// No torque; the plant is told to be ready.
    SwitchedOn,
    /// The loop is closed.
    OperationEnabled,
    /// Controlled stop on command or on a missing setpoint.
    QuickStopActive,
    /// Controlled stop because of a fault.
    FaultReactionActive,
    /// No torque; cleared only by a fault reset.
    Fault,
}

impl DriveState {
    /// All states, in the order of CiA 402.
    pub const ALL: [Self; 7] = [
        Self::SwitchOnDisabled,
        Self::ReadyToSwitchOn,
        Self::SwitchedOn,
        Self::OperationEnabled,
        Self::QuickStopActive,
        Self::FaultReactionActive,
        Self::Fault,
    ];

    const fn bits(self) -> u16 {
        match self {
            Self::SwitchOnDisabled => 0x0040,
            Self::ReadyToSwitchOn => 0x0021,
            Self::SwitchedOn => 0x0023,
            Self::OperationEnabled => 0x0027,
            Self::QuickStopActive => 0x0007,
            Self::FaultReactionActive => 0x000F,
            Self::Fault => 0x0008,
        }
    }
}

/// Status word, object 6041h.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StatusWord(pub u16);

impl StatusWord {
    const STATE_MASK: u16 = 0x006F;
    /// Bit 4: voltage enabled, the power stage is supplied.
    pub const VOLTAGE_ENABLED: u16 = 0x0010;
    /// Bit 7: a frame was lost, stale or malformed since the last status frame, and was bridged.
    pub const WARNING: u16 = 0x0080;
    /// Bit 9: the control word is followed (NMT operational).
    pub const REMOTE: u16 = 0x0200;
    /// Bit 10: target reached; while halt or a stop is commanded: the axis stands.
    pub const TARGET_REACHED: u16 = 0x0400;
    /// Bit 11: torque or velocity stood at its limit.
    pub const INTERNAL_LIMIT: u16 = 0x0800;
    /// Bit 12: the drive follows the setpoint (cyclic synchronous position).
    pub const FOLLOWS_SETPOINT: u16 = 0x1000;

    /// The status word of a state, without further bits.
    #[must_use]
    pub const fn of(state: DriveState) -> Self {
        Self(state.bits())
    }

    /// The same word with further bits set.
    #[must_use]
    pub const fn with(self, bits: u16) -> Self {
        Self(self.0 | bits)
    }

    /// The state that the word tells; `None` for a word outside CiA 402.
    #[must_use]
    pub fn state(self) -> Option<DriveState> {
        DriveState::ALL
            .into_iter()
            .find(|state| state.bits() == self.0 & Self::STATE_MASK)
    }
}

/// Where a brake stands, as the plant tells it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BrakeState {
    /// The axis has none: it never holds and never hinders.
    #[default]
    NotFitted,
    /// It holds.
    Closed,
    /// On its way; nobody may count on it.
    Moving,
    /// It lets go.
    Open,
}

impl BrakeState {
    /// The code on the wire.
    #[must_use]
    pub const fn code(self) -> u8 {
        match self {
            Self::NotFitted => 0,
            Self::Closed => 1,
            Self::Moving => 2,
            Self::Open => 3,
        }
    }

    /// The state of a code; `None` for an unknown one.
    #[must_use]
    pub const fn from_code(code: u8) -> Option<Self> {
        match code {
            0 => Some(Self::NotFitted),
            1 => Some(Self::Closed),
            2 => Some(Self::Moving),
            3 => Some(Self::Open),
            _ => None,
        }
    }
}

/// Control word, object 6040h.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub struct ControlWord(pub u16);

impl ControlWord {
    /// Disable voltage: to `switch on disabled`.
    pub const DISABLE_VOLTAGE: Self = Self(0x0000);
    /// Shutdown: to `ready to switch on`.
    pub const SHUTDOWN: Self = Self(0x0006);
    /// Switch on: to `switched on`.
    pub const SWITCH_ON: Self = Self(0x0007);
    /// Enable operation: to `operation enabled`.
    pub const ENABLE_OPERATION: Self = Self(0x000F);
    /// Quick stop: controlled stop.
    pub const QUICK_STOP: Self = Self(0x0002);
    /// Fault reset, acts on its rising edge.
    pub const FAULT_RESET: Self = Self(0x0080);

    /// Bit 8: halt, a controlled stop with the loop closed (605Dh).
    pub const HALT: u16 = 0x0100;
    /// Bit 11 (manufacturer specific), from the servo to its plant: release the brake.
    pub const RELEASE_BRAKE: u16 = 0x0800;

    /// The same word with further bits set.
    #[must_use]
    pub const fn with(self, bits: u16) -> Self {
        Self(self.0 | bits)
    }

    /// Whether all of these bits are set.
    #[must_use]
    pub const fn has(self, bits: u16) -> bool {
        self.0 & bits == bits
    }

    /// What the word asks for, CiA 402-2 table 23; `None` where it asks for nothing known.
    #[must_use]
    pub const fn command(self) -> Option<Command> {
        match self.0 & 0x008F {
            bits if bits & 0x0080 != 0 => Some(Command::FaultReset),
            bits if bits & 0x0002 == 0 => Some(Command::DisableVoltage),
            bits if bits & 0x0004 == 0 => Some(Command::QuickStop),
            bits if bits & 0x0001 == 0 => Some(Command::Shutdown),
            bits if bits & 0x0008 == 0 => Some(Command::SwitchOn),
            0x000F => Some(Command::EnableOperation),
            _ => None,
        }
    }
}

/// Commands of the control word.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Command {
    /// To `ready to switch on`.
    Shutdown,
    /// To `switched on`.
    SwitchOn,
    /// To `operation enabled`.
    EnableOperation,
    /// To `switch on disabled`.
    DisableVoltage,
    /// Controlled stop.
    QuickStop,
    /// Leave `fault`, on the rising edge.
    FaultReset,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_state_is_told_apart_by_its_status_word() {
        for state in DriveState::ALL {
            let noisy = StatusWord::of(state)
                .with(StatusWord::WARNING | StatusWord::INTERNAL_LIMIT | 0x0200);
            assert_eq!(noisy.state(), Some(state));
        }
        assert_eq!(StatusWord(0x0001).state(), None);
    }

    #[test]
    fn control_words_ask_what_cia_402_says() {
        assert_eq!(ControlWord::SHUTDOWN.command(), Some(Command::Shutdown));
        assert_eq!(ControlWord::SWITCH_ON.command(), Some(Command::SwitchOn));
        assert_eq!(
            ControlWord::ENABLE_OPERATION.command(),
            Some(Command::EnableOperation)
        );
        assert_eq!(
            ControlWord::DISABLE_VOLTAGE.command(),
            Some(Command::DisableVoltage)
        );
        assert_eq!(ControlWord::QUICK_STOP.command(), Some(Command::QuickStop));
        assert_eq!(
            ControlWord::FAULT_RESET.command(),
            Some(Command::FaultReset)
        );
    }
}
