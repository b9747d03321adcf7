//! The identified model as a machine file, which `circle`, `tune` and `plant` accept.
//!
//! `[axis.actual]` is the identified model; `[axis.identified]` beside it holds the parameters as
//! they were found, with intervals and units. What a record does not say (the split of the masses,
//! the stiffness of the screw) is stated as assumed. Of several ripple orders the first is
//! simulated, of position dependence the linear part, of friction drift the Coulomb part.

use std::f64::consts::TAU;
use std::fmt::Write as _;

use identification::{AxisKind, Dataset, Effort, EffortHold, Identification};
use plant_sim::machine::{Gains, Limits, MachineAxis, PositionSensor};

/// What is known of an axis besides its identification.
#[derive(Clone, Debug)]
pub struct Known {
    /// Travel per revolution, m.
    pub lead_m: f64,
    /// Motor encoder.
    pub counts_per_rev: f64,
    /// Load scale, m.
    pub load_resolution_m: f64,
    /// Current loop, s.
    pub lag_s: f64,
    /// Limit of the force, N.
    pub force_limit_n: f64,
    /// Limits of the motion.
    pub limits: Limits,
    /// Gains of the drive.
    pub gains: Gains,
    /// Sample period, s.
    pub period_s: f64,
    /// Delay that the record sees because the effort is held while its rows say it acts at once, s.
    pub hold_s: f64,
}

/// Share of the moved mass that is taken for the table's where nothing says it.
const TABLE_SHARE: f64 = 0.4;
/// Damping ratio that is taken for the screw.
const SCREW_DAMPING: f64 = 0.1;
/// A screw that is stiff for the simulator: this share of what its sub-step carries.
const STIFF: f64 = 0.05;
/// Lead that is taken where the record does not know it, m.
const LEAD_M: f64 = 0.010;

impl Known {
    /// From a machine file.
    #[must_use]
    pub fn of_machine(axis: &MachineAxis, period_s: f64) -> Self {
        let actual = &axis.actual;
        Self {
            lead_m: actual.lead_m_per_rev,
            counts_per_rev: f64::from(actual.motor_encoder_counts_per_rev),
            load_resolution_m: actual.load_encoder_resolution_m,
            lag_s: actual.current_loop_time_constant_s,
            force_limit_n: actual.force_limit_n,
            limits: axis.limits,
            gains: axis.gains,
            period_s,
            hold_s: 0.0,
        }
    }

    /// From a dataset; `None` where the axis is not one that the simulator has (rotary, or effort
    /// that is no force).
    #[must_use]
    pub fn of_dataset(dataset: &Dataset, mass_kg: f64) -> Option<Self> {
        if dataset.kind != AxisKind::Linear || dataset.effort != Effort::Force {
            return None;
        }
        let record = &dataset.train;
        let fastest = record
            .position
            .windows(11)
            .map(|w| (w[10] - w[0]).abs())
            .fold(0.0, f64::max);
        let hardest = record
            .effort
            .iter()
            .fold(0.0, |most: f64, effort| most.max(effort.abs()));
        let furthest = record
            .position
            .iter()
            .fold(0.0, |most: f64, x| most.max(x.abs()));
        let controller = dataset.controller.clone().unwrap_or_default();
        let lead_m = dataset.lead_m_per_rev.unwrap_or(LEAD_M);
        let bandwidth = controller
            .velocity_gain_n_s_per_m
            .map_or(25.0, |gain| gain / (mass_kg * TAU));
        Some(Self {
            lead_m,
            counts_per_rev: (lead_m / dataset.resolution).round().clamp(100.0, 1.0e8),
            load_resolution_m: dataset.load_resolution.clamp(1.0e-10, 1.0e-4),
            lag_s: dataset.effort_lag_s,
            force_limit_n: dataset.effort_limit.unwrap_or(3.0 * hardest),
            limits: Limits {
                velocity_m_per_s: (1.2 * fastest / (10.0 * record.period_s)).clamp(0.1, 5.0),
                acceleration_m_per_s2: (hardest / mass_kg).clamp(0.5, 200.0),
                travel_m: (1.2 * furthest).clamp(0.12, 10.0),
            },
            gains: Gains {
                position_sensor: match controller.position_sensor.as_deref() {
                    Some("load") => PositionSensor::Load,
                    _ => PositionSensor::Motor,
                },
                position_gain_per_s: controller
                    .position_gain_per_s
                    .unwrap_or(40.0)
                    .clamp(1.0, 1000.0),
                velocity_bandwidth_hz: bandwidth.clamp(0.1, 1000.0),
                velocity_integral_hz: controller
                    .integral_per_s
                    .map_or(5.0, |rate| rate / TAU)
                    .clamp(0.0, 500.0),
                velocity_filter: controller.velocity_filter.unwrap_or(0.7).clamp(0.01, 1.0),
                torque_low_pass_hz: None,
                torque_notch_hz: None,
            },
            period_s: record.period_s,
            hold_s: if dataset.hold == EffortHold::Instant {
                0.5 * record.period_s
            } else {
                0.0
            },
        })
    }
}

/// The machine file of identified axes. One axis gets a second one like it, since a circle needs
/// two.
#[must_use]
pub fn text(name: &str, axes: &[(String, Known, &Identification)]) -> String {
    let period_s = axes.first().map_or(1.0e-3, |(_, known, _)| known.period_s);
    let mut text = format!(
        "# Identified model of {name}: a machine file for circle, tune and plant. [axis.actual] is what was identified.\n\
         name = \"{}\"\nseed = 1\n\n[bus]\nformat = \"classic\"\nbit_rate = 1_000_000\n\n[loop]\nperiod_s = {period_s:e}\n",
        name.replace(['\"', '\\'], " ")
    );
    for (name, known, result) in axes {
        axis(&mut text, name, known, result);
    }
    if let [(name, ..)] = axes {
        let _ = write!(
            text,
            "\n[[axis]]   # a circle needs two\nname = \"{name}2\"\nlike = \"{name}\"\n"
        );
    }
    text
}

fn axis(text: &mut String, name: &str, known: &Known, result: &Identification) {
    let report = &result.report;
    let get = |key: &str| report.parameters.get(key).map(|parameter| parameter.value);
    let or_zero = |key: &str| get(key).unwrap_or(0.0);
    let mass = or_zero("inertia").max(2.0e-3);
    let table =
        get("load_inertia").or_else(|| get("backlash_load_share").map(|share| share * mass));
    let assumed = if table.is_some() {
        ""
    } else {
        "   # split assumed"
    };
    let table = table
        .unwrap_or(TABLE_SHARE * mass)
        .clamp(0.05 * mass, 0.95 * mass);
    let reduced = table * (mass - table) / mass;
    let stiff = STIFF * reduced / plant_sim::axis::SUB_STEP_S.powi(2);
    let stiffness = get("compliance_stiffness")
        .unwrap_or(stiff)
        .clamp(1.0e4, stiff);
    let damping = 2.0 * SCREW_DAMPING * (stiffness * reduced).sqrt();
    let (lead, g, l) = (known.lead_m, &known.gains, &known.limits);
    let sensor = if g.position_sensor == PositionSensor::Load {
        "load"
    } else {
        "motor"
    };
    let noise = result.residual_rms.min(known.force_limit_n);
    let _ = write!(
        text,
        "\n[[axis]]\nname = \"{name}\"\n\n[axis.mechanics]\nlead_m_per_rev = {lead:e}\nmotor_inertia_kg = {:e}{assumed}\ntable_mass_kg = {table:e}\n\
         screw_stiffness_n_per_m = {stiffness:e}\nscrew_damping_n_s_per_m = {damping:e}\nbacklash_m = {:e}\n\n\
         [axis.encoders]\nmotor_counts_per_rev = {:.0}\nload_resolution_m = {:e}\n\n\
         [axis.actuator]\ncurrent_loop_time_constant_s = {:e}\nforce_limit_n = {:e}\nforce_noise_n = 0.0\nforce_record_noise_n = {noise:e}\n\n\
         [axis.limits]\nvelocity_m_per_s = {:e}\nacceleration_m_per_s2 = {:e}\ntravel_m = {:e}\n\n\
         [axis.gains]\nposition_sensor = \"{sensor}\"\nposition_gain_per_s = {:e}\nvelocity_bandwidth_hz = {:e}\nvelocity_integral_hz = {:e}\nvelocity_filter = {:e}\n",
        mass - table,
        or_zero("backlash_gap"),
        known.counts_per_rev,
        known.load_resolution_m,
        known.lag_s,
        known.force_limit_n,
        l.velocity_m_per_s,
        l.acceleration_m_per_s2,
        l.travel_m,
        g.position_gain_per_s,
        g.velocity_bandwidth_hz,
        g.velocity_integral_hz,
        g.velocity_filter,
    );
    friction(text, result);
    effects(text, known, result);
    let names: Vec<String> = report
        .declared
        .iter()
        .chain(&report.found)
        .map(|name| format!("\"{name}\""))
        .collect();
    let _ = write!(
        text,
        "\n[axis.declared]\neffects = [{}]\n\n[axis.identified]\nverdict = \"{}\"\n",
        names.join(", "),
        report.verdict
    );
    for (name, p) in &report.parameters {
        let _ = writeln!(
            text,
            "{name} = {{ value = {:e}, low = {:e}, high = {:e}, unit = \"{}\" }}",
            p.value, p.low, p.high, p.unit
        );
    }
}

fn friction(text: &mut String, result: &Identification) {
    let get = |key: &str| {
        result
            .report
            .parameters
            .get(key)
            .map(|parameter| parameter.value)
    };
    let coulomb = get("coulomb").unwrap_or(0.0).max(1.0e-2);
    let viscous = get("viscous").unwrap_or(0.0).max(0.0);
    let asymmetry = get("viscous_asymmetry").map_or(0.0, |a| {
        (a / viscous.max(f64::MIN_POSITIVE)).clamp(-0.9, 0.9)
    });
    let _ = write!(
        text,
        "\n[axis.actual.sliding]\ncoulomb_n = {coulomb:e}\nstatic_n = {:e}\nstribeck_velocity_m_per_s = {:e}\nviscous_n_s_per_m = {viscous:e}\n\
         viscous_asymmetry = {asymmetry:e}\nquadratic_drag_n_s2_per_m2 = {:e}\n\n[axis.actual.friction]\n",
        coulomb + get("stribeck_excess").unwrap_or(0.0).max(0.0),
        get("stribeck_velocity")
            .unwrap_or(2.0e-3)
            .clamp(1.0e-6, 1.0),
        get("quadratic_drag").unwrap_or(0.0).max(0.0),
    );
    let _ = match get("presliding_deflection").filter(|deflection| *deflection > 0.0) {
        Some(deflection) => {
            let stiffness = (coulomb / deflection).clamp(1.0e3, 1.0e12);
            let damping = get("presliding_damping").unwrap_or(0.0).clamp(0.0, 1.0e7);
            write!(
                text,
                "law = \"lu-gre\"\nbristle_stiffness_n_per_m = {stiffness:e}\nbristle_damping_n_s_per_m = {damping:e}\n"
            )
        }
        None => writeln!(text, "law = \"coulomb\""),
    };
}

fn effects(text: &mut String, known: &Known, result: &Identification) {
    let parameters = &result.report.parameters;
    let get = |key: &str| parameters.get(key).map(|parameter| parameter.value);
    let coulomb = get("coulomb").unwrap_or(0.0).max(1.0e-2);
    let _ = write!(
        text,
        "\n[axis.actual.effects]\noffset_n = {:e}\n",
        get("offset").unwrap_or(0.0)
    );
    if let (Some(amplitude), Some(period), Some(phase)) = (
        get("torque_ripple_amplitude"),
        get("torque_ripple_period"),
        get("torque_ripple_phase"),
    ) {
        let order = known.lead_m / period;
        let _ = writeln!(
            text,
            "torque_ripple = {{ amplitude_n = {amplitude:e}, order_per_rev = {order:e}, phase_rad = {phase:e} }}"
        );
    }
    if let (Some(amplitude), Some(period)) =
        (get("pitch_error_amplitude"), get("pitch_error_period"))
    {
        let _ = writeln!(
            text,
            "pitch_error = {{ amplitude_m = {amplitude:e}, period_m = {period:e} }}"
        );
    }
    if let Some(slope) = get("position_dependent_friction_linear") {
        let (middle, half) = result.travel;
        let _ = writeln!(
            text,
            "position_dependent_friction_per_m = {:e}   # the linear part",
            slope / half / (coulomb - slope * middle / half).max(1.0e-2)
        );
    }
    if let (Some(surplus), Some(tau)) = (
        get("friction_drift_coulomb"),
        get("friction_drift_time_constant"),
    ) {
        let gain = (surplus / coulomb).clamp(-0.9, 10.0);
        let _ = writeln!(
            text,
            "friction_drift = {{ gain = {gain:e}, time_constant_s = {tau:e} }}"
        );
    }
    if let Some(k) = get("torque_saturation") {
        let _ = writeln!(text, "torque_saturation_per_n = {k:e}");
    }
    if let Some(delay_s) = get("delay") {
        let _ = writeln!(
            text,
            "delay_s = {:e}",
            (delay_s - known.hold_s).clamp(0.0, known.period_s.min(1.0e-3))
        );
    }
}

/// Parameters alone, for an axis that the simulator does not have.
#[must_use]
pub fn parameters_only(name: &str, result: &Identification) -> String {
    let report = &result.report;
    let list = |names: &[String]| {
        names
            .iter()
            .map(|name| format!("\"{name}\""))
            .collect::<Vec<_>>()
            .join(", ")
    };
    let mut text = format!(
        "# Identified model. No machine file: the simulator has linear axes with efforts in newtons.\nname = \"{}\"\ndeclared = [{}]\nfound = [{}]\nverdict = \"{}\"\n\n[identified]\n",
        name.replace(['\"', '\\'], " "),
        list(&report.declared),
        list(&report.found),
        report.verdict
    );
    for (name, p) in &report.parameters {
        let _ = writeln!(
            text,
            "{name} = {{ value = {:e}, low = {:e}, high = {:e}, unit = \"{}\" }}",
            p.value, p.low, p.high, p.unit
        );
    }
    text
}
