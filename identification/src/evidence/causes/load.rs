//! Motor and load: which of them drives, and whether both were read at one time.
//!
//! What stands between the two is pressed together by the force that it transmits. So motor − load
//! goes with the effort, never against it: the motor leads.

use crate::evidence::thresholds::FEWEST_COUNTS;
use crate::motion::kinematics::Kinematics;
use crate::record::dataset::Dataset;

/// Correlation of motor − load with the effort below which the load drives the motor. Chosen: of
/// twenty axes with two encoders none is below −0.1.
const SWAPPED: f64 = -0.5;
/// Longest shift that is tried, s.
const LONGEST_S: f64 = 0.05;
/// A shorter shift is that of a damper between the two, s.
const SHORTEST_S: f64 = 2.0e-3;
/// Largest error of a clock that is tried.
const LARGEST_RATE: f64 = 0.01;
/// Share of the variance of motor − load that may be left.
const LARGEST_REST: f64 = 0.1;
/// Step of the rows that are asked, s.
const APART_S: f64 = 5.0e-3;

/// What motor and load show of a record.
pub(crate) fn cause(dataset: &Dataset, motion: &Kinematics) -> Option<String> {
    let load = dataset.train.load.as_deref()?;
    let difference = motion.low_passed(motion.difference.as_deref()?);
    let rows: Vec<usize> = moving(motion);
    let count = dataset.resolution.max(dataset.load_resolution);
    let at = |values: &[f64]| -> Vec<f64> { rows.iter().map(|row| values[*row]).collect() };
    let (apart, effort) = (at(&difference), at(&motion.effort_lp));
    if scatter(&apart).sqrt() < FEWEST_COUNTS * count {
        return None;
    }
    let unit = dataset.kind.position_unit();
    let read = Read {
        motor: &dataset.train.position,
        load,
        rows: &rows,
        period_s: motion.period_s,
    };
    let is_swapped = correlation(&apart, &effort) < SWAPPED;
    let swapped = || {
        format!(
            "the load leads where the effort pushes; are position_{unit} and load_position_{unit} swapped?"
        )
    };
    read.shift(unit)
        .or_else(|| read.clock(unit))
        .or_else(|| is_swapped.then(swapped))
}

fn moving(motion: &Kinematics) -> Vec<usize> {
    let every = ((APART_S / motion.period_s).round() as usize).max(1);
    let rows = (0..motion.len()).step_by(every);
    rows.filter(|row| motion.moving[*row]).collect()
}

/// Both columns, and the rows that are asked.
struct Read<'a> {
    motor: &'a [f64],
    load: &'a [f64],
    rows: &'a [usize],
    period_s: f64,
}

impl Read<'_> {
    fn shift(&self, unit: &str) -> Option<String> {
        let rows = (LONGEST_S / self.period_s).round() as i32;
        let (shift, after) = self.best((-rows..=rows).map(f64::from), &|shift, _| shift)?;
        let time_s = self.period_s * shift;
        let side = if shift > 0.0 { "late" } else { "early" };
        let is_cause = after <= LARGEST_REST * self.left(&|_| 0.0) && time_s.abs() >= SHORTEST_S;
        is_cause.then(|| {
            format!(
                "load_position_{unit} is {:.0} rows {side} ({:.1} ms)",
                shift.abs(),
                1.0e3 * time_s.abs()
            )
        })
    }

    fn clock(&self, unit: &str) -> Option<String> {
        let steps = 200;
        let rates = (-steps..=steps).map(|at| LARGEST_RATE * f64::from(at) / f64::from(steps));
        let (rate, after) = self.best(rates, &|rate, row| rate * row as f64)?;
        let side = if rate > 0.0 { "slow" } else { "fast" };
        (after <= LARGEST_REST * self.left(&|_| 0.0) && rate != 0.0).then(|| {
            format!(
                "the clock of load_position_{unit} goes {:.2} % {side}",
                100.0 * rate.abs()
            )
        })
    }

    fn best(
        &self,
        numbers: impl Iterator<Item = f64>,
        later: &dyn Fn(f64, usize) -> f64,
    ) -> Option<(f64, f64)> {
        let left = numbers.map(|number| (number, self.left(&|row| later(number, row))));
        left.min_by(|one, other| one.1.total_cmp(&other.1))
    }

    /// Variance of motor − load, the load read so many rows later.
    fn left(&self, later: &dyn Fn(usize) -> f64) -> f64 {
        let apart = self.rows.iter().filter_map(|row| {
            let at = *row as f64 + later(*row);
            let (before, share) = (at.floor(), at - at.floor());
            let before = (before >= 0.0).then_some(before as usize)?;
            let (one, next) = (self.load.get(before)?, self.load.get(before + 1)?);
            Some(self.motor[*row] - (one + share * (next - one)))
        });
        scatter(&apart.collect::<Vec<f64>>())
    }
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

/// Mean square about the mean.
fn scatter(values: &[f64]) -> f64 {
    let middle = mean(values);
    let squares = values.iter().map(|value| (value - middle).powi(2));
    squares.sum::<f64>() / values.len().max(1) as f64
}

fn correlation(one: &[f64], other: &[f64]) -> f64 {
    let (a, b) = (mean(one), mean(other));
    let products = one.iter().zip(other).map(|(x, y)| (x - a) * (y - b));
    let cross = products.sum::<f64>() / one.len().max(1) as f64;
    cross
        / (scatter(one) * scatter(other))
            .sqrt()
            .max(f64::MIN_POSITIVE)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::made::{axis, on, usual};
    use crate::simulate::made;

    /// What is said of an axis whose load follows from the position of the motor and the effort.
    fn said(load: impl Fn(&[f64], &[f64], usize) -> f64) -> String {
        let usual_axis = axis(usual);
        let effort = usual_axis.dataset.train.effort.clone();
        let mut record = made::record(1.0e-3, made::two_sines(6000));
        let rows = 0..record.len();
        record.load = Some(
            rows.map(|row| load(&record.position, &effort, row))
                .collect(),
        );
        let mut both = on(record);
        both.put(|_, row| effort[row]);
        cause(&both.dataset, &both.motion).unwrap_or_default()
    }

    #[test]
    fn a_spring_between_motor_and_load_is_pressed_by_the_effort() {
        assert_eq!(said(|x, u, row| x[row] - 1.0e-7 * u[row]), "");
        assert!(said(|x, u, row| x[row] + 1.0e-7 * u[row]).contains("swapped"));
        assert_eq!(said(|x, _, row| x[row]), "");
    }

    #[test]
    fn a_load_that_is_read_at_another_time_is_told() {
        let late = said(|x, _, row| x[row.saturating_sub(5)]);
        assert!(late.contains("is 5 rows late (5.0 ms)"), "{late}");
        let early = said(|x, _, row| x[(row + 5).min(5999)]);
        assert!(early.contains("is 5 rows early"), "{early}");
        assert_eq!(said(|x, _, row| x[row.saturating_sub(1)]), "");
        let slow = said(|x, _, row| x[row - row / 200]);
        assert!(
            slow.starts_with("the clock of load_position_m goes 0.49 % slow"),
            "{slow}"
        );
    }

    #[test]
    fn correlation_is_one_of_deviations() {
        let one = [1.0, 2.0, 3.0];
        assert!((correlation(&one, &[10.0, 12.0, 14.0]) - 1.0).abs() < 1.0e-12);
        assert!((correlation(&one, &[3.0, 2.0, 1.0]) + 1.0).abs() < 1.0e-12);
        assert_eq!(correlation(&one, &[1.0, 1.0, 1.0]), 0.0);
    }
}
