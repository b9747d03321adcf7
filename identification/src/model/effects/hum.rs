//! A force periodic in time: no effect of the list (mains hum, a pump nearby), but it must not be
//! absorbed by one.

use std::f64::consts::TAU;

use super::{Action, Against, Effect, Instant, Kinematics, Named, Naming, Setting, turning};
use crate::model::name::Called;
use crate::record::dataset::Dataset;

/// a cos(2π f t) + b sin(2π f t).
pub(crate) struct Hum;

const SLOWEST_HZ: f64 = 0.2;
const FASTEST_HZ: f64 = 60.0;
/// Every so many samples are scanned.
const STRIDE: usize = 8;
/// The whole band is scanned on so much of a record, s.
const LONGEST_SCAN_S: f64 = 40.0;

impl Effect for Hum {
    fn called(&self) -> Called {
        Called::Structure("force over time")
    }

    fn equation(&self) -> &'static str {
        "a cos(2 pi f t) + b sin(2 pi f t)"
    }

    fn columns(&self, motion: &Kinematics, _: &Dataset, hz: f64) -> Vec<Vec<f64>> {
        let angle = |t: &f64| TAU * hz * t;
        let t = &motion.time_s;
        vec![
            t.iter().map(|t| angle(t).cos()).collect(),
            t.iter().map(|t| angle(t).sin()).collect(),
        ]
    }

    fn width(&self, _: f64) -> usize {
        2
    }

    fn is_tuned(&self) -> bool {
        true
    }

    fn against(&self) -> Against {
        Against::Time
    }

    fn action(&self, at: &Instant, hz: f64, own: &[f64]) -> Action {
        let (sin, cos) = (TAU * hz * at.time_s).sin_cos();
        Action::force(own[0] * cos + own[1] * sin)
    }

    fn least_distance(&self, motion: &Kinematics) -> f64 {
        2.0 / motion.duration_s()
    }

    fn grid(&self, motion: &Kinematics, setting: &Setting<'_>) -> Vec<f64> {
        let fastest = FASTEST_HZ.min(0.4 / (motion.period_s * STRIDE as f64));
        // The whole band on a part of the record, then about its best on all of it: frequencies
        // times samples would grow with the square.
        let part = (LONGEST_SCAN_S / motion.period_s) as usize;
        let duration_s = motion.duration_s().min(LONGEST_SCAN_S);
        let step = 0.5 / duration_s;
        let best = strongest(&samples(motion, setting, part), SLOWEST_HZ, fastest, step);
        let fine = 0.5 / motion.duration_s();
        let best = if motion.len() > part {
            strongest(
                &samples(motion, setting, motion.len()),
                best - 2.0 * step,
                best + 2.0 * step,
                fine,
            )
        } else {
            best
        };
        (-3..=3)
            .map(|i| best + fine / 3.0 * f64::from(i))
            .filter(|hz| *hz > 0.0)
            .collect()
    }

    fn first_step(&self, motion: &Kinematics, _: f64) -> f64 {
        0.1 / motion.duration_s()
    }

    fn repeats(&self) -> bool {
        true
    }

    fn parameters(&self, naming: &Naming<'_>) -> Vec<Named> {
        vec![naming.nonlinear("force_over_time_frequency", naming.parameter, "Hz".into())]
    }
}

/// Time and residual of moving samples, thinned.
fn samples(motion: &Kinematics, setting: &Setting<'_>, rows: usize) -> Vec<(f64, f64)> {
    let moving = (0..motion.len().min(rows))
        .step_by(STRIDE)
        .filter(|at| motion.moving[*at]);
    moving
        .map(|at| {
            (
                motion.time_s[at],
                setting.residual.get(at).copied().unwrap_or(0.0),
            )
        })
        .collect()
}

/// The frequency with the strongest component within a band.
fn strongest(samples: &[(f64, f64)], from: f64, to: f64, step: f64) -> f64 {
    let count = ((to - from) / step).clamp(0.0, 20_000.0) as usize;
    turning::strongest(samples, from, step, count).unwrap_or(1.0)
}
