//! What a record cannot know: declared effects whose forces it cannot tell apart.
//!
//! A record at one speed does not tell viscous friction from drag, one without slow motion knows
//! nothing of a Stribeck fall. Their columns are (nearly) dependent: the fit leaves as little as
//! any, but its coefficients are differences of large numbers, and on another motion they predict
//! anything. So the declared model is asked how far its prediction would change had a part of the
//! training record been another one (the jackknife over blocks, [`Bench::uncertainty_on`]), on the
//! training record and on the other one. Where that is more than
//! [`KNOWN_PERCENT`] of the effort, the effect is
//! dropped that costs nothing on held-out blocks of the training record and makes the prediction
//! certain, and a remark says so. An effect that the training record does show is never
//! dropped.
//!
//! What stays may still be too uncertain for the motion of the validation record. Where it is, and
//! is wrong there, the record is `unexplained` ([`reason`]).

use std::borrow::Cow;

use axis_model::EffectName;

use crate::evidence::inverse_dynamics::InverseDynamics;
use crate::evidence::selection::is_enough;
use crate::evidence::thresholds::{KNOWN_GAIN, KNOWN_PERCENT, LEFT_PERCENT};
use crate::evidence::verdict::Reason;
use crate::fit::bench::Bench;
use crate::fit::blocks::Gain;
use crate::fit::tuning::{self, Pair};
use crate::model::inverse::{Model, Part};
use crate::motion::kinematics::Kinematics;
use crate::motion::motions::Motions;
use crate::record::dataset::Dataset;

/// The dataset without the declared effects that its training record cannot know. Effects that the
/// selection `brought_back` are known: an effect that was not declared was in their way.
pub(crate) fn known<'a>(
    dataset: &'a Dataset,
    motions: &Motions,
    brought_back: &[EffectName],
) -> Cow<'a, Dataset> {
    let [bench, low, other] = [&motions.train, &motions.train_low, &motions.validate]
        .map(|motion| Bench::new(dataset, motion));
    let pair = Pair {
        bench: &bench,
        low: &low,
    };
    let mut known = Cow::Borrowed(dataset);
    let mut model = Model::declared(dataset);
    tuning::prepare(pair, &mut model);
    while let Some(unknown) = unknown([&bench, &other], &model, brought_back) {
        let note = unknown.words();
        model = unknown.rest;
        tuning::refine(pair, &mut model);
        let name = unknown.effect;
        let mut rest = known.into_owned().with_note(note);
        rest.declared.retain(|declared| *declared != name);
        known = Cow::Owned(rest);
    }
    known
}

/// An effect that a record cannot know.
struct Unknown {
    effect: EffectName,
    /// Uncertainty of the prediction with it and without it, percent of the effort.
    percent: [f64; 2],
    /// The model without it.
    rest: Model,
}

impl Unknown {
    fn words(&self) -> String {
        let Self {
            effect,
            percent: [with, without],
            ..
        } = self;
        let with = if *with < 1.0e4 {
            format!("{with:.0} %")
        } else {
            "more than a hundred times".into()
        };
        format!(
            "{effect} is declared, but the training record cannot tell its force from that of the other effects: with it the prediction is uncertain by {with} of the effort, without it by {without:.1} %; it is left out, {effect} is unknown; {}",
            advice(*effect)
        )
    }
}

/// What would tell an effect from the others.
fn advice(effect: EffectName) -> &'static str {
    match effect {
        EffectName::Stribeck => "record slow runs too, at several speeds about its fall",
        EffectName::Inertia => "record higher accelerations",
        EffectName::Viscous
        | EffectName::Coulomb
        | EffectName::QuadraticDrag
        | EffectName::ViscousAsymmetry => {
            "record runs at several speeds, from slow to fast, in both directions"
        }
        EffectName::FrictionDrift => "record longer, with the same motion all the time",
        EffectName::TorqueSaturation => "record efforts up to the limit",
        _ => "record runs over the whole travel, at several speeds and accelerations",
    }
}

/// The effect that is dropped next, of those that the training record does not miss: one without
/// which the prediction is known.
fn unknown(
    benches: [&Bench<'_>; 2],
    model: &Model,
    brought_back: &[EffectName],
) -> Option<Unknown> {
    let before = uncertainty(benches, model);
    if before <= KNOWN_PERCENT {
        return None;
    }
    let without = |part: &Part| {
        let rest = model.without(part);
        let percent = [before, uncertainty(benches, &rest)];
        let is_free = percent[1] < KNOWN_GAIN * before && !is_missed(benches[0], model, &rest);
        let effect = part.called().name().filter(|_| is_free)?;
        if brought_back.contains(&effect) {
            return None;
        }
        Some(Unknown {
            effect,
            percent,
            rest,
        })
    };
    let forces = model.parts.iter().filter(|part| part.width() > 0);
    // Of two that may go, the later one of the library: the plain effects stand at its head.
    let unknown = forces.filter_map(without);
    unknown.max_by_key(|unknown| unknown.percent[1] <= KNOWN_PERCENT)
}

/// Whether held-out blocks of the training record miss an effect.
fn is_missed(bench: &Bench<'_>, with: &Model, without: &Model) -> bool {
    let [with, without] = [with, without].map(|model| bench.cross_validate(model));
    is_enough(&Gain::of(&without, &with))
}

/// What a prediction says that is wrong on the validation record, and that the training record was
/// not certain of.
pub(crate) fn reason(
    dataset: &Dataset,
    motions: [&Kinematics; 2],
    model: &InverseDynamics,
    error_percent: f64,
) -> Option<Reason> {
    let seen = motions.map(|motion| model.motion(motion));
    let [train, other] = seen.each_ref().map(|motion| Bench::new(dataset, motion));
    let uncertain = || train.uncertainty_on(&other, model.fitted.model());
    let percent = Some(error_percent).filter(|percent| *percent > LEFT_PERCENT);
    let percent = percent.map(|_| uncertain()).filter(|u| *u > LEFT_PERCENT);
    percent.map(|percent| {
        Reason::unexplained(format!(
            "the training record does not know enough for the motion of the validation record: its prediction there is uncertain by {percent:.0} % of the effort, and off by {error_percent:.0} %; record the speeds and accelerations of both in the training record"
        ))
    })
}

/// Half width of the prediction's 95 % interval, rms over the record that is worse, percent of its
/// effort.
fn uncertainty(benches: [&Bench<'_>; 2], model: &Model) -> f64 {
    let [train, other] = benches;
    let on = |bench| train.uncertainty_on(bench, model);
    f64::max(on(train), on(other))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::made::on;
    use crate::fit::tuning::delay_cutoff_hz;
    use crate::simulate::made;

    const PERIOD_S: f64 = 1.0e-3;

    /// 20 s there and back, turned within a few rows, with a speed for each way.
    fn path(speeds: &[f64]) -> Vec<f64> {
        const WAY_ROWS: usize = 600;
        let speed = |row: usize| {
            let way = row / WAY_ROWS;
            let sign = if way.is_multiple_of(2) { 1.0 } else { -1.0 };
            sign * speeds[(way / 2) % speeds.len()]
        };
        let (mut velocity, mut position) = (0.0_f64, 0.0);
        let steps = (0..20_000).map(|row| {
            let step = 50.0 * PERIOD_S;
            velocity += (speed(row) - velocity).clamp(-step, step);
            position += PERIOD_S * velocity;
            position
        });
        steps.collect()
    }

    /// 50 kg, 300 N s/m, 30 N and 5 N along a path, with 0.5 N of noise; Stribeck is declared too.
    fn dataset([train, validate]: [&[f64]; 2]) -> Dataset {
        let record = |speeds: &[f64]| {
            let mut record = made::record(PERIOD_S, path(speeds));
            let x = &record.position;
            let at = |row: usize| x[row.clamp(1, x.len() - 2)];
            let effort = (0..x.len()).map(|row| {
                let (before, now, after) = (at(row.max(1) - 1), at(row), at(row + 1));
                let velocity = (after - before) / (2.0 * PERIOD_S);
                let acceleration = (after - 2.0 * now + before) / PERIOD_S.powi(2);
                let noise = (0.37 * (row * row % 1009) as f64).sin();
                50.0 * acceleration + 300.0 * velocity + 30.0 * velocity.signum() + 5.0 + noise
            });
            record.effort = effort.collect();
            record
        };
        let mut dataset = on(record(train)).dataset;
        dataset.validate = record(validate);
        dataset.declared.push(EffectName::Stribeck);
        dataset
    }

    /// What is left of the declaration, and what is told.
    fn told(speeds: [&[f64]; 2]) -> (Vec<EffectName>, Vec<String>) {
        let dataset = dataset(speeds);
        let motions = Motions::of(&dataset, delay_cutoff_hz(PERIOD_S)).unwrap();
        let known = known(&dataset, &motions, &[]);
        let news = known.notes[dataset.notes.len()..].to_vec();
        (known.declared.clone(), news)
    }

    #[test]
    fn what_a_record_at_one_speed_cannot_know_is_left_out_and_told() {
        let (declared, notes) = told([&[0.05], &[0.002, 0.01, 0.05, 0.2]]);
        assert_eq!(declared.len(), 4, "{declared:?}");
        assert!(!declared.contains(&EffectName::Stribeck));
        assert_eq!(notes.len(), 1);
        assert!(
            notes[0].starts_with("stribeck is declared, but the training record cannot tell"),
            "{notes:?}"
        );
        assert!(notes[0].ends_with("record slow runs too, at several speeds about its fall"));
    }

    #[test]
    fn what_several_speeds_tell_apart_stays_even_where_it_is_nothing() {
        let speeds: &[f64] = &[0.002, 0.01, 0.05, 0.2];
        let (declared, notes) = told([speeds, speeds]);
        assert_eq!((declared.len(), notes.len()), (5, 0), "{notes:?}");
    }

    #[test]
    fn a_prediction_is_as_uncertain_as_its_columns_are_alike() {
        let dataset = dataset([&[0.05], &[0.05]]);
        let motion = Kinematics::new(&dataset, &dataset.train).unwrap();
        let bench = Bench::new(&dataset, &motion);
        let of = |model: &Model| uncertainty([&bench, &bench], model);
        let four = Model::declared(&dataset)
            .without(Model::declared(&dataset).of(EffectName::Stribeck).unwrap());
        assert!(of(&four) < 0.5, "{}", of(&four));
        assert!(unknown([&bench, &bench], &four, &[]).is_none());
    }

    #[test]
    fn a_wrong_prediction_counts_where_the_training_record_was_not_certain_of_it() {
        let counts = |train: &[f64], error_percent: f64| {
            let dataset = dataset([train, &[0.002, 0.01, 0.05, 0.2]]);
            let motion = Kinematics::new(&dataset, &dataset.train).unwrap();
            let other = Kinematics::new(&dataset, &dataset.validate).unwrap();
            // Stribeck is the last of its parts.
            let model = Model::declared(&dataset).with_parameter(4, 0.02);
            let model = InverseDynamics {
                fitted: Bench::new(&dataset, &motion).fit(&model),
                bristle: None,
                by_the_load: None,
                slips_at: None,
            };
            reason(&dataset, [&motion, &other], &model, error_percent).is_some()
        };
        assert!(counts(&[0.05], 30.0) && !counts(&[0.05], 11.0));
        assert!(!counts(&[0.002, 0.01, 0.05, 0.2], 30.0));
    }
}
