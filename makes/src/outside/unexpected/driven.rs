//! A brake and a drive: what a stair lift and the door of a bus have for people's safety.
//!
//! Weights of a centrifugal brake press on its drum once their springs give way: above a speed, and
//! with its square from there on (Shigley's Mechanical Engineering Design, 2011, ch. 16).

use crate::control::Controller;
use crate::draw::Draw;
use crate::drive::Flaw;
use crate::make::rig;
use crate::mechanics::resistance::Resistance;
use crate::mechanics::train::Train;
use crate::motion::Room;
use crate::rig::{Kind, Rig};

/// The chair of a stair lift on a level rail of its maker's, at 500 Hz.
pub(super) fn stair_lift(draw: &mut Draw) -> Rig {
    let mass = draw.near(140.0);
    let train = Train::one(mass, draw.near(60.0), draw.near(150.0));
    let controller = Controller::cascade(mass, 2.5, 13.0, 2.0e-3);
    let mut rig = rig(Kind::Linear, train, controller, 2.0e-7);
    rig.noisy(2.0);
    rig.moved(
        draw,
        Room::about(1.2, (0.8, 1.8), 40.0),
        [Room::points, Room::shifts],
        20.0,
    );
    rig
}

/// Its safety brake drags above half of its speed.
pub(super) fn centrifugal_brake(rig: &mut Rig, draw: &mut Draw) {
    rig.train.drags[0].resistance = Some(Resistance::Centrifugal {
        quadratic: draw.near(700.0),
        velocity: draw.between(0.35, 0.45),
    });
}

/// A wing of the door of a bus, on its belt.
pub(super) fn bus_door(draw: &mut Draw) -> Rig {
    let mass = draw.near(34.0);
    let train = Train::one(mass, draw.near(28.0), draw.near(60.0));
    let controller = Controller::cascade(mass, 0.8, 3.5, 1.0e-3);
    let mut rig = rig(Kind::Linear, train, controller, 2.0e-7);
    rig.noisy(0.8);
    rig.moved(
        draw,
        Room::about(0.45, (0.8, 2.4), 28.0),
        [Room::jogs, Room::workshop],
        14.0,
    );
    rig
}

/// Its drive lets the force grow and fall by so much a second, lest it hurts somebody; the command
/// is what is recorded.
pub(super) fn ramp(rig: &mut Rig, draw: &mut Draw) {
    rig.drive.flaw = Some(Flaw::Ramp(draw.near(4500.0)));
}
