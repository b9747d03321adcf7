//! The whole identification of a dataset, and what is said about it.

use serde::Serialize;

use crate::difference::{self, Difference};
use crate::effects::{Named, Naming};
use crate::error::IdentificationError;
use crate::excitation;
use crate::kinematics::Kinematics;
use crate::record::{Dataset, Record};
use crate::residual::{self, Structure, UNEXPLAINED_PERCENT, UNEXPLAINED_SHARE, WHITE_SHARE};
use crate::reversal::{self, Reversal, bristle};
use crate::actuator::{self, Pair};
use crate::bench::{Bench, Model, Term};
use crate::selection::{self, Scored, Selection};

/// A candidate in the ranking.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Candidate {
    /// Effect.
    pub effect: String,
    /// Error if this effect alone is added to the declared model, percent: of the force on the validation record, or, for effects judged on motor − load,
    /// what is left of that difference on held-out blocks.
    pub validation_error_percent: Option<f64>,
    /// Evidence: mean over standard error of its gain on held-out blocks, in the round in which it stood best.
    pub evidence: f64,
    /// Share of the held-out error that it removes.
    pub share: f64,
    /// On which measured output it was judged.
    pub judged_on: &'static str,
    /// Whether what was fitted can be this effect.
    pub physical: bool,
    /// Whether it was accepted.
    pub accepted: bool,
}

/// Errors on one record.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Errors {
    /// Force error of the declared model over moving samples.
    pub force_error_before_percent: f64,
    /// Force error of the extended model.
    pub force_error_after_percent: f64,
    /// Rms of the force that is not explained about reversals and rests, declared; in the unit of the effort.
    pub reversal_error_before: f64,
    /// The same, extended.
    pub reversal_error_after: f64,
    /// Rms of motor − load that is not explained, declared.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub position_difference_error_um_before: Option<f64>,
    /// The same, extended.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub position_difference_error_um_after: Option<f64>,
}

/// Whether structure is left.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct ResidualReport {
    /// Declared model.
    pub white_before: bool,
    /// Extended model.
    pub white_after: bool,
    /// Share of the residual's variance that features explain on held-out blocks, declared.
    pub share_before: f64,
    /// The same, extended.
    pub share_after: f64,
    /// What the structure that is left looks like, where there is any.
    pub looks_like: String,
}

/// A parameter with its interval.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Parameter {
    /// Value.
    pub value: f64,
    /// Unit.
    pub unit: String,
    /// Lower end of the 95 % interval; the value itself for nonlinear parameters.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

/// What was found, in the form of `identify --json`.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Report {
    /// Dataset.
    pub dataset: String,
    /// Declared effects.
    pub declared: Vec<String>,
    /// Effects that were lacking, in order of contribution.
    pub found: Vec<String>,
    /// Ranking.
    pub candidates: Vec<Candidate>,
    /// Errors on the training record.
    pub train: Errors,
    /// Errors on the validation record.
    pub validate: Errors,
    /// Errors on the whole file, where validation is its last part: the declared and the extended structure fitted to all of it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub whole: Option<Errors>,
    /// Structure left.
    pub residual: ResidualReport,
    /// Parameters of the extended model.
    pub parameters: std::collections::BTreeMap<String, Parameter>,
    /// `explained` or `unexplained`.
    pub verdict: String,
    /// What the record cannot say.
    pub warnings: Vec<String>,
}

/// Curves for pictures and `prediction.csv`.
#[derive(Clone, Debug, Default)]
pub struct Curves {
    /// Validation record: time, s.
    pub time_s: Vec<f64>,
    /// Recorded effort; where a known lag stands between the recorded and the acting effort, the acting one, which is what the predictions are of.
    pub effort: Vec<f64>,
    /// Prediction of the declared model, not low-passed.
    pub declared: Vec<f64>,
    /// Prediction of the extended model, not low-passed.
    pub extended: Vec<f64>,
    /// Moving samples of the validation record: velocity, position, residual declared, residual extended.
    pub moving: Vec<[f64; 4]>,
}

/// Everything that came out.
#[derive(Clone, Debug, Default)]
pub struct Identification {
    /// The report.
    pub report: Report,
    /// Curves.
    pub curves: Curves,
    /// Unit of the effort.
    pub effort_unit: &'static str,
    /// Name of the effort column.
    pub effort_column: &'static str,
    /// Unit of the position.
    pub position_unit: &'static str,
}

struct Fitted {
    model: Model,
    coefficients: Vec<f64>,
    reversal: Option<Reversal>,
}

/// Identifies a dataset. `progress` hears of every step.
///
/// # Errors
/// Where the record leaves nothing to fit.
pub fn identify(dataset: &Dataset, progress: &mut dyn FnMut(&str)) -> Result<Identification, IdentificationError> {
    let motion = kinematics(dataset, &dataset.train)?;
    let low_cutoff = actuator::delay_cutoff_hz(dataset.train.period_s);
    let low = Kinematics::with_cutoff(dataset, &dataset.train, low_cutoff).ok_or_else(|| no_room(dataset))?;
    let moving = motion.moving.iter().filter(|moving| **moving).count();
    if moving < crate::record::FEWEST_ROWS / 2 {
        return Err(IdentificationError::new(format!(
            "{}: only {moving} moving samples are left for the fit; record longer runs",
            dataset.name
        )));
    }
    let validation = kinematics(dataset, &dataset.validate)?;
    if validation.moving.iter().filter(|moving| **moving).count() < crate::filter::TRIM {
        return Err(IdentificationError::new(format!(
            "{}: hardly any moving samples are left in the validation record; record longer runs for it",
            dataset.name
        )));
    }
    let bench = Bench::new(dataset, &motion);
    let low = Bench::new(dataset, &low);
    let pair = Pair { bench: &bench, low: &low };
    progress("fitting the declared model");
    let mut declared = selection::declared_model(dataset);
    selection::prepare(pair, &mut declared);
    let start = declared.clone();
    let declared = fitted(pair, declared, dataset.declared.iter().any(|name| name == "presliding"));
    progress("scoring candidate effects");
    let selected = selection::select(pair, start, progress);
    let extended = fitted(pair, selected.model.clone(), true);
    progress("looking at motor and load");
    let difference = difference::difference(dataset, &motion);
    progress("validating");
    Ok(assemble(dataset, &motion, &declared, &extended, &selected, difference.as_ref()))
}

fn kinematics(dataset: &Dataset, record: &Record) -> Result<Kinematics, IdentificationError> {
    Kinematics::new(dataset, record).ok_or_else(|| no_room(dataset))
}

fn no_room(dataset: &Dataset) -> IdentificationError {
    IdentificationError::new(format!("{}: the sample period leaves no room for the low-pass", dataset.name))
}

/// Fits a model on moving samples and judges presliding with it.
fn fitted(pair: Pair<'_>, model: Model, with_presliding: bool) -> Fitted {
    let bench = pair.bench;
    let coefficients = bench.fit(&model).coefficients;
    let reversal = reversal::judge(bench, &model, &coefficients);
    let used = reversal.filter(|r| with_presliding && r.presliding);
    let Some(accepted) = used else { return Fitted { model, coefficients, reversal } };
    // The sign columns follow the bristle now; everything that depends on them is refined again.
    let [motion, slow] = [bench, pair.low].map(|bench| bristle::motion(bench.motion, accepted.deflection));
    let (bench, low) = (Bench::new(bench.dataset, &motion), Bench::new(bench.dataset, &slow));
    let mut model = model;
    selection::refine(Pair { bench: &bench, low: &low }, &mut model);
    let coefficients = bench.fit(&model).coefficients;
    Fitted { model, coefficients, reversal }
}

struct Judged {
    force_percent: f64,
    reversal: f64,
    residual: Vec<f64>,
    prediction: Vec<f64>,
}

impl Fitted {
    fn uses_presliding(&self, allowed: bool) -> Option<f64> {
        self.reversal.filter(|r| allowed && r.presliding).map(|r| r.deflection)
    }

    fn judge(&self, dataset: &Dataset, motion: &Kinematics, presliding: bool) -> Judged {
        self.judge_with(dataset, motion, presliding, &self.coefficients)
    }

    fn judge_with(&self, dataset: &Dataset, motion: &Kinematics, presliding: bool, coefficients: &[f64]) -> Judged {
        let deflection = self.uses_presliding(presliding);
        let bristle = deflection.map(|deflection| bristle::motion(motion, deflection));
        let reversal = self.reversal.filter(|_| presliding);
        let reversal = reversal::error_rms(&Bench::new(dataset, motion), &self.model, coefficients, reversal.as_ref());
        let bench = Bench::new(dataset, bristle.as_ref().unwrap_or(motion));
        let residual = bench.residual(&self.model, coefficients);
        Judged {
            force_percent: bench.force_error_percent(&self.model, coefficients),
            reversal: reversal.unwrap_or(0.0),
            prediction: bench.predict(&self.model, coefficients),
            residual,
        }
    }
}

fn assemble(
    dataset: &Dataset,
    motion: &Kinematics,
    declared: &Fitted,
    extended: &Fitted,
    selected: &Selection,
    difference: Option<&Difference>,
) -> Identification {
    let declares_presliding = dataset.declared.iter().any(|name| name == "presliding");
    let train = [declared.judge(dataset, motion, declares_presliding), extended.judge(dataset, motion, true)];
    let validation_motion = Kinematics::new(dataset, &dataset.validate);
    let validation_motion = validation_motion.as_ref().unwrap_or(motion);
    let validation = [
        declared.judge(dataset, validation_motion, declares_presliding),
        extended.judge(dataset, validation_motion, true),
    ];
    let found = found(dataset, selected, extended, difference);
    let residual = structure(motion, &train, selected);
    let percent_left = train[1].force_percent * residual.share_after.sqrt();
    let matters = residual.share_after >= UNEXPLAINED_SHARE && percent_left >= UNEXPLAINED_PERCENT;
    let suspicious = reversal_suspicion(extended, difference);
    let unexplained = matters || !selected.nameless.is_empty() || suspicious;
    let report = Report {
        dataset: dataset.name.clone(),
        declared: dataset.declared.clone(),
        candidates: candidates(dataset, motion, validation_motion, selected, extended, difference, &found),
        found,
        train: errors(&train, difference.map(|d| (d.before_um, d.after_um))),
        validate: errors(&validation, difference.and_then(|d| d.on(validation_motion, &dataset.validate.position))),
        whole: whole(dataset, declared, extended, declares_presliding),
        residual: ResidualReport { looks_like: looks_like(&residual, selected, suspicious), ..residual },
        parameters: parameters(dataset, motion, extended, difference),
        verdict: if unexplained { "unexplained" } else { "explained" }.into(),
        warnings: excitation::warnings(dataset, motion),
    };
    Identification {
        curves: curves(dataset, validation_motion, &validation),
        report,
        effort_unit: dataset.effort.unit(),
        effort_column: dataset.effort.column(),
        position_unit: dataset.kind.position_unit(),
    }
}

fn found(dataset: &Dataset, selected: &Selection, extended: &Fitted, difference: Option<&Difference>) -> Vec<String> {
    let mut found: Vec<String> = selected.found.iter().map(|name| (*name).to_owned()).collect();
    let declared = |name: &str| dataset.declared.iter().any(|declared| declared == name);
    if extended.uses_presliding(true).is_some() && !declared("presliding") {
        found.push("presliding".into());
    }
    if extended.reversal.is_some_and(|r| r.backlash) && !declared("backlash") {
        found.push("backlash".into());
    }
    found.extend(difference.into_iter().flat_map(|d| &d.found).map(|name| (*name).to_owned()));
    found
}

fn errors(judged: &[Judged; 2], difference_um: Option<(f64, f64)>) -> Errors {
    Errors {
        force_error_before_percent: judged[0].force_percent,
        force_error_after_percent: judged[1].force_percent,
        reversal_error_before: judged[0].reversal,
        reversal_error_after: judged[1].reversal,
        position_difference_error_um_before: difference_um.map(|(before, _)| before),
        position_difference_error_um_after: difference_um.map(|(_, after)| after),
    }
}

/// Both structures fitted to the whole file: the protocol of the published figures.
fn whole(dataset: &Dataset, declared: &Fitted, extended: &Fitted, declares_presliding: bool) -> Option<Errors> {
    let record = dataset.whole()?;
    let motion = Kinematics::new(dataset, &record)?;
    let judge = |fitted: &Fitted, presliding: bool| {
        let bristle =
            fitted.uses_presliding(presliding).map(|deflection| bristle::motion(&motion, deflection));
        let bench = Bench::new(dataset, bristle.as_ref().unwrap_or(&motion));
        let coefficients = bench.fit(&fitted.model).coefficients;
        fitted.judge_with(dataset, &motion, presliding, &coefficients)
    };
    Some(errors(&[judge(declared, declares_presliding), judge(extended, true)], None))
}

fn structure(motion: &Kinematics, train: &[Judged; 2], selected: &Selection) -> ResidualReport {
    let shares = |judged: &Judged| residual::structures(motion, &judged.residual);
    let (before, after) = (shares(&train[0]), shares(&train[1]));
    let best = |round: usize| {
        let of_round = selected.scored.iter().filter(|scored| scored.round == round && scored.physical);
        of_round.map(|scored| scored.gain.share).fold(0.0, f64::max)
    };
    let last = selected.scored.iter().map(|scored| scored.round).max().unwrap_or(0);
    let largest = |list: &[Structure]| list.first().map_or(0.0, |structure| structure.share);
    let share_before = largest(&before).max(best(0));
    let share_after = largest(&after).max(best(last));
    ResidualReport {
        white_before: share_before < WHITE_SHARE,
        white_after: share_after < WHITE_SHARE,
        share_before,
        share_after,
        looks_like: after.first().map_or(String::new(), |structure| structure.over.into()),
    }
}

/// Something acts at reversals that neither rigid Coulomb friction nor an accepted effect explains.
fn reversal_suspicion(extended: &Fitted, difference: Option<&Difference>) -> bool {
    let has_gap = difference.is_some_and(|d| d.gap.is_some());
    let unexplained = |r: Reversal| !r.presliding && !r.backlash && r.dahl < reversal::SUSPICION * r.rigid;
    extended.reversal.is_some_and(unexplained) && !has_gap
}

fn looks_like(residual: &ResidualReport, selected: &Selection, suspicious: bool) -> String {
    let mut parts: Vec<String> = selected.nameless.iter().map(|name| format!("a {name}")).collect();
    if residual.share_after >= WHITE_SHARE && !residual.looks_like.is_empty() {
        parts.push(format!(
            "structure over {} ({:.0} % of the residual)",
            residual.looks_like,
            100.0 * residual.share_after
        ));
    }
    if suspicious {
        parts.push("structure at reversals that is neither stick nor a bristle".into());
    }
    parts.join("; ")
}

fn candidates(
    dataset: &Dataset,
    motion: &Kinematics,
    validation: &Kinematics,
    selected: &Selection,
    extended: &Fitted,
    difference: Option<&Difference>,
    found: &[String],
) -> Vec<Candidate> {
    let mut list: Vec<Candidate> = Vec::new();
    for scored in &selected.scored {
        let known = list.iter_mut().find(|candidate| candidate.effect == scored.effect);
        match known {
            Some(known) if known.share >= scored.gain.share => {}
            Some(known) => (known.share, known.evidence) = (scored.gain.share, scored.gain.t),
            None => list.push(force_candidate(dataset, motion, validation, scored)),
        }
    }
    let removed = |after: f64, before: f64| 1.0 - (after / before.max(f64::MIN_POSITIVE)).powi(2);
    list.extend(extended.reversal.map(|r| Candidate {
        effect: "presliding".into(),
        validation_error_percent: Some(with_bristle(dataset, motion, validation, r.deflection)),
        evidence: r.t,
        share: removed(r.dahl, r.rigid),
        judged_on: "effort about reversals",
        physical: r.deflection >= reversal::resolution(dataset),
        accepted: r.presliding,
    }));
    list.extend(extended.reversal.filter(|_| difference.is_none()).map(|r| Candidate {
        effect: "backlash".into(),
        validation_error_percent: None,
        evidence: r.gap_t,
        share: removed(r.gap_about, r.rigid_about),
        judged_on: "effort about reversals",
        physical: r.gap.width >= reversal::resolution(dataset),
        accepted: r.backlash,
    }));
    list.extend(difference.into_iter().flat_map(|d| &d.scored).filter(|s| s.round == 0).map(|scored| Candidate {
        effect: scored.effect.into(),
        // Of the position difference: what is left of its rms on held-out blocks.
        validation_error_percent: Some(100.0 * (1.0 - scored.gain.share).max(0.0).sqrt()),
        evidence: scored.gain.t,
        share: scored.gain.share,
        judged_on: "motor - load position",
        physical: scored.physical,
        accepted: scored.accepted,
    }));
    for candidate in &mut list {
        candidate.accepted = found.contains(&candidate.effect);
    }
    list.sort_by(|a, b| b.accepted.cmp(&a.accepted).then(b.share.total_cmp(&a.share)));
    list
}

/// Force error on the validation record of the declared model with a bristle in place of the sign.
fn with_bristle(dataset: &Dataset, motion: &Kinematics, validation: &Kinematics, deflection: f64) -> f64 {
    let model = selection::declared_model(dataset);
    let (train, validate) =
        (bristle::motion(motion, deflection), bristle::motion(validation, deflection));
    let coefficients = Bench::new(dataset, &train).fit(&model).coefficients;
    Bench::new(dataset, &validate).force_error_percent(&model, &coefficients)
}

fn force_candidate(dataset: &Dataset, motion: &Kinematics, validation: &Kinematics, scored: &Scored) -> Candidate {
    let mut model = selection::declared_model(dataset);
    match crate::effects::find(scored.effect) {
        Some(effect) => model.terms.push(Term { effect, parameter: scored.parameter }),
        None if scored.effect == "delay" => model.delay_s = scored.parameter,
        None => model = actuator::linearised(&Bench::new(dataset, motion), &model, scored.parameter),
    }
    let coefficients = Bench::new(dataset, motion).fit(&model).coefficients;
    let error = Bench::new(dataset, validation).force_error_percent(&model, &coefficients);
    Candidate {
        effect: scored.effect.into(),
        validation_error_percent: Some(error),
        evidence: scored.gain.t,
        share: scored.gain.share,
        judged_on: "effort of moving samples",
        physical: scored.physical,
        accepted: scored.accepted,
    }
}

fn parameters(
    dataset: &Dataset,
    motion: &Kinematics,
    extended: &Fitted,
    difference: Option<&Difference>,
) -> std::collections::BTreeMap<String, Parameter> {
    let bristle = extended.uses_presliding(true).map(|deflection| bristle::motion(motion, deflection));
    let bench = Bench::new(dataset, bristle.as_ref().unwrap_or(motion));
    let half_widths = bench.half_widths(&extended.model);
    let mut rest = extended.coefficients.iter().copied().zip(half_widths);
    let mut named: Vec<Named> = Vec::new();
    for term in &extended.model.terms {
        let columns = term.effect.columns(motion, dataset, term.parameter).len();
        let own: Vec<(f64, f64)> = rest.by_ref().take(columns).collect();
        let naming = Naming { parameter: term.parameter, coefficients: &own, dataset };
        for mut parameter in term.effect.parameters(&naming) {
            let times = named.iter().filter(|known| known.name.starts_with(&parameter.name)).count();
            if times > 0 {
                parameter.name = format!("{}_{}", parameter.name, times + 1);
            }
            named.push(parameter);
        }
    }
    let length = dataset.kind.position_unit();
    let plain =
        |name: &str, value: f64, unit: &str| Named { name: name.into(), value, half_width: None, unit: unit.into() };
    if extended.model.delay_s != 0.0 {
        named.push(plain("delay", extended.model.delay_s, "s"));
    }
    if extended.model.saturates() {
        let unit = format!("1/{}", dataset.effort.unit());
        named.push(plain("torque_saturation", extended.model.saturation.per_effort, &unit));
    }
    named.extend(extended.uses_presliding(true).map(|deflection| plain("presliding_deflection", deflection, length)));
    if let Some(reversal) = extended.reversal.filter(|r| r.backlash) {
        named.push(plain("backlash_gap", reversal.gap.width, length));
        named.push(plain("backlash_load_share", reversal.gap.share, "of the moved mass"));
    }
    named.extend(difference.and_then(|d| d.gap).map(|gap| plain("backlash_gap", gap, length)));
    let stiffness_unit = format!("{}/{length}", dataset.effort.unit());
    named.extend(difference.and_then(|d| d.stiffness).map(|k| plain("compliance_stiffness", k, &stiffness_unit)));
    named
        .into_iter()
        .map(|n| {
            let half = n.half_width.unwrap_or(0.0);
            (n.name, Parameter { value: n.value, unit: n.unit, low: n.value - half, high: n.value + half })
        })
        .collect()
}

fn curves(dataset: &Dataset, motion: &Kinematics, validation: &[Judged; 2]) -> Curves {
    let moving = (0..motion.len()).filter(|at| motion.moving[*at]).map(|at| {
        [motion.velocity_lp[at], motion.position_lp[at], validation[0].residual[at], validation[1].residual[at]]
    });
    // One row per row of the record: predictions go back from the uniform base to the time stamps of the file.
    let origin = dataset.validate.rows.first().map_or(0.0, |row| row.0) - motion.time_s.first().copied().unwrap_or(0.0);
    let at: Vec<f64> = dataset.validate.rows.iter().map(|(t, _)| t - origin).collect();
    let even = at.len() == motion.len();
    let on_rows =
        |values: &[f64]| if even { values.to_vec() } else { crate::record::interpolate(&motion.time_s, values, &at) };
    Curves {
        time_s: dataset.validate.rows.iter().map(|(t, _)| *t).collect(),
        effort: if dataset.effort_lag_s > 0.0 {
            on_rows(&motion.effort)
        } else {
            dataset.validate.rows.iter().map(|(_, e)| *e).collect()
        },
        declared: on_rows(&validation[0].prediction),
        extended: on_rows(&validation[1].prediction),
        moving: moving.collect(),
    }
}

/// Coulomb friction as the declared model alone sees it; for feedforward.
///
/// # Errors
/// Where the declared model has no Coulomb friction, or the record leaves nothing to fit.
pub fn declared_coulomb(dataset: &Dataset) -> Result<f64, IdentificationError> {
    let motion = kinematics(dataset, &dataset.train)?;
    let model = selection::declared_model(dataset);
    let place = model.terms.iter().position(|term| term.effect.name() == "coulomb");
    let fit = Bench::new(dataset, &motion).fit(&model);
    // The declared effects in front of it have one column each.
    place.and_then(|place| fit.coefficients.get(place).copied()).ok_or_else(|| {
        IdentificationError::new(format!("{}: the declared model has no Coulomb friction", dataset.name))
    })
}
