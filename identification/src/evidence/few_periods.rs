//! Whether waves of few periods have earned their name.
//!
//! A wave that comes back once or twice within the travel ([`FewPeriods`]) looks like any smooth
//! function of the position: a spring, a cable, a latch. What tells it from them is that it needs
//! two coefficients where they need many. So the waves of an effect that were found must together
//! beat, as an effect beats no effect, a polynomial that has as many turns within the travel as the
//! fastest of them, and two degrees more for each of them, or three where its period was searched.
//! A structure without a name over the position that is in the model is a part of any polynomial:
//! its columns do not count against it.
//!
//! Where they do not beat it, the selection is done again without few periods of this effect. What
//! the axis has over its position is then found without a name, or seen in the residual.
//!
//! Two degrees for each wave are what keeps latches, steps and random smooth curves out. What else
//! was tried stands in docs/design-history.md.
//!
//! [`FewPeriods`]: crate::model::effects::few_periods::FewPeriods

use crate::evidence::selection::is_enough;
use crate::evidence::thresholds::EFFORT_SHARE;
use crate::fit::bench::Bench;
use crate::fit::blocks::Gain;
use crate::model::effects::{Against, wave};
use crate::model::inverse::{Model, Origin, Part};
use crate::model::name::Called;
use crate::motion::kinematics::Kinematics;

/// Degrees of the polynomial for each wave: as many as it has columns.
const DEGREES_PER_WAVE: usize = 2;

/// An effect whose waves of few periods do not beat a smooth function of the position.
pub(crate) fn unearned(bench: &Bench<'_>, model: &Model) -> Option<Called> {
    let is_declared = |part: &Part| part.called().is_declared_in(bench.dataset);
    let mut found = model
        .parts
        .iter()
        .filter(|part| has_few(part) && !is_declared(part));
    let is_unearned = |part: &&Part| {
        let called = part.called();
        let waves = |part: &&Part| has_few(part) && part.called() == called;
        let waves: Vec<&Part> = model.parts.iter().filter(waves).collect();
        let rest = waves
            .iter()
            .fold(model.clone(), |rest, wave| rest.without(wave));
        let degree = degree(bench.motion, &waves, &rest);
        let smooth = part.effect.smooth();
        let smooth = smooth.map(|smooth| rest.with(Part::found(smooth, degree as f64)));
        smooth.is_some_and(|smooth| !beats_smooth(bench, model, &smooth))
    };
    found.find(is_unearned).map(Part::called)
}

/// Whether a model with waves beats one with a smooth function of the position: as an effect beats
/// no effect, and in the sample too. Where one block alone shows an end of the travel, a polynomial
/// that has not seen it is far off there, and that is no merit of the wave.
pub(crate) fn beats_smooth(bench: &Bench<'_>, model: &Model, smooth: &Model) -> bool {
    let [waves, smooth] = [model, smooth].map(|model| bench.cross_validate(model));
    is_enough(&Gain::of(&smooth, &waves)) && waves.sse <= (1.0 - EFFORT_SHARE) * smooth.sse
}

/// Whether a part was found with few periods.
fn has_few(part: &Part) -> bool {
    part.origin == Origin::Found && part.effect.smooth().is_some()
}

/// Degree of a polynomial with as many turns as a wave of so many periods within the travel, and
/// two more for each of so many waves.
#[must_use]
pub(crate) fn degree_beside(periods: f64, waves: usize) -> usize {
    let turns = 2.0 * periods;
    turns as usize + 1 + DEGREES_PER_WAVE * waves
}

/// Degree of the polynomial that waves must beat beside the rest of their model.
fn degree(motion: &Kinematics, waves: &[&Part], rest: &Model) -> usize {
    let periods = waves
        .iter()
        .map(|part| wave::periods(motion, part.parameter));
    let most = periods.fold(0.0, f64::max);
    let is_nameless =
        |part: &&Part| part.called().name().is_none() && part.effect.against() == Against::Position;
    let nameless = rest.parts.iter().filter(is_nameless);
    let covered: usize = nameless.map(Part::width).sum();
    let searched = waves.iter().filter(|part| part.effect.is_tuned()).count();
    degree_beside(most, waves.len()) + searched + covered
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::made::{Axis, axis, model, usual};
    use crate::model::effects::{Effect, find};
    use axis_model::EffectName::{self, Coulomb, Inertia, Offset, TorqueRipple, Viscous};
    use std::f64::consts::TAU;

    const DECLARED: [EffectName; 4] = [Inertia, Viscous, Coulomb, Offset];

    /// Wave number of so many periods within the travel.
    fn of(axis: &Axis, periods: f64) -> f64 {
        wave::of_periods(&axis.motion, periods)
    }

    fn known() -> &'static dyn Effect {
        find(TorqueRipple).unwrap().with_few_periods()[0]
    }

    /// Whether a wave of 2.6 periods has earned its name on an axis with a force over position.
    fn is_earned(force: impl Fn(f64) -> f64) -> bool {
        let (low, high) = axis(usual).motion.span();
        let u = |x: f64| (2.0 * x - low - high) / (high - low);
        let axis = axis(|motion, row| usual(motion, row) + 6.0 * force(u(motion.position_lp[row])));
        let found = model(&DECLARED).with(Part::found(known(), of(&axis, 2.6)));
        unearned(&axis.bench(), &found).is_none()
    }

    #[test]
    fn a_wave_earns_its_name_and_what_a_polynomial_is_as_well_does_not() {
        assert!(is_earned(|u| (0.5 * TAU * 2.6 * u + 0.4).sin()));
        for degree in 1..=6 {
            assert!(!is_earned(|u| u.powi(degree)), "{degree}");
        }
        assert!(!is_earned(|u| (3.0 * u).exp() / 20.0), "a cable");
        assert!(!is_earned(|u| (u - 0.3).max(0.0)), "a buffer");
    }

    #[test]
    fn the_polynomial_has_the_turns_of_the_fastest_wave_and_two_degrees_for_each() {
        let axis = axis(usual);
        let part = |periods| Part::found(known(), of(&axis, periods));
        let (slow, fast) = (part(1.35), part(5.8));
        let rest = model(&DECLARED);
        let degree = |waves: &[&Part], rest: &Model| degree(&axis.motion, waves, rest);
        assert_eq!(degree(&[&slow], &rest), 2 + 1 + 2);
        assert_eq!(degree(&[&slow, &fast], &rest), 11 + 1 + 4);
        let spring = find(Called::Structure("force over position")).unwrap();
        let rest = rest.with(Part::found(spring, 2.0));
        assert_eq!(degree(&[&slow], &rest), 2 + 1 + 2 + 2);
    }

    #[test]
    fn what_is_declared_and_what_was_searched_need_not_earn_a_name() {
        let axis = axis(usual);
        let declared = model(&DECLARED).with(Part::declared(known(), of(&axis, 2.0)));
        assert!(unearned(&axis.bench(), &declared).is_none());
        let searched = Part::found(find(TorqueRipple).unwrap(), of(&axis, 20.0));
        let searched = model(&DECLARED).with(searched);
        assert!(unearned(&axis.bench(), &searched).is_none());
    }
}
