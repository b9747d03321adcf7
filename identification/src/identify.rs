//! The whole identification of a dataset: the list of its steps.
//!
//! This is the only file that sees every room. What a step does stands in its room.

use axis_model::EffectName;

use crate::error::IdentificationError;
use crate::evidence::at_reversals::{self, LoadScale, Witnesses};
use crate::evidence::difference::{self, Difference};
use crate::evidence::findings::{Findings, Stages};
use crate::evidence::free_run::{self, Reversals};
use crate::evidence::inverse_dynamics::{Compared, InverseDynamics};
use crate::evidence::plausibility;
use crate::evidence::reversal;
use crate::evidence::selection::{self, Selection};
use crate::evidence::slow_ripple::slow_ripple;
use crate::fit::bench::Bench;
use crate::fit::fitted::Fitted;
use crate::fit::tuning::{self, Pair};
use crate::model::inverse::Model;
use crate::motion::kinematics::Kinematics;
use crate::motion::motions::{self, Motions};
use crate::record::dataset::Dataset;
use crate::report;
use crate::report::forms::Identification;

/// Identifies a dataset. `progress` hears of every step.
///
/// # Errors
/// Where the record leaves nothing to fit.
pub fn identify(
    dataset: &Dataset,
    progress: &mut dyn FnMut(&str),
) -> Result<Identification, IdentificationError> {
    let low_cutoff_hz = tuning::delay_cutoff_hz(dataset.train.period_s);
    let motions = Motions::of(dataset, low_cutoff_hz)?;
    plausibility::check(dataset, &motions.train)?;
    let (bench, low) = (
        Bench::new(dataset, &motions.train),
        Bench::new(dataset, &motions.train_low),
    );
    let pair = Pair {
        bench: &bench,
        low: &low,
    };
    progress("fitting the declared model");
    let declared = declared(pair);
    let (stages, models) = stages(pair, declared, &motions, progress);
    progress("validating");
    let both = [&motions.train, &motions.validate];
    let findings = Findings::of(dataset, both, stages, models);
    Ok(report::identification(&findings))
}

/// The declared model, its nonlinear parameters fitted.
fn declared(pair: Pair<'_>) -> Model {
    let mut model = Model::declared(pair.bench.dataset);
    tuning::prepare(pair, &mut model);
    model
}

/// What every output says, and the two models that follow from it.
fn stages(
    pair: Pair<'_>,
    declared: Model,
    motions: &Motions,
    progress: &mut dyn FnMut(&str),
) -> (Stages, Compared<InverseDynamics>) {
    let (bench, dataset) = (pair.bench, pair.bench.dataset);
    progress("scoring candidate effects");
    let effort = on_effort(pair, &declared, &motions.validate, progress);
    let inverse = bench.fit(&effort.model);
    progress("looking at motor and load");
    let difference = on_difference(bench, &inverse);
    progress("simulating reversals: stick, bristle, gap");
    let presliding = reversal::presliding(bench, &inverse);
    let mut reversals = free_run::reversals(dataset, &inverse);
    let at_reversals = Witnesses {
        inverse: presliding,
        free_run: reversals.as_ref().map(Reversals::summary),
        load_scale: difference.as_ref().map(|found| LoadScale {
            gap: found.gap.is_some(),
        }),
    }
    .decide();
    if let Some(reversals) = &mut reversals {
        let gap = difference.as_ref().is_some_and(|d| d.gap.is_some());
        reversals.settle(at_reversals.presliding, at_reversals.backlash || gap);
    }
    let mut stages = Stages {
        effort,
        difference,
        presliding,
        reversals,
        at_reversals,
        ripple: None,
    };
    let models = models(pair, declared, &stages);
    stages.ripple = slow_ripple(dataset, &motions.train, models.declared.fitted.model());
    (stages, models)
}

/// Forward selection on the effort, with the validation record's veto.
fn on_effort(
    pair: Pair<'_>,
    declared: &Model,
    validate: &Kinematics,
    progress: &mut dyn FnMut(&str),
) -> Selection {
    let mut selected = selection::select(pair, declared.clone(), progress);
    let other = Bench::new(pair.bench.dataset, validate);
    selection::veto(pair.bench, &other, &mut selected.model);
    selected
}

/// Motor − load, where there is a load scale.
fn on_difference(bench: &Bench<'_>, fitted: &Fitted) -> Option<Difference> {
    let transmitted = bench.transmitted(fitted);
    let path = difference::Path {
        position: &bench.dataset.train.position,
        transmitted: &transmitted,
    };
    difference::difference(bench.dataset, bench.motion, path)
}

/// The declared model and the extended one, each with the bristle that it has.
fn models(pair: Pair<'_>, declared: Model, stages: &Stages) -> Compared<InverseDynamics> {
    let dataset = pair.bench.dataset;
    let simulated = stages.reversals.as_ref();
    // With a load scale friction is judged where it acts, not at the motor.
    let simulated = simulated.filter(|_| stages.difference.is_none());
    let deflection = at_reversals::deflection(
        stages.presliding.as_ref(),
        simulated.and_then(Reversals::deflection),
    );
    let declares_bristle = dataset.declares(EffectName::Presliding);
    let has_bristle = declares_bristle || stages.at_reversals.presliding;
    let extended = match &stages.difference {
        Some(found) if found.moves_apart() => {
            selection::with_load_inertia(pair.bench, &stages.effort.model)
        }
        _ => stages.effort.model.clone(),
    };
    Compared {
        declared: InverseDynamics::fitted(pair, declared, deflection.filter(|_| declares_bristle)),
        extended: InverseDynamics::fitted(pair, extended, deflection.filter(|_| has_bristle)),
    }
}

/// Coulomb friction as the declared model alone sees it; for feedforward.
///
/// # Errors
/// Where the declared model has no Coulomb friction, or the record leaves nothing to fit.
pub fn declared_coulomb(dataset: &Dataset) -> Result<f64, IdentificationError> {
    let motion = motions::of_training(dataset)?;
    let fitted = Bench::new(dataset, &motion).fit(&Model::declared(dataset));
    let own = fitted.of(EffectName::Coulomb).and_then(<[f64]>::first);
    own.copied().ok_or_else(|| {
        IdentificationError::new(format!(
            "{}: the declared model has no Coulomb friction",
            dataset.name
        ))
    })
}
