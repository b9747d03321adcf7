//! The difference of motor and load position: backlash, compliance and pitch error, where there is
//! a load scale.
//!
//! Candidates: a gap (the load coasts, or waits, while the motor crosses it:
//! [`crate::simulate::load`]), wind-up by the transmitted force, and a function periodic in
//! position. Judged on held-out blocks like the force, but accepted only where the amplitude is
//! beyond the encoders' counts.

mod columns;
mod search;

use axis_model::EffectName;

pub(crate) use self::columns::Path;
use self::columns::{Apart, FittedWays, Way};
use self::search::{best_gap, best_pitch};
use crate::evidence::selection::{self, Candidate, Output, Scored};
use crate::evidence::thresholds::{
    DIFFERENCE_RMS_COUNTS, DIFFERENCE_SHARE, DIFFERENCE_SHARE_OF_ALL, DIFFERENCE_T, FEWEST_COUNTS,
    GAP_FACTOR,
};
use crate::fit::blocks::{Fit, Gain};
use crate::fit::plain::Plain;
use crate::motion::kinematics::Kinematics;
use crate::record::dataset::Dataset;

/// The effects that stand between motor and load, in the order in which they are tried.
const EFFECTS: [EffectName; 3] = [
    EffectName::Compliance,
    EffectName::Backlash,
    EffectName::PitchError,
];

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
    declared: FittedWays,
    extended: FittedWays,
}

/// Judges the difference of a training record; `None` where there is no load scale.
#[must_use]
pub(crate) fn difference(
    dataset: &Dataset,
    motion: &Kinematics,
    path: Path<'_>,
) -> Option<Difference> {
    let apart = Apart::on(motion, path)?;
    let count = dataset.resolution.max(dataset.load_resolution);
    let declared = declared(dataset, &apart, count);
    let before = apart.cross_validate(&declared).held_out.iter().sum();
    let output = MotorLoad {
        inertia: Plain::fit(motion).inertia,
        apart,
        count,
        before,
    };
    let selection = selection::select(&output, declared.clone(), &mut |_| ());
    let apart = &output.apart;
    let fits = [&declared, &selection.model].map(|ways| apart.fit(ways));
    let rms_um = fits.each_ref().map(|fitted| apart.rms_um(fitted));
    Some(Difference::of(fits, rms_um, selection.scored))
}

/// The ways that a dataset declares, in the order compliance, backlash, pitch error.
fn declared(dataset: &Dataset, apart: &Apart<'_>, count: f64) -> Vec<Way> {
    let mut ways = vec![Way::Constant];
    for name in EFFECTS.into_iter().filter(|name| dataset.declares(*name)) {
        let way = best(name, apart, &ways, count);
        ways.extend(way);
    }
    ways
}

/// The way of an effect that leaves least beside others.
fn best(name: EffectName, apart: &Apart<'_>, ways: &[Way], count: f64) -> Option<Way> {
    match name {
        EffectName::Compliance => Some(Way::WindUp),
        EffectName::Backlash => Some(best_gap(apart, ways, count)),
        EffectName::PitchError => best_pitch(apart, &apart.fit(ways)),
        _ => None,
    }
}

/// Motor − load as an output that judges.
struct MotorLoad<'a> {
    apart: Apart<'a>,
    /// Count of the coarser encoder.
    count: f64,
    /// Held-out sum of squares that the declared ways leave.
    before: f64,
    /// Moved mass as the plain model sees it: a motor's own mass is less.
    inertia: f64,
}

impl Output for MotorLoad<'_> {
    type Model = Vec<Way>;

    fn candidates(&self, ways: &Vec<Way>, round: usize) -> Vec<Candidate<Vec<Way>>> {
        let base = self.apart.cross_validate(ways);
        let is_open = |name: &EffectName| !ways.iter().any(|way| way.called() == *name);
        let open = EFFECTS.into_iter().filter(is_open);
        let best = open.filter_map(|name| best(name, &self.apart, ways, self.count));
        best.map(|way| self.judged(ways, &base, way, round))
            .collect()
    }

    fn accepts(&self, candidate: &Candidate<Vec<Way>>) -> bool {
        let Scored { gain, physical, .. } = &candidate.scored;
        let rows = self.apart.mask.iter().filter(|inside| **inside).count() as f64;
        let removed_rms = (gain.removed.max(0.0) / rows.max(1.0)).sqrt();
        *physical
            && gain.share >= DIFFERENCE_SHARE
            && gain.t >= DIFFERENCE_T
            && gain.removed >= DIFFERENCE_SHARE_OF_ALL * self.before
            && removed_rms >= DIFFERENCE_RMS_COUNTS * self.count
    }

    fn most(&self) -> usize {
        EFFECTS.len()
    }
}

impl MotorLoad<'_> {
    fn judged(&self, ways: &[Way], base: &Fit, way: Way, round: usize) -> Candidate<Vec<Way>> {
        let model = [ways, &[way]].concat();
        let gain = Gain::of(base, &self.apart.cross_validate(&model));
        let fitted = self.apart.fit(&model);
        let own = fitted.last().map_or(&[][..], |(_, own)| own);
        let scored = Scored {
            effect: way.called(),
            parameter: parameter(way, own),
            gain,
            physical: self.is_physical(way, own),
            accepted: false,
            round,
        };
        Candidate { scored, model }
    }

    /// Whether coefficients can be those of a way, and the encoders can show it.
    fn is_physical(&self, way: Way, own: &[f64]) -> bool {
        let least = FEWEST_COUNTS * self.count;
        match way {
            Way::Constant => false,
            Way::Play(behind) => GAP_FACTOR.contains(&own[0]) && behind.gap >= least,
            Way::Pitch { .. } => own[0].hypot(own[1]) >= least,
            Way::WindUp => {
                let efforts = self.apart.path.transmitted.iter();
                let largest = efforts.fold(0.0_f64, |most, effort| most.max(effort.abs()));
                let motor_mass = -own[1] / own[0];
                let is_visible = own[0] > 0.0 && own[0] * largest >= least;
                is_visible && motor_mass > 0.0 && motor_mass < self.inertia
            }
        }
    }
}

/// The quantity for people: width, stiffness, wave number.
fn parameter(way: Way, own: &[f64]) -> f64 {
    match way {
        Way::Constant => 0.0,
        Way::WindUp => 1.0 / own[0],
        Way::Play(behind) => behind.gap,
        Way::Pitch { per_length } => per_length,
    }
}

impl Difference {
    fn of(
        [declared, extended]: [FittedWays; 2],
        [before_um, after_um]: [f64; 2],
        scored: Vec<Scored>,
    ) -> Self {
        let is_declared = |name: &EffectName| declared.of(*name).is_some();
        let gap = extended.of(EffectName::Backlash);
        let wind_up = extended.of(EffectName::Compliance);
        Self {
            found: extended.names().filter(|name| !is_declared(name)).collect(),
            scored,
            before_um,
            after_um,
            gap: gap.map(|(way, own)| parameter(way, own)),
            stiffness: wind_up
                .filter(|(_, own)| own[0] > 0.0)
                .map(|(way, own)| parameter(way, own)),
            declared,
            extended,
        }
    }

    /// Whether the load moves otherwise than the motor.
    #[must_use]
    pub(crate) const fn moves_apart(&self) -> bool {
        self.gap.is_some() || self.stiffness.is_some()
    }

    /// Amplitude and wave number of the pitch error, if one was found.
    #[must_use]
    pub(crate) fn pitch(&self) -> Option<(f64, f64)> {
        let (way, own) = self.extended.of(EffectName::PitchError)?;
        Some((own[0].hypot(own[1]), parameter(way, own)))
    }

    /// Rms on another record: declared, extended; µm.
    #[must_use]
    pub(crate) fn on(&self, motion: &Kinematics, path: Path<'_>) -> Option<(f64, f64)> {
        let apart = Apart::on(motion, path)?;
        Some((apart.rms_um(&self.declared), apart.rms_um(&self.extended)))
    }
}
