//! What an effect could also be: other causes whose columns nearly look like its own.
//!
//! A payload without its mass is a brake that drags, and friction that goes with a wave looks like
//! a torque constant that does. An effect that has such look-alikes ([`Effect::look_alikes`]) must
//! in the end beat each of them by the rule by which an effect beats no effect, with all its parts
//! that were found together.

use crate::evidence::forms::beats;
use crate::fit::bench::Bench;
use crate::model::effects::Effect;
use crate::model::inverse::{Model, Origin, Part};
use crate::model::name::Called;

/// A model with each look-alike of an effect in the place of all its parts that were found; once,
/// where the look-alike has no nonlinear parameter.
pub(crate) fn as_look_alikes(
    model: &Model,
    effect: &'static dyn Effect,
) -> impl Iterator<Item = Model> {
    let is_one = move |part: &Part| {
        let is_alike = !part.effect.look_alikes().is_empty();
        is_alike && part.origin == Origin::Found && part.called() == effect.called()
    };
    let (own, rest): (Vec<Part>, Vec<Part>) = model.parts.iter().cloned().partition(is_one);
    effect.look_alikes().iter().map(move |other| {
        let count = if other.is_tuned() { own.len() } else { 1 };
        let others = own[..count]
            .iter()
            .map(|part| Part::found(*other, part.parameter));
        Model {
            parts: rest.iter().cloned().chain(others).collect(),
        }
    })
}

/// An effect that was found and does not beat everything that nearly looks like it.
pub(crate) fn looks_like_another(bench: &Bench<'_>, model: &Model) -> Option<Called> {
    let mut found = model
        .parts
        .iter()
        .filter(|part| part.origin == Origin::Found);
    let does = |part: &&Part| {
        let mut others = as_look_alikes(model, part.effect);
        others.any(|other| !beats(bench, model, &other))
    };
    found.find(does).map(Part::called)
}
