//! How far the mass of a load that the effort tells is off because encoders count.
//!
//! The effort is `M·a1 + M2·(a2 − a1)`, and rounding of the positions is in a2 − a1. Where that of
//! the motor is a part ρ1 of the square and that of the scale ρ2, the fit gives the load
//! `M2·(1 − ρ1 − ρ2) + M·ρ1`: of an axis of 3 kg with a coarse motor encoder and a table of 0.8 kg
//! before a fine scale, 3.6 kg to the table.

use crate::evidence::force_noise::second_differences;
use crate::motion::kinematics::Kinematics;
use crate::record::dataset::Dataset;

/// Where rounding is more than this part of what is there, it is all of it.
const ALL: f64 = 0.99;

/// How far the load's mass may be off, of an axis with such a mass of which the fit gives so much
/// to the load. Rounding of the motor's position is in a1 too, which gives the load what the motor
/// has; that of the scale, or beside a measured velocity any, takes from the load.
pub(crate) fn off(dataset: &Dataset, motion: &Kinematics, [whole, load]: [f64; 2]) -> f64 {
    let Some(apart) = &motion.load_acceleration else {
        return 0.0;
    };
    let low_passed = motion.low_passed(apart);
    let rows = low_passed.iter().zip(&motion.fitted);
    let fitted = rows.filter_map(|(apart, is_fitted)| is_fitted.then_some(apart * apart));
    let (count, sum) = fitted.fold((0.0, 0.0), |(count, sum), square| {
        (count + 1.0, sum + square)
    });
    let rounding = count / 12.0 * second_differences(dataset, &motion.filter);
    let [motor, scale] =
        [dataset.resolution, dataset.load_resolution].map(|step| rounding * step.powi(2));
    let all = (motor + scale).min(ALL * sum);
    let is_in_both = dataset.train.velocity.is_none();
    let gives = if is_in_both { motor } else { 0.0 };
    let takes = motor + scale - gives;
    let share = |part: f64| all * part / (motor + scale);
    if all > 0.0 {
        ((whole - load).abs() * share(gives) + load.abs() * share(takes)) / (sum - all)
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evidence::findings::tests::Scene;
    use crate::evidence::force_noise::tests::noise;
    use crate::motion::derivatives::Derivatives;

    /// A load a constant way behind: what its acceleration differs by from the motor's is rounding,
    /// as much as the counts say, times a factor.
    fn off_by(times: f64, [motor_m, load_m]: [f64; 2], masses: [f64; 2]) -> f64 {
        let Scene {
            mut dataset,
            mut motion,
        } = Scene::behind(0.0);
        let mut dither = noise();
        (dataset.resolution, dataset.load_resolution) = (motor_m, load_m);
        let step = motor_m.hypot(load_m);
        let counted: Vec<f64> = (0..motion.len()).map(|_| times * step * dither()).collect();
        let derivatives = Derivatives::new(&counted, motion.period_s, dataset.hold);
        motion.load_acceleration = Some(derivatives.acceleration);
        off(&dataset, &motion, masses)
    }

    #[test]
    fn a_load_that_moves_with_the_motor_has_no_mass_of_its_own_to_tell() {
        let nothing_else = off_by(1.0, [1.0e-6, 0.0], [4.0, 3.0]);
        assert!(nothing_else > 5.0, "{nothing_else}");
    }

    #[test]
    fn counts_of_the_motor_give_the_load_what_the_motor_has_and_those_of_the_scale_take() {
        // A hundredth of the square is rounding.
        let near = |off_by: f64, wanted: f64| (off_by / wanted - 1.0).abs() < 0.2;
        let motor = off_by(10.0, [1.0e-6, 0.0], [1000.0, 800.0]);
        assert!(near(motor, 2.0), "{motor}");
        let scale = off_by(10.0, [0.0, 1.0e-6], [1000.0, 800.0]);
        assert!(near(scale, 8.0), "{scale}");
        assert_eq!(off_by(1.0, [0.0, 0.0], [1000.0, 800.0]), 0.0);
    }
}
