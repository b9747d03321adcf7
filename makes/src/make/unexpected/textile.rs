//! Textile machines: the carriage of a flat knitter, the frame of an embroiderer.
//!
//! A cam box raises needles on one of its ways and lowers them on the other. Cloth that hangs over
//! the edge of a table rubs the more of it hangs there. Iron that saturates gives u/(1 + k|u|).

use crate::control::Controller;
use crate::control::pi::{Pi, Shape};
use crate::draw::Draw;
use crate::make::{Make, Presence, rig};
use crate::mechanics::friction::Scale;
use crate::mechanics::train::Train;
use crate::motion::Room;
use crate::rig::{EffortColumn, Kind, Rig};
use crate::truth::Effect;

/// The family.
pub const MAKES: &[Make] = &[
    Make {
        name: "knitting-carriage",
        hides: &[Effect::CoulombAsymmetry],
        build: knitting_carriage,
    },
    Make {
        name: "embroidery-frame",
        hides: &[
            Effect::Delay,
            Effect::TorqueSaturation,
            Effect::PositionDependentFriction,
        ],
        build: embroidery_frame,
    },
];

/// Radius of the pulley that draws the knitting carriage, m.
const KNITTER_PULLEY_M: f64 = 0.03;

/// The carriage of a flat knitter on its belt, under PID: its cams raise needles on the way out.
/// The motor's torque is recorded, and no constant torque is declared.
fn knitting_carriage(draw: &mut Draw, presence: Presence) -> Rig {
    let (mass, coulomb) = (draw.near(16.0), draw.near(26.0));
    let asymmetry = presence.size_of(Effect::CoulombAsymmetry, draw.near(0.3));
    let mut train = Train::one(mass, coulomb, draw.near(20.0));
    train.surfaces[0].scales.push(Scale::Direction(asymmetry));
    let controller = Controller::pid(mass, 7.0, 1.0e-3);
    let mut rig = rig(Kind::Linear, train, controller, 5.0e-7);
    rig.base.retain(|effect| *effect != Effect::Offset);
    rig.column = EffortColumn::Torque(KNITTER_PULLEY_M);
    rig.noisy(0.7);
    let asymmetry_nm = asymmetry * coulomb * KNITTER_PULLEY_M;
    rig.know("coulomb_asymmetry", asymmetry_nm, "N m");
    rig.moved(
        draw,
        Room::about(0.6, (1.2, 7.0), 26.0),
        [Room::strokes, Room::raster],
        14.0,
    );
    rig
}

/// The frame that carries the cloth of an embroiderer from stitch to stitch, under a controller in
/// velocity form: its small motors saturate, a command waits for some cycles, and the cloth rubs
/// the more of it hangs over the table's edge.
fn embroidery_frame(draw: &mut Draw, presence: Presence) -> Rig {
    let (mass, coulomb) = (draw.near(7.0), draw.near(10.0));
    let delay_s = presence.size_of(Effect::Delay, draw.near(4.0e-3));
    let droop = presence.size_of(Effect::TorqueSaturation, draw.near(2.0e-3));
    let slope = presence.size_of(Effect::PositionDependentFriction, draw.near(1.6));
    let mut train = Train::one(mass, coulomb, draw.near(18.0));
    train.surfaces[0].scales.push(Scale::Slope(slope));
    let loops = Pi::of(mass, 2.6, 13.0, Shape::VelocityForm(260.0));
    let mut rig = rig(Kind::Linear, train, Controller::pi(loops, 1.0e-3), 1.0e-7);
    rig.drive.dead_time_s = delay_s;
    rig.drive.droop = droop;
    rig.noisy(0.3);
    rig.know("delay", delay_s, "s");
    rig.know("torque_saturation", droop, "1/N");
    rig.know("position_dependent_friction_linear", slope, "1/m");
    rig.moved(
        draw,
        Room::about(0.28, (0.7, 9.0), 26.0),
        [Room::jogs, Room::weaving],
        14.0,
    );
    rig
}
