//! Seeded records of axes with known hidden effects, for judging the identification.
//!
//! The plant simulator under a floating-point position controller, at 1 kHz, recorded as a drive
//! would: encoders rounded down, the recorded effort with noise of its own. The identification
//! knows nothing of it but the CSV files and `dataset.toml`.

use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::io;
use std::path::Path;

use plant_sim::axis::{Axis, AxisParameters, Mounting, Reading};
use plant_sim::effects::{Effects, FrictionDrift, PitchError, TorqueRipple};
use plant_sim::friction::{Law, Sliding};
use plant_sim::mechanics::Mechanics;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal, Uniform};

const PERIOD_S: f64 = 1.0e-3;
const LEAD_M: f64 = 0.010;
const COUNTS_PER_REV: u32 = 131_072;
const POSITION_GAIN_PER_S: f64 = 40.0;
const VELOCITY_BANDWIDTH_HZ: f64 = 25.0;
const INTEGRAL_PER_S: f64 = 30.0;
const VELOCITY_FILTER: f64 = 0.7;

/// One hidden effect, with its size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Hidden {
    /// Relative, by direction.
    ViscousAsymmetry(f64),
    /// Breakaway over Coulomb friction, velocity in m/s.
    Stribeck(f64, f64),
    /// Deflection of the bristles Fc/σ0, m.
    Presliding(f64),
    /// Gap, m.
    Backlash(f64),
    /// Screw stiffness, N/m.
    Compliance(f64),
    /// Amplitude, N, and order per revolution.
    TorqueRipple(f64, f64),
    /// Amplitude, m, and period, m.
    PitchError(f64, f64),
    /// Relative change of friction per metre.
    PositionDependentFriction(f64),
    /// Relative surplus at the start and time constant, s.
    FrictionDrift(f64, f64),
    /// N·s²/m².
    QuadraticDrag(f64),
    /// Share lost at 1 kN.
    TorqueSaturation(f64),
    /// s.
    Delay(f64),
    /// Outside the list: a force over position, N/m.
    Spring(f64),
    /// Outside the list: a force over time, N and Hz.
    Hum(f64, f64),
    /// Outside the list: a drag that grows with the cube of velocity, N·s³/m³.
    CubicDrag(f64),
}

impl Hidden {
    /// Its name in the interface; `unexplained` where it has none.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::ViscousAsymmetry(_) => "viscous_asymmetry",
            Self::Stribeck(..) => "stribeck",
            Self::Presliding(_) => "presliding",
            Self::Backlash(_) => "backlash",
            Self::Compliance(_) => "compliance",
            Self::TorqueRipple(..) => "torque_ripple",
            Self::PitchError(..) => "pitch_error",
            Self::PositionDependentFriction(_) => "position_dependent_friction",
            Self::FrictionDrift(..) => "friction_drift",
            Self::QuadraticDrag(_) => "quadratic_drag",
            Self::TorqueSaturation(_) => "torque_saturation",
            Self::Delay(_) => "delay",
            Self::Spring(_) | Self::Hum(..) | Self::CubicDrag(_) => "unexplained",
        }
    }
}

/// What to record.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// What the declared model lacks.
    pub hidden: Vec<Hidden>,
    /// Whether the load position is recorded.
    pub load_scale: bool,
    /// Whether the position loop is closed on the load: a gap is inside the loop.
    pub load_loop: bool,
    /// Factor on the Coulomb friction of the seed's axis.
    pub friction_factor: f64,
    /// Noise of the recorded effort, N.
    pub noise_n: f64,
    /// Rows of each record, 1 ms apart.
    pub rows: usize,
    /// Chooses the axis, the motion and the noise.
    pub seed: u64,
}

impl Default for Plan {
    fn default() -> Self {
        Self {
            hidden: Vec::new(),
            load_scale: false,
            load_loop: false,
            friction_factor: 1.0,
            noise_n: 3.0,
            rows: 30_000,
            seed: 1,
        }
    }
}

struct Source(ChaCha8Rng);

impl Source {
    fn between(&mut self, low: f64, high: f64) -> f64 {
        Uniform::new(low, high).map_or(low, |range| range.sample(&mut self.0))
    }

    fn normal(&mut self) -> f64 {
        StandardNormal.sample(&mut self.0)
    }
}

/// Writes `train.csv`, `validate.csv` and `dataset.toml` of a plan into a folder.
///
/// # Errors
/// Where the folder cannot be written.
pub fn write(folder: &Path, plan: &Plan) -> io::Result<()> {
    let mut source = Source(ChaCha8Rng::seed_from_u64(plan.seed));
    let parameters = axis(plan, &mut source);
    let mass = parameters.mechanics.motor_inertia_kg + parameters.mechanics.table_mass_kg;
    for name in ["train.csv", "validate.csv"] {
        let path = path(plan.rows, &mut source);
        std::fs::write(
            folder.join(name),
            record(plan, &parameters, &path, mass, &mut source),
        )?;
    }
    std::fs::write(folder.join("dataset.toml"), dataset(plan, mass))
}

fn dataset(plan: &Plan, mass: f64) -> String {
    let resolution = LEAD_M / f64::from(COUNTS_PER_REV);
    let load = if plan.load_scale {
        "load_encoder_resolution_m = 1e-7\n"
    } else {
        ""
    };
    let gain = mass * TAU * VELOCITY_BANDWIDTH_HZ;
    format!(
        "name = \"seed {}\"\nsample_period_s = {PERIOD_S}\neffort_hold = \"zero-order\"\n[axis]\nkind = \"linear\"\nlead_m_per_rev = {LEAD_M}\nencoder_resolution_m = {resolution:e}\n{load}\
         [controller]\nposition_gain_per_s = {POSITION_GAIN_PER_S}\nvelocity_gain_n_s_per_m = {gain}\nintegral_per_s = {INTEGRAL_PER_S}\nvelocity_filter = {VELOCITY_FILTER}\n\
         acceleration_feedforward_kg = {mass}\nposition_sensor = \"{}\"\n[declared]\neffects = [\"inertia\", \"viscous\", \"coulomb\", \"offset\"]\n",
        plan.seed,
        if plan.load_loop { "load" } else { "motor" }
    )
}

/// An axis of a plan: masses, friction and effects.
fn axis(plan: &Plan, source: &mut Source) -> AxisParameters {
    let coulomb_n = plan.friction_factor * source.between(180.0, 320.0);
    let sliding = Sliding {
        coulomb_n,
        static_n: coulomb_n,
        stribeck_velocity_m_per_s: 2.0e-3,
        viscous_n_s_per_m: source.between(700.0, 1100.0),
        coulomb_asymmetry: 0.0,
        viscous_asymmetry: 0.0,
        quadratic_drag_n_s2_per_m2: 0.0,
    };
    let mechanics = Mechanics {
        motor_inertia_kg: source.between(380.0, 460.0),
        table_mass_kg: source.between(250.0, 340.0),
        screw_stiffness_n_per_m: 1.0e10,
        screw_damping_n_s_per_m: 2.0e5,
        backlash_m: 0.0,
    };
    let mut parameters = AxisParameters {
        mechanics,
        lead_m_per_rev: LEAD_M,
        sliding,
        law: Law::Coulomb,
        effects: Effects {
            offset_n: source.between(-30.0, 30.0),
            ..Effects::default()
        },
        motor_encoder_counts_per_rev: COUNTS_PER_REV,
        load_encoder_resolution_m: 1.0e-7,
        current_loop_time_constant_s: 2.0e-5,
        force_limit_n: 1.0e4,
        force_noise_n: 0.3 * plan.noise_n,
        mounting: Mounting::default(),
    };
    plan.hidden
        .iter()
        .for_each(|hidden| hide(*hidden, &mut parameters));
    parameters
}

fn hide(hidden: Hidden, axis: &mut AxisParameters) {
    match hidden {
        Hidden::ViscousAsymmetry(share) => axis.sliding.viscous_asymmetry = share,
        Hidden::Stribeck(ratio, velocity) => {
            axis.sliding.static_n = ratio * axis.sliding.coulomb_n;
            axis.sliding.stribeck_velocity_m_per_s = velocity;
        }
        Hidden::Presliding(deflection) => {
            let bristle_stiffness_n_per_m = axis.sliding.coulomb_n / deflection;
            axis.law = Law::LuGre {
                bristle_stiffness_n_per_m,
                bristle_damping_n_s_per_m: 2.0e4,
            };
        }
        Hidden::Backlash(gap) => axis.mechanics.backlash_m = gap,
        Hidden::Compliance(stiffness) => {
            axis.mechanics.screw_stiffness_n_per_m = stiffness;
            axis.mechanics.screw_damping_n_s_per_m = 2.0e4;
        }
        Hidden::TorqueRipple(amplitude_n, order_per_rev) => {
            axis.effects.torque_ripple = Some(TorqueRipple {
                amplitude_n,
                order_per_rev,
                phase_rad: 0.7,
            });
        }
        Hidden::PitchError(amplitude_m, period_m) => {
            axis.effects.pitch_error = Some(PitchError {
                amplitude_m,
                period_m,
            });
        }
        Hidden::PositionDependentFriction(per_m) => {
            axis.effects.position_dependent_friction_per_m = per_m;
        }
        Hidden::FrictionDrift(gain, time_constant_s) => {
            axis.effects.friction_drift = Some(FrictionDrift {
                gain,
                time_constant_s,
            });
        }
        Hidden::QuadraticDrag(drag) => axis.sliding.quadratic_drag_n_s2_per_m2 = drag,
        Hidden::TorqueSaturation(share) => {
            axis.effects.torque_saturation_per_n = 1.0e-3 * share / (1.0 - share);
        }
        Hidden::Delay(delay_s) => axis.effects.delay_s = delay_s,
        Hidden::Spring(_) | Hidden::Hum(..) | Hidden::CubicDrag(_) => {}
    }
}

/// Force of the hidden effects that the simulator has no name for, N.
fn foreign_n(hidden: &[Hidden], table_m: f64, velocity: f64, time_s: f64) -> f64 {
    hidden
        .iter()
        .map(|hidden| match hidden {
            Hidden::Spring(n_per_m) => -n_per_m * table_m,
            Hidden::Hum(amplitude_n, hz) => amplitude_n * (TAU * hz * time_s).sin(),
            Hidden::CubicDrag(drag) => -drag * velocity.powi(3),
            _ => 0.0,
        })
        .sum()
}

/// The motion of a record: sums of sines, bursts and trapezoids, slow and fast, with rests.
fn path(rows: usize, source: &mut Source) -> Vec<f64> {
    let mut path = vec![0.0; (source.between(0.2, 0.6) / PERIOD_S) as usize];
    while path.len() < rows {
        let here = path.last().copied().unwrap_or(0.0);
        let kind = source.between(0.0, 3.0);
        let piece = if kind < 1.0 {
            sines(here, source)
        } else if kind < 1.7 {
            slow(here, source)
        } else {
            trapezoid(here, source)
        };
        path.extend(piece);
        let rest = (source.between(0.02, 0.3) / PERIOD_S) as usize;
        path.extend(std::iter::repeat_n(
            path.last().copied().unwrap_or(0.0),
            rest,
        ));
    }
    path.truncate(rows);
    path
}

/// Furthest from the middle, m.
const REACH_M: f64 = 0.14;

/// Two sines in a smooth window; back to where it began.
fn sines(here: f64, source: &mut Source) -> Vec<f64> {
    let duration_s = source.between(2.0, 4.0);
    let hz = [source.between(0.4, 0.9), source.between(1.0, 3.0)];
    let speed = [source.between(0.02, 0.15), source.between(0.005, 0.05)];
    let phase = source.between(0.0, TAU);
    let rows = (duration_s / PERIOD_S) as usize;
    (0..rows)
        .map(|row| {
            let t = PERIOD_S * row as f64;
            let window = smooth(2.0 * t) * smooth(2.0 * (duration_s - t));
            let part =
                |i: usize, phase: f64| speed[i] / (TAU * hz[i]) * (TAU * hz[i] * t + phase).sin();
            here + window * (part(0, 0.0) + part(1, phase))
        })
        .collect()
}

/// Slow moves there and back.
fn slow(here: f64, source: &mut Source) -> Vec<f64> {
    let velocity = 1.0e-3 * 10.0_f64.powf(source.between(0.2, 1.3));
    let way = (velocity * source.between(0.4, 1.2)).min(0.02);
    let there = if here > 0.0 { -way } else { way };
    [
        ramp(here, here + there, velocity, 0.3),
        ramp(here + there, here, velocity, 0.3),
    ]
    .concat()
}

/// A fast move elsewhere.
fn trapezoid(here: f64, source: &mut Source) -> Vec<f64> {
    let target = source.between(-REACH_M, REACH_M);
    ramp(
        here,
        target,
        source.between(0.05, 0.30),
        source.between(0.5, 3.0),
    )
}

/// A move with a limited velocity and acceleration, smoothed.
fn ramp(from: f64, to: f64, velocity: f64, acceleration: f64) -> Vec<f64> {
    let way = (to - from).abs();
    let velocity = velocity.min((way * acceleration).sqrt());
    if way == 0.0 {
        return Vec::new();
    }
    let speeding_s = 1.875 * velocity / acceleration;
    let duration_s = way / velocity + speeding_s;
    let mut x = 0.0;
    let rows = (duration_s / PERIOD_S) as usize + 1;
    (0..rows)
        .map(|row| {
            let t = PERIOD_S * row as f64;
            x += PERIOD_S
                * velocity
                * smooth(t / speeding_s)
                * smooth((duration_s - t) / speeding_s);
            from + (to - from).signum() * x.min(way)
        })
        .collect()
}

fn smooth(u: f64) -> f64 {
    let u = u.clamp(0.0, 1.0);
    u.powi(3) * (10.0 - 15.0 * u + 6.0 * u * u)
}

/// Runs the axis along a path and writes the record.
fn record(
    plan: &Plan,
    parameters: &AxisParameters,
    path: &[f64],
    mass: f64,
    source: &mut Source,
) -> String {
    let seed = source.between(0.0, 1.0e9) as u64;
    let mut axis = Axis::new(parameters.clone(), seed);
    let resolution = LEAD_M / f64::from(COUNTS_PER_REV);
    let load = if plan.load_scale {
        ",load_position_m"
    } else {
        ""
    };
    let mut text = format!("time_s,reference_m,position_m{load},force_n\n");
    let mut control = Loop::new(mass);
    for row in 0..path.len() {
        let Reading {
            motor_increments,
            load_10_nm,
        } = axis.read();
        let position = motor_increments as f64 * resolution;
        let measured = if plan.load_loop {
            1.0e-8 * load_10_nm as f64
        } else {
            position
        };
        let force = control.step(path, row, measured);
        let recorded = force + plan.noise_n * source.normal();
        let load = if plan.load_scale {
            format!(",{:.8}", 1.0e-8 * load_10_nm as f64)
        } else {
            String::new()
        };
        let time_s = PERIOD_S * row as f64;
        writeln!(
            text,
            "{time_s:.3},{:.9},{position:.10}{load},{recorded:.2}",
            path[row]
        )
        .expect("a String takes it");
        let motion = *axis.motion();
        axis.advance(
            force + foreign_n(&plan.hidden, motion.table_m, motion.table_m_per_s, time_s),
            PERIOD_S,
        );
    }
    text
}

/// Radius and feed of the circle on which bursts are compared.
const CIRCLE_M: f64 = 0.100;
const FEED_M_PER_S: f64 = 2.0 / 60.0;
/// Bursts are looked for within this angle about a reversal, rad.
const BURST_WINDOW: f64 = 0.26;

/// The burst that the axis of a plan makes on a circle, m: the largest deviation of the table from
/// its setpoint about the reversals of the second turn, less the deviation in between.
#[must_use]
pub fn burst_m(plan: &Plan) -> f64 {
    let mut source = Source(ChaCha8Rng::seed_from_u64(plan.seed));
    let parameters = AxisParameters {
        force_noise_n: 0.0,
        ..axis(plan, &mut source)
    };
    let mass = parameters.mechanics.motor_inertia_kg + parameters.mechanics.table_mass_kg;
    let omega = FEED_M_PER_S / CIRCLE_M;
    let rows = (2.0 * TAU / omega / PERIOD_S) as usize;
    let angle = |row: usize| omega * PERIOD_S * row as f64;
    let path: Vec<f64> = (0..rows).map(|row| CIRCLE_M * angle(row).sin()).collect();
    let mut axis = Axis::new(parameters, 1);
    let mut control = Loop::new(mass);
    let (mut largest, mut sum, mut count) = (0.0_f64, 0.0, 0.0);
    for row in 0..rows {
        let Reading {
            motor_increments,
            load_10_nm,
        } = axis.read();
        let motor = motor_increments as f64 * LEAD_M / f64::from(COUNTS_PER_REV);
        let measured = if plan.load_loop {
            1.0e-8 * load_10_nm as f64
        } else {
            motor
        };
        let deviation = (axis.motion().table_m - path[row]).abs();
        if angle(row) > TAU {
            if angle(row).cos().abs() < BURST_WINDOW.sin() {
                largest = largest.max(deviation);
            } else {
                (sum, count) = (sum + deviation, count + 1.0);
            }
        }
        axis.advance(control.step(&path, row, measured), PERIOD_S);
    }
    largest - sum / f64::max(count, 1.0)
}

/// Position P, velocity PI with feedforward of velocity and acceleration.
struct Loop {
    mass: f64,
    before: Option<f64>,
    velocity: f64,
    integral: f64,
}

impl Loop {
    const fn new(mass: f64) -> Self {
        Self {
            mass,
            before: None,
            velocity: 0.0,
            integral: 0.0,
        }
    }

    fn step(&mut self, path: &[f64], row: usize, position: f64) -> f64 {
        let at = |row: usize| path[row.min(path.len() - 1)];
        let slope = |row: usize| (at(row) - at(row.saturating_sub(1))) / PERIOD_S;
        let quotient = (position - self.before.unwrap_or(position)) / PERIOD_S;
        self.before = Some(position);
        self.velocity += VELOCITY_FILTER * (quotient - self.velocity);
        let error = POSITION_GAIN_PER_S * (at(row) - position) + slope(row) - self.velocity;
        self.integral += PERIOD_S * INTEGRAL_PER_S * error;
        let gain = self.mass * TAU * VELOCITY_BANDWIDTH_HZ;
        gain * (error + self.integral)
            + self.mass * (slope(row + 1) - slope(row.saturating_sub(1))) / (2.0 * PERIOD_S)
    }
}
