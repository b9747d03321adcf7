//! From a parameter set to settings: physical units become machine units of the set's cycle time T.
//!
//! A person gives physical units. The control law counts 10 nm, cycles and µN·m. Between them stand
//! these equations (1 count = 10 nm, I: inertia as torque per acceleration), evaluated once, at
//! commit:
//!
//! ```text
//! velocity      v · T       Kp = 2π f I               velocity filter  α = 1 − exp(−T/τ)
//! acceleration  a · T²      Ki · T = Kp · 2π fi · T   pulse            decay = exp(−T/T_comp)
//! jerk          j · T³      Ja = share · I            way per increment = feed / increments
//! ```
//!
//! Each value is rounded once, to nearest: it is off by at most half a unit of its type or a
//! millionth, the exponentials by 2⁻³⁰. A value that the type cannot hold at that cycle time, or
//! that would become zero though it is not, refuses the whole set: nothing saturates.

mod pulse;

use controller::backlash::BacklashConfig;
use controller::cascade::CascadeConfig;
use controller::compensation::Compensation;
use controller::filter::{FilterConfig, FilterError};
use controller::friction::{
    Ahead, ByDirection, Elements, FrictionConfig, Gap, LEVELS, LevelCurve, LevelLag, LevelPlace,
    LevelTuning, STIFFNESS_BITS, Screw,
};
use controller::reference::{Ramp, ReferenceConfig};
use controller::ripple::{RippleConfig, Wave};
use controller::units::{
    AccelerationGain, Position, PositionError, PositionGain, Torque, TorqueLimit, Velocity,
    VelocityGain, WayPerIncrement,
};
use controller::{Config, PositionSource};
use fixed::types::{I2F30, I4F28, I8F24, I20F12, I24F8, I56F8, U17F15};
use protocol::table::HEARTBEAT_EVERY_CYCLES;

use crate::objects::Parameter;
use crate::parameters::{ParameterSet, SetError};
use crate::physical::{Fraction, decay};
use crate::settings::{
    AbortConnectionOption, Brake, Limits, Options, Preset, Relation, Settings, StopOption,
};

/// 2π and its square as fractions: 3·10⁻¹¹ and 1·10⁻¹¹ off.
const TWO_PI: (u64, u64) = (6_283_185_307, 1_000_000_000);
const TWO_PI_SQUARED: (u64, u64) = (39_478_417_604, 1_000_000_000);
/// Counts of 10 nm in a metre.
const COUNTS_PER_M: u64 = 100_000_000;
/// µN·m per count over N·m per metre: 10⁶ · 10⁻⁸ is one hundredth.
const TORQUE_PER_COUNT: u64 = 100;
const MICROS: u64 = 1_000_000;
/// Fractional bits of the machine units.
const Q8: u64 = 1 << 8;
const Q12: u64 = 1 << 12;
const Q15: u64 = 1 << 15;
const Q24: u64 = 1 << 24;
const Q28: u64 = 1 << 28;
const Q30: u64 = 1 << 30;
const Q32: u64 = 1 << 32;
const Q40: u64 = 1 << 40;
const Q48: u64 = 1 << 48;
/// Bits of a stiffness per 2⁻¹⁵ of 10 nm.
const STEPS_OF_A_STIFFNESS: u64 = 1 << (STIFFNESS_BITS + 3);
/// Counts in which the friction model has places along the travel.
const PLACE: u64 = 1 << 24;
/// The friction model looks so many cycles ahead at most, with 24 fractional bits.
const LONGEST_AHEAD: i32 = 8 << 24;
/// A position gain above one per cycle is not stable.
const LARGEST_POSITION_GAIN: i32 = 1 << 24;
/// 2⁻⁸ of 10 nm per cycle.
const SMALLEST_LIMIT: Velocity = Velocity(I20F12::from_bits(16));
/// SYNC may be silent for so many periods where the set does not say it (2131h = 0): two more than
/// the setpoints and feedbacks that may be missing in a row.
pub(crate) const SYNC_TIMEOUT_PERIODS: u64 = 5;
/// The peer's heartbeat may be silent for so many periods where the set does not say it: four and a
/// half heartbeats. Where 2 % of them are lost or damaged, two in a row go missing once in 250 s at
/// 1 kHz, which stopped an axis; four once in a week.
const HEARTBEAT_TIMEOUT_PERIODS: u64 = 450;

impl ParameterSet {
    /// The settings that the set describes, in machine units of its cycle time.
    ///
    /// # Errors
    /// [`SetError`] where values that are fine one by one do not go together, or do not fit the
    /// machine units.
    pub fn settings(&self) -> Result<Settings, SetError> {
        let reading = Reading::of(self);
        reading.check_limits()?;
        Ok(Settings {
            period_us: self.get(Parameter::CyclePeriod).unsigned_abs(),
            config: reading.config()?,
            limits: reading.limits()?,
            options: reading.options(),
            brake: reading.brake()?,
            preset: reading.preset(),
            relation: reading.relation(),
            way: reading.way()?,
            rated_torque_mnm: self.get(Parameter::RatedTorque),
        })
    }
}

/// A set that is being read at its cycle time.
struct Reading<'a> {
    set: &'a ParameterSet,
    period_us: u64,
}

impl<'a> Reading<'a> {
    fn of(set: &'a ParameterSet) -> Self {
        let period_us = u64::from(set.get(Parameter::CyclePeriod).unsigned_abs());
        Self { set, period_us }
    }
}

// Conversions of one value.
impl Reading<'_> {
    fn raw(&self, parameter: Parameter) -> i32 {
        self.set.get(parameter)
    }

    /// Magnitude of the raw number.
    fn steps(&self, parameter: Parameter) -> u64 {
        u64::from(self.raw(parameter).unsigned_abs())
    }

    /// A fraction as a machine number; what does not fit is the fault of `parameter`.
    fn held(parameter: Parameter, numerator: &[u64], denominator: &[u64]) -> Result<i32, SetError> {
        let value = Fraction::new(numerator, denominator).and_then(Fraction::nearest);
        match value.and_then(|value| i32::try_from(value).ok()) {
            None => Err(SetError::TooLarge(parameter)),
            Some(0) if numerator.iter().all(|factor| *factor > 0) => {
                Err(SetError::TooSmall(parameter))
            }
            Some(value) => Ok(value),
        }
    }

    /// A size with the sign of its parameter.
    fn signed(&self, parameter: Parameter, size: i32) -> i32 {
        if self.raw(parameter) < 0 {
            size.wrapping_neg()
        } else {
            size
        }
    }

    /// A velocity (order 1), acceleration (2) or jerk (3): raw / steps per SI unit · T^order, in
    /// counts of 10 nm with 12 fractional bits.
    ///
    /// The largest numerator is that of a jerk: 2³¹ · (2·10⁴)³ · 10⁸ · 2¹² is below 2¹¹⁴.
    fn motion(&self, parameter: Parameter, order: u32) -> Result<Velocity, SetError> {
        let time = self.period_us.saturating_pow(order);
        let numerator = [self.steps(parameter), time, COUNTS_PER_M, Q12];
        let bits = Self::held(
            parameter,
            &numerator,
            &[parameter.unit().per_si, MICROS.saturating_pow(order)],
        )?;
        Ok(Velocity(I20F12::from_bits(self.signed(parameter, bits))))
    }

    /// A limit of the reference stage, which counts 2⁻⁸ of 10 nm: what is less there would be none.
    fn limit(&self, parameter: Parameter, order: u32) -> Result<Velocity, SetError> {
        let limit = self.motion(parameter, order)?;
        if self.steps(parameter) > 0 && limit < SMALLEST_LIMIT {
            Err(SetError::TooSmall(parameter))
        } else {
            Ok(limit)
        }
    }

    /// A way given in counts; its row keeps it below what the type holds.
    fn window(&self, parameter: Parameter) -> PositionError {
        PositionError(I24F8::saturating_from_num(self.raw(parameter)))
    }

    fn torque(&self, parameter: Parameter) -> Torque {
        Torque::from_micro_nm(self.raw(parameter))
    }

    /// A count; its row keeps it below 2¹⁶.
    fn count(&self, parameter: Parameter) -> u16 {
        u16::try_from(self.raw(parameter)).unwrap_or(u16::MAX)
    }

    fn small(&self, parameter: Parameter) -> u8 {
        u8::try_from(self.raw(parameter)).unwrap_or(u8::MAX)
    }

    fn cycles_up(&self, parameter: Parameter) -> Result<u16, SetError> {
        let cycles =
            Fraction::new(&[self.steps(parameter)], &[self.period_us]).and_then(Fraction::up);
        cycles
            .and_then(|cycles| u16::try_from(cycles).ok())
            .ok_or(SetError::TooLarge(parameter))
    }

    /// `exp(−T/τ)` with 30 fractional bits.
    fn decay(&self, parameter: Parameter) -> I2F30 {
        let bits = decay(self.period_us.saturating_mul(1000), self.steps(parameter));
        I2F30::from_bits(i32::try_from(bits).unwrap_or(1 << 30))
    }
}

// The control law.
impl Reading<'_> {
    fn config(&self) -> Result<Config, SetError> {
        Ok(Config {
            position_source: match self.raw(Parameter::PositionSource) {
                0 => PositionSource::Motor,
                _ => PositionSource::Load,
            },
            cascade: self.cascade()?,
            compensation: Some(self.compensation()?).filter(|own| !own.is_off()),
            filter: self.filter()?,
            reference: self.reference()?,
        })
    }

    fn compensation(&self) -> Result<Compensation, SetError> {
        Ok(Compensation {
            pulse: self.pulse()?,
            backlash: self.backlash()?,
            coulomb: self.torque(Parameter::CoulombTorque),
            friction: self.friction()?,
            ripple: self.ripple()?,
        })
    }

    fn cascade(&self) -> Result<CascadeConfig, SetError> {
        if self.raw(Parameter::VelocityBandwidth) > 0 && self.raw(Parameter::Inertia) == 0 {
            return Err(SetError::WithoutInertia(Parameter::Inertia));
        }
        Ok(CascadeConfig {
            position_gain: PositionGain(I8F24::from_bits(self.position_gain()?)),
            velocity_gain: VelocityGain(I20F12::from_bits(self.velocity_gain()?)),
            integral_gain: VelocityGain(I20F12::from_bits(self.integral_gain()?)),
            acceleration_gain: AccelerationGain(I24F8::from_bits(self.acceleration_gain()?)),
            velocity_filter: I2F30::ONE.saturating_sub(self.decay(Parameter::VelocityFilterTime)),
            torque_limit: TorqueLimit::from_micro_nm(self.raw(Parameter::TorqueLimit)),
        })
    }

    /// Kv · T.
    fn position_gain(&self) -> Result<i32, SetError> {
        let parameter = Parameter::PositionGain;
        let per_si = parameter.unit().per_si;
        let bits = Self::held(
            parameter,
            &[self.steps(parameter), self.period_us, Q24],
            &[per_si, MICROS],
        )?;
        if bits > LARGEST_POSITION_GAIN {
            Err(SetError::TooLarge(parameter))
        } else {
            Ok(bits)
        }
    }

    /// 2π f I, per count and cycle: over T. Below 2²⁴ · 2³¹ · 2³³ · 2¹² · 10⁶, that is 2¹²⁰.
    fn velocity_gain(&self) -> Result<i32, SetError> {
        let (parameter, inertia) = (Parameter::VelocityBandwidth, Parameter::Inertia);
        let numerator = [
            self.steps(parameter),
            self.steps(inertia),
            TWO_PI.0,
            Q12,
            MICROS,
        ];
        let (f, i) = (parameter.unit().per_si, inertia.unit().per_si);
        Self::held(
            parameter,
            &numerator,
            &[f, i, TWO_PI.1, TORQUE_PER_COUNT, self.period_us],
        )
    }

    /// Kp · 2π fi · T, per count and cycle: T falls out. At most 10⁷ · 10⁷ · 2³¹ · 4·10¹⁰ · 2¹²,
    /// that is below 2¹²⁵.
    fn integral_gain(&self) -> Result<i32, SetError> {
        let (corner, bandwidth, inertia) = (
            Parameter::IntegralCorner,
            Parameter::VelocityBandwidth,
            Parameter::Inertia,
        );
        let numerator = [
            self.steps(corner),
            self.steps(bandwidth),
            self.steps(inertia),
            TWO_PI_SQUARED.0,
            Q12,
        ];
        let (c, b, i) = (
            corner.unit().per_si,
            bandwidth.unit().per_si,
            inertia.unit().per_si,
        );
        Self::held(
            corner,
            &numerator,
            &[c, b, i, TWO_PI_SQUARED.1, TORQUE_PER_COUNT],
        )
    }

    /// The inertia's share in the acceleration feedforward.
    fn acceleration_gain(&self) -> Result<i32, SetError> {
        let share = Parameter::AccelerationShare;
        let share = (self.steps(share), share.unit().per_si);
        self.inertia_gain(Parameter::Inertia, share)
    }

    /// share · I, per count and cycle²: over T². Below 2³¹ · 2²¹ · 2⁸ · 10¹², that is 2¹⁰⁰.
    fn inertia_gain(&self, inertia: Parameter, share: (u64, u64)) -> Result<i32, SetError> {
        let numerator = [self.steps(inertia), share.0, Q8, MICROS, MICROS];
        let i = inertia.unit().per_si;
        Self::held(
            inertia,
            &numerator,
            &[i, share.1, TORQUE_PER_COUNT, self.period_us, self.period_us],
        )
    }

    /// A length over a number.
    fn length(&self, way: Parameter, over: u64) -> Result<PositionError, SetError> {
        let numerator = [self.steps(way), COUNTS_PER_M, Q8];
        let held = Self::held(way, &numerator, &[way.unit().per_si, over])?;
        Ok(PositionError(I24F8::from_bits(held)))
    }

    fn backlash(&self) -> Result<BacklashConfig, SetError> {
        Ok(BacklashConfig {
            half_gap: self.length(Parameter::BacklashGap, 2)?,
            velocity_limit: self.limit(Parameter::VelocityLimit, 1)?,
            acceleration_limit: self.limit(Parameter::AccelerationLimit, 2)?,
        })
    }

    /// The friction model; without a level and a viscous torque there is none.
    fn friction(&self) -> Result<Option<FrictionConfig>, SetError> {
        let says = |parameter: &Parameter| self.steps(*parameter) > 0;
        if !(Parameter::FRICTION_LEVELS.iter().any(says) || says(&Parameter::ViscousTorque)) {
            return Ok(None);
        }
        let ahead = self.cycles(Parameter::FrictionAhead)?;
        let torque = ahead.saturating_add(Ahead::HALF_A_CYCLE);
        let viscous = self.viscous(Parameter::ViscousTorque)?;
        let asymmetry = self.viscous(Parameter::ViscousAsymmetry)?;
        Ok(Some(FrictionConfig {
            elements: self.elements()?,
            levels: self.levels()?,
            lag: self.level_lag(I8F24::ONE),
            lag_per_way: self.lag_per_way()?,
            place: self.level_place(),
            by_direction: self.by_direction(),
            tuning: self.level_tuning()?,
            viscous: [viscous.plus(asymmetry), viscous.minus(asymmetry)],
            torque: self.ahead_by(torque),
            lag_after: self.level_lag(torque.saturating_add(I8F24::ONE)),
            damping_cycles: self.cycles(Parameter::FrictionDamping)?,
            screw: self.screw()?,
            windup_cycles: self.signed_cycles(Parameter::WindupAhead)?,
            motor_inertia: AccelerationGain(I24F8::from_bits(
                self.inertia_gain(Parameter::MotorInertia, (1, 1))?,
            )),
        }))
    }

    /// Levels and ways of elements become ways and stiffnesses; a level that is too low for a
    /// stiffness counts as zero.
    fn elements(&self) -> Result<Elements, SetError> {
        let mut elements = Elements::default();
        let Elements {
            ways,
            stiffnesses,
            of_table,
        } = &mut elements;
        let each = ways.iter_mut().zip(stiffnesses).zip(of_table);
        for (((level, way), on_motor), ((slips_after, all), table)) in Parameter::FRICTION_LEVELS
            .into_iter()
            .zip(Parameter::FRICTION_WAYS)
            .zip(Parameter::FRICTION_ON_MOTOR)
            .zip(each)
        {
            *slips_after = self.slip_way(way)?;
            let whole = on_motor.unit().per_si;
            let left = whole.saturating_sub(self.steps(on_motor));
            *all = self.stiffness(level, (whole, whole), *slips_after)?;
            *table = self.stiffness(level, (left, whole), *slips_after)?;
        }
        Ok(elements)
    }

    /// Below 2²⁴ · 2²⁷ · 2¹⁵.
    fn slip_way(&self, way: Parameter) -> Result<U17F15, SetError> {
        let numerator = [self.steps(way), COUNTS_PER_M, Q15];
        let bits = Fraction::new(&numerator, &[way.unit().per_si]).and_then(Fraction::nearest);
        let bits = bits.and_then(|bits| u32::try_from(bits).ok());
        bits.map(U17F15::from_bits).ok_or(SetError::TooLarge(way))
    }

    /// A share of a level over a way. Below 2²⁸ · 2²⁰ · 2²⁷.
    fn stiffness(
        &self,
        level: Parameter,
        (share, whole): (u64, u64),
        way: U17F15,
    ) -> Result<i32, SetError> {
        let numerator = [self.steps(level), share, STEPS_OF_A_STIFFNESS];
        let denominator = [u64::from(way.to_bits()), whole];
        let bits = Fraction::new(&numerator, &denominator).and_then(Fraction::nearest);
        let bits = bits.and_then(|bits| i32::try_from(bits).ok());
        bits.ok_or(SetError::TooLarge(level))
    }

    /// One over a way, per count.
    fn per_way(&self, way: Parameter) -> Result<I8F24, SetError> {
        let bits = Self::held(
            way,
            &[way.unit().per_si, Q24],
            &[self.steps(way), COUNTS_PER_M],
        )?;
        Ok(I8F24::from_bits(bits))
    }

    /// A time in cycles. Below 2¹⁷ · 2²⁴.
    fn cycles(&self, parameter: Parameter) -> Result<I8F24, SetError> {
        let bits = Self::held(parameter, &[self.steps(parameter), Q24], &[self.period_us])?;
        if bits > LONGEST_AHEAD {
            return Err(SetError::TooLarge(parameter));
        }
        Ok(I8F24::from_bits(bits))
    }

    fn signed_cycles(&self, parameter: Parameter) -> Result<I8F24, SetError> {
        let cycles = self.cycles(parameter)?;
        Ok(I8F24::from_bits(self.signed(parameter, cycles.to_bits())))
    }

    /// 16 intervals over the span.
    fn levels(&self) -> Result<LevelCurve, SetError> {
        Ok(LevelCurve {
            intervals_per_velocity: self.per_velocity(16, Parameter::LevelSpan)?,
            factors: self.factors(),
        })
    }

    /// A number over a velocity, per count and cycle; none where that is zero.
    fn per_velocity(&self, number: u64, velocity: Parameter) -> Result<I8F24, SetError> {
        if self.steps(velocity) == 0 {
            return Ok(I8F24::ZERO);
        }
        let bits = Self::held(
            velocity,
            &[number, velocity.unit().per_si, MICROS, Q24],
            &[self.steps(velocity), self.period_us, COUNTS_PER_M],
        )?;
        Ok(I8F24::from_bits(bits))
    }

    /// How levels lag within a time over some cycles with 24 fractional bits, ten at most: `x = t /
    /// τ`, come = 1 − exp(−x), ramp = 1 − come / x. Below 2²⁸ · 2²⁵ · 2³⁰ and 2³⁰ · 2³⁰ · 2²⁴.
    fn level_lag(&self, cycles: I8F24) -> LevelLag {
        let lag_ns = self.steps(Parameter::LevelLagTime).saturating_mul(1000);
        if lag_ns == 0 {
            return LevelLag::NONE;
        }
        let cycles = u64::from(cycles.to_bits().unsigned_abs());
        let period_ns = self.period_us.saturating_mul(1000);
        let time_ns = cycles.saturating_mul(period_ns).wrapping_shr(24);
        let come = Q30.saturating_sub(u64::from(decay(time_ns, lag_ns)));
        let of = |numerator: &[u64], denominator: &[u64]| {
            let bits = Fraction::new(numerator, denominator).and_then(Fraction::nearest);
            let bits = bits.and_then(|bits| i32::try_from(bits).ok());
            I8F24::from_bits(bits.unwrap_or_default())
        };
        let over_x = of(&[come, lag_ns, Q24], &[Q30, time_ns]);
        LevelLag {
            come: of(&[come, Q24], &[Q30]),
            ramp: I8F24::ONE.saturating_sub(over_x),
        }
    }

    /// What looks ahead by so many cycles, ten at most: nothing of it leaves 8.24 bits.
    fn ahead_by(&self, cycles: I8F24) -> Ahead {
        let square = I8F24::saturating_from_num(cycles.wide_mul(cycles));
        let sum = square.saturating_add(cycles);
        Ahead {
            cycles,
            way_by_acceleration: I8F24::from_bits(sum.to_bits().wrapping_shr(1)),
            velocity_by_acceleration: cycles.saturating_add(Ahead::HALF_A_CYCLE),
            lag: self.level_lag(cycles),
        }
    }

    /// 1 over the way of the lag, per count; none: zero.
    fn lag_per_way(&self) -> Result<I8F24, SetError> {
        let way = Parameter::LevelLagWay;
        if self.steps(way) == 0 {
            Ok(I8F24::ZERO)
        } else {
            self.per_way(way)
        }
    }

    /// Ways count 1 / (1 ± a) times, where they are so much longer: ten times at most.
    fn by_direction(&self) -> ByDirection {
        let asymmetry = Parameter::WayAsymmetry;
        let (whole, share) = (asymmetry.unit().per_si, self.steps(asymmetry));
        let counts = |longer: u64| {
            let bits = Fraction::new(&[whole, Q24], &[longer]).and_then(Fraction::nearest);
            let bits = bits.and_then(|bits| i32::try_from(bits).ok());
            bits.map_or(I8F24::ONE, I8F24::from_bits)
        };
        let (longer, shorter) = (
            counts(whole.saturating_add(share)),
            counts(whole.saturating_sub(share)),
        );
        let ways = if self.raw(asymmetry) < 0 {
            [shorter, longer]
        } else {
            [longer, shorter]
        };
        ByDirection {
            ways,
            level_micro_nm: self.raw(Parameter::LevelAsymmetry),
        }
    }

    /// Per 2²⁴ counts and its square; their rows keep them below 128. Below 2³¹ · 2⁷².
    fn level_place(&self) -> LevelPlace {
        let of = |place: Parameter, numerator: &[u64], denominator: &[u64]| {
            let bits = Fraction::new(numerator, denominator).and_then(Fraction::nearest);
            let bits = bits.and_then(|bits| i32::try_from(bits).ok());
            I8F24::from_bits(self.signed(place, bits.unwrap_or(i32::MAX)))
        };
        let (slope, bend) = (Parameter::LevelSlope, Parameter::LevelBend);
        LevelPlace {
            linear: of(
                slope,
                &[self.steps(slope), PLACE, Q24],
                &[slope.unit().per_si, COUNTS_PER_M],
            ),
            quadratic: of(
                bend,
                &[self.steps(bend), PLACE, PLACE, Q24],
                &[bend.unit().per_si, COUNTS_PER_M, COUNTS_PER_M],
            ),
        }
    }

    /// Share over twice the level, per µN·m with 40 fractional bits; none where there is no level.
    /// Where the level is so low that it does not fit, a turn tells less.
    fn level_tuning(&self) -> Result<LevelTuning, SetError> {
        let (share, settling) = (Parameter::LevelTuning, Parameter::LevelSettling);
        let levels = Parameter::FRICTION_LEVELS.iter();
        let level = levels.fold(0_u64, |sum, place| sum.saturating_add(self.steps(*place)));
        let per_micro_nm = if level == 0 {
            0
        } else {
            let numerator = [self.steps(share), Q40];
            let denominator = [share.unit().per_si, 2, level];
            let per = Fraction::new(&numerator, &denominator).and_then(Fraction::nearest);
            let per = per.and_then(|per| i32::try_from(per).ok());
            per.unwrap_or(i32::MAX)
        };
        if per_micro_nm == 0 && level > 0 && self.steps(share) > 0 {
            return Err(SetError::TooSmall(share));
        }
        Ok(LevelTuning {
            per_micro_nm,
            settling_cycles: self.whole_cycles(settling)?,
            settling_way: self.length(Parameter::LevelSettlingWay, 1)?,
        })
    }

    /// A time in whole cycles, to nearest.
    fn whole_cycles(&self, time: Parameter) -> Result<u16, SetError> {
        let cycles =
            Fraction::new(&[self.steps(time)], &[self.period_us]).and_then(Fraction::nearest);
        let cycles = cycles.and_then(|cycles| u16::try_from(cycles).ok());
        cycles.ok_or(SetError::TooLarge(time))
    }

    /// Millionths as binary fractions; their rows keep them below 8.
    fn factors(&self) -> [I8F24; LEVELS] {
        Parameter::LEVEL_FACTORS.map(|place| {
            let bits =
                Fraction::new(&[self.steps(place), Q24], &[MICROS]).and_then(Fraction::nearest);
            let bits = bits.and_then(|bits| i32::try_from(bits).ok());
            I8F24::from_bits(bits.unwrap_or(i32::MAX))
        })
    }

    /// Torque per velocity, per count and cycle: over T.
    fn viscous(&self, parameter: Parameter) -> Result<VelocityGain, SetError> {
        let bits = Self::held(
            parameter,
            &[self.steps(parameter), Q12, MICROS],
            &[parameter.unit().per_si, TORQUE_PER_COUNT, self.period_us],
        )?;
        Ok(VelocityGain(I20F12::from_bits(
            self.signed(parameter, bits),
        )))
    }

    fn ripple(&self) -> Result<RippleConfig, SetError> {
        let ahead = self.cycles(Parameter::FrictionAhead)?;
        Ok(RippleConfig {
            waves: Parameter::RIPPLES.map(|[torque, period, phase]| Wave {
                amplitude_micro_nm: self.raw(torque),
                per_position: self.turns_per_position(period),
                phase: self.angle(phase),
            }),
            ahead: self.ahead_by(ahead.saturating_add(Ahead::HALF_A_CYCLE)),
        })
    }

    /// Turns per 2⁻⁸ of 10 nm, 2⁻⁵⁶: 2⁴⁸ over the period in counts, whose row keeps it above 100.
    fn turns_per_position(&self, period: Parameter) -> i64 {
        let numerator = [period.unit().per_si, Q48];
        let denominator = [self.steps(period), COUNTS_PER_M];
        let turns = Fraction::new(&numerator, &denominator).and_then(Fraction::nearest);
        turns
            .and_then(|turns| i64::try_from(turns).ok())
            .unwrap_or(i64::MAX)
    }

    /// An angle in 2⁻³² turns; whole turns fall out.
    fn angle(&self, phase: Parameter) -> i32 {
        let turns = Fraction::new(&[self.steps(phase), Q32], &[phase.unit().per_si]);
        let turns = turns.and_then(Fraction::nearest).unwrap_or(0);
        let [a, b, c, d, ..] = turns.to_le_bytes();
        self.signed(phase, i32::from_le_bytes([a, b, c, d]))
    }

    /// Counts per µN·m. Below 2³¹ · 10⁸ · 2²⁸.
    fn screw(&self) -> Result<Screw, SetError> {
        let windup = Parameter::Windup;
        let compliance = Self::held(
            windup,
            &[self.steps(windup), COUNTS_PER_M, Q28],
            &[windup.unit().per_si, MICROS],
        )?;
        Ok(Screw {
            compliance: I4F28::from_bits(compliance),
            gap: self.gap()?,
            table_inertia: AccelerationGain(I24F8::from_bits(
                self.inertia_gain(Parameter::TableInertia, (1, 1))?,
            )),
            table_micro_nm: self.raw(Parameter::TableTorque),
            acceleration_limit: self.limit(Parameter::AccelerationLimit, 2)?,
        })
    }

    /// Counts of 10 nm, and counts per µN·m. Below 2²⁴ · 10⁸ · 2²⁸.
    fn gap(&self) -> Result<Gap, SetError> {
        let (width, torque) = (Parameter::GapWidth, Parameter::GapTorque);
        let per_torque = Self::held(
            width,
            &[self.steps(width), COUNTS_PER_M, Q28],
            &[width.unit().per_si, 2, self.steps(torque)],
        )?;
        Ok(Gap {
            half: I20F12::saturating_from_num(self.length(width, 2)?.0),
            per_half: self.per_half_gap(),
            per_torque: I4F28::from_bits(per_torque),
            per_velocity: self.per_velocity(1, Parameter::GapVelocity)?,
        })
    }

    /// As much as there is room for where the gap is less than 0.2 nm.
    fn per_half_gap(&self) -> I8F24 {
        let width = Parameter::GapWidth;
        let numerator = [width.unit().per_si, 2, Q24];
        let bits = Fraction::new(&numerator, &[self.steps(width), COUNTS_PER_M]);
        let bits = bits.and_then(Fraction::nearest);
        let bits = bits.and_then(|bits| i32::try_from(bits).ok());
        bits.map_or(I8F24::MAX, I8F24::from_bits)
    }

    fn filter(&self) -> Result<FilterConfig, SetError> {
        let coefficients = Parameter::TORQUE_FILTER.map(|place| self.raw(place));
        let filter = FilterConfig::new(coefficients).map_err(|error| match error {
            FilterError::TooLarge { .. } => SetError::FilterHeadroom(Parameter::FilterB0),
            FilterError::Unstable { .. } => SetError::FilterUnstable(Parameter::FilterA1),
        })?;
        let made_for_this = self.raw(Parameter::FilterPeriod) == self.raw(Parameter::CyclePeriod);
        if filter != FilterConfig::OFF && !made_for_this {
            return Err(SetError::FilterPeriod(Parameter::FilterPeriod));
        }
        Ok(filter)
    }

    /// Feed over increments, 10 nm with 32 fractional bits. Below 2³¹ · 2¹⁶ · 2²⁷ · 2³², that is
    /// 2¹⁰⁶.
    fn way(&self) -> Result<WayPerIncrement, SetError> {
        let (feed, increments) = (Parameter::Feed, Parameter::EncoderIncrements);
        let numerator = [
            self.steps(feed),
            self.steps(Parameter::EncoderRevolutions),
            COUNTS_PER_M,
            Q32,
        ];
        let denominator = [
            self.steps(Parameter::FeedRevolutions),
            self.steps(increments),
            feed.unit().per_si,
        ];
        let way = Fraction::new(&numerator, &denominator).and_then(Fraction::nearest);
        let way = way.ok_or(SetError::TooLarge(feed))?;
        if way == 0 {
            return Err(SetError::TooSmall(feed));
        }
        let whole = u16::try_from(way.wrapping_shr(32)).map_err(|_| SetError::TooLarge(feed))?;
        Ok(WayPerIncrement {
            whole,
            fraction: u32::try_from(way & u64::from(u32::MAX)).unwrap_or(u32::MAX),
        })
    }
}

// The reference stage.
impl Reading<'_> {
    fn reference(&self) -> Result<ReferenceConfig, SetError> {
        let (low, high) = (
            self.raw(Parameter::PositionMin),
            self.raw(Parameter::PositionMax),
        );
        if low >= high {
            return Err(SetError::PositionLimitsCrossed(Parameter::PositionMin));
        }
        let position_min = if low == i32::MIN {
            Position(I56F8::MIN)
        } else {
            Position::from_counts(i64::from(low))
        };
        let position_max = if high == i32::MAX {
            Position(I56F8::MAX)
        } else {
            Position::from_counts(i64::from(high))
        };
        let (velocity_limit, acceleration_limit) = (
            self.limit(Parameter::VelocityLimit, 1)?,
            self.limit(Parameter::AccelerationLimit, 2)?,
        );
        Ok(ReferenceConfig {
            velocity_limit,
            acceleration_limit,
            step: self.limit(Parameter::StepJerk, 3)?,
            position_min,
            position_max,
            middle: braking_counts(velocity_limit, acceleration_limit)
                .map_or(ReferenceConfig::NOWHERE, |way| {
                    ReferenceConfig::middle_of([position_min, position_max], way)
                }),
            quick_stop: self.ramp(Parameter::QuickStopDeceleration)?,
            slow_down: self.ramp(Parameter::SlowDownDeceleration)?,
            filter_log2: self.small(Parameter::SetpointFilter),
            setpoint_cycles: self.setpoint_cycles()?,
        })
    }

    fn ramp(&self, deceleration: Parameter) -> Result<Ramp, SetError> {
        Ok(Ramp {
            deceleration: self.limit(deceleration, 2)?,
            jerk: self.limit(Parameter::RampJerk, 3)?,
        })
    }

    /// Object 60C2h, value · 10^exponent s, in cycles.
    fn setpoint_cycles(&self) -> Result<u8, SetError> {
        let parameter = Parameter::SetpointPeriod;
        if self.raw(parameter) == 0 {
            return Ok(1);
        }
        let to_micros = self
            .raw(Parameter::SetpointPeriodExponent)
            .saturating_add(6)
            .unsigned_abs();
        let period_us = self
            .steps(parameter)
            .saturating_mul(10_u64.saturating_pow(to_micros));
        let cycles = Fraction::new(&[period_us], &[self.period_us]).and_then(Fraction::exact);
        let cycles = cycles
            .filter(|cycles| (1..=20).contains(cycles))
            .and_then(|cycles| u8::try_from(cycles).ok());
        cycles.ok_or(SetError::SetpointPeriod(parameter))
    }
}

// Everything around the loop.
impl Reading<'_> {
    /// An axis that may have torque has limits, its ramps keep them, and nothing is beyond the
    /// torque limit.
    fn check_limits(&self) -> Result<(), SetError> {
        let limit = self.steps(Parameter::TorqueLimit);
        let moves = limit > 0 || self.steps(Parameter::BacklashGap) > 0;
        for parameter in [Parameter::VelocityLimit, Parameter::AccelerationLimit] {
            if moves && self.steps(parameter) == 0 {
                return Err(SetError::WithoutLimit(parameter));
            }
        }
        for parameter in [
            Parameter::QuickStopDeceleration,
            Parameter::SlowDownDeceleration,
        ] {
            if moves && self.steps(parameter) > self.steps(Parameter::AccelerationLimit) {
                return Err(SetError::BeyondAcceleration(parameter));
            }
        }
        for parameter in [Parameter::CoulombTorque, Parameter::PresetTorque] {
            if self.steps(parameter) > limit {
                return Err(SetError::BeyondTorqueLimit(parameter));
            }
        }
        Ok(())
    }

    fn limits(&self) -> Result<Limits, SetError> {
        let beat_us = self
            .period_us
            .saturating_mul(u64::from(HEARTBEAT_EVERY_CYCLES));
        Ok(Limits {
            setpoint_misses: self.count(Parameter::SetpointMissesAllowed),
            feedback_misses: self.count(Parameter::FeedbackMissesAllowed),
            refusals: self.count(Parameter::RefusalsAllowed),
            following_error: self.window(Parameter::FollowingErrorWindow),
            encoder_jump: self.window(Parameter::EncoderJumpLimit),
            enable_window: self.window(Parameter::EnableWindow),
            heartbeat_us: self.timeout(
                Parameter::HeartbeatTimeout,
                1000,
                beat_us,
                HEARTBEAT_TIMEOUT_PERIODS,
            )?,
            sync_timeout_us: self.timeout(
                Parameter::SyncTimeout,
                1,
                self.period_us,
                SYNC_TIMEOUT_PERIODS,
            )?,
            stage_cycles: self.count(Parameter::StageCycles),
        })
    }

    /// A timeout in µs: at least twice what it watches; where the set leaves it open, so many
    /// periods.
    fn timeout(
        &self,
        parameter: Parameter,
        step_us: u64,
        watched_us: u64,
        periods: u64,
    ) -> Result<u64, SetError> {
        match self.steps(parameter).saturating_mul(step_us) {
            0 => Ok(self.period_us.saturating_mul(periods)),
            short if short < watched_us.saturating_mul(2) => {
                Err(SetError::TimeoutTooShort(parameter))
            }
            timeout => Ok(timeout),
        }
    }

    fn options(&self) -> Options {
        Options {
            quick_stop: self.stop_option(Parameter::QuickStopOption),
            shutdown: self.stop_option(Parameter::ShutdownOption),
            disable_operation: self.stop_option(Parameter::DisableOperationOption),
            halt: match self.raw(Parameter::HaltOption) {
                2 => StopOption::QuickStopAndStay,
                _ => StopOption::SlowDownAndStay,
            },
            fault_reaction: self.stop_option(Parameter::FaultReactionOption),
            abort_connection: match self.raw(Parameter::AbortConnectionOption) {
                2 => AbortConnectionOption::DisableVoltage,
                3 => AbortConnectionOption::QuickStop,
                _ => AbortConnectionOption::Fault,
            },
        }
    }

    /// The option codes of CiA 402-2 mean the same in all objects but that of halt.
    fn stop_option(&self, parameter: Parameter) -> StopOption {
        match self.raw(parameter) {
            0 => StopOption::DisableAtOnce,
            1 => StopOption::SlowDown,
            5 => StopOption::SlowDownAndStay,
            6 => StopOption::QuickStopAndStay,
            _ => StopOption::QuickStop,
        }
    }

    fn brake(&self) -> Result<Brake, SetError> {
        Ok(Brake {
            open_cycles: self.cycles_up(Parameter::BrakeOpening)?,
            close_cycles: self.cycles_up(Parameter::BrakeClosing)?,
        })
    }

    fn preset(&self) -> Preset {
        Preset {
            torque: self.torque(Parameter::PresetTorque),
            from_last: self.raw(Parameter::PresetFromLast) != 0,
        }
    }

    fn relation(&self) -> Relation {
        Relation {
            offset: self.raw(Parameter::RelationOffset),
            window: self.window(Parameter::RelationWindow),
        }
    }
}

/// The way of a braking from a velocity in whole counts, `v² / 2 a`; `None` beyond 21 m.
fn braking_counts(velocity: Velocity, acceleration: Velocity) -> Option<i32> {
    // As the reference stage has them, to 2⁻⁸ of a count, which a velocity may be above its limit.
    let [v, a] = [velocity, acceleration]
        .map(|limit| u64::from(limit.0.to_bits().unsigned_abs().wrapping_shr(4)));
    let v = v.saturating_add(1);
    let way = Fraction::new(&[v, v], &[a, 2, Q8]).and_then(Fraction::nearest)?;
    i32::try_from(way).ok()
}

#[cfg(test)]
#[allow(clippy::float_arithmetic, reason = "the reference is a float")]
mod tests {
    use super::*;
    use crate::objects::TABLE;
    use proptest::prelude::*;
    use std::f64::consts::TAU;

    fn with(changes: &[(Parameter, i32)]) -> ParameterSet {
        let mut set = ParameterSet::default();
        for (parameter, value) in changes {
            let entry = TABLE
                .iter()
                .find(|entry| entry.parameter == *parameter)
                .unwrap();
            assert_eq!(entry.check(*value), Ok(()), "{}", entry.name());
            set.set(*parameter, *value);
        }
        set
    }

    /// An axis: moved mass, lead, periods; with a position gain that needs no more than one over
    /// ten cycles.
    fn axis(mass_kg: f64, lead_m: f64, period_us: i32, bandwidth_hz: f64) -> ParameterSet {
        let inertia = mass_kg * lead_m / TAU * 1.0e7;
        with(&[
            (Parameter::CyclePeriod, period_us),
            (Parameter::PositionGain, 1_000_000_000 / period_us.max(1000)),
            (Parameter::Inertia, inertia.round() as i32),
            (
                Parameter::VelocityBandwidth,
                (bandwidth_hz * 1.0e4).round() as i32,
            ),
            (
                Parameter::IntegralCorner,
                (bandwidth_hz / 4.0 * 1.0e4).round() as i32,
            ),
            (Parameter::VelocityFilterTime, 1_091_356),
            (Parameter::TorqueLimit, 3_000_000),
            (Parameter::Feed, (lead_m * 1.0e9).round() as i32),
            (Parameter::EncoderIncrements, 1 << 20),
            (Parameter::VelocityLimit, 100_000),
            (Parameter::AccelerationLimit, 5_000_000),
        ])
    }

    /// Machine numbers in units of their last bit, as real numbers.
    fn exact(set: &ParameterSet) -> Vec<(Parameter, f64)> {
        let si =
            |parameter: Parameter| f64::from(set.get(parameter)) / parameter.unit().per_si as f64;
        let t = si(Parameter::CyclePeriod);
        let motion = |parameter, order| (parameter, si(parameter) * t.powi(order) * 1.0e8 * 4096.0);
        let (f, fi, i) = (
            si(Parameter::VelocityBandwidth),
            si(Parameter::IntegralCorner),
            si(Parameter::Inertia),
        );
        let way = si(Parameter::Feed) / si(Parameter::FeedRevolutions)
            * si(Parameter::EncoderRevolutions);
        vec![
            (
                Parameter::PositionGain,
                si(Parameter::PositionGain) * t * 2.0_f64.powi(24),
            ),
            (
                Parameter::VelocityBandwidth,
                TAU * f * i * 0.01 / t * 4096.0,
            ),
            (
                Parameter::IntegralCorner,
                TAU * f * i * 0.01 * TAU * fi * 4096.0,
            ),
            (
                Parameter::Inertia,
                i * si(Parameter::AccelerationShare) * 0.01 / t / t * 256.0,
            ),
            (
                Parameter::BacklashGap,
                si(Parameter::BacklashGap) / 2.0 * 1.0e8 * 256.0,
            ),
            motion(Parameter::PulseHeight, 1),
            motion(Parameter::VelocityLimit, 1),
            motion(Parameter::AccelerationLimit, 2),
            motion(Parameter::QuickStopDeceleration, 2),
            motion(Parameter::SlowDownDeceleration, 2),
            motion(Parameter::RampJerk, 3),
            motion(Parameter::StepJerk, 3),
            (
                Parameter::Feed,
                way / si(Parameter::EncoderIncrements) * 1.0e8 * 2.0_f64.powi(32),
            ),
            (
                Parameter::PulseStartDelay,
                si(Parameter::PulseStartDelay) / t,
            ),
            (
                Parameter::PulseShortestWay,
                si(Parameter::PulseShortestWay) * 1.0e8 * 256.0,
            ),
        ]
    }

    /// Parts that are off included, which settings are without.
    fn compensation(set: &ParameterSet) -> Compensation {
        Reading::of(set).compensation().unwrap()
    }

    fn held(set: &ParameterSet, settings: &Settings) -> Vec<i64> {
        let (cascade, reference) = (settings.config.cascade, settings.config.reference);
        let compensation = compensation(set);
        vec![
            i64::from(cascade.position_gain.0.to_bits()),
            i64::from(cascade.velocity_gain.0.to_bits()),
            i64::from(cascade.integral_gain.0.to_bits()),
            i64::from(cascade.acceleration_gain.0.to_bits()),
            i64::from(compensation.backlash.half_gap.0.to_bits()),
            i64::from(compensation.pulse.shape.amplitude.0.to_bits()),
            i64::from(reference.velocity_limit.0.to_bits()),
            i64::from(reference.acceleration_limit.0.to_bits()),
            i64::from(reference.quick_stop.deceleration.0.to_bits()),
            i64::from(reference.slow_down.deceleration.0.to_bits()),
            i64::from(reference.quick_stop.jerk.0.to_bits()),
            i64::from(reference.step.0.to_bits()),
            (i64::from(settings.way.whole) << 32) + i64::from(settings.way.fraction),
            i64::from(compensation.pulse.shape.start_delay_cycles),
            i64::from(compensation.pulse.shortest_way.0.to_bits()),
        ]
    }

    #[test]
    fn the_middle_of_the_travel_is_a_braking_way_from_its_ends() {
        let set = with(&[
            (Parameter::VelocityLimit, 500_000),
            (Parameter::AccelerationLimit, 5_000_000),
            (Parameter::PositionMin, -20_000_000),
            (Parameter::PositionMax, 30_000_000),
        ]);
        let middle = set.settings().unwrap().config.reference.middle;
        // (50 000 + 1/256)² / (2 · 500) counts to nearest, 25 mm, and two for rounding.
        let wanted = [-20_000_000 + 2_500_002, 30_000_000 - 2_500_002].map(Position::from_counts);
        assert_eq!(middle, wanted);
    }

    /// `exp(−T/τ)` as the settings hold it, and as a real number.
    fn exponentials(set: &ParameterSet, settings: &Settings) -> [(f64, f64); 2] {
        let of = |parameter: Parameter| match set.get(parameter) {
            0 => 0.0,
            time => (-f64::from(set.get(Parameter::CyclePeriod)) * 1.0e3 / f64::from(time)).exp(),
        };
        let share: f64 = settings.config.cascade.velocity_filter.to_num();
        [
            (1.0 - share, of(Parameter::VelocityFilterTime)),
            (
                compensation(set).pulse.shape.decay.to_num(),
                of(Parameter::PulseTime),
            ),
        ]
    }

    /// Half a unit of the machine number, and 1.1·10⁻⁸ of it for (2π)² as a fraction.
    fn is_close(held: i64, exact: f64) -> bool {
        (held as f64 - exact).abs() <= 0.5 + 1.1e-8 * exact.abs()
    }

    fn check(set: &ParameterSet) -> Result<(), TestCaseError> {
        match set.settings() {
            Ok(settings) => {
                for ((parameter, exact), held) in exact(set).into_iter().zip(held(set, &settings)) {
                    prop_assert!(
                        is_close(held, exact),
                        "{:?}: {} for {}",
                        parameter,
                        held,
                        exact
                    );
                    prop_assert_eq!(
                        held == 0,
                        exact == 0.0 || parameter == Parameter::PulseStartDelay && held == 0
                    );
                }
                for (held, exact) in exponentials(set, &settings) {
                    prop_assert!(
                        (held - exact).abs() <= 2.0_f64.powi(-30),
                        "{} for {}",
                        held,
                        exact
                    );
                }
            }
            Err(SetError::TooLarge(parameter)) => {
                let largest = match parameter {
                    Parameter::PositionGain => 2.0_f64.powi(24),
                    Parameter::Feed => 2.0_f64.powi(48),
                    Parameter::BrakeOpening | Parameter::BrakeClosing => return Ok(()),
                    _ => 2.0_f64.powi(31),
                };
                let guilty = exact(set)
                    .into_iter()
                    .any(|(of, exact)| of == parameter && exact.abs() >= largest - 0.6);
                prop_assert!(guilty, "{:?} is not too large", parameter);
            }
            Err(SetError::TooSmall(parameter)) => {
                let guilty = exact(set)
                    .into_iter()
                    .any(|(of, exact)| of == parameter && exact.abs() <= 15.51);
                prop_assert!(guilty, "{:?} is not too small", parameter);
            }
            Err(_) => {}
        }
        Ok(())
    }

    /// Values of a row, small and large ones equally likely.
    fn value(parameter: Parameter) -> impl Strategy<Value = i32> {
        let entry = TABLE
            .iter()
            .find(|entry| entry.parameter == parameter)
            .unwrap();
        let (min, max) = (entry.min, entry.max);
        (any::<i32>(), 0..31_u32).prop_map(move |(value, shift)| (value >> shift).clamp(min, max))
    }

    #[test]
    fn elements_slip_after_their_ways_at_their_levels_and_one_that_is_too_stiff_is_refused() {
        let element = |level: i32, way: i32| {
            with(&[
                (Parameter::FrictionLevel1, level),
                (Parameter::FrictionWay1, way),
            ])
            .settings()
        };
        // 0.1 mN·m to 268 N·m, 10 nm to 1 mm, in tenths of a nanometre.
        for (level, way) in [(100, 10_000_000), (100_000, 100), (250_000_000, 10_000_000)] {
            let friction = element(level, way)
                .unwrap()
                .config
                .friction()
                .copied()
                .unwrap();
            let [counts, stiffness] = [
                friction.elements.ways[0].to_num::<f64>(),
                f64::from(friction.elements.stiffnesses[0]) * 2.0_f64.powi(12 - 24),
            ];
            assert!(
                (counts / (0.01 * f64::from(way)) - 1.0).abs() < 1.0e-4,
                "{counts}"
            );
            // To half a step of the stiffness.
            let most = counts * 2.0_f64.powi(-13) + 1.0e-4 * f64::from(level);
            let reached = stiffness * counts;
            assert!(
                (reached - f64::from(level)).abs() < most,
                "{reached} of {level}"
            );
        }
        let stiff = element(250_000_000, 100).unwrap_err();
        assert_eq!(stiff, SetError::TooLarge(Parameter::FrictionLevel1));
    }

    #[test]
    fn a_gap_has_half_its_width_and_a_velocity_from_which_on_its_band_is_wide() {
        let gap = |width: i32, velocity: i32, period_us: i32| {
            let set = with(&[
                (Parameter::CyclePeriod, period_us),
                (Parameter::FrictionLevel1, 100_000),
                (Parameter::GapWidth, width),
                (Parameter::GapTorque, 50_000),
                (Parameter::GapVelocity, velocity),
            ]);
            set.settings()
                .unwrap()
                .config
                .friction()
                .copied()
                .unwrap()
                .screw
                .gap
        };
        // 6 µm in tenths of a nanometre, 1.5 mm/s in µm/s: 150 counts per ms.
        for (period_us, counts) in [(1000, 150.0), (250, 37.5)] {
            let own = gap(60_000, 1500, period_us);
            assert_eq!(own.half.to_num::<f64>(), 300.0);
            let [per_half, per_torque, per_velocity]: [f64; 3] = [
                own.per_half.to_num(),
                own.per_torque.to_num(),
                own.per_velocity.to_num(),
            ];
            assert!((per_half * 300.0 - 1.0).abs() < 1.0e-5, "{per_half}");
            assert!((per_torque * 50_000.0 / 300.0 - 1.0).abs() < 1.0e-5);
            assert!(
                (per_velocity * counts - 1.0).abs() < 1.0e-5,
                "{per_velocity}"
            );
        }
        // None at any velocity, and a gap that is less than one over it can hold.
        assert_eq!(gap(60_000, 0, 1000).per_velocity, I8F24::ZERO);
        assert_eq!(gap(1, 0, 1000).per_half, I8F24::MAX);
        assert_eq!(gap(0, 0, 1000).half, I20F12::ZERO);
    }

    #[test]
    fn a_lag_of_the_levels_comes_exactly_over_a_cycle_and_over_what_looks_ahead() {
        for (period_us, lag_us) in [
            (1000, 2_000),
            (1000, 100),
            (250, 60_000),
            (20_000, 1_000_000),
        ] {
            let set = with(&[
                (Parameter::CyclePeriod, period_us),
                (Parameter::LevelLagTime, lag_us),
                (Parameter::FrictionAhead, period_us / 2),
                (Parameter::ViscousTorque, 1_000_000),
            ]);
            let friction = set.settings().unwrap().config.friction().copied().unwrap();
            for (lag, cycles) in [
                (friction.lag, 1.0),
                (friction.torque.lag, 1.0),
                (friction.lag_after, 2.0),
            ] {
                let x = cycles * f64::from(period_us) / f64::from(lag_us);
                let come = 1.0 - (-x).exp();
                let off = |held: I8F24, exact: f64| (held.to_num::<f64>() - exact).abs();
                assert!(
                    off(lag.come, come) < 1.0e-7,
                    "{period_us} {lag_us} {cycles}"
                );
                let ramp = 1.0 - come / x;
                assert!(
                    off(lag.ramp, ramp) < 1.0e-6,
                    "{period_us} {lag_us} {cycles}"
                );
            }
        }
        let without = with(&[(Parameter::ViscousTorque, 1_000_000)]);
        let friction = without
            .settings()
            .unwrap()
            .config
            .friction()
            .copied()
            .unwrap();
        assert_eq!(friction.lag, LevelLag::NONE);
    }

    const CONVERTED: [Parameter; 23] = [
        Parameter::PositionGain,
        Parameter::Inertia,
        Parameter::VelocityBandwidth,
        Parameter::IntegralCorner,
        Parameter::AccelerationShare,
        Parameter::VelocityFilterTime,
        Parameter::TorqueLimit,
        Parameter::Feed,
        Parameter::FeedRevolutions,
        Parameter::EncoderIncrements,
        Parameter::EncoderRevolutions,
        Parameter::PulseHeight,
        Parameter::PulseTime,
        Parameter::PulseStartDelay,
        Parameter::PulseShortestWay,
        Parameter::BacklashGap,
        Parameter::VelocityLimit,
        Parameter::AccelerationLimit,
        Parameter::SlowDownDeceleration,
        Parameter::QuickStopDeceleration,
        Parameter::RampJerk,
        Parameter::StepJerk,
        Parameter::BrakeClosing,
    ];

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(5000))]

        /// A set of arbitrary values is mostly refused, for a reason that holds.
        #[test]
        fn any_set_gives_what_a_float_would_give_or_names_a_value_that_does_not_fit(
            period_us in 100..20_000_i32, values in CONVERTED.map(value), places in any::<u32>(),
        ) {
            let mut set = axis(931.65, 0.010, period_us, 5.0);
            for (place, (parameter, value)) in CONVERTED.into_iter().zip(values).enumerate() {
                // One value in four is changed, so that many sets are still whole.
                let shift = u32::try_from(place).unwrap();
                if places.rotate_right(shift).trailing_zeros() >= 2 {
                    set.set(parameter, value);
                }
            }
            check(&set)?;
        }

        /// Axes as they are built are taken.
        #[test]
        fn any_axis_from_ten_kilograms_to_eight_tonnes_fits_at_any_period(
            mass_kg in 10.0..8000.0_f64, lead_mm in 2.0..20.0_f64, period_us in 250..20_000_i32, share in 0.02..0.1_f64,
        ) {
            let bandwidth_hz = (share / (f64::from(period_us) * 1.0e-6)).min(80.0);
            let set = axis(mass_kg, lead_mm * 1.0e-3, period_us, bandwidth_hz);
            prop_assert!(set.settings().is_ok(), "{:?}", set.settings());
            check(&set)?;
        }
    }

    #[test]
    fn the_steps_resolve_the_smallest_axis_to_a_ten_thousandth() {
        // 10 kg with a lead of 2 mm, and its slowest gains.
        let inertia = 10.0 * 0.002 / TAU * Parameter::Inertia.unit().per_si as f64;
        let kv_per_s = 1.0 * Parameter::PositionGain.unit().per_si as f64;
        let bandwidth_hz = 1.0 * Parameter::VelocityBandwidth.unit().per_si as f64;
        for steps in [inertia, kv_per_s, bandwidth_hz] {
            assert!(0.5 / steps < 1.0e-4, "{steps} steps");
        }
        let heaviest = 8000.0 * 0.020 / TAU * Parameter::Inertia.unit().per_si as f64;
        assert!(heaviest < f64::from(i32::MAX), "{heaviest} steps");
    }

    #[test]
    fn the_defaults_move_nothing_at_any_period() {
        for period_us in [100, 125, 450, 333, 1000, 2000, 20_000] {
            let settings = with(&[(Parameter::CyclePeriod, period_us)])
                .settings()
                .unwrap();
            let cascade = settings.config.cascade;
            assert_eq!(
                (cascade.torque_limit, cascade.position_gain),
                (TorqueLimit::default(), PositionGain::default())
            );
            assert_eq!(
                settings.limits.sync_timeout_us,
                5 * u64::from(settings.period_us)
            );
            assert_eq!(
                settings.limits.heartbeat_us,
                450 * u64::from(settings.period_us)
            );
            assert_eq!(settings.config.reference.setpoint_cycles, 1);
            assert_eq!(
                (
                    settings.config.reference.position_min.0,
                    settings.config.reference.position_max.0
                ),
                (I56F8::MIN, I56F8::MAX)
            );
        }
    }

    #[test]
    fn a_lead_of_ten_millimetres_is_exact() {
        let set = with(&[
            (Parameter::Feed, 10_000_000),
            (Parameter::EncoderIncrements, 1 << 20),
        ]);
        let way = set.settings().unwrap().way;
        let counts: i64 = way.times(1 << 20).0.to_num();
        assert_eq!(
            (counts, way.times(1 << 20).0.frac()),
            (1_000_000, I56F8::ZERO)
        );
    }

    #[test]
    fn the_setpoint_period_is_a_whole_number_of_cycles() {
        let of = |period_us, value, exponent| {
            let set = with(&[
                (Parameter::CyclePeriod, period_us),
                (Parameter::SetpointPeriod, value),
                (Parameter::SetpointPeriodExponent, exponent),
            ]);
            set.settings()
                .map(|settings| settings.config.reference.setpoint_cycles)
        };
        let refused = Err(SetError::SetpointPeriod(Parameter::SetpointPeriod));
        assert_eq!(
            (
                of(1000, 1, -3),
                of(250, 5, -3),
                of(250, 250, -6),
                of(20_000, 4, -1)
            ),
            (Ok(1), Ok(20), Ok(1), Ok(20))
        );
        assert_eq!(
            (
                of(2000, 1, -3),
                of(2000, 5, -3),
                of(1000, 21, -3),
                of(1000, 255, 0)
            ),
            (refused, refused, refused, refused)
        );
    }

    #[test]
    fn a_brake_is_given_at_least_its_time() {
        let set = with(&[
            (Parameter::BrakeOpening, 30_001),
            (Parameter::BrakeClosing, 40_000),
        ]);
        assert_eq!(
            set.settings().unwrap().brake,
            Brake {
                open_cycles: 31,
                close_cycles: 40
            }
        );
    }

    #[test]
    fn values_that_do_not_go_together_are_refused_with_their_parameter() {
        let limits = [
            (Parameter::VelocityLimit, 500_000),
            (Parameter::AccelerationLimit, 5_000_000),
        ];
        let rows: [(&[(Parameter, i32)], SetError); 14] = [
            (
                &[(Parameter::VelocityBandwidth, 300_000)],
                SetError::WithoutInertia(Parameter::Inertia),
            ),
            (
                &[(Parameter::TorqueLimit, 1), limits[1]],
                SetError::WithoutLimit(Parameter::VelocityLimit),
            ),
            (
                &[(Parameter::BacklashGap, 1000), limits[0]],
                SetError::WithoutLimit(Parameter::AccelerationLimit),
            ),
            (
                &[
                    (Parameter::TorqueLimit, 1),
                    limits[0],
                    limits[1],
                    (Parameter::SlowDownDeceleration, 5_000_001),
                ],
                SetError::BeyondAcceleration(Parameter::SlowDownDeceleration),
            ),
            // 37 m/s³ at 10 kHz are less than the reference stage can count.
            (
                &[(Parameter::CyclePeriod, 100), (Parameter::RampJerk, 37_000)],
                SetError::TooSmall(Parameter::RampJerk),
            ),
            (
                &[(Parameter::PresetTorque, -1)],
                SetError::BeyondTorqueLimit(Parameter::PresetTorque),
            ),
            (
                &[(Parameter::CoulombTorque, 1)],
                SetError::BeyondTorqueLimit(Parameter::CoulombTorque),
            ),
            (
                &[(Parameter::PositionMin, i32::MAX)],
                SetError::PositionLimitsCrossed(Parameter::PositionMin),
            ),
            (
                &[
                    (Parameter::FilterB0, i32::MAX),
                    (Parameter::FilterB1, i32::MAX),
                ],
                SetError::FilterHeadroom(Parameter::FilterB0),
            ),
            (
                &[
                    (Parameter::FilterB0, 1 << 28),
                    (Parameter::FilterPeriod, 999),
                ],
                SetError::FilterPeriod(Parameter::FilterPeriod),
            ),
            // A pole at 1.2: y = 1.2 y1.
            (
                &[(Parameter::FilterA1, 644_245_094)],
                SetError::FilterUnstable(Parameter::FilterA1),
            ),
            (
                &[(Parameter::SyncTimeout, 1999)],
                SetError::TimeoutTooShort(Parameter::SyncTimeout),
            ),
            (
                &[(Parameter::HeartbeatTimeout, 199)],
                SetError::TimeoutTooShort(Parameter::HeartbeatTimeout),
            ),
            (
                &[
                    (Parameter::BrakeOpening, 2_000_000),
                    (Parameter::PositionGain, 10_000_000),
                    (Parameter::CyclePeriod, 2000),
                ],
                SetError::TooLarge(Parameter::PositionGain),
            ),
        ];
        for (changes, error) in rows {
            assert_eq!(with(changes).settings().err(), Some(error));
        }
    }
}
