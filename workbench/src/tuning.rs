//! Tuning of the pulse, as at a real machine: circles, and nothing else.
//!
//! ```text
//! circle without compensation ─▶ start_values ─▶ valley (X) ─▶ valley (Y) ─▶ circle with both
//! ```
//!
//! [`coulomb_force`] and [`friction_model`] are other ways to a compensation: one force per axis,
//! or a model, from a record; [`self_tuning`] lets the drives refine that. [`adaptive()`] tunes a
//! pulse for each acceleration.

mod adaptive;
pub mod coulomb_force;
mod crossing;
pub mod friction_model;
mod pulse_response;
pub mod self_tuning;
pub mod springs;
mod start_values;
mod tuning_circles;
mod valley;

use std::cell::RefCell;

use identification::Identification;
use plant_sim::machine::MachineAxis;

use crate::compensation::{AxisCompensation, Compensation};
use crate::error::Outcome;
use crate::model_file::Known;
use crate::session::Stand;
use crate::trajectory::Circle;
pub use adaptive::adaptive;
pub use start_values::LEAST_PEAK_UM;
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

/// Tunes the pulse of both axes at one circle. An axis without a burst gets none; without a burst
/// on any of them there is nothing to tune.
///
/// # Errors
/// Where a circle cannot be run, or the operator interrupts.
pub fn pulse(stand: &Stand<'_>, circle: &Circle, start_delay_s: f64) -> Outcome<Option<Tuned>> {
    let session = stand.connect(TUNING_RUN)?;
    session.perform(&stand.uncompensated(), None, |session| {
        let circles = RefCell::new(TuningCircles::on(session, circle));
        tune_both(&circles, stand, start_delay_s)
    })
}

/// The model of friction of both axes, from what was identified; circles only tell what it is
/// worth. Where no axis has friction there is none.
///
/// # Errors
/// Where a circle cannot be run, or the operator interrupts.
pub fn model(
    stand: &Stand<'_>,
    circle: &Circle,
    results: &[Identification],
) -> Outcome<Option<Tuned>> {
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
    if compensation == stand.uncompensated() {
        return Ok(None);
    }
    let session = stand.connect(TUNING_RUN)?;
    session.perform(&stand.uncompensated(), None, |session| {
        let circles = TuningCircles::on(session, circle);
        worth(circles, stand, compensation.clone()).map(Some)
    })
}

/// What a compensation is worth on two circles, without and with it.
fn worth(
    mut circles: TuningCircles<'_, '_>,
    stand: &Stand<'_>,
    compensation: Vec<AxisCompensation>,
) -> Outcome<Tuned> {
    let before_um = circles.run(&stand.uncompensated())?.bursts_um;
    let after_um = circles.run(&compensation)?.bursts_um;
    Ok(Tuned {
        compensation,
        before_um,
        after_um,
        circles: circles.count,
    })
}

fn tune_both(
    circles: &RefCell<TuningCircles<'_, '_>>,
    stand: &Stand<'_>,
    start_delay_s: f64,
) -> Outcome<Option<Tuned>> {
    let mut compensation = stand.uncompensated();
    let before = circles.borrow_mut().run(&compensation)?;
    for axis in 0..2 {
        let Some(start) = start(&before.points, axis, before.radius_m, stand.machine) else {
            continue;
        };
        let search = Search {
            circles,
            axis,
            others: compensation.clone(),
            start_delay_s,
            failure: RefCell::new(None),
        };
        compensation[axis].reversal = Compensation::Pulse(search.run(start)?);
    }
    if compensation == stand.uncompensated() {
        return Ok(None);
    }
    let after = circles.borrow_mut().run(&compensation)?;
    let circles = circles.borrow().count;
    Ok(Some(Tuned {
        compensation,
        before_um: before.bursts_um,
        after_um: after.bursts_um,
        circles,
    }))
}

impl Tuned {
    /// The largest burst of any axis before and after, µm.
    #[must_use]
    pub fn largest_um(&self) -> [f64; 2] {
        [self.before_um, self.after_um].map(|bursts| bursts.into_iter().fold(0.0, f64::max))
    }
}
