//! A burr, hoses and a flap: what holds back by direction or by where it came from.

use crate::control::Controller;
use crate::control::pi::{Pi, Shape};
use crate::draw::Draw;
use crate::make::rig;
use crate::mechanics::friction::{Law, Scale, Surface};
use crate::mechanics::resistance::Resistance;
use crate::mechanics::train::Train;
use crate::motion::Room;
use crate::rig::{Kind, Rig};

/// What pulls a kitchen's drawer out and pushes it in, some ten thousand times, with a new drawer.
pub(super) fn drawer(draw: &mut Draw) -> Rig {
    let mass = draw.near(26.0);
    let train = Train::one(mass, draw.near(24.0), draw.near(40.0));
    let controller = Controller::lead(mass, 8.0, 1.0e-3);
    let mut rig = rig(Kind::Linear, train, controller, 1.0e-7);
    rig.noisy(0.6);
    rig.moved(
        draw,
        Room::about(0.22, (0.5, 3.0), 28.0),
        [Room::points, Room::strokes],
        14.0,
    );
    rig
}

/// Level of the burr's surface where there is no burr, N: nothing to speak of.
const NO_BURR_N: f64 = 0.05;

/// A burr has grown on a rail: it catches on the way out and is slid over on the way back.
pub(super) fn burr(rig: &mut Rig, draw: &mut Draw) {
    let catches = Scale::Bump {
        centre: draw.between(-0.05, 0.05),
        width: draw.near(0.035),
        share: draw.near(28.0) / NO_BURR_N,
    };
    let surface = Surface::new(0, Law::coulomb(NO_BURR_N));
    let surface = surface.with(catches).with(Scale::Direction(1.0));
    rig.train.surfaces.push(surface);
}

/// A stand that carries an X-ray tube along the ceiling, with its hoses taken off.
pub(super) fn ceiling_stand(draw: &mut Draw) -> Rig {
    let mass = draw.near(180.0);
    let train = Train::one(mass, draw.near(55.0), draw.near(130.0));
    let controller = Controller::cascade(mass, 2.5, 14.0, 2.0e-3);
    let mut rig = rig(Kind::Linear, train, controller, 1.0e-7);
    rig.noisy(2.0);
    rig.moved(
        draw,
        Room::about(0.9, (0.8, 1.6), 40.0),
        [Room::errands, Room::waves],
        20.0,
    );
    rig
}

/// The hoses hang in a loop: bending them takes a force that builds up over decimetres after every
/// reversal, and stays when the stand does.
pub(super) fn hoses(rig: &mut Rig, draw: &mut Draw) {
    let coulomb = draw.near(60.0);
    let bundle = Law::Dahl {
        coulomb,
        stiffness: coulomb / draw.near(0.25),
    };
    rig.train.surfaces.push(Surface::new(0, bundle));
}

/// The paddle of a flume for waves, in an empty flume, at 500 Hz.
pub(super) fn paddle(draw: &mut Draw) -> Rig {
    let mass = draw.near(240.0);
    let train = Train::one(mass, draw.near(70.0), draw.near(150.0));
    let loops = Pi::of(mass, 2.5, 13.0, Shape::VelocityForm(4.0e3));
    let mut rig = rig(Kind::Linear, train, Controller::pi(loops, 2.0e-3), 1.0e-7);
    rig.noisy(2.5);
    rig.moved(
        draw,
        Room::about(0.8, (0.9, 2.0), 36.0),
        [Room::packets, Room::strokes],
        18.0,
    );
    rig
}

/// The flume is full, and a flap in the paddle opens when it is drawn back.
pub(super) fn flap(rig: &mut Rig, draw: &mut Draw) {
    rig.train.drags[0].resistance = Some(Resistance::Flap(draw.near(420.0)));
}
