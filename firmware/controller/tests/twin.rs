//! A floating-point twin beside the fixed-point law, and golden vectors that ARM has to repeat
//! (`cargo test -p hil-tests emulated`).
//!
//! The twin is written from the equations of the module docs in `f64`. On the reference gains and
//! any plausible motion the two differ by less than [`BOUND_MICRO_NM`] after 3000 cycles: rounding
//! of position to 39 pm and of velocity to 2.4 pm per cycle is all there is. The twin has the gains
//! as the fixed-point numbers hold them; how well they hold the SI ones is tested where they are
//! made.

use controller::reference::ReferenceState;
use controller::units::{Position, Velocity};
use controller::{Config, PositionSource, State};
use fixed::types::I56F8;
use proptest::prelude::*;

#[path = "../vectors/law.rs"]
mod law;

use law::{LIMIT, config, torque};

/// Largest difference of the torques, µN·m: 0.0035 ‰ of the reference axis' 14.3 N·m.
const BOUND_MICRO_NM: f64 = 50.0;

struct Twin {
    config: Config,
    motor: Option<f64>,
    direction: f64,
    pulse: f64,
    velocity: f64,
    integral: f64,
}

/// What the reference stage says of a path: x(k), x(k) − x(k−1), x(k+1) − x(k), and a(k) + 1.5
/// (a(k) − a(k−1)).
struct Path {
    setpoint: f64,
    velocity: f64,
    next_velocity: f64,
    acceleration: f64,
}

impl Path {
    /// `at` is at rest before cycle 0; the stage takes two setpoints before it believes an
    /// acceleration.
    fn of(at: impl Fn(u32) -> f64, cycle: u32) -> Self {
        let velocity = |cycle: u32| {
            if cycle == 0 {
                0.0
            } else {
                at(cycle) - at(cycle - 1)
            }
        };
        let acceleration = |cycle: u32| {
            if cycle < 2 {
                0.0
            } else {
                velocity(cycle + 1) - velocity(cycle)
            }
        };
        let now = acceleration(cycle);
        let before = if cycle == 0 {
            0.0
        } else {
            acceleration(cycle - 1)
        };
        Self {
            setpoint: at(cycle),
            velocity: velocity(cycle),
            next_velocity: velocity(cycle + 1),
            acceleration: now + 1.5 * (now - before),
        }
    }
}

impl Twin {
    fn new(config: &Config) -> Self {
        Self {
            config: config.clone(),
            motor: None,
            direction: 0.0,
            pulse: 0.0,
            velocity: 0.0,
            integral: 0.0,
        }
    }

    fn step(&mut self, source: PositionSource, path: &Path, motor: f64, load: f64) -> f64 {
        let cascade = &self.config.cascade;
        let position_gain: f64 = cascade.position_gain.0.to_num();
        let velocity_gain: f64 = cascade.velocity_gain.0.to_num();
        let integral_gain: f64 = cascade.integral_gain.0.to_num();
        let acceleration_gain: f64 = cascade.acceleration_gain.0.to_num();
        let share: f64 = cascade.velocity_filter.to_num();
        let compensation = self.config.compensation.unwrap();
        let (height, decay): (f64, f64) = (
            compensation.pulse.shape.amplitude.0.to_num(),
            compensation.pulse.shape.decay.to_num(),
        );
        let limit = f64::from(cascade.torque_limit.micro_nm());
        let coulomb: f64 = compensation.coulomb.0.to_num();
        let motor_velocity = motor - self.motor.replace(motor).unwrap_or(motor);
        self.pulse *= decay;
        if path.next_velocity != 0.0 {
            let now = path.next_velocity.signum();
            if self.direction != 0.0 && now != self.direction {
                self.pulse = now * height;
            }
            self.direction = now;
        }
        let measured = if source == PositionSource::Motor {
            motor
        } else {
            load
        };
        let command = path.velocity + self.pulse + position_gain * (path.setpoint - measured);
        self.velocity += share * (motor_velocity - self.velocity);
        let error = command - self.velocity;
        let integral = (self.integral + integral_gain * error).clamp(-limit, limit);
        let wanted = velocity_gain * error
            + integral
            + acceleration_gain * path.acceleration
            + coulomb * self.direction;
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

fn position(x: f64) -> Position {
    Position(I56F8::from_num(x))
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn fixed_point_and_floating_point_agree_within_the_bound(
        amplitude in 1.0e3_f64..1.0e7, period in 300.0_f64..20_000.0, lag in 0.0_f64..3.0, on_load in any::<bool>(),
    ) {
        let source = if on_load { PositionSource::Load } else { PositionSource::Motor };
        let config = config(source);
        let path = |cycle: u32| motion(cycle, amplitude, period, lag).0;
        let (mut law, mut twin) = (State::default(), Twin::new(&config));
        let mut stage = ReferenceState::at(position(path(0)), Velocity::ZERO);
        for cycle in 0..3000 {
            let (_, motor, load) = motion(cycle, amplitude, period, lag);
            let at = [position(motor), position(load)];
            let fixed = torque(&config, &mut stage, &mut law, position(path(cycle + 1)), at);
            let float = twin.step(source, &Path::of(path, cycle), motor, load);
            // At the limit the two may hold the integral one cycle apart, which is a step and no
            // rounding.
            if float.abs() > 0.95 * LIMIT {
                break;
            }
            let difference = (f64::from(fixed) - float).abs();
            prop_assert!(difference <= BOUND_MICRO_NM, "cycle {cycle}: {difference} µN·m of {float}");
        }
    }

    #[test]
    fn no_input_makes_the_law_panic_or_pass_its_limit(
        inputs in proptest::collection::vec((any::<i64>(), any::<i64>(), any::<i64>()), 1..100),
    ) {
        let (config, mut law) = (config(PositionSource::Load), State::default());
        let mut stage = ReferenceState::default();
        for (setpoint, motor, load) in inputs {
            let [setpoint, motor, load] = [setpoint, motor, load].map(Position::from_fine_counts);
            let torque = torque(&config, &mut stage, &mut law, setpoint, [motor, load]);
            prop_assert!(torque.abs() <= LIMIT as i32);
        }
    }
}

/// Rows of bits: setpoint of the next cycle, motor, load (10 nm / 256), torque (µN·m). Whatever
/// runs this law has to give the same integers.
#[test]
fn the_golden_vectors_repeat_to_the_bit() {
    let mut text = String::from(
        "# preview motor load torque; 10 nm/256 and uN m; config of tests/twin.rs, load side\n",
    );
    let (config, mut law) = (config(PositionSource::Load), State::default());
    let at = |cycle| motion(cycle, 40_000.0, 333.0, 2.0);
    let mut stage = ReferenceState::at(position(at(0).0), Velocity::ZERO);
    for cycle in 0..400 {
        let ((preview, ..), (_, motor, load)) = (at(cycle + 1), at(cycle));
        let [preview, motor, load] = [preview, motor, load].map(position);
        let torque = torque(&config, &mut stage, &mut law, preview, [motor, load]);
        let bits = |position: Position| position.0.to_bits();
        text += &format!(
            "{} {} {} {torque}\n",
            bits(preview),
            bits(motor),
            bits(load)
        );
    }
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/vectors/reference.txt");
    if std::env::var_os("QUADRANT_BLESS").is_some() {
        std::fs::write(path, &text).unwrap();
    }
    let golden = std::fs::read_to_string(path).unwrap_or_default();
    let differing = golden
        .lines()
        .zip(text.lines())
        .position(|(golden, now)| golden != now);
    assert!(golden == text, "line {differing:?} of {path} differs");
}
