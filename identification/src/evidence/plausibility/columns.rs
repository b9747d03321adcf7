//! Which column is which: each has a habit of its own.
//!
//! A measured position follows its setpoint and stands on the counts of its encoder. An effort does
//! neither.

use crate::evidence::plausibility::{steps, stillness};
use crate::record::dataset::Dataset;
use crate::record::extent::{range, smallest_step};
use crate::record::samples::Record;

/// Correlation from which two columns are one thing in two units.
pub(crate) const SAME: f64 = 0.99;
/// Correlation below which a setpoint is not that of the axis. Servos that follow have 0.999.
const STRANGER: f64 = 0.5;
/// Share of the travel that a setpoint makes before it can be asked.
const MOVES: f64 = 0.05;
/// A column is finer than its encoder where its smallest step is below this share of a count.
const FINER: f64 = 0.2;
/// A smallest step is that of an encoder within this factor.
const SAME_COUNT: std::ops::Range<f64> = 0.5..2.0;

/// What is odd about a record's columns, in words.
pub(crate) fn oddity(dataset: &Dataset, record: &Record) -> Option<String> {
    let columns = Columns::of(dataset, record);
    columns
        .with_effort_swapped()
        .or_else(|| columns.without_counts())
        .or_else(|| columns.odd_steps())
        .or_else(|| columns.frozen())
        .or_else(|| columns.held_effort())
        .or_else(|| columns.strange_setpoint())
}

struct Columns<'a> {
    dataset: &'a Dataset,
    record: &'a Record,
    position: String,
    load: String,
    reference: String,
}

impl<'a> Columns<'a> {
    fn of(dataset: &'a Dataset, record: &'a Record) -> Self {
        let unit = dataset.kind.position_unit();
        Self {
            dataset,
            record,
            position: format!("position_{unit}"),
            load: format!("load_position_{unit}"),
            reference: format!("reference_{unit}"),
        }
    }

    /// Measured positions with their names and counts.
    fn measured(&self) -> Vec<(&str, &[f64], f64)> {
        let motor = (
            &*self.position,
            &*self.record.position,
            self.dataset.resolution,
        );
        let load = self.record.load.as_deref();
        let load = load.map(|load| (&*self.load, load, self.dataset.load_resolution));
        std::iter::once(motor).chain(load).collect()
    }

    /// An effort in place of a position: what does not follow is followed by the effort's column.
    fn with_effort_swapped(&self) -> Option<String> {
        let (position, effort) = (&self.record.position, &self.record.effort);
        let load = self.record.load.as_ref().map(|load| (&self.load, load));
        let setpoint = self
            .record
            .reference
            .as_ref()
            .map(|path| (&self.reference, path));
        let column = self.dataset.effort.column();
        setpoint.into_iter().chain(load).find_map(|(name, values)| {
            if !moves(values) || correlation(position, values).abs() > STRANGER {
                return None;
            }
            let swapped = if correlation(effort, values) > SAME {
                &self.position
            } else if correlation(effort, position) > SAME {
                name
            } else {
                return None;
            };
            Some(format!("{column} goes with the positions and {swapped} does not; are the two columns swapped?"))
        })
    }

    /// A position without counts beside a setpoint that has them.
    fn without_counts(&self) -> Option<String> {
        let reference = self.record.reference.as_deref()?;
        let set = smallest_step(reference);
        self.measured().into_iter().find_map(|(name, values, count)| {
            let step = smallest_step(values);
            let is_smooth = step > 0.0 && step < FINER * count;
            let is_swapped = is_smooth && SAME_COUNT.contains(&(set / count)) && !self.record.jittered;
            is_swapped.then(|| {
                format!("{name} is finer than its encoder ({step:.1e} where a count is {count:.1e}) and {} has its counts; are the two columns swapped?", self.reference)
            })
        })
    }

    fn frozen(&self) -> Option<String> {
        let period_s = self.record.period_s;
        let words = |name: &str, from_s: f64| {
            format!("{name} stands still from {from_s:.1} s on while the axis moves")
        };
        let load = self.record.load.as_deref();
        let others = [
            load,
            self.record.reference.as_deref(),
            Some(&*self.record.position),
        ];
        let said = |name: &str, values: &[f64]| {
            let froze = |other: &&[f64]| stillness::frozen_from(values, other, period_s);
            let from_s = others.iter().flatten().find_map(froze)?;
            Some(words(name, from_s))
        };
        let mut measured = self.measured().into_iter();
        let (effort, column) = (&self.record.effort, self.dataset.effort.column());
        let is_at_limit = stillness::is_longest_at_an_end(effort);
        let froze = stillness::frozen_effort_from(effort, &self.record.position, period_s);
        let effort = froze.filter(|_| !is_at_limit);
        let effort = effort.map(|from_s| words(column, from_s));
        effort.or_else(|| measured.find_map(|(name, values, _)| said(name, values)))
    }

    fn odd_steps(&self) -> Option<String> {
        if self.record.jittered {
            return None;
        }
        self.measured()
            .into_iter()
            .find_map(|(name, values, count)| {
                steps::oddity(values, count).map(|oddity| format!("{name} {oddity}"))
            })
    }

    fn held_effort(&self) -> Option<String> {
        let rows = stillness::held_rows(&self.record.effort, self.record.period_s)?;
        Some(format!(
            "{} is held: it changes at every {rows}th row only; record it at the rate of the rows",
            self.dataset.effort.column()
        ))
    }

    fn strange_setpoint(&self) -> Option<String> {
        let reference = self.record.reference.as_deref()?;
        let position = &self.record.position;
        let travel = |values: &[f64]| {
            let (low, high) = range(values);
            high - low
        };
        let is_asked = travel(reference) > MOVES * travel(position);
        let follows = correlation(position, reference).abs();
        (is_asked && follows < STRANGER).then(|| {
            format!(
                "{} does not follow {} (correlation {follows:.2}); is one of them another axis' or another run's?",
                self.position, self.reference
            )
        })
    }
}

fn moves(values: &[f64]) -> bool {
    let (low, high) = range(values);
    high > low
}

/// Correlation of two columns; zero where one of them does not change.
pub(crate) fn correlation(x: &[f64], y: &[f64]) -> f64 {
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len().max(1) as f64;
    let (mx, my) = (mean(x), mean(y));
    let sums = x.iter().zip(y).fold([0.0; 3], |[xx, yy, xy], (x, y)| {
        let (x, y) = (x - mx, y - my);
        [xx + x * x, yy + y * y, xy + x * y]
    });
    sums[2] / (sums[0] * sums[1]).sqrt().max(f64::MIN_POSITIVE)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::made::axis;

    /// What is said of an axis of friction with a setpoint and a load, changed.
    fn said(change: impl Fn(&mut Dataset)) -> String {
        let mut dataset = axis(|motion, row| 900.0 * motion.velocity[row]).dataset;
        let position = dataset.train.position.clone();
        let rounded = |x: &f64| 1.0e-7 * (x / 1.0e-7).round();
        let late = (0..position.len()).map(|row| position[row.saturating_sub(2)]);
        dataset.train.reference = Some(position.clone());
        dataset.train.load = Some(late.clone().map(|x| rounded(&x)).collect());
        dataset.train.position = late.map(|x| rounded(&x)).collect();
        (dataset.resolution, dataset.load_resolution) = (1.0e-7, 1.0e-7);
        change(&mut dataset);
        oddity(&dataset, &dataset.train).unwrap_or_default()
    }

    fn swap(one: &mut Vec<f64>, other: &mut Option<Vec<f64>>) {
        std::mem::swap(one, other.as_mut().unwrap());
    }

    #[test]
    fn an_axis_as_it_should_be_is_not_odd() {
        assert_eq!(said(|_| ()), "");
    }

    #[test]
    fn swapped_columns_are_told() {
        let with_effort = said(|d| std::mem::swap(&mut d.train.position, &mut d.train.effort));
        assert!(
            with_effort.contains("position_m does not; are the two columns swapped"),
            "{with_effort}"
        );
        let reference = said(|d| swap(&mut d.train.effort, &mut d.train.reference));
        assert!(
            reference.contains("reference_m does not; are the two columns swapped"),
            "{reference}"
        );
        let setpoint = said(|d| swap(&mut d.train.position, &mut d.train.reference));
        assert!(
            setpoint.starts_with("position_m is finer than its encoder"),
            "{setpoint}"
        );
        let load = said(|d| {
            let reference = d.train.reference.take();
            d.train.reference = std::mem::replace(&mut d.train.load, reference);
        });
        assert!(load.starts_with("load_position_m is finer"), "{load}");
    }

    #[test]
    fn a_setpoint_of_another_axis_is_told_and_one_at_rest_is_not() {
        let other = said(|d| {
            let other = (0..6000).map(|row| 0.02 * (0.0071 * f64::from(row)).sin());
            d.train.reference = Some(other.collect());
        });
        assert!(other.contains("does not follow reference_m"), "{other}");
        assert_eq!(said(|d| d.train.reference = Some(vec![0.0; 6000])), "");
    }

    #[test]
    fn columns_that_stand_still_or_are_held_are_told() {
        let still = said(|d| {
            let effort = &mut d.train.effort[3000..];
            effort.fill(1.0);
        });
        assert!(
            still.starts_with("force_n stands still from 3.0 s on"),
            "{still}"
        );
        let load = said(|d| {
            let load = d.train.load.as_mut().unwrap();
            let stuck = load[3000];
            load[3000..].fill(stuck);
        });
        assert!(load.starts_with("load_position_m stands still"), "{load}");
        let held = said(|d| {
            let old = d.train.effort.clone();
            (0..6000).for_each(|row| d.train.effort[row] = old[row - row % 50]);
        });
        assert!(
            held.starts_with("force_n is held: it changes at every 50th row"),
            "{held}"
        );
    }
}
