//! Forward selection over any measured output.
//!
//! One effect at a time, the one that removes most of the held-out error first. In each round the
//! output judges everything that its model could have besides; the best one that it accepts comes
//! in, the model is refined, and the next round begins. Outputs: the effort of moving samples
//! ([`crate::evidence::effort`]), motor − load ([`crate::evidence::difference`]), the effort about
//! fast reversals ([`crate::evidence::slow_ripple`]).

use axis_model::EffectName;

use crate::evidence::thresholds::{EFFORT_PERCENT, EFFORT_SHARE, EFFORT_T, MOST_EFFECTS, OUTSIDER};
use crate::fit::blocks::Gain;
use crate::model::inverse::{Model, Origin, Part};
use crate::model::name::Called;

/// Parameters that differ by at most so many times are of one effect that two outputs show. Chosen.
const NEAR: f64 = 3.0;

/// What an effect is worth.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Scored {
    /// Effect.
    pub effect: Called,
    /// Nonlinear parameter.
    pub parameter: f64,
    /// Gain on held-out blocks.
    pub gain: Gain,
    /// Whether what was fitted can be this effect.
    pub physical: bool,
    /// Whether it was accepted.
    pub accepted: bool,
    /// Round of the selection, from 0.
    pub round: usize,
}

/// An effect with what it is worth, and the model that has it.
pub(crate) struct Candidate<M> {
    /// What it is worth.
    pub scored: Scored,
    /// The model with it.
    pub model: M,
}

/// A measured output that judges effects.
pub(crate) trait Output {
    /// What is fitted to it.
    type Model;

    /// Everything that a model could have besides, judged.
    fn candidates(&self, model: &Self::Model, round: usize) -> Vec<Candidate<Self::Model>>;

    /// Whether a candidate is worth a name.
    fn accepts(&self, candidate: &Candidate<Self::Model>) -> bool;

    /// Place of the candidate that comes in, among all of a round in the order of their shares.
    fn best(&self, candidates: &[Candidate<Self::Model>]) -> Option<usize> {
        candidates.iter().position(|one| self.accepts(one))
    }

    /// The model after an effect came in.
    fn refined(&self, model: Self::Model) -> Self::Model {
        model
    }

    /// Most effects that are added.
    fn most(&self) -> usize {
        MOST_EFFECTS
    }
}

/// What the selection did.
#[derive(Clone, Debug, Default)]
pub(crate) struct Selection<M = Model> {
    /// The model with everything that was accepted.
    pub model: M,
    /// All candidates of all rounds.
    pub scored: Vec<Scored>,
    /// What another record took away again.
    pub vetoed: Vec<Vetoed>,
}

/// An effect that one record shows and another contradicts.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Vetoed {
    /// Effect.
    pub effect: Called,
    /// Nonlinear parameter.
    pub parameter: f64,
    /// What it removes on held-out blocks of the record that shows it.
    pub gain: Gain,
}

impl Selection {
    /// Effects that are in the model and were not declared, in the order in which they were found.
    #[must_use]
    pub(crate) fn found(&self) -> Vec<EffectName> {
        let found = self.model.found().into_iter();
        found.filter_map(Called::name).collect()
    }

    /// Takes in an effect that another output shows on both records. That the effort of one of them
    /// contradicts it is answered, where it is the same: of a parameter that is near.
    pub(crate) fn take_in(&mut self, part: Part) {
        let is_answered = |vetoed: &Vetoed| {
            let times = (vetoed.parameter / part.parameter).ln().abs();
            vetoed.effect == part.called() && times <= NEAR.ln()
        };
        self.vetoed.retain(|vetoed| !is_answered(vetoed));
        self.model.parts.push(part);
    }

    /// Structures without a name that were found.
    pub(crate) fn nameless(&self) -> impl Iterator<Item = &Part> {
        let found = |part: &&Part| part.origin == Origin::Found;
        let found = self.model.parts.iter().filter(found);
        found.filter(|part| part.called().name().is_none())
    }
}

/// Forward selection on an output, from a model. `heard` hears of every effect that comes in.
pub(crate) fn select<O: Output>(
    output: &O,
    start: O::Model,
    heard: &mut dyn FnMut(&Scored),
) -> Selection<O::Model> {
    let (mut model, mut scored) = (start, Vec::new());
    for round in 0..output.most() {
        let mut candidates = output.candidates(&model, round);
        let share = |candidate: &Candidate<O::Model>| candidate.scored.gain.share;
        candidates.sort_by(|a, b| share(b).total_cmp(&share(a)));
        let best = output.best(&candidates);
        if let Some(best) = best {
            candidates[best].scored.accepted = true;
            heard(&candidates[best].scored);
        }
        for (place, candidate) in candidates.into_iter().enumerate() {
            scored.push(candidate.scored);
            if Some(place) == best {
                model = candidate.model;
            }
        }
        if best.is_none() {
            break;
        }
        model = output.refined(model);
    }
    Selection {
        model,
        scored,
        vetoed: Vec::new(),
    }
}

/// Whether a gain in the effort is relevant, large enough to matter to the axis, and more than
/// chance.
#[must_use]
pub(crate) fn is_enough(gain: &Gain) -> bool {
    gain.share >= EFFORT_SHARE && gain.percent >= EFFORT_PERCENT && is_certain(gain)
}

/// Whether a gain is large enough for a name outside the list.
#[must_use]
pub(crate) fn is_large_outside(gain: &Gain) -> bool {
    let (share, percent) = OUTSIDER;
    gain.share >= share && gain.percent >= percent
}

/// Whether a gain is more than chance.
#[must_use]
pub(crate) fn is_certain(gain: &Gain) -> bool {
    let is_above = |(from, smallest_t): &(f64, f64)| gain.share >= *from && gain.t >= *smallest_t;
    EFFORT_T.iter().any(is_above)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn gain(share: f64, percent: f64, t: f64) -> Gain {
        Gain {
            removed: 1.0,
            share,
            percent,
            t,
        }
    }

    #[test]
    fn what_another_output_shows_on_both_records_is_contradicted_no_more() {
        let at = [
            (EffectName::Stribeck, 3.0e-3),
            (EffectName::Stribeck, 0.1),
            (EffectName::Payload, 2.0e-3),
        ];
        let vetoed = at.map(|(name, parameter)| Vetoed {
            effect: name.into(),
            parameter,
            gain: gain(0.5, 1.0, 9.0),
        });
        let mut selection = Selection {
            model: Model::default(),
            vetoed: vetoed.to_vec(),
            ..Selection::default()
        };
        let fall = crate::model::effects::find(EffectName::Stribeck).unwrap();
        selection.take_in(Part::found(fall, 2.0e-3));
        assert_eq!(selection.found(), [EffectName::Stribeck]);
        assert_eq!(selection.vetoed, vetoed[1..]);
    }

    /// An output whose model is a list of numbers; a number is worth what it is, and taken from
    /// 0.2 on.
    struct Numbers {
        worth: Vec<f64>,
        most: usize,
    }

    impl Output for Numbers {
        type Model = Vec<f64>;

        fn candidates(&self, model: &Vec<f64>, round: usize) -> Vec<Candidate<Vec<f64>>> {
            let open = self.worth.iter().filter(|worth| !model.contains(worth));
            let candidate = |worth: &f64| Candidate {
                scored: Scored {
                    effect: Called::Structure("number"),
                    parameter: *worth,
                    gain: gain(*worth, 1.0, 1.0),
                    physical: true,
                    accepted: false,
                    round,
                },
                model: [model.as_slice(), &[*worth]].concat(),
            };
            open.map(candidate).collect()
        }

        fn accepts(&self, candidate: &Candidate<Vec<f64>>) -> bool {
            candidate.scored.parameter >= 0.2
        }

        fn most(&self) -> usize {
            self.most
        }
    }

    #[test]
    fn the_largest_comes_first_and_the_search_ends_where_none_is_accepted() {
        let output = Numbers {
            worth: vec![0.1, 0.3, 0.9, 0.2],
            most: 8,
        };
        let mut heard = Vec::new();
        let selection = select(&output, Vec::new(), &mut |scored| {
            heard.push(scored.parameter);
        });
        assert_eq!(selection.model, [0.9, 0.3, 0.2]);
        assert_eq!(heard, selection.model);
        // Four, three and two candidates, and one that was refused.
        let rounds: Vec<usize> = selection.scored.iter().map(|scored| scored.round).collect();
        assert_eq!(rounds, [0, 0, 0, 0, 1, 1, 1, 2, 2, 3]);
        let accepted = selection.scored.iter().filter(|scored| scored.accepted);
        let accepted: Vec<f64> = accepted.map(|scored| scored.parameter).collect();
        assert_eq!(accepted, [0.9, 0.3, 0.2]);
    }

    #[test]
    fn no_more_effects_come_in_than_an_output_asks_for() {
        let output = Numbers {
            worth: vec![0.3, 0.9, 0.2],
            most: 2,
        };
        let selection = select(&output, vec![7.0], &mut |_| ());
        assert_eq!(selection.model, [7.0, 0.9, 0.3]);
    }

    #[test]
    fn a_gain_is_enough_where_share_size_and_t_reach_their_limits_together() {
        for (share, percent, t, enough) in [
            (0.05, 0.15, 3.0, true),
            (0.049, 0.15, 30.0, false),
            (0.05, 0.149, 30.0, false),
            (0.05, 0.15, 2.99, false),
            (0.08, 0.15, 2.5, true),
            (0.08, 0.15, 2.49, false),
            (0.12, 0.15, 1.5, true),
            (0.12, 0.15, 1.49, false),
            (0.30, 0.15, 1.0, true),
            (0.30, 0.15, 0.99, false),
            (-0.4, 1.0, 9.0, false),
        ] {
            let gain = gain(share, percent, t);
            assert_eq!(is_enough(&gain), enough, "{gain:?}");
        }
    }
}
