//! What is said about an identification: the form of `identify --json`, and curves for pictures.

use std::collections::BTreeMap;

use axis_model::{Effect, Estimate};
use serde::Serialize;
use serde::ser::{SerializeMap, Serializer};

use crate::report::protocols::Protocol;

/// A candidate in the ranking: an effect, and what it would explain if it were added.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Candidate {
    /// Effect.
    pub effect: String,
    /// Force error on the validation record if this effect alone is added to the declared model,
    /// percent; for effects that are judged on the effort.
    pub validation_error_percent: Option<f64>,
    /// What is left of the rms of motor − load on held-out blocks, percent; for effects that are
    /// judged on that.
    pub difference_left_percent: Option<f64>,
    /// Evidence: mean over standard error of its gain on held-out blocks, in the round in which it
    /// stood best.
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

/// An output on which an effect shows that was found: what is left of it on the training record.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Shown {
    /// Effect.
    pub effect: String,
    /// The measured output.
    pub on: &'static str,
    /// Unit of what is left: percent of the effort (rms), or an rms.
    pub unit: &'static str,
    /// What is left without the effect.
    pub without: f64,
    /// What is left with it.
    pub with: f64,
}

/// Errors on one record.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Errors {
    /// Force error of the declared model over moving samples.
    pub force_error_before_percent: f64,
    /// Force error of the extended model.
    pub force_error_after_percent: f64,
    /// Rms of the force that is not explained about reversals and rests, declared; in the unit of
    /// the effort.
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

/// Free-run errors on one record.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct FreeRunErrors {
    /// Rms of simulated − recorded motor position, declared model; µm (µrad). No number where the
    /// simulation ran away: an error beyond the travel.
    pub position_error_um_before: f64,
    /// The same, extended.
    pub position_error_um_after: f64,
    /// Rms of setpoint − position of the record itself, where there is a setpoint.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tracking_error_um: Option<f64>,
    /// The declared model's error over the rms of setpoint − position, percent, where there is a
    /// setpoint.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tracking_error_percent_before: Option<f64>,
    /// The same, extended.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tracking_error_percent_after: Option<f64>,
}

/// What stick, bristle and gap leave: of the simulated position on blocks that were not fitted, µm
/// (µrad), and of the effort about reversals, rms.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct ReversalShapes {
    /// Rigid friction. Here as below: no number where the simulation ran away.
    pub rigid_um: f64,
    /// A bristle.
    pub bristle_um: f64,
    /// A gap; only looked for where something acts at reversals.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gap_um: Option<f64>,
    /// A bristle behind a gap.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub both_um: Option<f64>,
    /// Effort about reversals that rigid friction leaves, in the unit of the effort.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rigid_effort: Option<f64>,
    /// The same, a bristle.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bristle_effort: Option<f64>,
}

/// Torque ripple of an axis that is never slow for long, found about its reversals.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct SlowRipple {
    /// Samples up to this velocity were used, in position units per second.
    pub fastest: f64,
    /// Low-pass of this judgement, Hz.
    pub cutoff_hz: f64,
    /// Orders, largest contribution first.
    pub orders: Vec<RippleOrder>,
    /// Force error over these samples, training record, declared model fitted to them; percent.
    pub train_force_error_before_percent: f64,
    /// The same with the ripple.
    pub train_force_error_after_percent: f64,
    /// Validation record, declared.
    pub validate_force_error_before_percent: f64,
    /// Validation record, with the ripple.
    pub validate_force_error_after_percent: f64,
}

/// One order of ripple.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct RippleOrder {
    /// Periods per revolution.
    pub per_rev: u32,
    /// Amplitude, in the unit of the effort.
    pub amplitude: f64,
    /// Half width of its 95 % interval.
    pub half_width: f64,
    /// Share of the held-out error that it removed when it was added.
    pub share: f64,
    /// Mean over standard error of that gain.
    pub evidence: f64,
}

impl RippleOrder {
    /// Its amplitude with the interval.
    #[must_use]
    pub fn estimate(&self, unit: &str) -> Estimate {
        Estimate {
            value: self.amplitude,
            unit: unit.into(),
            low: self.amplitude - self.half_width,
            high: self.amplitude + self.half_width,
        }
    }
}

/// Free-run simulation with output-error fits.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct FreeRun {
    /// `known`: the controller of the dataset gives the recorded effort. Else the recorded effort
    /// was applied and a soft controller of our own kept the simulation near the record, so that
    /// the errors compare models but are no free run: the controller is `not described`, `hidden
    /// by noise` of the record, or `refuted` by it.
    pub controller: &'static str,
    /// What the described controller leaves of the recorded effort, percent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub controller_misfit_percent: Option<f64>,
    /// Training record.
    pub train: FreeRunErrors,
    /// Validation record.
    pub validate: FreeRunErrors,
    /// The shapes that were compared.
    pub reversals: ReversalShapes,
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
    /// How late the effort is against the motion by what the extended model leaves, ms.
    pub late_ms: f64,
    /// Share of the residual's variance that this shift explains.
    pub late_share: f64,
    /// What the structure that is left looks like, where there is any.
    pub looks_like: String,
}

/// One spring of Maxwell slip.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct SlipElement {
    /// The way after which it slips, from rest; in the unit of the position.
    pub deflection: f64,
    /// Its share of the level.
    pub share: f64,
}

/// Friction after a reversal: at the way since it, in the unit of the position, a force in that of
/// the effort with its 95 % interval.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct AfterReversal {
    /// Way since the reversal.
    pub way: f64,
    /// Friction, against the motion where it is positive.
    pub force: f64,
    /// Lower end of its interval.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

/// Presliding as a curve: from sliding one way to sliding the other.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct PreslidingCurve {
    /// `dahl` or `maxwell-slip`.
    pub law: &'static str,
    /// The elements of Maxwell slip.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub elements: Vec<SlipElement>,
    /// Those of the motor's own side, over the motor's way, where they are known: shares of its
    /// level.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub motor_elements: Vec<SlipElement>,
    /// The curve.
    pub points: Vec<AfterReversal>,
}

/// White noise of the force, rms in the unit of the effort.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct ForceNoise {
    /// Of the record alone.
    pub recorded: f64,
    /// Acting on the axis.
    pub acting: f64,
}

/// What a loop does by itself on a record, beside what its setpoint asks for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct LoopOscillation {
    /// Frequency, Hz.
    pub frequency_hz: f64,
    /// Rms of the position, m or rad.
    pub rms: f64,
}

/// A parameter that the record does not know.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct UnknownParameter {
    /// Always true: it stands in the place of a value.
    pub unknown: bool,
    /// Unit of the interval.
    pub unit: String,
    /// Lower end of the interval in which it lies.
    pub low: f64,
    /// Upper end.
    pub high: f64,
    /// What to record so that it is known.
    pub record: &'static str,
}

/// Parameters by name: those that the record knows, and those that it does not. One map in JSON and
/// TOML.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ParameterTable {
    /// Values with intervals.
    pub known: BTreeMap<String, Estimate>,
    /// Intervals too wide for a value.
    pub unknown: BTreeMap<String, UnknownParameter>,
}

impl ParameterTable {
    /// A parameter that is known.
    #[must_use]
    pub fn get(&self, name: &str) -> Option<&Estimate> {
        self.known.get(name)
    }

    /// All names.
    pub fn names(&self) -> impl Iterator<Item = &String> {
        self.known.keys().chain(self.unknown.keys())
    }
}

impl Serialize for ParameterTable {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(self.names().count()))?;
        for (name, known) in &self.known {
            map.serialize_entry(name, known)?;
        }
        for (name, unknown) in &self.unknown {
            map.serialize_entry(name, unknown)?;
        }
        map.end()
    }
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
    /// Where each of them shows.
    pub shown: Vec<Shown>,
    /// Ranking.
    pub candidates: Vec<Candidate>,
    /// Errors on the training record.
    pub train: Errors,
    /// Errors on the validation record.
    pub validate: Errors,
    /// Errors on the whole file, where validation is its last part: the declared and the extended
    /// structure fitted to all of it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub whole: Option<Errors>,
    /// The force error by the protocols that papers use.
    pub protocols: Vec<Protocol>,
    /// Structure left.
    pub residual: ResidualReport,
    /// Free-run simulation, where the model can be simulated.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub free_run: Option<FreeRun>,
    /// Ripple about reversals, where the axis is never slow for long.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub slow_ripple: Option<SlowRipple>,
    /// Friction after a reversal, where there is presliding.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub presliding: Option<PreslidingCurve>,
    /// Noise of the force, where the controller is known and tells that of the record from that
    /// which acts.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub force_noise: Option<ForceNoise>,
    /// An oscillation of the loop that drives the axis: nothing that is fitted on such records
    /// holds.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub loop_oscillation: Option<LoopOscillation>,
    /// Cut-off of the zero-phase low-pass of the fit and of the errors, Hz: 100 Hz or a tenth of
    /// the sample rate, but 20 Hz where the clock jittered and that spoils the acceleration.
    pub cutoff_hz: f64,
    /// Where that is not the defined one: errors with the defined low-pass.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub as_defined: Option<[Errors; 2]>,
    /// Parameters of the extended model.
    pub parameters: ParameterTable,
    /// The output that each of them comes from.
    pub parameters_from: BTreeMap<String, &'static str>,
    /// `explained` or `unexplained`.
    pub verdict: String,
    /// What the record cannot say, and what cannot be told apart.
    pub warnings: Vec<String>,
}

/// One effect of the extended model, as the training record shows it.
#[derive(Clone, Debug, Default)]
pub struct EffectCurve {
    /// Effect.
    pub effect: &'static str,
    /// Its equation.
    pub equation: &'static str,
    /// What it is shown against, with its unit.
    pub against: String,
    /// That, the residual of the model without the effect, and the effect, moving samples.
    pub points: Vec<[f64; 3]>,
}

/// Curves for pictures and `prediction.csv`.
#[derive(Clone, Debug, Default)]
pub struct Curves {
    /// The effects that were found in the effort.
    pub effects: Vec<EffectCurve>,
    /// Free run on the validation record: time, position error declared and extended, µm (µrad).
    pub free_run: Vec<[f64; 3]>,
    /// Validation record: time, s.
    pub time_s: Vec<f64>,
    /// Recorded effort; where a known lag stands between the recorded and the acting effort, the
    /// acting one, which is what the predictions are of.
    pub effort: Vec<f64>,
    /// Prediction of the declared model, not low-passed.
    pub declared: Vec<f64>,
    /// Prediction of the extended model, not low-passed.
    pub extended: Vec<f64>,
    /// Moving samples of the validation record: velocity, position, residual declared, residual
    /// extended.
    pub moving: Vec<[f64; 4]>,
}

/// Everything that came out.
#[derive(Clone, Debug, Default)]
pub struct Identification {
    /// The report.
    pub report: Report,
    /// The effects of the extended model with their parameters, as the vocabulary has them.
    pub effects: Vec<Effect<Estimate>>,
    /// Curves.
    pub curves: Curves,
    /// Middle and half of the travel of the training record.
    pub travel: (f64, f64),
    /// Rms of what the extended model leaves of the effort on the training record, moving samples.
    pub residual_rms: f64,
    /// Unit of the effort.
    pub effort_unit: &'static str,
    /// Name of the effort column.
    pub effort_column: &'static str,
    /// Unit of the position.
    pub position_unit: &'static str,
}
