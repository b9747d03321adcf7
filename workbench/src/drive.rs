//! From SI gains to the drive's fixed-point parameters: the one place where physical units meet machine units.
//!
//! Position counts are 10 nm, time is the control cycle, torque is µN·m at the motor: `T = F · lead / 2π`. Every value is rounded to nearest
//! and checked against the range of its object, so that a gain that the drive cannot hold is an error that names the key of the machine file.

use std::f64::consts::TAU;

use plant_sim::machine::{MachineAxis, PositionSensor};
use servo::objects::{Entry, Parameter, TABLE};

use crate::compensation::{AxisCompensation, Compensation};
use crate::error::{Failure, Outcome};

/// 10 nm, the position count of drive and bus.
pub const COUNT_M: f64 = 1.0e-8;
/// Counts of the setpoint frame per position count.
pub const FINE_PER_COUNT: f64 = 256.0;

/// Raw values of a parameter set, in the order of download.
pub type Download = Vec<(&'static Entry, i32)>;

struct Scaling {
    period_s: f64,
    micro_nm_per_newton: f64,
}

impl Scaling {
    /// 10 nm per cycle, in m/s.
    fn velocity(&self, m_per_s: f64) -> f64 {
        m_per_s * self.period_s / COUNT_M
    }

    fn acceleration(&self, m_per_s2: f64) -> f64 {
        m_per_s2 * self.period_s * self.period_s / COUNT_M
    }

    fn torque(&self, newton: f64) -> f64 {
        newton * self.micro_nm_per_newton
    }
}

/// The whole parameter set of an axis.
///
/// # Errors
/// [`Failure`] that names the key of the machine file or of the compensation whose value the drive cannot hold.
pub fn parameters(axis: &MachineAxis, period_s: f64, compensation: &AxisCompensation) -> Outcome<Download> {
    let scaling = Scaling { period_s, micro_nm_per_newton: 1.0e6 * axis.actual.lead_m_per_rev / TAU };
    let mut set = Vec::new();
    loop_gains(&mut set, axis, &scaling)?;
    encoder(&mut set, axis)?;
    filter(&mut set, axis, period_s)?;
    limits(&mut set, axis, &scaling)?;
    compensation_values(&mut set, compensation, &scaling)?;
    Ok(set)
}

fn loop_gains(set: &mut Download, axis: &MachineAxis, scaling: &Scaling) -> Outcome<()> {
    let gains = &axis.gains;
    let inertia = axis.actual.mechanics.motor_inertia_kg + axis.actual.mechanics.table_mass_kg;
    let source = match gains.position_sensor {
        PositionSensor::Motor => 0.0,
        PositionSensor::Load => 1.0,
    };
    // N per m/s, as torque per count and cycle.
    let velocity_gain = scaling.torque(inertia * TAU * gains.velocity_bandwidth_hz) * COUNT_M / scaling.period_s;
    let integral = velocity_gain * TAU * gains.velocity_integral_hz * scaling.period_s;
    let acceleration = scaling.torque(inertia) * COUNT_M / (scaling.period_s * scaling.period_s);
    put(set, Parameter::PositionSource, "position_sensor", source)?;
    put(
        set,
        Parameter::PositionGain,
        "position_gain_per_s",
        gains.position_gain_per_s * scaling.period_s * two_to(24),
    )?;
    put(set, Parameter::VelocityGain, "velocity_bandwidth_hz", velocity_gain * two_to(12))?;
    put(set, Parameter::IntegralGain, "velocity_integral_hz", integral * two_to(12))?;
    put(set, Parameter::AccelerationGain, "motor_inertia_kg", acceleration * two_to(8))?;
    put(set, Parameter::VelocityFilter, "velocity_filter", gains.velocity_filter * two_to(30))?;
    put(set, Parameter::TorqueLimit, "force_limit_n", scaling.torque(axis.actual.force_limit_n))?;
    put(set, Parameter::RatedTorque, "force_limit_n", (scaling.torque(axis.actual.force_limit_n) / 1000.0).max(1.0))
}

fn encoder(set: &mut Download, axis: &MachineAxis) -> Outcome<()> {
    let way = axis.actual.lead_m_per_rev / f64::from(axis.actual.motor_encoder_counts_per_rev) / COUNT_M;
    put(set, Parameter::WayWhole, "motor_counts_per_rev", way.floor())?;
    put(set, Parameter::WayFraction, "motor_counts_per_rev", (way.fract() * two_to(31)).min(two_to(31) - 1.0))
}

/// Second-order filter by the bilinear transform: low-pass with Q = 1/√2, notch with Q = 1 (RBJ audio EQ cookbook).
fn filter(set: &mut Download, axis: &MachineAxis, period_s: f64) -> Outcome<()> {
    let (coefficients, key) = match (axis.gains.torque_low_pass_hz, axis.gains.torque_notch_hz) {
        (None, None) => return Ok(()),
        (Some(_), Some(_)) => {
            return Err(Failure::new(
                "torque_low_pass_hz and torque_notch_hz: the drive has one torque filter; choose one",
            ));
        }
        (Some(hz), None) => (low_pass(hz, period_s), "torque_low_pass_hz"),
        (None, Some(hz)) => (notch(hz, period_s), "torque_notch_hz"),
    };
    let places =
        [Parameter::FilterB0, Parameter::FilterB1, Parameter::FilterB2, Parameter::FilterA1, Parameter::FilterA2];
    places.into_iter().zip(coefficients).try_for_each(|(place, value)| put(set, place, key, value * two_to(29)))
}

fn low_pass(hz: f64, period_s: f64) -> [f64; 5] {
    let (sin, cos) = (TAU * hz * period_s).sin_cos();
    let alpha = sin * std::f64::consts::FRAC_1_SQRT_2;
    let a0 = 1.0 + alpha;
    [(1.0 - cos) / 2.0 / a0, (1.0 - cos) / a0, (1.0 - cos) / 2.0 / a0, 2.0 * cos / a0, (alpha - 1.0) / a0]
}

fn notch(hz: f64, period_s: f64) -> [f64; 5] {
    let (sin, cos) = (TAU * hz * period_s).sin_cos();
    let alpha = sin / 2.0;
    let a0 = 1.0 + alpha;
    [1.0 / a0, -2.0 * cos / a0, 1.0 / a0, 2.0 * cos / a0, (alpha - 1.0) / a0]
}

/// An encoder may jump by this without being implausible: it leaves room for a gap that closes.
const ENCODER_JUMP_M: f64 = 1.0e-4;
/// Following error window.
const FOLLOWING_ERROR_M: f64 = 2.0e-3;

fn limits(set: &mut Download, axis: &MachineAxis, scaling: &Scaling) -> Outcome<()> {
    let limits = &axis.limits;
    let stop_cycles = 1.5 * limits.velocity_m_per_s / limits.acceleration_m_per_s2 / scaling.period_s;
    put(set, Parameter::VelocityLimit, "velocity_m_per_s", scaling.velocity(limits.velocity_m_per_s) * two_to(12))?;
    put(
        set,
        Parameter::AccelerationLimit,
        "acceleration_m_per_s2",
        scaling.acceleration(limits.acceleration_m_per_s2) * two_to(12),
    )?;
    put(
        set,
        Parameter::StopDeceleration,
        "acceleration_m_per_s2",
        scaling.acceleration(limits.acceleration_m_per_s2) * two_to(12),
    )?;
    put(set, Parameter::StopCycles, "velocity_m_per_s", stop_cycles.min(10_000.0))?;
    put(set, Parameter::EncoderJumpLimit, "encoder jump", ENCODER_JUMP_M / COUNT_M)?;
    put(set, Parameter::FollowingErrorWindow, "following error window", FOLLOWING_ERROR_M / COUNT_M)
}

fn compensation_values(set: &mut Download, compensation: &AxisCompensation, scaling: &Scaling) -> Outcome<()> {
    let (mut coulomb, mut height, mut decay, mut delay) = (0.0, 0.0, 0.0, 0.0);
    match compensation.reversal {
        Compensation::None => {}
        Compensation::Coulomb { force_n } => coulomb = scaling.torque(force_n),
        Compensation::Pulse(pulse) => {
            height = scaling.velocity(pulse.height_m_per_s) * two_to(12);
            decay = (-scaling.period_s / pulse.time_constant_s).exp() * two_to(30);
            delay = pulse.start_delay_s / scaling.period_s;
        }
    }
    put(set, Parameter::CoulombTorque, "coulomb force_n", coulomb)?;
    put(set, Parameter::PulseAmplitude, "pulse height_m_per_s", height)?;
    put(set, Parameter::PulseDecay, "pulse time_constant_s", decay)?;
    put(set, Parameter::PulseStartDelay, "pulse start_delay_s", delay)?;
    let half_gap = 0.5 * compensation.backlash_m / COUNT_M * FINE_PER_COUNT;
    put(set, Parameter::BacklashHalfGap, "backlash_m", half_gap)
}

fn two_to(bits: i32) -> f64 {
    2.0_f64.powi(bits)
}

fn put(set: &mut Download, parameter: Parameter, key: &str, value: f64) -> Outcome<()> {
    let entry = TABLE.iter().find(|entry| entry.parameter == parameter);
    let entry = entry.ok_or_else(|| Failure::new(format!("{key}: the drive has no such object")))?;
    let rounded = value.round();
    if !(f64::from(entry.min)..=f64::from(entry.max)).contains(&rounded) {
        return Err(Failure::new(format!(
            "{key}: the drive cannot hold this value ({} [{}] takes {} to {}, wanted {rounded}); choose a smaller one, or other units",
            entry.name, entry.unit, entry.min, entry.max
        )));
    }
    #[expect(clippy::cast_possible_truncation, reason = "within an i32 range, checked above")]
    set.push((entry, rounded as i32));
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use plant_sim::Machine;

    fn raw(set: &Download, parameter: Parameter) -> f64 {
        f64::from(set.iter().find(|(entry, _)| entry.parameter == parameter).unwrap().1)
    }

    #[test]
    fn the_reference_gains_survive_fixed_point_to_a_millionth() {
        let machine = Machine::reference();
        let set = parameters(&machine.axes[0], machine.period_s, &AxisCompensation::default()).unwrap();
        // Back to SI: N per (m/s) and kg.
        let newton_per_micro_nm = TAU / 0.010 / 1.0e6;
        let kp = raw(&set, Parameter::VelocityGain) / two_to(12) * newton_per_micro_nm * 1.0e-3 / COUNT_M;
        let kg = raw(&set, Parameter::AccelerationGain) / two_to(8) * newton_per_micro_nm * 1.0e-6 / COUNT_M;
        assert!((kp / (931.65 * TAU * 30.0) - 1.0).abs() < 1.0e-6, "{kp}");
        assert!((kg / 931.65 - 1.0).abs() < 1.0e-6, "{kg}");
        assert!((raw(&set, Parameter::PositionGain) / two_to(24) - 0.040).abs() < 1.0e-7);
    }

    #[test]
    fn a_gain_that_the_drive_cannot_hold_names_its_key() {
        let mut machine = Machine::reference();
        machine.axes[0].gains.velocity_bandwidth_hz = 1.0e6;
        let error = parameters(&machine.axes[0], machine.period_s, &AxisCompensation::default()).unwrap_err();
        assert!(error.to_string().starts_with("velocity_bandwidth_hz: the drive cannot hold"), "{error}");
    }
}
