//! What was found out about an axis, by stage: what every later word is about.
//!
//! Each measured output has its own judge. Moving samples of the effort judge columns, delay and
//! saturation ([`Selection`]). Samples about reversals and the free-run position judge what acts
//! there ([`AtReversals`]). Motor − load judges what stands between the two ([`Difference`]). An
//! axis that passes its reversals fast shows ripple there only ([`RippleAtReversals`]).

use axis_model::EffectName;

use crate::evidence::at_reversals::AtReversals;
use crate::evidence::difference::Difference;
use crate::evidence::free_run::Reversals;
use crate::evidence::inverse_dynamics::{Compared, InverseDynamics, Judgement};
use crate::evidence::reversal::Presliding;
use crate::evidence::selection::Selection;
use crate::evidence::slow_ripple::RippleAtReversals;
use crate::evidence::verdict::{Left, ResidualStructure, Verdict, moves_apart};
use crate::motion::kinematics::Kinematics;
use crate::record::dataset::Dataset;

/// What each stage said.
pub(crate) struct Stages {
    /// Moving samples of the effort.
    pub effort: Selection,
    /// Motor − load, where there is a load scale.
    pub difference: Option<Difference>,
    /// The effort about reversals.
    pub presliding: Option<Presliding>,
    /// The free-run position.
    pub reversals: Option<Reversals>,
    /// What the last three say together of reversals.
    pub at_reversals: AtReversals,
    /// The effort about reversals of an axis that is never slow for long.
    pub ripple: Option<RippleAtReversals>,
}

/// The effects that are lacking, in the order in which they were found.
pub(crate) struct Found(Vec<EffectName>);

impl Found {
    /// Each effect once, by the first output that shows it: effort, reversals, difference, effort
    /// about fast reversals. What is declared is not lacking.
    pub(crate) fn of(stages: &Stages, declared: &[EffectName]) -> Self {
        let mut found = Self(Vec::new());
        for effect in stages.accepted() {
            if !declared.contains(&effect) && !found.has(effect) {
                found.0.push(effect);
            }
        }
        found
    }

    /// Whether an effect is among them.
    pub(crate) fn has(&self, effect: EffectName) -> bool {
        self.0.contains(&effect)
    }

    /// Their names.
    pub(crate) fn names(&self) -> &[EffectName] {
        &self.0
    }
}

impl Stages {
    /// What was accepted, output by output; an effect that two outputs show comes twice.
    fn accepted(&self) -> Vec<EffectName> {
        let mut list = self.effort.found();
        let AtReversals {
            presliding,
            backlash,
            ..
        } = self.at_reversals;
        list.extend(presliding.then_some(EffectName::Presliding));
        list.extend(backlash.then_some(EffectName::Backlash));
        list.extend(self.difference.iter().flat_map(|d| d.found.iter()));
        list.extend(self.ripple.is_some().then_some(EffectName::TorqueRipple));
        list
    }
}

/// Everything that was found out.
pub(crate) struct Findings<'a> {
    /// The axis with its records.
    pub dataset: &'a Dataset,
    /// Motion of the training record.
    pub motion: &'a Kinematics,
    /// Motion of the validation record.
    pub validation: &'a Kinematics,
    /// What each stage said.
    pub stages: Stages,
    /// The declared and the extended model.
    pub models: Compared<InverseDynamics>,
    /// What they leave of the training record.
    pub train: Compared<Judgement>,
    /// What they leave of the validation record.
    pub validate: Compared<Judgement>,
    /// The effects that are lacking.
    pub found: Found,
    /// Structure in the residual of the training record.
    pub residual: ResidualStructure,
    /// Explained or not.
    pub verdict: Verdict,
}

impl<'a> Findings<'a> {
    /// Judges both models on both records, and draws the conclusions.
    pub(crate) fn of(
        dataset: &'a Dataset,
        [motion, validation]: [&'a Kinematics; 2],
        stages: Stages,
        models: Compared<InverseDynamics>,
    ) -> Self {
        let train = models.each(|model| model.on(dataset, motion));
        let validate = models.each(|model| model.on(dataset, validation));
        let found = Found::of(&stages, &dataset.declared);
        let residual = ResidualStructure::of(motion, &train, &stages.effort.scored);
        let declares_gap = dataset.declares(EffectName::Backlash);
        let left = Left {
            nameless: &stages.effort.nameless(),
            residual,
            force_percent: train.extended.force_percent,
            at_reversals: stages.at_reversals.unexplained,
            apart: stages
                .difference
                .as_ref()
                .is_some_and(|difference| moves_apart(dataset, difference)),
            has_gap: declares_gap || found.has(EffectName::Backlash),
        };
        let verdict = Verdict::of(&left);
        Self {
            dataset,
            motion,
            validation,
            stages,
            models,
            train,
            validate,
            found,
            residual,
            verdict,
        }
    }
}
