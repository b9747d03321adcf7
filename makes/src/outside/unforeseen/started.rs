//! Sludge, a radio link and a brake: what follows from a rest, a stir or a silence.
//!
//! Sludge sets at rest and is stirred thin (Moore, Trans. British Ceramic Society 58, 1959). The
//! magnet of a holding brake needs its time to draw the armature.

use std::f64::consts::TAU;

use crate::control::Controller;
use crate::control::pi::{Pi, Shape};
use crate::draw::Draw;
use crate::drive::Flaw;
use crate::make::rig;
use crate::mechanics::friction::{Law, Surface};
use crate::mechanics::train::Train;
use crate::motion::Room;
use crate::rig::{Kind, Rig};

/// The rake of a clarifier in clear water, at 250 Hz.
pub(super) fn rake(draw: &mut Draw) -> Rig {
    let inertia = draw.near(1900.0);
    let train = Train::one(inertia, draw.near(140.0), draw.near(350.0));
    let controller = Controller::cascade(inertia, 1.2, 6.0, 4.0e-3);
    let mut rig = rig(Kind::Rotary, train, controller, TAU / 33_554_432.0);
    rig.noisy(6.0);
    rig.moved(
        draw,
        Room::about(1.4, (0.5, 0.5), 70.0),
        [Room::shifts, Room::tracking],
        36.0,
    );
    rig
}

/// Sludge lies on the floor: it is stirred thin over half a turn and sets again within seconds.
pub(super) fn sludge(rig: &mut Rig, draw: &mut Draw) {
    let floor = Law::Thixotropic {
        coulomb: draw.near(90.0),
        surplus: draw.near(2.5),
        sets_in_s: draw.near(4.0),
        way: draw.near(0.4),
    };
    rig.train.surfaces.push(Surface::new(0, floor));
}

/// A shuttle for crates between the rows of an orchard.
pub(super) fn shuttle(draw: &mut Draw) -> Rig {
    let mass = draw.near(85.0);
    let train = Train::one(mass, draw.near(38.0), draw.near(60.0));
    let loops = Pi::of(mass, 1.6, 8.0, Shape::BackCalculation(1.2e3));
    let mut rig = rig(Kind::Linear, train, Controller::pi(loops, 1.0e-3), 2.0e-7);
    rig.noisy(1.5);
    rig.moved(
        draw,
        Room::about(1.2, (1.2, 4.0), 30.0),
        [Room::jogs, Room::shifts],
        15.0,
    );
    rig
}

/// Its commands come by radio, and the link is silent for a moment now and then: the drive goes on
/// with the last command.
pub(super) fn silence(rig: &mut Rig, draw: &mut Draw) {
    rig.drive.flaw = Some(Flaw::Silence(draw.near(0.06), draw.near(0.7)));
}

/// The trolley of a lift for the cleaning of facades, which goes along the roof.
pub(super) fn facade_lift(draw: &mut Draw) -> Rig {
    let mass = draw.near(520.0);
    let train = Train::one(mass, draw.near(130.0), draw.near(240.0));
    let controller = Controller::cascade(mass, 1.5, 8.0, 2.0e-3);
    let mut rig = rig(Kind::Linear, train, controller, 2.0e-7);
    rig.noisy(5.0);
    rig.moved(
        draw,
        Room::about(1.5, (0.5, 0.8), 48.0),
        [Room::shifts, Room::jogs],
        24.0,
    );
    rig
}

/// Its brake closes at every stop and opens half a second after the next start.
pub(super) fn late_brake(rig: &mut Rig, draw: &mut Draw) {
    let brake = Law::Brake {
        holds: draw.near(240.0),
        opens_in_s: draw.near(0.45),
        closes_in_s: 0.02,
    };
    rig.train.surfaces.push(Surface::new(0, brake));
}
