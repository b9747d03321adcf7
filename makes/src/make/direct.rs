//! Direct drives: nothing between the motor's force and the load.
//!
//! Magnets cog over their pitch (Gieras, Piech and Tomczuk, Linear Synchronous Motors, 2012, ch.
//! 3), iron saturates, rolling guides deflect before they slip.

use std::f64::consts::TAU;

use crate::control::Controller;
use crate::draw::Draw;
use crate::drive::{ConstantRipple, CurrentLoop};
use crate::make::{Make, Presence, rig};
use crate::mechanics::field::Field;
use crate::mechanics::friction::{Law, Stribeck};
use crate::mechanics::train::Train;
use crate::motion::Room;
use crate::rig::{EffortColumn, Kind, Rig};
use crate::sensing::{Encoder, Rounding, Wave};
use crate::truth::Effect;

/// The family.
pub const MAKES: &[Make] = &[
    Make {
        name: "iron-core-stage",
        hides: &[Effect::TorqueRipple],
        build: iron_core_stage,
    },
    Make {
        name: "nano-stage",
        hides: &[Effect::Presliding],
        build: nano_stage,
    },
    Make {
        name: "roller-stage",
        hides: &[Effect::Presliding],
        build: roller_stage,
    },
    Make {
        name: "damped-stage",
        hides: &[Effect::Presliding, Effect::Stribeck],
        build: damped_stage,
    },
    Make {
        name: "sealed-cylinder",
        hides: &[Effect::Presliding],
        build: sealed_cylinder,
    },
    Make {
        name: "voice-coil",
        hides: &[Effect::TorqueSaturation],
        build: voice_coil,
    },
    Make {
        name: "torque-motor",
        hides: &[Effect::TorqueSaturation],
        build: torque_motor,
    },
    Make {
        name: "uneven-magnets",
        hides: &[Effect::TorqueConstantRipple],
        build: uneven_magnets,
    },
];

/// A linear motor with iron core at 8 kHz: cogging over a magnet pitch of 24 mm, light ball
/// guides, a scale whose interpolation errs by 30 nm within each period of 20 µm.
fn iron_core_stage(draw: &mut Draw, presence: Presence) -> Rig {
    let mass = draw.near(12.0);
    let amplitude = presence.size(draw.near(9.0));
    let mut train = Train::one(mass, draw.near(9.0), draw.near(25.0));
    let cogging = Field::Cogging {
        amplitude,
        waves: TAU / 0.024,
        phase: draw.between(0.0, TAU),
    };
    train.fields.push((0, cogging));
    let controller = Controller::state_feedback(mass, 25.0, 1.25e-4);
    let mut rig = rig(Kind::Linear, train, controller, 5.0e-9);
    rig.sensing.motor = Encoder::of(5.0e-9, Rounding::Nearest).with(Wave {
        amplitude: 3.0e-8,
        period: 2.0e-5,
        phase: 0.0,
    });
    rig.logs_current(1);
    rig.noisy(0.5);
    rig.know("torque_ripple_amplitude", amplitude, "N");
    rig.know("torque_ripple_period", 0.024, "m");
    rig.moved(
        draw,
        Room::about(0.12, (0.6, 8.0), 10.0),
        [Room::workshop, Room::waves],
        5.0,
    );
    rig
}

/// A stage of half a kilogram with a scale of one nanometre: eight Maxwell elements give way one
/// after the other over some micrometres.
fn nano_stage(draw: &mut Draw, presence: Presence) -> Rig {
    let (mass, coulomb) = (draw.near(0.5), draw.near(1.6));
    let deflection = draw.near(12.0e-6);
    let mut train = Train::one(mass, coulomb, draw.near(3.0));
    let slipping = Law::maxwell_slip(coulomb, deflection, 8);
    let gives_way = slipping.deflection();
    train.surfaces[0].law = presence.or(slipping, Law::coulomb(coulomb));
    let mut rig = rig(
        Kind::Linear,
        train,
        Controller::pid(mass, 30.0, 5.0e-4),
        1.0e-9,
    );
    rig.sensing.motor.rounding = Rounding::Nearest;
    rig.noisy(0.01);
    rig.know("presliding_deflection", presence.size(gives_way), "m");
    rig.moved(
        draw,
        Room::about(0.01, (0.03, 0.6), 15.0),
        [Room::jogs, Room::circles],
        8.0,
    );
    rig
}

/// A rotary table on rollers without gear: Dahl's law, some millidegrees before it slips.
fn roller_stage(draw: &mut Draw, presence: Presence) -> Rig {
    let (inertia, coulomb) = (draw.near(5.0), draw.near(14.0));
    let deflection = draw.near(1.2e-4);
    let mut train = Train::one(inertia, coulomb, draw.near(6.0));
    let bristles = Law::Dahl {
        coulomb,
        stiffness: coulomb / deflection,
    };
    train.surfaces[0].law = presence.or(bristles, Law::coulomb(coulomb));
    let controller = Controller::cascade(inertia, 5.0, 30.0, 1.0e-3);
    let mut rig = rig(Kind::Rotary, train, controller, TAU / 23_592_960.0);
    rig.noisy(0.1);
    rig.know("presliding_deflection", presence.size(deflection), "rad");
    rig.moved(
        draw,
        Room::about(1.5, (3.0, 12.0), 25.0),
        [Room::circles, Room::points],
        12.0,
    );
    rig
}

/// LuGre with a micro-damping that fades with velocity, and a fall besides: two effects of one
/// contact.
fn damped_stage(draw: &mut Draw, presence: Presence) -> Rig {
    let (mass, coulomb) = (draw.near(22.0), draw.near(18.0));
    let (deflection, excess) = (draw.near(9.0e-6), draw.near(0.6));
    let velocity = draw.near(0.012);
    let bristles = Law::LuGre {
        coulomb,
        stribeck: Some(Stribeck {
            excess,
            velocity,
            exponent: 2.0,
        }),
        stiffness: coulomb / deflection,
        micro_damping: 0.6 * (coulomb / deflection * mass).sqrt(),
        fade_velocity: 2.0e-3,
    };
    let mut train = Train::one(mass, coulomb, draw.near(60.0));
    train.surfaces[0].law = presence.or(bristles, Law::coulomb(coulomb));
    let mut rig = rig(
        Kind::Linear,
        train,
        Controller::pid(mass, 22.0, 5.0e-4),
        1.0e-8,
    );
    rig.noisy(0.3);
    rig.know("presliding_deflection", presence.size(deflection), "m");
    rig.know("stribeck_excess", presence.size(excess * coulomb), "N");
    rig.moved(
        draw,
        Room::about(0.06, (0.12, 1.5), 15.0),
        [Room::workshop, Room::circles],
        8.0,
    );
    rig
}

/// An electric cylinder with rubber seals: Bouc–Wen hysteresis over thirty micrometres.
fn sealed_cylinder(draw: &mut Draw, presence: Presence) -> Rig {
    let (mass, coulomb) = (draw.near(35.0), draw.near(70.0));
    let deflection = draw.near(30.0e-6);
    let rubber = Law::BoucWen {
        coulomb,
        stiffness: coulomb / deflection,
        exponent: 1.3,
    };
    let mut train = Train::one(mass, coulomb, draw.near(150.0));
    train.surfaces[0].law = presence.or(rubber, Law::coulomb(coulomb));
    let controller = Controller::cascade(mass, 5.0, 30.0, 1.0e-3);
    let mut rig = rig(Kind::Linear, train, controller, 1.0e-7);
    rig.stated.controller = true;
    rig.noisy(0.8);
    rig.know("presliding_deflection", presence.size(deflection), "m");
    rig.moved(
        draw,
        Room::about(0.05, (0.1, 1.0), 24.0),
        [Room::waves, Room::jogs],
        12.0,
    );
    rig
}

/// A voice coil in a short yoke at 2 kHz: force falls behind current as the yoke saturates.
fn voice_coil(draw: &mut Draw, presence: Presence) -> Rig {
    let mass = draw.near(0.8);
    let droop = presence.size(draw.near(0.006));
    let train = Train::one(mass, draw.near(1.2), draw.near(5.0));
    let mut rig = rig(
        Kind::Linear,
        train,
        Controller::pid(mass, 25.0, 5.0e-4),
        1.0e-8,
    );
    rig.drive.droop = droop;
    rig.noisy(0.05);
    rig.know("torque_saturation", droop, "1/N");
    rig.moved(
        draw,
        Room::about(0.012, (0.6, 40.0), 15.0),
        [Room::waves, Room::points],
        7.0,
    );
    rig
}

/// A torque motor of 50 kg m² that is driven to twice its rating: the teeth saturate. Current is
/// recorded from a drive at 8 kHz.
fn torque_motor(draw: &mut Draw, presence: Presence) -> Rig {
    let inertia = draw.near(50.0);
    let droop = presence.size(draw.near(3.0e-4));
    let train = Train::one(inertia, draw.near(60.0), draw.near(25.0));
    let controller = Controller::cascade(inertia, 5.0, 30.0, 1.25e-4);
    let mut rig = rig(Kind::Rotary, train, controller, TAU / 11_796_480.0);
    rig.drive.droop = droop;
    rig.drive.current_loop = CurrentLoop::First(3.0e-4);
    rig.column = EffortColumn::Current(1.0 / 23.0);
    rig.logs_current(8);
    rig.noisy(1.5);
    rig.know("torque_saturation", droop * 23.0, "1/A");
    rig.moved(
        draw,
        Room::about(2.5, (4.0, 16.0), 26.0),
        [Room::points, Room::workshop],
        12.0,
    );
    rig
}

/// An ironless linear motor whose magnets are of uneven strength: force per ampere varies by some
/// percent over a pole pair of 60 mm. At constant velocity it hardly shows.
fn uneven_magnets(draw: &mut Draw, presence: Presence) -> Rig {
    let mass = draw.near(6.0);
    let wave = ConstantRipple {
        share: draw.near(0.06),
        waves: TAU / 0.06,
        phase: draw.between(0.0, TAU),
    };
    let train = Train::one(mass, draw.near(4.0), draw.near(10.0));
    let controller = Controller::state_feedback(mass, 18.0, 5.0e-4);
    let mut rig = rig(Kind::Linear, train, controller, 1.0e-7);
    rig.drive.ripple = presence.or(Some(wave), None);
    rig.noisy(0.2);
    rig.know("torque_constant_ripple", presence.size(wave.share), "");
    rig.know("torque_constant_ripple_period", 0.06, "m");
    rig.moved(
        draw,
        Room::about(0.2, (0.9, 15.0), 15.0),
        [Room::points, Room::waves],
        7.0,
    );
    rig
}
