//! The momentum of the axis about a few rows, from the usual model
//! `u = M a + Fv v + Fc sign v + F0`.
//!
//! The model is fitted to means of 20 ms without the rows that stand out: coarse, but no single row
//! counts there. It is not the model of the identification. It answers one question, whether an
//! impulse of the effort went into the motion, and that within a factor of two.

use std::ops::Range;

use nalgebra::{Matrix4, Vector4};

use crate::record::outliers::excursion::Excursion;
use crate::record::time_base::{Rows, median_step};

/// Time of a mean: two periods of the low-pass of a fit.
const MEAN_S: f64 = 0.020;
/// Fewest rows of a mean.
const FEWEST_IN_MEAN: usize = 4;
/// Fewest means that tell four parameters.
const FEWEST_MEANS: usize = 20;
/// Rows on either side of a run that the effort is summed over: an impulse that was logged so many
/// rows early or late is answered within them.
const ABOUT: usize = 6;
/// Rows of which a velocity at the ends is made.
const VELOCITY_ROWS: usize = 4;
/// Every so many rows a balance is made, to know what it usually leaves.
const EVERY: usize = 7;
/// Share of the balances that leave less than the usual.
const USUAL_SHARE: f64 = 0.99;
/// An impulse is judged where it is so many times the usual.
const USUAL: f64 = 2.0;
/// Without the impulse the balance must leave the usual, or less than this share of what it leaves
/// with it: a real impulse leaves less with it.
const BETTER: f64 = 0.25;
/// Smallest effort that is worth a look, as a share of the effort's spread. Eight single rows of
/// this size among 28 000 add 0.15 %, the least that matters ([`EFFORT_PERCENT`]).
///
/// [`EFFORT_PERCENT`]: crate::evidence::thresholds::EFFORT_PERCENT
const SMALLEST: f64 = 0.5;
/// A motor may be so many times lighter than all that it moves.
const LIGHTER: f64 = 4.0;

/// What the momentum of a record is balanced with.
pub(crate) struct Balance {
    /// Mass (inertia), friction and offset.
    model: Vector4<f64>,
    /// The least mass that a motor may have.
    lightest: f64,
    /// What a balance in motion usually leaves.
    usual: f64,
    /// Standard deviation of the effort.
    spread: f64,
}

/// What a balance leaves about a run, and what friction may have taken where the axis stood.
#[derive(Clone, Copy, Debug)]
struct Left {
    impulse: f64,
    friction: f64,
}

impl Balance {
    /// The balance of a record, without the rows that stand out.
    pub(crate) fn of(rows: &Rows, standing_out: &[Excursion], moving_velocity: f64) -> Self {
        let mut spoilt = rows.left_out.clone();
        for one in standing_out {
            spoilt[one.rows.start - 1..=one.rows.end].fill(true);
        }
        let (model, masses) = usual_model(rows, &spoilt, moving_velocity);
        let mut balance = Self {
            model,
            lightest: masses.start / LIGHTER,
            usual: 0.0,
            spread: spread(&rows.effort),
        };
        // The largest mass that the record allows: it asks most of an outlier.
        balance.model[0] = masses.end;
        balance.usual = balance.usually_left(rows, &spoilt);
        balance
    }

    /// Whether an excursion of the effort was not there: the balance is better without it.
    pub(crate) fn has_no_such_effort(&self, rows: &Rows, one: &Excursion) -> bool {
        let Some(left) = self.left(rows, &one.rows) else {
            return false;
        };
        let run_s = rows.time_s[one.rows.end] - rows.time_s[one.rows.start];
        let impulse = one.size * run_s;
        let without = left.impulse - impulse;
        one.size.abs() > SMALLEST * self.spread
            && impulse.abs() > USUAL * self.usual + left.friction
            && without.abs() < self.usual.max(BETTER * left.impulse.abs())
    }

    /// Whether an excursion of a position is more than the effort about it can do.
    pub(crate) fn has_no_such_motion(&self, rows: &Rows, one: &Excursion) -> bool {
        if self.lightest <= 0.0 {
            return false;
        }
        let near = one.rows.start.saturating_sub(ABOUT)..one.rows.end + ABOUT;
        let near = &rows.effort[near.start..near.end.min(rows.effort.len())];
        let most = near.iter().fold(0.0_f64, |most, u| most.max(u.abs()));
        let run_s = rows.time_s[one.rows.end] - rows.time_s[one.rows.start];
        // There and back: twice what the effort does from rest.
        one.size.abs() > 2.0 * most * run_s.powi(2) / self.lightest
    }

    /// What balances about moving rows leave where nothing stands out.
    fn usually_left(&self, rows: &Rows, spoilt: &[bool]) -> f64 {
        let about = ABOUT + VELOCITY_ROWS;
        let ends = spoilt.len().saturating_sub(about + 1);
        let is_good = |row: &usize| !spoilt[row - about..=row + about].contains(&true);
        let starts = (about..ends).step_by(EVERY).filter(is_good);
        let balances = starts.filter_map(|row| self.left(rows, &(row..row + 1)));
        let moving = balances.filter(|left| left.friction == 0.0);
        let mut left: Vec<f64> = moving.map(|left| left.impulse.abs()).collect();
        if left.is_empty() {
            return f64::INFINITY;
        }
        let place = ((left.len() - 1) as f64 * USUAL_SHARE) as usize;
        *left.select_nth_unstable_by(place, f64::total_cmp).1
    }

    /// The balance about a run; `None` at the ends of a record.
    fn left(&self, rows: &Rows, run: &Range<usize>) -> Option<Left> {
        let half = VELOCITY_ROWS / 2;
        let from = run.start.checked_sub(ABOUT + VELOCITY_ROWS)?;
        let to = run.end + ABOUT + VELOCITY_ROWS;
        if to > rows.position.len() {
            return None;
        }
        let change = slope(rows, to - VELOCITY_ROWS..to) - slope(rows, from..from + VELOCITY_ROWS);
        let inside = from + half..to - half;
        let (first, last) = (inside.start, inside.end - 1);
        let step_s = (rows.time_s[last] - rows.time_s[first]) / (last - first) as f64;
        let time_s = step_s * inside.len() as f64;
        let way = (rows.position[last] - rows.position[first]) / (last - first) as f64
            * inside.len() as f64;
        let given: f64 = rows.effort[inside].iter().sum::<f64>() * step_s;
        let [mass, viscous, coulomb, offset] = self.model.into();
        let taken =
            mass * change + viscous * way + coulomb * way.signum() * time_s + offset * time_s;
        let stands = turns_or_stands(&rows.position[from..to]);
        Some(Left {
            impulse: given - taken,
            friction: if stands {
                2.0 * coulomb.abs() * time_s
            } else {
                0.0
            },
        })
    }
}

/// Whether positions do not go one way all the time; two rows at a time, since an encoder counts.
fn turns_or_stands(position: &[f64]) -> bool {
    let mut steps = position
        .windows(VELOCITY_ROWS)
        .map(|rows| rows[VELOCITY_ROWS - 1] - rows[0]);
    let forwards = position[position.len() - 1] > position[0];
    !steps.all(|step| if forwards { step > 0.0 } else { step < 0.0 })
}

/// Velocity over a few rows, by least squares.
fn slope(rows: &Rows, range: Range<usize>) -> f64 {
    let count = range.len() as f64;
    let (t, x) = (&rows.time_s[range.clone()], &rows.position[range]);
    let (mean_t, mean_x) = (t.iter().sum::<f64>() / count, x.iter().sum::<f64>() / count);
    let sums = t.iter().zip(x).fold((0.0, 0.0), |(tt, tx), (t, x)| {
        (tt + (t - mean_t).powi(2), tx + (t - mean_t) * (x - mean_x))
    });
    sums.1 / sums.0.max(f64::MIN_POSITIVE)
}

fn spread(values: &[f64]) -> f64 {
    let count = values.len().max(1) as f64;
    let mean = values.iter().sum::<f64>() / count;
    (values
        .iter()
        .map(|value| (value - mean).powi(2))
        .sum::<f64>()
        / count)
        .sqrt()
}

/// The usual model by least squares on means, and the range of its mass.
fn usual_model(rows: &Rows, spoilt: &[bool], slowest: f64) -> (Vector4<f64>, Range<f64>) {
    let period_s = median_step(&rows.time_s);
    let in_mean = ((MEAN_S / period_s).round() as usize).max(FEWEST_IN_MEAN);
    let mean_s = in_mean as f64 * period_s;
    let mean = |values: &[f64]| -> Vec<f64> {
        let parts = values.chunks_exact(in_mean);
        parts
            .map(|part| part.iter().sum::<f64>() / in_mean as f64)
            .collect()
    };
    let (x, u) = (mean(&rows.position), mean(&rows.effort));
    let parts = spoilt.chunks_exact(in_mean);
    let bad: Vec<bool> = parts.map(|part| part.contains(&true)).collect();
    let inside = (1..x.len().saturating_sub(1)).filter(|at| !bad[at - 1..=at + 1].contains(&true));
    let samples = inside.filter_map(|at| {
        let velocity = (x[at + 1] - x[at - 1]) / (2.0 * mean_s);
        let acceleration = (x[at + 1] - 2.0 * x[at] + x[at - 1]) / mean_s.powi(2);
        let effort = 0.25 * (u[at - 1] + 2.0 * u[at] + u[at + 1]);
        let columns = Vector4::new(acceleration, velocity, velocity.signum(), 1.0);
        (velocity.abs() > slowest).then_some((columns, effort))
    });
    solved(&samples.collect::<Vec<_>>())
}

/// Least squares. Noise in the acceleration makes the mass small, so the true one lies between this
/// regression and the reverse one, of the acceleration on the effort (Frisch 1934): `M` and `M/r²`
/// with the partial correlation r, each with its 95 % interval. Where nothing is known the range
/// has no ends.
fn solved(samples: &[(Vector4<f64>, f64)]) -> (Vector4<f64>, Range<f64>) {
    let unknown = (Vector4::zeros(), 0.0..f64::INFINITY);
    if samples.len() < FEWEST_MEANS {
        return unknown;
    }
    let (mut gram, mut right, mut total) = (Matrix4::zeros(), Vector4::zeros(), 0.0);
    for (columns, effort) in samples {
        gram += columns * columns.transpose();
        right += columns * *effort;
        total += effort * effort;
    }
    let scale = gram
        .diagonal()
        .map(|square: f64| square.sqrt().max(f64::MIN_POSITIVE));
    let scaled = Matrix4::from_fn(|i, j| gram[(i, j)] / (scale[i] * scale[j]));
    let Ok(inverse) = scaled.pseudo_inverse(1.0e-9) else {
        return unknown;
    };
    let model = (inverse * right.component_div(&scale)).component_div(&scale);
    let left = (total - model.dot(&right)).max(0.0) / samples.len() as f64;
    let error = (left * inverse[(0, 0)].max(0.0)).sqrt() / scale[0];
    let mass = model[0];
    if mass <= 2.0 * error {
        return (model, 0.0..f64::INFINITY);
    }
    let reverse = mass + samples.len() as f64 * error.powi(2) / mass;
    (model, mass - 2.0 * error..reverse + 2.0 * error)
}
