//! Places: kitchens and canneries, where friction is not the same everywhere.
//!
//! A worn rail grips at one place, a disc that is out of round with every turn of it; dough and
//! grease carry the more the faster they slide, with an exponent below one (Bo and Pavelescu, Wear
//! 82, 1982).

use std::f64::consts::TAU;

use crate::control::Controller;
use crate::draw::Draw;
use crate::make::{Make, Presence, rig};
use crate::mechanics::friction::{Law, Scale, Stribeck};
use crate::mechanics::train::Train;
use crate::motion::Room;
use crate::rig::{EffortColumn, Kind, Rig};
use crate::truth::Effect;

/// The family.
pub const MAKES: &[Make] = &[
    Make {
        name: "kneading-hook",
        hides: &[Effect::Stribeck, Effect::PositionDependentFriction],
        build: kneading_hook,
    },
    Make {
        name: "retort-basket",
        hides: &[Effect::PositionDependentFriction],
        build: retort_basket,
    },
];

/// Torque of the hook per ampere of its motor, N m/A.
const HOOK_NM_PER_A: f64 = 2.4;

/// The hook of a kneader that tests dough, swung to and fro at 1 kHz: its felt seal is out of round
/// by two waves a turn, and sticks with an exponent of seven tenths. In amperes of the drive.
fn kneading_hook(draw: &mut Draw, presence: Presence) -> Rig {
    let (inertia, coulomb) = (draw.near(0.35), draw.near(4.0));
    let excess = presence.size_of(Effect::Stribeck, draw.near(0.9));
    let felt = Scale::Wavy {
        share: presence.size_of(Effect::PositionDependentFriction, draw.near(0.35)),
        waves: 2.0,
        phase: draw.between(0.0, TAU),
    };
    let mut train = Train::one(inertia, coulomb, draw.near(0.8));
    train.surfaces[0].law = Law::Rigid {
        coulomb,
        stribeck: Some(Stribeck {
            excess,
            velocity: draw.near(0.15),
            exponent: 0.7,
        }),
    };
    train.surfaces[0].scales.push(felt);
    let controller = Controller::pid(inertia, 9.0, 2.5e-4);
    let mut rig = rig(Kind::Rotary, train, controller, TAU / 8_388_608.0);
    rig.column = EffortColumn::Current(1.0 / HOOK_NM_PER_A);
    rig.logs_current(4);
    rig.noisy(0.04);
    rig.know("stribeck_excess", excess * coulomb / HOOK_NM_PER_A, "A");
    rig.moved(
        draw,
        Room::about(3.0, (4.0, 16.0), 30.0),
        [Room::errands, Room::ladder],
        20.0,
    );
    rig
}

/// The carriage that draws baskets out of a cannery's retort, at 250 Hz: where the door's sill is,
/// its rails are dirty over some decimetres.
fn retort_basket(draw: &mut Draw, presence: Presence) -> Rig {
    let (mass, coulomb) = (draw.near(1900.0), draw.near(900.0));
    let sill = Scale::Bump {
        centre: draw.between(0.25, 0.4),
        width: draw.near(0.22),
        share: presence.size_of(Effect::PositionDependentFriction, draw.near(0.7)),
    };
    let mut train = Train::one(mass, coulomb, draw.near(1200.0));
    train.surfaces[0].scales.push(sill);
    let controller = Controller::cascade(mass, 1.2, 6.0, 4.0e-3);
    let mut rig = rig(Kind::Linear, train, controller, 1.0e-6);
    rig.stated.controller = true;
    rig.noisy(12.0);
    rig.moved(
        draw,
        Room::about(1.2, (0.7, 0.9), 64.0),
        [Room::points, Room::weaving],
        40.0,
    );
    rig
}
