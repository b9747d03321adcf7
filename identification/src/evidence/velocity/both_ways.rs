//! The declared model with the derivative of the position and with the measured velocity: what each
//! leaves of the effort on held-out blocks of the training record.
//!
//! A jittered clock is fitted with a lower low-pass than that of the errors, because above it noise
//! of the acceleration makes a prediction worse than none. Beside a measured velocity that may be
//! otherwise, so both low-passes are asked. In the band between them a good acceleration explains
//! most of the effort. Noise of an acceleration adds to it.

use crate::evidence::thresholds::{FULL_BAND, VELOCITY_WORTH};
use crate::fit::bench::Bench;
use crate::fit::fitted::Fitted;
use crate::fit::tuning::{self, Pair};
use crate::model::inverse::Model;
use crate::motion::kinematics::Kinematics;
use crate::record::dataset::Dataset;
use crate::record::samples::Record;

/// What the declared model leaves, percent of the effort.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Left {
    /// With the derivative of the position.
    pub by_position: f64,
    /// With the measured velocity.
    pub by_velocity: f64,
}

/// The same with the low-pass of the errors, of a jittered clock.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Wide {
    left: Left,
    /// What the better source leaves in the band that this low-pass adds, over what the effort has
    /// there; mean squares.
    of_added: f64,
}

/// What is left with the low-pass of the fit and, where the clock jitters, with that of the errors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct BothWays {
    usual: Left,
    full: Option<Wide>,
}

impl Left {
    /// Whether the measured velocity leaves enough less.
    #[must_use]
    pub(crate) fn is_better_measured(self) -> bool {
        self.by_velocity <= VELOCITY_WORTH * self.by_position
    }
}

impl BothWays {
    /// Of a dataset whose records have an aligned velocity; `None` where the sample period leaves
    /// no room for the low-pass.
    #[must_use]
    pub(crate) fn of(dataset: &Dataset) -> Option<Self> {
        let sources = Sources::of(dataset)?;
        let wide = dataset.train.jittered.then(|| Wide::of(dataset, &sources));
        Some(Self {
            usual: sources.left(dataset),
            full: wide.flatten(),
        })
    }

    /// Whether a jittered clock spoils nothing with the low-pass of the errors.
    #[must_use]
    pub(crate) fn full_band(self) -> bool {
        self.full.is_some_and(|full| full.of_added <= FULL_BAND)
    }

    /// What is left with the low-pass that is taken.
    #[must_use]
    pub(crate) fn left(self) -> Left {
        let full = self.full.filter(|_| self.full_band());
        full.map_or(self.usual, |full| full.left)
    }
}

impl Wide {
    fn of(dataset: &Dataset, usual: &Sources) -> Option<Self> {
        let (train, validate) = (dataset.train.clone(), dataset.validate.clone());
        let dataset = &Dataset {
            full_band: true,
            ..dataset.with_records(train, validate)
        };
        let full = Sources::of(dataset)?;
        let left = full.left(dataset);
        let (full, usual) = if left.is_better_measured() {
            (&full.velocity, &usual.velocity)
        } else {
            (&full.position, &usual.position)
        };
        let of_added = full.of_added(dataset, &usual.motion);
        Some(Self { left, of_added })
    }
}

/// The motion of the training record from either source.
struct Sources {
    position: Motion,
    velocity: Motion,
}

impl Sources {
    fn of(dataset: &Dataset) -> Option<Self> {
        let measured = &dataset.train;
        let derived = Record {
            velocity: None,
            ..measured.clone()
        };
        let mut sources = Self {
            position: Motion::of(dataset, &derived)?,
            velocity: Motion::of(dataset, measured)?,
        };
        only_common(&mut sources.position.motion, &mut sources.velocity.motion);
        Some(sources)
    }

    fn left(&self, dataset: &Dataset) -> Left {
        Left {
            by_position: self.position.left(dataset),
            by_velocity: self.velocity.left(dataset),
        }
    }
}

/// Both are asked on the same samples.
fn only_common(one: &mut Kinematics, other: &mut Kinematics) {
    for (one, other) in one.fitted.iter_mut().zip(&mut other.fitted) {
        let both = *one && *other;
        (*one, *other) = (both, both);
    }
}

/// The motion of a record from one source, with the cut-off of the delay search beside it.
struct Motion {
    motion: Kinematics,
    low: Kinematics,
}

impl Motion {
    fn of(dataset: &Dataset, record: &Record) -> Option<Self> {
        let low_hz = tuning::delay_cutoff_hz(record.period_s);
        Some(Self {
            motion: Kinematics::new(dataset, record)?,
            low: Kinematics::with_cutoff(dataset, record, low_hz)?,
        })
    }

    /// The declared model, its nonlinear parameters fitted.
    fn declared(&self, dataset: &Dataset) -> Model {
        let [bench, low] = [&self.motion, &self.low].map(|motion| Bench::new(dataset, motion));
        let pair = Pair {
            bench: &bench,
            low: &low,
        };
        let mut model = Model::declared(dataset);
        tuning::prepare(pair, &mut model);
        model
    }

    /// What the declared model leaves on held-out blocks, percent.
    fn left(&self, dataset: &Dataset) -> f64 {
        let bench = Bench::new(dataset, &self.motion);
        let fit = bench.cross_validate(&self.declared(dataset));
        let left: f64 = fit.held_out.iter().sum();
        100.0 * (left / fit.total.max(f64::MIN_POSITIVE)).sqrt()
    }

    /// What the declared model leaves in the band that this low-pass has and a lower one has not,
    /// over what the effort has there; mean squares.
    fn of_added(&self, dataset: &Dataset, lower: &Kinematics) -> f64 {
        let fitted = Bench::new(dataset, &self.motion).fit(&self.declared(dataset));
        let [wide, narrow] =
            [&self.motion, lower].map(|motion| Signals::of(dataset, motion, &fitted));
        let rows = (0..self.motion.len()).filter(|row| self.motion.fitted[*row]);
        let sums = rows.fold([0.0; 2], |[left, there], row| {
            let effort = wide.effort[row] - narrow.effort[row];
            let predicted = wide.predicted[row] - narrow.predicted[row];
            [left + (effort - predicted).powi(2), there + effort * effort]
        });
        sums[0] / sums[1].max(f64::MIN_POSITIVE)
    }
}

/// Effort and its prediction through one low-pass.
struct Signals<'a> {
    effort: &'a [f64],
    predicted: Vec<f64>,
}

impl<'a> Signals<'a> {
    fn of(dataset: &Dataset, motion: &'a Kinematics, fitted: &Fitted) -> Self {
        Self {
            effort: &motion.effort_lp,
            predicted: Bench::new(dataset, motion).predict_lp(fitted),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn left(by_position: f64, by_velocity: f64) -> Left {
        Left {
            by_position,
            by_velocity,
        }
    }

    #[test]
    fn a_tenth_less_is_better_and_a_little_is_not() {
        assert!(left(4.0, 3.6).is_better_measured());
        assert!(!left(4.0, 3.61).is_better_measured());
    }

    #[test]
    fn the_low_pass_is_kept_where_half_of_the_wider_band_is_explained() {
        let ways = |of_added: Option<f64>| BothWays {
            usual: left(4.0, 3.9),
            full: of_added.map(|of_added| Wide {
                left: left(100.0, 8.0),
                of_added,
            }),
        };
        for (of_added, full_band) in [(None, false), (Some(0.51), false), (Some(0.5), true)] {
            let ways = ways(of_added);
            let wanted = if full_band {
                left(100.0, 8.0)
            } else {
                ways.usual
            };
            assert_eq!((ways.full_band(), ways.left()), (full_band, wanted));
        }
    }
}
