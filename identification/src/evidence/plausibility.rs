//! Whether a dataset can be what it says: units off by a thousand, signs swapped, columns that
//! stand still or do not belong together, rows that no axis makes.
//!
//! Everything here refuses the record, with what it looks like. What only the fit can show is a
//! cause beside the verdict ([`crate::evidence::causes`]).

use crate::error::IdentificationError;
use crate::evidence::thresholds::{
    FASTEST_M_PER_S, LOAD_SLOPE, LONGEST_M, SMALLEST_INERTIA_SHARE, STANDSTILL_SLOPE,
    SWAPPED_EFFORT, SWAPPED_REFERENCE, THOUSAND,
};
use crate::fit::plain::Plain;
use crate::motion::kinematics::Kinematics;
use crate::record::dataset::Dataset;
use crate::record::samples::Record;
use crate::record::units::AxisKind;
use crate::simulate::controller::law::Law;

pub(crate) mod columns;
pub(crate) mod repeats;
pub(crate) mod steps;
pub(crate) mod stillness;

type Outcome = Result<(), IdentificationError>;

/// Checks the rows of both records, before anything is made of them.
///
/// # Errors
/// What does not fit, and what it looks like.
pub(crate) fn check_rows(dataset: &Dataset) -> Outcome {
    for (what, record) in [
        ("training", &dataset.train),
        ("validation", &dataset.validate),
    ] {
        let oddity = repeats::copy(record).or_else(|| columns::oddity(dataset, record));
        if let Some(oddity) = oddity {
            return Err(IdentificationError::new(format!(
                "{}: {what} record: {oddity}",
                dataset.name
            )));
        }
        check_position(dataset, what, record)?;
        check_followers(dataset, what, record)?;
    }
    Ok(())
}

/// Checks the training record with its motion.
///
/// # Errors
/// What does not fit, and what it looks like.
pub(crate) fn check(dataset: &Dataset, motion: &Kinematics) -> Outcome {
    let name = &dataset.name;
    let refuse = |text: String| Err(IdentificationError::new(format!("{name}: {text}")));
    if let Some(gain) = Law::effort_over_computed(dataset) {
        let column = dataset.effort.column();
        if gain < SWAPPED_EFFORT {
            return refuse(format!(
                "{column} has the other sign than the controller of dataset.toml gives ({gain:.3} times); swap the sign of {column} or of the positions"
            ));
        }
        if is_thousand(gain) {
            return refuse(format!(
                "{column} is {gain:.4} times what the controller of dataset.toml gives; check its unit, and that of the gains"
            ));
        }
    }
    let plain = Plain::fit(motion);
    if is_swapped(plain.inertia, inertia_share(motion, plain.inertia)) {
        return refuse(format!(
            "{} falls where the axis speeds up (inertia {:.4} {} s2/{}); swap its sign or that of the positions",
            dataset.effort.column(),
            plain.inertia,
            dataset.effort.unit(),
            dataset.kind.position_unit()
        ));
    }
    Ok(())
}

fn is_thousand(factor: f64) -> bool {
    let factor = factor.abs();
    let inside = |factor: f64| THOUSAND.contains(&factor);
    inside(factor) || inside(1.0 / factor.max(f64::MIN_POSITIVE))
}

/// Whether an inertia with a share of the effort says that the effort has the other sign.
fn is_swapped(inertia: f64, share: f64) -> bool {
    inertia < 0.0 && share > SMALLEST_INERTIA_SHARE
}

/// Share of the effort's mean square that the inertia force has.
fn inertia_share(motion: &Kinematics, inertia: f64) -> f64 {
    let acceleration = motion.low_passed(&motion.acceleration);
    let square = |values: &[f64], scale: f64| {
        let fitted = values
            .iter()
            .zip(&motion.fitted)
            .filter(|(_, fitted)| **fitted);
        fitted
            .map(|(value, _)| (scale * value).powi(2))
            .sum::<f64>()
    };
    square(&acceleration, inertia) / square(&motion.effort_lp, 1.0).max(f64::MIN_POSITIVE)
}

fn check_position(dataset: &Dataset, what: &str, record: &Record) -> Outcome {
    let unit = dataset.kind.position_unit();
    let (low, high) = crate::record::extent::range(&record.position);
    let fastest = record
        .position
        .windows(6)
        .map(|w| (w[5] - w[0]).abs())
        .fold(0.0, f64::max)
        / (5.0 * record.period_s);
    let refuse = |text: String| {
        Err(IdentificationError::new(format!(
            "{}: {what} record: {text}",
            dataset.name
        )))
    };
    if dataset.kind == AxisKind::Linear && (high - low > LONGEST_M || fastest > FASTEST_M_PER_S) {
        return refuse(format!(
            "position_{unit} spans {:.1} {unit} and moves at up to {fastest:.1} {unit}/s; is it in millimetres?",
            high - low
        ));
    }
    let smallest = smallest_step(&record.position);
    if dataset.resolution > 0.0
        && smallest.is_finite()
        && is_thousand(smallest / dataset.resolution)
        // A short record may move fast all the time.
        && (what == "training" || smallest < dataset.resolution)
        && !record.jittered
    {
        return refuse(format!(
            "the smallest step of position_{unit} is {smallest:.3e} {unit}, encoder_resolution_{unit} says {:.3e}; check the unit of both",
            dataset.resolution
        ));
    }
    Ok(())
}

fn smallest_step(values: &[f64]) -> f64 {
    let steps = values
        .windows(2)
        .map(|pair| (pair[1] - pair[0]).abs())
        .filter(|step| *step > 0.0);
    steps.fold(f64::INFINITY, f64::min)
}

/// Whether a factor is that between turns and radians.
fn is_turn(factor: f64) -> bool {
    let is = |factor: f64| (factor / std::f64::consts::TAU - 1.0).abs() < TURN;
    is(factor.abs()) || is(1.0 / factor.abs().max(f64::MIN_POSITIVE))
}

/// Whether a column is another one times a factor.
fn goes_with(x: &[f64], y: &[f64]) -> bool {
    columns::correlation(x, y).abs() > columns::SAME
}

/// How near a factor is to 2 pi: gears have whole teeth.
const TURN: f64 = 0.005;

/// Load position and setpoint must go with the motor.
fn check_followers(dataset: &Dataset, what: &str, record: &Record) -> Outcome {
    let unit = dataset.kind.position_unit();
    for (column, values) in [
        ("load_position", &record.load),
        ("reference", &record.reference),
    ] {
        let Some(values) = values else { continue };
        let slope = slope(&record.position, values);
        // A setpoint is not needed: only one in a wrong unit or direction is worth a refusal.
        let wrong = if column == "reference" {
            is_thousand(slope) && slope.abs() > STANDSTILL_SLOPE
                || slope < SWAPPED_REFERENCE
                || goes_with(&record.position, values) && !LOAD_SLOPE.contains(&slope)
        } else {
            !LOAD_SLOPE.contains(&slope)
        };
        if wrong {
            let looks = match slope {
                slope if slope.abs() < STANDSTILL_SLOPE => "it stands still".to_owned(),
                slope if slope < 0.0 && slope > -2.0 => "its sign is swapped".to_owned(),
                slope if is_thousand(slope) => "its unit is off by a thousand".to_owned(),
                slope if is_turn(slope) => "one is in turns, the other in radians".to_owned(),
                _ if goes_with(&record.position, values) => {
                    "it needs a scale: a gear ratio, or the lead".to_owned()
                }
                _ => "it belongs to another axis or needs a scale".to_owned(),
            };
            return Err(IdentificationError::new(format!(
                "{}: {what} record: {column}_{unit} moves {slope:.4} times as far as position_{unit}: {looks}",
                dataset.name
            )));
        }
    }
    Ok(())
}

/// Slope of a line through the origin of both means.
fn slope(x: &[f64], y: &[f64]) -> f64 {
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len().max(1) as f64;
    let (mx, my) = (mean(x), mean(y));
    let sums = x.iter().zip(y).fold((0.0, 0.0), |(xx, xy), (x, y)| {
        (xx + (x - mx).powi(2), xy + (x - mx) * (y - my))
    });
    sums.1 / f64::max(sums.0, f64::MIN_POSITIVE)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::made::{Axis, axis, on, usual};
    use crate::record::form::ControllerForm;
    use crate::simulate::made::{record, two_sines};

    fn refused(axis: &Axis) -> String {
        let mut dataset = axis.dataset.clone();
        dataset.validate.effort.clone_from(&dataset.train.effort);
        let checked = check_rows(&dataset).and_then(|()| check(&dataset, &axis.motion));
        checked
            .err()
            .map_or(String::new(), |error| error.to_string())
    }

    #[test]
    fn a_usual_axis_is_plausible() {
        assert_eq!(refused(&axis(usual)), "");
    }

    #[test]
    fn a_factor_of_about_a_thousand_is_a_unit_either_way_and_with_either_sign() {
        for (factor, wanted) in [
            (300.0, true),
            (299.0, false),
            (2999.0, true),
            (3001.0, false),
            (-1000.0, true),
            (1.0e-3, true),
            (1.0 / 290.0, false),
            (1.0, false),
            (0.0, false),
        ] {
            assert_eq!(is_thousand(factor), wanted, "{factor}");
        }
    }

    #[test]
    fn an_effort_against_the_acceleration_has_the_wrong_sign() {
        let swapped = refused(&axis(|motion, row| -usual(motion, row)));
        assert!(
            swapped.contains("force_n falls where the axis speeds up"),
            "{swapped}"
        );
        // An inertia that hardly takes part says nothing.
        let light = |motion: &Kinematics, row: usize| 25.0 - 0.5 * motion.acceleration[row];
        assert_eq!(refused(&axis(light)), "");
    }

    #[test]
    fn a_negative_inertia_counts_beyond_a_twentieth_of_the_effort() {
        assert!(is_swapped(-90.0, 0.051) && !is_swapped(-90.0, 0.05));
        assert!(!is_swapped(90.0, 0.9) && !is_swapped(0.0, 0.9));
    }

    #[test]
    fn both_records_are_asked() {
        let mut axis = axis(usual);
        axis.dataset.validate.reference = Some(axis.dataset.validate.position.clone());
        assert_eq!(refused(&axis), "");
        let swapped = axis.dataset.validate.position.iter().map(|x| -x).collect();
        axis.dataset.validate.reference = Some(swapped);
        let text = refused(&axis);
        assert!(
            text.contains("validation record: reference_m moves -1.0000 times"),
            "{text}"
        );
        axis.dataset.validate.reference = None;
        let far = axis.dataset.validate.position.iter().map(|x| 1.0e4 * x);
        axis.dataset.validate.position = far.collect();
        assert!(refused(&axis).contains("validation record: position_m spans"));
    }

    #[test]
    fn the_share_of_the_inertia_is_one_of_mean_squares() {
        let axis = axis(|motion, row| 90.0 * motion.acceleration[row]);
        assert!((inertia_share(&axis.motion, 90.0) - 1.0).abs() < 0.01);
        assert!((inertia_share(&axis.motion, -45.0) - 0.25).abs() < 0.01);
    }

    fn with_positions(scale: f64, change: impl FnOnce(&mut Axis)) -> String {
        let position = two_sines(3000).iter().map(|x| scale * x).collect();
        let mut axis = on(record(1.0e-3, position));
        axis.dataset.resolution = 0.0;
        change(&mut axis);
        check_position(&axis.dataset, "training", &axis.dataset.train)
            .err()
            .map_or(String::new(), |error| error.to_string())
    }

    #[test]
    fn a_linear_axis_that_is_too_long_or_too_fast_is_in_millimetres() {
        // 46 mm of travel, at most 0.1 m/s.
        assert_eq!(with_positions(450.0, |_| ()), "");
        let fast = with_positions(600.0, |_| ());
        assert!(fast.contains("is it in millimetres?"), "{fast}");
        let slow = |axis: &mut Axis| axis.dataset.train.period_s = 1.0;
        assert_eq!(with_positions(2000.0, slow), "");
        let long = with_positions(2400.0, |axis| axis.dataset.train.period_s = 1.0);
        assert!(long.contains("is it in millimetres?"), "{long}");
        let rotary = |axis: &mut Axis| axis.dataset.kind = AxisKind::Rotary;
        assert_eq!(with_positions(1.0e6, rotary), "");
    }

    #[test]
    fn a_resolution_that_is_a_thousand_times_the_smallest_step_is_in_another_unit() {
        let rounded = |resolution: f64, jittered: bool| {
            with_positions(1.0, |axis| {
                let count = 1.0e-6;
                let positions = &mut axis.dataset.train.position;
                for x in positions {
                    *x = (*x / count).round() * count;
                }
                axis.dataset.resolution = resolution;
                axis.dataset.train.jittered = jittered;
            })
        };
        assert_eq!(rounded(1.0e-6, false), "");
        assert!(rounded(1.0e-3, false).contains("check the unit of both"));
        assert!(rounded(1.0e-9, false).contains("check the unit of both"));
        assert_eq!(rounded(1.0e-9, true), "");
        assert_eq!(rounded(1.0e-5, false), "");
    }

    #[test]
    fn the_smallest_step_is_not_that_of_standstill() {
        assert_eq!(smallest_step(&[1.0, 1.0, 4.0, 3.5]), 0.5);
        assert_eq!(smallest_step(&[1.0, 1.0]), f64::INFINITY);
    }

    fn follower(scale: f64, is_load: bool) -> String {
        let mut axis = axis(usual);
        let train = &mut axis.dataset.train;
        let column = Some(train.position.iter().map(|x| 0.3 + scale * x).collect());
        if is_load {
            train.load = column;
        } else {
            train.reference = column;
        }
        check_followers(&axis.dataset, "training", &axis.dataset.train)
            .err()
            .map_or(String::new(), |error| error.to_string())
    }

    #[test]
    fn a_load_that_does_not_follow_is_refused_with_what_it_looks_like() {
        for (scale, looks) in [
            (1.0, ""),
            (0.81, ""),
            (1.24, ""),
            (0.79, "a gear ratio"),
            (1.26, "a gear ratio"),
            (-1.0, "its sign is swapped"),
            (-3.0, "a gear ratio"),
            (1000.0, "off by a thousand"),
            (0.0, "it stands still"),
        ] {
            let text = follower(scale, true);
            assert!(
                text.contains(looks) && text.is_empty() == looks.is_empty(),
                "{scale} {text}"
            );
        }
    }

    #[test]
    fn a_setpoint_in_a_wrong_unit_or_direction_is_refused() {
        for (scale, looks) in [
            (1.0, ""),
            (5.0, "a gear ratio"),
            (std::f64::consts::TAU, "in turns"),
            (-0.4, "its sign is swapped"),
            (0.0, ""),
            (-0.6, "its sign is swapped"),
            (1000.0, "off by a thousand"),
            (1.0e-3, "off by a thousand"),
        ] {
            let text = follower(scale, false);
            assert!(
                text.contains(looks) && text.is_empty() == looks.is_empty(),
                "{scale} {text}"
            );
        }
    }

    #[test]
    fn an_effort_that_its_controller_does_not_give_is_refused() {
        let with = |factor: f64| {
            let mut axis = axis(usual);
            axis.dataset.controller = Some(ControllerForm {
                position_gain_per_s: Some(40.0),
                velocity_gain_n_s_per_m: Some(1000.0),
                ..ControllerForm::default()
            });
            let train = &mut axis.dataset.train;
            let late: Vec<f64> = train.position.iter().map(|x| 1.01 * x).collect();
            let period_s = train.period_s;
            let velocity =
                |path: &[f64], row: usize| (path[row] - path[row.saturating_sub(1)]) / period_s;
            train.effort = (0..train.position.len())
                .map(|row| {
                    let error = 40.0 * (late[row] - train.position[row]);
                    let slower = velocity(&late, row) - velocity(&train.position, row);
                    factor * 1000.0 * (error + slower)
                })
                .collect();
            train.reference = Some(late);
            refused(&axis)
        };
        assert!(
            with(-1.0).contains("has the other sign than the controller"),
            "{}",
            with(-1.0)
        );
        assert!(with(1000.0).contains("check its unit, and that of the gains"));
        // The limits: a fifth of the other sign, three hundred times.
        assert!(with(-0.21).contains("has the other sign than the controller"));
        assert!(!with(-0.19).contains("controller"), "{}", with(-0.19));
        assert!(with(301.0).contains("check its unit, and that of the gains"));
        assert!(!with(299.0).contains("controller"), "{}", with(299.0));
        assert!(!with(1.0).contains("controller"), "{}", with(1.0));
    }

    #[test]
    fn a_slope_is_one_about_both_means() {
        assert!((slope(&[1.0, 2.0, 3.0], &[10.0, 12.0, 14.0]) - 2.0).abs() < 1.0e-12);
        assert!((slope(&[5.0, 7.0], &[1.0, 0.0]) + 0.5).abs() < 1.0e-12);
        assert_eq!(slope(&[5.0, 5.0], &[1.0, 0.0]), 0.0);
    }
}
