//! The good axes that clean, disturbed and spoilt records start from.
//!
//! They are as plain as can be: what is odd about a record is then the one thing that its table
//! names.

use crate::control::Controller;
use crate::draw::Draw;
use crate::make::rig;
use crate::mechanics::joint::Joint;
use crate::mechanics::train::Train;
use crate::motion::{Pace, Room};
use crate::rig::{Kind, Rig};
use crate::sensing::{Encoder, Rounding};
use crate::truth::Effect;

/// Where the linear axes move.
pub(crate) const ROOM: Room = Room {
    low: -0.15,
    high: 0.15,
    pace: Pace {
        velocity: 0.3,
        acceleration: 3.0,
    },
    duration_s: 28.0,
};
/// Length of their validation records, s.
pub(crate) const VALIDATION_S: f64 = 12.0;

/// One mass of some sixty kilograms.
pub(crate) fn plain(draw: &mut Draw) -> Rig {
    plain_at(draw, 1.0e-3)
}

/// The same at another period of the controller and of the rows.
pub(crate) fn plain_at(draw: &mut Draw, period_s: f64) -> Rig {
    let mass = draw.near(60.0);
    let train = Train::one(mass, draw.near(40.0), draw.near(160.0));
    // A twenty-fifth of the sampling rate, at most 30 Hz: half a period of dead time is 7 degrees.
    let velocity_hz = (0.04 / period_s).min(30.0);
    let controller = Controller::cascade(mass, velocity_hz / 5.5, velocity_hz, period_s);
    let mut rig = rig(Kind::Linear, train, controller, 1.0e-7);
    rig.noisy(0.8);
    rig.moved(draw, ROOM, [Room::workshop, Room::points], VALIDATION_S);
    rig
}

/// The same under a controller at 8 kHz, with the drive's current recorded at 1 kHz.
pub(crate) fn fast(draw: &mut Draw) -> Rig {
    let mut rig = plain_at(draw, 1.25e-4);
    rig.logs_current(8);
    rig
}

/// Two masses with a scale at the load and the compliance declared; the controller is stated.
pub(crate) fn scaled(draw: &mut Draw) -> Rig {
    let (motor, table) = (draw.near(35.0), draw.near(40.0));
    let stiffness = draw.near(1.5e7);
    let train = Train::one(motor, draw.near(15.0), draw.near(80.0)).then(
        Joint::stiff(stiffness, 6.0e3),
        table,
        draw.near(35.0),
        draw.near(90.0),
    );
    let controller = Controller::cascade(motor + table, 5.0, 28.0, 1.0e-3);
    let mut rig = rig(Kind::Linear, train, controller, 1.0e-7);
    rig.sensing.load = Some(Encoder::of(1.0e-7, Rounding::Nearest));
    rig.stated.controller = true;
    rig.stated.lead_m_per_rev = Some(0.01);
    rig.declare(Effect::Compliance);
    rig.noisy(0.8);
    rig.know("compliance_stiffness", stiffness, "N/m");
    rig.moved(
        draw,
        ROOM.lasting(16.0),
        [Room::workshop, Room::points],
        8.0,
    );
    rig
}

/// A rotary axis of a few kg m².
pub(crate) fn rotary(draw: &mut Draw) -> Rig {
    let inertia = draw.near(3.0);
    let train = Train::one(inertia, draw.near(8.0), draw.near(5.0));
    let controller = Controller::cascade(inertia, 5.0, 28.0, 1.0e-3);
    let count = std::f64::consts::TAU / 4_194_304.0;
    let mut rig = rig(Kind::Rotary, train, controller, count);
    rig.noisy(0.08);
    let room = Room {
        low: -2.0,
        high: 2.0,
        pace: Pace {
            velocity: 3.0,
            acceleration: 12.0,
        },
        duration_s: 16.0,
    };
    rig.moved(draw, room, [Room::workshop, Room::points], 8.0);
    rig
}
