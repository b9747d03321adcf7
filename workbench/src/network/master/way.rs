//! The way up to `operation enabled` and down again, CiA 402-2 §4.2, each step confirmed by the
//! status of every drive.
//!
//! ```text
//! up:    disable voltage (fault reset) ─▶ shutdown ─▶ switch on ─▶ enable operation
//!          SwitchOnDisabled            ReadyToSwitchOn  SwitchedOn   OperationEnabled
//! down:  switch on (ramp, brake) ─▶ shutdown ─▶ disable voltage
//!          SwitchedOn            ReadyToSwitchOn  SwitchOnDisabled
//! ```
//!
//! A status comes on change of state, and every tenth cycle at the latest. What a drive said before
//! a step began confirms nothing: its state counts as unknown then. Patience is counted in cycles
//! and derived from seconds, because brakes and ramps take time, not cycles.

use protocol::message::NmtCommand;
use protocol::states::{ControlWord, DriveState};
use protocol::table::STATUS_EVERY_CYCLES;

use super::Master;
use super::axis_link::AxisLink;
use crate::error::{Failure, Outcome};
use crate::network::link::Link;

/// A step without motion is confirmed by the next status; a status may be lost, nine in a row are
/// not.
const STEP_CYCLES: u32 = 10 * STATUS_EVERY_CYCLES as u32;
/// Enabling waits for the power stage and for a brake: the slowest of our machine files opens in 30
/// ms, catalogues go up to some 100 ms.
const ENABLE_S: f64 = 1.0;
/// Disabling ramps down (0.5 m/s at 5 m/s² take 0.1 s; the longest ramp that a drive accepts is
/// below a second) and holds until the brake bites.
const DISABLE_S: f64 = 1.5;

/// Which setpoints go out while the drives change their state.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Hold {
    /// Where each axis stands at present, by the encoder that closes its loop.
    Actual,
    /// Those that were sent last.
    Last,
}

/// A step of the way up.
struct Step {
    /// What the drives are told.
    control: ControlWord,
    /// Where they are to be meanwhile.
    hold: Hold,
    /// The state that confirms the step.
    wanted: DriveState,
    /// How long it may take, cycles.
    patience: u32,
}

impl<L: Link> Master<L> {
    /// NMT start, and the drives up to `operation enabled` where they stand. Where one does not
    /// come up, all go down again.
    ///
    /// # Errors
    /// Axis, state and the fault or EMCY with which a drive refused; an interruption.
    pub fn enable(&mut self) -> Outcome<()> {
        self.broadcast(NmtCommand::StartRemoteNode)?;
        self.send_setpoints(self.counter)?;
        let climbed = self.climb();
        if climbed.is_err() {
            // The refusal is the news; whatever goes wrong on the way down follows from it.
            let _ = self.disable();
        }
        climbed
    }

    fn climb(&mut self) -> Outcome<()> {
        self.reset_fault()?;
        self.steps_up()
            .into_iter()
            .try_for_each(|step| self.step_up(&step))
    }

    fn steps_up(&self) -> [Step; 3] {
        [
            Step {
                control: ControlWord::SHUTDOWN,
                hold: Hold::Actual,
                wanted: DriveState::ReadyToSwitchOn,
                patience: STEP_CYCLES,
            },
            Step {
                control: ControlWord::SWITCH_ON,
                hold: Hold::Actual,
                wanted: DriveState::SwitchedOn,
                patience: STEP_CYCLES,
            },
            Step {
                control: ControlWord::ENABLE_OPERATION,
                hold: Hold::Last,
                wanted: DriveState::OperationEnabled,
                patience: self.cycles_in(ENABLE_S),
            },
        ]
    }

    fn step_up(&mut self, step: &Step) -> Outcome<()> {
        let is_up = |axis: &AxisLink| axis.state == Some(step.wanted);
        self.confirm(step.control, step.hold, step.patience, |master| {
            master.axes.iter().all(is_up)
                || master.axes.iter().any(has_refused)
                || master.is_interrupted()
        })?;
        if self.is_interrupted() {
            return Err(self.interrupt.failure("the drives were not enabled"));
        }
        let mut axes = self.axes.iter();
        match axes.find(|axis| has_refused(axis) || !is_up(axis)) {
            Some(axis) => Err(refusal(axis, step.wanted)),
            None => Ok(()),
        }
    }

    /// Disables the drives: disable operation (they ramp down and hold until their brakes bite),
    /// shutdown, disable voltage.
    ///
    /// # Errors
    /// Where an interface is gone, or a drive does not confirm that its torque is off.
    pub fn disable(&mut self) -> Outcome<()> {
        if !self.all(is_down) {
            self.descend(
                ControlWord::SWITCH_ON,
                self.cycles_in(DISABLE_S),
                is_without_torque,
            )?;
            self.descend(ControlWord::SHUTDOWN, STEP_CYCLES, |state| {
                is_without_torque(state) && state != DriveState::SwitchedOn
            })?;
        }
        self.descend(ControlWord::DISABLE_VOLTAGE, STEP_CYCLES, is_down)?;
        let torque_is_off =
            |axis: &AxisLink| axis.is_silent() || axis.state.is_some_and(is_without_torque);
        match self.axes.iter().find(|axis| !torque_is_off(axis)) {
            None => Ok(()),
            Some(axis) => Err(Failure::new(format!(
                "axis {}: the drive did not confirm that its torque is off ({})",
                axis.name,
                axis.account()
            ))),
        }
    }

    /// Resets faults; the drives are disabled afterwards, those that were in operation in a
    /// controlled way.
    ///
    /// # Errors
    /// Where an interface is gone, or a drive does not confirm that its torque is off.
    pub fn reset_fault(&mut self) -> Outcome<()> {
        let is_energised =
            |axis: &AxisLink| axis.state.is_some_and(|state| !is_without_torque(state));
        if self.axes.iter().any(is_energised) {
            self.disable()?;
        }
        self.rest()?;
        if self.axes.iter().any(is_in_fault) {
            self.clear_faults()?;
        }
        self.control = ControlWord::DISABLE_VOLTAGE;
        self.axes
            .iter_mut()
            .filter(|axis| !is_in_fault(axis))
            .for_each(AxisLink::forget_faults);
        Ok(())
    }

    /// Waits until nothing is left to switch off: a drive may have been ramping down by itself.
    fn rest(&mut self) -> Outcome<()> {
        let rests = |axis: &AxisLink| axis.is_silent() || axis.state.is_some_and(is_down);
        let patience = self.cycles_in(DISABLE_S);
        self.confirm(
            ControlWord::DISABLE_VOLTAGE,
            Hold::Actual,
            patience,
            |master| master.axes.iter().all(rests),
        )
        .map(|_| ())
    }

    fn clear_faults(&mut self) -> Outcome<()> {
        let is_clear =
            |axis: &AxisLink| axis.is_silent() || axis.state == Some(DriveState::SwitchOnDisabled);
        self.confirm(
            ControlWord::FAULT_RESET,
            Hold::Actual,
            STEP_CYCLES,
            |master| master.axes.iter().all(is_clear),
        )
        .map(|_| ())
    }

    /// A step of the way down, with the setpoints frozen. Nobody waits for a servo that is silent.
    fn descend(
        &mut self,
        control: ControlWord,
        patience: u32,
        reached: fn(DriveState) -> bool,
    ) -> Outcome<()> {
        self.confirm(control, Hold::Last, patience, |master| master.all(reached))
            .map(|_| ())
    }

    /// Whether all drives that are not silent told a state of this kind.
    pub(super) fn all(&self, is_reached: fn(DriveState) -> bool) -> bool {
        self.axes
            .iter()
            .all(|axis| axis.is_silent() || axis.state.is_some_and(is_reached))
    }

    /// Sends a control word until the drives have confirmed it, or for that many cycles; tells
    /// whether they have.
    pub(super) fn confirm(
        &mut self,
        control: ControlWord,
        hold: Hold,
        patience: u32,
        is_done: impl Fn(&Self) -> bool,
    ) -> Outcome<bool> {
        self.control = control;
        self.axes.iter_mut().for_each(AxisLink::forget_state);
        for _ in 0..patience {
            let setpoints = self.held(hold);
            self.cycle(&setpoints)?;
            if is_done(self) {
                return Ok(true);
            }
        }
        Ok(false)
    }

    pub(super) fn held(&self, hold: Hold) -> Vec<f64> {
        let of = |axis: &AxisLink| match hold {
            Hold::Actual => axis.position_m(),
            Hold::Last => axis.last_setpoint_m(),
        };
        self.axes.iter().map(of).collect()
    }

    pub(super) fn cycles_in(&self, duration_s: f64) -> u32 {
        (duration_s / self.period.as_secs_f64()).ceil() as u32
    }
}

/// A fault that is latched, or the state after power-up: nothing is left to switch off.
pub(super) const fn is_down(state: DriveState) -> bool {
    matches!(state, DriveState::SwitchOnDisabled | DriveState::Fault)
}

fn is_in_fault(axis: &AxisLink) -> bool {
    axis.state == Some(DriveState::Fault)
}

/// The states in which CiA 402 allows no torque.
pub(super) const fn is_without_torque(state: DriveState) -> bool {
    match state {
        DriveState::SwitchOnDisabled
        | DriveState::ReadyToSwitchOn
        | DriveState::SwitchedOn
        | DriveState::Fault => true,
        DriveState::OperationEnabled
        | DriveState::QuickStopActive
        | DriveState::FaultReactionActive => false,
    }
}

/// An EMCY is an answer, and so is silence.
fn has_refused(axis: &AxisLink) -> bool {
    axis.has_reported() || axis.is_silent()
}

fn refusal(axis: &AxisLink, wanted: DriveState) -> Failure {
    if axis.is_silent()
        && let Some(silence) = axis.trouble()
    {
        return silence;
    }
    Failure::new(format!(
        "axis {}: the drive is not enabled; it did not reach {wanted:?} ({})",
        axis.name,
        axis.account()
    ))
}
