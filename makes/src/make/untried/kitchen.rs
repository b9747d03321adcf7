//! Field and bakery: a spout that throws chaff, a peel that carries loaves.
//!
//! Grease in the cold is stiff and gives way as it is worked (Lugt, Grease Lubrication in Rolling
//! Bearings, 2013). A telescope that is drawn out leans on its last rollers by a lever that grows
//! with its length.

use std::f64::consts::TAU;

use crate::control::Controller;
use crate::control::pi::{Pi, Shape};
use crate::draw::Draw;
use crate::make::{Make, Presence, rig};
use crate::mechanics::field::WarmOil;
use crate::mechanics::friction::Scale;
use crate::mechanics::joint::Joint;
use crate::mechanics::train::Train;
use crate::motion::Room;
use crate::rig::{Kind, Rig};
use crate::sensing::{Encoder, Rounding};
use crate::truth::Effect;

/// The family.
pub const MAKES: &[Make] = &[
    Make {
        name: "forage-spout",
        hides: &[Effect::Backlash, Effect::FrictionDrift],
        build: forage_spout,
    },
    Make {
        name: "oven-peel",
        hides: &[Effect::PositionDependentFriction],
        build: oven_peel,
    },
];

/// The spout of a forage harvester on its worm, at 500 Hz: a third of a degree of play, and grease
/// of a cold morning in both bearings. Encoders sit on gear and spout, wind-up is declared, and one
/// row in a hundred is lost on the vehicle's bus.
fn forage_spout(draw: &mut Draw, presence: Presence) -> Rig {
    let (gear, spout) = (draw.near(1.2), draw.near(2.6));
    let stiffness = draw.near(8.0e5);
    let gap = presence.size_of(Effect::Backlash, draw.near(5.0e-3));
    let surplus = presence.size_of(Effect::FrictionDrift, draw.near(0.7));
    let time_constant_s = draw.near(9.0);
    let joint = Joint {
        gap,
        ..Joint::stiff(stiffness, 700.0)
    };
    let mut train = Train::one(gear, draw.near(4.0), draw.near(2.0)).then(
        joint,
        spout,
        draw.near(16.0),
        draw.near(4.0),
    );
    for surface in &mut train.surfaces {
        surface.scales.push(Scale::WarmUp {
            surplus,
            time_constant_s,
        });
    }
    for drag in &mut train.drags {
        drag.oil = Some(WarmOil {
            surplus,
            time_constant_s,
        });
    }
    let controller = Controller::cascade(gear + spout, 2.0, 12.0, 2.0e-3);
    let mut rig = rig(Kind::Rotary, train, controller, TAU / 8_388_608.0);
    rig.sensing.load = Some(Encoder::of(TAU / 262_144.0, Rounding::Nearest));
    rig.sensing.stamps.lost_share = 0.01;
    rig.declare(Effect::Compliance);
    rig.noisy(0.15);
    rig.know("backlash_gap", gap, "rad");
    rig.know("compliance_stiffness", stiffness, "N m/rad");
    rig.know("friction_drift_gain", surplus, "");
    rig.know("friction_drift_time_constant", time_constant_s, "s");
    rig.moved(
        draw,
        Room::about(1.1, (1.2, 4.0), 40.0),
        [Room::errands, Room::jogs],
        22.0,
    );
    rig
}

/// The telescopic peel that puts loaves into an oven: the farther out, the heavier its rollers run.
/// A gain that is scheduled, and no recorded setpoint.
fn oven_peel(draw: &mut Draw, presence: Presence) -> Rig {
    let mass = draw.near(35.0);
    let slope = presence.size_of(Effect::PositionDependentFriction, draw.near(0.7));
    let mut train = Train::one(mass, draw.near(30.0), draw.near(25.0));
    train.surfaces[0].scales.push(Scale::Slope(slope));
    let shape = Shape::Scheduled {
        extra: 0.5,
        knee: 0.2,
    };
    let loops = Pi::of(mass, 4.0, 22.0, shape);
    let mut rig = rig(Kind::Linear, train, Controller::pi(loops, 1.0e-3), 1.0e-7);
    rig.sensing.reference = false;
    rig.noisy(0.8);
    rig.know("position_dependent_friction_linear", slope, "1/m");
    rig.moved(
        draw,
        Room::about(0.8, (1.3, 4.0), 28.0),
        [Room::errands, Room::points],
        14.0,
    );
    rig
}
