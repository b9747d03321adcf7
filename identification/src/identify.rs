//! The whole identification of a dataset: the list of its steps.
//!
//! This is the only file that sees every room. What a step does stands in its room.

use axis_model::EffectName;

use crate::error::IdentificationError;
use crate::evidence::all_rows::AllRows;
use crate::evidence::difference::{self, Difference};
use crate::evidence::effort;
use crate::evidence::findings::{Findings, Stages};
use crate::evidence::inverse_dynamics::{Compared, InverseDynamics};
use crate::evidence::plausibility;
use crate::evidence::reversal_stage::ReversalStage;
use crate::evidence::selection::Selection;
use crate::evidence::slow_ripple::slow_ripple;
use crate::fit::bench::Bench;
use crate::fit::fitted::Fitted;
use crate::fit::tuning::{self, Pair};
use crate::model::inverse::Model;
use crate::motion::kinematics::Kinematics;
use crate::motion::motions::{self, Motions};
use crate::record::dataset::Dataset;
use crate::record::excerpt::{EXCERPT, ExcerptSize, excerpt};
use crate::report;
use crate::report::forms::Identification;

/// Identifies a dataset. `progress` hears of every step.
///
/// Of a record of more than 60 000 rows an excerpt is fitted, and a warning of the report says so.
/// Errors and predictions are of all rows.
///
/// # Errors
/// Where the record leaves nothing to fit.
pub fn identify(
    dataset: &Dataset,
    progress: &mut dyn FnMut(&str),
) -> Result<Identification, IdentificationError> {
    identify_excerpt(dataset, EXCERPT, progress)
}

fn identify_excerpt(
    dataset: &Dataset,
    size: ExcerptSize,
    progress: &mut dyn FnMut(&str),
) -> Result<Identification, IdentificationError> {
    let excerpt = excerpt(dataset, size);
    let fitted_on = excerpt.as_ref().unwrap_or(dataset);
    let low_cutoff_hz = tuning::delay_cutoff_hz(dataset.train.period_s);
    let motions = Motions::of(fitted_on, low_cutoff_hz)?;
    plausibility::check(dataset, &motions.train)?;
    let bench = Bench::new(fitted_on, &motions.train);
    let low = Bench::new(fitted_on, &motions.train_low);
    let pair = Pair {
        bench: &bench,
        low: &low,
    };
    let findings = findings(pair, &motions, progress);
    let all = excerpt.as_ref().map(|_| AllRows::of(&findings, dataset));
    Ok(report::identification(&findings, all.as_ref()))
}

/// Every judge in its turn; later ones stand on what earlier ones accepted.
fn findings<'a>(
    pair: Pair<'a>,
    motions: &'a Motions,
    progress: &mut dyn FnMut(&str),
) -> Findings<'a> {
    let (bench, dataset) = (pair.bench, pair.bench.dataset);
    progress("fitting the declared model");
    let declared = declared(pair);
    progress("scoring candidate effects");
    let effort = on_effort(pair, &declared, &motions.validate, progress);
    let fitted = bench.fit(&effort.model);
    progress("looking at motor and load");
    let difference = on_difference(bench, &fitted);
    progress("simulating reversals: stick, bristle, gap");
    let reversals = ReversalStage::of(bench, &fitted, difference.as_ref());
    let mut stages = Stages {
        effort,
        difference,
        reversals,
        ripple: None,
    };
    let models = models(pair, declared, &stages);
    stages.ripple = slow_ripple(dataset, &motions.train, models.declared.fitted.model());
    progress("validating");
    Findings::of(dataset, [&motions.train, &motions.validate], stages, models)
}

/// The declared model, its nonlinear parameters fitted.
fn declared(pair: Pair<'_>) -> Model {
    let mut model = Model::declared(pair.bench.dataset);
    tuning::prepare(pair, &mut model);
    model
}

/// Forward selection on the effort, with the validation record's veto.
fn on_effort(
    pair: Pair<'_>,
    declared: &Model,
    validate: &Kinematics,
    progress: &mut dyn FnMut(&str),
) -> Selection {
    let mut selected = effort::select(pair, declared.clone(), progress);
    let other = Bench::new(pair.bench.dataset, validate);
    effort::veto(pair.bench, &other, &mut selected.model);
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
    let moves_apart = stages
        .difference
        .as_ref()
        .is_some_and(Difference::moves_apart);
    let extended = if moves_apart {
        effort::with_load_inertia(pair.bench, &stages.effort.model)
    } else {
        stages.effort.model.clone()
    };
    let declares_bristle = pair.bench.dataset.declares(EffectName::Presliding);
    let has_bristle = declares_bristle || stages.reversals.decided.presliding;
    let deflection = stages.reversals.deflection();
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
