//! Portals and presses: a plasma cutter on racks, the bar that hands blanks from die to die, the
//! screw of an injection moulder.
//!
//! A shaft and its pinions give way like a spring before a heavy portal (Rivin, Stiffness and
//! Damping in Mechanical Design, 1999, ch. 6). Iron that saturates gives u/(1 + k|u|).

use std::f64::consts::TAU;

use crate::control::Controller;
use crate::control::pi::{Pi, Shape};
use crate::draw::Draw;
use crate::make::{Make, Presence, rig};
use crate::mechanics::inertia::Inertia;
use crate::mechanics::joint::Joint;
use crate::mechanics::train::Train;
use crate::motion::Room;
use crate::rig::{EffortColumn, Kind, Rig};
use crate::sensing::{Encoder, Rounding, Stamps};
use crate::truth::Effect;

/// The family.
pub const MAKES: &[Make] = &[
    Make {
        name: "plasma-portal",
        hides: &[Effect::Compliance],
        build: plasma_portal,
    },
    Make {
        name: "transfer-bar",
        hides: &[Effect::Payload],
        build: transfer_bar,
    },
    Make {
        name: "injection-screw",
        hides: &[Effect::TorqueSaturation],
        build: injection_screw,
    },
];

/// Travel of the portal per turn of its motor, through gear and pinion, m.
const PORTAL_LEAD_M: f64 = 0.025;

/// The portal of a plasma cutter on two racks, more than a tonne, at 500 Hz: shaft and pinions give
/// way by tenths of a millimetre. A tape of five micrometres is read on the rail, and the motor's
/// torque is recorded.
fn plasma_portal(draw: &mut Draw, presence: Presence) -> Rig {
    let (gear, portal) = (draw.near(420.0), draw.near(780.0));
    let stiffness = draw.near(6.0e6);
    let [first, last] = [draw.near(90.0), draw.near(180.0)];
    let [fast, slow] = [draw.near(250.0), draw.near(300.0)];
    let soft =
        Train::one(gear, first, fast).then(Joint::stiff(stiffness, 8.0e3), portal, last, slow);
    let bolted = Train::one(gear + portal, first + last, fast + slow);
    let is_soft = presence.has(Effect::Compliance);
    let train = if is_soft { soft } else { bolted };
    let controller = Controller::cascade(gear + portal, 1.1, 5.5, 2.0e-3);
    let mut rig = rig(Kind::Linear, train, controller, 1.0e-6);
    rig.sensing.load = Some(Encoder::of(5.0e-6, Rounding::Down));
    rig.column = EffortColumn::Torque(PORTAL_LEAD_M / TAU);
    rig.stated.lead_m_per_rev = Some(PORTAL_LEAD_M);
    rig.noisy(8.0);
    rig.know("compliance_stiffness", stiffness, "N/m");
    rig.moved(
        draw,
        Room::about(1.1, (0.9, 3.0), 36.0),
        [Room::points, Room::jogs],
        18.0,
    );
    rig
}

/// The bar that hands blanks from die to die, under an integral that is led back at the limit: it
/// takes a row of blanks up and keeps it.
fn transfer_bar(draw: &mut Draw, presence: Presence) -> Rig {
    let empty = draw.near(85.0);
    let blanks = presence.size_of(Effect::Payload, draw.near(32.0));
    let mut train = Train::one(empty, draw.near(55.0), draw.near(130.0));
    train.inertias[0] = Inertia::Payload {
        empty,
        loaded: empty + blanks,
        at_s: vec![draw.between(6.5, 8.5)],
    };
    let loops = Pi::of(empty, 3.5, 18.0, Shape::BackCalculation(3.0e3));
    let mut rig = rig(Kind::Linear, train, Controller::pi(loops, 1.0e-3), 1.0e-7);
    rig.noisy(3.0);
    rig.know("payload", blanks, "kg");
    rig.moved(
        draw,
        Room::about(0.7, (1.5, 7.0), 26.0),
        [Room::raster, Room::points],
        16.0,
    );
    rig
}

/// The screw of an injection moulder with its barrel empty: its motor's iron saturates when it is
/// thrown forward. The drive records its velocity, and one row in three hundred is lost.
fn injection_screw(draw: &mut Draw, presence: Presence) -> Rig {
    let mass = draw.near(620.0);
    let droop = presence.size_of(Effect::TorqueSaturation, draw.near(3.5e-5));
    let train = Train::one(mass, draw.near(700.0), draw.near(2200.0));
    let controller = Controller::cascade(mass, 4.0, 20.0, 1.0e-3);
    let mut rig = rig(Kind::Linear, train, controller, 5.0e-8);
    rig.drive.droop = droop;
    rig.sensing.velocity = Some(1.0e-5);
    rig.sensing.stamps = Stamps {
        lost_share: 0.003,
        ..Stamps::default()
    };
    rig.noisy(15.0);
    rig.know("torque_saturation", droop, "1/N");
    rig.moved(
        draw,
        Room::about(0.16, (0.45, 8.0), 22.0),
        [Room::errands, Room::workshop],
        12.0,
    );
    rig
}
