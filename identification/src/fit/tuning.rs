//! Nonlinear parameters of a model: where the parts together leave the least.
//!
//! One parameter at a time, each on a grid first and then by descent; all of them once more
//! together, because what one leaves on its grid looks like another. A delay is searched at the
//! lower cut-off.

use crate::fit::bench::Bench;
use crate::fit::fitted::{Fitted, Searched};
use crate::fit::search::{descend, smallest};
use crate::fit::told;
use crate::model::effects::{Effect, Setting, Stage};
use crate::model::inverse::{Model, Part};

/// Cut-off for the search of a delay: quantisation comes back through the controller as effort that
/// follows measured noise, and looks like a delay at 100 Hz but not here.
const DELAY_CUTOFF_HZ: f64 = 30.0;
/// The linearisation about the last fit is renewed so often.
const RENEWALS: usize = 3;
/// First step of the search among forms: halved until it is one.
const LARGEST_STEP_OF_FORMS: f64 = 32.0;
/// Degree of the smooth function of the position that no wave of a known order may stand for: that
/// of a spring with what it stiffens by, of either sign.
pub(crate) const SMOOTH_DEGREE: f64 = 4.0;
/// A smooth function beside a wave that is declared is a spring where it removes this share of what
/// the wave leaves alone: waves of less than a period within the travel need none.
const WORTH_A_SPRING: f64 = 0.05;
/// A parameter is refined where the best of its grid removes this share of the squares: less is not
/// in reach of what an effect must remove.
const WORTH_A_DESCENT: f64 = 0.01;
/// Rounds of the refinement of one parameter after the other.
const ROUNDS: usize = 2;
/// Most steps of all parameters together.
const MOST_STEPS: usize = 8;
/// Parts of a step that are tried, the largest first.
const FACTORS: [f64; 3] = [1.0, 0.5, 0.1];
/// There are no more steps where the last one removed less than this share of what was left.
const WORTH_A_STEP: f64 = 1.0e-3;

/// The cut-off for the delay search at a sample period.
#[must_use]
pub(crate) fn delay_cutoff_hz(period_s: f64) -> f64 {
    DELAY_CUTOFF_HZ.min(crate::motion::filter::cutoff_hz(period_s))
}

/// A record with the cut-off of the errors, and the same with that of the delay search.
#[derive(Clone, Copy)]
pub(crate) struct Pair<'a> {
    /// As the errors are defined.
    pub bench: &'a Bench<'a>,
    /// For the delay.
    pub low: &'a Bench<'a>,
}

impl<'a> Pair<'a> {
    /// The bench on which an effect's parameter is searched.
    fn of(&self, effect: &dyn Effect) -> &'a Bench<'a> {
        if effect.stage() == Stage::Time {
            self.low
        } else {
            self.bench
        }
    }
}

/// The model linearised about its own fit, after a step in the parameter of an effect; only an
/// actuator is not linear.
#[must_use]
pub(crate) fn settled(bench: &Bench<'_>, model: Model, effect: &dyn Effect) -> Model {
    if effect.stage() == Stage::Actuator {
        linearised(bench, model)
    } else {
        model
    }
}

/// The model linearised about its own fit, which starts from that with an ideal actuator.
fn linearised(bench: &Bench<'_>, mut model: Model) -> Model {
    let is_ideal = |part: &&Part| part.effect.stage() != Stage::Actuator;
    let ideal = Model {
        parts: model.parts.iter().filter(is_ideal).cloned().collect(),
    };
    put_about(&mut model, &bench.fit(&ideal));
    for _ in 0..RENEWALS {
        let fitted = bench.fit(&model);
        put_about(&mut model, &fitted);
    }
    model
}

/// Puts the working point of the forces where a fit has them.
fn put_about(model: &mut Model, fitted: &Fitted) {
    let is_force = |part: &Part| part.effect.stage() == Stage::Force;
    let forces = model.parts.iter_mut().filter(|part| is_force(part));
    let terms = fitted.terms().filter(|term| is_force(term.part));
    forces
        .zip(terms)
        .for_each(|(part, term)| part.about = term.own.to_vec());
}

/// The model with an effect more, its parameter where that leaves the least; `None` where the
/// record cannot show the effect.
#[must_use]
pub(crate) fn extended(
    pair: Pair<'_>,
    model: &Model,
    effect: &'static dyn Effect,
    setting: &Setting<'_>,
) -> Option<Model> {
    let bench = pair.of(effect);
    let fixed = bench.gathered(model);
    let beside = told::beside(bench, model, effect);
    let part = |parameter: f64| Part {
        beside: beside.clone(),
        ..Part::found(effect, parameter)
    };
    let with = |parameter: f64| model.with(part(parameter));
    let sse = |parameter: f64| {
        if effect.stage() == Stage::Force {
            let blocks = bench.beside(&fixed, &part(parameter));
            // A choice is between numbers of columns: more of them always fit better.
            if effect.is_tuned() {
                blocks.fit().sse
            } else {
                blocks.cross_validate().held_out.iter().sum()
            }
        } else {
            bench.sse(&settled(bench, with(parameter), effect))
        }
    };
    let alone = || match effect.stage() {
        Stage::Force => fixed.fit().sse,
        _ => bench.sse(model),
    };
    let bounds = effect.bounds(bench.motion);
    let inside = |k: &f64| !effect.is_tuned() || (*k >= bounds.0 && *k <= bounds.1);
    let grid = effect.grid(bench.motion, setting).into_iter();
    let grid = grid.filter(|k| inside(k) && is_new(bench, model, effect, *k));
    let start = smallest(&grid.collect::<Vec<f64>>(), &sse)?;
    let step = effect.first_step(bench.motion, start);
    // A choice has no step, and what removes nothing on its grid is not worth one; but what comes
    // and goes may show at both times together only.
    let removes = || sse(start) < (1.0 - WORTH_A_DESCENT) * alone();
    let is_worth_it = step > 0.0 && (effect.comes_and_goes() || removes());
    let parameter = if is_worth_it {
        descend(start, step, bounds, &sse)
    } else {
        start
    };
    let settled = settled(bench, with(parameter), effect);
    Some(told::of_the_others(pair.bench, settled))
}

/// Whether an effect that repeats has another parameter than those of its kind in the model.
#[must_use]
pub(crate) fn is_new(
    bench: &Bench<'_>,
    model: &Model,
    effect: &'static dyn Effect,
    parameter: f64,
) -> bool {
    if !effect.repeats() {
        return true;
    }
    let least = effect.least_distance(bench.motion);
    let same = |part: &&Part| part.called() == effect.called();
    let mut known = model.parts.iter().filter(same);
    known.all(|part| (part.parameter - parameter).abs() > least)
}

/// The nonlinear parameters of a declared model, from nothing.
pub(crate) fn prepare(pair: Pair<'_>, model: &mut Model) {
    begin(pair, model);
    refine(pair, model);
}

/// The nonlinear parameters of a declared model on their grids: delay and actuator first, since all
/// columns go through them.
pub(crate) fn begin(pair: Pair<'_>, model: &mut Model) {
    let is_force = |place: &usize| model.parts[*place].effect.stage() == Stage::Force;
    let (forces, others): (Vec<usize>, Vec<usize>) =
        model.outwards().into_iter().partition(is_force);
    for place in others.into_iter().chain(forces) {
        start(pair, model, place);
    }
}

/// Puts a nonlinear parameter where its grid, or one of its few periods, leaves the least beside
/// the other parts.
fn start(pair: Pair<'_>, model: &mut Model, place: usize) {
    let effect = model.parts[place].effect;
    let bench = pair.of(effect);
    let residual = bench.residual(&bench.fit(&model.without(&model.parts[place])));
    let setting = Setting {
        dataset: bench.dataset,
        residual: &residual,
    };
    let choices = |effect: &'static dyn Effect| {
        let grid = effect.grid(bench.motion, &setting).into_iter();
        grid.map(move |parameter| (effect, parameter))
    };
    let few = effect.with_few_periods().iter();
    let few: Vec<_> = few.flat_map(|effect| choices(*effect)).collect();
    let all: Vec<_> = choices(effect).chain(few.iter().copied()).collect();
    if all.len() < 2 {
        return;
    }
    let at = |(effect, parameter): (&'static dyn Effect, f64)| {
        let started = model.with_form(place, effect);
        settled(bench, started.with_parameter(place, parameter), effect)
    };
    let alone = |choice| bench.sse(&at(choice));
    let Some(mut best) = smallest(&all, &alone) else {
        return;
    };
    // A spring that is not in the model must not decide which order is the declared one.
    if let Some(smooth) = few.first().and_then(|(few, _)| few.smooth()) {
        let beside = |choice| bench.sse(&at(choice).with(Part::found(smooth, SMOOTH_DEGREE)));
        let other = smallest(&all, &beside).unwrap_or(best);
        if beside(other) < (1.0 - WORTH_A_SPRING) * alone(best) {
            best = other;
        }
    }
    *model = at(best);
}

/// Joint refinement of all nonlinear parameters: without it the grid's coarseness leaves residuals
/// that look like other effects.
pub(crate) fn refine(pair: Pair<'_>, model: &mut Model) {
    for _ in 0..ROUNDS {
        for place in model.outwards() {
            refine_one(pair, model, place);
        }
        *model = told::of_the_others(pair.bench, std::mem::take(model));
    }
    if model.delay_s() != 0.0 {
        together(pair.low, model, &|part| {
            part.effect.stage() != Stage::Actuator
        });
    }
    together(pair.bench, model, &|part| {
        part.effect.stage() != Stage::Time
    });
}

/// All nonlinear parameters at once, of the parts that are meant, from where each was refined by
/// itself: that stops short of the least, and two of them that stand for each other creep along
/// their valley. A part of a step is taken where all of it does not leave less.
fn together(bench: &Bench<'_>, model: &mut Model, is_meant: &dyn Fn(&Part) -> bool) {
    let is_searched =
        |part: &Part| is_meant(part) && part.effect.is_tuned() && later_step(bench, part) > 0.0;
    let places: Vec<usize> = (0..model.parts.len())
        .filter(|place| is_searched(&model.parts[*place]))
        .collect();
    if places.is_empty() {
        return;
    }
    let mut left = bench.sse(model);
    for _ in 0..MOST_STEPS {
        let step = bench.step_about(&bench.fit(model), &places);
        let after = |factor: f64| {
            let mut moved = model.clone();
            for (place, step) in places.iter().zip(&step) {
                let Part {
                    effect, parameter, ..
                } = moved.parts[*place];
                let (low, high) = effect.bounds(bench.motion);
                let parameter = (parameter + factor * step).clamp(low, high);
                moved = settled(bench, moved.with_parameter(*place, parameter), effect);
            }
            told::of_the_others(bench, moved)
        };
        let tried = FACTORS
            .into_iter()
            .map(after)
            .map(|moved| (bench.sse(&moved), moved));
        let Some((sse, moved)) = tried.into_iter().find(|(sse, _)| *sse < left) else {
            return;
        };
        *model = moved;
        if sse > (1.0 - WORTH_A_STEP) * left {
            return;
        }
        left = sse;
    }
}

fn later_step(bench: &Bench<'_>, part: &Part) -> f64 {
    part.effect.later_step(bench.motion, part.parameter)
}

fn refine_one(pair: Pair<'_>, model: &mut Model, place: usize) {
    let Part {
        effect, parameter, ..
    } = model.parts[place];
    let bench = pair.of(effect);
    let step = effect.later_step(bench.motion, parameter);
    if step <= 0.0 {
        return;
    }
    let at = |parameter: f64| {
        let stepped = settled(bench, model.with_parameter(place, parameter), effect);
        if told::is_close(model) {
            told::of_the_others(bench, stepped)
        } else {
            stepped
        }
    };
    let sse = |parameter: f64| bench.sse(&at(parameter));
    let best = descend(parameter, step, effect.bounds(bench.motion), &sse);
    *model = at(best);
}

/// The model with the nonlinear parameter of one part refined.
#[must_use]
pub(crate) fn refined_at(pair: Pair<'_>, mut model: Model, place: usize) -> Model {
    refine_one(pair, &mut model, place);
    told::of_the_others(pair.bench, model)
}

/// The model with the form of a part (or its lag) that leaves the least, each with its nonlinear
/// parameter where it leaves the least.
#[must_use]
pub(crate) fn reshaped(pair: Pair<'_>, model: &Model, place: usize, what: Searched) -> Model {
    let part = &model.parts[place];
    let bench = pair.of(part.effect);
    let choices = what.choices(part.effect);
    let Some(start) = what.place(part.effect) else {
        return model.clone();
    };
    let at = |choice: f64| {
        let other = model.with_form(place, choices[choice as usize]);
        refined_at(pair, other, place)
    };
    let sse = |choice: f64| bench.sse(&at(choice));
    let bounds = (0.0, choices.len() as f64 - 1.0);
    at(descend(start as f64, LARGEST_STEP_OF_FORMS, bounds, &sse))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::made::{USUAL, axis, found, model, usual};
    use crate::model::effects::find;
    use crate::motion::kinematics::Kinematics;
    use axis_model::EffectName::{
        self, Coulomb, Delay, FrictionDrift, Inertia, Offset, Stribeck, TorqueRipple,
        TorqueSaturation, Viscous,
    };
    use std::f64::consts::TAU;

    const DECLARED: [EffectName; 4] = [Inertia, Viscous, Coulomb, Offset];

    /// The best parameter of an effect beside the declared ones, both cut-offs the same.
    fn best(name: EffectName, law: impl Fn(&Kinematics, usize) -> f64) -> Option<f64> {
        let axis = axis(law);
        let bench = axis.bench();
        let pair = Pair {
            bench: &bench,
            low: &bench,
        };
        let declared = model(&DECLARED);
        let residual = bench.residual(&bench.fit(&declared));
        let setting = Setting {
            dataset: &axis.dataset,
            residual: &residual,
        };
        let extended = extended(pair, &declared, find(name).unwrap(), &setting)?;
        Some(extended.parts.last()?.parameter)
    }

    #[test]
    fn a_nonlinear_parameter_is_found_within_a_few_percent() {
        let stribeck = |motion: &Kinematics, row: usize| {
            let fall = (-(motion.velocity_lp[row] / 0.02).powi(2)).exp();
            usual(motion, row) + 8.0 * motion.direction[row] * fall
        };
        let vs = best(Stribeck, stribeck).unwrap();
        assert!((vs / 0.02 - 1.0).abs() < 0.03, "{vs}");
        let ripple = |motion: &Kinematics, row: usize| {
            usual(motion, row) + 3.0 * (TAU * 400.0 * motion.position_lp[row]).cos()
        };
        let k = best(TorqueRipple, ripple).unwrap();
        assert!((k / 400.0 - 1.0).abs() < 1.0e-3, "{k}");
    }

    #[test]
    fn a_delay_is_found_with_its_sign() {
        for rows in [2_usize, 4] {
            let late =
                |motion: &Kinematics, row: usize| usual(motion, (row + rows).min(motion.len() - 1));
            let delay_s = best(Delay, late).unwrap();
            assert!((delay_s - 1.0e-3 * rows as f64).abs() < 2.0e-5, "{delay_s}");
        }
        let early = |motion: &Kinematics, row: usize| usual(motion, row.saturating_sub(1));
        let delay_s = best(Delay, early).unwrap();
        assert!((delay_s + 1.0e-3).abs() < 2.0e-5, "{delay_s}");
    }

    #[test]
    fn a_saturation_is_found_with_its_working_point() {
        let k = 3.0e-3;
        let lost = |motion: &Kinematics, row: usize| {
            let wanted = usual(motion, row);
            wanted / (1.0 - k * wanted.abs())
        };
        let found = best(TorqueSaturation, lost).unwrap();
        assert!((found / k - 1.0).abs() < 0.1, "{found}");
    }

    #[test]
    fn a_linearised_model_stands_at_its_own_fit() {
        let k = 2.0e-3;
        let axis = axis(|motion, row| {
            let wanted = usual(motion, row);
            wanted / (1.0 - k * wanted.abs())
        });
        let bench = axis.bench();
        let part = found(TorqueSaturation, k);
        let start = model(&DECLARED).with(part.clone());
        let settled = settled(&bench, start.clone(), part.effect);
        for (part, wanted) in settled.parts.iter().zip(USUAL) {
            assert!(
                (part.about[0] / wanted - 1.0).abs() < 0.05,
                "{}",
                part.called()
            );
        }
        assert!(bench.sse(&settled) < 0.1 * bench.sse(&start));
        // What is linear needs no working point.
        let linear = super::settled(&bench, start, find(Stribeck).unwrap());
        assert!(linear.parts.iter().all(|part| part.about.is_empty()));
    }

    #[test]
    fn a_second_ripple_must_have_another_period_but_a_second_kind_need_not() {
        let axis = axis(usual);
        let bench = axis.bench();
        let with = model(&DECLARED).with(found(TorqueRipple, 400.0));
        let (low, high) = axis.motion.span();
        let apart = 2.0 / (high - low);
        let ripple = find(TorqueRipple).unwrap();
        for (k, wanted) in [
            (400.0, false),
            (400.0 + 0.99 * apart, false),
            (400.0 - 0.99 * apart, false),
            (400.0 + 1.01 * apart, true),
            (400.0 - 1.01 * apart, true),
        ] {
            assert_eq!(is_new(&bench, &with, ripple, k), wanted, "{k}");
        }
        assert!(is_new(&bench, &with, find(Stribeck).unwrap(), 400.0));
    }

    #[test]
    fn declared_parameters_are_found_from_nothing_and_refined_together() {
        let axis = axis(|motion, row| {
            let later = (row + 2).min(motion.len() - 1);
            let warm = 6.0 * (-motion.time_s[later] / 2.5).exp();
            usual(motion, later) + warm * motion.direction[later]
        });
        let bench = axis.bench();
        let pair = Pair {
            bench: &bench,
            low: &bench,
        };
        let mut declared = model(&DECLARED);
        for (name, start) in [(FrictionDrift, 0.7), (Delay, 2.5e-4)] {
            let part = Part::declared(find(name).unwrap(), start);
            declared.parts.push(part);
        }
        prepare(pair, &mut declared);
        let tau = declared.of(FrictionDrift).unwrap().parameter;
        assert!((tau / 2.5 - 1.0).abs() < 0.1, "{tau}");
        assert!(
            (declared.delay_s() - 2.0e-3).abs() < 2.0e-5,
            "{}",
            declared.delay_s()
        );
    }

    #[test]
    fn the_cut_off_of_the_delay_search_is_thirty_hertz_or_that_of_the_fit() {
        assert_eq!(delay_cutoff_hz(1.0e-3), 30.0);
        assert!((delay_cutoff_hz(5.0e-3) - 20.0).abs() < 1.0e-9);
    }

    #[test]
    fn only_a_delay_is_searched_at_the_lower_cut_off() {
        let (axis, other) = (axis(usual), axis(usual));
        let (bench, low) = (axis.bench(), other.bench());
        let pair = Pair {
            bench: &bench,
            low: &low,
        };
        let is_low = |name| std::ptr::eq(pair.of(find(name).unwrap()), &raw const low);
        assert!(is_low(Delay) && !is_low(TorqueSaturation) && !is_low(Stribeck));
    }

    #[test]
    fn a_declared_ripple_is_started_at_its_order_from_less_than_a_period_on() {
        for turns in [0.5, 0.8, 1.7] {
            let mut axis = axis(usual);
            let (low, high) = axis.motion.span();
            let revolution = (high - low) / turns;
            axis.dataset.lead_m_per_rev = Some(revolution);
            axis.dataset.declared.push(TorqueRipple);
            axis.put(|motion, row| {
                let angle = TAU * motion.position_lp[row] / revolution;
                usual(motion, row) + 20.0 * (angle + 0.7).sin()
            });
            let bench = axis.bench();
            let pair = Pair {
                bench: &bench,
                low: &bench,
            };
            let mut model = Model::declared(&axis.dataset);
            prepare(pair, &mut model);
            let ripple = model.of(TorqueRipple).unwrap();
            let order = ripple.parameter * revolution;
            assert!((order - 1.0).abs() < 1.0e-9, "{turns} turns: {order}");
        }
    }

    #[test]
    fn the_delay_is_the_same_beside_friction_that_grows_with_the_load() {
        let (share, late) = (0.4, 4);
        let axis = axis(|motion, row| {
            let row = (row + late).min(motion.len() - 1);
            let force = usual(motion, row);
            let behind = force - share * USUAL[0] * motion.acceleration[row];
            force + 0.15 * behind.abs() * motion.direction[row]
        });
        let slow = Kinematics::with_cutoff(&axis.dataset, &axis.dataset.train, 30.0).unwrap();
        let (bench, low) = (axis.bench(), Bench::new(&axis.dataset, &slow));
        let pair = Pair {
            bench: &bench,
            low: &low,
        };
        let mut model = model(&DECLARED)
            .with(found(EffectName::LoadDependentFriction, share))
            .with(found(Delay, 1.0e-3));
        refine(pair, &mut model);
        let delay_s = model.parts[5].parameter;
        assert!((delay_s - 4.0e-3).abs() < 5.0e-5, "{delay_s}");
    }

    #[test]
    fn parameters_that_stand_for_each_other_are_found_together() {
        // Late by 2.37 rows, and two ripples that are a twelfth of a period apart over the travel.
        let (delay_s, waves) = (2.37e-3, [(400.0, 3.0), (407.0, 1.5)]);
        let axis = axis(|motion, row| {
            let at = |row: usize| {
                let ripple =
                    |(k, size): &(f64, f64)| size * (TAU * k * motion.position_lp[row]).cos();
                usual(motion, row) + waves.iter().map(ripple).sum::<f64>()
            };
            let [near, far] = [2, 3].map(|late| at((row + late).min(motion.len() - 1)));
            0.63 * near + 0.37 * far
        });
        let bench = axis.bench();
        let pair = Pair {
            bench: &bench,
            low: &bench,
        };
        let mut model = model(&DECLARED)
            .with(found(Delay, 2.0e-3))
            .with(found(TorqueRipple, 399.0))
            .with(found(TorqueRipple, 408.5));
        refine(pair, &mut model);
        let parameters: Vec<f64> = model.parts[4..].iter().map(|part| part.parameter).collect();
        assert!((parameters[0] - delay_s).abs() < 2.0e-6, "{parameters:?}");
        for (found, (wanted, _)) in parameters[1..].iter().zip(waves) {
            assert!((found / wanted - 1.0).abs() < 2.0e-4, "{parameters:?}");
        }
    }
}
