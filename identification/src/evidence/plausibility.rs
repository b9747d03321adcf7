//! Whether a dataset can be what it says: units off by a thousand, signs swapped, columns that
//! stand still or do not belong together.

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

type Outcome = Result<(), IdentificationError>;

/// Checks a dataset.
///
/// # Errors
/// What does not fit, and what it looks like.
pub(crate) fn check(dataset: &Dataset, motion: &Kinematics) -> Outcome {
    let name = &dataset.name;
    let refuse = |text: String| Err(IdentificationError::new(format!("{name}: {text}")));
    for (what, record) in [
        ("training", &dataset.train),
        ("validation", &dataset.validate),
    ] {
        check_position(dataset, what, record)?;
        check_followers(dataset, what, record)?;
    }
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
    if plain.inertia < 0.0 && inertia_share(motion, plain.inertia) > SMALLEST_INERTIA_SHARE {
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
            is_thousand(slope) && slope.abs() > STANDSTILL_SLOPE || slope < SWAPPED_REFERENCE
        } else {
            !LOAD_SLOPE.contains(&slope)
        };
        if wrong {
            let looks = match slope {
                slope if slope.abs() < STANDSTILL_SLOPE => "it stands still".to_owned(),
                slope if slope < 0.0 && slope > -2.0 => "its sign is swapped".to_owned(),
                slope if is_thousand(slope) => "its unit is off by a thousand".to_owned(),
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
