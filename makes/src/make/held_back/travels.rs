//! Doors and shuttles: what carries people and goods, slow to sample and cheap to build.

use crate::control::Controller;
use crate::control::pi::{Pi, Shape};
use crate::draw::Draw;
use crate::make::{Make, Presence, rig};
use crate::mechanics::field::{Drag, Field};
use crate::mechanics::inertia::Inertia;
use crate::mechanics::train::Train;
use crate::motion::Room;
use crate::rig::{Kind, Rig};
use crate::sensing::Noise;
use crate::truth::Effect;

/// The family.
pub const MAKES: &[Make] = &[
    Make {
        name: "platform-door",
        hides: &[Effect::Offset, Effect::ViscousAsymmetry],
        build: platform_door,
    },
    Make {
        name: "tray-shuttle",
        hides: &[Effect::Payload],
        build: tray_shuttle,
    },
];

/// A sliding door with a weight that closes it and a damper that acts one way, at 200 Hz: neither
/// the weight nor the damper's direction is declared.
fn platform_door(draw: &mut Draw, presence: Presence) -> Rig {
    let (mass, viscous) = (draw.near(90.0), draw.near(110.0));
    let weight = presence.size(draw.near(45.0));
    let asymmetry = presence.size(draw.near(0.45));
    let mut train = Train::one(mass, draw.near(30.0), viscous);
    train.fields.push((0, Field::Constant(-weight)));
    train.drags[0] = Drag {
        forward: viscous * (1.0 + asymmetry),
        backward: viscous * (1.0 - asymmetry),
        ..Drag::default()
    };
    let controller = Controller::cascade(mass, 1.2, 7.0, 5.0e-3);
    let mut rig = rig(Kind::Linear, train, controller, 1.0e-6);
    rig.base.retain(|effect| *effect != Effect::Offset);
    rig.noisy(0.8);
    // Held up by the drive: the sign of the constant force against positive motion.
    rig.know("offset", weight, "N");
    rig.know("viscous_asymmetry", asymmetry * viscous, "N s/m");
    rig.moved(
        draw,
        Room::about(0.5, (0.8, 1.2), 70.0),
        [Room::points, Room::workshop],
        35.0,
    );
    rig
}

/// A shuttle of a store that takes up a tray in mid-record and puts it down later, at 500 Hz under
/// a controller in velocity form. Rollers rumble: 1/f noise of the effort.
fn tray_shuttle(draw: &mut Draw, presence: Presence) -> Rig {
    let empty = draw.near(28.0);
    let tray = presence.size(draw.near(12.0));
    let mut train = Train::one(empty, draw.near(32.0), draw.near(40.0));
    train.inertias[0] = Inertia::Payload {
        empty,
        loaded: empty + tray,
        at_s: vec![draw.between(8.0, 10.0), draw.between(24.0, 27.0)],
    };
    let loops = Pi::of(empty, 3.0, 18.0, Shape::VelocityForm(600.0));
    let mut rig = rig(Kind::Linear, train, Controller::pi(loops, 2.0e-3), 2.0e-7);
    rig.sensing.effort.noise = Noise {
        white: 0.5,
        pink: 0.7,
        mains: 0.0,
    };
    rig.know("payload", tray, "kg");
    rig.moved(
        draw,
        Room::about(0.8, (1.4, 5.0), 40.0),
        [Room::points, Room::jogs],
        18.0,
    );
    rig
}
