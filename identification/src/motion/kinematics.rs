//! From positions to velocity, acceleration, direction and masks, aligned with the effort.
//!
//! A zero-order-hold effort acts from its row to the next, so positions and their derivatives are
//! taken at the middle of that interval: the velocity is the difference quotient, the acceleration
//! the mean of two adjacent second differences (the triangle-weighted mean acceleration over the
//! hold). An instantaneous effort is paired with central differences.
//!
//! Nonlinear columns are made from the low-passed velocity and position and then low-passed
//! themselves, linear ones from the raw derivatives.

use crate::motion::filter::{LowPass, TRIM, fit_cutoff_hz};
use crate::record::dataset::Dataset;
use crate::record::samples::Record;
use crate::record::units::EffortHold;

/// Slow samples spoil their neighbours within this time.
const SLOW_MARGIN_S: f64 = 0.020;

/// What a record says about motion.
#[derive(Clone, Debug)]
pub(crate) struct Kinematics {
    /// Sample period, s.
    pub period_s: f64,
    /// Time since the start of the record, s.
    pub time_s: Vec<f64>,
    /// Acceleration, raw.
    pub acceleration: Vec<f64>,
    /// Velocity, raw.
    pub velocity: Vec<f64>,
    /// Load − motor acceleration, raw, where both were measured.
    pub load_acceleration: Option<Vec<f64>>,
    /// Low-passed position.
    pub position_lp: Vec<f64>,
    /// Low-passed velocity where friction acts: at the load scale if there is one, else at the
    /// motor.
    pub velocity_lp: Vec<f64>,
    /// Raw position where friction acts.
    pub friction_position: Vec<f64>,
    /// Direction, −1…1: the sign of the velocity, or the presliding state once that is accepted.
    pub direction: Vec<f64>,
    /// Acting effort, raw.
    pub effort: Vec<f64>,
    /// Low-passed effort.
    pub effort_lp: Vec<f64>,
    /// Motor − load, raw, where both were measured.
    pub difference: Option<Vec<f64>>,
    /// Moving samples: the ones that errors are defined on.
    pub moving: Vec<bool>,
    /// Moving samples whose effort is known and not at its limit: the ones that are fitted.
    pub fitted: Vec<bool>,
    /// Samples about reversals and rests.
    pub slow: Vec<bool>,
    /// The low-pass.
    pub filter: LowPass,
}

impl Kinematics {
    /// Kinematics of a record with the cut-off of its fit; `None` where the sample rate leaves no
    /// room for the low-pass.
    #[must_use]
    pub(crate) fn new(dataset: &Dataset, record: &Record) -> Option<Self> {
        Self::with_cutoff(dataset, record, fit_cutoff_hz(record))
    }

    /// The same with another cut-off.
    #[must_use]
    pub(crate) fn with_cutoff(dataset: &Dataset, record: &Record, cutoff: f64) -> Option<Self> {
        let period_s = record.period_s;
        let filter = LowPass::new(period_s, cutoff)?;
        let motor = Derivatives::new(&record.position, period_s, dataset.hold);
        let friction = record
            .load
            .as_ref()
            .map(|load| Derivatives::new(load, period_s, dataset.hold));
        let relative = |load: &Derivatives| {
            load.acceleration
                .iter()
                .zip(&motor.acceleration)
                .map(|(l, m)| l - m)
                .collect()
        };
        let load_acceleration = friction.as_ref().map(relative);
        let friction = friction.as_ref().unwrap_or(&motor);
        let effort = acting_effort(&record.effort, dataset.effort_lag_s, period_s, dataset.hold);
        let motor_lp = filter.apply(&motor.velocity);
        let velocity_lp = filter.apply(&friction.velocity);
        let limit = dataset.kind.moving_velocity();
        let (moving, slow) = masks(&motor_lp, limit, period_s);
        let spoilt = spoilt(record, dataset.effort_limit, period_s);
        let fitted = moving
            .iter()
            .zip(&spoilt)
            .map(|(moving, spoilt)| *moving && !spoilt)
            .collect();
        let slow = slow
            .iter()
            .zip(&spoilt)
            .map(|(slow, spoilt)| *slow && !spoilt)
            .collect();
        Some(Self {
            period_s,
            time_s: record.time_s.clone(),
            load_acceleration,
            position_lp: filter.apply(&motor.position),
            direction: velocity_lp.iter().map(|v| v.signum()).collect(),
            friction_position: friction.position.clone(),
            velocity_lp,
            effort_lp: filter.apply(&effort),
            difference: record.load.as_ref().map(|load| {
                record
                    .position
                    .iter()
                    .zip(load)
                    .map(|(m, l)| m - l)
                    .collect()
            }),
            moving,
            fitted,
            slow,
            acceleration: motor.acceleration,
            velocity: motor.velocity,
            effort,
            filter,
        })
    }

    /// Number of samples.
    #[must_use]
    pub(crate) fn len(&self) -> usize {
        self.effort.len()
    }

    /// Range of positions over moving samples.
    #[must_use]
    pub(crate) fn span(&self) -> (f64, f64) {
        let moving = self
            .position_lp
            .iter()
            .zip(&self.moving)
            .filter(|(_, moving)| **moving);
        moving.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), (x, _)| {
            (low.min(*x), high.max(*x))
        })
    }

    /// Duration, s.
    #[must_use]
    pub(crate) fn duration_s(&self) -> f64 {
        self.period_s * self.len() as f64
    }
}

struct Derivatives {
    position: Vec<f64>,
    velocity: Vec<f64>,
    acceleration: Vec<f64>,
}

impl Derivatives {
    fn new(x: &[f64], t: f64, hold: EffortHold) -> Self {
        let rows = x.len();
        // Ends mirrored about their first and last value, so that no row is lost.
        let at = |i: isize| -> f64 {
            let last = rows as isize - 1;
            match i {
                i if i < 0 => 2.0 * x[0] - x[(-i).min(last) as usize],
                i if i > last => 2.0 * x[last as usize] - x[(2 * last - i).max(0) as usize],
                i => x[i as usize],
            }
        };
        let second = |i: isize| (at(i + 1) - 2.0 * at(i) + at(i - 1)) / (t * t);
        let rows = 0..rows as isize;
        match hold {
            EffortHold::ZeroOrder => Self {
                position: rows.clone().map(|i| 0.5 * (at(i) + at(i + 1))).collect(),
                velocity: rows.clone().map(|i| (at(i + 1) - at(i)) / t).collect(),
                acceleration: rows.map(|i| 0.5 * (second(i) + second(i + 1))).collect(),
            },
            EffortHold::Instant => Self {
                position: x.to_vec(),
                velocity: rows
                    .clone()
                    .map(|i| (at(i + 1) - at(i - 1)) / (2.0 * t))
                    .collect(),
                acceleration: rows.map(second).collect(),
            },
        }
    }
}

/// The effort that acts: through a known first-order lag; for a zero-order hold, its mean over the
/// interval.
fn acting_effort(effort: &[f64], lag_s: f64, period_s: f64, hold: EffortHold) -> Vec<f64> {
    if lag_s <= 0.0 {
        return effort.to_vec();
    }
    let decay = (-period_s / lag_s).exp();
    let mean_share = lag_s / period_s * (1.0 - decay);
    let mut state = effort.first().copied().unwrap_or(0.0);
    effort
        .iter()
        .map(|u| {
            let before = state;
            state = u + (state - u) * decay;
            match hold {
                EffortHold::ZeroOrder => u + (before - u) * mean_share,
                EffortHold::Instant => state,
            }
        })
        .collect()
}

/// Share of the limit from which an effort counts as limited.
const LIMITED: f64 = 0.999;

/// Samples about a hole in the record or about an effort at its limit: what acted there is not
/// known.
fn spoilt(record: &Record, limit: Option<f64>, period_s: f64) -> Vec<bool> {
    let limited = |effort: &f64| limit.is_some_and(|limit| effort.abs() >= LIMITED * limit);
    let bad = record
        .effort
        .iter()
        .zip(&record.interpolated)
        .map(|(effort, hole)| *hole || limited(effort));
    let margin = (SLOW_MARGIN_S / period_s).round() as usize;
    let rows = record.len();
    let mut spoilt = vec![false; rows];
    for (row, _) in bad.enumerate().filter(|(_, bad)| *bad) {
        spoilt[row.saturating_sub(margin)..(row + margin + 1).min(rows)].fill(true);
    }
    spoilt
}

fn masks(velocity_lp: &[f64], limit: f64, period_s: f64) -> (Vec<bool>, Vec<bool>) {
    let rows = velocity_lp.len();
    let margin = (SLOW_MARGIN_S / period_s).round() as usize;
    let mut spoilt = vec![false; rows];
    let mut until = 0;
    for (row, velocity) in velocity_lp.iter().enumerate() {
        if velocity.abs() <= limit {
            let from = row.saturating_sub(margin).max(until);
            until = (row + margin + 1).min(rows);
            spoilt[from.min(until)..until].fill(true);
        }
    }
    let inside = |row: usize| row >= TRIM && row + TRIM < rows;
    let moving = (0..rows).map(|row| inside(row) && !spoilt[row]).collect();
    let slow = (0..rows).map(|row| inside(row) && spoilt[row]).collect();
    (moving, slow)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_acceleration_of_a_parabola_is_exact_under_both_holds() {
        let x: Vec<f64> = (0..50)
            .map(|i| 0.5 * 3.0 * (1.0e-3 * f64::from(i)).powi(2))
            .collect();
        for hold in [EffortHold::Instant, EffortHold::ZeroOrder] {
            let derivatives = Derivatives::new(&x, 1.0e-3, hold);
            assert!(
                derivatives.acceleration[5..45]
                    .iter()
                    .all(|a| (a - 3.0).abs() < 1.0e-6)
            );
        }
    }

    #[test]
    fn slow_samples_take_their_neighbours_with_them() {
        let velocity: Vec<f64> = (0..1000)
            .map(|i| if i == 500 { 0.0 } else { 0.1 })
            .collect();
        let (moving, slow) = masks(&velocity, 1.0e-3, 1.0e-3);
        assert_eq!(slow.iter().filter(|slow| **slow).count(), 41);
        assert!(!moving[480] && !moving[520] && moving[479] && moving[521]);
        assert!(!moving[199] && moving[200]);
    }
}
