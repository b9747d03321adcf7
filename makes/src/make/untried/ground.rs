//! Rock and clay: the feed of a drill, what pushes cars into a kiln.
//!
//! A throttle check valve lets the oil of a feed cylinder out slowly and in freely (Merritt,
//! Hydraulic Control Systems, 1967, ch. 3). Flanks of a nut rub with what they carry (Olofsson and
//! Ekerfors, Wear 155, 1992).

use crate::control::Controller;
use crate::draw::Draw;
use crate::make::{Make, Presence, rig};
use crate::mechanics::field::Drag;
use crate::mechanics::friction::Scale;
use crate::mechanics::inertia::Inertia;
use crate::mechanics::train::Train;
use crate::motion::Room;
use crate::rig::{EffortColumn, Kind, Rig};
use crate::sensing::Noise;
use crate::truth::Effect;

/// The family.
pub const MAKES: &[Make] = &[
    Make {
        name: "rock-drill-feed",
        hides: &[Effect::ViscousAsymmetry, Effect::PositionDependentFriction],
        build: rock_drill_feed,
    },
    Make {
        name: "kiln-pusher",
        hides: &[Effect::LoadDependentFriction, Effect::Payload],
        build: kiln_pusher,
    },
];

/// The feed beam of a drill in a mine, at 400 Hz: its oil is throttled on the way in, the beam is
/// bent at one place, and the pressure sensors that stand for the force have 1/f noise.
fn rock_drill_feed(draw: &mut Draw, presence: Presence) -> Rig {
    let (mass, viscous) = (draw.near(320.0), draw.near(620.0));
    let asymmetry = presence.size_of(Effect::ViscousAsymmetry, draw.near(0.45));
    let bend = Scale::Bump {
        centre: draw.between(-0.3, 0.3),
        width: draw.near(0.3),
        share: presence.size_of(Effect::PositionDependentFriction, draw.near(1.0)),
    };
    let mut train = Train::one(mass, draw.near(240.0), viscous);
    train.surfaces[0].scales.push(bend);
    train.drags[0] = Drag {
        forward: viscous * (1.0 + asymmetry),
        backward: viscous * (1.0 - asymmetry),
        ..Drag::default()
    };
    let controller = Controller::rejecting(mass, 3.0, 2.5e-3);
    let mut rig = rig(Kind::Linear, train, controller, 2.0e-7);
    rig.sensing.effort.noise = Noise {
        white: 5.0,
        pink: 5.0,
        mains: 0.0,
    };
    rig.know("viscous_asymmetry", asymmetry * viscous, "N s/m");
    rig.moved(
        draw,
        Room::about(1.1, (0.9, 2.5), 46.0),
        [Room::errands, Room::points],
        24.0,
    );
    rig
}

/// Force of the pusher's motor per ampere, N/A.
const PUSHER_N_PER_A: f64 = 60.0;

/// What pushes cars with bricks into a kiln, on a trapezoidal thread: it grips a car after a third
/// of the record. The current is recorded.
fn kiln_pusher(draw: &mut Draw, presence: Presence) -> Rig {
    let (empty, coulomb) = (draw.near(260.0), draw.near(130.0));
    let share = presence.size_of(Effect::LoadDependentFriction, draw.near(0.2) / coulomb);
    let car = presence.size_of(Effect::Payload, draw.near(150.0));
    let mut train = Train::one(empty, coulomb, draw.near(200.0));
    train.surfaces[0].scales.push(Scale::Load(share));
    train.inertias[0] = Inertia::Payload {
        empty,
        loaded: empty + car,
        at_s: vec![draw.between(9.0, 11.0)],
    };
    let controller = Controller::state_feedback(empty, 6.0, 1.0e-3);
    let mut rig = rig(Kind::Linear, train, controller, 1.0e-7);
    rig.column = EffortColumn::Current(1.0 / PUSHER_N_PER_A);
    rig.noisy(4.0);
    rig.know("load_dependent_friction", share * coulomb, "");
    rig.know("payload", car / PUSHER_N_PER_A, "A s2/m");
    rig.moved(
        draw,
        Room::about(0.6, (0.7, 5.0), 32.0),
        [Room::points, Room::packets],
        20.0,
    );
    rig
}
