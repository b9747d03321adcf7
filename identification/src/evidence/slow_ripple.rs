//! Torque ripple of an axis that passes its reversals fast.
//!
//! At speed, ripple of a high order lies above the low-pass; it shows only about the reversals,
//! which the margins about slow samples leave out. Where an axis never dwells there is no stiction
//! to protect the fit from, and those samples are judged on their own: the declared model and one
//! integer order per revolution after the other, on held-out blocks, with the thresholds of the
//! selection.

use std::f64::consts::TAU;

use crate::evidence::inverse_dynamics::Compared;
use crate::evidence::selection;
use crate::fit::bench::Bench;
use crate::fit::blocks::{Fit, Gain};
use crate::fit::fitted::Fitted;
use crate::model::effects::torque_ripple::TorqueRipple;
use crate::model::inverse::{Model, Part};
use crate::motion::excitation::reversals;
use crate::motion::kinematics::Kinematics;
use crate::record::dataset::Dataset;
use crate::record::samples::Record;
use crate::record::units::AxisKind;

/// Torque ripple of an axis that is never slow for long.
#[derive(Clone, Debug)]
pub(crate) struct RippleAtReversals {
    /// Samples up to this velocity were used, in position units per second.
    pub fastest: f64,
    /// Low-pass of this judgement, Hz.
    pub cutoff_hz: f64,
    /// Orders, largest contribution first.
    pub orders: Vec<OrderAtReversals>,
    /// Force error over these samples, training record, percent: the declared model fitted to
    /// them, and with the ripple.
    pub train_percent: Compared<f64>,
    /// The same on the validation record.
    pub validate_percent: Compared<f64>,
}

/// One order of ripple.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OrderAtReversals {
    /// Periods per revolution.
    pub per_rev: u32,
    /// Amplitude, in the unit of the effort.
    pub amplitude: f64,
    /// Half width of its 95 % interval.
    pub half_width: f64,
    /// What it removed of the held-out error when it was added.
    pub gain: Gain,
}

/// An axis dwells where it has at least so many rows below the moving velocity per reversal.
const DWELL_ROWS: f64 = 1.0;
/// Samples up to this share of the median velocity are slow.
const SLOW_SHARE: f64 = 0.25;
/// Low-pass of this judgement, Hz.
const CUTOFF_HZ: f64 = 30.0;
/// Fewest slow samples and reversals.
const FEWEST_ROWS: usize = 1500;
const FEWEST_REVERSALS: usize = 20;
/// Highest order per revolution that is tried.
const HIGHEST_ORDER: u32 = 180;
/// Most orders that are added.
const MOST: usize = 8;
/// Largest distance of the two halves' amplitudes (as vectors), as a share of their mean.
const LARGEST_DISAGREEMENT: f64 = 0.6;
/// An amplitude must be so many half widths.
const WIDTHS: f64 = 1.5;

/// Ripple about reversals; `None` where the axis dwells, the revolution is not known, or nothing
/// was found.
#[must_use]
pub(crate) fn slow_ripple(
    dataset: &Dataset,
    moving: &Kinematics,
    declared: &Model,
) -> Option<RippleAtReversals> {
    let per_rev = match dataset.kind {
        AxisKind::Rotary => TAU,
        AxisKind::Linear => dataset.lead_m_per_rev?,
    };
    let limit = dataset.kind.moving_velocity();
    let dwelling = moving
        .velocity_lp
        .iter()
        .filter(|v| v.abs() <= limit)
        .count() as f64;
    let turns = reversals(moving);
    if turns < FEWEST_REVERSALS || dwelling >= DWELL_ROWS * turns as f64 {
        return None;
    }
    let fastest = SLOW_SHARE * median_speed(moving);
    let slow = |record: &Record| slow_motion(dataset, record, fastest);
    let (train, validate) = (slow(&dataset.train)?, slow(&dataset.validate)?);
    if train.fitted.iter().filter(|slow| **slow).count() < FEWEST_ROWS {
        return None;
    }
    let bench = Bench::new(dataset, &train);
    let before = bench.cross_validate(declared);
    let (model, after, found) = add_orders(&bench, declared.clone(), before.clone(), per_rev);
    if found.is_empty() {
        return None;
    }
    let before = Fitted::new(declared.clone(), &before.coefficients);
    let after = Fitted::new(model, &after.coefficients);
    let widths = bench.estimates_of_coefficients(&after);
    let orders = found.iter().zip(widths.iter().skip(declared.parts.len()));
    let orders = orders.map(|((per_rev, gain), estimate)| {
        let (own, half): (Vec<f64>, Vec<f64>) = estimate.own.iter().copied().unzip();
        OrderAtReversals {
            per_rev: *per_rev,
            amplitude: own[0].hypot(own[1]),
            half_width: half[0].hypot(half[1]),
            gain: *gain,
        }
    });
    let orders: Vec<OrderAtReversals> = orders
        .filter(|order| order.amplitude >= WIDTHS * order.half_width)
        .collect();
    let error = |motion: &Kinematics, fitted: &Fitted| {
        Bench::new(dataset, motion).force_error_percent(fitted)
    };
    let compared = |motion: &Kinematics| Compared {
        declared: error(motion, &before),
        extended: error(motion, &after),
    };
    Some(RippleAtReversals {
        fastest,
        cutoff_hz: CUTOFF_HZ,
        orders,
        train_percent: compared(&train),
        validate_percent: compared(&validate),
    })
    .filter(|ripple| !ripple.orders.is_empty())
}

fn median_speed(motion: &Kinematics) -> f64 {
    let moving = motion
        .velocity_lp
        .iter()
        .zip(&motion.moving)
        .filter(|(_, moving)| **moving);
    let mut speeds: Vec<f64> = moving.map(|(v, _)| v.abs()).collect();
    speeds.sort_by(f64::total_cmp);
    speeds.get(speeds.len() / 2).copied().unwrap_or(0.0)
}

/// The motion with its slow samples in place of the moving ones.
fn slow_motion(dataset: &Dataset, record: &Record, fastest: f64) -> Option<Kinematics> {
    let motion = Kinematics::with_cutoff(dataset, record, CUTOFF_HZ)?;
    let rows = motion.len();
    let slow = |row: usize| motion.is_inside(row) && motion.velocity_lp[row].abs() <= fastest;
    let mask: Vec<bool> = (0..rows)
        .map(|row| slow(row) && !record.interpolated[row])
        .collect();
    Some(Kinematics {
        moving: mask.clone(),
        fitted: mask,
        ..motion
    })
}

/// The two halves of the samples, each on its own.
fn halves(motion: &Kinematics) -> [Kinematics; 2] {
    let count = motion.fitted.iter().filter(|slow| **slow).count();
    let mut seen = 0;
    let first: Vec<bool> = motion
        .fitted
        .iter()
        .map(|slow| {
            seen += usize::from(*slow);
            *slow && 2 * seen <= count
        })
        .collect();
    let second = motion
        .fitted
        .iter()
        .zip(&first)
        .map(|(slow, first)| *slow && !first)
        .collect();
    [first, second].map(|fitted| Kinematics {
        fitted,
        ..motion.clone()
    })
}

/// One order after the other, each the best of its round that both halves of the record agree
/// about.
fn add_orders(
    bench: &Bench<'_>,
    start: Model,
    fit: Fit,
    per_rev: f64,
) -> (Model, Fit, Vec<(u32, Gain)>) {
    let halves = halves(bench.motion);
    let (mut model, mut fit, mut found) = (start, fit, Vec::<(u32, Gain)>::new());
    while found.len() < MOST {
        let design = bench.design(&model);
        let part = |order: u32| Part::found(&TorqueRipple, f64::from(order) / per_rev);
        let open =
            (1..=HIGHEST_ORDER).filter(|order| found.iter().all(|(known, _)| known != order));
        let judged = open.map(|order| {
            let fit_with = bench
                .blocks(&bench.extended_once(&design, &part(order)))
                .cross_validate();
            (Gain::of(&fit, &fit_with), order, fit_with)
        });
        let mut judged: Vec<(Gain, u32, Fit)> = judged
            .filter(|(gain, ..)| gain.share >= selection::SHARE && selection::is_enough(gain))
            .collect();
        judged.sort_by(|a, b| b.0.share.total_cmp(&a.0.share));
        let agreed = judged
            .into_iter()
            .find(|(_, order, _)| agree(bench.dataset, &halves, &model.with(part(*order))));
        let Some((gain, order, better)) = agreed else {
            break;
        };
        model = model.with(part(order));
        fit = better;
        found.push((order, gain));
    }
    (model, fit, found)
}

/// Whether both halves see the last order of a model with about the same amplitude and phase.
fn agree(dataset: &Dataset, halves: &[Kinematics; 2], model: &Model) -> bool {
    let [one, other] = halves.each_ref().map(|motion| {
        let fitted = Bench::new(dataset, motion).fit(model);
        let last = fitted.terms().next_back();
        last.map_or([0.0; 2], |term| [term.own[0], term.own[1]])
    });
    let apart = f64::hypot(one[0] - other[0], one[1] - other[1]);
    let mean = 0.5 * f64::hypot(one[0] + other[0], one[1] + other[1]);
    apart <= LARGEST_DISAGREEMENT * mean
}
