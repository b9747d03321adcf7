//! Which form an effect has: the exponent of a Stribeck fall, the curve of friction over position.
//!
//! The usual form stays unless another one beats it as an effect beats no effect ([`is_enough`]). A
//! fall of another exponent would leave something that looks like drag, asymmetry or a drift, and
//! one that is not the same both ways what looks like friction of another law.

use crate::evidence::selection::{is_enough, is_large_outside};
use crate::fit::bench::Bench;
use crate::fit::blocks::Gain;
use crate::fit::fitted::Searched;
use crate::fit::search::smallest;
use crate::fit::told;
use crate::fit::tuning::{self, Pair};
use crate::model::effects::{self, Effect, Setting};
use crate::model::inverse::{Model, Part};
use axis_model::EffectName;

/// More coefficients than these are a curve.
const MOST_COEFFICIENTS: usize = 2;

/// So often a growth is taken from the level that it leaves.
const GROWN: usize = 2;

/// Whether a model beats another as an effect beats no effect.
#[must_use]
pub(crate) fn beats(bench: &Bench<'_>, model: &Model, other: &Model) -> bool {
    is_enough(&gain(bench, model, other))
}

/// Gain of a model over another.
#[must_use]
pub(crate) fn gain(bench: &Bench<'_>, model: &Model, other: &Model) -> Gain {
    Gain::of(&bench.cross_validate(other), &bench.cross_validate(model))
}

/// The model refined, each part in the form that the record asks for. The form of what follows the
/// load is a matter of what it follows, and the other way round: where it is not the usual one,
/// both are asked once more.
#[must_use]
pub(crate) fn refined(pair: Pair<'_>, mut model: Model) -> Model {
    tuning::refine(pair, &mut model);
    let mut model = chosen(pair, model);
    if told::is_close(&model) {
        tuning::refine(pair, &mut model);
        model = chosen(pair, model);
    }
    model
}

/// The model, each part in the form that the record asks for.
#[must_use]
fn chosen(pair: Pair<'_>, mut model: Model) -> Model {
    for place in 0..model.parts.len() {
        let called = model.parts[place].called();
        let has_forms =
            |usual: &&dyn Effect| !usual.forms().is_empty() || usual.by_direction().is_some();
        if let Some(usual) = effects::find(called).filter(has_forms) {
            model = of_part(pair, model, place, usual);
        }
        model = with_best_choice(pair.bench, model, place);
    }
    model
}

/// The model with the choice of a part that the held-out error asks for. That is the best of those
/// with one or two coefficients, unless one with more of them beats it, and removes as much as a
/// nearest outsider has to: such a curve can be anything. What repeats chooses where, not how much.
fn with_best_choice(bench: &Bench<'_>, model: Model, place: usize) -> Model {
    let effect = model.parts[place].effect;
    if effect.is_tuned() || effect.repeats() {
        return model;
    }
    let setting = Setting {
        dataset: bench.dataset,
        residual: &[],
    };
    let choices = effect.grid(bench.motion, &setting);
    if choices.len() < 2 {
        return model;
    }
    let choices = choices.into_iter();
    let (plain, curves): (Vec<f64>, Vec<f64>) =
        choices.partition(|choice| effect.width(*choice) <= MOST_COEFFICIENTS);
    let with = |choice: f64| told::of_the_others(bench, model.with_parameter(place, choice));
    let error = |choice: f64| bench.cross_validate(&with(choice)).held_out.iter().sum();
    let Some(plain) = smallest(&plain, &error) else {
        return model;
    };
    curves
        .into_iter()
        .map(with)
        .fold(with(plain), |best, curve| {
            let gain = gain(bench, &curve, &best);
            if is_enough(&gain) && is_large_outside(&gain) {
                curve
            } else {
                best
            }
        })
}

/// The model with one of its parts in the form that the record asks for.
fn of_part(pair: Pair<'_>, model: Model, place: usize, usual: &'static dyn Effect) -> Model {
    let part = &model.parts[place];
    let plain = if part.is_same(&Part {
        effect: usual,
        ..part.clone()
    }) {
        model
    } else {
        tuning::refined_at(pair, model.with_form(place, usual), place)
    };
    let at_once = shaped(pair, plain.clone(), place);
    let lagging = curved(pair, plain, place, Searched::Lag);
    if lagging.parts[place].effect.lag_s() == 0.0 {
        return at_once;
    }
    // The lag is searched once more beside the form that it leaves.
    let lagging = curved(pair, shaped(pair, lagging, place), place, Searched::Lag);
    let lagging = with_the_level(pair, lagging, place);
    if beats(pair.bench, &lagging, &at_once) {
        lagging
    } else {
        at_once
    }
}

/// The model with a lag that goes with the level, as with generalised Maxwell slip, where that
/// leaves less on held-out blocks than one that is the same at all velocities. Either has one
/// parameter, so that neither has to beat the other.
fn with_the_level(pair: Pair<'_>, same: Model, place: usize) -> Model {
    let grown = |model: &Model| {
        let fitted = pair.bench.fit(model);
        let coulomb = fitted.of(EffectName::Coulomb)?.first().copied()?;
        let excess = fitted.terms().nth(place)?.own.first().copied()?;
        model.parts[place].effect.lag_growing(excess / coulomb)
    };
    let mut growing = same.clone();
    for _ in 0..GROWN {
        let Some(effect) = grown(&growing) else {
            return same;
        };
        if effect.lag_growth() == growing.parts[place].effect.lag_growth() {
            break;
        }
        let other = growing.with_form(place, effect);
        growing = tuning::reshaped(pair, &other, place, Searched::Lag);
    }
    let still_lags = growing.parts[place].effect.lag_s() > 0.0;
    if still_lags && gain(pair.bench, &growing, &same).share > 0.0 {
        growing
    } else {
        same
    }
}

/// The model with a part in the curve that the record asks for, and with a size for each direction
/// where it asks for that.
fn shaped(pair: Pair<'_>, plain: Model, place: usize) -> Model {
    let shaped = curved(pair, plain, place, Searched::Form);
    let Some(by_direction) = shaped.parts[place].effect.by_direction() else {
        return shaped;
    };
    let two_sizes = shaped.with_form(place, by_direction);
    if beats(pair.bench, &two_sizes, &shaped) {
        let refined = tuning::refined_at(pair, two_sizes, place);
        curved(pair, refined, place, Searched::Form)
    } else {
        shaped
    }
}

/// The model with another curve (or another lag) of a part, where that beats the one it has.
fn curved(pair: Pair<'_>, model: Model, place: usize, what: Searched) -> Model {
    let bench = pair.bench;
    if what.choices(model.parts[place].effect).is_empty() {
        return model;
    }
    let before = bench.cross_validate(&model);
    let about = bench.cross_validate_about(&bench.fit(&model), place, what);
    if !is_enough(&Gain::of(&before, &about)) {
        return model;
    }
    let other = tuning::reshaped(pair, &model, place, what);
    if is_enough(&Gain::of(&before, &bench.cross_validate(&other))) {
        other
    } else {
        model
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::made::{Axis, axis, found, model, usual};
    use axis_model::EffectName::{
        Coulomb, FrictionDrift, Inertia, LoadDependentFriction, Offset, PositionDependentFriction,
        Stribeck, Viscous,
    };

    /// An axis with a fall of 15 N over 10 mm/s by an exponent, and `by_direction` of it the other
    /// size against negative motion.
    fn falling(exponent: f64, by_direction: f64) -> Axis {
        axis(|motion, row| {
            let fall = (-(motion.velocity[row] / 0.01).abs().powf(exponent)).exp();
            let direction = motion.direction[row];
            usual(motion, row) + 15.0 * fall * direction * (1.0 + by_direction * direction)
        })
    }

    /// The fall in the form that the record asks for, with its estimate.
    fn form(axis: &Axis) -> crate::fit::fitted::Estimate {
        let bench = axis.bench();
        let pair = Pair {
            bench: &bench,
            low: &bench,
        };
        let usual = model(&[Inertia, Viscous, Coulomb, Offset]);
        let start = usual.with(found(Stribeck, 0.01));
        let model = chosen(pair, tuning::refined_at(pair, start, 4));
        bench.estimates(&bench.fit(&model)).remove(4)
    }

    #[test]
    fn an_exponent_is_found_with_an_interval_that_holds_it() {
        for exponent in [0.5, 0.7, 1.0, 1.3] {
            let found = form(&falling(exponent, 0.0));
            let half = found.form_half_width.expect("it is not the usual form");
            let off = (found.part.effect.form() - exponent).abs();
            assert!(
                off <= half.max(0.025) && half < 0.3,
                "{exponent}: {off} ± {half}"
            );
            assert_eq!(found.own.len(), 1, "{exponent}");
        }
    }

    /// An axis with a fall of 15 N over 10 mm/s that lags by a time, so much longer at rest.
    fn lagging(exponent: f64, lag_s: f64, growth: f64) -> Axis {
        let mut axis = axis(usual);
        let motion = &axis.motion;
        let steady = |row: usize| (-(motion.velocity[row] / 0.01).abs().powf(exponent)).exp();
        let mut left = 1.0;
        let falls: Vec<f64> = (0..motion.len())
            .map(|row| {
                // Over the row that has gone by it is the mean of both ends.
                let goes_to = 0.5 * (steady(row.saturating_sub(1)) + steady(row));
                let lag_s = lag_s * (1.0 + growth * goes_to);
                left += -(-motion.period_s / lag_s).exp_m1() * (goes_to - left);
                left
            })
            .collect();
        axis.put(|motion, row| usual(motion, row) + 15.0 * falls[row] * motion.direction[row]);
        axis
    }

    #[test]
    fn a_fall_that_lags_is_found_with_an_interval_that_holds_its_lag() {
        for (exponent, lag_s) in [(2.0, 4.0e-3), (1.0, 4.0e-3), (2.0, 20.0e-3)] {
            let found = form(&lagging(exponent, lag_s, 0.0));
            let half = found.lag_half_width.expect("it lags");
            let off = (found.part.effect.lag_s() - lag_s).abs();
            assert!(
                off <= half.max(0.1 * lag_s) && half < 0.5 * lag_s,
                "{exponent} {lag_s}: {off} ± {half}"
            );
        }
    }

    #[test]
    fn a_lag_that_goes_with_the_level_is_told_from_one_that_does_not() {
        // 15 N above 25 N: the nearest growth on the grid is 5 % off.
        for (lag_s, growth) in [(4.0e-3, 0.0), (4.0e-3, 0.6), (20.0e-3, 0.6)] {
            let found = form(&lagging(2.0, lag_s, growth));
            let effect = found.part.effect;
            let off = (effect.lag_s() - lag_s).abs();
            assert!(
                off < 0.06 * lag_s,
                "{growth}: {} for {lag_s}",
                effect.lag_s()
            );
            let told = effect.lag_growth();
            assert!(
                (told - growth).abs() < 0.13 * growth.max(1.0e-3),
                "{told} for {growth}"
            );
        }
    }

    #[test]
    fn a_gaussian_fall_stays_the_usual_one() {
        let found = form(&falling(2.0, 0.0));
        assert!(!found.part.is_reshaped());
        assert_eq!((found.form_half_width, found.own.len()), (None, 1));
    }

    #[test]
    fn a_fall_that_differs_by_direction_has_a_size_for_each() {
        for exponent in [1.0, 2.0] {
            let found = form(&falling(exponent, 0.25));
            let off = (found.part.effect.form() - exponent).abs();
            assert!(off <= 0.05, "{exponent}: {off}");
            let sizes = found.own.iter().zip([15.0, 0.25 * 15.0]);
            for ((value, half), wanted) in sizes {
                assert!(
                    (value - wanted).abs() < half.max(0.02 * wanted),
                    "{value} ± {half}"
                );
            }
            assert_eq!(found.own.len(), 2);
        }
    }

    #[test]
    fn friction_that_drifts_differs_by_direction_where_its_level_does() {
        let sizes = |by_direction: f64| {
            let axis = axis(|motion, row| {
                let fall = (-motion.time_s[row] / 2.0).exp();
                let direction = motion.direction[row];
                usual(motion, row) + 15.0 * fall * direction * (1.0 + by_direction * direction)
            });
            let bench = axis.bench();
            let pair = Pair {
                bench: &bench,
                low: &bench,
            };
            let usual = model(&[Inertia, Viscous, Coulomb, Offset]);
            let start = usual.with(found(FrictionDrift, 2.0));
            let chosen = bench.fit(&chosen(pair, start));
            chosen.of(FrictionDrift).unwrap().to_vec()
        };
        assert_eq!(sizes(0.0).len(), 2);
        let by_direction = sizes(0.3);
        assert_eq!(by_direction.len(), 3);
        assert!((by_direction[2] - 4.5).abs() < 0.2, "{by_direction:?}");
    }

    #[test]
    fn a_form_that_is_not_needed_any_more_is_given_back() {
        let axis = falling(2.0, 0.0);
        let bench = axis.bench();
        let pair = Pair {
            bench: &bench,
            low: &bench,
        };
        let usual = model(&[Inertia, Viscous, Coulomb, Offset]).with(found(Stribeck, 0.01));
        let other = usual.with_form(4, usual.parts[4].effect.forms()[20]);
        assert!(other.parts[4].is_reshaped());
        assert!(!chosen(pair, other).parts[4].is_reshaped());
    }

    /// Number of coefficients of friction over position that a curve of it asks for.
    fn coefficients(curve: impl Fn(f64) -> f64) -> usize {
        let (middle, half) = axis(usual).dataset.travel();
        let axis = axis(|motion, row| {
            let u = (motion.position_lp[row] - middle) / half;
            usual(motion, row) + curve(u) * motion.direction[row]
        });
        let bench = axis.bench();
        let pair = Pair {
            bench: &bench,
            low: &bench,
        };
        let usual = model(&[Inertia, Viscous, Coulomb, Offset]);
        let model = chosen(pair, usual.with(found(PositionDependentFriction, 2.0)));
        model.parts[4].width()
    }

    #[test]
    fn friction_over_position_is_a_curve_only_where_a_parabola_leaves_much() {
        assert_eq!(coefficients(|u| 6.0 * u), 1);
        assert_eq!(coefficients(|u| 6.0 * u - 4.0 * u * u), 2);
        let worn = |u: f64| 8.0 * (-((u - 0.3) / 0.4).powi(2)).exp();
        assert!(coefficients(worn) >= 8);
    }

    #[test]
    fn the_load_presses_the_surface_that_wears_in_or_another_one() {
        let form = |is_shared: bool| {
            let axis = axis(|motion, row| {
                let change = 0.8 * (-motion.time_s[row] / 2.0).exp();
                let force = usual(motion, row) + 25.0 * change * motion.direction[row];
                let drives = (force * motion.direction[row]).signum();
                if is_shared {
                    force / (1.0 - drives * 0.2 * (1.0 + change))
                } else {
                    force * (1.0 + drives * 0.2)
                }
            });
            let bench = axis.bench();
            let pair = Pair {
                bench: &bench,
                low: &bench,
            };
            let start = model(&[Inertia, Viscous, Coulomb, Offset])
                .with(found(FrictionDrift, 2.0))
                .with(found(LoadDependentFriction, 0.0));
            let model = refined(pair, start);
            let left = bench.sse(&model) / bench.sse(&model.without(&model.parts[5]));
            assert!(left < 1.0e-3, "{is_shared} {left}");
            let fitted = bench.fit(&model);
            let ratio = fitted.of(LoadDependentFriction).unwrap()[0];
            assert!((ratio - 0.2).abs() < 0.003, "{is_shared} {ratio}");
            model.parts[5].effect.form()
        };
        assert_eq!((form(false), form(true)), (0.0, 1.0));
    }
}
