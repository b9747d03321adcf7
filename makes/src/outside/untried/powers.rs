//! Friction that is switched, and drives that give less than they should.
//!
//! Ultrasound takes most of the friction away while it is on (Littmann, Storck and Wallaschek,
//! Arch. Appl. Mech. 71, 2001). A motor near the voltage of its supply loses torque with speed
//! (Leonhard, Control of Electrical Drives, 2001, ch. 5).

use crate::control::Controller;
use crate::control::pi::{Pi, Shape};
use crate::draw::Draw;
use crate::drive::Flaw;
use crate::make::rig;
use crate::mechanics::friction::Scale;
use crate::mechanics::train::Train;
use crate::motion::Room;
use crate::rig::{EffortColumn, Kind, Rig};

/// The blade of a cake slitter, with its ultrasound off.
pub(super) fn slitter(draw: &mut Draw) -> Rig {
    let mass = draw.near(8.0);
    let train = Train::one(mass, draw.near(16.0), draw.near(24.0));
    let controller = Controller::pid(mass, 10.0, 1.0e-3);
    let mut rig = rig(Kind::Linear, train, controller, 1.0e-7);
    rig.noisy(0.3);
    rig.moved(
        draw,
        Room::about(0.2, (0.5, 4.0), 28.0),
        [Room::errands, Room::points],
        14.0,
    );
    rig
}

/// It is switched on for two seconds of every five.
pub(super) fn ultrasound(rig: &mut Rig, draw: &mut Draw) {
    rig.train.surfaces[0].scales.push(Scale::Pulsed {
        share: -draw.near(0.6),
        lasts_s: draw.near(2.2),
        period_s: draw.near(4.9),
    });
}

/// The drive of a small funicular, counted at the rope, balanced, at 250 Hz.
pub(super) fn funicular(draw: &mut Draw) -> Rig {
    let mass = draw.near(5200.0);
    let train = Train::one(mass, draw.near(650.0), draw.near(400.0));
    let controller = Controller::cascade(mass, 1.0, 5.5, 4.0e-3);
    let mut rig = rig(Kind::Linear, train, controller, 1.0e-6);
    rig.column = EffortColumn::Current(1.0 / 90.0);
    rig.noisy(20.0);
    rig.moved(
        draw,
        Room::about(8.0, (2.6, 0.9), 66.0),
        [Room::seek, Room::errands],
        34.0,
    );
    rig
}

/// Its line is too long: at full speed half of what is asked for is missing.
pub(super) fn starved(rig: &mut Rig, draw: &mut Draw) {
    rig.drive.flaw = Some(Flaw::Starved(draw.near(3.6)));
}

/// The linear motor of a people mover's short test track, at 1 kHz.
pub(super) fn people_mover(draw: &mut Draw) -> Rig {
    let mass = draw.near(640.0);
    let train = Train::one(mass, draw.near(190.0), draw.near(230.0));
    let loops = Pi::of(mass, 2.5, 14.0, Shape::BackCalculation(8.0e3));
    let mut rig = rig(Kind::Linear, train, Controller::pi(loops, 1.0e-3), 1.0e-7);
    rig.noisy(6.0);
    rig.moved(
        draw,
        Room::about(1.6, (1.4, 3.0), 30.0),
        [Room::seek, Room::strokes],
        15.0,
    );
    rig
}

/// Over some decimetres it gives four tenths less.
pub(super) fn weak_magnet(rig: &mut Rig, draw: &mut Draw) {
    let centre = draw.between(-0.3, 0.3);
    rig.drive.flaw = Some(Flaw::Patch(centre, draw.near(0.25), -draw.near(0.4)));
}
