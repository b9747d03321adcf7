//! What effects that follow the load are told of the other effects of their model.
//!
//! Friction that grows with the load, or a torque constant that ripples, is a factor of what the
//! others do. That is not linear, so such a part is told the coefficients of an earlier fit
//! ([`Part::beside`]), and they are renewed until both agree: each renewal leaves as much of the
//! error as the factor is of the whole, a tenth or a fifth.
//!
//! In the end it is told of the usual effects too, which until then are fitted beside its columns
//! ([`by_motion`](crate::model::effects::by_motion)), and of itself: on another record they do what
//! they did here. These renewals go half way: friction by load on a surface that changes swings
//! about its fit from a ratio of 0.2 on.

use crate::fit::bench::Bench;
use crate::fit::fitted::{Fitted, Term};
use crate::model::effects::by_motion::place_among_usual;
use crate::model::effects::{Effect, Stage};
use crate::model::inverse::{Beside, Model, Part};

/// What is told is renewed so often.
const RENEWALS: usize = 3;

/// The model, what follows the load told what the others do by its own fit.
#[must_use]
pub(crate) fn of_the_others(bench: &Bench<'_>, mut model: Model) -> Model {
    if !model.parts.iter().any(|part| part.effect.follows_load()) {
        return model;
    }
    tell(&mut model, &[]);
    if model.parts.iter().any(is_beside) {
        for _ in 0..RENEWALS {
            let told = by(&bench.fit(&model), &is_beside);
            tell(&mut model, &told);
        }
    }
    let mut told: Option<Vec<Vec<f64>>> = None;
    for _ in 0..RENEWALS {
        let fitted = bench.fit(&model);
        let now: Vec<Vec<f64>> = fitted.terms().map(|term| term.own.to_vec()).collect();
        let next = told.map_or_else(|| now.clone(), |before| half_way(before, &now));
        tell_all(&mut model, &next);
        told = Some(next);
    }
    model
}

/// The model, told what its parts do in an earlier fit. A part that follows the load is told its
/// own size too, unless there may be several of its kind.
fn tell_all(model: &mut Model, own: &[Vec<f64>]) {
    let all = model.parts.iter().zip(own).map(|(part, own)| Beside {
        part: Part {
            beside: Vec::new(),
            ..part.clone()
        },
        own: own.clone(),
    });
    let all: Vec<Beside> = all.collect();
    for part in model
        .parts
        .iter_mut()
        .filter(|part| part.effect.follows_load())
    {
        let knows = |one: &&Beside| {
            let is_itself = one.part.is_same(part) && !part.effect.repeats();
            is_itself || is_told(&one.part)
        };
        part.beside = all.iter().filter(knows).cloned().collect();
    }
}

/// Half way from what was told to what a fit says now.
fn half_way(mut told: Vec<Vec<f64>>, now: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let values = told.iter_mut().flatten().zip(now.iter().flatten());
    values.for_each(|(told, now)| *told = 0.5 * (*told + now));
    told
}

/// Whether what is told has to be renewed at each step of a search: where a form depends on it by
/// more than its size.
#[must_use]
pub(crate) fn is_close(model: &Model) -> bool {
    let is_other = |part: &Part| part.effect.follows_load() && part.is_reshaped();
    model.parts.iter().any(is_other)
}

/// What an effect is told that is tried beside a model.
#[must_use]
pub(crate) fn beside(bench: &Bench<'_>, model: &Model, effect: &dyn Effect) -> Vec<Beside> {
    if effect.follows_load() {
        by(&bench.fit(model), &is_beside)
    } else {
        Vec::new()
    }
}

fn tell(model: &mut Model, told: &[Beside]) {
    let parts = model.parts.iter_mut();
    let follow = parts.filter(|part| part.effect.follows_load());
    follow.for_each(|part| part.beside = told.to_vec());
}

/// Whether a part is told of: those that follow the load do not know each other.
fn is_told(part: &Part) -> bool {
    let acts = matches!(part.effect.stage(), Stage::Force | Stage::Actuator);
    acts && !part.effect.follows_load()
}

/// Whether a part is told of while the usual ones are still fitted beside.
fn is_beside(part: &Part) -> bool {
    is_told(part) && place_among_usual(part.called()).is_none()
}

/// Some of the parts, with the coefficients of a fit.
fn by(fitted: &Fitted, is_one: &dyn Fn(&Part) -> bool) -> Vec<Beside> {
    let others = fitted.terms().filter(|term| is_one(term.part));
    let with_own = |term: Term<'_>| Beside {
        part: term.part.clone(),
        own: term.own.to_vec(),
    };
    others.map(with_own).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::made::{USUAL, axis, found, model, usual};
    use crate::model::effects::find;
    use crate::model::effects::torque_saturation::Saturation;
    use crate::model::name::Called;
    use crate::motion::kinematics::Kinematics;
    use axis_model::EffectName;
    use axis_model::EffectName::{
        Coulomb, Inertia, LoadDependentFriction, Offset, Payload, TorqueConstantRipple,
        TorqueSaturation, Viscous,
    };
    use std::f64::consts::TAU;

    const DECLARED: [EffectName; 4] = [Inertia, Viscous, Coulomb, Offset];
    const RATIO: f64 = 0.15;
    const SHARE: f64 = 0.4;

    /// What friction that grows with the load adds to a force, on a surface of its own.
    fn by_load(motion: &Kinematics, row: usize, force: f64) -> f64 {
        let behind = force - SHARE * USUAL[0] * motion.acceleration[row];
        RATIO * behind.abs() * motion.direction[row]
    }

    #[test]
    fn friction_that_grows_with_the_load_grows_with_all_that_the_load_is() {
        let axis = axis(|motion, row| {
            let is_there = f64::from(u8::from(motion.time_s[row] > 2.5));
            let brings = 30.0 * motion.acceleration[row] + 6.0 * motion.direction[row] + 40.0;
            let force = usual(motion, row) + is_there * brings;
            force + by_load(motion, row, force)
        });
        let bench = axis.bench();
        let untold = model(&DECLARED)
            .with(found(Payload, 2.5))
            .with(found(LoadDependentFriction, SHARE));
        let told = of_the_others(&bench, untold.clone());
        assert!(bench.sse(&told) < 0.05 * bench.sse(&untold));
        let fitted = bench.fit(&told);
        let ratio = fitted.of(LoadDependentFriction).unwrap()[0];
        assert!((ratio - RATIO).abs() < 0.003, "{ratio}");
        // Told of the usual ones and of itself, it needs no fit of its own on another record.
        assert_eq!(told.parts[5].beside.len(), DECLARED.len() + 2);
        // Nothing else follows the load, and what is told is told anew.
        assert!(told.parts[..5].iter().all(|part| part.beside.is_empty()));
        let alone = of_the_others(&bench, told.without(&told.parts[4]));
        assert_eq!(alone.parts[4].beside.len(), DECLARED.len() + 1);
    }

    #[test]
    fn a_torque_constant_that_ripples_acts_on_all_of_the_effort() {
        let wave = |x: f64| 0.1 * (TAU * 400.0 * x).cos();
        let axis = axis(|motion, row| {
            let force = usual(motion, row) + 3000.0 * motion.position_lp[row];
            force / (1.0 + wave(motion.position_lp[row]))
        });
        let bench = axis.bench();
        let spring = find(Called::Structure("force over position")).unwrap();
        let untold = model(&DECLARED)
            .with(Part::found(spring, 2.0))
            .with(found(TorqueConstantRipple, 400.0));
        let told = of_the_others(&bench, untold.clone());
        let [before, after] = [&untold, &told].map(|model| bench.sse(model));
        assert!(after < 0.1 * before, "{before} {after}");
    }

    #[test]
    fn a_torque_constant_ripples_by_the_effort_that_a_saturating_drive_delivers() {
        let drive = Saturation { per_effort: 1.5e-3 };
        let wave = |x: f64| 0.1 * (TAU * 400.0 * x).cos();
        let axis = axis(|motion, row| {
            let force = usual(motion, row);
            drive.commanded(force / (1.0 + wave(motion.position_lp[row])))
        });
        let bench = axis.bench();
        let mut of_both = model(&DECLARED)
            .with(found(TorqueSaturation, drive.per_effort))
            .with(found(TorqueConstantRipple, 400.0));
        for _ in 0..3 {
            of_both = of_the_others(&bench, of_both);
            let about = bench.fit(&of_both);
            for (part, term) in of_both.parts.iter_mut().zip(about.terms()) {
                part.about = term.own.to_vec();
            }
        }
        let ripple = bench.fit(&of_both);
        let [a, b] = *ripple.of(TorqueConstantRipple).unwrap() else {
            panic!("a wave has two coefficients");
        };
        // By the effort that is asked for it would be smaller by what the drive loses.
        assert!((a.hypot(b) - 0.1).abs() < 0.001, "{a} {b}");
    }
}
