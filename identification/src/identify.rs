//! The whole identification of a dataset.

use crate::error::IdentificationError;
use crate::evidence::actuator::{self, Pair};
use crate::evidence::at_reversals::{self, AtReversals, LoadScale, Witnesses};
use crate::evidence::difference::{self, Difference};
use crate::evidence::free_run::{self, Reversals};
use crate::evidence::plausibility;
use crate::evidence::residual::{
    self, Structure, UNEXPLAINED_PERCENT, UNEXPLAINED_SHARE, WHITE_SHARE,
};
use crate::evidence::reversal::{self, Presliding, bristle};
use crate::evidence::selection::{self, Selection};
use crate::evidence::slow_ripple::slow_ripple;
use crate::fit::bench::{Bench, Model};
use crate::motion::excitation;
use crate::motion::kinematics::Kinematics;
use crate::record::dataset::Dataset;
use crate::report::forms::{Curves, Errors, Identification, Report, ResidualReport};
use crate::report::free_run as free_run_errors;
use crate::report::pictures;
use crate::report::protocols;
use crate::report::ranking;

/// A model with its coefficients.
pub(crate) struct Fitted {
    pub(crate) model: Model,
    pub(crate) coefficients: Vec<f64>,
    /// Deflection of the bristle, where presliding is in the model.
    pub(crate) deflection: Option<f64>,
}

/// What was found out, by stage.
pub(crate) struct Findings<'a> {
    pub(crate) dataset: &'a Dataset,
    pub(crate) motion: &'a Kinematics,
    pub(crate) validation: &'a Kinematics,
    pub(crate) declared: Fitted,
    pub(crate) extended: Fitted,
    pub(crate) selected: Selection,
    pub(crate) difference: Option<Difference>,
    pub(crate) presliding: Option<Presliding>,
    pub(crate) reversals: Option<Reversals>,
    pub(crate) accepted: AtReversals,
}

/// Identifies a dataset. `progress` hears of every step.
///
/// # Errors
/// Where the record leaves nothing to fit.
pub fn identify(
    dataset: &Dataset,
    progress: &mut dyn FnMut(&str),
) -> Result<Identification, IdentificationError> {
    let motion = kinematics(dataset, &dataset.train)?;
    let low_cutoff = actuator::delay_cutoff_hz(dataset.train.period_s);
    let low = Kinematics::with_cutoff(dataset, &dataset.train, low_cutoff)
        .ok_or_else(|| no_room(dataset))?;
    let validation = kinematics(dataset, &dataset.validate)?;
    check_samples(dataset, &motion, &validation)?;
    plausibility::check(dataset, &motion)?;
    let (bench, low) = (Bench::new(dataset, &motion), Bench::new(dataset, &low));
    let pair = Pair {
        bench: &bench,
        low: &low,
    };
    progress("fitting the declared model");
    let mut start = selection::declared_model(dataset);
    selection::prepare(pair, &mut start);
    progress("scoring candidate effects");
    let mut selected = selection::select(pair, start.clone(), progress);
    selection::veto(
        &bench,
        &Bench::new(dataset, &validation),
        &mut selected,
        start.terms.len(),
    );
    progress("looking at motor and load");
    let coefficients = bench.fit(&selected.model).coefficients;
    let transmitted = bench.transmitted(&selected.model, &coefficients);
    let path = difference::Path {
        position: &dataset.train.position,
        transmitted: &transmitted,
    };
    let difference = difference::difference(dataset, &motion, path);
    progress("simulating reversals: stick, bristle, gap");
    let presliding = reversal::presliding(&bench, &selected.model, &coefficients);
    let mut reversals = free_run::reversals(dataset, &selected.model, &coefficients);
    let accepted = Witnesses {
        inverse: presliding,
        free_run: reversals.as_ref().map(Reversals::summary),
        load_scale: difference.as_ref().map(|found| LoadScale {
            gap: found.gap.is_some(),
        }),
    }
    .decide();
    if let Some(reversals) = &mut reversals {
        let gap = difference.as_ref().is_some_and(|d| d.gap.is_some());
        reversals.settle(accepted.presliding, accepted.backlash || gap);
    }
    // With a load scale friction is judged where it acts, not at the motor.
    let simulated = reversals.as_ref().filter(|_| difference.is_none());
    let deflection = at_reversals::deflection(
        presliding.as_ref(),
        simulated.and_then(Reversals::deflection),
    );
    let model = match &difference {
        Some(found) if found.moves_apart() => selection::with_load_inertia(&bench, &selected.model),
        _ => selected.model.clone(),
    };
    let declares_presliding = dataset.declared.iter().any(|name| name == "presliding");
    let findings = Findings {
        dataset,
        motion: &motion,
        validation: &validation,
        declared: fitted(pair, start, deflection.filter(|_| declares_presliding)),
        extended: fitted(
            pair,
            model,
            deflection.filter(|_| accepted.presliding || declares_presliding),
        ),
        selected,
        difference,
        presliding,
        reversals,
        accepted,
    };
    progress("validating");
    Ok(assemble(&findings))
}

fn check_samples(
    dataset: &Dataset,
    motion: &Kinematics,
    validation: &Kinematics,
) -> Result<(), IdentificationError> {
    let fitted = motion.fitted.iter().filter(|fitted| **fitted).count();
    if fitted < crate::record::checks::FEWEST_ROWS / 2 {
        return Err(IdentificationError::new(format!(
            "{}: only {fitted} moving samples are left for the fit; record longer runs, away from the effort's limit",
            dataset.name
        )));
    }
    if validation.moving.iter().filter(|moving| **moving).count() < crate::motion::filter::TRIM {
        return Err(IdentificationError::new(format!(
            "{}: hardly any moving samples are left in the validation record; record longer runs for it",
            dataset.name
        )));
    }
    Ok(())
}

fn kinematics(
    dataset: &Dataset,
    record: &crate::record::samples::Record,
) -> Result<Kinematics, IdentificationError> {
    Kinematics::new(dataset, record).ok_or_else(|| no_room(dataset))
}

fn no_room(dataset: &Dataset) -> IdentificationError {
    IdentificationError::new(format!(
        "{}: the sample period leaves no room for the low-pass",
        dataset.name
    ))
}

/// Fits a model on moving samples; its sign columns follow the bristle, where there is one.
fn fitted(pair: Pair<'_>, model: Model, deflection: Option<f64>) -> Fitted {
    let Some(width) = deflection else {
        let coefficients = pair.bench.fit(&model).coefficients;
        return Fitted {
            model,
            coefficients,
            deflection,
        };
    };
    let dataset = pair.bench.dataset;
    let [motion, slow] = [pair.bench, pair.low].map(|bench| bristle::motion(bench.motion, width));
    let (bench, low) = (Bench::new(dataset, &motion), Bench::new(dataset, &slow));
    let mut model = model;
    selection::refine(
        Pair {
            bench: &bench,
            low: &low,
        },
        &mut model,
    );
    let coefficients = bench.fit(&model).coefficients;
    Fitted {
        model,
        coefficients,
        deflection,
    }
}

struct Judged {
    force_percent: f64,
    reversal: f64,
    residual: Vec<f64>,
    prediction: Vec<f64>,
}

impl Fitted {
    /// The motion as this model sees it.
    pub(crate) fn motion(&self, motion: &Kinematics) -> Kinematics {
        self.deflection.map_or_else(
            || motion.clone(),
            |deflection| bristle::motion(motion, deflection),
        )
    }

    fn judge(&self, dataset: &Dataset, motion: &Kinematics) -> Judged {
        self.judge_with(dataset, motion, &self.coefficients)
    }

    fn judge_with(&self, dataset: &Dataset, motion: &Kinematics, coefficients: &[f64]) -> Judged {
        let plain = Bench::new(dataset, motion);
        let reversal = reversal::error_rms(&plain, &self.model, coefficients, self.deflection);
        let motion = self.motion(motion);
        let bench = Bench::new(dataset, &motion);
        Judged {
            force_percent: bench.force_error_percent(&self.model, coefficients),
            reversal: reversal.unwrap_or(0.0),
            prediction: bench.predict(&self.model, coefficients),
            residual: bench.residual(&self.model, coefficients),
        }
    }
}

fn assemble(findings: &Findings<'_>) -> Identification {
    let Findings {
        dataset,
        motion,
        validation,
        declared,
        extended,
        selected,
        difference,
        ..
    } = findings;
    let train = [
        declared.judge(dataset, motion),
        extended.judge(dataset, motion),
    ];
    let validate = [
        declared.judge(dataset, validation),
        extended.judge(dataset, validation),
    ];
    let slow_ripple = slow_ripple(dataset, motion, &declared.model);
    let found = found(findings, slow_ripple.is_some());
    let residual = structure(motion, &train, selected);
    let percent_left = train[1].force_percent * residual.share_after.sqrt();
    // Impacts in a gap leave structure in the force that no column of an inverse model can have.
    let has_gap = found
        .iter()
        .chain(&dataset.declared)
        .any(|name| name == "backlash");
    let matters = residual.share_after >= UNEXPLAINED_SHARE
        && percent_left >= UNEXPLAINED_PERCENT
        && !has_gap;
    let apart = difference
        .as_ref()
        .is_some_and(|d| !has_gap && leaves_much(dataset, d));
    let unexplained =
        matters || !selected.nameless.is_empty() || findings.accepted.unexplained || apart;
    let transmitted =
        Bench::new(dataset, validation).transmitted(&extended.model, &extended.coefficients);
    let path = difference::Path {
        position: &dataset.validate.position,
        transmitted: &transmitted,
    };
    let on_validation = |d: &Difference| d.on(validation, path);
    let free_run = findings
        .reversals
        .as_ref()
        .and_then(|reversals| free_run_errors::report(findings, reversals));
    let report = Report {
        dataset: dataset.name.clone(),
        declared: dataset.declared.clone(),
        candidates: ranking::candidates(findings, &found),
        train: errors(
            &train,
            difference.as_ref().map(|d| (d.before_um, d.after_um)),
        ),
        validate: errors(&validate, difference.as_ref().and_then(on_validation)),
        whole: whole(dataset, declared, extended),
        protocols: protocols::table(findings),
        residual: ResidualReport {
            looks_like: looks_like(&residual, findings, apart),
            ..residual
        },
        free_run: free_run.as_ref().map(|(report, _)| report.clone()),
        parameters: ranking::parameters(findings, slow_ripple.as_ref()),
        cutoff_hz: crate::motion::filter::fit_cutoff_hz(&dataset.train),
        as_defined: as_defined(findings),
        slow_ripple,
        verdict: if unexplained {
            "unexplained"
        } else {
            "explained"
        }
        .into(),
        warnings: excitation::warnings(dataset, motion, &found),
        found,
    };
    Identification {
        curves: Curves {
            effects: pictures::effects(findings),
            free_run: free_run.map_or_else(Vec::new, |(_, curve)| curve),
            ..curves(dataset, validation, &validate)
        },
        report,
        travel: dataset.travel(),
        residual_rms: reversal::rms(&train[1].residual, &motion.moving),
        effort_unit: dataset.effort.unit(),
        effort_column: dataset.effort.column(),
        position_unit: dataset.kind.position_unit(),
    }
}

fn found(findings: &Findings<'_>, slow_ripple: bool) -> Vec<String> {
    let accepted = [
        (findings.accepted.presliding, "presliding"),
        (findings.accepted.backlash, "backlash"),
    ];
    let at_reversals = accepted
        .into_iter()
        .filter(|(accepted, _)| *accepted)
        .map(|(_, name)| name);
    let in_difference = findings
        .difference
        .iter()
        .flat_map(|d| d.found.iter().copied());
    let ripple = slow_ripple.then_some("torque_ripple");
    let all = findings
        .selected
        .found
        .iter()
        .copied()
        .chain(at_reversals)
        .chain(in_difference)
        .chain(ripple);
    let mut list: Vec<String> = Vec::new();
    for name in all.filter(|name| {
        !findings
            .dataset
            .declared
            .iter()
            .any(|declared| declared == name)
    }) {
        if !list.iter().any(|known| known == name) {
            list.push(name.into());
        }
    }
    list
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

/// Errors with the defined low-pass, where the fit used another: training and validation record.
fn as_defined(findings: &Findings<'_>) -> Option<[Errors; 2]> {
    let Findings {
        dataset,
        declared,
        extended,
        ..
    } = findings;
    if !dataset.train.jittered {
        return None;
    }
    let on = |record: &crate::record::samples::Record| {
        let motion = Kinematics::with_cutoff(
            dataset,
            record,
            crate::motion::filter::cutoff_hz(record.period_s),
        )?;
        Some(errors(
            &[
                declared.judge(dataset, &motion),
                extended.judge(dataset, &motion),
            ],
            None,
        ))
    };
    Some([on(&dataset.train)?, on(&dataset.validate)?])
}

/// Both structures fitted to the whole file: the protocol of the published figures.
fn whole(dataset: &Dataset, declared: &Fitted, extended: &Fitted) -> Option<Errors> {
    let record = dataset.whole()?;
    let motion = Kinematics::new(dataset, &record)?;
    let judge = |fitted: &Fitted| {
        let seen = fitted.motion(&motion);
        let coefficients = Bench::new(dataset, &seen).fit(&fitted.model).coefficients;
        fitted.judge_with(dataset, &motion, &coefficients)
    };
    Some(errors(&[judge(declared), judge(extended)], None))
}

fn structure(motion: &Kinematics, train: &[Judged; 2], selected: &Selection) -> ResidualReport {
    let shares = |judged: &Judged| residual::structures(motion, &judged.residual);
    let (before, after) = (shares(&train[0]), shares(&train[1]));
    let best = |round: usize| {
        let of_round = selected
            .scored
            .iter()
            .filter(|scored| scored.round == round && scored.physical);
        of_round.map(|scored| scored.gain.share).fold(0.0, f64::max)
    };
    let last = selected
        .scored
        .iter()
        .map(|scored| scored.round)
        .max()
        .unwrap_or(0);
    let largest = |list: &[Structure]| list.first().map_or(0.0, |structure| structure.share);
    let share_before = largest(&before).max(best(0));
    let share_after = largest(&after).max(best(last));
    ResidualReport {
        white_before: share_before < WHITE_SHARE,
        white_after: share_after < WHITE_SHARE,
        share_before,
        share_after,
        looks_like: after
            .first()
            .map_or(String::new(), |structure| structure.over.into()),
    }
}

/// What motor − load may keep: µm (µrad), and counts of the coarser encoder.
const LARGEST_DIFFERENCE_UM: f64 = 3.0;
const LARGEST_DIFFERENCE_COUNTS: f64 = 10.0;

fn leaves_much(dataset: &Dataset, difference: &Difference) -> bool {
    let counts = 1.0e-6 * difference.after_um
        / dataset
            .resolution
            .max(dataset.load_resolution)
            .max(f64::MIN_POSITIVE);
    difference.after_um > LARGEST_DIFFERENCE_UM && counts > LARGEST_DIFFERENCE_COUNTS
}

fn looks_like(residual: &ResidualReport, findings: &Findings<'_>, apart: bool) -> String {
    let mut parts: Vec<String> = findings
        .selected
        .nameless
        .iter()
        .map(|name| format!("a {name}"))
        .collect();
    if residual.share_after >= WHITE_SHARE && !residual.looks_like.is_empty() {
        parts.push(format!(
            "structure over {} ({:.0} % of the residual)",
            residual.looks_like,
            100.0 * residual.share_after
        ));
    }
    if findings.accepted.unexplained {
        parts.push("structure at reversals that is neither stick nor a bristle nor a gap".into());
    }
    if apart {
        parts.push(
            "motor and load that move apart otherwise than by a gap, a stiffness or a pitch error"
                .into(),
        );
    }
    parts.join("; ")
}

fn curves(dataset: &Dataset, motion: &Kinematics, validation: &[Judged; 2]) -> Curves {
    let moving = (0..motion.len()).filter(|at| motion.moving[*at]).map(|at| {
        [
            motion.velocity_lp[at],
            motion.position_lp[at],
            validation[0].residual[at],
            validation[1].residual[at],
        ]
    });
    // One row per row of the record: predictions go back from the uniform base to the time stamps
    // of the file.
    let origin = dataset.validate.rows.first().map_or(0.0, |row| row.0)
        - motion.time_s.first().copied().unwrap_or(0.0);
    let at: Vec<f64> = dataset
        .validate
        .rows
        .iter()
        .map(|(t, _)| t - origin)
        .collect();
    let even = !dataset.validate.jittered && at.len() == motion.len();
    let on_rows = |values: &[f64]| {
        if even {
            values.to_vec()
        } else {
            crate::record::time_base::interpolate(&motion.time_s, values, &at)
        }
    };
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
        ..Curves::default()
    }
}

/// Coulomb friction as the declared model alone sees it; for feedforward.
///
/// # Errors
/// Where the declared model has no Coulomb friction, or the record leaves nothing to fit.
pub fn declared_coulomb(dataset: &Dataset) -> Result<f64, IdentificationError> {
    let motion = kinematics(dataset, &dataset.train)?;
    let model = selection::declared_model(dataset);
    let place = model
        .terms
        .iter()
        .position(|term| term.effect.name() == "coulomb");
    let fit = Bench::new(dataset, &motion).fit(&model);
    // The declared effects in front of it have one column each.
    place
        .and_then(|place| fit.coefficients.get(place).copied())
        .ok_or_else(|| {
            IdentificationError::new(format!(
                "{}: the declared model has no Coulomb friction",
                dataset.name
            ))
        })
}
