//! A floating-point twin beside the fixed-point law, and golden vectors for later runs on ARM.
//!
//! The twin is written from the equations of the module docs in `f64`. On the reference gains and any plausible motion the two differ by less than
//! [`BOUND_MICRO_NM`] after 3000 cycles: rounding of position to 39 pm and of velocity to 2.4 pm per cycle is all there is. The twin has the gains as the
//! fixed-point numbers hold them; how well they hold the SI ones is tested where they are made.

use controller::backlash::BacklashConfig;
use controller::cascade::CascadeConfig;
use controller::filter::FilterConfig;
use controller::pulse::PulseConfig;
use controller::units::{AccelerationGain, Position, PositionGain, Torque, Velocity, VelocityGain};
use controller::{Config, Input, PositionSource, State};
use fixed::types::{I2F30, I8F24, I20F12, I24F8, I56F8};
use proptest::prelude::*;

/// Largest difference of the torques, µN·m: 0.0035 ‰ of the reference axis' 14.3 N·m.
const BOUND_MICRO_NM: f64 = 50.0;

const POSITION_GAIN: f64 = 0.040;
const VELOCITY_GAIN: f64 = 2794.0;
const INTEGRAL_GAIN: f64 = 131.6;
const ACCELERATION_GAIN: f64 = 14_827.0;
const FILTER_SHARE: f64 = 0.6;
const LIMIT: f64 = 14_323_944.0;
const PULSE_HEIGHT: f64 = 178.0;
const PULSE_DECAY: f64 = 0.988_5;
const COULOMB: f64 = 636_620.0;

fn config(source: PositionSource) -> Config {
    Config {
        position_source: source,
        cascade: CascadeConfig {
            position_gain: PositionGain(I8F24::from_num(POSITION_GAIN)),
            velocity_gain: VelocityGain(I20F12::from_num(VELOCITY_GAIN)),
            integral_gain: VelocityGain(I20F12::from_num(INTEGRAL_GAIN)),
            acceleration_gain: AccelerationGain(I24F8::from_num(ACCELERATION_GAIN)),
            velocity_filter: I2F30::from_num(FILTER_SHARE),
            torque_limit: Torque::from_micro_nm(LIMIT as i32),
        },
        pulse: PulseConfig {
            amplitude: Velocity(I20F12::from_num(PULSE_HEIGHT)),
            decay: I2F30::from_num(PULSE_DECAY),
            start_delay_cycles: 0,
        },
        backlash: BacklashConfig::default(),
        coulomb: Torque::from_micro_nm(COULOMB as i32),
        filter: FilterConfig::OFF,
    }
}

struct Twin {
    config: Config,
    before: Option<(f64, f64, f64)>,
    direction: f64,
    pulse: f64,
    velocity: f64,
    integral: f64,
}

impl Twin {
    fn new(config: &Config) -> Self {
        Self { config: config.clone(), before: None, direction: 0.0, pulse: 0.0, velocity: 0.0, integral: 0.0 }
    }

    fn step(&mut self, source: PositionSource, setpoint: f64, motor: f64, load: f64) -> f64 {
        let cascade = &self.config.cascade;
        let position_gain: f64 = cascade.position_gain.0.to_num();
        let velocity_gain: f64 = cascade.velocity_gain.0.to_num();
        let integral_gain: f64 = cascade.integral_gain.0.to_num();
        let acceleration_gain: f64 = cascade.acceleration_gain.0.to_num();
        let share: f64 = cascade.velocity_filter.to_num();
        let (height, decay): (f64, f64) = (self.config.pulse.amplitude.0.to_num(), self.config.pulse.decay.to_num());
        let (limit, coulomb): (f64, f64) = (cascade.torque_limit.0.to_num(), self.config.coulomb.0.to_num());
        let (x0, v0, m0) = self.before.unwrap_or((setpoint, 0.0, motor));
        let velocity = setpoint - x0;
        let acceleration = if self.before.is_some() { velocity - v0 } else { 0.0 };
        let motor_velocity = motor - m0;
        self.before = Some((setpoint, velocity, motor));
        self.pulse *= decay;
        if velocity != 0.0 {
            let now = velocity.signum();
            if self.direction != 0.0 && now != self.direction {
                self.pulse = now * height;
            }
            self.direction = now;
        }
        let measured = if source == PositionSource::Motor { motor } else { load };
        let command = velocity + self.pulse + position_gain * (setpoint - measured);
        self.velocity += share * (motor_velocity - self.velocity);
        let error = command - self.velocity;
        let integral = (self.integral + integral_gain * error).clamp(-limit, limit);
        let wanted = velocity_gain * error + integral + acceleration_gain * acceleration + coulomb * self.direction;
        let torque = wanted.clamp(-limit, limit);
        let pushes = (wanted >= limit && error > 0.0) || (wanted <= -limit && error < 0.0);
        if !pushes {
            self.integral = integral;
        }
        torque
    }
}

/// Positions in counts of 10 nm along a sum of sines, the measurement a little behind.
fn motion(cycle: u32, amplitude: f64, period: f64, lag: f64) -> (f64, f64, f64) {
    let at = |t: f64| {
        let phase = std::f64::consts::TAU * t / period;
        amplitude * (phase.sin() + 0.2 * (2.7 * phase).sin())
    };
    let t = f64::from(cycle);
    let fine = |x: f64| (x * 256.0).round() / 256.0;
    (fine(at(t)), at(t - lag).round(), at(t - 1.3 * lag).round())
}

fn input(setpoint: f64, motor: f64, load: f64) -> Input {
    let position = |x: f64| Position(I56F8::from_num(x));
    Input { setpoint: position(setpoint), motor: position(motor), load: position(load) }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn fixed_point_and_floating_point_agree_within_the_bound(
        amplitude in 1.0e3_f64..1.0e7, period in 300.0_f64..20_000.0, lag in 0.0_f64..3.0, on_load in any::<bool>(),
    ) {
        let source = if on_load { PositionSource::Load } else { PositionSource::Motor };
        let config = config(source);
        let (mut state, mut twin) = (State::default(), Twin::new(&config));
        for cycle in 0..3000 {
            let (setpoint, motor, load) = motion(cycle, amplitude, period, lag);
            let fixed = controller::step(&config, &mut state, &input(setpoint, motor, load)).torque;
            let float = twin.step(source, setpoint, motor, load);
            // At the limit the two may hold the integral one cycle apart, which is a step and no rounding.
            if float.abs() > 0.95 * LIMIT {
                break;
            }
            let difference = (f64::from(fixed.to_micro_nm_lossy()) - float).abs();
            prop_assert!(difference <= BOUND_MICRO_NM, "cycle {cycle}: {difference} µN·m of {float}");
        }
    }

    #[test]
    fn no_input_makes_the_law_panic_or_pass_its_limit(
        inputs in proptest::collection::vec((any::<i64>(), any::<i64>(), any::<i64>()), 1..100),
    ) {
        let (config, mut state) = (config(PositionSource::Load), State::default());
        for (setpoint, motor, load) in inputs {
            let position = |bits: i64| Position(I56F8::from_bits(bits));
            let input = Input { setpoint: position(setpoint), motor: position(motor), load: position(load) };
            let torque = controller::step(&config, &mut state, &input).torque;
            prop_assert!(torque.to_micro_nm_lossy().abs() <= LIMIT as i32);
        }
    }
}

/// Rows of bits: setpoint, motor, load (10 nm / 256), torque (µN·m). Whatever runs this law has to give the same integers.
#[test]
fn the_golden_vectors_repeat_to_the_bit() {
    let mut text =
        String::from("# setpoint motor load torque; 10 nm/256 and uN m; config of tests/twin.rs, load side\n");
    let (config, mut state) = (config(PositionSource::Load), State::default());
    for cycle in 0..400 {
        let (setpoint, motor, load) = motion(cycle, 40_000.0, 333.0, 2.0);
        let input = input(setpoint, motor, load);
        let torque = controller::step(&config, &mut state, &input).torque.to_micro_nm_lossy();
        let bits = |position: Position| position.0.to_bits();
        text += &format!("{} {} {} {torque}\n", bits(input.setpoint), bits(input.motor), bits(input.load));
    }
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/vectors/reference.txt");
    if std::env::var_os("QUADRANT_BLESS").is_some() {
        std::fs::write(path, &text).unwrap();
    }
    let golden = std::fs::read_to_string(path).unwrap_or_default();
    let differing = golden.lines().zip(text.lines()).position(|(golden, now)| golden != now);
    assert!(golden == text, "line {differing:?} of {path} differs");
}
