//! One axis: actuator, mechanics, effects and encoders, advanced by one control cycle at a time.

use axis_model::Inertia;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};

use protocol::states::BrakeState;

use crate::brake::{Brake, BrakeParameters};
use crate::effects::{Effects, Instant};
use crate::friction::{Friction, Law, Sides, Sliding};
use crate::lag::Lag;
use crate::mechanics::{Drive, Mechanics, Motion};
use crate::stops::Stops;

/// Sub-step of the integration: halving it changes a free run of 8 mm by less than 10⁻⁵ of it
/// (`tests/mechanics.rs`).
pub const SUB_STEP_S: f64 = 1.0e-3 / 16.0;

/// How an axis is mounted: what pulls at it, what holds it, where it ends and where it stands when
/// it is switched on.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Mounting {
    /// Force of gravity on the table towards positive position, N: −2500 where positive is up.
    /// Identification finds it as an `offset` of the opposite sign, because an offset is counted
    /// against positive motion.
    pub gravity_n: f64,
    /// Brake on the motor.
    pub brake: Option<BrakeParameters>,
    /// End stops at the table.
    pub stops: Option<Stops>,
    /// Where the table stands when the axis is switched on, m.
    pub start_m: f64,
    /// Motor position at the table where the motor encoder reads zero, m.
    pub motor_zero_m: f64,
    /// Table position where the load scale reads zero, m.
    pub load_zero_m: f64,
}

impl Mounting {
    /// The axis at rest in its start position, the table hanging on the screw where gravity pulls.
    #[must_use]
    pub fn start(&self, mechanics: &Mechanics) -> Motion {
        let hang_m = -self.gravity_n / mechanics.screw_stiffness_n_per_m;
        let gap_m = if self.gravity_n == 0.0 {
            0.0
        } else {
            -0.5 * mechanics.backlash_m * self.gravity_n.signum()
        };
        Motion {
            motor_m: self.start_m + gap_m + hang_m,
            table_m: self.start_m,
            ..Motion::default()
        }
    }
}

/// Friction of what turns with the motor: bearings, nut, seals, seen at the table.
#[derive(Clone, Debug, PartialEq)]
pub struct MotorSide {
    /// Sliding friction.
    pub sliding: Sliding,
    /// Friction law.
    pub law: Law,
}

/// Everything that an axis really is.
#[derive(Clone, Debug, PartialEq)]
pub struct AxisParameters {
    /// Inertia and screw.
    pub mechanics: Mechanics,
    /// Travel per motor revolution, m.
    pub lead_m_per_rev: f64,
    /// Sliding friction at the table.
    pub sliding: Sliding,
    /// Friction law at the table.
    pub law: Law,
    /// Friction of the motor's side, where it has some.
    pub motor_side: Option<MotorSide>,
    /// Further effects.
    pub effects: Effects,
    /// Motor encoder.
    pub motor_encoder_counts_per_rev: u32,
    /// Load scale, m.
    pub load_encoder_resolution_m: f64,
    /// Time constant of the current loop, s; zero is allowed.
    pub current_loop_time_constant_s: f64,
    /// Limit of the force, N.
    pub force_limit_n: f64,
    /// Noise of the force that really acts, N, one value a cycle.
    pub force_noise_n: f64,
    /// How it is mounted.
    pub mounting: Mounting,
}

impl AxisParameters {
    /// What has to be accelerated, in the words of the vocabulary, kg.
    #[must_use]
    pub const fn inertia(&self) -> Inertia {
        let (motor, load) = (
            self.mechanics.motor_inertia_kg,
            self.mechanics.table_mass_kg,
        );
        Inertia {
            inertia: motor + load,
            load: Some(load),
        }
    }

    /// Force at the table of a motor torque of 1 µN·m, N.
    #[must_use]
    pub fn newton_per_micro_nm(&self) -> f64 {
        1.0e-6 * std::f64::consts::TAU / self.lead_m_per_rev
    }
}

/// Encoder readings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Reading {
    /// Motor encoder, increments.
    pub motor_increments: i64,
    /// Load scale, counts of 10 nm.
    pub load_10_nm: i64,
}

/// An axis in motion.
#[derive(Clone, Debug)]
pub struct Axis {
    parameters: AxisParameters,
    motion: Motion,
    friction: Sides,
    brake: Option<Brake>,
    force_n: f64,
    delayed_n: f64,
    lag: Lag,
    time_s: f64,
    noise: ChaCha8Rng,
    seed: u64,
    sub_step_s: f64,
}

impl Axis {
    /// An axis at rest in its start position, its brake closed.
    #[must_use]
    pub fn new(parameters: AxisParameters, seed: u64) -> Self {
        let motor_side = parameters.motor_side.as_ref();
        let friction = Sides {
            table: Friction::new(parameters.sliding, parameters.law.clone()),
            motor: motor_side.map(|own| Friction::new(own.sliding, own.law.clone())),
        };
        let motion = parameters.mounting.start(&parameters.mechanics);
        let brake = parameters.mounting.brake.map(Brake::new);
        Self {
            parameters,
            motion,
            friction,
            brake,
            force_n: 0.0,
            delayed_n: 0.0,
            lag: Lag::default(),
            time_s: 0.0,
            noise: ChaCha8Rng::seed_from_u64(seed),
            seed,
            sub_step_s: SUB_STEP_S,
        }
    }

    /// The axis as it was when it was switched on, its noise from the beginning.
    pub fn start_over(&mut self) {
        let sub_step_s = self.sub_step_s;
        *self = Self::new(self.parameters.clone(), self.seed).with_sub_step(sub_step_s);
    }

    /// The same axis with another sub-step; for convergence tests.
    #[must_use]
    pub fn with_sub_step(mut self, sub_step_s: f64) -> Self {
        self.sub_step_s = sub_step_s;
        self
    }

    /// Where the axis is.
    #[must_use]
    pub const fn motion(&self) -> &Motion {
        &self.motion
    }

    /// Puts the axis somewhere at rest; for tests and for starting a record elsewhere.
    pub fn place(&mut self, motion: Motion) {
        self.motion = motion;
    }

    /// Tells the brake, if there is one, to open or to close.
    pub fn command_brake(&mut self, release: bool) {
        if let Some(brake) = &mut self.brake {
            brake.command(release);
        }
    }

    /// Where the brake stands.
    #[must_use]
    pub fn brake(&self) -> BrakeState {
        self.brake
            .as_ref()
            .map_or(BrakeState::NotFitted, Brake::state)
    }

    /// Force that the motor delivers at present, N.
    #[must_use]
    pub const fn force_n(&self) -> f64 {
        self.force_n
    }

    /// What it is made of.
    #[must_use]
    pub const fn parameters(&self) -> &AxisParameters {
        &self.parameters
    }

    /// Reads both encoders: rounded down, as an incremental encoder counts.
    #[must_use]
    pub fn read(&self) -> Reading {
        let parameters = &self.parameters;
        let counts_per_m =
            f64::from(parameters.motor_encoder_counts_per_rev) / parameters.lead_m_per_rev;
        let mounting = &parameters.mounting;
        let scale_m = self.motion.table_m + parameters.effects.scale_error_m(self.motion.table_m)
            - mounting.load_zero_m;
        let resolution = parameters.load_encoder_resolution_m;
        Reading {
            motor_increments: floor((self.motion.motor_m - mounting.motor_zero_m) * counts_per_m),
            load_10_nm: floor((scale_m / resolution).floor() * resolution / 1.0e-8 + 0.5),
        }
    }

    /// Advances by one control cycle with a commanded force.
    pub fn advance(&mut self, commanded_n: f64, cycle_s: f64) {
        let noise: f64 = StandardNormal.sample(&mut self.noise);
        let limit = self.parameters.force_limit_n;
        let effects = &self.parameters.effects;
        let wanted = effects.delivered_n(commanded_n.clamp(-limit, limit));
        let disturbance = self.parameters.force_noise_n * noise;
        let steps = (cycle_s / self.sub_step_s).round().max(1.0);
        let dt_s = cycle_s / steps;
        let time_constant_s = self.parameters.current_loop_time_constant_s;
        let lag = self.lag.kept_over(dt_s, time_constant_s);
        self.lag = lag;
        let before = std::mem::replace(&mut self.delayed_n, wanted);
        let delay_s = effects.delay_s().min(cycle_s);
        let mut elapsed = 0.0;
        while elapsed < cycle_s - 0.5 * dt_s {
            let target = if elapsed < delay_s {
                // The share of this sub-step in which the old force still acts.
                let old = ((delay_s - elapsed) / dt_s).min(1.0);
                old * before + (1.0 - old) * wanted
            } else {
                wanted
            };
            self.sub_step(target, disturbance, lag, dt_s);
            elapsed += dt_s;
        }
        self.time_s += cycle_s;
    }

    fn sub_step(&mut self, target_n: f64, disturbance_n: f64, lag: Lag, dt_s: f64) {
        let before = self.force_n;
        self.force_n += lag.end * (target_n - self.force_n);
        let mean_n = target_n + (before - target_n) * lag.mean_left;
        let effects = &self.parameters.effects;
        let acting = effects.acting(|| Instant {
            delivered_n: mean_n,
            ..self.instant(dt_s)
        });
        let drive = Drive {
            motor_n: mean_n + disturbance_n + acting.motor_n,
            table_n: self.parameters.mounting.gravity_n + self.stop_n(dt_s) + acting.table_n,
            friction_factor: acting.friction_factor,
            friction_level_n: acting.friction_level_n,
            added_mass_kg: acting.added_mass_kg,
            brake_n: self.brake.as_mut().map_or(0.0, |brake| brake.pass(dt_s)),
        };
        self.parameters
            .mechanics
            .advance(&mut self.motion, &mut self.friction, drive, dt_s);
    }

    /// What the effects of a sub-step see: the motor in its middle, the table at its begin.
    fn instant(&self, dt_s: f64) -> Instant {
        let (parameters, motion) = (&self.parameters, &self.motion);
        Instant {
            motor_m: motion.motor_m + 0.5 * dt_s * motion.motor_m_per_s,
            table_m: motion.table_m,
            table_m_per_s: motion.table_m_per_s,
            time_s: self.time_s,
            lead_m: parameters.lead_m_per_rev,
            transmitted_n: parameters.mechanics.transmitted_n(motion),
            ..Instant::default()
        }
    }

    /// Force of an end stop on the table in the middle of a sub-step.
    fn stop_n(&self, dt_s: f64) -> f64 {
        let Motion {
            table_m,
            table_m_per_s,
            ..
        } = self.motion;
        let force =
            |stops: Stops| stops.force_n(table_m + 0.5 * dt_s * table_m_per_s, table_m_per_s);
        self.parameters.mounting.stops.map_or(0.0, force)
    }
}

#[expect(
    clippy::cast_possible_truncation,
    reason = "saturates at 2^63 counts, 10^11 m"
)]
fn floor(value: f64) -> i64 {
    value.floor() as i64
}
