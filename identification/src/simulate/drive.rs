//! Who computes the effort of a simulated axis.
//!
//! The controller of the record, where it is known. Where it is not, the recorded effort is
//! applied, and a soft controller of our own keeps the simulation near the record:
//! `u = u_rec + m ω² (q_rec − q) + 2 ζ m ω (v_rec − v)`, with ω = 60 rad/s and ζ = 0.7. That is
//! good enough to compare structures, but no free run, and not reported as one. An effort that was
//! logged late is read ahead by that time.

use crate::record::samples::Record;
use crate::simulate::axis::Axis;
use crate::simulate::controller::known::Controller;
use crate::simulate::controller::law::{Law, Memory};
use crate::simulate::controller::timing::Setpoints;

/// Bandwidth ω of the soft controller, rad/s: below any drive's own, so that it does not hide what
/// the simulation lacks.
const SOFT_BANDWIDTH: f64 = 60.0;
/// 2 ζ of the soft controller.
const SOFT_DAMPING: f64 = 1.4;

/// Who computes the effort.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Drive {
    /// The controller of the record.
    Known(Law),
    /// The recorded effort and a soft controller.
    Followed,
}

/// A drive along a record.
pub(crate) struct Driving<'a> {
    drive: &'a Drive,
    record: &'a Record,
    mass: f64,
    /// Rows by which the recorded effort was logged late.
    late_rows: f64,
    memory: Memory,
}

impl Drive {
    /// The drive of an axis, by what is known of its controller.
    #[must_use]
    pub(crate) fn of(controller: Controller) -> Self {
        controller.law().map_or(Self::Followed, Self::Known)
    }

    /// The drive at the start of a record, for an axis of a mass; the recorded effort was logged
    /// late by a time.
    #[must_use]
    pub(crate) fn along<'a>(
        &'a self,
        record: &'a Record,
        mass: f64,
        logged_late_s: f64,
    ) -> Driving<'a> {
        let memory = match self {
            Self::Known(law) => law.start(record),
            Self::Followed => Memory::default(),
        };
        Driving {
            drive: self,
            record,
            mass,
            late_rows: logged_late_s / record.period_s,
            memory,
        }
    }
}

impl Driving<'_> {
    /// The effort of a row.
    #[inline]
    pub(crate) fn effort(&mut self, row: usize, axis: &Axis) -> f64 {
        match self.drive {
            Drive::Known(law) => {
                let setpoints = Setpoints::of(self.record);
                let seen = law.sees(row, axis.motor.x, axis.load.x);
                law.effort(&setpoints, &mut self.memory, seen)
            }
            Drive::Followed => self.followed(row, axis),
        }
    }

    fn followed(&self, row: usize, axis: &Axis) -> f64 {
        let stiffness = self.mass * SOFT_BANDWIDTH.powi(2);
        let damping = SOFT_DAMPING * self.mass * SOFT_BANDWIDTH;
        self.recorded(row)
            + stiffness * (self.record.position[row] - axis.motor.x)
            + damping * (velocity(self.record, row) - axis.motor.v)
    }

    /// The recorded effort that acted at a row, between two rows by their distance.
    fn recorded(&self, row: usize) -> f64 {
        let efforts = &self.record.effort;
        let from = row + self.late_rows.floor() as usize;
        let at = |row: usize| efforts.get(row).or(efforts.last()).copied().unwrap_or(0.0);
        let share = self.late_rows.fract();
        (1.0 - share) * at(from) + share * at(from + 1)
    }
}

/// Recorded velocity of the motor: the central difference, at the start a forward one.
#[must_use]
pub(crate) fn velocity(record: &Record, row: usize) -> f64 {
    let (x, period_s) = (&record.position, record.period_s);
    match (x.get(row + 1), row.checked_sub(1)) {
        (Some(next), Some(past)) => (next - x[past]) / (2.0 * period_s),
        (Some(next), None) => (next - x[row]) / period_s,
        (None, _) => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulate::controller::law::Form;
    use crate::simulate::friction::Body;
    use crate::simulate::made;

    /// Rows of 0.5 s.
    fn record() -> Record {
        Record {
            effort: vec![5.0; 4],
            reference: Some(vec![1.0; 4]),
            ..made::record(0.5, vec![0.0, 1.0, 4.0, 4.0])
        }
    }

    #[test]
    fn an_effort_that_was_logged_late_is_read_ahead_between_two_rows() {
        let record = Record {
            effort: vec![1.0, 3.0, 7.0, 8.0],
            ..record()
        };
        let effort = |row, logged_late_s| {
            let driving = Drive::Followed.along(&record, 2.0, logged_late_s);
            driving.recorded(row)
        };
        assert_eq!((effort(0, 0.0), effort(1, 0.0)), (1.0, 3.0));
        assert_eq!((effort(0, 0.5), effort(0, 0.75)), (3.0, 5.0));
        assert_eq!(effort(3, 0.75), 8.0);
    }

    #[test]
    fn the_recorded_velocity_is_a_difference_over_the_rows_that_are_there() {
        let velocities = [0, 1, 2, 3].map(|row| velocity(&record(), row));
        assert_eq!(velocities, [2.0, 4.0, 3.0, 0.0]);
    }

    #[test]
    fn the_soft_controller_adds_a_spring_and_a_damper_to_the_recorded_effort() {
        let record = record();
        let mut driving = Drive::Followed.along(&record, 2.0, 0.0);
        // On the record: 1 at 4 units a second.
        assert_eq!(driving.effort(1, &Axis::at(1.0, 4.0)), 5.0);
        // 2·60² = 7200 a unit behind, 1.4·2·60 = 168 a unit a second too slow.
        let near = |value: f64, wanted: f64| assert!((value - wanted).abs() < 1.0e-9, "{value}");
        near(driving.effort(1, &Axis::at(0.5, 4.0)), 3605.0);
        near(driving.effort(1, &Axis::at(1.0, 3.5)), 89.0);
    }

    #[test]
    fn a_known_law_sees_the_side_that_it_closes_on_and_remembers() {
        let record = record();
        let mut axis = Axis::at(0.5, 0.0);
        axis.load = Body { x: 0.75, v: 0.0 };
        for (on_load, x) in [(false, 0.5), (true, 0.75)] {
            let law = Law {
                form: Form::Voltage { gain: 10.0 },
                position_gain: 4.0,
                limit: None,
                on_load,
                velocity_of_load: on_load,
                misfit: 0.0,
            };
            let drive = Drive::Known(law);
            let mut driving = drive.along(&record, 2.0, 0.0);
            // 10 (4 (1 − q) − (q − q two rows ago)/1 s); the record came from −2, then −1.
            assert_eq!(
                driving.effort(0, &axis),
                10.0 * (4.0 * (1.0 - x) - (x + 2.0))
            );
            assert_eq!(
                driving.effort(1, &axis),
                10.0 * (4.0 * (1.0 - x) - (x + 1.0))
            );
        }
    }
}
