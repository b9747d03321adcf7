//! Antennas and trackers: slow most of the time, and quick from one target to the next.
//!
//! Teeth of a pinion come into mesh so many times per turn (Smith, Gear Noise and Vibration,
//! 2003). Wind of its own motion drags at a reflector with velocity squared (Hirst and McKee,
//! Wind Forces on Parabolic Antennas, 1965).

use std::f64::consts::TAU;

use crate::control::Controller;
use crate::control::pi::{Pi, Shape};
use crate::draw::Draw;
use crate::drive::ConstantRipple;
use crate::make::{Make, Presence, rig};
use crate::mechanics::field::Field;
use crate::mechanics::friction::Law;
use crate::mechanics::joint::Joint;
use crate::mechanics::train::Train;
use crate::motion::Room;
use crate::rig::{EffortColumn, Kind, Rig};
use crate::sensing::{Encoder, Rounding};
use crate::truth::Effect;

/// The family.
pub const MAKES: &[Make] = &[
    Make {
        name: "tracking-antenna",
        hides: &[Effect::Compliance, Effect::TorqueRipple],
        build: tracking_antenna,
    },
    Make {
        name: "laser-tracker",
        hides: &[Effect::TorqueRipple, Effect::Presliding],
        build: laser_tracker,
    },
    Make {
        name: "radar-pedestal",
        hides: &[Effect::QuadraticDrag, Effect::TorqueConstantRipple],
        build: radar_pedestal,
    },
];

/// The azimuth of an antenna for satellites, at 500 Hz under a lead compensator: its pedestal winds
/// up, its pinion meshes thirty times per turn. Encoders sit on the motor's and the dish's side.
fn tracking_antenna(draw: &mut Draw, presence: Presence) -> Rig {
    let (motor, dish) = (draw.near(450.0), draw.near(800.0));
    let stiffness = draw.near(4.0e6);
    let [first, last, viscous] = [draw.near(45.0), draw.near(80.0), draw.near(90.0)];
    let soft =
        Train::one(motor, first, viscous).then(Joint::stiff(stiffness, 5.0e3), dish, last, viscous);
    let bolted = Train::one(motor + dish, first + last, 2.0 * viscous);
    let is_soft = presence.has(Effect::Compliance);
    let mut train = if is_soft { soft } else { bolted };
    let amplitude = presence.size_of(Effect::TorqueRipple, draw.near(35.0));
    let mesh = Field::Cogging {
        amplitude,
        waves: 30.0,
        phase: draw.between(0.0, TAU),
    };
    train.fields.push((0, mesh));
    let controller = Controller::lead(motor + dish, 2.2, 2.0e-3);
    let mut rig = rig(Kind::Rotary, train, controller, TAU / 67_108_864.0);
    rig.sensing.load = Some(Encoder::of(TAU / 33_554_432.0, Rounding::Nearest));
    rig.noisy(2.0);
    rig.know("compliance_stiffness", stiffness, "N m/rad");
    rig.know("torque_ripple_amplitude", amplitude, "N m");
    rig.know("torque_ripple_order", 30.0, "1/rev");
    rig.moved(
        draw,
        Room::about(1.2, (0.35, 0.35), 48.0),
        [Room::tracking, Room::points],
        24.0,
    );
    rig
}

/// The head of a laser tracker at 2 kHz: a motor without a gear that cogs twenty-four times per
/// turn under a lens that is heavier on one side, in bearings whose bristles bend by a milliradian
/// (LuGre). It creeps after its target, reversing often.
fn laser_tracker(draw: &mut Draw, presence: Presence) -> Rig {
    let (inertia, coulomb) = (draw.near(0.03), draw.near(0.14));
    let deflection = draw.near(1.5e-3);
    let slots = presence.size_of(Effect::TorqueRipple, draw.near(0.03));
    let lens = presence.size_of(Effect::TorqueRipple, draw.near(0.05));
    let mut train = Train::one(inertia, coulomb, draw.near(0.02));
    let bristles = Law::LuGre {
        coulomb,
        stribeck: None,
        stiffness: coulomb / deflection,
        micro_damping: draw.near(0.12),
        fade_velocity: 0.1,
    };
    if presence.has(Effect::Presliding) {
        train.surfaces[0].law = bristles;
    }
    for (amplitude, waves) in [(slots, 24.0), (lens, 1.0)] {
        let cogging = Field::Cogging {
            amplitude,
            waves,
            phase: draw.between(0.0, TAU),
        };
        train.fields.push((0, cogging));
    }
    let loops = Pi::of(inertia, 5.0, 28.0, Shape::BackCalculation(3.0));
    let controller = Controller::pi(loops, 5.0e-4);
    let mut rig = rig(Kind::Rotary, train, controller, TAU / 33_554_432.0);
    rig.noisy(3.0e-3);
    let shown = presence.size_of(Effect::Presliding, deflection);
    rig.know("torque_ripple_amplitude", lens, "N m");
    rig.know("torque_ripple_order", 1.0, "1/rev");
    rig.know("presliding_deflection", shown, "rad");
    rig.moved(
        draw,
        Room::about(2.4, (2.5, 12.0), 18.0),
        [Room::tracking, Room::weaving],
        9.0,
    );
    rig
}

/// The pedestal of a harbour radar under a velocity loop, without a recorded setpoint: its antenna
/// drags at the air, and the motor's torque per ampere varies twelve times a turn.
fn radar_pedestal(draw: &mut Draw, presence: Presence) -> Rig {
    let inertia = draw.near(6.0);
    let quadratic = presence.size_of(Effect::QuadraticDrag, draw.near(1.6));
    let wave = ConstantRipple {
        share: presence.size_of(Effect::TorqueConstantRipple, draw.near(0.08)),
        waves: 12.0,
        phase: draw.between(0.0, TAU),
    };
    let mut train = Train::one(inertia, draw.near(6.0), draw.near(1.2));
    train.drags[0].quadratic = quadratic;
    let controller = Controller::velocity(inertia, 16.0, 1.0e-3);
    let mut rig = rig(Kind::Rotary, train, controller, TAU / 8_388_608.0);
    rig.column = EffortColumn::Current(1.0 / 5.2);
    rig.drive.ripple = Some(wave);
    rig.sensing.reference = false;
    rig.noisy(0.4);
    rig.know("quadratic_drag", quadratic / 5.2, "A s2/rad2");
    rig.know("torque_constant_ripple", wave.share, "");
    rig.know("torque_constant_ripple_order", 12.0, "1/rev");
    rig.moved(
        draw,
        Room::about(9.0, (5.0, 7.0), 28.0),
        [Room::jogs, Room::ladder],
        14.0,
    );
    rig
}
