//! The whole identification of a dataset: the list of its steps.
//!
//! This is the only file that sees every room. What a step does stands in its room.

use std::borrow::Cow;

use axis_model::EffectName;

use crate::error::IdentificationError;
use crate::evidence::all_rows::AllRows;
use crate::evidence::difference::{self, Difference};
use crate::evidence::effort;
use crate::evidence::fast_motion;
use crate::evidence::findings::{Findings, Stages};
use crate::evidence::forms;
use crate::evidence::inverse_dynamics::{Compared, InverseDynamics};
use crate::evidence::law_of_the_load::or_by_the_load;
use crate::evidence::plausibility;
use crate::evidence::rank;
use crate::evidence::reversal::{self, bristle::Bristle};
use crate::evidence::reversal_stage::ReversalStage;
use crate::evidence::selection::Selection;
use crate::evidence::slow_ripple::slow_ripple;
use crate::evidence::thresholds::EFFORT_PERCENT;
use crate::evidence::velocity;
use crate::evidence::veto::veto;
use crate::fit::bench::Bench;
use crate::fit::plain::Plain;
use crate::fit::tuning::{self, Pair};
use crate::model::inverse::Model;
use crate::motion::derivatives::Derivatives;
use crate::motion::motions::{self, Motions};
use crate::progress::Step;
use crate::record::dataset::Dataset;
use crate::record::excerpt::{EXCERPT, ExcerptSize, excerpt};
use crate::record::samples::Record;
use crate::record::scale_error::{ScaleError, along};
use crate::record::units::EffortHold;
use crate::report;
use crate::report::forms::Identification;

/// Identifies a dataset. `progress` hears of every step.
///
/// Of a record of more than 120 000 rows an excerpt is fitted, and a warning of the report says so.
/// Errors and predictions are of all rows.
///
/// # Errors
/// Where the record leaves nothing to fit.
pub fn identify(
    dataset: &Dataset,
    progress: &mut dyn FnMut(&Step),
) -> Result<Identification, IdentificationError> {
    identify_excerpt(dataset, EXCERPT, Search::Whole, progress)
}

/// Fits a dataset with what it declares: the effort is not asked what else acts on it.
///
/// # Errors
/// Where the record leaves nothing to fit.
pub fn fit_declared(
    dataset: &Dataset,
    progress: &mut dyn FnMut(&Step),
) -> Result<Identification, IdentificationError> {
    identify_excerpt(dataset, EXCERPT, Search::Nothing, progress)
}

/// What the effort is asked beside what is declared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Search {
    /// All effects of the library.
    Whole,
    /// None.
    Nothing,
}

fn identify_excerpt(
    dataset: &Dataset,
    size: ExcerptSize,
    search: Search,
    progress: &mut dyn FnMut(&Step),
) -> Result<Identification, IdentificationError> {
    plausibility::check_rows(dataset)?;
    let mut dataset = motion_decided(dataset, size);
    loop {
        match judged(&dataset, size, search, progress)? {
            Judged::Whole(identification) => return Ok(*identification),
            Judged::ScaleIsOff(errors) => dataset.to_mut().scale_errors = errors,
        }
    }
}

/// What came of all judges.
enum Judged {
    /// The identification.
    Whole(Box<Identification>),
    /// Nothing holds: the acceleration of the load has a force that never was.
    ScaleIsOff(Vec<ScaleError>),
}

fn judged(
    dataset: &Dataset,
    size: ExcerptSize,
    search: Search,
    progress: &mut dyn FnMut(&Step),
) -> Result<Judged, IdentificationError> {
    let excerpt = excerpt(dataset, size);
    let fitted_on = excerpt.as_ref().unwrap_or(dataset);
    let low_cutoff_hz = tuning::delay_cutoff_hz(dataset.train.period_s);
    let motions = Motions::of(fitted_on, low_cutoff_hz)?;
    plausibility::check(dataset, &motions.train)?;
    let mut brought_back = Vec::new();
    loop {
        let known = rank::known(fitted_on, &motions, &brought_back);
        let bench = Bench::new(&known, &motions.train);
        let low = Bench::new(&known, &motions.train_low);
        let pair = Pair {
            bench: &bench,
            low: &low,
        };
        let findings = findings(pair, &motions, search, progress);
        if let Some(errors) = scale_errors(&findings, &bench) {
            return Ok(Judged::ScaleIsOff(errors));
        }
        let is_declared = |name: &&EffectName| fitted_on.declares(**name);
        let declared = findings.found.names().iter().filter(is_declared);
        let before = brought_back.len();
        brought_back.extend(declared);
        if brought_back.len() > before {
            continue;
        }
        let all = excerpt.as_ref().map(|_| {
            progress(&Step::AllRows);
            AllRows::of(&findings, dataset)
        });
        let identification = report::identification(&findings, all.as_ref());
        return Ok(Judged::Whole(Box::new(identification)));
    }
}

/// What the load's scale is off by, where its acceleration has a force of the size of an effect by
/// that and is still taken as it was recorded. The load is as heavy as the axis at most.
fn scale_errors(findings: &Findings<'_>, bench: &Bench<'_>) -> Option<Vec<ScaleError>> {
    let (dataset, motion) = (bench.dataset, bench.motion);
    if !dataset.scale_errors.is_empty() {
        return None;
    }
    let errors = findings.stages.difference.as_ref()?.scale_errors();
    if errors.is_empty() {
        return None;
    }
    let off = Derivatives::new(
        &along(&errors, &dataset.train.position),
        motion.period_s,
        dataset.hold,
    );
    let rms = |signal: &[f64]| reversal::rms(signal, &motion.fitted);
    let force = Plain::moved_mass(motion) * rms(&motion.low_passed(&off.acceleration));
    (force >= 0.01 * EFFORT_PERCENT * rms(&motion.effort_lp)).then_some(errors)
}

/// The dataset with what says how it moves: position or velocity, sharpened or not.
fn motion_decided(dataset: &Dataset, size: ExcerptSize) -> Cow<'_, Dataset> {
    fast_motion::decided(velocity::decided(dataset, size), size)
}

/// Every judge in its turn; later ones stand on what earlier ones accepted.
fn findings<'a>(
    pair: Pair<'a>,
    motions: &'a Motions,
    search: Search,
    progress: &mut dyn FnMut(&Step),
) -> Findings<'a> {
    let (bench, dataset) = (pair.bench, pair.bench.dataset);
    progress(&Step::Declared);
    let declared = declared(pair);
    progress(&Step::Candidates);
    let other = Bench::new(dataset, &motions.validate);
    let mut effort = on_effort(pair, &declared, &other, search, progress);
    progress(&Step::MotorAndLoad);
    let difference = beside_the_load(pair, &other, &declared, search, &mut effort, progress);
    let fitted = bench.fit(&effort.model);
    let reversals = ReversalStage::of([bench, &other], &fitted, difference.as_ref(), progress);
    let mut stages = Stages {
        effort,
        difference,
        reversals,
        ripple: None,
    };
    let models = models(pair, &other, declared, &stages);
    stages.ripple = slow_ripple(dataset, &motions.train, models.declared.fitted.model());
    progress(&Step::Validating);
    let motions = [&motions.train, &motions.train_low, &motions.validate];
    Findings::of(dataset, motions, stages, models)
}

/// The declared model, its nonlinear parameters fitted: beside the inertia of a load that is
/// declared to move otherwise, since what that leaves of fast motion is no wave.
fn declared(pair: Pair<'_>) -> Model {
    let mut model = Model::declared(pair.bench.dataset);
    model = effort::with_declared_load(pair.bench, &model);
    tuning::begin(pair, &mut model);
    effort::without_load(&forms::refined(pair, model))
}

/// Forward selection on the effort, with the validation record's veto.
fn on_effort(
    pair: Pair<'_>,
    declared: &Model,
    other: &Bench<'_>,
    search: Search,
    progress: &mut dyn FnMut(&Step),
) -> Selection {
    let start = effort::with_declared_load(pair.bench, declared);
    selected(pair, &start, other, search, progress)
}

fn selected(
    pair: Pair<'_>,
    start: &Model,
    other: &Bench<'_>,
    search: Search,
    progress: &mut dyn FnMut(&Step),
) -> Selection {
    if search == Search::Nothing {
        return Selection {
            model: start.clone(),
            ..Selection::default()
        };
    }
    let mut selected = effort::select(pair, start, progress);
    veto(pair.bench, other, &mut selected);
    selected
}

/// Motor − load, where there is a load scale. Where it shows that the load moves otherwise, the
/// effort is asked again what it lacks beside the load's own inertia.
fn beside_the_load(
    pair: Pair<'_>,
    other: &Bench<'_>,
    declared: &Model,
    search: Search,
    effort: &mut Selection,
    progress: &mut dyn FnMut(&Step),
) -> Option<Difference> {
    let bench = pair.bench;
    let (dataset, motion) = (bench.dataset, bench.motion);
    let transmitted = |effort: &Selection| bench.transmitted(&bench.fit(&effort.model));
    let mut force = transmitted(effort);
    let mut difference =
        difference::difference(dataset, motion, path(&dataset.train, dataset.hold, &force))?;
    if difference.moves_apart() {
        if effort::lacks_load_inertia(bench, &effort.model) {
            let start = effort::with_load(bench, declared);
            *effort = selected(pair, &start, other, search, progress);
            effort.model = effort::without_load(&effort.model);
        }
        effort::remove_beside_load(bench, &mut effort.model);
        force = transmitted(effort);
        difference =
            difference::difference(dataset, motion, path(&dataset.train, dataset.hold, &force))?;
    }
    let own = path(&dataset.train, dataset.hold, &force);
    let force = other.transmitted(&other.fit(&effort.model));
    let others = path(&dataset.validate, dataset.hold, &force);
    let both = [(motion, own), (other.motion, others)];
    let settled = difference::settled_on_both(difference, dataset, both);
    let Some(elsewhere) = difference::elsewhere(&settled, dataset, other.motion, others) else {
        return Some(settled);
    };
    let mut settled = settled.beside(&elsewhere);
    if search == Search::Whole
        && !effort.model.has(EffectName::Stribeck)
        && let Some(fall) = settled.name_fall(&elsewhere, both)
    {
        effort.take_in(fall);
    }
    Some(settled)
}

/// What a record gives to motor − load.
fn path<'a>(record: &'a Record, hold: EffortHold, transmitted: &'a [f64]) -> difference::Path<'a> {
    difference::Path {
        position: &record.position,
        transmitted,
        hold,
    }
}

/// The declared model and the extended one, each with the bristle that it has.
fn models(
    pair: Pair<'_>,
    other: &Bench<'_>,
    declared: Model,
    stages: &Stages,
) -> Compared<InverseDynamics> {
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
    let reversals = &stages.reversals;
    let bristle = reversals.deflection().map(Bristle::Dahl);
    let fitted = |model: Model, is_there: bool| {
        let dahl = bristle.clone().filter(|_| is_there);
        let fitted = InverseDynamics::fitted(pair, model, dahl);
        if reversals.decided.backlash {
            return fitted;
        }
        fitted.or_slipping(pair, other)
    };
    let told = stages.difference.as_ref();
    let told = told.and_then(|difference| difference.by_the_load.as_ref());
    let extended = fitted(extended, has_bristle);
    Compared {
        declared: fitted(declared, declares_bristle),
        extended: or_by_the_load(extended, [pair.bench, other], told),
    }
}

/// Coulomb friction as the declared model alone sees it; for feedforward.
///
/// # Errors
/// Where the declared model has no Coulomb friction, or the record leaves nothing to fit.
pub fn declared_coulomb(dataset: &Dataset) -> Result<f64, IdentificationError> {
    let dataset = &*motion_decided(dataset, EXCERPT);
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::samples::Record;
    use crate::record::units::{AxisKind, Effort, EffortHold};

    /// 20 s at 1 kHz of an axis without mass, so that nothing is simulated: Coulomb and viscous
    /// friction, an offset, and a ripple of 15 N that nobody declared.
    fn record(phase: f64) -> Record {
        let time_s: Vec<f64> = (0..20_000).map(|row| 1.0e-3 * f64::from(row)).collect();
        let position: Vec<f64> = time_s.iter().map(|t| counted(path(*t, phase))).collect();
        let effort = (0..time_s.len()).map(|row| {
            let t = time_s[row];
            let velocity = (path(t + 1.0e-5, phase) - path(t - 1.0e-5, phase)) / 2.0e-5;
            let ripple = 15.0 * (std::f64::consts::TAU * 200.0 * position[row]).cos();
            let noise = 2.0 * (1.0e4 * (row as f64 * 12.9898).sin()).fract();
            100.0 * velocity.signum() + 300.0 * velocity + 5.0 + ripple + noise
        });
        let effort: Vec<f64> = effort.collect();
        Record {
            period_s: 1.0e-3,
            load: None,
            velocity: None,
            reference: None,
            rows: time_s.iter().copied().zip(effort.iter().copied()).collect(),
            effort,
            position,
            jittered: false,
            joints: Vec::new(),
            interpolated: vec![false; time_s.len()],
            time_s,
        }
    }

    fn path(t: f64, phase: f64) -> f64 {
        0.03 * (0.9 * t + phase).sin() + 0.008 * (2.9 * t).sin()
    }

    /// An encoder of 0.1 µm.
    fn counted(position: f64) -> f64 {
        1.0e-7 * (position / 1.0e-7).round()
    }

    fn dataset() -> Dataset {
        Dataset {
            name: "long".into(),
            kind: AxisKind::Linear,
            moving_velocity: 1.0e-3,
            effort: Effort::Force,
            hold: EffortHold::Instant,
            effort_lag_s: 0.0,
            lead_m_per_rev: None,
            resolution: 1.0e-7,
            load_resolution: 0.0,
            effort_limit: None,
            controller: None,
            declared: vec![EffectName::Coulomb, EffectName::Viscous, EffectName::Offset],
            train: record(0.0),
            validate: record(1.0),
            held_back: false,
            full_band: false,
            is_sharpened: false,
            scale_errors: Vec::new(),
            notes: Vec::new(),
        }
    }

    fn identified(rows: usize) -> Identification {
        let size = ExcerptSize {
            whole: rows,
            rows,
            windows: 3,
        };
        identify_excerpt(&dataset(), size, Search::Whole, &mut |_| ()).unwrap()
    }

    #[test]
    fn windows_of_a_long_record_give_the_names_and_the_errors_of_the_whole() {
        let (whole, windows) = (identified(20_000), identified(12_000));
        assert_eq!(whole.report.found, ["torque_ripple"]);
        assert_eq!(windows.report.found, whole.report.found);
        assert_eq!(windows.report.verdict, whole.report.verdict);
        let pairs = [
            (&windows.report.train, &whole.report.train),
            (&windows.report.validate, &whole.report.validate),
        ];
        for (of_windows, of_whole) in pairs {
            let before =
                of_windows.force_error_before_percent / of_whole.force_error_before_percent;
            let after = of_windows.force_error_after_percent / of_whole.force_error_after_percent;
            assert!((0.98..1.02).contains(&before), "{before}");
            assert!((0.98..1.05).contains(&after), "{after}");
        }
    }

    #[test]
    fn every_row_of_a_long_record_has_a_prediction_and_none_is_a_spike() {
        let windows = identified(12_000);
        let curves = &windows.curves;
        assert_eq!(curves.extended.len(), 20_000);
        assert_eq!(curves.time_s, dataset().validate.time_s);
        let errors = curves.extended.iter().zip(&curves.effort);
        // Noise of 2 N; about a reversal the sign may be a row off: twice the Coulomb friction.
        let apart = errors.filter(|(predicted, effort)| (*predicted - *effort).abs() > 6.0);
        assert!(apart.count() < 60);
    }

    #[test]
    fn the_report_says_how_much_was_fitted_and_a_short_record_says_nothing() {
        let fitted_on = |identification: Identification| {
            let warnings = identification.report.warnings.into_iter();
            warnings
                .filter(|warning| {
                    warning
                        .starts_with("long record: used 12000 of 20000 rows of the training record")
                })
                .count()
        };
        assert_eq!(fitted_on(identified(12_000)), 1);
        assert_eq!(fitted_on(identified(20_000)), 0);
    }
}
