//! Free-run simulation of the whole axis in closed loop.
//!
//! The simulation gets the setpoints of a record and nothing else; who computes the effort:
//! [`drive`](crate::simulate::drive). Every row of the record is cut into equal sub-steps of at
//! most 0.25 ms; forces are those of the middle of a sub-step. The states of the axis (stick,
//! bristle, gap) are what the inverse model cannot have. At a joint of a record the axis starts
//! anew from where it was recorded.

use crate::record::samples::Record;
use crate::simulate::axis::Axis;
use crate::simulate::drive::{Drive, velocity};
use crate::simulate::hold::{Felt, HeldEfforts};
use crate::simulate::model::{Forces, Moment, Simulated};

/// Longest sub-step, s: a velocity loop of 1000 rad/s still has four sub-steps a radian.
const SUB_STEP_S: f64 = 2.5e-4;
/// Rows at the start of a piece that are not judged: the state there is an estimate.
pub(crate) const SETTLING_ROWS: usize = 300;

/// A simulation along a record.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Run {
    /// Motor position at the rows.
    pub motor: Vec<f64>,
}

/// The sub-steps of a row.
#[derive(Clone, Debug, PartialEq)]
struct SubSteps {
    length_s: f64,
    /// The middle of each after its row, s, and the efforts that it feels.
    list: Vec<(f64, Felt)>,
}

impl SubSteps {
    fn of(period_s: f64, efforts: &HeldEfforts) -> Self {
        let count = (period_s / SUB_STEP_S).ceil().max(1.0);
        let length_s = period_s / count;
        let step = |step: usize| {
            let middle_s = (step as f64 + 0.5) * length_s;
            (middle_s, efforts.felt(middle_s, length_s))
        };
        Self {
            length_s,
            list: (0..count as usize).map(step).collect(),
        }
    }
}

/// Simulates a model along a record.
#[must_use]
pub(crate) fn simulate(model: &Simulated, drive: &Drive, record: &Record) -> Run {
    if record.joints.is_empty() {
        return simulate_piece(model, drive, record);
    }
    let pieces = record.pieces().into_iter();
    let runs = pieces.map(|piece| simulate_piece(model, drive, &record.part(piece)));
    Run {
        motor: runs.flat_map(|run| run.motor).collect(),
    }
}

fn simulate_piece(model: &Simulated, drive: &Drive, record: &Record) -> Run {
    let first = |values: &[f64]| values.first().copied().unwrap_or(0.0);
    let mut axis = Axis::at(first(&record.position), velocity(record, 0));
    let mut driving = drive.along(record, model.mechanics.mass, model.logged_late_s);
    let mut efforts = HeldEfforts::new(first(&record.effort), record.period_s, model.delay_s);
    let steps = SubSteps::of(record.period_s, &efforts);
    let forces = model.at_work();
    let mut left = forces.left_at(axis.load.v);
    let row = |row: usize| {
        let at = axis.motor.x;
        efforts.push(driving.effort(row, &axis));
        let time = (record.time_s[row], &steps);
        (axis, left) = over_row((axis, left), &forces, &efforts, time);
        at
    };
    Run {
        motor: (0..record.len()).map(row).collect(),
    }
}

/// The axis a row later, and what is left then of a fall that lags.
fn over_row(
    (mut axis, mut left): (Axis, Option<f64>),
    forces: &Forces<'_>,
    efforts: &HeldEfforts,
    (time_s, steps): (f64, &SubSteps),
) -> (Axis, Option<f64>) {
    let h = steps.length_s;
    for (since_s, felt) in &steps.list {
        let now = Moment {
            time_s: time_s + since_s,
            commanded: efforts.mean(*felt),
            left,
            ..halfway(&axis, h)
        };
        axis = axis.after(forces.mechanics(), forces.acting(now), h);
        left = forces.left_after(left, now.velocity, h);
    }
    (axis, left)
}

/// Where ripple and friction are seen over a sub-step: in its middle, with the load's velocity.
fn halfway(axis: &Axis, step_s: f64) -> Moment {
    Moment {
        position: axis.motor.x + 0.5 * step_s * axis.motor.v,
        velocity: axis.load.v,
        ..Moment::default()
    }
}

/// Rms of simulated − recorded motor position over rows of a mask, in the unit of the position.
/// Rows at the start of a piece and those in holes of the file do not count.
#[must_use]
pub(crate) fn position_rms(run: &Run, record: &Record, mask: &dyn Fn(usize) -> bool) -> f64 {
    let settled = record.settled(SETTLING_ROWS);
    let rows = settled.filter(|row| mask(*row) && !record.interpolated[*row]);
    let (sum, count) = rows.fold((0.0, 0.0), |(sum, count), row| {
        (
            sum + (run.motor[row] - record.position[row]).powi(2),
            count + 1.0,
        )
    });
    (sum / f64::max(count, 1.0)).sqrt()
}

/// The same of the simulation of a model along the record.
#[must_use]
pub(crate) fn error_along(
    model: &Simulated,
    drive: &Drive,
    record: &Record,
    mask: &dyn Fn(usize) -> bool,
) -> f64 {
    position_rms(&simulate(model, drive, record), record, mask)
}

/// Whether a simulation strays from its record by more than a distance, or leaves the numbers.
#[must_use]
pub(crate) fn strays(run: &Run, record: &Record, distance: f64) -> bool {
    let near = |row: usize| (run.motor[row] - record.position[row]).abs() <= distance;
    !record.settled(SETTLING_ROWS).all(near)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_simulation_strays_where_one_settled_row_is_too_far_off_or_no_number() {
        let record = crate::simulate::made::record(1.0e-3, vec![1.0; 1000]);
        let strays_with = |row: usize, at: f64| {
            let mut motor = vec![1.1; 1000];
            motor[row] = at;
            strays(&Run { motor }, &record, 0.5)
        };
        for (at, wanted) in [(1.49, false), (1.51, true), (0.49, true), (f64::NAN, true)] {
            assert_eq!(strays_with(600, at), wanted, "{at}");
            assert!(!strays_with(10, at), "it has not settled");
        }
        assert!(strays_with(999, f64::NEG_INFINITY));
    }
    use crate::simulate::made;

    #[test]
    fn a_row_is_cut_into_equal_sub_steps_of_a_quarter_millisecond_at_most() {
        for (period_s, count) in [(1.0e-4, 1), (2.5e-4, 1), (2.6e-4, 2), (1.0e-3, 4)] {
            let steps = SubSteps::of(period_s, &HeldEfforts::new(0.0, period_s, 0.0));
            assert_eq!(steps.list.len(), count, "{period_s} s");
            assert!((count as f64 * steps.length_s - period_s).abs() < 1.0e-18);
        }
        let steps = SubSteps::of(5.0e-4, &HeldEfforts::new(0.0, 5.0e-4, 0.0));
        let middles: Vec<f64> = steps.list.iter().map(|(middle_s, _)| *middle_s).collect();
        assert_eq!(middles, [1.25e-4, 3.75e-4]);
    }

    #[test]
    fn forces_are_those_of_the_motors_place_in_the_middle_of_a_sub_step_and_the_loads_velocity() {
        let mut axis = Axis::at(1.0, 4.0);
        axis.load.v = 3.0;
        let wanted = Moment {
            position: 2.0,
            velocity: 3.0,
            ..Moment::default()
        };
        assert_eq!(halfway(&axis, 0.5), wanted);
    }

    #[test]
    fn an_effort_moves_a_mass_by_half_its_acceleration_times_the_time_squared() {
        let parts: &[(_, _, &[f64])] = &[(axis_model::EffectName::Inertia, 0.0, &[2.0])];
        let dataset = made::dataset(made::record(1.0e-3, vec![0.0; 10]), None);
        let shape = crate::simulate::axis::Shape::default();
        let model = Simulated::new(&dataset, 1.0e-3, &made::fitted(parts), shape).unwrap();
        let efforts = HeldEfforts::new(8.0, 1.0e-3, 0.0);
        let steps = SubSteps::of(1.0e-3, &efforts);
        let (axis, _) = over_row(
            (Axis::at(0.0, 1.0), None),
            &model.at_work(),
            &efforts,
            (0.0, &steps),
        );
        // 8 N on 2 kg over 1 ms, from 1 m/s.
        assert!((axis.motor.v - 1.004).abs() < 1.0e-12, "{axis:?}");
        assert!((axis.motor.x - 1.002e-3).abs() < 1.0e-15, "{axis:?}");
    }

    #[test]
    fn the_rms_is_over_rows_of_the_mask_that_are_settled_and_recorded() {
        let mut record = made::record(1.0e-3, vec![1.0; 310]);
        let mut run = Run {
            motor: vec![1.0; 310],
        };
        let rms = |run: &Run, record: &Record| position_rms(run, record, &|row| row != 305);
        // Not settled; masked; in a hole.
        record.interpolated[307] = true;
        for row in [299, 305, 307] {
            run.motor[row] = 100.0;
        }
        assert_eq!(rms(&run, &record), 0.0);
        // Eight rows count: √((3² + 4²)/8).
        (run.motor[300], run.motor[309]) = (4.0, -3.0);
        assert!((rms(&run, &record) - 3.125_f64.sqrt()).abs() < 1.0e-15);
        assert_eq!(position_rms(&run, &record, &|_| false), 0.0);
    }

    #[test]
    fn each_piece_settles_anew() {
        let mut record = made::record(1.0e-3, vec![0.0; 620]);
        let run = Run {
            motor: (0..620)
                .map(|row| if row < 610 { 1.0 } else { 2.0 })
                .collect(),
        };
        record.joints = vec![310];
        assert!((position_rms(&run, &record, &|_| true) - 2.5_f64.sqrt()).abs() < 1.0e-15);
    }
}
