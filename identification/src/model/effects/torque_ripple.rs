//! Torque ripple: a force periodic in motor position, `a cos(2π k x) + b sin(2π k x)`.
//!
//! The period is searched, so the lead need not be known; where it is, the order per revolution is
//! reported. Fewer periods within the travel than tell themselves must earn the name
//! ([`FewPeriods`]): cogging on half a turn, the magnets of a short linear motor.

use std::ops::Range;

use axis_model::EffectName;

use super::few_periods::{FewPeriods, WaveNumbers};
use super::spring::SmoothForce;
use super::wave::{self, Names, Weight};
use super::{Action, Against, Effect, Instant, Kinematics, Named, Naming, Setting};
use crate::model::name::Called;
use crate::record::dataset::Dataset;

/// Cosine and sine of position.
pub(crate) struct TorqueRipple;

/// At least so many periods within the travel: fewer may be position dependence.
const FEWEST_PERIODS: f64 = 8.0;

const fn few_periods(wave_numbers: WaveNumbers) -> FewPeriods {
    FewPeriods {
        of: &TorqueRipple,
        below_periods: FEWEST_PERIODS,
        wave_numbers,
        smooth: &SmoothForce,
        look_alikes: &[],
    }
}

static WITH_FEW_PERIODS: [&dyn Effect; 2] = [
    &const { few_periods(WaveNumbers::KnownOrders) },
    &const { few_periods(WaveNumbers::Searched) },
];

impl Effect for TorqueRipple {
    fn called(&self) -> Called {
        EffectName::TorqueRipple.into()
    }

    fn equation(&self) -> &'static str {
        "a cos(2 pi k x) + b sin(2 pi k x)"
    }

    fn columns(&self, motion: &Kinematics, _: &Dataset, k: f64) -> Vec<Vec<f64>> {
        wave::columns(motion, k, |_| Weight::PLAIN)
    }

    fn width(&self, _: f64) -> usize {
        2
    }

    fn is_tuned(&self) -> bool {
        true
    }

    fn with_few_periods(&self) -> &'static [&'static dyn Effect] {
        &WITH_FEW_PERIODS
    }

    fn acts_on_motor(&self) -> bool {
        true
    }

    fn against(&self) -> Against {
        Against::Period
    }

    fn action(&self, at: &Instant, k: f64, own: &[f64]) -> Action {
        Action::force(wave::value(own, k, at.position))
    }

    fn start(&self, dataset: &Dataset) -> f64 {
        dataset.lead_m_per_rev.map_or(100.0, |lead| 1.0 / lead)
    }

    fn least_distance(&self, motion: &Kinematics) -> f64 {
        wave::of_periods(motion, 2.0)
    }

    fn grid(&self, motion: &Kinematics, setting: &Setting<'_>) -> Vec<f64> {
        self.strongest(motion, setting, FEWEST_PERIODS..f64::INFINITY)
    }

    fn strongest(
        &self,
        motion: &Kinematics,
        setting: &Setting<'_>,
        periods: Range<f64>,
    ) -> Vec<f64> {
        wave::strongest(motion, setting, periods, |_| Weight::PLAIN)
    }

    fn first_step(&self, motion: &Kinematics, _: f64) -> f64 {
        wave::of_periods(motion, 0.05)
    }

    fn bounds(&self, motion: &Kinematics) -> (f64, f64) {
        (wave::of_periods(motion, FEWEST_PERIODS), f64::MAX)
    }

    fn repeats(&self) -> bool {
        true
    }

    fn parameters(&self, naming: &Naming<'_>) -> Vec<Named> {
        let names = Names {
            amplitude: "torque_ripple_amplitude",
            rest: "torque_ripple",
        };
        wave::named(naming, &names, naming.effort_unit(""))
    }
}
