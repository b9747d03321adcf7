//! Stages and mirrors: light, fine, and fast or nearly without friction.
//!
//! Oil and air films have no level that holds at rest, F = c·v alone (Slocum, Precision Machine
//! Design, 1992, ch. 9): the declared model of such a make has no Coulomb friction.

use std::f64::consts::TAU;

use crate::control::Controller;
use crate::control::pi::{Pi, Shape};
use crate::draw::Draw;
use crate::drive::ConstantRipple;
use crate::make::{Make, Presence, rig};
use crate::mechanics::field::Field;
use crate::mechanics::friction::Law;
use crate::mechanics::train::Train;
use crate::motion::Room;
use crate::rig::{EffortColumn, Kind, Rig};
use crate::sensing::Rounding;
use crate::truth::Effect;

/// The family.
pub const MAKES: &[Make] = &[
    Make {
        name: "galvanometer",
        hides: &[Effect::Presliding],
        build: galvanometer,
    },
    Make {
        name: "hydrostatic-slide",
        hides: &[Effect::TorqueSaturation],
        build: hydrostatic_slide,
    },
    Make {
        name: "piezo-hybrid",
        hides: &[Effect::Presliding, Effect::Delay],
        build: piezo_hybrid,
    },
    Make {
        name: "air-bearing-table",
        hides: &[Effect::TorqueRipple],
        build: air_bearing_table,
    },
    Make {
        name: "camera-gimbal",
        hides: &[Effect::TorqueConstantRipple],
        build: camera_gimbal,
    },
];

/// The mirror of a laser scanner, 4·10⁻⁷ kg m², at 10 kHz: its two small ball bearings only roll a
/// little within the usual angles, with the hysteresis of Bouc and Wen over a milliradian or two.
fn galvanometer(draw: &mut Draw, presence: Presence) -> Rig {
    let (inertia, coulomb) = (draw.near(4.0e-7), draw.near(6.0e-5));
    let deflection = draw.near(1.5e-3);
    let mut train = Train::one(inertia, coulomb, draw.near(4.0e-6));
    let rolling = Law::BoucWen {
        coulomb,
        stiffness: coulomb / deflection,
        exponent: 1.5,
    };
    train.surfaces[0].law = presence.or(rolling, Law::coulomb(coulomb));
    let controller = Controller::pid(inertia, 90.0, 1.0e-4);
    let mut rig = rig(Kind::Rotary, train, controller, TAU / 4_194_304.0);
    rig.sensing.motor.rounding = Rounding::Nearest;
    rig.logs_current(2);
    rig.noisy(1.0e-6);
    rig.know("presliding_deflection", presence.size(deflection), "rad");
    rig.moved(
        draw,
        Room::about(0.3, (8.0, 800.0), 9.0),
        [Room::waves, Room::points],
        4.0,
    );
    rig
}

/// The slide of a grinding machine on pockets of oil: viscous friction, no Coulomb friction,
/// declared or present. The linear motor saturates under nine hundred kilograms.
fn hydrostatic_slide(draw: &mut Draw, presence: Presence) -> Rig {
    let mass = draw.near(900.0);
    let droop = presence.size(draw.near(5.0e-5));
    let train = Train::one(mass, 0.0, draw.near(9000.0));
    let controller = Controller::cascade(mass, 4.0, 24.0, 1.0e-3);
    let mut rig = rig(Kind::Linear, train, controller, 2.0e-8);
    rig.drive.droop = droop;
    rig.base.retain(|effect| *effect != Effect::Coulomb);
    rig.noisy(12.0);
    rig.know("torque_saturation", droop, "1/N");
    rig.moved(
        draw,
        Room::about(0.25, (0.4, 4.0), 26.0),
        [Room::jogs, Room::workshop],
        12.0,
    );
    rig
}

/// A coarse stage that carries a piezo and shares one controller at 4 kHz with it: the piezo has
/// its share of the bandwidth because the coarse stage gets its command three periods late. Its
/// crossed rollers deflect by micrometres before they roll (LuGre).
fn piezo_hybrid(draw: &mut Draw, presence: Presence) -> Rig {
    let (mass, coulomb) = (draw.near(2.0), draw.near(3.0));
    let deflection = draw.near(8.0e-6);
    let delay_s = presence.size(7.5e-4);
    let mut train = Train::one(mass, coulomb, draw.near(9.0));
    let bristles = Law::LuGre {
        coulomb,
        stribeck: None,
        stiffness: coulomb / deflection,
        micro_damping: draw.near(250.0),
        fade_velocity: 0.005,
    };
    train.surfaces[0].law = presence.or(bristles, Law::coulomb(coulomb));
    let controller = Controller::state_feedback(mass, 22.0, 2.5e-4);
    let mut rig = rig(Kind::Linear, train, controller, 2.0e-9);
    rig.sensing.motor.rounding = Rounding::Nearest;
    rig.drive.dead_time_s = delay_s;
    rig.noisy(0.01);
    rig.know("presliding_deflection", presence.size(deflection), "m");
    rig.know("delay", delay_s, "s");
    rig.moved(
        draw,
        Room::about(0.02, (0.1, 3.0), 9.0),
        [Room::jogs, Room::waves],
        5.0,
    );
    rig
}

/// A turntable on air that is driven by feedforward alone: nothing is measured for the loop, so it
/// ends up where cogging takes it. Drag of the air is a hundredth of the torque, Coulomb friction
/// is neither declared nor present, and no setpoint is recorded.
fn air_bearing_table(draw: &mut Draw, presence: Presence) -> Rig {
    let (inertia, viscous) = (draw.near(0.4), draw.near(0.03));
    let amplitude = presence.size(draw.near(0.08));
    let mut train = Train::one(inertia, 0.0, viscous);
    let cogging = Field::Cogging {
        amplitude,
        waves: 18.0,
        phase: draw.between(0.0, TAU),
    };
    train.fields.push((0, cogging));
    let controller = Controller::feedforward(0.98 * inertia, viscous, 1.0e-3);
    let mut rig = rig(Kind::Rotary, train, controller, TAU / 67_108_864.0);
    rig.base.retain(|effect| *effect != Effect::Coulomb);
    rig.sensing.reference = false;
    rig.noisy(3.0e-3);
    rig.know("torque_ripple_amplitude", amplitude, "N m");
    rig.know("torque_ripple_order", 18.0, "1/rev");
    rig.moved(
        draw,
        Room::about(3.0, (2.5, 4.0), 28.0),
        [Room::waves, Room::workshop],
        14.0,
    );
    rig
}

/// The roll axis of a camera gimbal: a motor of seven pole pairs and no gear, whose torque per
/// ampere varies with the rotor's place. Its gain is scheduled, stiff at rest and soft when it
/// pans. The drive's current goes into the log in amperes, in steps of 2 mA.
fn camera_gimbal(draw: &mut Draw, presence: Presence) -> Rig {
    let inertia = draw.near(2.5e-3);
    let wave = ConstantRipple {
        share: draw.near(0.11),
        waves: 7.0,
        phase: draw.between(0.0, TAU),
    };
    let train = Train::one(inertia, draw.near(0.012), draw.near(1.5e-3));
    let shape = Shape::Scheduled {
        extra: 0.8,
        knee: 1.0,
    };
    let controller = Controller::pi(Pi::of(inertia, 6.0, 30.0, shape), 5.0e-4);
    let mut rig = rig(Kind::Rotary, train, controller, TAU / 4_194_304.0);
    rig.column = EffortColumn::Current(1.0 / 0.09);
    rig.drive.ripple = presence.or(Some(wave), None);
    rig.logs_current(2);
    rig.sensing.effort.quantum = 0.002 * 0.09;
    rig.noisy(4.0e-4);
    rig.know("torque_constant_ripple", presence.size(wave.share), "");
    rig.know("torque_constant_ripple_order", 7.0, "1/rev");
    rig.moved(
        draw,
        Room::about(1.2, (6.0, 60.0), 24.0),
        [Room::waves, Room::points],
        12.0,
    );
    rig
}
