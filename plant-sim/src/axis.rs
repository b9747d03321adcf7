//! One axis: actuator, mechanics, effects and encoders, advanced by one control cycle at a time.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};

use crate::effects::Effects;
use crate::friction::{Friction, Law, Sliding};
use crate::mechanics::{Drive, Mechanics, Motion};

/// Sub-step of the integration: halving it changes a free run of 8 mm by less than 10⁻⁵ of it (`tests/mechanics.rs`).
pub const SUB_STEP_S: f64 = 1.0e-3 / 16.0;

/// Everything that an axis really is.
#[derive(Clone, Debug, PartialEq)]
pub struct AxisParameters {
    /// Inertia and screw.
    pub mechanics: Mechanics,
    /// Travel per motor revolution, m.
    pub lead_m_per_rev: f64,
    /// Sliding friction.
    pub sliding: Sliding,
    /// Friction law.
    pub law: Law,
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
}

impl AxisParameters {
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
    friction: Friction,
    force_n: f64,
    delayed_n: f64,
    time_s: f64,
    noise: ChaCha8Rng,
    sub_step_s: f64,
}

impl Axis {
    /// An axis at rest at position zero.
    #[must_use]
    pub fn new(parameters: AxisParameters, seed: u64) -> Self {
        let friction = Friction::new(parameters.sliding, parameters.law.clone());
        Self {
            parameters,
            motion: Motion::default(),
            friction,
            force_n: 0.0,
            delayed_n: 0.0,
            time_s: 0.0,
            noise: ChaCha8Rng::seed_from_u64(seed),
            sub_step_s: SUB_STEP_S,
        }
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
        let counts_per_m = f64::from(parameters.motor_encoder_counts_per_rev) / parameters.lead_m_per_rev;
        let scale_m = self.motion.table_m + parameters.effects.scale_error_m(self.motion.table_m);
        let resolution = parameters.load_encoder_resolution_m;
        Reading {
            motor_increments: floor(self.motion.motor_m * counts_per_m),
            load_10_nm: floor((scale_m / resolution).floor() * resolution / 1.0e-8 + 0.5),
        }
    }

    /// Advances by one control cycle with a commanded force.
    pub fn advance(&mut self, commanded_n: f64, cycle_s: f64) {
        let noise: f64 = StandardNormal.sample(&mut self.noise);
        let limit = self.parameters.force_limit_n;
        let effects = self.parameters.effects;
        let wanted = effects.delivered_n(commanded_n.clamp(-limit, limit));
        let disturbance = self.parameters.force_noise_n * noise;
        let steps = (cycle_s / self.sub_step_s).round().max(1.0);
        let dt_s = cycle_s / steps;
        let lag = lag_share(dt_s, self.parameters.current_loop_time_constant_s);
        let before = std::mem::replace(&mut self.delayed_n, wanted);
        let delay_s = effects.delay_s.min(cycle_s);
        let mut elapsed = 0.0;
        while elapsed < cycle_s - 0.5 * dt_s {
            // The share of this sub-step in which the old force still acts.
            let old = ((delay_s - elapsed) / dt_s).clamp(0.0, 1.0);
            let target = old * before + (1.0 - old) * wanted;
            self.sub_step(target, disturbance, lag, dt_s);
            elapsed += dt_s;
        }
        self.time_s += cycle_s;
    }

    fn sub_step(&mut self, target_n: f64, disturbance_n: f64, lag: f64, dt_s: f64) {
        let before = self.force_n;
        self.force_n += lag * (target_n - self.force_n);
        let mean_n = target_n + (before - target_n) * mean_share(lag);
        let effects = &self.parameters.effects;
        let middle = self.motion.motor_m + 0.5 * dt_s * self.motion.motor_m_per_s;
        let drive = Drive {
            motor_n: mean_n + disturbance_n + effects.motor_force_n(middle, self.parameters.lead_m_per_rev),
            table_n: -effects.offset_n,
            friction_factor: effects.friction_factor(self.motion.table_m, self.time_s),
        };
        self.parameters.mechanics.advance(&mut self.motion, &mut self.friction, drive, dt_s);
    }
}

#[expect(clippy::cast_possible_truncation, reason = "saturates at 2^63 counts, 10^11 m")]
fn floor(value: f64) -> i64 {
    value.floor() as i64
}

/// Share of the way to its target that a first-order lag covers in `dt`.
fn lag_share(dt_s: f64, time_constant_s: f64) -> f64 {
    if time_constant_s > 0.0 { -(-dt_s / time_constant_s).exp_m1() } else { 1.0 }
}

/// Mean of a decay from 1 over a sub-step in which it falls by `lag`: `lag / −ln(1 − lag)`, zero where it falls at once.
fn mean_share(lag: f64) -> f64 {
    if lag >= 1.0 { 0.0 } else { lag / -(-lag).ln_1p() }
}
