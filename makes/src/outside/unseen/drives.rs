//! Drives that do not give what they are asked for.

use std::f64::consts::TAU;

use crate::control::Controller;
use crate::control::pi::{Pi, Shape};
use crate::draw::Draw;
use crate::drive::Flaw;
use crate::make::rig;
use crate::mechanics::field::Field;
use crate::mechanics::train::Train;
use crate::motion::Room;
use crate::rig::{EffortColumn, Kind, Rig};

/// The arm that holds an electrode over a furnace, balanced but for a rest, at 500 Hz.
pub(super) fn electrode(draw: &mut Draw) -> Rig {
    let mass = draw.near(260.0);
    let mut train = Train::one(mass, draw.near(150.0), draw.near(420.0));
    train.fields.push((0, Field::Constant(-draw.near(280.0))));
    let loops = Pi::of(mass, 3.0, 16.0, Shape::BackCalculation(6000.0));
    let mut rig = rig(Kind::Linear, train, Controller::pi(loops, 2.0e-3), 1.0e-7);
    rig.noisy(3.0);
    rig.moved(
        draw,
        Room::about(0.3, (0.5, 2.0), 40.0),
        [Room::workshop, Room::points],
        20.0,
    );
    rig
}

/// The arc pulls the supply down and lets it go, a little more than once a second.
pub(super) fn flickering(rig: &mut Rig, draw: &mut Draw) {
    rig.drive.flaw = Some(Flaw::Flicker(draw.near(0.22), draw.near(1.3)));
}

/// A cylinder behind a new servo valve, whose current stands for its force.
pub(super) fn spool(draw: &mut Draw) -> Rig {
    let mass = draw.near(42.0);
    let train = Train::one(mass, draw.near(48.0), draw.near(300.0));
    let controller = Controller::cascade(mass, 3.5, 20.0, 5.0e-4);
    let mut rig = rig(Kind::Linear, train, controller, 5.0e-8);
    rig.column = EffortColumn::Current(1.0 / 30.0);
    rig.noisy(1.0);
    rig.moved(
        draw,
        Room::about(0.12, (0.3, 3.0), 18.0),
        [Room::circles, Room::jogs],
        9.0,
    );
    rig
}

/// Varnish on the spool.
pub(super) fn sticking(rig: &mut Rig, draw: &mut Draw) {
    rig.drive.flaw = Some(Flaw::Play(draw.near(40.0)));
}

/// An electrode's slide of a spot-welding gun, in torque of its motor.
pub(super) fn gun(draw: &mut Draw) -> Rig {
    let mass = draw.near(22.0);
    let train = Train::one(mass, draw.near(30.0), draw.near(110.0));
    let controller = Controller::sliding(mass, 9.0, 400.0, 1.0e-3);
    let mut rig = rig(Kind::Linear, train, controller, 1.0e-7);
    rig.column = EffortColumn::Torque(0.01 / TAU);
    rig.stated.lead_m_per_rev = Some(0.01);
    rig.noisy(0.6);
    rig.moved(
        draw,
        Room::about(0.15, (0.6, 8.0), 26.0),
        [Room::strokes, Room::points],
        13.0,
    );
    rig
}

/// Three quarters of what is asked for at most, and no message.
pub(super) fn clipped(rig: &mut Rig, _: &mut Draw) {
    let asked = rig.train.inertia() * 8.0 + rig.train.coulomb();
    rig.drive.flaw = Some(Flaw::Limit(0.75 * asked));
}
