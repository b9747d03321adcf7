//! Farms: an arm that milks, a boom that sprays.
//!
//! A hose that is drawn along rubs the more of it lies on the floor. A long boom on its gear winds
//! up; a brake band that is wound one way grips more that way (Euler and Eytelwein).

use std::f64::consts::TAU;

use crate::control::Controller;
use crate::control::pi::{Pi, Shape};
use crate::draw::Draw;
use crate::make::{Make, Presence, rig};
use crate::mechanics::friction::Scale;
use crate::mechanics::inertia::Inertia;
use crate::mechanics::joint::Joint;
use crate::mechanics::train::Train;
use crate::motion::Room;
use crate::rig::{Kind, Rig};
use crate::sensing::{Encoder, Noise, Rounding};
use crate::truth::Effect;

/// The family.
pub const MAKES: &[Make] = &[
    Make {
        name: "milking-arm",
        hides: &[Effect::Payload, Effect::PositionDependentFriction],
        build: milking_arm,
    },
    Make {
        name: "spray-boom",
        hides: &[Effect::Compliance, Effect::CoulombAsymmetry],
        build: spray_boom,
    },
];

/// The carriage of a milking robot, at 500 Hz with an integral that is led back at the limit: it
/// takes the cluster of cups off its rest, and draws hoses after it that rub more the further it
/// goes. Rumble of the rollers is 1/f noise.
fn milking_arm(draw: &mut Draw, presence: Presence) -> Rig {
    let (empty, slope) = (draw.near(38.0), draw.near(1.2));
    let cups = presence.size_of(Effect::Payload, draw.near(13.0));
    let slope = presence.size_of(Effect::PositionDependentFriction, slope);
    let mut train = Train::one(empty, draw.near(32.0), draw.near(70.0));
    train.inertias[0] = Inertia::Payload {
        empty,
        loaded: empty + cups,
        at_s: vec![draw.between(7.0, 9.0)],
    };
    train.surfaces[0].scales.push(Scale::Slope(slope));
    let loops = Pi::of(empty, 3.0, 16.0, Shape::BackCalculation(900.0));
    let mut rig = rig(Kind::Linear, train, Controller::pi(loops, 2.0e-3), 2.0e-7);
    rig.sensing.effort.noise = Noise {
        white: 0.6,
        pink: 0.6,
        mains: 0.0,
    };
    rig.know("payload", cups, "kg");
    rig.know("position_dependent_friction_linear", slope, "1/m");
    rig.moved(
        draw,
        Room::about(0.5, (0.9, 5.0), 30.0),
        [Room::shifts, Room::jogs],
        18.0,
    );
    rig
}

/// A wing of a sprayer's boom on its slewing gear, at 250 Hz: a tube of many metres winds up at
/// five hertz, and its band brake drags more on the way out. Encoders sit on gear and tube; no
/// constant torque is declared.
fn spray_boom(draw: &mut Draw, presence: Presence) -> Rig {
    let (gear, boom) = (draw.near(160.0), draw.near(380.0));
    let stiffness = draw.near(4.0e5);
    let [first, last] = [draw.near(30.0), draw.near(80.0)];
    let [fast, slow] = [draw.near(40.0), draw.near(60.0)];
    let asymmetry = presence.size_of(Effect::CoulombAsymmetry, draw.near(0.35));
    let soft = Train::one(gear, first, fast).then(Joint::stiff(stiffness, 1.5e3), boom, last, slow);
    let bolted = Train::one(gear + boom, first, fast + slow);
    let is_soft = presence.has(Effect::Compliance);
    let mut train = if is_soft { soft } else { bolted };
    if is_soft {
        train.surfaces[1].scales.push(Scale::Direction(asymmetry));
    } else {
        let mut of_boom = train.surfaces[0].clone().with(Scale::Direction(asymmetry));
        of_boom.law = of_boom.law.scaled(last / first);
        train.surfaces.push(of_boom);
    }
    let controller = Controller::cascade(gear + boom, 0.5, 2.5, 4.0e-3);
    let mut rig = rig(Kind::Rotary, train, controller, TAU / 33_554_432.0);
    rig.base.retain(|effect| *effect != Effect::Offset);
    rig.sensing.load = Some(Encoder::of(TAU / 524_288.0, Rounding::Nearest));
    rig.noisy(2.5);
    rig.know("compliance_stiffness", stiffness, "N m/rad");
    rig.know("coulomb_asymmetry", asymmetry * last, "N m");
    rig.moved(
        draw,
        Room::about(0.7, (0.5, 0.6), 60.0),
        [Room::points, Room::circles],
        32.0,
    );
    rig
}
