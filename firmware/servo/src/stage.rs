//! The power stage as a port of the drive: ready, enabled, fault and brake come in; enable, brake
//! and torque go out.
//!
//! Behind it stands the plant on CAN (a torque drive of CiA 402, [`StageInput::from`] its status
//! frame), or an inverter on the board. The drive believes only what the stage says of itself:
//! `operation enabled` without its word does not exist.

use protocol::Fault;
use protocol::message::PlantStatus;
use protocol::states::{BrakeState, ControlWord, DriveState};

/// What the stage says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StageInput {
    state: DriveState,
    fault: Option<Fault>,
    brake: BrakeState,
}

impl Default for StageInput {
    fn default() -> Self {
        Self::new(DriveState::SwitchOnDisabled, None, BrakeState::NotFitted)
    }
}

impl StageInput {
    /// What a stage says.
    #[must_use]
    pub const fn new(state: DriveState, fault: Option<Fault>, brake: BrakeState) -> Self {
        Self {
            state,
            fault,
            brake,
        }
    }

    /// It is supplied and has no fault.
    #[must_use]
    pub const fn is_ready(self) -> bool {
        self.fault.is_none()
            && !matches!(
                self.state,
                DriveState::Fault | DriveState::FaultReactionActive
            )
    }

    /// It delivers torque.
    #[must_use]
    pub const fn is_enabled(self) -> bool {
        self.fault.is_none() && matches!(self.state, DriveState::OperationEnabled)
    }

    /// Where the brake stands.
    #[must_use]
    pub const fn brake(self) -> BrakeState {
        self.brake
    }

    /// The stage's own fault.
    #[must_use]
    pub const fn fault(self) -> Option<Fault> {
        self.fault
    }
}

impl From<PlantStatus> for StageInput {
    fn from(status: PlantStatus) -> Self {
        Self::new(
            status.status.state().unwrap_or(DriveState::Fault),
            status.fault,
            status.brake,
        )
    }
}

/// What the stage is told, once per cycle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct StageOutput {
    /// Enable and brake.
    pub control: ControlWord,
    /// Torque, µN·m.
    pub micro_nm: i32,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stage_with_a_fault_is_neither_ready_nor_enabled_whatever_its_state_says() {
        let faulty = StageInput::new(
            DriveState::OperationEnabled,
            Some(Fault::TorqueMissing),
            BrakeState::Open,
        );
        assert!(!faulty.is_ready() && !faulty.is_enabled());
        assert!(StageInput::default().is_ready() && !StageInput::default().is_enabled());
    }
}
