//! The power drive state machine of CiA 402-2, as an enum with data.
//!
//! A fault says what was seen; it is latched, and only a fault reset clears it. Faults with a trustworthy measurement lead to a
//! controlled stop, all others to torque zero at once.

use protocol::Fault;
use protocol::states::{Command, ControlWord, DriveState};

use crate::stop::Stop;

/// State of the drive.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Drive {
    /// No torque.
    #[default]
    SwitchOnDisabled,
    /// No torque.
    ReadyToSwitchOn,
    /// No torque; the plant is told to be ready.
    SwitchedOn,
    /// The loop is closed.
    OperationEnabled,
    /// Controlled stop on command.
    QuickStop(Stop),
    /// Controlled stop because of a fault.
    FaultReaction(Fault, Stop),
    /// No torque until a fault reset.
    Faulted(Fault),
}

/// What the drive does about a fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reaction {
    /// Torque zero at once.
    TorqueZero,
    /// Ramp down, then torque zero.
    ControlledStop,
}

/// The reaction to each fault: a controlled stop needs feedback that can be trusted and a clock that still ticks.
#[must_use]
pub const fn reaction(fault: Fault) -> Reaction {
    match fault {
        Fault::SetpointMissing => Reaction::ControlledStop,
        Fault::FeedbackMissing
        | Fault::TorqueMissing
        | Fault::FollowingError
        | Fault::EncoderJump
        | Fault::StaleCounter
        | Fault::SyncMissing
        | Fault::HeartbeatLost
        | Fault::PeerFault
        | Fault::MalformedFrame
        | Fault::SetpointImplausible
        | Fault::StageRefused
        | Fault::StageLost
        | Fault::ReferenceTooFar
        | Fault::CycleTimeMismatch
        | Fault::EncoderRelation
        | Fault::LimitOverrun
        | Fault::BrakeFailed => Reaction::TorqueZero,
    }
}

impl Drive {
    /// The state as the status word tells it.
    #[must_use]
    pub const fn state(&self) -> DriveState {
        match self {
            Self::SwitchOnDisabled => DriveState::SwitchOnDisabled,
            Self::ReadyToSwitchOn => DriveState::ReadyToSwitchOn,
            Self::SwitchedOn => DriveState::SwitchedOn,
            Self::OperationEnabled => DriveState::OperationEnabled,
            Self::QuickStop(_) => DriveState::QuickStopActive,
            Self::FaultReaction(..) => DriveState::FaultReactionActive,
            Self::Faulted(_) => DriveState::Fault,
        }
    }

    /// The latched fault.
    #[must_use]
    pub const fn fault(&self) -> Option<Fault> {
        match self {
            Self::FaultReaction(fault, _) | Self::Faulted(fault) => Some(*fault),
            Self::SwitchOnDisabled
            | Self::ReadyToSwitchOn
            | Self::SwitchedOn
            | Self::OperationEnabled
            | Self::QuickStop(_) => None,
        }
    }

    /// Whether torque may be commanded.
    #[must_use]
    pub const fn is_energised(&self) -> bool {
        matches!(self, Self::OperationEnabled | Self::QuickStop(_) | Self::FaultReaction(..))
    }

    /// What the servo tells the plant's torque drive.
    #[must_use]
    pub const fn plant_control(&self) -> ControlWord {
        match self {
            Self::OperationEnabled | Self::QuickStop(_) | Self::FaultReaction(..) => ControlWord::ENABLE_OPERATION,
            Self::SwitchedOn => ControlWord::SWITCH_ON,
            Self::ReadyToSwitchOn => ControlWord::SHUTDOWN,
            Self::SwitchOnDisabled | Self::Faulted(_) => ControlWord::DISABLE_VOLTAGE,
        }
    }

    /// Follows a control word; `reset_edge` is true where its fault-reset bit has just risen.
    #[must_use]
    pub fn commanded(self, command: Option<Command>, reset_edge: bool, stop: Stop) -> Self {
        match (self, command) {
            (Self::Faulted(_), Some(Command::FaultReset)) if reset_edge => Self::SwitchOnDisabled,
            (Self::Faulted(_) | Self::FaultReaction(..), _) => self,
            (_, Some(Command::DisableVoltage)) => Self::SwitchOnDisabled,
            (Self::OperationEnabled, Some(Command::QuickStop)) => Self::QuickStop(stop),
            (Self::QuickStop(_), _) => self,
            (Self::SwitchOnDisabled, Some(Command::Shutdown)) => Self::ReadyToSwitchOn,
            (Self::SwitchedOn | Self::OperationEnabled, Some(Command::Shutdown)) => Self::ReadyToSwitchOn,
            (Self::ReadyToSwitchOn, Some(Command::SwitchOn)) => Self::SwitchedOn,
            (Self::OperationEnabled, Some(Command::SwitchOn)) => Self::SwitchedOn,
            (Self::SwitchedOn, Some(Command::EnableOperation)) => Self::OperationEnabled,
            (Self::ReadyToSwitchOn | Self::SwitchedOn, Some(Command::QuickStop)) => Self::SwitchOnDisabled,
            (Self::SwitchOnDisabled | Self::ReadyToSwitchOn | Self::SwitchedOn | Self::OperationEnabled, _) => self,
        }
    }

    /// Latches a fault; the first one stays.
    #[must_use]
    pub fn faulted(self, fault: Fault, stop: Stop) -> Self {
        match (self, reaction(fault)) {
            (Self::Faulted(first), _) => Self::Faulted(first),
            (Self::FaultReaction(first, _), Reaction::TorqueZero) => Self::Faulted(first),
            (Self::FaultReaction(..), Reaction::ControlledStop) => self,
            (Self::OperationEnabled, Reaction::ControlledStop) => Self::FaultReaction(fault, stop),
            // The ramp that runs goes on.
            (Self::QuickStop(running), Reaction::ControlledStop) => Self::FaultReaction(fault, running),
            (
                Self::SwitchOnDisabled
                | Self::ReadyToSwitchOn
                | Self::SwitchedOn
                | Self::OperationEnabled
                | Self::QuickStop(_),
                _,
            ) => Self::Faulted(fault),
        }
    }

    /// The controlled stop has ended.
    #[must_use]
    pub const fn stopped(self) -> Self {
        match self {
            Self::QuickStop(_) => Self::SwitchOnDisabled,
            Self::FaultReaction(fault, _) => Self::Faulted(fault),
            other => other,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stop() -> Stop {
        Stop::within(1)
    }

    #[test]
    fn the_way_up_and_down_is_that_of_cia_402() {
        let mut drive = Drive::default();
        for command in [Command::Shutdown, Command::SwitchOn, Command::EnableOperation] {
            drive = drive.commanded(Some(command), false, stop());
        }
        assert_eq!(drive, Drive::OperationEnabled);
        assert_eq!(drive.commanded(Some(Command::DisableVoltage), false, stop()), Drive::SwitchOnDisabled);
        assert_eq!(drive.commanded(Some(Command::QuickStop), false, stop()).stopped(), Drive::SwitchOnDisabled);
        assert_eq!(Drive::default().commanded(Some(Command::EnableOperation), false, stop()), Drive::default());
    }

    #[test]
    fn a_fault_is_left_only_by_the_edge_of_a_fault_reset() {
        for fault in Fault::ALL.iter().copied() {
            let faulted = Drive::OperationEnabled.faulted(fault, stop()).stopped();
            assert_eq!(faulted, Drive::Faulted(fault));
            for command in [Command::Shutdown, Command::EnableOperation, Command::DisableVoltage, Command::FaultReset] {
                assert_eq!(faulted.commanded(Some(command), false, stop()), faulted);
            }
            assert_eq!(faulted.commanded(Some(Command::FaultReset), true, stop()), Drive::SwitchOnDisabled);
            assert!(!faulted.is_energised());
        }
    }

    #[test]
    fn the_first_fault_stays() {
        let first = Drive::OperationEnabled.faulted(Fault::SetpointMissing, stop());
        assert_eq!(first.faulted(Fault::FeedbackMissing, stop()), Drive::Faulted(Fault::SetpointMissing));
    }
}
