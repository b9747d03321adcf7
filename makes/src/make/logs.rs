//! Machines that are as they are declared, with a bus or a log that shifts the effort in time.
//!
//! An effort that acts later than the file says is `delay`; one that is recorded later than it
//! acted is `logged_late`. Which of them decides the sign alone.

use crate::control::Controller;
use crate::draw::Draw;
use crate::drive::CurrentLoop;
use crate::make::{Make, Presence, rig};
use crate::mechanics::friction::Scale;
use crate::mechanics::train::Train;
use crate::motion::Room;
use crate::rig::{Kind, Rig};
use crate::truth::Effect;

/// The family.
pub const MAKES: &[Make] = &[
    Make {
        name: "fieldbus-log",
        hides: &[Effect::LoggedLate],
        build: fieldbus_log,
    },
    Make {
        name: "plc-log",
        hides: &[Effect::LoggedLate, Effect::FrictionDrift],
        build: plc_log,
    },
    Make {
        name: "network-drive",
        hides: &[Effect::Delay],
        build: network_drive,
    },
];

/// A drive that measures its current and sends it with the next frame of a bus: one millisecond
/// late, beside positions that are latched.
fn fieldbus_log(draw: &mut Draw, presence: Presence) -> Rig {
    let mass = draw.near(25.0);
    let late_s = presence.size(draw.near(1.0e-3));
    let train = Train::one(mass, draw.near(20.0), draw.near(60.0));
    let controller = Controller::cascade(mass, 6.0, 40.0, 1.25e-4);
    let mut rig = rig(Kind::Linear, train, controller, 1.0e-7);
    rig.drive.current_loop = CurrentLoop::Second(700.0, 0.8);
    rig.logs_current(8);
    rig.sensing.effort.late_s = late_s;
    rig.noisy(0.5);
    rig.know("logged_late", late_s, "s");
    rig.moved(
        draw,
        Room::about(0.15, (0.6, 10.0), 24.0),
        [Room::points, Room::waves],
        12.0,
    );
    rig
}

/// A PLC at 250 Hz whose trace takes the torque a cycle and a half late, on an axis that warms up.
fn plc_log(draw: &mut Draw, presence: Presence) -> Rig {
    let mass = draw.near(110.0);
    let late_s = presence.size(draw.near(6.0e-3));
    let surplus = presence.size(draw.near(0.5));
    let mut train = Train::one(mass, draw.near(75.0), draw.near(260.0));
    train.surfaces[0].scales.push(Scale::WarmUp {
        surplus,
        time_constant_s: draw.near(14.0),
    });
    let controller = Controller::cascade(mass, 4.0, 25.0, 1.25e-4);
    // At 8 kHz a micrometre would be 8 mm/s: noise of the loop that 250 Hz would fold down.
    let mut rig = rig(Kind::Linear, train, controller, 2.0e-8);
    rig.logs_current(32);
    rig.sensing.effort.late_s = late_s;
    rig.noisy(1.5);
    rig.know("logged_late", late_s, "s");
    rig.know("friction_drift_gain", surplus, "");
    rig.moved(
        draw,
        Room::about(0.3, (0.6, 4.0), 60.0),
        [Room::workshop, Room::points],
        30.0,
    );
    rig
}

/// A drive on a network: a command acts most of a millisecond after it was given, at 500 Hz.
fn network_drive(draw: &mut Draw, presence: Presence) -> Rig {
    let mass = draw.near(40.0);
    let delay_s = presence.size(draw.near(9.0e-4));
    let train = Train::one(mass, draw.near(22.0), draw.near(80.0));
    let controller = Controller::cascade(mass, 3.0, 18.0, 2.0e-3);
    let mut rig = rig(Kind::Linear, train, controller, 2.0e-7);
    rig.drive.dead_time_s = delay_s;
    rig.noisy(0.6);
    rig.know("delay", delay_s, "s");
    rig.moved(
        draw,
        Room::about(0.15, (0.5, 8.0), 45.0),
        [Room::points, Room::circles],
        20.0,
    );
    rig
}
