//! Tuning of the pulse, as at a real machine: circles, and nothing else.
//!
//! ```text
//! circle without compensation ─▶ start_values ─▶ valley (X) ─▶ valley (Y) ─▶ circle with both
//! ```
//!
//! [`coulomb_force`] and [`friction_model`] are other ways to a compensation: one force per axis, or
//! a model, from a record.

pub mod coulomb_force;
pub mod friction_model;
mod start_values;
mod tuning_circles;
mod valley;

use std::cell::RefCell;

use identification::Identification;
use plant_sim::Machine;
use plant_sim::machine::MachineAxis;

use crate::ballbar::Point;
use crate::compensation::{AxisCompensation, Compensation, Pulse};
use crate::error::{Failure, Outcome};
use crate::model_file::Known;
use crate::session::Stand;
use crate::trajectory::Circle;
use start_values::start;
use tuning_circles::TuningCircles;
use valley::Search;

/// What tuning did.
#[derive(Clone, Debug)]
pub struct Tuned {
    /// One compensation per axis.
    pub compensation: Vec<AxisCompensation>,
    /// Burst before, per axis, µm.
    pub before_um: [f64; 2],
    /// Burst with the tuned pulse on the tuning circles, per axis, µm.
    pub after_um: [f64; 2],
    /// Circles that were run.
    pub circles: u32,
}

/// The search ends when its corners differ by less than this, µm: below it is noise.
const TOLERANCE_UM: f64 = 0.05;
/// Noise of tuning runs is another than that of the circles that judge the result.
const TUNING_RUN: u64 = 1000;

/// Tunes the pulse of both axes at one circle.
///
/// # Errors
/// Where a circle cannot be run, the machine shows no burst, or the operator interrupts.
pub fn pulse(stand: &Stand<'_>, circle: &Circle, start_delay_s: f64) -> Outcome<Tuned> {
    let session = stand.connect(TUNING_RUN)?;
    session.perform(&stand.uncompensated(), None, |session| {
        let circles = RefCell::new(TuningCircles::on(session, circle));
        tune_both(&circles, stand, start_delay_s)
    })
}

/// The model of friction of both axes, from what was identified; circles only tell what it is
/// worth.
///
/// # Errors
/// Where a circle cannot be run, or the operator interrupts.
pub fn model(stand: &Stand<'_>, circle: &Circle, results: &[Identification]) -> Outcome<Tuned> {
    let of_axis = |(axis, result): (&MachineAxis, &Identification)| {
        let known = Known::of_machine(axis, stand.machine.period_s);
        let model = friction_model::of_axis(&known, result);
        AxisCompensation {
            reversal: model.map_or(Compensation::None, |model| {
                Compensation::Model(Box::new(model))
            }),
            backlash_m: 0.0,
        }
    };
    let axes = stand.machine.axes.iter().zip(results);
    let compensation: Vec<AxisCompensation> = axes.map(of_axis).collect();
    let session = stand.connect(TUNING_RUN)?;
    session.perform(&stand.uncompensated(), None, |session| {
        let mut circles = TuningCircles::on(session, circle);
        let before_um = circles.run(&stand.uncompensated())?.bursts_um;
        let after_um = circles.run(&compensation)?.bursts_um;
        Ok(Tuned {
            compensation: compensation.clone(),
            before_um,
            after_um,
            circles: circles.count,
        })
    })
}

fn tune_both(
    circles: &RefCell<TuningCircles<'_, '_>>,
    stand: &Stand<'_>,
    start_delay_s: f64,
) -> Outcome<Tuned> {
    let mut compensation = stand.uncompensated();
    let before = circles.borrow_mut().run(&compensation)?;
    for axis in 0..2 {
        let start = burst_to_compensate(&before.points, axis, before.radius_m, stand.machine)?;
        let search = Search {
            circles,
            axis,
            others: compensation.clone(),
            start_delay_s,
            failure: RefCell::new(None),
        };
        compensation[axis].reversal = Compensation::Pulse(search.run(start)?);
    }
    let after = circles.borrow_mut().run(&compensation)?;
    let circles = circles.borrow().count;
    Ok(Tuned {
        compensation,
        before_um: before.bursts_um,
        after_um: after.bursts_um,
        circles,
    })
}

/// The pulse to begin with, from the uncompensated circle.
fn burst_to_compensate(
    points: &[Point],
    axis: usize,
    radius_m: f64,
    machine: &Machine,
) -> Outcome<Pulse> {
    start(points, axis, radius_m, machine).ok_or_else(|| {
        Failure::new(format!(
            "axis {}: no burst to compensate on this circle",
            machine.axes[axis].name
        ))
    })
}
