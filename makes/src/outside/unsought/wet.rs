//! Water and oil: a tank for fins, a slide with a dashpot.
//!
//! A foil that stands athwart the way is lifted to one side with velocity squared (Newman, Marine
//! Hydrodynamics, 1977, ch. 5). The groove of a recoil brake narrows, lest the slide hits its end.

use crate::control::Controller;
use crate::draw::Draw;
use crate::make::rig;
use crate::mechanics::resistance::Resistance;
use crate::mechanics::train::Train;
use crate::motion::Room;
use crate::rig::{Kind, Rig};

/// The carriage over a tank in which fins of surfboards are tried, without a fin, at 500 Hz.
pub(super) fn fin_tank(draw: &mut Draw) -> Rig {
    let mass = draw.near(75.0);
    let train = Train::one(mass, draw.near(30.0), draw.near(85.0));
    let controller = Controller::cascade(mass, 2.2, 11.0, 2.0e-3);
    let mut rig = rig(Kind::Linear, train, controller, 2.0e-7);
    rig.noisy(1.0);
    rig.moved(
        draw,
        Room::about(1.3, (1.2, 2.2), 38.0),
        [Room::strokes, Room::shifts],
        20.0,
    );
    rig
}

/// A curved fin is pushed to one end of the tank, whichever way it goes.
pub(super) fn foil(rig: &mut Rig, draw: &mut Draw) {
    rig.train.drags[0].resistance = Some(Resistance::Foil(draw.near(130.0)));
}

/// The slide of a tester for recoil brakes, with a brake of even groove.
pub(super) fn recoil_slide(draw: &mut Draw) -> Rig {
    let mass = draw.near(44.0);
    let train = Train::one(mass, draw.near(32.0), draw.near(170.0));
    let controller = Controller::pid(mass, 7.0, 1.0e-3);
    let mut rig = rig(Kind::Linear, train, controller, 1.0e-7);
    rig.noisy(1.2);
    rig.moved(
        draw,
        Room::about(0.35, (0.9, 4.5), 26.0),
        [Room::points, Room::jogs],
        14.0,
    );
    rig
}

/// The groove of its brake narrows toward the end of the way.
pub(super) fn narrowing_groove(rig: &mut Rig, draw: &mut Draw) {
    rig.train.drags[0].taper = draw.near(1.9);
}
