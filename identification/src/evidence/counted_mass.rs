//! How far the mass of a load that the effort tells is off because encoders count.
//!
//! The effort is `M·a1 + M2·(a2 − a1)`, and rounding of the positions is in a2 − a1. Where it is a
//! part ρ of that, the fit gives the motor `(1 − ρ)·(M − M2)`, and the load the rest: of an axis of
//! 3 kg with a coarse motor encoder and a table of 0.8 kg before a fine scale, 3.6 kg to the table.

use crate::evidence::force_noise::second_differences;
use crate::motion::kinematics::Kinematics;
use crate::record::dataset::Dataset;

/// Where rounding is more than this part of what is there, it is all of it.
const ALL: f64 = 0.99;

/// How far the load's mass may be off, where the rest of the axis has such a mass by the fit.
pub(crate) fn off(dataset: &Dataset, motion: &Kinematics, rest: f64) -> f64 {
    let Some(apart) = &motion.load_acceleration else {
        return 0.0;
    };
    let low_passed = motion.low_passed(apart);
    let rows = low_passed.iter().zip(&motion.fitted);
    let fitted = rows.filter_map(|(apart, is_fitted)| is_fitted.then_some(apart * apart));
    let (count, sum) = fitted.fold((0.0, 0.0), |(count, sum), square| {
        (count + 1.0, sum + square)
    });
    let counts = dataset.resolution.powi(2) + dataset.load_resolution.powi(2);
    let rounding = counts / 12.0 * second_differences(dataset, &motion.filter);
    let part = (rounding * count / sum).min(ALL);
    if part.is_finite() {
        rest.abs() * part / (1.0 - part)
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evidence::findings::tests::Scene;

    /// A load a constant way behind: what its acceleration differs by from the motor's is rounding,
    /// as much as the counts say.
    #[test]
    fn a_load_that_moves_with_the_motor_has_no_mass_of_its_own_to_tell() {
        let scene = Scene::behind(0.0);
        let mut motion = scene.motion;
        let mut state = 1_u64;
        let mut dither = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            (state >> 33) as f64 / f64::from(1 << 31) - 0.5
        };
        let mut dataset = scene.dataset;
        (dataset.resolution, dataset.load_resolution) = (1.0e-6, 0.0);
        let counted: Vec<f64> = (0..motion.len()).map(|_| 1.0e-6 * dither()).collect();
        let hold = dataset.hold;
        let derivatives =
            crate::motion::derivatives::Derivatives::new(&counted, motion.period_s, hold);
        motion.load_acceleration = Some(derivatives.acceleration.clone());
        let off_by = off(&dataset, &motion, 1.0);
        assert!(off_by > 5.0, "{off_by}");
        motion.load_acceleration =
            Some(derivatives.acceleration.iter().map(|a| 10.0 * a).collect());
        let off_by = off(&dataset, &motion, 1.0);
        assert!((off_by / 0.01 - 1.0).abs() < 0.2, "{off_by}");
    }
}
