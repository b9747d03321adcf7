//! Axes without a position loop: an effort is applied and the axis goes where it goes.
//!
//! Chirps and steps are what a laboratory applies (Ljung, System Identification, 1999, ch. 13).
//! There is no setpoint to simulate from.

use std::f64::consts::TAU;

use crate::control::Controller;
use crate::draw::Draw;
use crate::make::{Make, Presence, rig};
use crate::mechanics::field::Field;
use crate::mechanics::friction::Law;
use crate::mechanics::train::Train;
use crate::motion::{Motion, Programme};
use crate::rig::{Kind, Rig};
use crate::truth::Effect;

/// The family.
pub const MAKES: &[Make] = &[
    Make {
        name: "fan-spindle",
        hides: &[Effect::QuadraticDrag],
        build: fan_spindle,
    },
    Make {
        name: "bench-rotor",
        hides: &[Effect::TorqueRipple],
        build: bench_rotor,
    },
    Make {
        name: "late-bench",
        hides: &[Effect::Delay],
        build: late_bench,
    },
];

/// A small spindle with a fan wheel, 10⁻⁵ kg m², driven by steps of torque: drag with velocity
/// squared. Its Coulomb friction is a steep tanh.
fn fan_spindle(draw: &mut Draw, presence: Presence) -> Rig {
    let (inertia, coulomb) = (draw.near(1.2e-5), draw.near(1.5e-3));
    let quadratic = presence.size(draw.near(1.2e-7));
    let mut train = Train::one(inertia, coulomb, draw.near(6.0e-6));
    // At rest the steep law is of 10⁻³ s: fifty steps of the integration.
    train.surfaces[0].law = Law::Smooth { coulomb, knee: 0.1 };
    train.drags[0].quadratic = quadratic;
    let mut rig = rig(
        Kind::Rotary,
        train,
        Controller::open(1.0e-3),
        TAU / 65_536.0,
    );
    rig.sensing.reference = false;
    rig.noisy(2.0e-5);
    rig.know("quadratic_drag", quadratic, "N m s2/rad2");
    let steps = |seed| Motion::Effort(Programme::Steps(0.009, 1.0, seed));
    rig.training = (steps(1), 28.0);
    rig.validation = (steps(2), 12.0);
    rig
}

/// A rotor on a test bench under a chirp of torque that turns it over and over: cogging shows
/// where it is slow.
fn bench_rotor(draw: &mut Draw, presence: Presence) -> Rig {
    let inertia = draw.near(3.0e-3);
    let amplitude = presence.size(draw.near(0.02));
    let mut train = Train::one(inertia, draw.near(0.06), draw.near(2.5e-3));
    let cogging = Field::Cogging {
        amplitude,
        waves: 8.0,
        phase: draw.between(0.0, TAU),
    };
    train.fields.push((0, cogging));
    let mut rig = rig(
        Kind::Rotary,
        train,
        Controller::open(5.0e-4),
        TAU / 262_144.0,
    );
    rig.sensing.reference = false;
    rig.noisy(5.0e-4);
    rig.know("torque_ripple_amplitude", amplitude, "N m");
    rig.know("torque_ripple_order", 8.0, "1/rev");
    rig.training = (Motion::Effort(Programme::Chirp(0.17, 0.4, 3.0, 7.5)), 15.0);
    rig.validation = (Motion::Effort(Programme::Steps(0.16, 0.7, 3)), 8.0);
    rig
}

/// A bench whose amplifier sits behind a slow bus: 0.8 ms until a torque acts.
fn late_bench(draw: &mut Draw, presence: Presence) -> Rig {
    let inertia = draw.near(0.02);
    let delay_s = presence.size(draw.near(8.0e-4));
    let train = Train::one(inertia, draw.near(0.08), draw.near(0.02));
    let mut rig = rig(
        Kind::Rotary,
        train,
        Controller::open(1.0e-3),
        TAU / 1_048_576.0,
    );
    rig.drive.dead_time_s = delay_s;
    rig.sensing.reference = false;
    rig.noisy(2.0e-3);
    rig.know("delay", delay_s, "s");
    rig.training = (Motion::Effort(Programme::Chirp(0.6, 0.5, 12.0, 8.0)), 24.0);
    rig.validation = (Motion::Effort(Programme::Steps(0.5, 0.3, 5)), 10.0);
    rig
}
