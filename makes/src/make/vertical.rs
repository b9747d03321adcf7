//! Vertical axes: gravity is most of the effort.
//!
//! Ten times friction and more: what is judged as a share of the effort with its mean in it looks
//! good here without being so.

use crate::control::Controller;
use crate::draw::Draw;
use crate::make::{Make, Presence, rig};
use crate::mechanics::field::{Drag, Field};
use crate::mechanics::friction::{Law, Scale, Stribeck};
use crate::mechanics::train::Train;
use crate::motion::Room;
use crate::rig::{Kind, Rig};
use crate::truth::Effect;

/// The family.
pub const MAKES: &[Make] = &[
    Make {
        name: "counterbalanced-ram",
        hides: &[Effect::ViscousAsymmetry],
        build: counterbalanced_ram,
    },
    Make {
        name: "hanging-ram",
        hides: &[Effect::Stribeck, Effect::FrictionDrift],
        build: hanging_ram,
    },
    Make {
        name: "unbalanced-quill",
        hides: &[Effect::Offset],
        build: unbalanced_quill,
    },
    Make {
        name: "wiper-lopsided",
        hides: &[Effect::Offset],
        build: wiper_lopsided,
    },
];

/// Standard gravity, m/s².
const GRAVITY_M_S2: f64 = 9.806_65;

fn room(half_m: f64, duration_s: f64) -> Room {
    Room::about(half_m, (0.3, 2.0), duration_s)
}

fn hanging(mass: f64, coulomb: f64, viscous: f64, carried: f64) -> Train {
    let mut train = Train::one(mass, coulomb, viscous);
    let weight = mass * GRAVITY_M_S2 * (1.0 - carried);
    train.fields.push((0, Field::Constant(-weight)));
    train
}

/// A ram of two hundred kilograms whose counterbalance valve throttles one way: viscous friction
/// by direction beside gravity of ten times Coulomb's.
fn counterbalanced_ram(draw: &mut Draw, presence: Presence) -> Rig {
    let (mass, viscous) = (draw.near(200.0), draw.near(900.0));
    let asymmetry = presence.size(draw.near(0.35));
    let mut train = hanging(mass, draw.near(110.0), viscous, 0.4);
    train.drags[0] = Drag {
        forward: viscous * (1.0 + asymmetry),
        backward: viscous * (1.0 - asymmetry),
        ..Drag::default()
    };
    let controller = Controller::cascade(mass, 5.0, 28.0, 1.0e-3);
    let mut rig = rig(Kind::Linear, train, controller, 1.0e-7);
    rig.stated.controller = true;
    rig.noisy(3.0);
    rig.know("viscous_asymmetry", asymmetry * viscous, "N s/m");
    rig.moved(draw, room(0.2, 26.0), [Room::points, Room::circles], 12.0);
    rig
}

/// A ram that hangs free: gravity twelve times friction, which falls with speed and warms up.
fn hanging_ram(draw: &mut Draw, presence: Presence) -> Rig {
    let (mass, coulomb) = (draw.near(85.0), draw.near(70.0));
    let (excess, surplus) = (draw.near(0.6), draw.near(0.5));
    let mut train = hanging(mass, coulomb, draw.near(160.0), 0.0);
    train.surfaces[0].law = Law::Rigid {
        coulomb,
        stribeck: Some(Stribeck {
            excess: presence.size(excess),
            velocity: draw.near(0.012),
            exponent: 2.0,
        }),
    };
    train.surfaces[0].scales.push(Scale::WarmUp {
        surplus: presence.size(surplus),
        time_constant_s: draw.near(8.0),
    });
    let controller = Controller::state_feedback(mass, 9.0, 1.0e-3);
    let mut rig = rig(Kind::Linear, train, controller, 2.0e-7);
    rig.noisy(1.2);
    rig.know("stribeck_excess", presence.size(excess * coulomb), "N");
    rig.know("friction_drift_gain", presence.size(surplus), "");
    rig.moved(draw, room(0.15, 30.0), [Room::workshop, Room::jogs], 20.0);
    rig
}

/// A drill quill whose balance spring has gone: nobody declared a constant force.
fn unbalanced_quill(draw: &mut Draw, presence: Presence) -> Rig {
    let mass = draw.near(18.0);
    let carried = presence.or(draw.near(0.7), 1.0);
    let train = hanging(mass, draw.near(25.0), draw.near(60.0), carried);
    let mut rig = rig(
        Kind::Linear,
        train,
        Controller::pid(mass, 15.0, 1.0e-3),
        5.0e-7,
    );
    rig.base.retain(|effect| *effect != Effect::Offset);
    rig.noisy(0.5);
    rig.know("offset", mass * GRAVITY_M_S2 * (1.0 - carried), "N");
    rig.moved(draw, room(0.08, 25.0), [Room::jogs, Room::points], 12.0);
    rig
}

/// A wiper that leans: Coulomb friction by direction, the same force as an offset, and at 250 Hz.
fn wiper_lopsided(draw: &mut Draw, presence: Presence) -> Rig {
    let (mass, coulomb) = (draw.near(70.0), draw.near(65.0));
    let asymmetry = presence.size(draw.near(0.3));
    let mut train = Train::one(mass, coulomb, draw.near(130.0));
    train.surfaces[0].scales.push(Scale::Direction(asymmetry));
    let controller = Controller::cascade(mass, 2.5, 14.0, 4.0e-3);
    let mut rig = rig(Kind::Linear, train, controller, 1.0e-6);
    rig.base.retain(|effect| *effect != Effect::Offset);
    rig.noisy(0.8);
    rig.know("offset", asymmetry * coulomb, "N");
    rig.moved(draw, room(0.2, 60.0), [Room::workshop, Room::waves], 25.0);
    rig
}
