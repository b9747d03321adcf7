//! What acts at reversals: the decision, once every witness has spoken.
//!
//! Three witnesses see a reversal, each with a blind spot:
//! - the *load scale* sees a gap directly (motor − load); it says nothing about a bristle;
//! - the *inverse model* ([`reversal`](crate::evidence::reversal)) sees a bristle in the effort
//!   about reversals; it cannot see a gap, whose impacts are not in the low-passed effort;
//! - the *free run* ([`free_run`](crate::evidence::free_run)) sees both, where it knows the
//!   controller. Where it does not, the simulation is tied to the record: too closely to judge a
//!   bristle, but a gap that it sees is one, unless the inverse model sees a bristle so clearly
//!   that a gap cannot be it: a bristle of another law (Maxwell slip) looks like a gap to it.
//!
//! The load scale is asked first, then a free run with the known controller. The inverse model
//! decides where neither can, and breaks a tie of the free run.
//!
//! A bristle that the motor alone shows may have a gap before it. That is asked last
//! ([`mod@crate::evidence::reversal::gap`]), of the effort about reversals.

use crate::evidence::free_run::Summary;
use crate::evidence::free_run::decision::Accepted;
use crate::evidence::reversal::Presliding;
use crate::evidence::thresholds::{BRISTLE_TIE_RATIO, GAP_TIE_RATIO};

/// What the witnesses say about reversals; `None` where one is missing.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Witnesses {
    /// The inverse model.
    pub inverse: Option<Presliding>,
    /// The free run.
    pub free_run: Option<Summary>,
    /// The load scale.
    pub load_scale: Option<LoadScale>,
}

/// What a load scale says.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct LoadScale {
    /// Whether motor − load shows a gap.
    pub gap: bool,
}

/// What acts at reversals.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct AtReversals {
    /// A bristle.
    pub presliding: bool,
    /// A gap seen from the motor; one that a load scale shows stands in the difference.
    pub backlash: bool,
    /// Something that is none of them.
    pub unexplained: bool,
}

impl AtReversals {
    /// A bristle behind a gap.
    pub(crate) const BOTH: Self = Self {
        presliding: true,
        backlash: true,
        unexplained: false,
    };
}

impl Witnesses {
    /// What acts, by what they say.
    #[must_use]
    pub(crate) fn decide(&self) -> AtReversals {
        match (self.load_scale, self.free_run) {
            (Some(load), _) => self.by_inverse(self.is_suspicious() && !load.gap),
            (None, None) => self.by_inverse(self.is_suspicious()),
            (None, Some(seen)) if !seen.controller_known => self.by_followed_run(seen),
            (None, Some(seen)) if seen.accepted.undecided => self.by_tie(seen),
            (None, Some(seen)) => self.by_run(seen),
        }
    }

    /// The run decides. Where it sees nothing and leaves something, an effort that clearly bends as
    /// under a bristle says that there is more than it was told.
    fn by_run(&self, seen: Summary) -> AtReversals {
        let Accepted {
            presliding,
            backlash,
            ..
        } = seen.accepted;
        let sees_nothing = !presliding && !backlash;
        AtReversals {
            presliding,
            backlash,
            unexplained: sees_nothing && seen.something_left && self.is_clearly_a_bristle(),
        }
    }

    /// Whether a gap before a bristle is worth a look: the motor alone was recorded, the effort
    /// about reversals bends as under a bristle, something acts there, and nobody named a gap.
    #[must_use]
    pub(crate) fn may_hide_a_gap(&self, decided: AtReversals) -> bool {
        let acts = decided.presliding || decided.unexplained;
        self.load_scale.is_none() && self.accepts_bristle() && acts && !decided.backlash
    }

    fn accepts_bristle(&self) -> bool {
        self.inverse.is_some_and(|inverse| inverse.accepted)
    }

    fn is_suspicious(&self) -> bool {
        self.inverse.is_some_and(|inverse| inverse.is_suspicious())
    }

    fn by_inverse(&self, unexplained: bool) -> AtReversals {
        AtReversals {
            presliding: self.accepts_bristle(),
            backlash: false,
            unexplained,
        }
    }

    /// A bristle leaves so little of the effort about reversals that no gap would.
    fn is_clearly_a_bristle(&self) -> bool {
        let clear = |inverse: Presliding| inverse.dahl < BRISTLE_TIE_RATIO * inverse.rigid;
        self.accepts_bristle() && self.inverse.is_some_and(clear)
    }

    fn by_followed_run(&self, seen: Summary) -> AtReversals {
        let backlash = seen.accepted.backlash;
        if backlash && !seen.accepted.presliding && self.is_clearly_a_bristle() {
            return AtReversals {
                presliding: seen.bristle_helps,
                backlash: false,
                unexplained: !seen.bristle_helps,
            };
        }
        let presliding = if backlash {
            seen.accepted.presliding
        } else {
            self.accepts_bristle()
        };
        let torn = seen.accepted.undecided && seen.something_left;
        let strange = self.is_suspicious() || torn;
        AtReversals {
            presliding,
            backlash,
            unexplained: !presliding && !backlash && strange,
        }
    }

    /// Bristle and gap leave about the same in the free run: both witnesses must point one way.
    /// Where they do not, it is unexplained if rigid friction leaves something at all.
    fn by_tie(&self, seen: Summary) -> AtReversals {
        let ratio = self
            .inverse
            .map_or(f64::NAN, |inverse| inverse.dahl / inverse.rigid);
        let presliding = ratio < BRISTLE_TIE_RATIO && !seen.gap_leaves_less;
        let backlash = ratio > GAP_TIE_RATIO && seen.gap_leaves_less;
        AtReversals {
            presliding,
            backlash,
            unexplained: !presliding && !backlash && seen.something_left,
        }
    }
}

/// Deflection of the bristle: the free run's where it accepted one, else the inverse model's.
#[must_use]
pub(crate) fn deflection(inverse: Option<&Presliding>, free_run: Option<f64>) -> Option<f64> {
    free_run.or_else(|| inverse.map(|inverse| inverse.deflection))
}

#[cfg(test)]
mod tests {
    use super::*;

    const NOTHING: AtReversals = AtReversals {
        presliding: false,
        backlash: false,
        unexplained: false,
    };
    const BRISTLE: AtReversals = AtReversals {
        presliding: true,
        ..NOTHING
    };
    const GAP: AtReversals = AtReversals {
        backlash: true,
        ..NOTHING
    };
    const BOTH: AtReversals = AtReversals::BOTH;
    const UNEXPLAINED: AtReversals = AtReversals {
        unexplained: true,
        ..NOTHING
    };

    /// The inverse model: Dahl leaves `ratio` of what rigid friction leaves.
    fn inverse(ratio: f64, accepted: bool) -> Presliding {
        Presliding {
            rigid: 2.0,
            dahl: 2.0 * ratio,
            deflection: 3.0e-6,
            t: 2.0,
            accepted,
            elsewhere: Some(ratio),
        }
    }

    /// The free run: bristle, gap, undecided.
    fn free_run(controller_known: bool, accepted: [bool; 3]) -> Summary {
        let [presliding, backlash, undecided] = accepted;
        Summary {
            controller_known,
            accepted: Accepted {
                presliding,
                backlash,
                undecided,
            },
            gap_leaves_less: false,
            bristle_helps: false,
            something_left: true,
        }
    }

    fn check(rows: Vec<(&str, Witnesses, AtReversals)>) {
        for (sentence, witnesses, wanted) in rows {
            assert_eq!(witnesses.decide(), wanted, "{sentence}");
        }
    }

    #[test]
    fn without_a_free_run_the_inverse_model_decides() {
        let heard = |inverse| Witnesses {
            inverse,
            ..Witnesses::default()
        };
        check(vec![
            ("nobody spoke: nothing acts", heard(None), NOTHING),
            (
                "it accepts a bristle",
                heard(Some(inverse(0.3, true))),
                BRISTLE,
            ),
            (
                "just suspicious is unexplained",
                heard(Some(inverse(0.849, false))),
                UNEXPLAINED,
            ),
            (
                "the limit itself is not suspicious",
                heard(Some(inverse(0.85, false))),
                NOTHING,
            ),
            (
                "just not suspicious is nothing",
                heard(Some(inverse(0.851, false))),
                NOTHING,
            ),
            (
                "an accepted bristle is not suspicious",
                heard(Some(inverse(0.849, true))),
                BRISTLE,
            ),
        ]);
    }

    #[test]
    fn a_load_scale_is_asked_before_the_free_run() {
        let heard = |inverse, gap| Witnesses {
            inverse,
            free_run: Some(free_run(true, [false, true, false])),
            load_scale: Some(LoadScale { gap }),
        };
        check(vec![
            (
                "a gap is the difference's, not the motor's",
                heard(None, true),
                NOTHING,
            ),
            (
                "the bristle is the inverse model's",
                heard(Some(inverse(0.3, true)), false),
                BRISTLE,
            ),
            (
                "a bristle beside a gap",
                heard(Some(inverse(0.3, true)), true),
                BRISTLE,
            ),
            (
                "suspicion without a gap",
                heard(Some(inverse(0.8, false)), false),
                UNEXPLAINED,
            ),
            (
                "a gap explains a suspicion",
                heard(Some(inverse(0.8, false)), true),
                NOTHING,
            ),
        ]);
    }

    #[test]
    fn a_free_run_with_the_known_controller_outvotes_the_inverse_model() {
        let heard = |inverse, accepted| Witnesses {
            inverse,
            free_run: Some(free_run(true, accepted)),
            load_scale: None,
        };
        check(vec![
            (
                "it sees a bristle",
                heard(None, [true, false, false]),
                BRISTLE,
            ),
            (
                "it sees a gap",
                heard(Some(inverse(0.3, true)), [false, true, false]),
                GAP,
            ),
            ("it sees both", heard(None, [true, true, false]), BOTH),
            (
                "it sees nothing, and neither does the effort clearly",
                heard(Some(inverse(0.5, true)), [false; 3]),
                NOTHING,
            ),
            (
                "it sees nothing of what the effort clearly shows",
                heard(Some(inverse(0.499, true)), [false; 3]),
                UNEXPLAINED,
            ),
            (
                "it is not suspicious",
                heard(Some(inverse(0.8, false)), [false; 3]),
                NOTHING,
            ),
        ]);
    }

    #[test]
    fn a_followed_run_is_believed_about_gaps_only() {
        let heard = |inverse, accepted| Witnesses {
            inverse,
            free_run: Some(free_run(false, accepted)),
            load_scale: None,
        };
        check(vec![
            ("its gap counts", heard(None, [false, true, false]), GAP),
            (
                "its bristle does not",
                heard(None, [true, false, false]),
                NOTHING,
            ),
            (
                "a bristle beside its gap does",
                heard(None, [true, true, false]),
                BOTH,
            ),
            (
                "beside its gap the inverse model's bristle does not",
                heard(Some(inverse(0.5, true)), [false, true, false]),
                GAP,
            ),
            (
                "unless that is so clear that no gap can be it",
                heard(Some(inverse(0.49, true)), [false, true, false]),
                UNEXPLAINED,
            ),
            (
                "and the run sees it too",
                Witnesses {
                    free_run: Some(Summary {
                        bristle_helps: true,
                        ..free_run(false, [false, true, false])
                    }),
                    ..heard(Some(inverse(0.49, true)), [false, true, false])
                },
                BRISTLE,
            ),
            (
                "the inverse model's bristle counts",
                heard(Some(inverse(0.3, true)), [false; 3]),
                BRISTLE,
            ),
            (
                "a suspicion stays",
                heard(Some(inverse(0.8, false)), [false; 3]),
                UNEXPLAINED,
            ),
            (
                "its doubt is unexplained",
                heard(None, [false, false, true]),
                UNEXPLAINED,
            ),
            (
                "a bristle settles its doubt",
                heard(Some(inverse(0.3, true)), [false, false, true]),
                BRISTLE,
            ),
            (
                "a gap settles a suspicion",
                heard(Some(inverse(0.8, false)), [false, true, false]),
                GAP,
            ),
        ]);
    }

    #[test]
    fn a_tie_goes_to_the_shape_that_both_witnesses_point_to() {
        let heard = |ratio: Option<f64>, gap_leaves_less| Witnesses {
            inverse: ratio.map(|ratio| inverse(ratio, false)),
            free_run: Some(Summary {
                gap_leaves_less,
                ..free_run(true, [false, false, true])
            }),
            load_scale: None,
        };
        check(vec![
            (
                "both point to a bristle",
                heard(Some(0.499), false),
                BRISTLE,
            ),
            (
                "the ratio is a little too high",
                heard(Some(0.501), false),
                UNEXPLAINED,
            ),
            ("the gap leaves less", heard(Some(0.499), true), UNEXPLAINED),
            ("both point to a gap", heard(Some(0.801), true), GAP),
            (
                "the ratio is a little too low",
                heard(Some(0.799), true),
                UNEXPLAINED,
            ),
            (
                "the bristle leaves less",
                heard(Some(0.801), false),
                UNEXPLAINED,
            ),
            (
                "the inverse model is silent",
                heard(None, true),
                UNEXPLAINED,
            ),
            (
                "the limits themselves break no tie",
                heard(Some(0.5), false),
                UNEXPLAINED,
            ),
            (
                "the limits themselves break no tie",
                heard(Some(0.8), true),
                UNEXPLAINED,
            ),
        ]);
    }

    #[test]
    fn a_tie_without_anything_left_explains_nothing_and_is_not_unexplained() {
        let heard = |controller_known| Witnesses {
            free_run: Some(Summary {
                something_left: false,
                ..free_run(controller_known, [false, false, true])
            }),
            ..Witnesses::default()
        };
        check(vec![
            ("in a free run", heard(true), NOTHING),
            ("in a followed run", heard(false), NOTHING),
        ]);
    }

    #[test]
    fn a_gap_may_hide_before_a_bristle_or_behind_a_doubt_where_the_motor_alone_was_recorded() {
        let motor = Witnesses {
            inverse: Some(inverse(0.3, true)),
            ..Witnesses::default()
        };
        let stiff = Witnesses {
            inverse: Some(inverse(0.8, false)),
            ..motor
        };
        let with_scale = Witnesses {
            load_scale: Some(LoadScale::default()),
            ..motor
        };
        for (witnesses, decided, wanted) in [
            (motor, BRISTLE, true),
            (motor, UNEXPLAINED, true),
            (motor, NOTHING, false),
            (motor, GAP, false),
            (motor, BOTH, false),
            (stiff, UNEXPLAINED, false),
            (with_scale, BRISTLE, false),
        ] {
            assert_eq!(witnesses.may_hide_a_gap(decided), wanted, "{decided:?}");
        }
    }

    #[test]
    fn the_free_run_has_the_first_word_on_the_deflection() {
        let inverse = inverse(0.3, true);
        assert_eq!(deflection(Some(&inverse), Some(5.0e-6)), Some(5.0e-6));
        assert_eq!(deflection(Some(&inverse), None), Some(3.0e-6));
        assert_eq!(deflection(None, None), None);
    }
}
