//! Forces of position and velocity that no name of the list has.

use crate::control::Controller;
use crate::draw::Draw;
use crate::make::rig;
use crate::mechanics::field::Field;
use crate::mechanics::joint::Joint;
use crate::mechanics::resistance::Resistance;
use crate::mechanics::train::Train;
use crate::motion::Room;
use crate::rig::{Kind, Rig};

/// The spindle that opens the service brake of a ski lift, with its springs taken out.
pub(super) fn lift_brake(draw: &mut Draw) -> Rig {
    let mass = draw.near(32.0);
    let train = Train::one(mass, draw.near(38.0), draw.near(120.0));
    let controller = Controller::pid(mass, 11.0, 1.0e-3);
    let mut rig = rig(Kind::Linear, train, controller, 1.0e-7);
    rig.noisy(0.8);
    rig.moved(
        draw,
        Room::about(0.08, (0.25, 2.5), 28.0),
        [Room::ladder, Room::points],
        14.0,
    );
    rig
}

/// The springs are in.
pub(super) fn disc_springs(rig: &mut Rig, draw: &mut Draw) {
    let stack = Field::DiscSprings {
        stiffness: draw.near(600.0),
        knee: 0.045,
    };
    rig.train.fields.push((0, stack));
}

/// A car of a coaster on its test track, on a rack, with the brake's magnets folded away.
pub(super) fn coaster_car(draw: &mut Draw) -> Rig {
    let mass = draw.near(90.0);
    let train = Train::one(mass, draw.near(34.0), draw.near(20.0));
    let controller = Controller::cascade(mass, 3.0, 16.0, 1.0e-3);
    let mut rig = rig(Kind::Linear, train, controller, 2.0e-7);
    rig.noisy(1.2);
    rig.moved(
        draw,
        Room::about(1.3, (1.8, 4.0), 30.0),
        [Room::strokes, Room::points],
        15.0,
    );
    rig
}

/// The magnets stand beside the rail.
pub(super) fn eddy_brake(rig: &mut Rig, draw: &mut Draw) {
    rig.train.drags[0].resistance = Some(Resistance::Eddy {
        most: draw.near(110.0),
        velocity: draw.near(0.35),
    });
}

/// The doctor blade of a glue spreader, dry.
pub(super) fn spreader(draw: &mut Draw) -> Rig {
    let mass = draw.near(14.0);
    let train = Train::one(mass, draw.near(16.0), draw.near(30.0));
    let controller = Controller::state_feedback(mass, 10.0, 1.0e-3);
    let mut rig = rig(Kind::Linear, train, controller, 1.0e-7);
    rig.noisy(0.4);
    rig.moved(
        draw,
        Room::about(0.4, (0.7, 4.0), 26.0),
        [Room::workshop, Room::weaving],
        13.0,
    );
    rig
}

/// Glue under the blade.
pub(super) fn glue_film(rig: &mut Rig, draw: &mut Draw) {
    rig.train.drags[0].resistance = Some(Resistance::Thinning {
        consistency: draw.near(75.0),
        exponent: 0.45,
    });
}

/// A small shaker table on ball guides.
pub(super) fn shaker(draw: &mut Draw) -> Rig {
    let mass = draw.near(24.0);
    let train = Train::one(mass, draw.near(18.0), draw.near(40.0));
    let controller = Controller::lead(mass, 14.0, 5.0e-4);
    let mut rig = rig(Kind::Linear, train, controller, 5.0e-8);
    rig.noisy(0.6);
    rig.moved(
        draw,
        Room::about(0.1, (0.5, 5.0), 18.0),
        [Room::waves, Room::points],
        9.0,
    );
    rig
}

/// A dashpot between table and ground whose rod hangs in rubber: it follows within a quarter of a
/// second.
pub(super) fn rubber_dashpot(rig: &mut Rig, draw: &mut Draw) {
    let rubber = Joint::stiff(draw.near(1600.0), 4.0);
    let rod = rig.train.clone().then(rubber, 0.3, 0.0, draw.near(400.0));
    rig.train = rod;
}
