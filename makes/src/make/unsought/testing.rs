//! Test benches: a box that shears soil, a bench for dampers, an arm that serves balls.
//!
//! A lubricated guide has less friction the faster it slides (Stribeck, VDI-Z. 46, 1902). A car's
//! damper resists more when it is drawn out than when it is pressed together (Dixon, The Shock
//! Absorber Handbook, 2007). Iron that saturates gives u/(1 + k|u|).

use std::f64::consts::TAU;

use crate::control::Controller;
use crate::draw::Draw;
use crate::drive::ConstantRipple;
use crate::make::{Make, Presence, rig};
use crate::mechanics::field::Drag;
use crate::mechanics::friction::{Law, Stribeck};
use crate::mechanics::train::Train;
use crate::motion::{Motion, Programme, Room};
use crate::rig::{EffortColumn, Kind, Rig};
use crate::sensing::{Noise, Rounding};
use crate::truth::Effect;

/// The family.
pub const MAKES: &[Make] = &[
    Make {
        name: "shear-box",
        hides: &[Effect::Stribeck],
        build: shear_box,
    },
    Make {
        name: "damper-bench",
        hides: &[Effect::ViscousAsymmetry, Effect::Delay],
        build: damper_bench,
    },
    Make {
        name: "serving-arm",
        hides: &[Effect::TorqueConstantRipple, Effect::TorqueSaturation],
        build: serving_arm,
    },
];

/// The sledge of a box that shears soil, without soil, at 400 Hz under a lead compensator: its
/// guides grip at creeping speed. Mains is in its log.
fn shear_box(draw: &mut Draw, presence: Presence) -> Rig {
    let (mass, coulomb) = (draw.near(160.0), draw.near(120.0));
    let excess = presence.size_of(Effect::Stribeck, draw.near(0.5));
    let mut train = Train::one(mass, coulomb, draw.near(900.0));
    train.surfaces[0].law = Law::Rigid {
        coulomb,
        stribeck: Some(Stribeck {
            excess,
            velocity: draw.near(0.008),
            exponent: 1.6,
        }),
    };
    let controller = Controller::lead(mass, 9.0, 2.5e-3);
    let mut rig = rig(Kind::Linear, train, controller, 5.0e-8);
    rig.sensing.effort.noise = Noise {
        white: 2.0,
        pink: 0.0,
        mains: 1.5,
    };
    rig.know("stribeck_excess", excess * coulomb, "N");
    rig.moved(
        draw,
        Room::about(0.05, (0.12, 0.9), 36.0),
        [Room::errands, Room::ladder],
        19.0,
    );
    rig
}

/// A bench for dampers on a linear motor, at 8 kHz: the damper in it resists less when it is
/// pressed together, and its commands wait in a gateway for ten cycles.
fn damper_bench(draw: &mut Draw, presence: Presence) -> Rig {
    let (mass, viscous) = (draw.near(22.0), draw.near(320.0));
    let asymmetry = presence.size_of(Effect::ViscousAsymmetry, draw.near(0.3));
    let delay_s = presence.size_of(Effect::Delay, draw.near(1.25e-3));
    let mut train = Train::one(mass, draw.near(24.0), viscous);
    train.drags[0] = Drag {
        forward: viscous * (1.0 + asymmetry),
        backward: viscous * (1.0 - asymmetry),
        ..Drag::default()
    };
    let controller = Controller::cascade(mass, 5.0, 26.0, 1.25e-4);
    let mut rig = rig(Kind::Linear, train, controller, 5.0e-9);
    rig.sensing.motor.rounding = Rounding::Nearest;
    rig.drive.dead_time_s = delay_s;
    rig.noisy(2.0);
    rig.know("viscous_asymmetry", asymmetry * viscous, "N s/m");
    rig.know("delay", delay_s, "s");
    rig.moved(
        draw,
        Room::about(0.06, (0.7, 16.0), 11.0),
        [Room::swells, Room::points],
        7.0,
    );
    rig
}

/// Pole pairs of the serving arm's motor.
const SERVING_POLE_PAIRS: f64 = 5.0;
/// Its torque per ampere, N m/A.
const SERVING_NM_PER_A: f64 = 0.35;

/// The arm that serves balls to tennis players, on its maker's bench without a loop: its pole pairs
/// are uneven, and its iron saturates. In amperes.
fn serving_arm(draw: &mut Draw, presence: Presence) -> Rig {
    let inertia = draw.near(0.3);
    let droop = presence.size_of(Effect::TorqueSaturation, draw.near(0.02));
    let wave = ConstantRipple {
        share: presence.size_of(Effect::TorqueConstantRipple, draw.near(0.08)),
        waves: SERVING_POLE_PAIRS,
        phase: draw.between(0.0, TAU),
    };
    let train = Train::one(inertia, draw.near(0.4), draw.near(0.15));
    let controller = Controller::open(1.0e-3);
    let mut rig = rig(Kind::Rotary, train, controller, TAU / 4_194_304.0);
    rig.column = EffortColumn::Current(1.0 / SERVING_NM_PER_A);
    rig.drive.ripple = Some(wave);
    rig.drive.droop = droop;
    rig.sensing.reference = false;
    rig.noisy(0.05);
    rig.know("torque_constant_ripple", wave.share, "");
    rig.know("torque_constant_ripple_order", SERVING_POLE_PAIRS, "1/rev");
    rig.know("torque_saturation", droop * SERVING_NM_PER_A, "1/A");
    rig.training = (Motion::Effort(Programme::Multisine(6.0, 0.19, 24)), 24.0);
    rig.validation = (Motion::Effort(Programme::Doublets(11.0, 0.35, 8)), 14.0);
    rig
}
