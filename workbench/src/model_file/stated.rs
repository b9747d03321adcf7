//! From what was identified to the tables of an axis: masses, screw and gap as `[axis.mechanics]`,
//! everything else as `[axis.actual.effects]`.

use axis_model::{
    Backlash, Compliance, Coulomb, Delay, Effect, EffectName, EffectTable, Estimate, FrictionDrift,
    Inertia, Presliding, TorqueRipple,
};
use identification::{ForceNoise, Identification, PreslidingCurve, SlipElement};
use plant_sim::axis::SUB_STEP_S;
use plant_sim::friction::Law;
use plant_sim::machine::{ActuatorForm, EncodersForm, MechanicsForm, refusal};

use super::known::Known;

/// Share of the moved mass that is taken for the table's where nothing says it.
const TABLE_SHARE: f64 = 0.4;
/// The share of the table is between these: the simulator has two masses.
const TABLE_SHARES: (f64, f64) = (0.05, 0.95);
/// Damping ratio that is taken for the screw.
const SCREW_DAMPING: f64 = 0.1;
/// A screw that is stiff for the simulator: this share of M/dt², of which its sub-step carries a
/// quarter.
const STIFF: f64 = 0.05;
/// Softest screw of a machine file, N/m.
const SOFTEST: f64 = 1.0e4;
/// Stiffest bristles, as a share of M/dt² of their mass.
const STIFFEST_BRISTLES: f64 = 0.2;
/// Least moved mass that makes two masses of a machine file, kg.
const LEAST_MASS_KG: f64 = 2.0e-3;
/// Softest bristle of a machine file, N/m.
pub(super) const SOFTEST_BRISTLE: f64 = 1.0e3;
/// Least friction level, N: ten times what bristles need.
pub(super) const LEAST_LEVEL_N: f64 = 1.0e-2;

/// The parameters of an effect, where it was identified.
macro_rules! identified {
    ($effects:expr, $kind:ident) => {
        $effects.iter().find_map(|effect| match effect {
            Effect::$kind(own) => Some(own),
            _ => None,
        })
    };
}

/// `[axis.mechanics]`, and where the mass of the table comes from.
pub(super) fn mechanics(
    known: &Known,
    effects: &[Effect<Estimate>],
) -> (MechanicsForm, &'static str) {
    let gap: Option<&Backlash<Estimate>> = identified!(effects, Backlash);
    let masses = Masses::of(effects, gap, known.inertia_kg);
    let compliance: Option<&Compliance<Estimate>> = identified!(effects, Compliance);
    let stiffness = masses.stiffness_n_per_m(compliance);
    let usual = 2.0 * SCREW_DAMPING * (stiffness * masses.reduced_kg()).sqrt();
    let damping = compliance.and_then(|own| own.damping.as_ref());
    let form = MechanicsForm {
        lead_m_per_rev: known.lead_m,
        motor_inertia_kg: masses.motor_kg,
        table_mass_kg: masses.table_kg,
        screw_stiffness_n_per_m: stiffness,
        screw_damping_n_s_per_m: damping.map_or(usual, |own| own.value.max(0.0)),
        backlash_m: gap.map_or(0.0, |gap| gap.gap.value),
        gravity_n: 0.0,
        start_m: 0.0,
    };
    (form, masses.split)
}

struct Masses {
    motor_kg: f64,
    table_kg: f64,
    /// Where the split comes from.
    split: &'static str,
}

impl Masses {
    fn of(effects: &[Effect<Estimate>], gap: Option<&Backlash<Estimate>>, design_kg: f64) -> Self {
        let inertia: Option<&Inertia<Estimate>> = identified!(effects, Inertia);
        let all_kg = inertia.map_or(design_kg, |own| own.inertia.value);
        let all_kg = all_kg.max(LEAST_MASS_KG);
        let load = inertia.and_then(|own| own.load.as_ref());
        let behind_gap = gap.and_then(|gap| gap.load_share.as_ref());
        let (table_kg, split) = match (load, behind_gap) {
            (Some(load), _) => (load.value, "motor and load position"),
            (None, Some(share)) => (share.value * all_kg, "impacts in the gap"),
            (None, None) => (TABLE_SHARE * all_kg, "assumed"),
        };
        let table_kg = table_kg.clamp(TABLE_SHARES.0 * all_kg, TABLE_SHARES.1 * all_kg);
        Self {
            motor_kg: all_kg - table_kg,
            table_kg,
            split,
        }
    }

    fn reduced_kg(&self) -> f64 {
        let all_kg = self.motor_kg + self.table_kg;
        self.table_kg * self.motor_kg / all_kg
    }

    /// Of the screw: as identified, else stiff for the simulator.
    fn stiffness_n_per_m(&self, compliance: Option<&Compliance<Estimate>>) -> f64 {
        let stiff = STIFF * self.reduced_kg() / SUB_STEP_S.powi(2);
        let stiffness = compliance.map_or(stiff, |own| own.stiffness.value);
        stiffness.max(SOFTEST).min(stiff)
    }
}

/// `[axis.encoders]`.
pub(super) fn encoders(known: &Known) -> EncodersForm {
    EncodersForm {
        motor_counts_per_rev: known.counts_per_rev.round() as u32,
        load_resolution_m: known.load_resolution_m,
        motor_zero_m: 0.0,
        load_zero_m: 0.0,
    }
}

/// `[axis.actuator]`: what the model leaves of the effort is taken for noise of the recording,
/// where no controller tells that from noise that acts.
pub(super) fn actuator(known: &Known, result: &Identification) -> ActuatorForm {
    let of_record = ForceNoise {
        recorded: result.residual_rms,
        acting: 0.0,
    };
    let noise = result.report.force_noise.unwrap_or(of_record);
    ActuatorForm {
        current_loop_time_constant_s: known.lag_s,
        force_limit_n: known.force_limit_n,
        force_noise_n: noise.acting.min(known.force_limit_n),
        force_record_noise_n: noise.recorded.min(known.force_limit_n),
    }
}

/// What the simulator is told, and what it cannot be told.
#[derive(Default)]
pub(super) struct Stated {
    /// `[axis.actual.effects]`.
    pub effects: EffectTable,
    /// By name, for people.
    pub left_out: Vec<String>,
}

/// `[axis.actual.effects]`.
pub(super) fn effects(known: &Known, effects: &[Effect<Estimate>], table_kg: f64) -> Stated {
    let coulomb: Option<&Coulomb<Estimate>> = identified!(effects, Coulomb);
    let level_n = coulomb.map_or(0.0, |own| own.coulomb.value);
    let level_n = level_n.max(LEAST_LEVEL_N);
    let mut stated = Stated::default();
    stated.take(Coulomb { coulomb: level_n }.into());
    for effect in effects {
        match effect.stated() {
            Effect::Inertia(_)
            | Effect::Backlash(_)
            | Effect::Compliance(_)
            | Effect::Coulomb(_) => {}
            Effect::Presliding(own) => stated.presliding(own, level_n, table_kg),
            Effect::TorqueRipple(own) => stated.ripple(own),
            Effect::FrictionDrift(own) => stated.drift(own),
            Effect::Delay(_) => stated.delay(known, effect),
            other => stated.take(other),
        }
    }
    stated
}

/// `[axis.actual.friction]`: Maxwell slip, which no effect of the vocabulary can state.
pub(super) fn friction(
    curve: Option<&PreslidingCurve>,
    effects: &[Effect<Estimate>],
    table_kg: f64,
) -> Option<Law> {
    let deflection: Option<&Presliding<Estimate>> = identified!(effects, Presliding);
    let curve = curve.filter(|_| deflection.is_some())?;
    let coulomb: Option<&Coulomb<Estimate>> = identified!(effects, Coulomb);
    let level_n = coulomb?.coulomb.value.max(LEAST_LEVEL_N);
    slip(&curve.elements, level_n, table_kg)
}

/// Maxwell slip of a level on a mass, where there are elements; as stiff as the sub-step carries at
/// most, and as a machine file may say at least.
pub(super) fn slip(elements: &[SlipElement], level_n: f64, mass_kg: f64) -> Option<Law> {
    let shortest = level_n / stiffest(mass_kg);
    let stiffness = |element: &SlipElement| {
        let deflection = element.deflection.max(shortest);
        (element.share * level_n / deflection).max(SOFTEST_BRISTLE)
    };
    (!elements.is_empty()).then(|| Law::MaxwellSlip {
        stiffness_n_per_m: elements.iter().map(stiffness).collect(),
        share: elements.iter().map(|element| element.share).collect(),
    })
}

/// Stiffest bristles that the sub-step carries on a mass, N/m.
pub(super) fn stiffest(mass_kg: f64) -> f64 {
    STIFFEST_BRISTLES * mass_kg / SUB_STEP_S.powi(2)
}

impl Stated {
    /// The same without presliding, where the friction law states it.
    pub(super) fn without_presliding(&mut self) {
        self.effects
            .0
            .retain(|effect| effect.name() != EffectName::Presliding);
    }

    fn take(&mut self, effect: Effect) {
        match refusal(&effect) {
            None => self.effects.0.push(effect),
            Some(_) => self.left_out.push(effect.name().to_string()),
        }
    }

    /// Bristles as stiff as the sub-step carries, at most.
    fn presliding(&mut self, own: Presliding, level_n: f64, table_kg: f64) {
        let deflection = own.deflection.max(level_n / stiffest(table_kg));
        self.take(Presliding { deflection, ..own }.into());
    }

    /// A ripple by its period; without a phase nobody knows where it pulls.
    fn ripple(&mut self, own: TorqueRipple) {
        if own.phase.is_none() {
            self.left_out.push("torque_ripple without a phase".into());
            return;
        }
        let order = own.order.filter(|_| own.period.is_none());
        self.take(TorqueRipple { order, ..own }.into());
    }

    /// The Coulomb part of a drift.
    fn drift(&mut self, own: FrictionDrift) {
        if own.viscous_gain.is_some() {
            self.left_out.push("viscous_gain of friction_drift".into());
        }
        let viscous_gain = None;
        self.take(
            FrictionDrift {
                viscous_gain,
                ..own
            }
            .into(),
        );
    }

    /// The delay beyond the hold of the record, one cycle at most.
    fn delay(&mut self, known: &Known, effect: &Effect<Estimate>) {
        if let Effect::Delay(own) = effect {
            let most_s = known.period_s.min(LONGEST_DELAY_S);
            let delay = (own.delay.value - known.hold_s).clamp(0.0, most_s);
            self.take(Delay { delay }.into());
        }
    }
}

/// Longest delay of a machine file, s.
const LONGEST_DELAY_S: f64 = 1.0e-3;
