//! The machine stops as one: trouble of one axis, or the wish of the operator, brings all axes to
//! rest.
//!
//! Trouble is a fault or an EMCY, a drive that left `operation enabled`, or a servo that sent no
//! torque for `SILENT_CYCLES`. All drives get `quick stop` with the next setpoints, so within a
//! cycle of noticing: an EMCY is noticed at once, silence after three cycles, a mere change of
//! state with the status, at most ten cycles later. Setpoints stay where they are; the cycle goes
//! on until every motor stands and no drive is ramping any more, then the drives are disabled.

use protocol::states::ControlWord;
use protocol::table::STATUS_EVERY_CYCLES;

use super::Master;
use super::axis_link::AxisLink;
use super::way::{Hold, is_without_torque};
use crate::error::{Failure, Outcome};
use crate::network::link::Link;

/// Patience with a stop: an axis that coasts from 0.4 m/s stands after half a second, one that
/// ramps at 5 m/s² after a tenth.
const REST_S: f64 = 2.0;
/// Standstill has to last for a status period: a reversal stands for a moment too.
const STANDING_CYCLES: u32 = STATUS_EVERY_CYCLES as u32;

impl<L: Link> Master<L> {
    /// Fails with what a drive reports, if it does not follow setpoints.
    ///
    /// # Errors
    /// Axis, state and fault.
    pub fn expect_enabled(&self) -> Outcome<()> {
        self.axes
            .iter()
            .find_map(AxisLink::trouble)
            .map_or(Ok(()), Err)
    }

    /// Whether some servo has been silent for so long that going on makes no sense.
    #[must_use]
    pub fn has_lost_a_servo(&self) -> bool {
        self.axes.iter().any(AxisLink::is_silent)
    }

    /// Whether the machine must not go on: an axis has trouble, or the operator wants it to stop.
    #[must_use]
    pub fn must_stop(&self) -> bool {
        self.is_interrupted() || self.axes.iter().any(|axis| axis.trouble().is_some())
    }

    /// Brings all axes to rest and disables them; gives the reason, with the axis that began it.
    #[must_use]
    pub fn stop(&mut self) -> Failure {
        let reason = self.reason();
        match self
            .quick_stop()
            .and_then(|moving| self.disable().map(|()| moving))
        {
            Ok(None) => reason,
            Ok(Some(moving)) => Failure::new(format!(
                "{reason}; axis {moving} was not seen to come to rest in {REST_S} s"
            )),
            Err(failure) => Failure::new(format!("{reason}; and while stopping: {failure}")),
        }
    }

    pub(super) fn is_interrupted(&self) -> bool {
        self.interrupt.is_raised()
    }

    fn reason(&self) -> Failure {
        match self.axes.iter().find_map(AxisLink::trouble) {
            Some(trouble) if self.axes.len() > 1 => {
                Failure::new(format!("{trouble}; the other axes were stopped"))
            }
            Some(trouble) => trouble,
            None => self.interrupt.failure("all axes were stopped and disabled"),
        }
    }

    /// All drives ramp down; gives the first axis that was not seen to come to rest.
    fn quick_stop(&mut self) -> Outcome<Option<String>> {
        let patience = self.cycles_in(REST_S);
        let rested = self.confirm(ControlWord::QUICK_STOP, Hold::Last, patience, |master| {
            master.axes.iter().all(has_come_to_rest)
        })?;
        let moving = self
            .axes
            .iter()
            .find(|axis| !rested && !has_come_to_rest(axis));
        Ok(moving.map(|axis| axis.name.clone()))
    }
}

/// A silent servo tells no state, but its plant may still tell where the motor is; a motor of which
/// nothing is heard cannot be waited for.
fn has_come_to_rest(axis: &AxisLink) -> bool {
    axis.has_stood_for(STANDING_CYCLES)
        && (axis.is_silent() || axis.state.is_some_and(is_without_torque))
}
