//! Free-run simulation of the whole axis in closed loop, and the output-error fit.
//!
//! The simulation gets the setpoints of a record and nothing else; its controller is that of
//! `dataset.toml` where it is known ([`controller`]). Where it is not, the recorded effort is
//! applied and a soft controller of our own keeps the simulation near the record: good enough to
//! compare structures, but no free run, and not reported as one.
//!
//! Its states (stick, bristle, gap) are what the inverse model cannot have. Parameters start from
//! the inverse model and are fitted by Levenberg–Marquardt to the recorded position (`fit.rs`).

use super::axis::Axis;
use super::controller::{self, Law};
use super::model::Simulated;

use crate::record::dataset::Dataset;
use crate::record::samples::Record;

/// Longest sub-step, s.
const SUB_STEP_S: f64 = 2.5e-4;
/// Rows at the start of a piece that are not judged: the state there is an estimate.
pub(crate) const SETTLING_ROWS: usize = 300;
/// Bandwidth of the soft controller where the real one is not known, rad/s.
const SOFT_BANDWIDTH: f64 = 60.0;

/// Who computes the effort.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Drive {
    /// The controller of the record.
    Known(Law),
    /// The recorded effort and a soft controller.
    Followed,
}

impl Drive {
    /// The drive of a dataset.
    #[must_use]
    pub(crate) fn of(dataset: &Dataset) -> Self {
        Law::of(dataset).map_or(Self::Followed, Self::Known)
    }
}

/// Motor (and load) position of a simulation.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Run {
    /// Motor position at the rows.
    pub motor: Vec<f64>,
    /// Load position at the rows.
    pub load: Vec<f64>,
}

/// Simulates a model along a record; at a joint the axis starts anew from where it was recorded.
#[must_use]
pub(crate) fn simulate(model: &Simulated, drive: &Drive, record: &Record) -> Run {
    if record.joints.is_empty() {
        return simulate_piece(model, drive, record);
    }
    let mut run = Run::default();
    for piece in record.pieces() {
        let next = simulate_piece(model, drive, &record.part(piece));
        run.motor.extend(next.motor);
        run.load.extend(next.load);
    }
    run
}

fn simulate_piece(model: &Simulated, drive: &Drive, record: &Record) -> Run {
    let rows = record.len();
    let period_s = record.period_s;
    let steps = (period_s / SUB_STEP_S).ceil().max(1.0);
    let h = period_s / steps;
    let slope = |row: usize| match (record.position.get(row + 1), row.checked_sub(1)) {
        (Some(next), Some(past)) => (next - record.position[past]) / (2.0 * period_s),
        (Some(next), None) => (next - record.position[row]) / period_s,
        (None, _) => 0.0,
    };
    let mut axis = Axis::at(record.position.first().copied().unwrap_or(0.0), slope(0));
    let mut memory = match drive {
        Drive::Known(law) => law.start(record),
        Drive::Followed => controller::Memory::default(),
    };
    let mut efforts = vec![
        record.effort.first().copied().unwrap_or(0.0);
        (model.delay_s / period_s).ceil() as usize + 2
    ];
    let mut run = Run {
        motor: Vec::with_capacity(rows),
        load: Vec::with_capacity(rows),
    };
    for row in 0..rows {
        run.motor.push(axis.motor.x);
        run.load.push(axis.load.x);
        let effort = match drive {
            Drive::Known(law) => {
                let measured = if law.on_load {
                    axis.load.x
                } else {
                    axis.motor.x
                };
                law.step(record, &mut memory, row, measured)
            }
            Drive::Followed => {
                let stiffness = model.mechanics.mass * SOFT_BANDWIDTH.powi(2);
                let damping = 1.4 * model.mechanics.mass * SOFT_BANDWIDTH;
                record.effort[row]
                    + stiffness * (record.position[row] - axis.motor.x)
                    + damping * (slope(row) - axis.motor.v)
            }
        };
        efforts.rotate_right(1);
        efforts[0] = effort;
        let time_s = record.time_s[row];
        for step in 0..steps as usize {
            let since = (step as f64 + 0.5) * h;
            let commanded = held(
                &efforts,
                (since - 0.5 * h - model.delay_s) / period_s,
                h / period_s,
            );
            let middle = axis.motor.x + 0.5 * h * axis.motor.v;
            let acting = model.acting(middle, axis.load.v, time_s + since, commanded);
            axis = axis.after(&model.mechanics, acting, h);
        }
    }
    run
}

/// Mean of held efforts (the present one first) from a time on, in rows.
fn held(efforts: &[f64], from: f64, length: f64) -> f64 {
    let late = |at: f64| efforts[((-at.floor()).max(0.0) as usize).min(efforts.len() - 1)];
    let edge = from.floor() + 1.0;
    let before = (edge - from).min(length) / length;
    before * late(from) + (1.0 - before) * late(edge)
}

/// Rms of simulated − recorded motor position over rows of a mask, in the unit of the position;
/// also of the load, where both are there.
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
