//! A battery and a worm: a cart for luggage, what spaces bottles.
//!
//! The voltage of a battery falls with what has been drawn from it of late, and comes back
//! (Plett, Battery Management Systems, 2015, ch. 2). The pitch of a worm that spaces bottles grows,
//! so that they are brought up to the speed of the line.

use std::f64::consts::TAU;

use crate::control::Controller;
use crate::control::pi::{Pi, Shape};
use crate::draw::Draw;
use crate::drive::Flaw;
use crate::make::rig;
use crate::mechanics::field::Field;
use crate::mechanics::train::Train;
use crate::motion::Room;
use crate::rig::{Kind, Rig};

/// A cart that brings luggage to the gate, on its maker's track and on its charger, at 250 Hz.
pub(super) fn luggage_cart(draw: &mut Draw) -> Rig {
    let mass = draw.near(150.0);
    let train = Train::one(mass, draw.near(46.0), draw.near(75.0));
    let controller = Controller::cascade(mass, 1.4, 7.0, 4.0e-3);
    let mut rig = rig(Kind::Linear, train, controller, 5.0e-7);
    rig.noisy(2.5);
    rig.moved(
        draw,
        Room::about(2.6, (1.8, 1.5), 44.0),
        [Room::errands, Room::points],
        24.0,
    );
    rig
}

/// Off its charger it runs on an old battery.
pub(super) fn battery(rig: &mut Rig, draw: &mut Draw) {
    rig.drive.flaw = Some(Flaw::Sag(draw.near(7.0e-4), draw.near(1.2)));
}

/// The slide that turns the worm of a bottling line by its rack, with the worm taken out.
pub(super) fn bottle_spacer(draw: &mut Draw) -> Rig {
    let mass = draw.near(14.0);
    let train = Train::one(mass, draw.near(13.0), draw.near(35.0));
    let loops = Pi::of(mass, 3.5, 18.0, Shape::BackCalculation(400.0));
    let mut rig = rig(Kind::Linear, train, Controller::pi(loops, 1.0e-3), 1.0e-7);
    rig.noisy(0.4);
    rig.moved(
        draw,
        Room::about(0.4, (0.6, 4.0), 28.0),
        [Room::raster, Room::seek],
        15.0,
    );
    rig
}

/// The flanks of the worm push once in each of its turns, which get longer on their way.
pub(super) fn growing_pitch(rig: &mut Rig, draw: &mut Draw) {
    let flanks = Field::Scroll {
        amplitude: draw.near(11.0),
        waves: TAU / draw.near(0.09),
        stretch: -draw.near(0.7),
        phase: draw.between(0.0, TAU),
    };
    rig.train.fields.push((0, flanks));
}
