//! Friction of a body, the table or the motor, as an exchangeable effect.
//!
//! Every law answers one question of the integrator: given the velocity that the body would have
//! without friction, how large is the friction force over this sub-step? Laws with internal states
//! advance them in the same call. Friction is positive against motion.
//!
//! - [`Coulomb`](Law::Coulomb) with Stribeck fall and a *set-valued* stick phase: the body stands
//!   exactly still while the other forces stay below the breakaway force (Moreau's time stepping:
//!   friction is solved for, not looked up).
//! - [`LuGre`](Law::LuGre): bristle deflection `z`, `ż = v − σ0 |v| z / g(v)`, force `σ0 z + σ1 ż +
//!   Fv v` (Canudas de Wit, Olsson, Åström, Lischinsky 1995, eq. 2 to 4).
//! - [`MaxwellSlip`](Law::MaxwellSlip): parallel elasto-slide elements, for hysteresis with
//!   non-local memory (Iwan 1966).

use serde::{Deserialize, Serialize};

use crate::ranges::{Quantity, Ranged};

mod sides;
mod sliding;

pub use sides::Sides;
pub use sliding::Sliding;
pub(crate) use sliding::gaussian;
use sliding::{Curve, Fall, sign};

/// Which friction law acts, with its own parameters.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "law", rename_all = "kebab-case", deny_unknown_fields)]
pub enum Law {
    /// Coulomb and Stribeck with a rigid stick phase.
    Coulomb,
    /// LuGre.
    LuGre {
        /// Bristle stiffness σ0.
        bristle_stiffness_n_per_m: f64,
        /// Bristle damping σ1.
        bristle_damping_n_s_per_m: f64,
    },
    /// Maxwell slip.
    MaxwellSlip {
        /// Stiffness of each element.
        stiffness_n_per_m: Vec<f64>,
        /// Share of the sliding level that each element slips at; the shares add up to one.
        share: Vec<f64>,
    },
}

/// Range of a bristle's stiffness, N/m.
const STIFFNESS: (f64, f64) = (1.0e3, 1.0e12);
/// Range of a bristle's damping, N·s/m.
const DAMPING: (f64, f64) = (0.0, 1.0e7);

impl Ranged for Law {
    fn quantities(&self) -> Vec<Quantity> {
        match self {
            Self::Coulomb => Vec::new(),
            Self::LuGre {
                bristle_stiffness_n_per_m: stiffness,
                bristle_damping_n_s_per_m: damping,
            } => vec![
                Quantity::new("bristle_stiffness_n_per_m", *stiffness, STIFFNESS),
                Quantity::new("bristle_damping_n_s_per_m", *damping, DAMPING),
            ],
            Self::MaxwellSlip {
                stiffness_n_per_m, ..
            } => {
                let element = |k: &f64| Quantity::new("stiffness_n_per_m", *k, STIFFNESS);
                stiffness_n_per_m.iter().map(element).collect()
            }
        }
    }
}

impl Law {
    /// Stiffness at standstill, N/m; zero where the contact is rigid.
    #[must_use]
    pub fn stiffness_n_per_m(&self) -> f64 {
        match self {
            Self::Coulomb => 0.0,
            Self::LuGre {
                bristle_stiffness_n_per_m,
                ..
            } => *bristle_stiffness_n_per_m,
            Self::MaxwellSlip {
                stiffness_n_per_m, ..
            } => stiffness_n_per_m.iter().sum(),
        }
    }
}

/// A friction law with its state.
#[derive(Clone, Debug)]
pub struct Friction {
    sliding: Sliding,
    law: Law,
    state: State,
    kept: State,
}

/// Internal state of a friction law.
#[derive(Debug)]
pub struct State {
    deflection_m: Vec<f64>,
    fall: Fall,
    at: At,
}

impl State {
    /// Deflection of each bristle or element, m.
    #[must_use]
    pub fn deflection_m(&self) -> &[f64] {
        &self.deflection_m
    }
}

impl Clone for State {
    fn clone(&self) -> Self {
        Self {
            deflection_m: self.deflection_m.clone(),
            ..*self
        }
    }

    /// Into the memory that is there: it happens in every sub-step of a gap in contact.
    fn clone_from(&mut self, other: &Self) {
        self.deflection_m.copy_from_slice(&other.deflection_m);
        (self.fall, self.at) = (other.fall, other.at);
    }
}

/// What the integrator asks: the body without friction, over one sub-step.
#[derive(Clone, Copy, Debug)]
pub struct Body {
    /// Velocity at the begin of the sub-step.
    pub velocity: f64,
    /// Velocity that it would have at the end without friction.
    pub free_velocity: f64,
    /// Mass that resists (with the implicit part of the screw's damping), kg.
    pub mass_kg: f64,
    /// Length of the sub-step.
    pub dt_s: f64,
    /// Factor on the sliding level: warm-up and position dependence.
    pub factor: f64,
    /// Level beside the sliding one, N: friction of the load.
    pub level_n: f64,
}

impl Body {
    /// Friction level of a velocity, N.
    fn friction_n(&self, curve: Curve<'_>, v: f64) -> f64 {
        curve.level_n(v) * self.factor + self.level_n
    }
}

impl Friction {
    /// A law at rest, with relaxed bristles.
    #[must_use]
    pub fn new(sliding: Sliding, law: Law) -> Self {
        let states = match &law {
            Law::Coulomb => 0,
            Law::LuGre { .. } => 1,
            Law::MaxwellSlip { share, .. } => share.len(),
        };
        let state = State {
            deflection_m: vec![0.0; states],
            fall: Fall::default(),
            at: At::default(),
        };
        Self {
            sliding,
            law,
            kept: state.clone(),
            state,
        }
    }

    /// Velocity of the body at the end of the sub-step; advances the internal state.
    pub fn advance(&mut self, body: Body) -> f64 {
        let Self {
            sliding,
            law,
            state:
                State {
                    deflection_m,
                    fall,
                    at,
                },
            ..
        } = self;
        *fall = fall.after(sliding, body.velocity, body.dt_s);
        let curve = Curve {
            sliding,
            fall: *fall,
        };
        match law {
            Law::Coulomb => coulomb(curve, body),
            Law::LuGre {
                bristle_stiffness_n_per_m,
                bristle_damping_n_s_per_m,
            } => {
                let bristle = Bristle {
                    stiffness: *bristle_stiffness_n_per_m,
                    damping: *bristle_damping_n_s_per_m,
                };
                lugre(curve, bristle, (&mut deflection_m[0], at), &body)
            }
            Law::MaxwellSlip {
                stiffness_n_per_m,
                share,
            } => maxwell(curve, stiffness_n_per_m, share, deflection_m, body),
        }
    }

    /// The internal state.
    #[must_use]
    pub fn state(&self) -> &State {
        &self.state
    }

    /// Keeps the internal state, to go back to with [`Self::go_back`].
    pub fn keep(&mut self) {
        self.kept.clone_from(&self.state);
    }

    /// Goes back to the state that was kept last.
    pub fn go_back(&mut self) {
        self.state.clone_from(&self.kept);
    }

    /// Bristle deflection (or mean element deflection), m.
    #[must_use]
    pub fn deflection_m(&self) -> f64 {
        let all = &self.state.deflection_m;
        all.iter().sum::<f64>() / all.len().max(1) as f64
    }
}

/// Moreau: the friction that stops the body within the sub-step, if it is within the breakaway
/// force; else the sliding level against motion, never past standstill.
fn coulomb(curve: Curve<'_>, body: Body) -> f64 {
    let Body {
        velocity,
        free_velocity,
        mass_kg,
        dt_s,
        ..
    } = body;
    let direction = if velocity == 0.0 {
        free_velocity
    } else {
        velocity
    };
    let about = if velocity == 0.0 {
        sign(direction) * f64::MIN_POSITIVE
    } else {
        velocity
    };
    let level = body.friction_n(curve, about);
    // Viscous part trapezoidal, so that the scheme stays second order while it slides.
    let half = 0.5 * curve.viscous_n_s_per_m(direction) * dt_s / mass_kg;
    let free_velocity = free_velocity - half * velocity;
    let impulse = level * dt_s / mass_kg;
    if free_velocity.abs() <= impulse {
        return 0.0;
    }
    (free_velocity - free_velocity.signum() * impulse) / (1.0 + half)
}

#[derive(Clone, Copy)]
struct Bristle {
    stiffness: f64,
    damping: f64,
}

/// A bristle that slides at a velocity: what does not depend on how far it is bent. A sub-step ends
/// with the velocity that the next one begins with: what was computed last is asked for first.
#[derive(Clone, Copy, Debug, PartialEq)]
struct At {
    velocity: f64,
    dt_s: f64,
    factor: f64,
    beside_n: f64,
    sign: f64,
    level_n: f64,
    viscous_n_s_per_m: f64,
    rate_per_s: f64,
    /// Of its way to the end, in half a sub-step, over that rate.
    share_s: f64,
}

impl Default for At {
    /// Of no velocity yet.
    fn default() -> Self {
        Self {
            velocity: f64::NAN,
            dt_s: 0.0,
            factor: 1.0,
            beside_n: 0.0,
            sign: 0.0,
            level_n: 0.0,
            viscous_n_s_per_m: 0.0,
            rate_per_s: 0.0,
            share_s: 0.0,
        }
    }
}

impl At {
    #[expect(
        clippy::inline_always,
        reason = "once a sub-step: a call passes a dozen numbers through memory, 40 of 480 instructions"
    )]
    #[inline(always)]
    fn of(curve: Curve<'_>, stiffness: f64, body: &Body, velocity: f64) -> Self {
        let level_n = body.friction_n(curve, velocity);
        let rate_per_s = stiffness * velocity.abs() / level_n;
        Self {
            velocity,
            dt_s: body.dt_s,
            factor: body.factor,
            beside_n: body.level_n,
            sign: sign(velocity),
            level_n,
            viscous_n_s_per_m: curve.viscous_n_s_per_m(velocity),
            rate_per_s,
            share_s: decayed(rate_per_s, 0.5 * body.dt_s),
        }
    }

    /// Whether it is where a body begins its sub-step.
    fn is_begin_of(&self, curve: Curve<'_>, body: &Body) -> bool {
        self.velocity == body.velocity
            && self.factor == body.factor
            && self.beside_n == body.level_n
            && self.dt_s == body.dt_s
            && !curve.lags()
    }

    /// What rubs the body has changed, or lags; or it was put there.
    #[cold]
    #[inline(never)]
    fn begin(&mut self, curve: Curve<'_>, stiffness: f64, body: &Body) {
        *self = Self::of(curve, stiffness, body, body.velocity);
    }

    /// Solution of `ż = v − r z` after half a sub-step.
    fn relaxed(&self, z: f64) -> f64 {
        z + (self.velocity - self.rate_per_s * z) * self.share_s
    }
}

/// `(1 − exp(−r dt)) / r`.
fn decayed(rate: f64, dt: f64) -> f64 {
    let x = rate * dt;
    if x < 1e-6 {
        dt * (1.0 - 0.5 * x)
    } else {
        -(-x).exp_m1() / rate
    }
}

/// Strang splitting: half a sub-step of the bristle (exact for constant velocity), the body with
/// the part of the bristle force that is linear in its velocity taken implicitly, the other half of
/// the bristle.
fn lugre(curve: Curve<'_>, bristle: Bristle, (z, at): (&mut f64, &mut At), body: &Body) -> f64 {
    let Body {
        velocity,
        free_velocity,
        mass_kg,
        dt_s,
        ..
    } = *body;
    if !at.is_begin_of(curve, body) {
        at.begin(curve, bristle.stiffness, body);
    }
    let bent = at.relaxed(*z);
    // Force σ0 z + σ1 v (1 − sign(v) σ0 z / g) + Fv v: all of it that is proportional to v taken
    // trapezoidal.
    let constant = bristle.stiffness * bent;
    let linear = bristle.damping * (1.0 - at.sign * bristle.stiffness * bent / at.level_n)
        + at.viscous_n_s_per_m;
    let half = 0.5 * linear * dt_s / mass_kg;
    let next = (free_velocity - constant * dt_s / mass_kg - half * velocity) / (1.0 + half);
    *at = At::of(curve, bristle.stiffness, body, next);
    *z = at.relaxed(bent);
    next
}

fn maxwell(
    curve: Curve<'_>,
    stiffness: &[f64],
    share: &[f64],
    deflection: &mut [f64],
    body: Body,
) -> f64 {
    let Body {
        velocity,
        free_velocity,
        mass_kg,
        dt_s,
        ..
    } = body;
    // An element slips at the level of the direction it is deflected in, whatever the body does at
    // the moment.
    let slide = |deflection: &mut [f64], velocity: f64| {
        let (forth, back) = (
            body.friction_n(curve, velocity.abs()),
            body.friction_n(curve, -velocity.abs()),
        );
        let mut force = 0.0;
        for ((k, share), z) in stiffness.iter().zip(share).zip(deflection) {
            *z = (*z + 0.5 * velocity * dt_s).clamp(-share * back / k, share * forth / k);
            force += k * *z;
        }
        force
    };
    let force = slide(deflection, velocity);
    let half = 0.5 * curve.viscous_n_s_per_m(velocity) * dt_s / mass_kg;
    let next = (free_velocity - force * dt_s / mass_kg - half * velocity) / (1.0 + half);
    slide(deflection, next);
    next
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A bristle that goes on from where it was, beside one that remembers nothing: what rubs it
    /// and the length of the sub-step change one at a time, at a velocity that stays.
    #[test]
    fn what_a_bristle_remembers_is_what_it_would_compute() {
        let sliding = Sliding {
            static_n: 150.0,
            viscous_n_s_per_m: 300.0,
            ..Sliding::dry(100.0)
        };
        let law = Law::LuGre {
            bristle_stiffness_n_per_m: 2.0e7,
            bristle_damping_n_s_per_m: 5.0e3,
        };
        let mut remembers = Friction::new(sliding, law);
        let mut forgets = remembers.clone();
        let mut velocity = 1.0e-3;
        for step in 0..400_u32 {
            let changed = |every: u32| {
                if (step / every).is_multiple_of(2) {
                    1.0
                } else {
                    1.5
                }
            };
            let body = Body {
                velocity,
                free_velocity: velocity + 1.0e-5 * (f64::from(step) * 0.05).cos(),
                mass_kg: 300.0,
                dt_s: 6.25e-5 * changed(7),
                factor: changed(5),
                level_n: 20.0 * changed(3),
            };
            forgets.state.at = At::default();
            let next = remembers.advance(body);
            assert_eq!(next, forgets.advance(body), "step {step}");
            assert_eq!(remembers.deflection_m(), forgets.deflection_m());
            velocity = next;
        }
    }
}
