//! Torque ripple: a force periodic in motor position, `a cos(2π k x) + b sin(2π k x)`.
//!
//! The period is searched, so the lead need not be known; where it is, the order per revolution is
//! reported.

use std::f64::consts::TAU;

use axis_model::EffectName;

use super::{Action, Against, Effect, Instant, Kinematics, Named, Naming, Setting};
use crate::model::name::Called;
use crate::record::dataset::Dataset;
use crate::record::units::AxisKind;

/// Cosine and sine of position.
pub(crate) struct TorqueRipple;

/// At least so many periods within the travel: fewer are position dependence.
const FEWEST_PERIODS: f64 = 8.0;
/// The low-pass leaves nothing of faster ripple, Hz.
const FASTEST_HZ: f64 = 70.0;
/// Every so many samples are scanned.
const STRIDE: usize = 4;

impl Effect for TorqueRipple {
    fn called(&self) -> Called {
        EffectName::TorqueRipple.into()
    }

    fn equation(&self) -> &'static str {
        "a cos(2 pi k x) + b sin(2 pi k x)"
    }

    fn columns(&self, motion: &Kinematics, _: &Dataset, k: f64) -> Vec<Vec<f64>> {
        let angle = |x: &f64| TAU * k * x;
        let x = &motion.position_lp;
        vec![
            x.iter().map(|x| angle(x).cos()).collect(),
            x.iter().map(|x| angle(x).sin()).collect(),
        ]
    }

    fn width(&self, _: f64) -> usize {
        2
    }

    fn is_tuned(&self) -> bool {
        true
    }

    fn acts_on_motor(&self) -> bool {
        true
    }

    fn against(&self) -> Against {
        Against::Period
    }

    fn action(&self, at: &Instant, k: f64, own: &[f64]) -> Action {
        let (sin, cos) = (TAU * k * at.position).sin_cos();
        Action::force(own[0] * cos + own[1] * sin)
    }

    fn start(&self, dataset: &Dataset) -> f64 {
        dataset.lead_m_per_rev.map_or(100.0, |lead| 1.0 / lead)
    }

    fn least_distance(&self, motion: &Kinematics) -> f64 {
        let (low, high) = motion.span();
        2.0 / (high - low)
    }

    fn grid(&self, motion: &Kinematics, setting: &Setting<'_>) -> Vec<f64> {
        let (low, high) = motion.span();
        let step = 0.25 / (high - low);
        let best = strongest(motion, setting, FEWEST_PERIODS * 4.0 * step, step);
        best.iter()
            .flat_map(|k| (-3..=3).map(move |i| k + 0.25 * step * f64::from(i)))
            .collect()
    }

    fn first_step(&self, motion: &Kinematics, _: f64) -> f64 {
        let (low, high) = motion.span();
        0.05 / (high - low)
    }

    fn bounds(&self, motion: &Kinematics) -> (f64, f64) {
        let (low, high) = motion.span();
        (FEWEST_PERIODS / (high - low), f64::MAX)
    }

    fn repeats(&self) -> bool {
        true
    }

    fn parameters(&self, naming: &Naming<'_>) -> Vec<Named> {
        let (a, b) = (
            naming.coefficient("", 0, String::new()),
            naming.coefficient("", 1, String::new()),
        );
        let half_width = a
            .half_width
            .unwrap_or(0.0)
            .hypot(b.half_width.unwrap_or(0.0));
        let amplitude = Named {
            name: "torque_ripple_amplitude".into(),
            value: a.value.hypot(b.value),
            half_width: Some(half_width),
            unit: naming.effort_unit(""),
        };
        let k = naming.parameter;
        let per_rev = match naming.dataset.kind {
            AxisKind::Linear => naming.dataset.lead_m_per_rev.map(|lead| k * lead),
            AxisKind::Rotary => Some(k * TAU),
        };
        let order =
            per_rev.map(|order| naming.nonlinear("torque_ripple_order", order, "per rev".into()));
        let period = naming.nonlinear("torque_ripple_period", 1.0 / k, naming.length().into());
        // a cos θ + b sin θ = A sin(θ + φ).
        let phase = Named {
            name: "torque_ripple_phase".into(),
            value: a.value.atan2(b.value),
            half_width: Some(half_width / a.value.hypot(b.value).max(f64::MIN_POSITIVE)),
            unit: "rad".into(),
        };
        [Some(amplitude), Some(period), order, Some(phase)]
            .into_iter()
            .flatten()
            .collect()
    }
}

/// The three wave numbers with the strongest projection of the residual, apart from each other.
fn strongest(motion: &Kinematics, setting: &Setting<'_>, from: f64, step: f64) -> Vec<f64> {
    let samples: Vec<(f64, f64, f64)> = (0..motion.len())
        .step_by(STRIDE)
        .filter(|at| motion.moving[*at])
        .map(|at| {
            (
                motion.position_lp[at],
                motion.velocity_lp[at].abs(),
                setting.residual.get(at).copied().unwrap_or(0.0),
            )
        })
        .collect();
    let mut speeds: Vec<f64> = samples.iter().map(|(_, v, _)| *v).collect();
    speeds.sort_by(f64::total_cmp);
    let Some(median) = speeds.get(speeds.len() / 2) else {
        return Vec::new();
    };
    let to = (60.0 / median).min(4000.0 * 1.0e-3 / setting.dataset.kind.moving_velocity());
    let count = ((to - from) / step).clamp(0.0, 20_000.0) as usize;
    let mut scored: Vec<(f64, f64)> = (0..count)
        .map(|i| from + step * i as f64)
        .map(|k| (projection(&samples, k), k))
        .collect();
    scored.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut best: Vec<f64> = Vec::new();
    for (_, k) in scored {
        if best.iter().all(|known| (known - k).abs() > 4.0 * step) {
            best.push(k);
        }
        if best.len() == 3 {
            break;
        }
    }
    best
}

/// Sum of squares that cosine and sine of a wave number take out of the residual.
fn projection(samples: &[(f64, f64, f64)], k: f64) -> f64 {
    let (mut cc, mut ss, mut cs, mut ce, mut se) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for (x, _, e) in samples.iter().filter(|(_, v, _)| v * k < FASTEST_HZ) {
        let (sin, cos) = (TAU * k * x).sin_cos();
        cc += cos * cos;
        ss += sin * sin;
        cs += cos * sin;
        ce += cos * e;
        se += sin * e;
    }
    let determinant = cc * ss - cs * cs;
    if determinant <= 1.0e-3 * cc * ss {
        0.0
    } else {
        (ce * ce * ss - 2.0 * ce * se * cs + se * se * cc) / determinant
    }
}
