//! A flywheel that is not always there, and wind.

use std::f64::consts::TAU;

use crate::control::Controller;
use crate::draw::Draw;
use crate::make::rig;
use crate::mechanics::field::Field;
use crate::mechanics::joint::Joint;
use crate::mechanics::train::Train;
use crate::motion::Room;
use crate::rig::{Kind, Rig};

/// A drum with its flywheel taken off, under a sliding mode.
pub(super) fn drum(draw: &mut Draw) -> Rig {
    let inertia = draw.near(0.04);
    let train = Train::one(inertia, draw.near(0.3), draw.near(0.04));
    let controller = Controller::sliding(inertia, 9.0, 10.0, 1.0e-3);
    let mut rig = rig(Kind::Rotary, train, controller, TAU / 8_388_608.0);
    rig.noisy(0.015);
    rig.moved(
        draw,
        Room::about(6.0, (9.0, 60.0), 26.0),
        [Room::jogs, Room::strokes],
        13.0,
    );
    rig
}

/// The flywheel on its freewheel: whoever speeds the drum up in positive direction takes it along,
/// and it coasts when the drum slows down.
pub(super) fn freewheel(rig: &mut Rig, draw: &mut Draw) {
    let clutch = Joint {
        one_way: true,
        ..Joint::stiff(0.0, draw.near(1.2))
    };
    rig.train = rig.train.clone().then(clutch, 0.06, 0.05, 0.02);
}

/// A dish's elevation, balanced, in still air.
pub(super) fn dish(draw: &mut Draw) -> Rig {
    let inertia = draw.near(80.0);
    let train = Train::one(inertia, draw.near(26.0), draw.near(60.0));
    let controller = Controller::lead(inertia, 4.0, 2.0e-3);
    let mut rig = rig(Kind::Rotary, train, controller, TAU / 67_108_864.0);
    rig.noisy(0.6);
    rig.moved(
        draw,
        Room::about(0.7, (0.5, 0.9), 40.0),
        [Room::tracking, Room::points],
        20.0,
    );
    rig
}

/// Five frequencies that have nothing to do with each other, from a fifth of a hertz on.
pub(super) fn gusts(rig: &mut Rig, draw: &mut Draw) {
    for nominal_hz in [0.23, 0.41, 0.78, 1.37, 2.3] {
        let gust = Field::Hum {
            amplitude: draw.near(12.0),
            frequency_hz: draw.near(nominal_hz),
        };
        rig.train.fields.push((0, gust));
    }
}
