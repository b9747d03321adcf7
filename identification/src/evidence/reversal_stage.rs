//! The stage of reversals: every witness is asked, then [`at_reversals`] decides, then the free
//! run takes the decision over.

use crate::evidence::at_reversals::{self, AtReversals, LoadScale, Witnesses};
use crate::evidence::difference::Difference;
use crate::evidence::free_run::{self, Reversals};
use crate::evidence::reversal::gap::SeenGap;
use crate::evidence::reversal::{self, Presliding};
use crate::fit::bench::Bench;
use crate::fit::fitted::Fitted;
use crate::progress::Step;

/// What the witnesses said of reversals, and what was made of it.
pub(crate) struct ReversalStage {
    /// The inverse model, on the effort about reversals.
    pub inverse: Option<Presliding>,
    /// A gap before that bristle, on the same effort; where the motor alone was recorded.
    pub gap: Option<SeenGap>,
    /// The free run, on the position.
    pub free_run: Option<Reversals>,
    /// What acts.
    pub decided: AtReversals,
    /// Whether there is a load scale: friction is judged where it acts then, not at the motor.
    pub has_load_scale: bool,
}

impl ReversalStage {
    /// Asks all witnesses about a fitted model of the training record; the other record is asked
    /// whether it shows the same.
    pub(crate) fn of(
        [bench, other]: [&Bench<'_>; 2],
        fitted: &Fitted,
        difference: Option<&Difference>,
        progress: &mut dyn FnMut(&Step),
    ) -> Self {
        let inverse = reversal::presliding(bench, other, fitted);
        let mut free_run = free_run::reversals(bench.dataset, fitted, progress);
        let load_scale = difference.map(|found| LoadScale {
            gap: found.gap.is_some(),
        });
        let believed = free_run.as_ref().filter(|run| run.is_evidence());
        let witnesses = Witnesses {
            inverse,
            free_run: believed.map(Reversals::summary),
            load_scale,
        };
        let mut decided = witnesses.decide();
        if let Some(reversals) = &mut free_run {
            reversals.settle(decided.presliding, has_gap(decided, load_scale));
        }
        let is_asked = witnesses.may_hide_a_gap(decided);
        let gap = is_asked
            .then(|| reversal::gap(bench, other, fitted))
            .flatten();
        if gap.is_some_and(|gap| gap.is_clear()) {
            decided = AtReversals::BOTH;
        }
        Self {
            inverse,
            gap,
            free_run,
            decided,
            has_load_scale: difference.is_some(),
        }
    }

    /// The gap that the effort shows before a bristle, where it was accepted.
    pub(crate) fn gap_by_effort(&self) -> Option<SeenGap> {
        self.gap.filter(SeenGap::is_clear)
    }

    /// The gap that may be there beside the bristle that was named.
    pub(crate) fn doubtful_gap(&self) -> Option<SeenGap> {
        self.gap.filter(SeenGap::is_suspicious)
    }

    /// The free run, where it speaks of reversals: with a load scale the difference does.
    pub(crate) fn free_run_alone(&self) -> Option<&Reversals> {
        let free_run = self.free_run.as_ref();
        free_run.filter(|run| !self.has_load_scale && run.is_evidence())
    }

    /// The free run, where its shape is the one that was accepted.
    pub(crate) fn accepted_shape(&self) -> Option<&Reversals> {
        let has_shape = |run: &Reversals| run.accepted.presliding || run.accepted.backlash;
        let by_effort = self.gap_by_effort().is_some();
        let run = self
            .free_run_alone()
            .filter(|run| !by_effort && has_shape(run))?;
        (!run.best().ran_away).then_some(run)
    }

    /// Deflection of the bristle, if there is one.
    pub(crate) fn deflection(&self) -> Option<f64> {
        let free_run = self.accepted_shape().and_then(Reversals::deflection);
        at_reversals::deflection(self.inverse.as_ref(), free_run)
    }
}

/// Whether there is a gap, whoever saw it.
fn has_gap(decided: AtReversals, load_scale: Option<LoadScale>) -> bool {
    decided.backlash || load_scale.is_some_and(|scale| scale.gap)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evidence::inverse_dynamics::tests::{DEFLECTION_M, declared, record};
    use crate::model::inverse::Model;
    use crate::motion::kinematics::Kinematics;

    fn stage(deflection: Option<f64>, difference: Option<&Difference>) -> ReversalStage {
        let dataset = declared(record(deflection));
        let motion = Kinematics::new(&dataset, &dataset.train).unwrap();
        let bench = Bench::new(&dataset, &motion);
        let fitted = bench.fit(&Model::declared(&dataset));
        ReversalStage::of([&bench, &bench], &fitted, difference, &mut |_| ())
    }

    #[test]
    fn a_bristle_is_decided_with_its_deflection_and_the_free_run_takes_it_over() {
        let stage = stage(Some(DEFLECTION_M), None);
        assert!(stage.decided.presliding && !stage.decided.backlash);
        let accepted = stage.accepted_shape().unwrap().accepted;
        assert!(accepted.presliding && !accepted.backlash);
        let deflection = stage.deflection().unwrap();
        assert!(
            (deflection / DEFLECTION_M - 1.0).abs() < 0.2,
            "{deflection}"
        );
    }

    #[test]
    fn a_gap_is_there_where_the_free_run_or_the_load_scale_saw_it() {
        let seen = |backlash, load_scale: Option<bool>| {
            let decided = AtReversals {
                backlash,
                ..AtReversals::default()
            };
            has_gap(decided, load_scale.map(|gap| LoadScale { gap }))
        };
        assert!(seen(true, None) && seen(true, Some(false)) && seen(false, Some(true)));
        assert!(!seen(false, None) && !seen(false, Some(false)));
    }

    #[test]
    fn rigid_friction_is_no_effect_at_reversals() {
        let stage = stage(None, None);
        assert_eq!(stage.decided, AtReversals::default());
        assert!(stage.accepted_shape().is_none());
        assert!(stage.free_run_alone().is_some());
    }

    #[test]
    fn with_a_load_scale_the_free_run_is_not_asked_for_the_deflection() {
        let stage = stage(Some(DEFLECTION_M), Some(&Difference::default()));
        assert!(stage.free_run.is_some() && stage.free_run_alone().is_none());
        let inverse = stage.inverse.unwrap().deflection;
        assert_eq!(stage.deflection(), Some(inverse));
    }
}
