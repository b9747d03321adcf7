//! Geared rotary axes: worm, bevel, planet; counted in radians at the table.
//!
//! A gear has play (Nordin and Gutman, Automatica 38, 2002) and a worm's flanks rub with what they
//! carry (Niemann and Winter, Maschinenelemente III, 1986).

use std::f64::consts::TAU;

use crate::control::{Controller, Sensor};
use crate::draw::Draw;
use crate::make::{Make, Presence, rig};
use crate::mechanics::field::Field;
use crate::mechanics::friction::Scale;
use crate::mechanics::joint::Joint;
use crate::mechanics::train::Train;
use crate::motion::Room;
use crate::rig::{Kind, Rig};
use crate::sensing::{Encoder, Rounding, Wave};
use crate::truth::Effect;

/// The family.
pub const MAKES: &[Make] = &[
    Make {
        name: "worm-table",
        hides: &[Effect::Backlash],
        build: worm_table,
    },
    Make {
        name: "worm-hoist",
        hides: &[Effect::LoadDependentFriction],
        build: worm_hoist,
    },
    Make {
        name: "eccentric-table",
        hides: &[Effect::PitchError],
        build: eccentric_table,
    },
    Make {
        name: "slotted-servo",
        hides: &[Effect::TorqueRipple, Effect::Stribeck],
        build: slotted_servo,
    },
];

/// A dividing table on a worm, with an encoder on either side: play of some tenths of a millirad.
/// Most friction is at the table.
fn worm_table(draw: &mut Draw, presence: Presence) -> Rig {
    let (motor, table) = (draw.near(1.4), draw.near(1.8));
    let gap = presence.size(draw.near(4.0e-4));
    let stiffness = draw.near(6.0e5);
    let joint = Joint {
        gap,
        ..Joint::stiff(stiffness, 300.0)
    };
    let train = Train::one(motor, draw.near(1.5), draw.near(1.0)).then(
        joint,
        table,
        draw.near(7.0),
        draw.near(1.5),
    );
    let controller = Controller::cascade(motor + table, 3.5, 20.0, 1.0e-3);
    let mut rig = rig(Kind::Rotary, train, controller, TAU / 2_000_000.0);
    rig.sensing.load = Some(Encoder::counts(1_000_000.0));
    rig.declare(Effect::Compliance);
    rig.noisy(0.08);
    rig.know("backlash_gap", gap, "rad");
    rig.know("compliance_stiffness", stiffness, "N m/rad");
    rig.moved(
        draw,
        Room::about(2.0, (2.5, 8.0), 26.0),
        [Room::workshop, Room::circles],
        12.0,
    );
    rig
}

/// A worm that is self-locking or nearly so: its friction grows with the torque it carries, which
/// it does mostly while it accelerates.
fn worm_hoist(draw: &mut Draw, presence: Presence) -> Rig {
    let (inertia, coulomb) = (draw.near(0.08), draw.near(0.5));
    let share = presence.size(draw.near(0.2) / coulomb);
    let mut train = Train::one(inertia, coulomb, draw.near(0.04));
    train.surfaces[0].scales.push(Scale::Load(share));
    let mut rig = rig(
        Kind::Rotary,
        train,
        Controller::pid(inertia, 14.0, 1.0e-3),
        TAU / 1_048_576.0,
    );
    rig.noisy(0.015);
    rig.know("load_dependent_friction", share * coulomb, "");
    rig.moved(
        draw,
        Room::about(6.0, (9.0, 60.0), 25.0),
        [Room::points, Room::waves],
        12.0,
    );
    rig
}

/// A rotary table whose ring scale sits off its centre by ten micrometres: an error of one period
/// per turn between motor and table.
fn eccentric_table(draw: &mut Draw, presence: Presence) -> Rig {
    let (motor, table) = (draw.near(0.6), draw.near(0.9));
    let wave = Wave {
        amplitude: presence.size(draw.near(1.2e-4)),
        period: TAU,
        phase: draw.between(0.0, TAU),
    };
    let stiffness = draw.near(3.0e5);
    let train = Train::one(motor, draw.near(0.8), draw.near(0.5)).then(
        Joint::stiff(stiffness, 120.0),
        table,
        draw.near(2.0),
        draw.near(0.8),
    );
    let mut controller = Controller::cascade(motor + table, 3.5, 20.0, 1.0e-3);
    controller.sensor = Sensor::Motor;
    let mut rig = rig(Kind::Rotary, train, controller, TAU / 4_194_304.0);
    rig.sensing.load = Some(Encoder::of(TAU / 2_097_152.0, Rounding::Nearest).with(wave));
    rig.declare(Effect::Compliance);
    rig.noisy(0.04);
    rig.know("pitch_error_amplitude", wave.amplitude, "rad");
    rig.know("pitch_error_period", TAU, "rad");
    rig.moved(
        draw,
        Room::about(7.0, (6.0, 15.0), 25.0),
        [Room::waves, Room::points],
        12.0,
    );
    rig
}

/// A small geared servo with twelve slots: cogging, a fall of friction in its grease, and 1/f
/// noise of a cheap current sensor.
fn slotted_servo(draw: &mut Draw, presence: Presence) -> Rig {
    let (inertia, coulomb) = (draw.near(2.0e-3), draw.near(0.05));
    let amplitude = presence.size(draw.near(0.018));
    let mut train = Train::one(inertia, coulomb, draw.near(1.5e-3));
    let cogging = Field::Cogging {
        amplitude,
        waves: 12.0,
        phase: draw.between(0.0, TAU),
    };
    train.fields.push((0, cogging));
    train.surfaces[0].law = crate::mechanics::friction::Law::Rigid {
        coulomb,
        stribeck: Some(crate::mechanics::friction::Stribeck {
            excess: presence.size(draw.near(0.8)),
            velocity: draw.near(0.9),
            exponent: 1.0,
        }),
    };
    let controller = Controller::cascade(inertia, 5.0, 30.0, 1.0e-3);
    let mut rig = rig(Kind::Rotary, train, controller, TAU / 262_144.0);
    rig.noisy(5.0e-4);
    rig.sensing.effort.noise.pink = 6.0e-4;
    rig.know("torque_ripple_amplitude", amplitude, "N m");
    rig.know("torque_ripple_order", 12.0, "1/rev");
    rig.moved(
        draw,
        Room::about(4.0, (12.0, 80.0), 26.0),
        [Room::workshop, Room::jogs],
        12.0,
    );
    rig
}
