//! The power stage: a CiA 402 torque drive that the servo switches.
//!
//! ```text
//! SwitchOnDisabled ─shutdown─▶ ReadyToSwitchOn ─switch on─▶ SwitchedOn ─enable─▶ OperationEnabled
//!        ▲                          └──────── enable operation: both steps ──────────────▲
//!        └── disable voltage, quick stop: from every state but Fault      torque acts only here
//! Fault ─fault reset (rising edge)─▶ SwitchOnDisabled        Fault ─shutdown─▶ ReadyToSwitchOn
//! ```
//!
//! Transitions after CiA 402-2 §4.2 (numbers 2 to 10, 12, 15, 16). Ours, stated: a torque drive has
//! no ramp, so a quick stop is the end of torque; and a `shutdown` leaves `Fault` too, because a
//! servo that left its own fault state starts over with it.

use protocol::Fault;
use protocol::states::{Command, ControlWord, DriveState, StatusWord};

/// States of the torque drive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TorqueDrive {
    /// No torque; waits for `shutdown`.
    SwitchOnDisabled,
    /// No torque; waits for `switch on`.
    ReadyToSwitchOn,
    /// Supplied, no torque.
    SwitchedOn,
    /// Torque acts.
    OperationEnabled,
    /// No torque until the fault is reset.
    Fault(Fault),
}

/// The power stage with its supply.
#[derive(Clone, Copy, Debug)]
pub struct PowerStage {
    drive: TorqueDrive,
    control: ControlWord,
    supplied: bool,
    refuses: bool,
}

impl Default for PowerStage {
    fn default() -> Self {
        Self {
            drive: TorqueDrive::SwitchOnDisabled,
            control: ControlWord::DISABLE_VOLTAGE,
            supplied: true,
            refuses: false,
        }
    }
}

impl PowerStage {
    /// Its state.
    #[must_use]
    pub const fn drive(&self) -> TorqueDrive {
        self.drive
    }

    /// Whether torque acts.
    #[must_use]
    pub const fn is_enabled(&self) -> bool {
        self.supplied && matches!(self.drive, TorqueDrive::OperationEnabled)
    }

    /// Whether it lost its supply while it was enabled, and has not said so yet.
    #[must_use]
    pub const fn dropped_out(&self) -> bool {
        !self.supplied && matches!(self.drive, TorqueDrive::OperationEnabled)
    }

    /// The latched fault.
    #[must_use]
    pub const fn fault(&self) -> Option<Fault> {
        match self.drive {
            TorqueDrive::Fault(fault) => Some(fault),
            TorqueDrive::SwitchOnDisabled
            | TorqueDrive::ReadyToSwitchOn
            | TorqueDrive::SwitchedOn
            | TorqueDrive::OperationEnabled => None,
        }
    }

    /// Whether the control word of the last frame let the brake go.
    #[must_use]
    pub const fn releases_brake(&self) -> bool {
        self.is_enabled() && self.control.has(ControlWord::RELEASE_BRAKE)
    }

    /// Status word; `operational` is the node's NMT state.
    #[must_use]
    pub fn status_word(&self, operational: bool) -> StatusWord {
        let state = match self.drive {
            TorqueDrive::SwitchOnDisabled => DriveState::SwitchOnDisabled,
            TorqueDrive::ReadyToSwitchOn => DriveState::ReadyToSwitchOn,
            TorqueDrive::SwitchedOn => DriveState::SwitchedOn,
            TorqueDrive::OperationEnabled => DriveState::OperationEnabled,
            TorqueDrive::Fault(_) => DriveState::Fault,
        };
        let voltage = if self.supplied {
            StatusWord::VOLTAGE_ENABLED
        } else {
            0
        };
        let remote = if operational { StatusWord::REMOTE } else { 0 };
        StatusWord::of(state).with(voltage | remote)
    }

    /// Takes the control word of a fresh torque frame.
    pub fn obey(&mut self, control: ControlWord) {
        let reset_edge = control.0 & !self.control.0 & ControlWord::FAULT_RESET.0 != 0;
        self.control = control;
        if let Some(command) = control.command() {
            self.drive = self.permitted(next(self.drive, command, reset_edge));
        }
    }

    /// What supply and hooks let through.
    const fn permitted(self, wanted: TorqueDrive) -> TorqueDrive {
        match wanted {
            TorqueDrive::SwitchedOn | TorqueDrive::OperationEnabled if !self.supplied => {
                TorqueDrive::ReadyToSwitchOn
            }
            TorqueDrive::OperationEnabled if self.refuses => TorqueDrive::SwitchedOn,
            TorqueDrive::SwitchOnDisabled
            | TorqueDrive::ReadyToSwitchOn
            | TorqueDrive::SwitchedOn
            | TorqueDrive::OperationEnabled
            | TorqueDrive::Fault(_) => wanted,
        }
    }

    /// Latches a fault.
    pub fn fail(&mut self, fault: Fault) {
        self.drive = TorqueDrive::Fault(fault);
    }

    /// Goes back to the beginning, a latched fault excepted: the node left NMT operational.
    pub fn switch_off(&mut self) {
        self.control = ControlWord::DISABLE_VOLTAGE;
        if self.fault().is_none() {
            self.drive = TorqueDrive::SwitchOnDisabled;
        }
    }

    /// As after power-up, the supply and the hooks of tests excepted: the node was reset.
    pub fn reset(&mut self) {
        *self = Self {
            supplied: self.supplied,
            refuses: self.refuses,
            ..Self::default()
        };
    }

    /// For tests: from now on it does (not) go to `OperationEnabled`.
    pub fn refuse_enable(&mut self, refuses: bool) {
        self.refuses = refuses;
    }

    /// For tests: its supply goes or comes.
    pub fn supply(&mut self, supplied: bool) {
        self.supplied = supplied;
    }
}

/// The transitions of the table above.
const fn next(drive: TorqueDrive, command: Command, reset_edge: bool) -> TorqueDrive {
    use TorqueDrive::{OperationEnabled, ReadyToSwitchOn, SwitchOnDisabled, SwitchedOn};
    match (drive, command) {
        (TorqueDrive::Fault(_), Command::FaultReset) if reset_edge => SwitchOnDisabled,
        (TorqueDrive::Fault(_), Command::Shutdown) => ReadyToSwitchOn,
        (TorqueDrive::Fault(_), _) => drive,
        (_, Command::DisableVoltage | Command::QuickStop) => SwitchOnDisabled,
        (_, Command::FaultReset) => drive,
        (_, Command::Shutdown) => ReadyToSwitchOn,
        (SwitchOnDisabled, Command::SwitchOn | Command::EnableOperation) => SwitchOnDisabled,
        (ReadyToSwitchOn | SwitchedOn | OperationEnabled, Command::SwitchOn) => SwitchedOn,
        (ReadyToSwitchOn | SwitchedOn | OperationEnabled, Command::EnableOperation) => {
            OperationEnabled
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    use ControlWord as C;

    fn after(controls: &[ControlWord]) -> TorqueDrive {
        let mut stage = PowerStage::default();
        for control in controls {
            stage.obey(*control);
        }
        stage.drive()
    }

    #[test]
    fn only_shutdown_leaves_switch_on_disabled_and_enable_operation_takes_both_steps() {
        assert_eq!(after(&[C::ENABLE_OPERATION]), TorqueDrive::SwitchOnDisabled);
        assert_eq!(after(&[C::SWITCH_ON]), TorqueDrive::SwitchOnDisabled);
        assert_eq!(after(&[C::SHUTDOWN, C::SWITCH_ON]), TorqueDrive::SwitchedOn);
        assert_eq!(
            after(&[C::SHUTDOWN, C::ENABLE_OPERATION]),
            TorqueDrive::OperationEnabled
        );
        assert_eq!(
            after(&[C::SHUTDOWN, C::ENABLE_OPERATION, C::SWITCH_ON]),
            TorqueDrive::SwitchedOn
        );
        assert_eq!(
            after(&[C::SHUTDOWN, C::ENABLE_OPERATION, C::SHUTDOWN]),
            TorqueDrive::ReadyToSwitchOn
        );
        assert_eq!(
            after(&[C::SHUTDOWN, C::ENABLE_OPERATION, C::QUICK_STOP]),
            TorqueDrive::SwitchOnDisabled
        );
        assert_eq!(
            after(&[C::SHUTDOWN, C::ENABLE_OPERATION, C::DISABLE_VOLTAGE]),
            TorqueDrive::SwitchOnDisabled
        );
    }

    #[test]
    fn a_fault_is_left_by_a_rising_reset_or_a_shutdown_and_by_nothing_else() {
        let failed = |controls: &[ControlWord]| {
            let mut stage = PowerStage::default();
            stage.obey(C::FAULT_RESET);
            stage.fail(Fault::TorqueMissing);
            for control in controls {
                stage.obey(*control);
            }
            stage.drive()
        };
        let fault = TorqueDrive::Fault(Fault::TorqueMissing);
        for held in [
            &[C::FAULT_RESET][..],
            &[C::ENABLE_OPERATION],
            &[C::SWITCH_ON],
            &[C::DISABLE_VOLTAGE],
        ] {
            assert_eq!(failed(held), fault, "{held:?}");
        }
        assert_eq!(
            failed(&[C::DISABLE_VOLTAGE, C::FAULT_RESET]),
            TorqueDrive::SwitchOnDisabled
        );
        assert_eq!(failed(&[C::SHUTDOWN]), TorqueDrive::ReadyToSwitchOn);
    }

    #[test]
    fn without_supply_it_gets_ready_and_no_farther() {
        let mut stage = PowerStage::default();
        stage.supply(false);
        stage.obey(C::SHUTDOWN);
        stage.obey(C::ENABLE_OPERATION);
        assert_eq!(stage.drive(), TorqueDrive::ReadyToSwitchOn);
        assert_eq!(stage.status_word(true).0 & StatusWord::VOLTAGE_ENABLED, 0);
    }
}
