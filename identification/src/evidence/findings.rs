//! What was found out about an axis, by stage: what every later word is about.
//!
//! Each measured output has its own judge. Moving samples of the effort judge columns, delay and
//! saturation ([`Selection`]). Samples about reversals and the free-run position judge what acts
//! there ([`ReversalStage`]). Motor − load judges what stands between the two ([`Difference`]). An
//! axis that passes its reversals fast shows ripple there only ([`RippleAtReversals`]).

use axis_model::EffectName;

use crate::evidence::amount;
use crate::evidence::another_day::OnBoth;
use crate::evidence::at_reversals::AtReversals;
use crate::evidence::causes;
use crate::evidence::difference::Difference;
use crate::evidence::inverse_dynamics::{Compared, InverseDynamics, Judgement};
use crate::evidence::mains;
use crate::evidence::oscillation::{self, Oscillation};
use crate::evidence::rank;
use crate::evidence::residual::ResidualStructure;
use crate::evidence::reversal_stage::ReversalStage;
use crate::evidence::selection::Selection;
use crate::evidence::signs;
use crate::evidence::slow_ripple::RippleAtReversals;
use crate::evidence::verdict::{Reason, Verdict};
use crate::motion::kinematics::Kinematics;
use crate::record::dataset::Dataset;

/// What each stage said.
pub(crate) struct Stages {
    /// Moving samples of the effort.
    pub effort: Selection,
    /// Motor − load, where there is a load scale.
    pub difference: Option<Difference>,
    /// The effort about reversals and the free-run position.
    pub reversals: ReversalStage,
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
        } = self.reversals.decided;
        list.extend(presliding.then_some(EffectName::Presliding));
        list.extend(backlash.then_some(EffectName::Backlash));
        list.extend(self.difference.iter().flat_map(|d| d.found.iter()));
        list.extend(self.ripple.is_some().then_some(EffectName::TorqueRipple));
        list
    }

    /// What they saw that no effect explains.
    fn reasons(&self, length: &str) -> Vec<Reason> {
        let mut reasons: Vec<Reason> = self
            .effort
            .nameless()
            .map(|part| {
                mains::reason(part, &self.effort.scored)
                    .unwrap_or_else(|| Reason::unexplained(format!("a {}", part.called())))
            })
            .collect();
        let strange = self.reversals.decided.unexplained;
        reasons.extend(strange.then(|| {
            Reason::unexplained(
                "structure at reversals that is neither stick nor a bristle nor a gap",
            )
        }));
        let doubt = self.reversals.doubtful_gap();
        reasons.extend(doubt.map(|gap| Reason::unexplained(gap.words(length))));
        let difference = self.difference.as_ref();
        reasons.extend(difference.and_then(|difference| difference.reason(length)));
        reasons
    }
}

/// Everything that was found out.
pub(crate) struct Findings<'a> {
    /// The axis with its records.
    pub dataset: &'a Dataset,
    /// Motion of the training record.
    pub motion: &'a Kinematics,
    /// The same at the lower cut-off.
    pub low: &'a Kinematics,
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
    /// Coefficients of the extended model on both records.
    pub on_both: OnBoth,
    /// The effects that are lacking.
    pub found: Found,
    /// Structure in the residual of the training record.
    pub residual: ResidualStructure,
    /// Waves that drive the axis, one of a record at most.
    pub oscillations: Vec<Oscillation>,
    /// Explained or not.
    pub verdict: Verdict,
}

impl<'a> Findings<'a> {
    /// Judges both models on both records, and draws the conclusions. The motion of the training
    /// record comes at both cut-offs.
    pub(crate) fn of(
        dataset: &'a Dataset,
        [motion, low, validation]: [&'a Kinematics; 3],
        stages: Stages,
        models: Compared<InverseDynamics>,
    ) -> Self {
        let train = models.each(|model| model.on(dataset, motion));
        let validate = models.each(|model| model.on(dataset, validation));
        let found = Found::of(&stages, &dataset.declared);
        let scored = &stages.effort.scored;
        let residual = ResidualStructure::of(dataset, [motion, low], &models, scored);
        let has_gap = dataset.declares(EffectName::Backlash) || found.has(EffectName::Backlash);
        // What has happened to the record says why everything after it is there.
        let by_model = (0.01 * models.extended.on(dataset, low).force_percent).powi(2);
        let causes = causes::of(dataset, found.names(), by_model).into_iter();
        let mut reasons: Vec<Reason> = causes.map(Reason::unexplained).collect();
        let records = [
            ("training", motion, &dataset.train),
            ("validation", validation, &dataset.validate),
        ];
        let oscillations: Vec<Oscillation> = records
            .into_iter()
            .filter_map(|(what, motion, record)| oscillation::seen(dataset, what, motion, record))
            .collect();
        reasons.extend(oscillations.first().map(Oscillation::reason));
        reasons.extend(stages.reasons(dataset.kind.millionths()));
        let vetoed = stages.effort.vetoed.iter();
        reasons.extend(vetoed.map(|vetoed| residual.of_a_veto(vetoed)));
        reasons.extend(residual.reasons(has_gap));
        let extended = &models.extended;
        reasons.extend(amount::on_another_record(dataset, validation, extended));
        let records = [motion, validation];
        let off_percent = validate.extended.force_percent;
        reasons.extend(rank::reason(dataset, records, extended, off_percent));
        reasons.extend(signs::reasons(dataset, motion, extended));
        let on_both = OnBoth::of(dataset, records, extended);
        reasons.extend(on_both.reason());
        let verdict = Verdict::of(reasons);
        Self {
            dataset,
            motion,
            low,
            validation,
            stages,
            models,
            train,
            validate,
            on_both,
            found,
            residual,
            oscillations,
            verdict,
        }
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::evidence::inverse_dynamics::tests::{declared, record};
    use crate::fit::bench::Bench;
    use crate::model::effects::find;
    use crate::model::inverse::{Model, Part};

    /// An axis with a load scale, and its motion.
    pub(crate) struct Scene {
        pub dataset: Dataset,
        pub motion: Kinematics,
    }

    impl Scene {
        /// 700 kg, 900 N s/m and 300 N, with a load that stands a constant way behind the motor.
        pub(crate) fn behind(way_m: f64) -> Self {
            let mut record = record(None);
            record.load = Some(record.position.iter().map(|x| x - way_m).collect());
            let dataset = declared(record);
            let motion = Kinematics::new(&dataset, &dataset.train).unwrap();
            Self { dataset, motion }
        }
    }

    /// A model of parts, fitted to a scene.
    fn model(scene: &Scene, names: &[EffectName]) -> InverseDynamics {
        let model = crate::fit::made::model(names);
        InverseDynamics {
            fitted: Bench::new(&scene.dataset, &scene.motion).fit(&model),
            bristle: None,
            by_the_load: None,
            slips_at: None,
        }
    }

    /// Findings that explain the effort but for a constant; the difference is all left.
    pub(crate) fn findings<'a>(scene: &'a Scene, in_difference: &[EffectName]) -> Findings<'a> {
        use EffectName::{Coulomb, Inertia, Offset, Viscous};
        let mut difference = Difference::with_structure();
        difference.found = in_difference.to_vec();
        let stages = Stages {
            difference: Some(difference),
            ..stages(&[])
        };
        let models = Compared {
            declared: model(scene, &[Inertia, Coulomb]),
            extended: model(scene, &[Inertia, Viscous, Coulomb, Offset]),
        };
        let Scene { dataset, motion } = scene;
        Findings::of(dataset, [motion; 3], stages, models)
    }

    #[test]
    fn a_structure_of_motor_and_load_is_unexplained_whatever_was_found_beside_it() {
        let scene = Scene::behind(2.0e-6);
        for found in [&[][..], &[EffectName::Compliance], &[EffectName::Backlash]] {
            let findings = findings(&scene, found);
            assert_eq!(findings.found.names(), found);
            assert!(!findings.verdict.explained);
            let words = &findings.verdict.looks_like;
            assert!(
                words.contains("goes with the position (50.00 µm rms)"),
                "{words}"
            );
        }
    }

    fn stages(effort: &[EffectName]) -> Stages {
        let parts = effort.iter().filter_map(|name| find(*name));
        let parts = parts.map(|effect| Part::found(effect, 1.0)).collect();
        Stages {
            effort: Selection {
                model: Model { parts },
                ..Selection::default()
            },
            difference: None,
            reversals: ReversalStage {
                inverse: None,
                gap: None,
                free_run: None,
                decided: AtReversals::default(),
                has_load_scale: false,
            },
            ripple: None,
        }
    }

    fn ripple() -> RippleAtReversals {
        RippleAtReversals {
            fastest: 1.0,
            cutoff_hz: 30.0,
            orders: Vec::new(),
            train_percent: Compared::default(),
            validate_percent: Compared::default(),
        }
    }

    #[test]
    fn effects_are_found_output_by_output_and_in_the_order_of_each() {
        use EffectName::{Backlash, Compliance, Delay, PitchError, Presliding, TorqueRipple};
        let mut stages = stages(&[Delay, EffectName::Stribeck]);
        stages.reversals.decided.presliding = true;
        stages.reversals.decided.backlash = true;
        let mut difference = Difference::default();
        difference.found = vec![PitchError, Compliance];
        stages.difference = Some(difference);
        stages.ripple = Some(ripple());
        let wanted = [
            Delay,
            EffectName::Stribeck,
            Presliding,
            Backlash,
            PitchError,
            Compliance,
            TorqueRipple,
        ];
        assert_eq!(Found::of(&stages, &[]).names(), wanted);
    }

    #[test]
    fn an_effect_that_two_outputs_show_is_found_once_where_it_was_seen_first() {
        let mut stages = stages(&[EffectName::TorqueRipple, EffectName::Delay]);
        stages.ripple = Some(ripple());
        let found = Found::of(&stages, &[]);
        assert_eq!(found.names(), [EffectName::TorqueRipple, EffectName::Delay]);
    }

    #[test]
    fn what_is_declared_is_not_lacking() {
        let mut stages = stages(&[EffectName::TorqueRipple, EffectName::Delay]);
        stages.reversals.decided.presliding = true;
        let declared = [EffectName::TorqueRipple, EffectName::Presliding];
        let found = Found::of(&stages, &declared);
        assert_eq!(found.names(), [EffectName::Delay]);
        assert!(!found.has(EffectName::TorqueRipple) && found.has(EffectName::Delay));
    }

    #[test]
    fn something_unexplained_at_reversals_is_no_effect() {
        let mut stages = stages(&[]);
        stages.reversals.decided.unexplained = true;
        assert!(Found::of(&stages, &[]).names().is_empty());
    }
}
