//! Velocity and acceleration from positions, at the time at which the effort of a row acts.
//!
//! A zero-order-hold effort acts from its row to the next, so positions and their derivatives are
//! taken at the middle of that interval: the velocity is the difference quotient, the acceleration
//! the mean of two adjacent second differences (the triangle-weighted mean acceleration over the
//! hold). An instantaneous effort is paired with central differences.
//!
//! Where the drive's own velocity is good, it stands in the place of the difference quotient, and
//! the acceleration is its first derivative instead of the second one of the position. Over a hold
//! that is the mean acceleration exactly.
//!
//! Differences see less of fast motion than the effort does, by a share of ω²T² to the leading
//! order. [`Derivatives::sharpened`] gives it back. It makes noise of the positions larger too, so
//! a record has to show that it is worth it.
//!
//! | effort | acceleration sees | velocity sees |
//! |---|---|---|
//! | held | `[1 2 1]/4` of the effort: 1 − ω²T²/4 | 1 − ω²T²/12 of what that leaves of friction |
//! | at an instant | 1 − ω²T²/12 (Numerov) | 1 − ω²T²/6 |
//!
//! The velocity under a hold: a difference quotient sees 1 − ω²T²/24 of it. Two triangles half a
//! row away on either side see 1 − 5 ω²T²/24 of a friction that is smooth, and sharpened by a
//! quarter 1 + ω²T²/24.

use crate::motion::lag::unevenness;
use crate::record::dataset::Dataset;
use crate::record::units::EffortHold;

/// Position, velocity and acceleration of one body.
#[derive(Clone, Debug)]
pub(crate) struct Derivatives {
    pub(crate) position: Vec<f64>,
    pub(crate) velocity: Vec<f64>,
    pub(crate) acceleration: Vec<f64>,
}

/// Positions that go on beyond both ends, mirrored about the first and the last one, so that no row
/// is lost.
struct Mirrored<'a>(&'a [f64]);

impl Mirrored<'_> {
    fn at(&self, row: isize) -> f64 {
        let x = self.0;
        let last = x.len() as isize - 1;
        match row {
            row if row < 0 => 2.0 * x[0] - x[(-row).min(last) as usize],
            row if row > last => 2.0 * x[last as usize] - x[(2 * last - row).max(0) as usize],
            row => x[row as usize],
        }
    }

    /// Second difference about a row.
    fn second(&self, row: isize) -> f64 {
        self.at(row + 1) - 2.0 * self.at(row) + self.at(row - 1)
    }
}

impl Derivatives {
    /// Of positions that are `period_s` apart.
    #[must_use]
    pub(crate) fn new(positions: &[f64], period_s: f64, hold: EffortHold) -> Self {
        let (x, t) = (Mirrored(positions), period_s);
        let rows = 0..positions.len() as isize;
        let second = |i: isize| x.second(i) / (t * t);
        match hold {
            EffortHold::ZeroOrder => Self {
                position: rows
                    .clone()
                    .map(|i| 0.5 * (x.at(i) + x.at(i + 1)))
                    .collect(),
                velocity: rows.clone().map(|i| (x.at(i + 1) - x.at(i)) / t).collect(),
                acceleration: rows.map(|i| 0.5 * (second(i) + second(i + 1))).collect(),
            },
            EffortHold::Instant => Self {
                position: positions.to_vec(),
                velocity: rows
                    .clone()
                    .map(|i| (x.at(i + 1) - x.at(i - 1)) / (2.0 * t))
                    .collect(),
                acceleration: rows.map(second).collect(),
            },
        }
    }
}

/// What a velocity of [`Derivatives::new`] lacks, in its own second differences.
fn lacks_of_velocity(hold: EffortHold) -> f64 {
    match hold {
        EffortHold::ZeroOrder => 1.0 / 12.0,
        EffortHold::Instant => 1.0 / 6.0,
    }
}

/// What an acceleration of [`Derivatives::new`] lacks, in its own second differences.
fn lacks_of_acceleration(hold: EffortHold) -> f64 {
    match hold {
        EffortHold::ZeroOrder => 1.0 / 4.0,
        EffortHold::Instant => 1.0 / 12.0,
    }
}

impl Derivatives {
    /// The same with what differences lack of fast motion.
    #[must_use]
    pub(crate) fn sharpened(self, hold: EffortHold) -> Self {
        Self {
            velocity: without_bow(&self.velocity, lacks_of_velocity(hold)),
            acceleration: without_bow(&self.acceleration, lacks_of_acceleration(hold)),
            position: self.position,
        }
    }
}

/// What the acceleration of a body lacks of fast motion, as shares of ω²T².
///
/// It is more of the effort that moves the body than of a force beside it. A held effort goes in
/// steps, and the acceleration over two rows sees `[1 2 1]/4` of it; a lag rounds the steps, up to
/// what a smooth force is. For an effort that is recorded at an instant both are the same.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Lacking {
    /// Of the effort.
    pub effort: f64,
    /// Of a smooth force.
    pub force: f64,
}

impl Lacking {
    /// Of a dataset.
    #[must_use]
    pub(crate) fn of(dataset: &Dataset) -> Self {
        if dataset.train.velocity.is_some() {
            return Self::default();
        }
        let of_steps = lacks_of_acceleration(dataset.hold);
        let given = if dataset.is_sharpened { of_steps } else { 0.0 };
        let (effort, force) = match dataset.hold {
            EffortHold::Instant => (of_steps, of_steps),
            EffortHold::ZeroOrder => {
                let uneven = unevenness(dataset.effort_lag_s, dataset.train.period_s);
                (of_steps - uneven, 1.0 / 6.0)
            }
        };
        Self {
            effort: effort - given,
            force: force - given,
        }
    }
}

/// A signal with so much of its second differences taken away: sharpened, or smoothed where that is
/// below zero.
#[must_use]
pub(crate) fn without_bow(values: &[f64], share: f64) -> Vec<f64> {
    let around = Reflected(values);
    let second = |i| around.at(i + 1) - 2.0 * around.at(i) + around.at(i - 1);
    let rows = 0..values.len() as isize;
    rows.map(|i| around.at(i) - share * second(i)).collect()
}

/// Values that go on beyond both ends, mirrored.
struct Reflected<'a>(&'a [f64]);

impl Reflected<'_> {
    fn at(&self, row: isize) -> f64 {
        let last = self.0.len() as isize - 1;
        let inside = if row > last {
            2 * last - row
        } else {
            row.abs()
        };
        self.0[inside.clamp(0, last) as usize]
    }

    /// First derivative at a row times the period: the central difference over four rows, within
    /// half a percent up to a tenth of the sample rate, where that over two is off by six.
    fn slope(&self, row: isize) -> f64 {
        let over = |rows: isize| self.at(row + rows) - self.at(row - rows);
        (8.0 * over(1) - over(2)) / 12.0
    }
}

impl Derivatives {
    /// The same body, its velocity measured.
    #[must_use]
    pub(crate) fn with_velocity(&self, measured: &[f64], period_s: f64, hold: EffortHold) -> Self {
        let v = Reflected(measured);
        let rows = 0..measured.len() as isize;
        let (velocity, acceleration) = match hold {
            EffortHold::ZeroOrder => rows
                .map(|i| (v.at(i), v.at(i + 1)))
                .map(|(from, to)| (0.5 * (from + to), (to - from) / period_s))
                .unzip(),
            EffortHold::Instant => rows.map(|i| (v.at(i), v.slope(i) / period_s)).unzip(),
        };
        Self {
            position: self.position.clone(),
            velocity,
            acceleration,
        }
    }

    /// The body that goes with another one: this, moved by what that other body's motion has been
    /// corrected by.
    #[must_use]
    pub(crate) fn corrected_like(&self, before: &Self, after: &Self) -> Self {
        let moved = |own: &[f64], before: &[f64], after: &[f64]| {
            let rows = own.iter().zip(before).zip(after);
            rows.map(|((own, before), after)| own + (after - before))
                .collect()
        };
        Self {
            position: self.position.clone(),
            velocity: moved(&self.velocity, &before.velocity, &after.velocity),
            acceleration: moved(
                &self.acceleration,
                &before.acceleration,
                &after.acceleration,
            ),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;
    use crate::motion::lag::acting_effort;
    use crate::simulate::made::{dataset, record};

    const HOLDS: [EffortHold; 2] = [EffortHold::Instant, EffortHold::ZeroOrder];

    /// 0.5 · 3 t² at 1 kHz.
    fn parabola() -> Vec<f64> {
        let at = |i: i32| 1.5 * (1.0e-3 * f64::from(i)).powi(2);
        (0..50).map(at).collect()
    }

    #[test]
    fn the_acceleration_of_a_parabola_is_exact_under_both_holds() {
        for hold in HOLDS {
            let derivatives = Derivatives::new(&parabola(), 1.0e-3, hold);
            let inside = &derivatives.acceleration[5..45];
            assert!(inside.iter().all(|a| (a - 3.0).abs() < 1.0e-6));
        }
    }

    #[test]
    fn an_effort_that_is_held_sees_the_middle_of_its_interval() {
        let [instant, held] = HOLDS.map(|hold| Derivatives::new(&parabola(), 1.0e-3, hold));
        // 3 t: at row 20, and half a row later.
        assert!((instant.velocity[20] - 60.0e-3).abs() < 1.0e-9);
        assert!((held.velocity[20] - 61.5e-3).abs() < 1.0e-9);
        assert_eq!(instant.position[20], parabola()[20]);
        assert_eq!(held.position[20], 0.5 * (parabola()[20] + parabola()[21]));
    }

    #[test]
    fn a_straight_line_goes_on_beyond_its_ends() {
        let line: Vec<f64> = (0..10).map(|i| 0.5 * f64::from(i)).collect();
        for hold in HOLDS {
            let derivatives = Derivatives::new(&line, 0.5, hold);
            assert!(
                derivatives
                    .velocity
                    .iter()
                    .all(|v| (v - 1.0).abs() < 1.0e-12)
            );
            assert!(derivatives.acceleration.iter().all(|a| a.abs() < 1.0e-12));
        }
    }

    /// A velocity at 5 Hz and its derivative at a time, 1 kHz.
    fn wave(t: f64) -> (f64, f64) {
        ((31.4 * t).sin(), 31.4 * (31.4 * t).cos())
    }

    #[test]
    fn a_measured_velocity_gives_the_acceleration_at_the_time_of_the_effort() {
        let at = |row: i32| 1.0e-3 * f64::from(row);
        let measured: Vec<f64> = (0..400).map(|row| wave(at(row)).0).collect();
        for (hold, later_s) in [(EffortHold::Instant, 0.0), (EffortHold::ZeroOrder, 0.5e-3)] {
            let body = Derivatives::new(&vec![0.0; 400], 1.0e-3, hold);
            let body = body.with_velocity(&measured, 1.0e-3, hold);
            for row in 5..395 {
                let (velocity, acceleration) = wave(at(row) + later_s);
                let place = row as usize;
                assert!((body.velocity[place] - velocity).abs() < 2.0e-4);
                assert!((body.acceleration[place] - acceleration).abs() < 2.0e-3);
            }
        }
    }

    #[test]
    fn a_measured_velocity_of_a_line_goes_on_beyond_its_ends() {
        for hold in HOLDS {
            let body = Derivatives::new(&[0.0; 8], 0.5, hold);
            let body = body.with_velocity(&[2.0; 8], 0.5, hold);
            assert_eq!(body.velocity, [2.0; 8]);
            assert_eq!(body.acceleration, [0.0; 8]);
        }
    }

    /// 60 Hz at 1 kHz: what is left of the amplitude of a wave.
    #[test]
    fn sharpened_an_instant_sees_the_whole_of_fast_motion() {
        let omega = TAU * 60.0;
        let path: Vec<f64> = (0..600)
            .map(|row| (omega * 1.0e-3 * f64::from(row)).sin())
            .collect();
        let plain = Derivatives::new(&path, 1.0e-3, EffortHold::Instant);
        let sharp = plain.clone().sharpened(EffortHold::Instant);
        for (row, x) in path.iter().enumerate().take(590).skip(10) {
            let t = 1.0e-3 * row as f64;
            let (velocity, acceleration) = (omega * (omega * t).cos(), -omega.powi(2) * x);
            assert!((sharp.velocity[row] - velocity).abs() < 2.0e-3 * omega);
            assert!((sharp.acceleration[row] - acceleration).abs() < 2.0e-3 * omega.powi(2));
        }
        let lost = (plain.acceleration[104] / (-omega.powi(2) * path[104])) - 1.0;
        assert!((-0.013..-0.010).contains(&lost), "{lost}");
    }

    /// A mass of one with 40 1/s of friction, driven by an effort that is held, in 200 steps a row.
    #[test]
    fn sharpened_a_held_effort_is_the_mass_and_the_friction() {
        const STEPS: i32 = 200;
        let omega = TAU * 40.0;
        let effort: Vec<f64> = (0..800)
            .map(|row| (omega * 1.0e-3 * f64::from(row)).sin())
            .collect();
        let step_s = 1.0e-3 / f64::from(STEPS);
        let (mut x, mut v) = (0.0, 0.0);
        let mut path = Vec::new();
        for effort in &effort {
            path.push(x);
            for _ in 0..STEPS {
                let acceleration = effort - 40.0 * (v + 0.5 * step_s * (effort - 40.0 * v));
                x += step_s * (v + 0.5 * step_s * acceleration);
                v += step_s * acceleration;
            }
        }
        let left = |body: &Derivatives| {
            let rows = 200..790;
            let of = |row: usize| effort[row] - body.acceleration[row] - 40.0 * body.velocity[row];
            rows.map(|row| of(row).abs()).fold(0.0, f64::max)
        };
        let plain = Derivatives::new(&path, 1.0e-3, EffortHold::ZeroOrder);
        assert!((0.012..0.018).contains(&left(&plain)), "{}", left(&plain));
        let sharp = left(&plain.sharpened(EffortHold::ZeroOrder));
        assert!(sharp < 4.0e-4, "{sharp}");
    }

    /// A mass of one between a held effort that acts through a lag and half as much of a smooth
    /// force, at 40 Hz in 200 steps a row: what is left of the balance of forces, plain and with
    /// what the acceleration lacks.
    fn left_of_balance(lag_s: f64) -> [f64; 2] {
        const STEPS: i32 = 200;
        let (omega, step_s) = (TAU * 40.0, 1.0e-3 / f64::from(STEPS));
        let smooth = |t: f64| 0.5 * (omega * t + 0.4).sin();
        let recorded: Vec<f64> = (0..800)
            .map(|row| (omega * 1.0e-3 * f64::from(row)).sin())
            .collect();
        let (mut x, mut v, mut t, mut acts) = (0.0, 0.0, 0.0, 0.0);
        let kept = if lag_s > 0.0 {
            (-step_s / lag_s).exp()
        } else {
            0.0
        };
        let (mut path, mut forces) = (Vec::new(), Vec::new());
        for effort in &recorded {
            path.push(x);
            let mut mean = 0.0;
            for _ in 0..STEPS {
                let before = acts;
                acts = effort + (before - effort) * kept;
                let middle = if lag_s > 0.0 {
                    0.5 * (before + acts)
                } else {
                    *effort
                };
                let force = smooth(t + 0.5 * step_s);
                let acceleration = middle - force;
                x += step_s * (v + 0.5 * step_s * acceleration);
                v += step_s * acceleration;
                t += step_s;
                mean += force / f64::from(STEPS);
            }
            forces.push(mean);
        }
        let dataset = Dataset {
            effort_lag_s: lag_s,
            ..dataset(record(1.0e-3, path.clone()), None)
        };
        let lacking = Lacking::of(&dataset);
        let acceleration = Derivatives::new(&path, 1.0e-3, EffortHold::ZeroOrder).acceleration;
        let effort = acting_effort(&recorded, lag_s, 1.0e-3, EffortHold::ZeroOrder);
        [Lacking::default(), lacking].map(|lacking| {
            let acceleration = without_bow(&acceleration, lacking.force);
            let effort = without_bow(&effort, lacking.force - lacking.effort);
            let of = |row: usize| effort[row] - forces[row] - acceleration[row];
            (200..790).map(|row| of(row).abs()).fold(0.0, f64::max)
        })
    }

    #[test]
    fn what_an_acceleration_lacks_of_a_lagging_effort_and_of_a_smooth_force_is_given_back() {
        for lag_s in [0.0, 5.0e-4, 3.0e-3] {
            let [plain, whole] = left_of_balance(lag_s);
            assert!(
                plain > 4.0e-3 && whole < 0.1 * plain,
                "{lag_s}: {plain} {whole}"
            );
        }
    }

    #[test]
    fn a_load_is_corrected_as_its_motor_is() {
        let of = |velocity: f64| Derivatives {
            position: vec![7.0],
            velocity: vec![velocity],
            acceleration: vec![10.0 * velocity],
        };
        let load = of(1.0).corrected_like(&of(0.9), &of(0.8));
        assert!((load.velocity[0] - 0.9).abs() < 1.0e-12);
        assert!((load.acceleration[0] - 9.0).abs() < 1.0e-12);
        assert_eq!(load.position, [7.0]);
    }
}
