//! Sport and film: a club that is swung, a camera on a rope, a film that is drawn.
//!
//! The stretch of a rope is F·l/(E·A) (Feyrer, Wire Ropes, 2015). Iron that saturates gives
//! u/(1 + k|u|); teeth pull at magnets over their pitch (Gieras, Linear Synchronous Motors, 2011).

use std::f64::consts::TAU;

use crate::control::Controller;
use crate::control::pi::{Pi, Shape};
use crate::draw::Draw;
use crate::drive::ConstantRipple;
use crate::make::{Make, Presence, rig};
use crate::mechanics::field::Field;
use crate::mechanics::inertia::Inertia;
use crate::mechanics::joint::Joint;
use crate::mechanics::train::Train;
use crate::motion::Room;
use crate::rig::{Kind, Rig};
use crate::sensing::{Encoder, Rounding};
use crate::truth::Effect;

/// The family.
pub const MAKES: &[Make] = &[
    Make {
        name: "golf-robot",
        hides: &[Effect::PositionDependentInertia, Effect::TorqueSaturation],
        build: golf_robot,
    },
    Make {
        name: "cable-camera",
        hides: &[Effect::Compliance, Effect::LoggedLate],
        build: cable_camera,
    },
    Make {
        name: "film-capstan",
        hides: &[Effect::TorqueConstantRipple],
        build: film_capstan,
    },
    Make {
        name: "surge-sled",
        hides: &[Effect::TorqueRipple, Effect::TorqueSaturation],
        build: surge_sled,
    },
];

/// A robot that swings golf clubs for testing, in a flat plane at 2 kHz: a cam cocks the wrist over
/// the angle of the shoulder, so that the arm is longer on one side, and the motor saturates.
fn golf_robot(draw: &mut Draw, presence: Presence) -> Rig {
    let inertia = draw.near(1.4);
    let share = presence.size_of(Effect::PositionDependentInertia, draw.near(0.35));
    let droop = presence.size_of(Effect::TorqueSaturation, draw.near(1.5e-3));
    let mut train = Train::one(inertia, draw.near(3.0), draw.near(0.5));
    train.inertias[0] = Inertia::Harmonic {
        mean: inertia,
        share,
        waves: 1.0,
        phase: draw.between(0.8, 2.2),
    };
    let controller = Controller::pid(inertia, 9.0, 5.0e-4);
    let mut rig = rig(Kind::Rotary, train, controller, TAU / 16_777_216.0);
    rig.drive.droop = droop;
    rig.noisy(0.6);
    rig.know("position_dependent_inertia", share * inertia, "kg m2");
    rig.know("torque_saturation", droop, "1/(N m)");
    rig.moved(
        draw,
        Room::about(2.3, (13.0, 110.0), 18.0),
        [Room::packets, Room::points],
        10.0,
    );
    rig
}

/// A camera that is drawn along a stadium by a rope: winch, rope and trolley, whose place a laser
/// tells. The radio brings the winch's current some milliseconds late, at 500 Hz.
fn cable_camera(draw: &mut Draw, presence: Presence) -> Rig {
    let (winch, trolley) = (draw.near(60.0), draw.near(30.0));
    let stiffness = draw.near(4.0e5);
    let [first, last, viscous] = [draw.near(20.0), draw.near(14.0), draw.near(9.0)];
    let late_s = presence.size_of(Effect::LoggedLate, draw.near(9.0e-3));
    let soft = Train::one(winch, first, viscous).then(
        Joint::stiff(stiffness, 600.0),
        trolley,
        last,
        viscous,
    );
    let bolted = Train::one(winch + trolley, first + last, 2.0 * viscous);
    let is_soft = presence.has(Effect::Compliance);
    let train = if is_soft { soft } else { bolted };
    let controller = Controller::cascade(winch + trolley, 0.8, 4.5, 1.0e-3);
    let mut rig = rig(Kind::Linear, train, controller, 1.0e-7);
    rig.logs_current(2);
    rig.sensing.load = Some(Encoder::of(5.0e-6, Rounding::Nearest));
    rig.sensing.effort.late_s = late_s;
    rig.noisy(1.2);
    rig.know("compliance_stiffness", stiffness, "N/m");
    rig.know("logged_late", late_s, "s");
    rig.moved(
        draw,
        Room::about(5.0, (3.5, 3.5), 42.0),
        [Room::errands, Room::seek],
        22.0,
    );
    rig
}

/// The capstan of a film scanner, at 4 kHz with every second row kept: eleven pole pairs of uneven
/// magnets. Nobody has written down the encoder's resolution, and no setpoint is recorded.
fn film_capstan(draw: &mut Draw, presence: Presence) -> Rig {
    let inertia = draw.near(8.0e-4);
    let wave = ConstantRipple {
        share: presence.size_of(Effect::TorqueConstantRipple, draw.near(0.08)),
        waves: 11.0,
        phase: draw.between(0.0, TAU),
    };
    let train = Train::one(inertia, draw.near(0.02), draw.near(1.2e-3));
    let loops = Pi::of(inertia, 6.0, 35.0, Shape::BackCalculation(0.9));
    let controller = Controller::pi(loops, 2.5e-4);
    let mut rig = rig(Kind::Rotary, train, controller, TAU / 33_554_432.0);
    rig.logs_current(2);
    rig.drive.ripple = Some(wave);
    rig.sensing.reference = false;
    rig.stated.resolution = false;
    rig.noisy(1.5e-3);
    rig.know("torque_constant_ripple", wave.share, "");
    rig.know("torque_constant_ripple_order", 11.0, "1/rev");
    rig.moved(
        draw,
        Room::about(6.0, (22.0, 260.0), 14.0),
        [Room::raster, Room::waves],
        8.0,
    );
    rig
}

/// Pitch of the sled's magnets, m.
const SLED_PITCH_M: f64 = 0.064;

/// A sled that carries a person whose sense of balance is tested, on an iron-core motor under a
/// sliding mode: it cogs over the pitch of its magnets and saturates when it starts off. The
/// drive's velocity is recorded beside the rest.
fn surge_sled(draw: &mut Draw, presence: Presence) -> Rig {
    let mass = draw.near(220.0);
    let amplitude = presence.size_of(Effect::TorqueRipple, draw.near(40.0));
    let droop = presence.size_of(Effect::TorqueSaturation, draw.near(2.5e-4));
    let mut train = Train::one(mass, draw.near(28.0), draw.near(60.0));
    let teeth = Field::Cogging {
        amplitude,
        waves: TAU / SLED_PITCH_M,
        phase: draw.between(0.0, TAU),
    };
    train.fields.push((0, teeth));
    let controller = Controller::sliding(mass, 5.0, 1.2e3, 1.0e-3);
    let mut rig = rig(Kind::Linear, train, controller, 1.0e-7);
    rig.drive.droop = droop;
    rig.sensing.velocity = Some(1.0e-5);
    rig.noisy(4.0);
    rig.know("torque_ripple_amplitude", amplitude, "N");
    rig.know("torque_ripple_period", SLED_PITCH_M, "m");
    rig.know("torque_saturation", droop, "1/N");
    rig.moved(
        draw,
        Room::about(1.3, (1.6, 4.0), 28.0),
        [Room::packets, Room::seek],
        14.0,
    );
    rig
}
