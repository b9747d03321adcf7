//! The difference of motor and load position: backlash, compliance and pitch error, where there is
//! a load scale.
//!
//! Candidates: a gap (the load coasts, or waits, while the motor crosses it:
//! [`crate::simulate::load`]), wind-up by the transmitted force (`F − M1·a` over K), and a function
//! periodic in position.
//! Judged on held-out blocks like the force, but accepted only where the amplitude is beyond the
//! encoders' counts.

use std::f64::consts::TAU;

use axis_model::EffectName;

use crate::evidence::selection::Scored;
use crate::fit::blocks::{Blocks, Fit, Gain};
use crate::fit::search::{descend, smallest};
use crate::model::name::Called;
use crate::motion::kinematics::Kinematics;
use crate::record::dataset::Dataset;
use crate::simulate::load::Behind;

/// Smallest share of the held-out variance.
const SHARE: f64 = 0.10;
/// Smallest share of what was there before any of these effects.
const SHARE_OF_ALL: f64 = 0.01;
/// Smallest amplitude, in counts of the coarser encoder.
const FEWEST_COUNTS: f64 = 2.0;
const T: f64 = 2.0;
/// Smallest rms that an effect removes, in counts of the coarser encoder: every screw has some
/// stiffness.
const SMALLEST_RMS_COUNTS: f64 = 1.0;

/// What the difference says.
#[derive(Clone, Debug, Default)]
pub(crate) struct Difference {
    /// Accepted effects, in the order in which they were found.
    pub found: Vec<EffectName>,
    /// All candidates.
    pub scored: Vec<Scored>,
    /// Rms that the declared model leaves, µm (or µrad).
    pub before_um: f64,
    /// Rms that the extended model leaves.
    pub after_um: f64,
    /// Width of the gap, if one was found.
    pub gap: Option<f64>,
    /// Stiffness, if compliance was found or declared: effort per length.
    pub stiffness: Option<f64>,
    terms: Vec<Column>,
    coefficients: Vec<f64>,
    declared: Vec<f64>,
}

/// What a record gives to the difference, besides its kinematics.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Path<'a> {
    /// Motor position at the rows.
    pub position: &'a [f64],
    /// What the motor gives to the load side, but for its own mass; low-passed.
    pub transmitted: &'a [f64],
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Column {
    Constant,
    WindUp,
    Play(Behind),
    Pitch { k: f64 },
}

impl Column {
    const fn called(self) -> Called {
        match self {
            Self::Constant => Called::Structure("constant"),
            Self::WindUp => Called::Effect(EffectName::Compliance),
            Self::Play(_) => Called::Effect(EffectName::Backlash),
            Self::Pitch { .. } => Called::Effect(EffectName::PitchError),
        }
    }

    fn columns(self, motion: &Kinematics, path: Path<'_>) -> Vec<Vec<f64>> {
        let position = path.position;
        match self {
            Self::Constant => vec![vec![1.0; motion.len()]],
            Self::WindUp => vec![
                path.transmitted.to_vec(),
                motion.low_passed(&motion.acceleration),
            ],
            Self::Play(behind) => vec![behind.follow(position, motion.period_s)],
            Self::Pitch { k } => {
                let wave = |f: fn(f64) -> f64| position.iter().map(|x| f(TAU * k * x)).collect();
                vec![wave(f64::cos), wave(f64::sin)]
            }
        }
    }
}

struct Bench<'a> {
    motion: &'a Kinematics,
    path: Path<'a>,
    target: &'a [f64],
    mask: Vec<bool>,
}

impl<'a> Bench<'a> {
    fn new(motion: &'a Kinematics, path: Path<'a>, target: &'a [f64]) -> Self {
        let mask = motion
            .moving
            .iter()
            .zip(&motion.slow)
            .map(|(moving, slow)| *moving || *slow)
            .collect();
        Self {
            motion,
            path,
            target,
            mask,
        }
    }

    fn design(&self, terms: &[Column]) -> Vec<Vec<f64>> {
        terms
            .iter()
            .flat_map(|term| term.columns(self.motion, self.path))
            .collect()
    }

    fn blocks(&self, terms: &[Column]) -> Blocks {
        let design = self.design(terms);
        let columns: Vec<&[f64]> = design.iter().map(Vec::as_slice).collect();
        Blocks::new(&columns, self.target, &self.mask, self.motion.period_s)
    }

    fn fit(&self, terms: &[Column]) -> Fit {
        self.blocks(terms).cross_validate()
    }

    fn rms_um(&self, terms: &[Column], coefficients: &[f64]) -> f64 {
        let design = self.design(terms);
        let (mut sum, mut count) = (0.0, 0.0);
        for at in (0..self.target.len()).filter(|at| self.mask[*at]) {
            let predicted: f64 = design
                .iter()
                .zip(coefficients)
                .map(|(column, c)| c * column[at])
                .sum();
            sum += (self.target[at] - predicted).powi(2);
            count += 1.0;
        }
        1.0e6 * (sum / f64::max(count, 1.0)).sqrt()
    }
}

/// Judges the difference of a training record; `None` where there is no load scale.
#[must_use]
pub(crate) fn difference(
    dataset: &Dataset,
    motion: &Kinematics,
    path: Path<'_>,
) -> Option<Difference> {
    let target = motion.difference.as_deref()?;
    let bench = Bench::new(motion, path, target);
    let mut terms = vec![Column::Constant];
    if dataset.declares(EffectName::Compliance) {
        terms.push(Column::WindUp);
    }
    if dataset.declares(EffectName::Backlash) {
        terms.push(best_gap(&bench, &terms, dataset));
    }
    if dataset.declares(EffectName::PitchError) {
        let base = bench.fit(&terms);
        terms.extend(best_pitch(&bench, &terms, &base));
    }
    let declared_fit = bench.fit(&terms);
    let all: f64 = declared_fit.held_out.iter().sum();
    let mut outcome = Difference {
        before_um: bench.rms_um(&terms, &declared_fit.coefficients),
        declared: declared_fit.coefficients.clone(),
        ..Difference::default()
    };
    for round in 0..3 {
        let base = bench.fit(&terms);
        let mut candidates: Vec<(Scored, Column)> = candidates(&bench, &terms, dataset, &base)
            .into_iter()
            .map(|column| judge(&bench, &terms, &base, all, column, dataset, round))
            .collect();
        candidates.sort_by(|a, b| b.0.gain.share.total_cmp(&a.0.gain.share));
        let best = candidates.iter().position(|(scored, ..)| scored.accepted);
        if let Some(best) = best {
            terms.push(candidates[best].1);
            outcome.found.extend(candidates[best].1.called().name());
        }
        for (place, (mut scored, ..)) in candidates.into_iter().enumerate() {
            scored.accepted = Some(place) == best;
            outcome.scored.push(scored);
        }
        if best.is_none() {
            break;
        }
    }
    let fit = bench.fit(&terms);
    outcome.after_um = bench.rms_um(&terms, &fit.coefficients);
    outcome.gap = terms.iter().find_map(|term| match term {
        Column::Play(behind) => Some(behind.gap),
        Column::Constant | Column::WindUp | Column::Pitch { .. } => None,
    });
    outcome.stiffness = stiffness(&terms, &fit.coefficients);
    outcome.coefficients = fit.coefficients;
    outcome.terms = terms;
    Some(outcome)
}

impl Difference {
    /// Whether the load moves otherwise than the motor.
    #[must_use]
    pub(crate) const fn moves_apart(&self) -> bool {
        self.gap.is_some() || self.stiffness.is_some()
    }

    /// Amplitude and wave number of the pitch error, if one was found.
    #[must_use]
    pub(crate) fn pitch(&self) -> Option<(f64, f64)> {
        let mut place = 0;
        for term in &self.terms {
            match term {
                Column::Pitch { k } => {
                    let [a, b] =
                        [0, 1].map(|i| self.coefficients.get(place + i).copied().unwrap_or(0.0));
                    return Some((a.hypot(b), *k));
                }
                Column::WindUp => place += 2,
                Column::Constant | Column::Play(_) => place += 1,
            }
        }
        None
    }

    /// Rms on another record: declared, extended; µm.
    #[must_use]
    pub(crate) fn on(&self, motion: &Kinematics, path: Path<'_>) -> Option<(f64, f64)> {
        let target = motion.difference.as_deref()?;
        let bench = Bench::new(motion, path, target);
        let declared: Vec<Column> = self
            .terms
            .iter()
            .copied()
            .filter(|term| !self.found.iter().any(|name| term.called() == *name))
            .collect();
        Some((
            bench.rms_um(&declared, &self.declared),
            bench.rms_um(&self.terms, &self.coefficients),
        ))
    }
}

fn stiffness(terms: &[Column], coefficients: &[f64]) -> Option<f64> {
    let mut place = 0;
    for term in terms {
        match term {
            Column::WindUp => {
                return coefficients
                    .get(place)
                    .filter(|c| **c > 0.0)
                    .map(|c| 1.0 / c);
            }
            Column::Constant | Column::Play(_) => place += 1,
            Column::Pitch { .. } => place += 2,
        }
    }
    None
}

fn candidates(bench: &Bench<'_>, terms: &[Column], dataset: &Dataset, base: &Fit) -> Vec<Column> {
    let has =
        |name: EffectName| terms.iter().any(|term| term.called() == name) || dataset.declares(name);
    let mut list = Vec::new();
    if !has(EffectName::Compliance) {
        list.push(Column::WindUp);
    }
    if !has(EffectName::Backlash) {
        list.push(best_gap(bench, terms, dataset));
    }
    if !has(EffectName::PitchError) {
        list.extend(best_pitch(bench, terms, base));
    }
    list
}

/// Shares of the moved mass that stand behind the gap, as tried.
const SHARES: [f64; 5] = [0.02, 0.3, 0.4, 0.5, 0.65];
/// Coefficients of restitution that are tried.
const RESTITUTIONS: [f64; 5] = [0.0, 0.3, 0.5, 0.7, 0.9];
/// Rounds of the search, one parameter after the other.
const ROUNDS: usize = 2;

fn best_gap(bench: &Bench<'_>, terms: &[Column], dataset: &Dataset) -> Column {
    let counts = FEWEST_COUNTS * dataset.resolution.max(dataset.load_resolution);
    let plain = crate::evidence::selection::plain_fit(bench.motion);
    let behind = |gap: f64, share: f64, restitution: f64| Behind {
        gap,
        coulomb: plain.coulomb / (share * plain.inertia),
        viscous: plain.viscous.max(0.0) / (share * plain.inertia),
        restitution,
    };
    // A gap is as wide as it is: its lag is subtracted, not scaled.
    let sse = |behind: Behind| {
        let lag = behind.follow(bench.path.position, bench.motion.period_s);
        let target: Vec<f64> = bench
            .target
            .iter()
            .zip(lag)
            .map(|(target, lag)| target - lag)
            .collect();
        Bench {
            target: &target,
            mask: bench.mask.clone(),
            ..*bench
        }
        .blocks(terms)
        .fit()
        .sse
    };
    let grid = crate::model::effects::geometric(counts, 1.0e-3_f64.max(100.0 * counts), 24);
    let mut gap = smallest(grid, &|gap| sse(behind(gap, 0.4, 0.0))).unwrap_or(counts);
    let (mut share, mut restitution) = (SHARES[2], RESTITUTIONS[0]);
    let mut step = 0.15;
    for _ in 0..ROUNDS {
        gap = descend(gap, step * gap, (counts, f64::MAX), &|gap| {
            sse(behind(gap, share, restitution))
        });
        restitution =
            smallest(RESTITUTIONS.to_vec(), &|r| sse(behind(gap, share, r))).unwrap_or(restitution);
        share = smallest(SHARES.to_vec(), &|share| {
            sse(behind(gap, share, restitution))
        })
        .unwrap_or(share);
        restitution = descend(restitution, 0.1, (0.0, 0.99), &|r| {
            sse(behind(gap, share, r))
        });
        share = descend(share, 0.05, (0.01, 0.95), &|share| {
            sse(behind(gap, share, restitution))
        });
        step = 0.02;
    }
    Column::Play(behind(gap, share, restitution))
}

fn best_pitch(bench: &Bench<'_>, terms: &[Column], base: &Fit) -> Option<Column> {
    let (low, high) = bench.motion.span();
    let step = 0.5 / (high - low);
    let design = bench.design(terms);
    let residual: Vec<(f64, f64)> = (0..bench.target.len())
        .step_by(8)
        .filter(|at| bench.mask[*at])
        .map(|at| {
            let predicted: f64 = design
                .iter()
                .zip(&base.coefficients)
                .map(|(column, c)| c * column[at])
                .sum();
            (bench.path.position[at], bench.target[at] - predicted)
        })
        .collect();
    let power = |k: f64| {
        let (re, im) = residual.iter().fold((0.0, 0.0), |(re, im), (x, e)| {
            let (sin, cos) = (TAU * k * x).sin_cos();
            (re + cos * e, im + sin * e)
        });
        re.hypot(im)
    };
    let count = ((4000.0 * (high - low)) as usize).min(4000);
    let waves = (8..count.max(9)).map(|i| step * i as f64);
    let best = waves
        .map(|k| (power(k), k))
        .max_by(|a, b| a.0.total_cmp(&b.0))?
        .1;
    let fine = (-8..=8).map(|i| best + step / 8.0 * f64::from(i));
    fine.map(|k| (power(k), k))
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, k)| Column::Pitch { k })
}

fn judge(
    bench: &Bench<'_>,
    terms: &[Column],
    base: &Fit,
    all: f64,
    column: Column,
    dataset: &Dataset,
    round: usize,
) -> (Scored, Column) {
    let fit = bench.fit(&[terms, &[column]].concat());
    let gain = Gain::of(base, &fit);
    let own = &fit.coefficients[base.coefficients.len()..];
    let counts = FEWEST_COUNTS * dataset.resolution.max(dataset.load_resolution);
    let total: f64 = base.held_out.iter().sum();
    let (physical, parameter) = match column {
        Column::Play(behind) => (
            (0.8..=1.2).contains(&own[0]) && behind.gap >= counts,
            behind.gap,
        ),
        Column::WindUp => {
            let motor_mass = -own[1] / own[0];
            let inertia = crate::evidence::selection::plain_fit(bench.motion).inertia;
            let effort = bench
                .path
                .transmitted
                .iter()
                .fold(0.0_f64, |most, effort| most.max(effort.abs()));
            let visible = own[0] * effort >= counts;
            (
                visible && own[0] > 0.0 && motor_mass > 0.0 && motor_mass < inertia,
                1.0 / own[0],
            )
        }
        Column::Pitch { k } => (own[0].hypot(own[1]) >= counts, k),
        Column::Constant => (false, 0.0),
    };
    let removed_of_all = gain.share * total / all.max(f64::MIN_POSITIVE);
    let rows = bench.mask.iter().filter(|inside| **inside).count() as f64;
    let removed_rms = (gain.share.max(0.0) * total / rows.max(1.0)).sqrt();
    let matters =
        removed_rms >= SMALLEST_RMS_COUNTS * dataset.resolution.max(dataset.load_resolution);
    let accepted =
        physical && matters && gain.share >= SHARE && removed_of_all >= SHARE_OF_ALL && gain.t >= T;
    let scored = Scored {
        effect: column.called(),
        parameter,
        gain,
        physical,
        accepted,
        nameless: false,
        round,
    };
    (scored, column)
}
