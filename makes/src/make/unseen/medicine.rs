//! Medicine: a joint that is worn, a mill for crowns.
//!
//! A strain-wave gear winds up and has friction of either kind, a level and a viscous part
//! (Taghirad and Bélanger, ASME J. Dyn. Syst. Meas. Control 120, 1998); both fall as its grease
//! warms.

use std::f64::consts::TAU;

use crate::control::Controller;
use crate::draw::Draw;
use crate::make::{Make, Presence, rig};
use crate::mechanics::field::WarmOil;
use crate::mechanics::friction::{Law, Scale, Stribeck};
use crate::mechanics::joint::Joint;
use crate::mechanics::train::Train;
use crate::motion::Room;
use crate::rig::{EffortColumn, Kind, Rig};
use crate::sensing::{Encoder, Rounding, Wave};
use crate::truth::Effect;

/// The family.
pub const MAKES: &[Make] = &[
    Make {
        name: "exoskeleton-knee",
        hides: &[Effect::Compliance, Effect::FrictionDrift],
        build: exoskeleton_knee,
    },
    Make {
        name: "dental-mill",
        hides: &[Effect::PitchError, Effect::Stribeck],
        build: dental_mill,
    },
];

/// The knee of an exoskeleton on a strain-wave gear with an encoder on either side: it winds up,
/// and its grease warms while the wearer walks. A sliding mode at 4 kHz; the current is logged at 1
/// kHz, in amperes.
fn exoskeleton_knee(draw: &mut Draw, presence: Presence) -> Rig {
    let (motor, shank) = (draw.near(0.9), draw.near(0.4));
    let stiffness = draw.near(1.6e4);
    let [first, last, viscous] = [draw.near(3.5), draw.near(1.2), draw.near(0.9)];
    let soft =
        Train::one(motor, first, viscous).then(Joint::stiff(stiffness, 14.0), shank, last, viscous);
    let bolted = Train::one(motor + shank, first + last, 2.0 * viscous);
    let is_soft = presence.has(Effect::Compliance);
    let mut train = if is_soft { soft } else { bolted };
    let surplus = presence.size_of(Effect::FrictionDrift, draw.near(0.6));
    let time_constant_s = draw.near(8.0);
    for surface in &mut train.surfaces {
        surface.scales.push(Scale::WarmUp {
            surplus,
            time_constant_s,
        });
    }
    for drag in &mut train.drags {
        drag.oil = Some(WarmOil {
            surplus,
            time_constant_s,
        });
    }
    let controller = Controller::sliding(motor + shank, 8.0, 90.0, 2.5e-4);
    let mut rig = rig(Kind::Rotary, train, controller, TAU / 67_108_864.0);
    rig.column = EffortColumn::Current(1.0 / 9.0);
    rig.logs_current(4);
    rig.sensing.load = Some(Encoder::of(TAU / 1_048_576.0, Rounding::Nearest));
    rig.noisy(0.15);
    rig.know("compliance_stiffness", stiffness, "N m/rad");
    rig.know("friction_drift_gain", surplus, "");
    rig.know("friction_drift_time_constant", time_constant_s, "s");
    rig.moved(
        draw,
        Room::about(0.9, (3.5, 22.0), 26.0),
        [Room::weaving, Room::waves],
        13.0,
    );
    rig
}

/// Travel of the mill per turn of its screw, m.
const MILL_LEAD_M: f64 = 0.002;

/// An axis of a mill for dental crowns: a rolled screw of 2 mm whose pitch wobbles once per turn,
/// and slides that stick at the feeds of a finishing cut. Its wind-up is declared. At 2 kHz, with
/// the controller in the file.
fn dental_mill(draw: &mut Draw, presence: Presence) -> Rig {
    let (screw, slide) = (draw.near(1.6), draw.near(0.9));
    let stiffness = draw.near(1.2e7);
    let (coulomb, excess) = (draw.near(6.0), draw.near(0.8));
    let excess = presence.size_of(Effect::Stribeck, excess);
    let mut train = Train::one(screw, draw.near(3.0), draw.near(14.0)).then(
        Joint::stiff(stiffness, 1500.0),
        slide,
        coulomb,
        draw.near(12.0),
    );
    train.surfaces[1].law = Law::Rigid {
        coulomb,
        stribeck: Some(Stribeck {
            excess,
            velocity: draw.near(0.004),
            exponent: 1.5,
        }),
    };
    let wave = Wave {
        amplitude: presence.size_of(Effect::PitchError, draw.near(4.0e-6)),
        period: MILL_LEAD_M,
        phase: draw.between(0.0, TAU),
    };
    let controller = Controller::cascade(screw + slide, 7.0, 40.0, 5.0e-4);
    let mut rig = rig(Kind::Linear, train, controller, 5.0e-9);
    rig.sensing.load = Some(Encoder::of(1.0e-7, Rounding::Nearest).with(wave));
    rig.stated.lead_m_per_rev = Some(MILL_LEAD_M);
    rig.stated.controller = true;
    rig.declare(Effect::Compliance);
    rig.noisy(0.1);
    rig.know("compliance_stiffness", stiffness, "N/m");
    rig.know("pitch_error_amplitude", wave.amplitude, "m");
    rig.know("pitch_error_period", wave.period, "m");
    rig.know("stribeck_excess", excess * coulomb, "N");
    rig.moved(
        draw,
        Room::about(0.035, (0.08, 2.5), 18.0),
        [Room::ladder, Room::circles],
        9.0,
    );
    rig
}
