//! A parameter set, and what the drive makes of it.

use controller::backlash::BacklashConfig;
use controller::cascade::CascadeConfig;
use controller::filter::FilterConfig;
use controller::pulse::PulseConfig;
use controller::reference::{Ramp, ReferenceConfig};
use controller::units::{
    AccelerationGain, Position, PositionError, PositionGain, Torque, Velocity, VelocityGain, WayPerIncrement,
};
use controller::{Config, PositionSource};
use fixed::types::{I2F30, I8F24, I20F12, I24F8};

use crate::objects::{PARAMETERS, Parameter, TABLE};

/// One value per row of the object table.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ParameterSet([i32; PARAMETERS]);

impl Default for ParameterSet {
    fn default() -> Self {
        Self(TABLE.map(|entry| entry.default))
    }
}

/// Why a set as a whole is not valid, though each value is within its range.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SetError {
    /// The filter coefficients leave no headroom.
    FilterHeadroom,
    /// Backlash compensation needs velocity and acceleration limits.
    BacklashWithoutLimits,
    /// An encoder increment is worth nothing.
    EncoderWithoutWay,
}

/// Watchdog limits, all counted in cycles unless the name says otherwise.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Setpoints that may be missing in a row.
    pub setpoint_misses: u16,
    /// Feedbacks that may be missing in a row.
    pub feedback_misses: u16,
    /// Following error window.
    pub following_error: PositionError,
    /// Way by which a feedback may differ from the expected one.
    pub encoder_jump: PositionError,
    /// Cycles without a plant heartbeat.
    pub heartbeat: u16,
    /// Deceleration of a controlled stop, per cycle.
    pub stop_deceleration: Velocity,
    /// Longest controlled stop.
    pub stop: u16,
    /// SYNC timeout by wall clock, µs.
    pub sync_timeout_us: u64,
}

/// A parameter set that is fit to run.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// For the control law.
    pub config: Config,
    /// For the watchdogs.
    pub limits: Limits,
    /// Way per motor increment.
    pub way: WayPerIncrement,
    /// Rated torque, mN·m, at least 1.
    pub rated_torque_mnm: i32,
}

/// 1 m/s² at 1 kHz: a jerk of 50 m/s³ changes the acceleration by a twentieth of it per cycle.
const STEP: Velocity = Velocity(I20F12::from_bits(100 << 12));

impl ParameterSet {
    /// Raw value of a parameter.
    #[must_use]
    #[expect(clippy::as_conversions, reason = "repr(usize): the discriminant is the place")]
    pub fn get(&self, parameter: Parameter) -> i32 {
        self.0.get(parameter as usize).copied().unwrap_or(0)
    }

    /// Sets a raw value; the range was checked by the caller.
    #[expect(clippy::as_conversions, reason = "repr(usize): the discriminant is the place")]
    pub fn set(&mut self, parameter: Parameter, value: i32) {
        if let Some(place) = self.0.get_mut(parameter as usize) {
            *place = value;
        }
    }

    /// The settings that the set describes.
    ///
    /// # Errors
    /// [`SetError`] where values that are fine one by one do not go together.
    pub fn settings(&self) -> Result<Settings, SetError> {
        let way = self.way();
        if way == WayPerIncrement::default() {
            return Err(SetError::EncoderWithoutWay);
        }
        Ok(Settings {
            config: self.config()?,
            limits: self.limits(),
            way,
            rated_torque_mnm: self.get(Parameter::RatedTorque),
        })
    }

    fn config(&self) -> Result<Config, SetError> {
        Ok(Config {
            reference: self.reference(),
            position_source: match self.get(Parameter::PositionSource) {
                0 => PositionSource::Motor,
                _ => PositionSource::Load,
            },
            cascade: self.cascade(),
            pulse: self.pulse(),
            backlash: self.backlash()?,
            coulomb: Torque::from_micro_nm(self.get(Parameter::CoulombTorque)),
            filter: self.filter()?,
        })
    }

    /// Zero means no limit.
    fn reference(&self) -> ReferenceConfig {
        let limit = |parameter| match self.get(parameter) {
            0 => Velocity(I20F12::MAX),
            bits => Velocity(I20F12::from_bits(bits)),
        };
        let ramp = Ramp { deceleration: self.velocity(Parameter::StopDeceleration), jerk: Velocity::ZERO };
        ReferenceConfig {
            velocity_limit: limit(Parameter::VelocityLimit),
            acceleration_limit: limit(Parameter::AccelerationLimit),
            step: STEP,
            position_min: Position::from_counts(i64::MIN),
            position_max: Position::from_counts(i64::MAX),
            quick_stop: ramp,
            slow_down: ramp,
            filter_log2: 0,
            setpoint_cycles: 1,
        }
    }

    fn cascade(&self) -> CascadeConfig {
        CascadeConfig {
            position_gain: PositionGain(I8F24::from_bits(self.get(Parameter::PositionGain))),
            velocity_gain: VelocityGain(I20F12::from_bits(self.get(Parameter::VelocityGain))),
            integral_gain: VelocityGain(I20F12::from_bits(self.get(Parameter::IntegralGain))),
            acceleration_gain: AccelerationGain(I24F8::from_bits(self.get(Parameter::AccelerationGain))),
            velocity_filter: I2F30::from_bits(self.get(Parameter::VelocityFilter)),
            torque_limit: Torque::from_micro_nm(self.get(Parameter::TorqueLimit)),
        }
    }

    fn pulse(&self) -> PulseConfig {
        PulseConfig {
            amplitude: self.velocity(Parameter::PulseAmplitude),
            decay: I2F30::from_bits(self.get(Parameter::PulseDecay)),
            start_delay_cycles: self.cycles(Parameter::PulseStartDelay),
        }
    }

    fn backlash(&self) -> Result<BacklashConfig, SetError> {
        let config = BacklashConfig {
            half_gap: PositionError(I24F8::from_bits(self.get(Parameter::BacklashHalfGap))),
            velocity_limit: self.velocity(Parameter::VelocityLimit),
            acceleration_limit: self.velocity(Parameter::AccelerationLimit),
        };
        let limited = config.velocity_limit > Velocity::ZERO && config.acceleration_limit > Velocity::ZERO;
        if config.half_gap > PositionError::ZERO && !limited {
            return Err(SetError::BacklashWithoutLimits);
        }
        Ok(config)
    }

    fn filter(&self) -> Result<FilterConfig, SetError> {
        let coefficients =
            [Parameter::FilterB0, Parameter::FilterB1, Parameter::FilterB2, Parameter::FilterA1, Parameter::FilterA2];
        FilterConfig::new(coefficients.map(|place| self.get(place))).map_err(|_| SetError::FilterHeadroom)
    }

    fn limits(&self) -> Limits {
        Limits {
            setpoint_misses: self.cycles(Parameter::SetpointMissesAllowed),
            feedback_misses: self.cycles(Parameter::FeedbackMissesAllowed),
            following_error: self.way_of(Parameter::FollowingErrorWindow),
            encoder_jump: self.way_of(Parameter::EncoderJumpLimit),
            heartbeat: self.cycles(Parameter::HeartbeatCycles),
            stop_deceleration: self.velocity(Parameter::StopDeceleration),
            stop: self.cycles(Parameter::StopCycles),
            sync_timeout_us: u64::from(self.get(Parameter::SyncTimeout).unsigned_abs()),
        }
    }

    fn way(&self) -> WayPerIncrement {
        WayPerIncrement {
            whole: self.cycles(Parameter::WayWhole),
            fraction: self.get(Parameter::WayFraction).unsigned_abs().saturating_mul(2),
        }
    }

    fn velocity(&self, parameter: Parameter) -> Velocity {
        Velocity(I20F12::from_bits(self.get(parameter)))
    }

    fn way_of(&self, parameter: Parameter) -> PositionError {
        PositionError(I24F8::saturating_from_num(self.get(parameter)))
    }

    fn cycles(&self, parameter: Parameter) -> u16 {
        u16::try_from(self.get(parameter)).unwrap_or(u16::MAX)
    }
}
