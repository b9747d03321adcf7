//! A weight that is loose, and a current loop that rings.
//!
//! A current controller whose integral is too strong for its winding has a pair of poles with
//! little damping (Leonhard, Control of Electrical Drives, 2001, ch. 7).

use crate::control::Controller;
use crate::draw::Draw;
use crate::drive::CurrentLoop;
use crate::make::rig;
use crate::mechanics::joint::Joint;
use crate::mechanics::train::Train;
use crate::motion::Room;
use crate::rig::{EffortColumn, Kind, Rig};

/// A table that carries ballast, with nothing on it.
pub(super) fn ballast(draw: &mut Draw) -> Rig {
    let mass = draw.near(130.0);
    let train = Train::one(mass, draw.near(60.0), draw.near(140.0));
    let controller = Controller::pid(mass, 6.0, 1.0e-3);
    let mut rig = rig(Kind::Linear, train, controller, 1.0e-7);
    rig.noisy(1.5);
    rig.moved(
        draw,
        Room::about(0.5, (0.6, 2.5), 30.0),
        [Room::workshop, Room::circles],
        15.0,
    );
    rig
}

/// A weight on rollers of its own lies between two stops of the table, centimetres apart: it is
/// pushed by one of them, runs on, and is caught by the other. Nothing tells where it is.
pub(super) fn loose_weight(rig: &mut Rig, draw: &mut Draw) {
    let stops = Joint {
        gap: draw.near(0.05),
        ..Joint::stiff(4.0e5, 4.0e3)
    };
    let weight = draw.near(45.0);
    rig.train = rig.train.clone().then(stops, weight, draw.near(12.0), 5.0);
}

/// The carriage of a braiding machine, at 2 kHz.
pub(super) fn braider(draw: &mut Draw) -> Rig {
    let mass = draw.near(7.0);
    let train = Train::one(mass, draw.near(9.0), draw.near(22.0));
    let controller = Controller::state_feedback(mass, 6.0, 5.0e-4);
    let mut rig = rig(Kind::Linear, train, controller, 5.0e-8);
    rig.column = EffortColumn::Current(1.0 / 18.0);
    rig.noisy(0.3);
    rig.moved(
        draw,
        Room::about(0.15, (0.7, 12.0), 20.0),
        [Room::workshop, Room::points],
        10.0,
    );
    rig
}

/// Its current controller is tuned for another winding; the command is what is recorded.
pub(super) fn ringing(rig: &mut Rig, draw: &mut Draw) {
    rig.drive.current_loop = CurrentLoop::Second(draw.near(75.0), draw.near(0.15));
}
