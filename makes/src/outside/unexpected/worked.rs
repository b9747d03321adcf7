//! Oil and heat: the bridge of a stone saw, the table of a thread grinder.
//!
//! A screw that warms up by a few kelvin is longer by some hundredths of a millimetre on a metre:
//! eleven parts in a million for each (Bryan, CIRP Annals 39, 1990).

use crate::control::Controller;
use crate::draw::Draw;
use crate::make::rig;
use crate::mechanics::friction::Scale;
use crate::mechanics::joint::Joint;
use crate::mechanics::train::Train;
use crate::motion::Room;
use crate::rig::{Kind, Rig};
use crate::sensing::{Encoder, Growth, Rounding};
use crate::truth::Effect;

/// The bridge of a saw for stone slabs, at 250 Hz.
pub(super) fn stone_saw(draw: &mut Draw) -> Rig {
    let mass = draw.near(900.0);
    let train = Train::one(mass, draw.near(260.0), draw.near(500.0));
    let controller = Controller::cascade(mass, 1.2, 6.0, 4.0e-3);
    let mut rig = rig(Kind::Linear, train, controller, 5.0e-7);
    rig.noisy(6.0);
    rig.moved(
        draw,
        Room::about(1.0, (0.5, 1.0), 56.0),
        [Room::raster, Room::circles],
        30.0,
    );
    rig
}

/// A shot of oil every few seconds takes friction away, and it climbs until the next one.
pub(super) fn lubricator(rig: &mut Rig, draw: &mut Draw) {
    rig.train.surfaces[0].scales.push(Scale::Oiled {
        share: draw.near(0.7),
        period_s: draw.near(7.0),
    });
}

/// The table of a thread grinder under an observer of the disturbance, with a scale beside its
/// screw; wind-up is declared.
pub(super) fn thread_grinder(draw: &mut Draw) -> Rig {
    let (screw, table) = (draw.near(90.0), draw.near(160.0));
    let stiffness = draw.near(9.0e7);
    let train = Train::one(screw, draw.near(30.0), draw.near(160.0)).then(
        Joint::stiff(stiffness, 1.5e4),
        table,
        draw.near(60.0),
        draw.near(220.0),
    );
    let controller = Controller::rejecting(screw + table, 7.0, 1.0e-3);
    let mut rig = rig(Kind::Linear, train, controller, 2.0e-8);
    rig.sensing.load = Some(Encoder::of(1.0e-7, Rounding::Nearest));
    rig.declare(Effect::Compliance);
    rig.noisy(1.5);
    rig.know("compliance_stiffness", stiffness, "N/m");
    rig.moved(
        draw,
        Room::about(0.3, (0.4, 2.5), 24.0),
        [Room::circles, Room::points],
        13.0,
    );
    rig
}

/// The screw warms up by some seven kelvin while it is moved.
pub(super) fn growing_screw(rig: &mut Rig, draw: &mut Draw) {
    rig.sensing.growth = Some(Growth {
        share: draw.near(8.0e-5),
        time_constant_s: draw.near(9.0),
    });
}
