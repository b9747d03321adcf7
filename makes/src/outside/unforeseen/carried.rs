//! A net on its rope and a seat on its arm: what is carried moves by itself.
//!
//! A rope pulls and does not push. What sinks in water gets no faster than its drag carries its
//! weight (Newman, Marine Hydrodynamics, 1977, ch. 2). An inertia that changes with time takes
//! momentum, d(J·v)/dt.

use std::f64::consts::TAU;

use crate::control::Controller;
use crate::draw::Draw;
use crate::make::rig;
use crate::mechanics::field::{Drag, Field};
use crate::mechanics::inertia::Inertia;
use crate::mechanics::joint::Joint;
use crate::mechanics::train::Train;
use crate::motion::Room;
use crate::rig::{Kind, Rig};

/// The winch for plankton nets of a research vessel, with nothing on its rope, at 500 Hz; haul is
/// positive.
pub(super) fn plankton_winch(draw: &mut Draw) -> Rig {
    let mass = draw.near(160.0);
    let train = Train::one(mass, draw.near(55.0), draw.near(120.0));
    let controller = Controller::cascade(mass, 2.5, 13.0, 2.0e-3);
    let mut rig = rig(Kind::Linear, train, controller, 1.0e-7);
    rig.noisy(2.0);
    rig.moved(
        draw,
        Room::about(1.0, (0.7, 1.4), 40.0),
        [Room::shifts, Room::waves],
        20.0,
    );
    rig
}

/// A net that sinks with half a metre a second at most: on quick ways down its rope is slack.
pub(super) fn sinking_net(rig: &mut Rig, draw: &mut Draw) {
    let rope = Joint {
        one_way: true,
        ..Joint::stiff(3.0e4, 9.0e2)
    };
    let net = rig.train.clone().then(rope, draw.near(45.0), 0.0, 0.0);
    rig.train = net;
    let weight = draw.near(170.0);
    rig.train.fields.push((1, Field::Constant(-weight)));
    rig.train.drags[1] = Drag {
        body: 1,
        quadratic: weight / (0.45 * 0.45),
        ..Drag::default()
    };
}

/// The arm of a fairground ride, balanced, with its seats bolted on.
pub(super) fn gondola(draw: &mut Draw) -> Rig {
    let inertia = draw.near(420.0);
    let train = Train::one(inertia, draw.near(60.0), draw.near(45.0));
    let controller = Controller::pid(inertia, 5.0, 1.0e-3);
    let mut rig = rig(Kind::Rotary, train, controller, TAU / 8_388_608.0);
    rig.noisy(4.0);
    rig.moved(
        draw,
        Room::about(2.5, (1.6, 3.0), 36.0),
        [Room::swells, Room::errands],
        18.0,
    );
    rig
}

/// Its seats are swung in and out by a drive of their own, which nobody records.
pub(super) fn swung_seat(rig: &mut Rig, draw: &mut Draw) {
    rig.train.inertias[0] = Inertia::Breathing {
        mean: rig.train.inertia(),
        share: draw.near(0.22),
        frequency_hz: draw.near(0.45),
    };
}
