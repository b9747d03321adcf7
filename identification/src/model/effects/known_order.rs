//! A wave of few periods within the travel, at an integer order per revolution.
//!
//! The period of a wave that comes back once or twice cannot be found from the record: neighbouring
//! periods look alike, and so does any smooth function of the position. What a motor and its screw
//! do periodically they do a whole number of times per revolution, though (poles, slots, balls,
//! an eccentricity). So where the revolution is known these orders are candidates, with exactly
//! their wave number: it is known, not tuned.
//!
//! The name must be earned ([`crate::evidence::known_orders`]): such a wave must beat the smooth
//! functions of the position ([`Effect::smooth`]).

use super::by_motion::Others;
use super::{Action, Against, Effect, Fitted, Instant, Kinematics, Named, Naming, Setting, wave};
use crate::model::name::Called;
use crate::record::dataset::Dataset;

/// An effect that is a wave, at the orders that are known.
pub(crate) struct KnownOrder {
    /// The effect with a period that is found.
    pub of: &'static dyn Effect,
    /// From so many periods within the travel on, the period is found.
    pub below_periods: f64,
    /// The same with a polynomial in place of the wave.
    pub smooth: &'static dyn Effect,
    /// What a wave of the same period could also be.
    pub look_alikes: &'static [&'static dyn Effect],
}

impl Effect for KnownOrder {
    fn called(&self) -> Called {
        self.of.called()
    }

    fn equation(&self) -> &'static str {
        self.of.equation()
    }

    fn columns(&self, motion: &Kinematics, dataset: &Dataset, k: f64) -> Vec<Vec<f64>> {
        self.of.columns(motion, dataset, k)
    }

    fn columns_beside(
        &self,
        motion: &Kinematics,
        dataset: &Dataset,
        k: f64,
        others: &Others,
    ) -> Vec<Vec<f64>> {
        self.of.columns_beside(motion, dataset, k, others)
    }

    fn width(&self, k: f64) -> usize {
        self.of.width(k)
    }

    fn grid(&self, motion: &Kinematics, setting: &Setting<'_>) -> Vec<f64> {
        let fewest = if self.called().is_declared_in(setting.dataset) {
            wave::FEWEST_PERIODS_DECLARED
        } else {
            wave::FEWEST_PERIODS_OF_AN_ORDER
        };
        wave::of_orders(motion, setting.dataset, fewest..self.below_periods)
    }

    /// Two orders that are a period apart within the travel are two columns that are not alike.
    fn least_distance(&self, motion: &Kinematics) -> f64 {
        0.99 * wave::of_periods(motion, 1.0)
    }

    fn smooth(&self) -> Option<&'static dyn Effect> {
        Some(self.smooth)
    }

    fn look_alikes(&self) -> &'static [&'static dyn Effect] {
        self.look_alikes
    }

    fn is_physical(&self, fitted: &Fitted<'_>) -> bool {
        self.of.is_physical(fitted)
    }

    fn is_nearest_outsider(&self) -> bool {
        self.of.is_nearest_outsider()
    }

    fn acts_on_motor(&self) -> bool {
        self.of.acts_on_motor()
    }

    fn follows_load(&self) -> bool {
        self.of.follows_load()
    }

    fn repeats(&self) -> bool {
        self.of.repeats()
    }

    fn against(&self) -> Against {
        self.of.against()
    }

    fn action(&self, at: &Instant, k: f64, own: &[f64]) -> Action {
        self.of.action(at, k, own)
    }

    fn parameters(&self, naming: &Naming<'_>) -> Vec<Named> {
        self.of.parameters(naming)
    }
}
