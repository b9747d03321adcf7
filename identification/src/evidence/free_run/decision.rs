//! Which shape a free run accepts, from what each of them leaves.
//!
//! A shape is *seen* where it leaves clearly less than rigid friction and is larger than what an
//! encoder shows of nothing. It is *accepted* where it also leaves clearly less than its rival.
//! Where something is seen and nothing accepted, the run is undecided. "Less" is asked twice: on
//! the blocks that were not fitted and on the whole record. A gap must be certain over the blocks
//! too, and leave no more of another record than rigid friction does.

use crate::evidence::thresholds::{
    CERTAIN_T, HELPS_RATIO, RIVAL_RATIO, SHAPE_RATIO, VETO_RATIO, VISIBLE_ROUNDINGS,
};

/// What a free run accepts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Accepted {
    /// A bristle.
    pub presliding: bool,
    /// A gap.
    pub backlash: bool,
    /// Something of the kind, but not which.
    pub undecided: bool,
}

/// What a simulation leaves, rms of the position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Left {
    /// On blocks that were not fitted.
    pub held_out: f64,
    /// On the whole record.
    pub all: f64,
}

/// A shape that was tried.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Tried {
    /// What it leaves.
    pub left: Left,
    /// Deflection of its bristle or width of its gap; the smaller one where it has both.
    pub size: f64,
    /// Mean over standard error of the gains per block over rigid friction.
    pub t: f64,
}

/// What was tried beside each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Scene {
    /// Rigid friction.
    pub rigid: Left,
    /// A bristle.
    pub bristle: Tried,
    /// A gap, where one was looked for.
    pub gap: Option<Tried>,
    /// Smallest size that the encoder shows.
    pub smallest: f64,
}

impl Left {
    fn is_below(&self, other: &Self, ratio: f64) -> bool {
        self.held_out <= ratio * other.held_out && self.all <= ratio * other.all
    }
}

impl Scene {
    /// Whether a gap is worth a look: rigid friction leaves more than `rounding` to whole counts
    /// does, or a bristle helps.
    #[must_use]
    pub(crate) fn is_worth_a_gap(&self, rounding: f64) -> bool {
        let (rigid, bristle) = (self.rigid, self.bristle.left);
        rigid.all > VISIBLE_ROUNDINGS * rounding
            || bristle.held_out.min(bristle.all) < HELPS_RATIO * rigid.held_out.max(rigid.all)
    }

    /// Whether a bristle is seen.
    #[must_use]
    pub(crate) fn is_bristle(&self) -> bool {
        self.is_seen(&self.bristle)
    }

    fn is_seen(&self, tried: &Tried) -> bool {
        tried.size >= self.smallest && tried.left.is_below(&self.rigid, SHAPE_RATIO)
    }

    /// What is accepted of bristle and gap.
    #[must_use]
    pub(crate) fn decide(&self) -> Accepted {
        let wins = |one: &Tried, other: &Tried| one.left.is_below(&other.left, RIVAL_RATIO);
        let bristle = &self.bristle;
        let is_bristle = self.is_bristle();
        let gap = self.gap.as_ref().filter(|gap| self.is_seen(gap));
        let presliding = is_bristle && self.gap.as_ref().is_none_or(|gap| wins(bristle, gap));
        // A gap shows at every reversal: one that shows in few blocks stands for something else.
        let backlash = gap.is_some_and(|gap| wins(gap, bristle) && gap.t >= CERTAIN_T);
        Accepted {
            presliding,
            backlash,
            undecided: (is_bristle || gap.is_some()) && !presliding && !backlash,
        }
    }

    /// What a bristle and a gap together add to what was accepted of one of them.
    #[must_use]
    pub(crate) fn with_both(&self, accepted: Accepted, both: Tried) -> Accepted {
        let beats = |other: &Tried| both.left.is_below(&other.left, SHAPE_RATIO);
        let visible = both.size >= self.smallest;
        if visible && beats(&self.bristle) && self.gap.as_ref().is_none_or(beats) {
            return Accepted {
                presliding: true,
                backlash: true,
                undecided: false,
            };
        }
        accepted
    }
}

impl Accepted {
    /// What stays of it after a look at another record, by what its shape and rigid friction leave
    /// there: a gap that leaves more is none, and what acts is open.
    #[must_use]
    pub(crate) fn after_another_record(self, shape: f64, rigid: f64) -> Self {
        if self.backlash && shape > VETO_RATIO * rigid {
            return Self {
                undecided: true,
                ..Self::default()
            };
        }
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const fn left(held_out: f64, all: f64) -> Left {
        Left { held_out, all }
    }

    /// A shape of two smallest sizes.
    const fn tried(held_out: f64, all: f64) -> Tried {
        Tried {
            left: left(held_out, all),
            size: 4.0e-6,
            t: CERTAIN_T,
        }
    }

    /// Rigid friction leaves 1.
    const fn scene(bristle: Tried, gap: Option<Tried>) -> Scene {
        Scene {
            rigid: left(1.0, 1.0),
            bristle,
            gap,
            smallest: 2.0e-6,
        }
    }

    const fn accepted(presliding: bool, backlash: bool, undecided: bool) -> Accepted {
        Accepted {
            presliding,
            backlash,
            undecided,
        }
    }

    #[test]
    fn a_shape_is_accepted_where_it_leaves_clearly_less_than_rigid_friction_and_its_rival() {
        let nothing = tried(1.0, 1.0);
        let small = |tried: Tried, size| Tried { size, ..tried };
        let (bristle, gap) = (accepted(true, false, false), accepted(false, true, false));
        let (none, torn) = (accepted(false, false, false), accepted(false, false, true));
        for (sentence, one, other, wanted) in [
            ("neither helps", nothing, Some(nothing), none),
            ("a bristle without a rival", tried(0.6, 0.6), None, bristle),
            (
                "a bristle that leaves a little too much",
                tried(0.61, 0.6),
                None,
                none,
            ),
            ("on the whole record, too", tried(0.6, 0.61), None, none),
            (
                "a bristle of the smallest size",
                small(tried(0.5, 0.5), 2.0e-6),
                None,
                bristle,
            ),
            (
                "a bristle below it",
                small(tried(0.5, 0.5), 1.9e-6),
                None,
                none,
            ),
            (
                "a bristle beside a weak gap",
                tried(0.45, 0.45),
                Some(tried(0.61, 0.61)),
                bristle,
            ),
            (
                "a gap beside a weak bristle",
                tried(0.61, 0.61),
                Some(tried(0.45, 0.45)),
                gap,
            ),
            (
                "a gap that leaves too much",
                nothing,
                Some(tried(0.61, 0.61)),
                none,
            ),
            (
                "a gap below the smallest size",
                nothing,
                Some(small(tried(0.4, 0.4), 1.9e-6)),
                none,
            ),
            (
                "a gap of the smallest size",
                nothing,
                Some(small(tried(0.4, 0.4), 2.0e-6)),
                gap,
            ),
            (
                "a bristle just wins",
                tried(0.3, 0.3),
                Some(tried(0.41, 0.41)),
                bristle,
            ),
            (
                "a bristle just does not",
                tried(0.3, 0.3),
                Some(tried(0.39, 0.41)),
                torn,
            ),
            (
                "a gap just wins",
                tried(0.41, 0.41),
                Some(tried(0.3, 0.3)),
                gap,
            ),
            (
                "a gap that shows in few blocks",
                nothing,
                Some(Tried {
                    t: CERTAIN_T - 0.1,
                    ..tried(0.1, 0.1)
                }),
                torn,
            ),
            (
                "a gap just does not",
                tried(0.41, 0.39),
                Some(tried(0.3, 0.3)),
                torn,
            ),
        ] {
            assert_eq!(scene(one, other).decide(), wanted, "{sentence}");
        }
    }

    #[test]
    fn both_are_accepted_where_they_leave_clearly_less_than_each_alone() {
        let before = accepted(true, false, false);
        let both = accepted(true, true, false);
        let beside = |gap| scene(tried(0.5, 0.5), gap);
        let small = Tried {
            size: 1.9e-6,
            ..tried(0.1, 0.1)
        };
        for (sentence, gap, found, wanted) in [
            (
                "less than each",
                Some(tried(0.5, 0.5)),
                tried(0.3, 0.3),
                both,
            ),
            (
                "too much on held-out blocks",
                Some(tried(0.5, 0.5)),
                tried(0.31, 0.3),
                before,
            ),
            (
                "too much on the whole",
                Some(tried(0.5, 0.5)),
                tried(0.3, 0.31),
                before,
            ),
            (
                "not less than the gap",
                Some(tried(0.4, 0.4)),
                tried(0.3, 0.3),
                before,
            ),
            ("there was no gap", None, tried(0.3, 0.3), both),
            ("too small to be seen", None, small, before),
        ] {
            assert_eq!(beside(gap).with_both(before, found), wanted, "{sentence}");
        }
        let least = Tried {
            size: 2.0e-6,
            ..tried(0.3, 0.3)
        };
        assert_eq!(beside(None).with_both(before, least), both);
    }

    #[test]
    fn a_gap_that_leaves_more_of_another_record_than_rigid_friction_is_open() {
        let (gap, both) = (accepted(false, true, false), accepted(true, true, false));
        let torn = accepted(false, false, true);
        for (before, left, wanted) in [
            (gap, (VETO_RATIO, 1.0), gap),
            (gap, (VETO_RATIO + 0.01, 1.0), torn),
            (both, (VETO_RATIO + 0.01, 1.0), torn),
            (gap, (f64::INFINITY, 1.0), torn),
            (gap, (1.0, f64::INFINITY), gap),
            (gap, (f64::INFINITY, f64::INFINITY), gap),
        ] {
            assert_eq!(before.after_another_record(left.0, left.1), wanted);
        }
        let bristle = accepted(true, false, false);
        assert_eq!(bristle.after_another_record(2.0, 1.0), bristle);
    }

    #[test]
    fn a_gap_is_looked_for_where_something_shows_or_a_bristle_helps() {
        let useless = scene(tried(1.0, 1.0), None);
        assert!(!useless.is_worth_a_gap(1.0 / VISIBLE_ROUNDINGS));
        assert!(useless.is_worth_a_gap(0.99 / VISIBLE_ROUNDINGS));
        for (bristle, worth) in [
            (tried(HELPS_RATIO, 1.0), false),
            (tried(HELPS_RATIO - 0.01, 1.0), true),
            (tried(1.0, HELPS_RATIO - 0.01), true),
        ] {
            assert_eq!(
                scene(bristle, None).is_worth_a_gap(1.0),
                worth,
                "{bristle:?}"
            );
        }
    }
}
