//! Forces of place and time that no name of the list has.

use std::f64::consts::TAU;

use crate::control::Controller;
use crate::control::pi::{Pi, Shape};
use crate::draw::Draw;
use crate::make::rig;
use crate::mechanics::field::Field;
use crate::mechanics::train::Train;
use crate::motion::Room;
use crate::rig::{Kind, Rig};

/// The hoist of a sluice gate, balanced but for a rest, at 500 Hz.
pub(super) fn sluice(draw: &mut Draw) -> Rig {
    let mass = draw.near(700.0);
    let mut train = Train::one(mass, draw.near(420.0), draw.near(900.0));
    train.fields.push((0, Field::Constant(-draw.near(350.0))));
    let controller = Controller::rejecting(mass, 2.5, 2.0e-3);
    let mut rig = rig(Kind::Linear, train, controller, 1.0e-7);
    rig.noisy(6.0);
    rig.moved(
        draw,
        Room::about(0.7, (0.6, 1.2), 44.0),
        [Room::seek, Room::jogs],
        22.0,
    );
    rig
}

/// The tank that is its counterweight has a leak: it loses some kilograms a second.
pub(super) fn draining_tank(rig: &mut Rig, draw: &mut Draw) {
    let lost_n_per_s = draw.near(30.0);
    rig.train.fields.push((0, Field::Ramp(-lost_n_per_s)));
}

/// The motor on the zoom ring of a film lens, with its click stops taken out.
pub(super) fn zoom_ring(draw: &mut Draw) -> Rig {
    let (inertia, coulomb) = (draw.near(4.0e-4), draw.near(0.03));
    let train = Train::one(inertia, coulomb, draw.near(2.5e-3));
    let loops = Pi::of(inertia, 5.0, 28.0, Shape::VelocityForm(0.8));
    let controller = Controller::pi(loops, 1.0e-3);
    let mut rig = rig(Kind::Rotary, train, controller, TAU / 4_194_304.0);
    rig.noisy(6.0e-4);
    rig.moved(
        draw,
        Room::about(1.3, (6.0, 60.0), 26.0),
        [Room::raster, Room::errands],
        13.0,
    );
    rig
}

/// Five balls snap in at marks that have nothing even about them.
pub(super) fn click_stops(rig: &mut Rig, draw: &mut Draw) {
    for at in [-1.02, -0.55, -0.38, 0.24, 0.91] {
        let ball = Field::Latch {
            at: at + draw.between(-0.03, 0.03),
            width: draw.near(0.035),
            depth: draw.near(0.03),
        };
        rig.train.fields.push((0, ball));
    }
}

/// A carriage that takes samples of ore, in a night without work.
pub(super) fn sampler(draw: &mut Draw) -> Rig {
    let mass = draw.near(48.0);
    let train = Train::one(mass, draw.near(40.0), draw.near(90.0));
    let controller = Controller::state_feedback(mass, 7.0, 1.0e-3);
    let mut rig = rig(Kind::Linear, train, controller, 1.0e-7);
    rig.noisy(1.0);
    rig.moved(
        draw,
        Room::about(0.5, (0.8, 3.0), 28.0),
        [Room::packets, Room::workshop],
        14.0,
    );
    rig
}

/// Every stamp that falls next door shakes the ground along the axis.
pub(super) fn stamp_mill(rig: &mut Rig, draw: &mut Draw) {
    let blows = Field::Blows {
        force: draw.near(90.0),
        lasts_s: draw.near(0.16),
        period_s: draw.near(0.77),
    };
    rig.train.fields.push((0, blows));
}
