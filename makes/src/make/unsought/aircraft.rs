//! About aircraft: the screw of a flap, the support of a model in a wind tunnel, a winder of
//! fibres.
//!
//! A nut that has flown has play (Nordin and Gutman, Automatica 38, 2002). A model on a slender rod
//! swings on it (Rivin, Stiffness and Damping in Mechanical Design, 1999, ch. 6). Teeth of a rack
//! stand where the cutter has left them (Slocum, Precision Machine Design, 1992, ch. 10).

use std::f64::consts::TAU;

use crate::control::Controller;
use crate::control::pi::{Pi, Shape};
use crate::draw::Draw;
use crate::make::{Make, Presence, rig};
use crate::mechanics::joint::Joint;
use crate::mechanics::train::Train;
use crate::motion::Room;
use crate::rig::{EffortColumn, Kind, Rig};
use crate::sensing::{Encoder, Noise, Rounding, Wave};
use crate::truth::Effect;

/// The family.
pub const MAKES: &[Make] = &[
    Make {
        name: "flap-jackscrew",
        hides: &[Effect::Backlash],
        build: flap_jackscrew,
    },
    Make {
        name: "sting-support",
        hides: &[Effect::Compliance],
        build: sting_support,
    },
    Make {
        name: "filament-winder",
        hides: &[Effect::PitchError],
        build: filament_winder,
    },
];

/// Travel of the flap's nut per turn of its screw, m.
const FLAP_LEAD_M: f64 = 0.012;

/// The screw that drives a landing flap, in an overhaul shop at 800 Hz: its nut has worn, and has a
/// fifth of a millimetre of play. A probe follows the flap; wind-up is declared, and the motor's
/// torque is recorded.
fn flap_jackscrew(draw: &mut Draw, presence: Presence) -> Rig {
    let (screw, flap) = (draw.near(70.0), draw.near(45.0));
    let stiffness = draw.near(4.0e7);
    let gap = presence.size_of(Effect::Backlash, draw.near(2.0e-4));
    let joint = Joint {
        gap,
        ..Joint::stiff(stiffness, 9.0e3)
    };
    let train = Train::one(screw, draw.near(40.0), draw.near(150.0)).then(
        joint,
        flap,
        draw.near(45.0),
        draw.near(130.0),
    );
    let controller = Controller::cascade(screw + flap, 2.2, 11.0, 1.25e-3);
    let mut rig = rig(Kind::Linear, train, controller, 1.0e-7);
    rig.sensing.load = Some(Encoder::of(2.0e-6, Rounding::Nearest));
    rig.column = EffortColumn::Torque(FLAP_LEAD_M / TAU);
    rig.stated.lead_m_per_rev = Some(FLAP_LEAD_M);
    rig.declare(Effect::Compliance);
    rig.noisy(1.5);
    rig.know("compliance_stiffness", stiffness, "N/m");
    rig.know("backlash_gap", gap, "m");
    rig.moved(
        draw,
        Room::about(0.25, (0.3, 2.0), 28.0),
        [Room::strokes, Room::weaving],
        15.0,
    );
    rig
}

/// What sets the angle of a model in a wind tunnel without wind, at 500 Hz: the slender rod that
/// carries the model gives way. Encoders sit on the gear and in the model, and mains is in the log.
fn sting_support(draw: &mut Draw, presence: Presence) -> Rig {
    let (gear, model) = (draw.near(14.0), draw.near(18.0));
    let stiffness = draw.near(2.5e5);
    let [first, last] = [draw.near(10.0), draw.near(6.0)];
    let [fast, slow] = [draw.near(14.0), draw.near(5.0)];
    let soft =
        Train::one(gear, first, fast).then(Joint::stiff(stiffness, 200.0), model, last, slow);
    let bolted = Train::one(gear + model, first + last, fast + slow);
    let is_soft = presence.has(Effect::Compliance);
    let train = if is_soft { soft } else { bolted };
    let controller = Controller::pid(gear + model, 2.5, 2.0e-3);
    let mut rig = rig(Kind::Rotary, train, controller, TAU / 16_777_216.0);
    rig.sensing.load = Some(Encoder::of(TAU / 1_048_576.0, Rounding::Down));
    rig.sensing.effort.noise = Noise {
        white: 0.4,
        pink: 0.0,
        mains: 0.3,
    };
    rig.know("compliance_stiffness", stiffness, "N m/rad");
    rig.moved(
        draw,
        Room::about(0.35, (0.5, 2.5), 32.0),
        [Room::shifts, Room::seek],
        17.0,
    );
    rig
}

/// Radius of the pinion of the filament winder, m.
const WINDER_PINION_M: f64 = 0.04;
/// Way from tooth to tooth of its rack, m: module five.
const WINDER_TOOTH_M: f64 = 0.015_708;

/// The carriage that lays fibres on the tube of a fuselage, under an integral that is led back at
/// the limit: the teeth of its rack err by some hundredths of a millimetre. A tape is read on the
/// rail; wind-up is declared, and the motor's torque is recorded.
fn filament_winder(draw: &mut Draw, presence: Presence) -> Rig {
    let (gear, carriage) = (draw.near(35.0), draw.near(50.0));
    let stiffness = draw.near(2.0e7);
    let wave = Wave {
        amplitude: presence.size_of(Effect::PitchError, draw.near(2.2e-5)),
        period: WINDER_TOOTH_M,
        phase: draw.between(0.0, TAU),
    };
    let train = Train::one(gear, draw.near(18.0), draw.near(40.0)).then(
        Joint::stiff(stiffness, 7.0e3),
        carriage,
        draw.near(34.0),
        draw.near(50.0),
    );
    let loops = Pi::of(gear + carriage, 2.8, 14.0, Shape::BackCalculation(2.0e3));
    let mut rig = rig(Kind::Linear, train, Controller::pi(loops, 1.0e-3), 2.0e-7);
    rig.sensing.load = Some(Encoder::of(1.0e-6, Rounding::Nearest).with(wave));
    rig.column = EffortColumn::Torque(WINDER_PINION_M);
    rig.declare(Effect::Compliance);
    rig.noisy(1.5);
    rig.know("compliance_stiffness", stiffness, "N/m");
    rig.know("pitch_error_amplitude", wave.amplitude, "m");
    rig.know("pitch_error_period", wave.period, "m");
    rig.moved(
        draw,
        Room::about(0.9, (1.4, 5.0), 28.0),
        [Room::raster, Room::circles],
        15.0,
    );
    rig
}
