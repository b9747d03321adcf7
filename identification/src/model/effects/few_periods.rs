//! A wave of few periods within the travel.
//!
//! The period of a wave that comes back once or twice cannot be found from the record: neighbouring
//! periods look alike, and so does any smooth function of the position. What a motor and its screw
//! do periodically they do a whole number of times per revolution, though (poles, slots, balls,
//! an eccentricity). So where the revolution is known these orders are candidates, with exactly
//! their wave number: it is known, not tuned. Where it is not known (the magnets of a linear
//! motor), the period is searched from three within the travel on.
//!
//! The name must be earned ([`mod@crate::evidence::few_periods`]): such a wave must beat the smooth
//! functions of the position ([`Effect::smooth`]).

use super::by_motion::Others;
use super::wave::{self, FEWEST_PERIODS_DECLARED, FEWEST_PERIODS_OF_AN_ORDER, Weight};
use super::{Action, Against, Effect, Fitted, Instant, Kinematics, Named, Naming, Setting};
use crate::model::name::Called;
use crate::record::dataset::Dataset;

/// A wave that is not declared comes back twice before its period is believed.
const FEWEST_SEARCHED: f64 = 3.0;

/// Where the wave numbers come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum WaveNumbers {
    /// Integer orders of a revolution that is known.
    KnownOrders,
    /// A search, where no revolution is known.
    Searched,
}

/// An effect that is a wave, with few periods within the travel.
pub(crate) struct FewPeriods {
    /// The effect with as many periods as tell themselves.
    pub of: &'static dyn Effect,
    /// From so many periods within the travel on, they do.
    pub below_periods: f64,
    /// Where its wave numbers come from.
    pub wave_numbers: WaveNumbers,
    /// The same with a polynomial in place of the wave.
    pub smooth: &'static dyn Effect,
    /// What a wave of the same period could also be.
    pub look_alikes: &'static [&'static dyn Effect],
}

impl Effect for FewPeriods {
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

    fn is_tuned(&self) -> bool {
        self.wave_numbers == WaveNumbers::Searched
    }

    fn grid(&self, motion: &Kinematics, setting: &Setting<'_>) -> Vec<f64> {
        let dataset = setting.dataset;
        let is_declared = self.called().is_declared_in(dataset);
        match self.wave_numbers {
            WaveNumbers::KnownOrders if is_declared => {
                wave::of_orders(motion, dataset, FEWEST_PERIODS_DECLARED..self.below_periods)
            }
            WaveNumbers::KnownOrders => wave::of_orders(
                motion,
                dataset,
                FEWEST_PERIODS_OF_AN_ORDER..self.below_periods,
            ),
            WaveNumbers::Searched if dataset.revolution().is_some() => Vec::new(),
            WaveNumbers::Searched => {
                let fewest = if is_declared {
                    FEWEST_PERIODS_OF_AN_ORDER
                } else {
                    FEWEST_SEARCHED
                };
                let shown = fewest..self.below_periods;
                wave::strongest(motion, setting, shown, |_| Weight::PLAIN)
            }
        }
    }

    fn first_step(&self, motion: &Kinematics, k: f64) -> f64 {
        match self.wave_numbers {
            WaveNumbers::KnownOrders => 0.0,
            WaveNumbers::Searched => self.of.first_step(motion, k),
        }
    }

    fn bounds(&self, motion: &Kinematics) -> (f64, f64) {
        let bounds = [FEWEST_PERIODS_OF_AN_ORDER, self.below_periods];
        let [least, most] = bounds.map(|periods| wave::of_periods(motion, periods));
        (least, most)
    }

    /// Two orders that are a period apart within the travel are two columns that are not alike.
    fn least_distance(&self, motion: &Kinematics) -> f64 {
        match self.wave_numbers {
            WaveNumbers::KnownOrders => 0.99 * wave::of_periods(motion, 1.0),
            WaveNumbers::Searched => self.of.least_distance(motion),
        }
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
