//! From SI to the drive's parameters: integer steps of physical units, as the object table states
//! them.
//!
//! The drive itself turns them into machine units of the set's cycle time. Forces become motor
//! torques here, `T = F · lead / 2π`. Every value is rounded to its step and checked against the
//! range of its object, and the whole set against the drive's own check, so that a value that the
//! drive cannot hold is an error that names the key of the machine file.

use std::f64::consts::TAU;

use plant_sim::machine::{MachineAxis, PositionSensor};
use servo::objects::{Entry, Parameter, TABLE};
use servo::parameters::ParameterSet;

use crate::compensation::{Adaptive, AxisCompensation, Compensation, Model, Pulse};
use crate::error::{Failure, Outcome};
use crate::model_file::relation_m;

/// 10 nm, the position count of drive and bus.
pub const COUNT_M: f64 = 1.0e-8;
/// Counts of the setpoint frame per position count.
pub const FINE_PER_COUNT: f64 = 256.0;

/// Raw values of a parameter set, in the order of download.
pub type Download = Vec<(&'static Entry, i32)>;

/// The whole parameter set of an axis.
///
/// # Errors
/// [`Failure`] that names the key of the machine file or of the compensation whose value the drive
/// cannot hold.
pub fn parameters(
    axis: &MachineAxis,
    period_s: f64,
    compensation: &AxisCompensation,
) -> Outcome<Download> {
    let mut set = Set {
        values: Vec::new(),
        torque_per_newton: axis.actual.lead_m_per_rev / TAU,
    };
    set.cycle_time(period_s)?;
    set.loop_gains(axis, period_s)?;
    set.encoder(axis)?;
    set.filter(axis, period_s)?;
    set.limits(axis, period_s)?;
    set.mounting(axis)?;
    set.compensation(compensation)?;
    set.checked()
}

/// A set that is being made: each value with the key that it comes from.
struct Set {
    values: Vec<(&'static Entry, &'static str, i32)>,
    torque_per_newton: f64,
}

impl Set {
    /// Takes a value in SI units.
    fn put(&mut self, parameter: Parameter, key: &'static str, si: f64) -> Outcome<()> {
        let entry = TABLE.iter().find(|entry| entry.parameter == parameter);
        let entry =
            entry.ok_or_else(|| Failure::new(format!("{key}: the drive has no such object")))?;
        let rounded = (si * entry.unit().per_si as f64).round();
        if !(f64::from(entry.min)..=f64::from(entry.max)).contains(&rounded) {
            let forces = self.forces(entry);
            return Err(Failure::new(format!(
                "{key}: the drive cannot hold this value ({} [{}] takes {} to {}{forces}, wanted {rounded}); choose another one",
                entry.name(),
                entry.unit().text,
                entry.min,
                entry.max
            )));
        }
        #[expect(
            clippy::cast_possible_truncation,
            reason = "within an i32 range, checked above"
        )]
        self.values.push((entry, key, rounded as i32));
        Ok(())
    }

    /// What the range of a torque is in forces, which machine files have.
    fn forces(&self, entry: &Entry) -> String {
        if !entry.unit().text.ends_with("N m") {
            return String::new();
        }
        let force = |torque: i32| {
            let torque_nm = f64::from(torque) / entry.unit().per_si as f64;
            torque_nm / self.torque_per_newton
        };
        let lead_m = self.torque_per_newton * TAU;
        let [least, most] = [entry.min, entry.max].map(force);
        format!(", at {lead_m:.4} m a revolution {least:.0} to {most:.0} N")
    }

    /// Asks the drive's own code whether the set goes together and fits its machine units.
    fn checked(self) -> Outcome<Download> {
        let mut set = ParameterSet::default();
        for (entry, _, value) in &self.values {
            set.set(entry.parameter, *value);
        }
        if let Err(error) = set.settings() {
            let guilty = self
                .values
                .iter()
                .find(|(entry, ..)| entry.parameter == error.parameter());
            let key = guilty.map_or("parameter set", |(_, key, _)| key);
            return Err(Failure::new(format!(
                "{key}: the drive cannot hold this value: {}",
                error.text()
            )));
        }
        Ok(self
            .values
            .into_iter()
            .map(|(entry, _, value)| (entry, value))
            .collect())
    }

    /// The drive counts whole µs.
    fn cycle_time(&mut self, period_s: f64) -> Outcome<()> {
        let period_us = period_s * 1.0e6;
        if (period_us - period_us.round()).abs() > 1.0e-3 {
            return Err(Failure::new(format!(
                "period_s: {period_us} us is not a whole number of microseconds"
            )));
        }
        self.put(Parameter::CyclePeriod, "period_s", period_s)
    }

    fn loop_gains(&mut self, axis: &MachineAxis, period_s: f64) -> Outcome<()> {
        let gains = &axis.gains;
        let inertia_kg = axis.actual.inertia().inertia;
        let source = match gains.position_sensor {
            PositionSensor::Motor => 0.0,
            PositionSensor::Load => 1.0,
        };
        let limit_nm = axis.actual.force_limit_n * self.torque_per_newton;
        let filter_s = filter_time_constant(gains.velocity_filter, period_s);
        self.put(Parameter::PositionSource, "position_sensor", source)?;
        self.put(
            Parameter::PositionGain,
            "position_gain_per_s",
            gains.position_gain_per_s,
        )?;
        self.put(
            Parameter::Inertia,
            "motor_inertia_kg",
            inertia_kg * self.torque_per_newton,
        )?;
        self.put(
            Parameter::VelocityBandwidth,
            "velocity_bandwidth_hz",
            gains.velocity_bandwidth_hz,
        )?;
        self.put(
            Parameter::IntegralCorner,
            "velocity_integral_hz",
            gains.velocity_integral_hz,
        )?;
        self.put(Parameter::VelocityFilterTime, "velocity_filter", filter_s)?;
        self.put(Parameter::TorqueLimit, "force_limit_n", limit_nm)?;
        self.put(
            Parameter::RatedTorque,
            "force_limit_n",
            limit_nm.max(1.0e-3),
        )
    }

    fn encoder(&mut self, axis: &MachineAxis) -> Outcome<()> {
        let increments = f64::from(axis.actual.motor_encoder_counts_per_rev);
        self.put(
            Parameter::Feed,
            "lead_m_per_rev",
            axis.actual.lead_m_per_rev,
        )?;
        self.put(
            Parameter::EncoderIncrements,
            "motor_counts_per_rev",
            increments,
        )
    }

    fn filter(&mut self, axis: &MachineAxis, period_s: f64) -> Outcome<()> {
        let (coefficients, key) = torque_filter(axis, period_s)?;
        Parameter::TORQUE_FILTER
            .into_iter()
            .zip(coefficients)
            .try_for_each(|(place, value)| self.put(place, key, value))?;
        self.put(Parameter::FilterPeriod, key, period_s)
    }

    /// The ramps brake as hard as a path may; the drive itself may do a tenth more, to catch up
    /// after a loss. The travel is the software limit.
    fn limits(&mut self, axis: &MachineAxis, period_s: f64) -> Outcome<()> {
        let limits = &axis.limits;
        let (acceleration, key) = (limits.acceleration_m_per_s2, "acceleration_m_per_s2");
        self.put(
            Parameter::VelocityLimit,
            "velocity_m_per_s",
            limits.velocity_m_per_s,
        )?;
        self.put(
            Parameter::AccelerationLimit,
            key,
            ACCELERATION_RESERVE * acceleration,
        )?;
        self.put(Parameter::QuickStopDeceleration, key, acceleration)?;
        self.put(Parameter::SlowDownDeceleration, key, acceleration)?;
        self.put(Parameter::PositionMin, "travel_m", -limits.travel_m)?;
        self.put(Parameter::PositionMax, "travel_m", limits.travel_m)?;
        self.put(
            Parameter::EncoderJumpLimit,
            "encoder jump",
            encoder_jump_m(axis, period_s),
        )?;
        self.put(
            Parameter::FollowingErrorWindow,
            "following error window",
            FOLLOWING_ERROR_M,
        )
    }

    /// Brake, encoder relation and the weight of the axis. The preset is the torque that carries
    /// it: against gravity.
    fn mounting(&mut self, axis: &MachineAxis) -> Outcome<()> {
        let mounting = &axis.actual.mounting;
        let (open_s, close_s) = mounting
            .brake
            .map_or((0.0, 0.0), |brake| (brake.open_s, brake.close_s));
        let preset_nm = -mounting.gravity_n * self.torque_per_newton;
        self.put(Parameter::BrakeOpening, "open_s", open_s)?;
        self.put(Parameter::BrakeClosing, "close_s", close_s)?;
        self.put(Parameter::RelationOffset, "motor_zero_m", relation_m(axis))?;
        self.put(Parameter::PresetTorque, "gravity_n", preset_nm)
    }

    /// What is not asked for is switched off.
    fn compensation(&mut self, compensation: &AxisCompensation) -> Outcome<()> {
        let (mut force_n, mut pulse) = (0.0, Pulse::OFF);
        let (mut adaptive, mut model) = (&Adaptive::OFF, &Model::OFF);
        match &compensation.reversal {
            Compensation::None => {}
            Compensation::Coulomb { force_n: own } => force_n = *own,
            Compensation::Pulse(own) => pulse = *own,
            Compensation::Adaptive(own) => adaptive = own,
            Compensation::Model(own) => model = own,
        }
        let coulomb_nm = force_n * self.torque_per_newton;
        self.put(Parameter::CoulombTorque, "coulomb force_n", coulomb_nm)?;
        self.put(
            Parameter::BacklashGap,
            "backlash_m",
            compensation.backlash_m,
        )?;
        self.pulse(&pulse)?;
        self.adaptive(adaptive)?;
        self.model(model)
    }

    fn pulse(&mut self, pulse: &Pulse) -> Outcome<()> {
        let (height, time) = (pulse.height_m_per_s, pulse.time_constant_s);
        self.put(Parameter::PulseHeight, "pulse height_m_per_s", height)?;
        self.put(Parameter::PulseTime, "pulse time_constant_s", time)?;
        self.put(
            Parameter::PulseStartDelay,
            "pulse start_delay_s",
            pulse.start_delay_s,
        )
    }

    fn adaptive(&mut self, adaptive: &Adaptive) -> Outcome<()> {
        self.put(
            Parameter::AdaptiveFirst,
            "adaptive acceleration_m_per_s2",
            adaptive.acceleration_m_per_s2,
        )?;
        for (places, key, values) in [
            (
                Parameter::ADAPTIVE_FORWARD,
                "adaptive forward_m_per_s",
                adaptive.forward_m_per_s,
            ),
            (
                Parameter::ADAPTIVE_BACKWARD,
                "adaptive backward_m_per_s",
                adaptive.backward_m_per_s,
            ),
            (
                Parameter::ADAPTIVE_TIME,
                "adaptive time_constant_s",
                adaptive.time_constant_s,
            ),
            (
                Parameter::ADAPTIVE_DELAY,
                "adaptive start_delay_s",
                adaptive.start_delay_s,
            ),
        ] {
            for (place, value) in places.into_iter().zip(values) {
                self.put(place, key, value)?;
            }
        }
        Ok(())
    }

    fn model(&mut self, model: &Model) -> Outcome<()> {
        self.elements(model)?;
        self.all(&[
            (Parameter::FrictionAhead, "model ahead_s", model.ahead_s),
            (
                Parameter::FrictionDamping,
                "model damping_s",
                model.damping_s,
            ),
            (
                Parameter::LevelTuning,
                "model self_tuning",
                model.self_tuning,
            ),
        ])?;
        self.levels(model)?;
        self.screw(model)?;
        self.ripple(model)
    }

    fn all(&mut self, values: &[(Parameter, &'static str, f64)]) -> Outcome<()> {
        let mut each = values.iter();
        each.try_for_each(|(place, key, value)| self.put(*place, key, *value))
    }

    /// What levels of friction go with, and the viscous part.
    fn levels(&mut self, model: &Model) -> Outcome<()> {
        let per_newton = self.torque_per_newton;
        self.all(&[
            (
                Parameter::LevelSpan,
                "model span_m_per_s",
                model.span_m_per_s,
            ),
            (Parameter::LevelLagWay, "model lag_m", model.lag_m),
            (Parameter::LevelLagTime, "model lag_s", model.lag_s),
            (
                Parameter::LevelSlope,
                "model slope_per_m",
                model.slope_per_m,
            ),
            (Parameter::LevelBend, "model bend_per_m2", model.bend_per_m2),
            (
                Parameter::LevelAsymmetry,
                "model level_asymmetry_n",
                model.level_asymmetry_n * per_newton,
            ),
            (
                Parameter::WayAsymmetry,
                "model way_asymmetry",
                model.way_asymmetry,
            ),
            (
                Parameter::ViscousTorque,
                "model viscous_n_s_per_m",
                model.viscous_n_s_per_m * per_newton,
            ),
            (
                Parameter::ViscousAsymmetry,
                "model viscous_asymmetry_n_s_per_m",
                model.viscous_asymmetry_n_s_per_m * per_newton,
            ),
        ])
    }

    /// What is between motor and table.
    fn screw(&mut self, model: &Model) -> Outcome<()> {
        let per_newton = self.torque_per_newton;
        self.all(&[
            (
                Parameter::Windup,
                "model stiffness_n_per_m",
                1.0 / model.stiffness_n_per_m / per_newton,
            ),
            (
                Parameter::WindupAhead,
                "model windup_ahead_s",
                model.windup_ahead_s,
            ),
            (
                Parameter::MotorInertia,
                "model motor_inertia_kg",
                model.motor_inertia_kg * per_newton,
            ),
            (Parameter::GapWidth, "model gap_m", model.gap_m),
            (
                Parameter::GapTorque,
                "model gap_force_n",
                model.gap_force_n * per_newton,
            ),
            (
                Parameter::GapVelocity,
                "model gap_velocity_m_per_s",
                model.gap_velocity_m_per_s,
            ),
            (
                Parameter::TableInertia,
                "model table_mass_kg",
                model.table_mass_kg * per_newton,
            ),
            (
                Parameter::TableTorque,
                "model table_force_n",
                model.table_force_n * per_newton,
            ),
        ])
    }

    /// Elements and the levels over the speed.
    fn elements(&mut self, model: &Model) -> Outcome<()> {
        let per_newton = self.torque_per_newton;
        for (place, level_n) in Parameter::FRICTION_LEVELS.into_iter().zip(model.level_n) {
            self.put(place, "model level_n", level_n * per_newton)?;
        }
        for (place, slip_m) in Parameter::FRICTION_WAYS.into_iter().zip(model.slip_m) {
            self.put(place, "model slip_m", slip_m)?;
        }
        let on_motor = Parameter::FRICTION_ON_MOTOR.into_iter();
        for (place, share) in on_motor.zip(model.motor_share) {
            self.put(place, "model motor_share", share)?;
        }
        for (place, factor) in Parameter::LEVEL_FACTORS.into_iter().zip(model.factor) {
            self.put(place, "model factor", factor)?;
        }
        Ok(())
    }

    fn ripple(&mut self, model: &Model) -> Outcome<()> {
        for ([torque, period, phase], own) in Parameter::RIPPLES.into_iter().zip(model.ripple) {
            let torque_nm = own.amplitude_n * self.torque_per_newton;
            self.put(torque, "ripple amplitude_n", torque_nm)?;
            self.put(period, "ripple period_m", own.period_m)?;
            self.put(phase, "ripple phase_turns", own.phase_turns)?;
        }
        Ok(())
    }
}

/// What a motor may be beside where its last velocity leads without being implausible. Its own
/// force moves it by `F / m P²` within a cycle; twice that, since the load pushes too. A gap that
/// closes wants room as well.
fn encoder_jump_m(axis: &MachineAxis, period_s: f64) -> f64 {
    let acceleration = axis.actual.force_limit_n / axis.actual.mechanics.motor_inertia_kg;
    (2.0 * acceleration * period_s * period_s).max(GAP_CLOSES_M)
}

/// Room for a gap that closes.
const GAP_CLOSES_M: f64 = 1.0e-4;
/// Acceleration of the drive over that of a path. A path that takes all that the drive may leaves
/// nothing to catch up with: one setpoint lost at a step of 5 m/s² then costs 160 µm, with a tenth
/// of reserve 17 µm (2026-11-21, `cargo test -p hil-tests --test silence`).
const ACCELERATION_RESERVE: f64 = 1.1;
/// Following error window.
const FOLLOWING_ERROR_M: f64 = 2.0e-3;

/// The machine file gives the velocity filter as share α of the new value: α = 1 − exp(−T/τ), so τ
/// = −T / ln(1 − α). No filter: zero.
fn filter_time_constant(share: f64, period_s: f64) -> f64 {
    if share < 1.0 {
        -period_s / (-share).ln_1p()
    } else {
        0.0
    }
}

/// Coefficients `[b0, b1, b2, a1, a2]` of the torque filter, with the key that asks for it.
type TorqueFilter = ([f64; 5], &'static str);

/// Second-order filter by the bilinear transform: low-pass with Q = 1/√2, notch with Q = 1 (RBJ
/// audio EQ cookbook).
fn torque_filter(axis: &MachineAxis, period_s: f64) -> Outcome<TorqueFilter> {
    match (axis.gains.torque_low_pass_hz, axis.gains.torque_notch_hz) {
        (None, None) => Ok(([1.0, 0.0, 0.0, 0.0, 0.0], "torque filter")),
        (Some(_), Some(_)) => Err(Failure::new(
            "torque_low_pass_hz and torque_notch_hz: the drive has one torque filter; choose one",
        )),
        (Some(hz), None) => Ok((low_pass(hz, period_s), "torque_low_pass_hz")),
        (None, Some(hz)) => Ok((notch(hz, period_s), "torque_notch_hz")),
    }
}

fn low_pass(hz: f64, period_s: f64) -> [f64; 5] {
    let (sin, cos) = (TAU * hz * period_s).sin_cos();
    let alpha = sin * std::f64::consts::FRAC_1_SQRT_2;
    let a0 = 1.0 + alpha;
    [
        (1.0 - cos) / 2.0 / a0,
        (1.0 - cos) / a0,
        (1.0 - cos) / 2.0 / a0,
        2.0 * cos / a0,
        (alpha - 1.0) / a0,
    ]
}

fn notch(hz: f64, period_s: f64) -> [f64; 5] {
    let (sin, cos) = (TAU * hz * period_s).sin_cos();
    let alpha = sin / 2.0;
    let a0 = 1.0 + alpha;
    [
        1.0 / a0,
        -2.0 * cos / a0,
        1.0 / a0,
        2.0 * cos / a0,
        (alpha - 1.0) / a0,
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use plant_sim::Machine;
    use plant_sim::brake::BrakeParameters;
    use servo::settings::Settings;

    fn settings(machine: &Machine, compensation: &AxisCompensation) -> Settings {
        let mut set = ParameterSet::default();
        for (entry, value) in parameters(&machine.axes[0], machine.period_s, compensation).unwrap()
        {
            set.set(entry.parameter, value);
        }
        set.settings().unwrap()
    }

    #[test]
    fn a_motor_that_its_own_force_moves_is_plausible_at_long_periods_too() {
        let mut machine = Machine::reference();
        let jump_m = |machine: &Machine| {
            let settings = settings(machine, &AxisCompensation::default());
            settings.limits.encoder_jump.0.to_num::<f64>() * COUNT_M
        };
        assert_same("at 1 ms", jump_m(&machine), GAP_CLOSES_M);
        machine.period_s = 8.0e-3;
        let actual = &machine.axes[0].actual;
        let moved_m = actual.force_limit_n / actual.mechanics.motor_inertia_kg * 64.0e-6;
        let allowed = jump_m(&machine) / moved_m;
        assert!((1.9..2.1).contains(&allowed), "{allowed}");
    }

    fn assert_same(what: &str, got: f64, wanted: f64) {
        assert!(
            (got / wanted - 1.0).abs() < 1.0e-6,
            "{what}: {got}, wanted {wanted}"
        );
    }

    #[test]
    fn the_reference_gains_survive_fixed_point_to_a_millionth() {
        let machine = Machine::reference();
        let cascade = settings(&machine, &AxisCompensation::default())
            .config
            .cascade;
        // Back to SI: N per (m/s), kg.
        let newton_per_micro_nm = TAU / 0.010 / 1.0e6;
        let per_velocity = newton_per_micro_nm * machine.period_s / COUNT_M;
        let kp = cascade.velocity_gain.0.to_num::<f64>() * per_velocity;
        let ki = cascade.integral_gain.0.to_num::<f64>() * per_velocity / machine.period_s;
        let kg = cascade.acceleration_gain.0.to_num::<f64>() * per_velocity * machine.period_s;
        assert_same("Kp", kp, 931.65 * TAU * 30.0);
        assert_same("Ki", ki, 931.65 * TAU * 30.0 * TAU * 7.5);
        assert_same("Ja", kg, 931.65);
        assert_same(
            "Kv",
            cascade.position_gain.0.to_num::<f64>() / machine.period_s,
            40.0,
        );
        assert_same("velocity filter", cascade.velocity_filter.to_num(), 0.6);
        assert_same(
            "torque limit",
            f64::from(cascade.torque_limit.micro_nm()) * newton_per_micro_nm,
            9000.0,
        );
    }

    #[test]
    fn a_model_with_ripple_asymmetry_and_places_survives_fixed_point() {
        let ripple = crate::compensation::Ripple {
            amplitude_n: 30.0,
            period_m: 0.002,
            phase_turns: -0.25,
        };
        let model = Model {
            level_n: [40.0; crate::compensation::ELEMENTS],
            viscous_asymmetry_n_s_per_m: -500.0,
            motor_share: [0.25; crate::compensation::ELEMENTS],
            level_asymmetry_n: -60.0,
            way_asymmetry: -0.2,
            slope_per_m: -0.8,
            bend_per_m2: 2.5,
            self_tuning: 0.25,
            ripple: [crate::compensation::Ripple::NONE, ripple],
            ..Model::OFF
        };
        let compensation = AxisCompensation {
            reversal: Compensation::Model(Box::new(model)),
            ..AxisCompensation::default()
        };
        let config = settings(&Machine::reference(), &compensation).config;
        let newton = TAU / 0.010 / 1.0e6;
        let [none, wave] = config.compensation.unwrap().ripple.waves;
        assert_eq!(none.amplitude_micro_nm, 0);
        let amplitude_n = newton * f64::from(wave.amplitude_micro_nm);
        assert!((amplitude_n - 30.0).abs() < newton, "{amplitude_n}");
        let counts = 2.0_f64.powi(48) / wave.per_position as f64;
        assert_same("period", counts * COUNT_M, 0.002);
        assert_eq!(wave.phase, -(1 << 30));
        let friction = config.friction().unwrap();
        let per_velocity = newton * 1.0e-3 / COUNT_M;
        let [forward, backward] = friction.viscous.map(|gain| gain.0.to_num::<f64>());
        let asymmetry = 0.5 * (forward - backward) * per_velocity;
        assert!((asymmetry + 500.0).abs() < 0.02, "{asymmetry}");
        let [stiffness, of_table] = [
            friction.elements.stiffnesses[0],
            friction.elements.of_table[0],
        ]
        .map(f64::from);
        let way = friction.elements.ways[0].to_num::<f64>() * 4096.0;
        let level_n = stiffness * 2.0_f64.powi(-24) * way * newton;
        assert!((level_n - 40.0).abs() < 1.0e-3, "{level_n}");
        assert!((of_table / stiffness - 0.75).abs() < 2.0e-5, "{of_table}");
        let by_direction = friction.by_direction;
        let level_n = f64::from(by_direction.level_micro_nm) * newton;
        assert!((level_n + 60.0).abs() < newton, "{level_n}");
        let [forward, backward] = by_direction.ways.map(|counts| counts.to_num::<f64>());
        assert_same("forward", forward, 1.25);
        assert_same("backward", backward, 1.0 / 1.2);
        let unit_m = COUNT_M * 2.0_f64.powi(24);
        let linear = friction.place.linear.to_num::<f64>() / unit_m;
        let quadratic = friction.place.quadratic.to_num::<f64>() / unit_m / unit_m;
        assert_same("slope", linear, -0.8);
        assert!((quadratic - 2.5).abs() < 1.0e-5, "{quadratic}");
        // A quarter over twice 400 N.
        let share = f64::from(friction.tuning.per_micro_nm) / 2.0_f64.powi(40);
        assert!(
            (share * 800.0 / newton / 0.25 - 1.0).abs() < 1.0e-4,
            "{share}"
        );
    }

    #[test]
    fn the_same_machine_keeps_its_si_gains_at_any_period() {
        let mut machine = Machine::reference();
        for period_s in [2.5e-4, 5.0e-4, 1.0e-3, 2.0e-3, 4.0e-3] {
            machine.period_s = period_s;
            let settings = settings(&machine, &AxisCompensation::default());
            let per_velocity = TAU / 0.010 / 1.0e6 * period_s / COUNT_M;
            let kp = settings.config.cascade.velocity_gain.0.to_num::<f64>() * per_velocity;
            assert!(
                (kp / (931.65 * TAU * 30.0) - 1.0).abs() < 2.0e-6,
                "{kp} at {period_s}"
            );
            let deceleration = settings
                .config
                .reference
                .quick_stop
                .deceleration
                .0
                .to_num::<f64>();
            assert!(
                (deceleration * COUNT_M / period_s / period_s / 5.0 - 1.0).abs() < 1.0e-5,
                "{deceleration}"
            );
        }
    }

    #[test]
    fn the_pulse_is_that_of_the_file() {
        let pulse = crate::compensation::Pulse {
            height_m_per_s: 1.0e-3,
            time_constant_s: 0.02,
            start_delay_s: 0.003,
        };
        let compensation = AxisCompensation {
            reversal: Compensation::Pulse(pulse),
            backlash_m: 4.0e-5,
        };
        let config = settings(&Machine::reference(), &compensation).config;
        let compensation = config.compensation.unwrap();
        assert_same(
            "height",
            compensation.pulse.shape.amplitude.0.to_num(),
            100.0,
        );
        assert_same(
            "decay",
            compensation.pulse.shape.decay.to_num(),
            (-0.05_f64).exp(),
        );
        assert_eq!(compensation.pulse.shape.start_delay_cycles, 3);
        assert_same(
            "half gap",
            compensation.backlash.half_gap.0.to_num(),
            2000.0,
        );
    }

    #[test]
    fn an_axis_that_is_not_mounted_otherwise_has_no_brake_no_preset_and_encoders_that_agree() {
        let settings = settings(&Machine::reference(), &AxisCompensation::default());
        assert_eq!(
            (settings.brake.open_cycles, settings.brake.close_cycles),
            (0, 0)
        );
        assert_eq!(
            (
                settings.preset.torque.to_micro_nm_lossy(),
                settings.relation.offset
            ),
            (0, 0)
        );
    }

    #[test]
    fn the_preset_holds_against_gravity_and_the_brake_has_its_times() {
        let mut machine = Machine::reference();
        let brake = BrakeParameters {
            rated_force_n: 4000.0,
            open_s: 0.030,
            close_s: 0.0405,
            rise_s: 0.0,
        };
        let mounting = &mut machine.axes[0].actual.mounting;
        (mounting.gravity_n, mounting.brake) = (-2500.0, Some(brake));
        let up = settings(&machine, &AxisCompensation::default());
        assert_eq!(
            (up.brake.open_cycles, up.brake.close_cycles),
            (30, 41),
            "whole cycles, rounded up"
        );
        // 2500 N at a lead of 10 mm: 2500 · 0.010 / 2π N·m.
        assert_eq!(up.preset.torque.to_micro_nm_lossy(), 3_978_874);
        assert!(!up.preset.from_last);
        machine.axes[0].actual.mounting.gravity_n = 2500.0;
        let down = settings(&machine, &AxisCompensation::default());
        assert_eq!(down.preset.torque.to_micro_nm_lossy(), -3_978_874);
    }

    #[test]
    fn an_axis_heavier_than_its_motor_names_gravity() {
        let mut machine = Machine::reference();
        machine.axes[0].actual.mounting.gravity_n = -9001.0;
        let error = parameters(
            &machine.axes[0],
            machine.period_s,
            &AxisCompensation::default(),
        )
        .unwrap_err();
        assert!(
            error
                .to_string()
                .starts_with("gravity_n: the drive cannot hold"),
            "{error}"
        );
    }

    #[test]
    fn a_force_beyond_the_torque_of_the_drive_is_told_in_forces_too() {
        let mut machine = Machine::reference();
        machine.axes[0].actual.force_limit_n = 200_000.0;
        let axis = &machine.axes[0];
        let error = parameters(axis, machine.period_s, &AxisCompensation::default()).unwrap_err();
        // 250 N m at 10 mm a revolution.
        let wanted = "at 0.0100 m a revolution 0 to 157080 N, wanted 318309886)";
        assert!(error.to_string().contains(wanted), "{error}");
    }

    #[test]
    fn the_relation_is_the_scale_where_the_motor_encoder_is_zero() {
        let mut machine = Machine::reference();
        let mounting = &mut machine.axes[0].actual.mounting;
        (mounting.motor_zero_m, mounting.load_zero_m) = (0.1, -0.02);
        assert_eq!(
            settings(&machine, &AxisCompensation::default())
                .relation
                .offset,
            12_000_000,
            "10 nm"
        );
    }

    fn assert_cannot_hold(axis: &MachineAxis, period_s: f64, key: &str) {
        let error = parameters(axis, period_s, &AxisCompensation::default()).unwrap_err();
        let error = error.to_string();
        assert!(
            error.starts_with(&format!("{key}: the drive cannot hold")),
            "{error}"
        );
    }

    #[test]
    fn a_value_beyond_the_range_of_its_object_names_its_key() {
        let mut machine = Machine::reference();
        machine.axes[0].gains.velocity_bandwidth_hz = 1.0e6;
        assert_cannot_hold(&machine.axes[0], machine.period_s, "velocity_bandwidth_hz");
    }

    #[test]
    fn a_value_beyond_the_machine_units_names_its_key() {
        // 0.5 m/s are 10⁶ counts in 20 ms: more than the drive's velocities hold.
        let mut axis = Machine::reference().axes[0].clone();
        axis.gains.position_gain_per_s = 10.0;
        assert_cannot_hold(&axis, 0.02, "velocity_m_per_s");
        axis.limits.velocity_m_per_s = 0.1;
        axis.gains.position_gain_per_s = 100.0;
        assert_cannot_hold(&axis, 0.02, "position_gain_per_s");
    }

    #[test]
    fn a_period_that_is_no_whole_number_of_microseconds_is_refused() {
        let machine = Machine::reference();
        let error =
            parameters(&machine.axes[0], 1.0e-3 / 3.0, &AxisCompensation::default()).unwrap_err();
        assert!(error.to_string().starts_with("period_s: "), "{error}");
    }
}
