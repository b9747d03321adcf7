//! Water, glass, saw and stone: axes that feed a tool.
//!
//! A throttle in a hydraulic line drags by direction; rails that are not parallel bind toward both
//! ends (Slocum, Precision Machine Design, 1992, ch. 8); a lap that is pressed by its wedge rubs
//! with the force it is driven by.

use std::f64::consts::TAU;

use crate::control::{Controller, Law as Control};
use crate::draw::Draw;
use crate::make::unseen::GRAVITY_M_S2;
use crate::make::{Make, Presence, rig};
use crate::mechanics::field::{Drag, Field};
use crate::mechanics::friction::Scale;
use crate::mechanics::joint::Joint;
use crate::mechanics::train::Train;
use crate::motion::Room;
use crate::rig::{Kind, Rig};
use crate::sensing::{Encoder, Noise, Rounding};
use crate::truth::Effect;

/// The family.
pub const MAKES: &[Make] = &[
    Make {
        name: "waterjet-gantry",
        hides: &[Effect::Compliance, Effect::ViscousAsymmetry],
        build: waterjet_gantry,
    },
    Make {
        name: "glass-cutting-bridge",
        hides: &[Effect::TorqueRipple, Effect::PositionDependentFriction],
        build: glass_cutting_bridge,
    },
    Make {
        name: "bandsaw-head",
        hides: &[Effect::ViscousAsymmetry, Effect::Offset],
        build: bandsaw_head,
    },
    Make {
        name: "honing-stroke",
        hides: &[Effect::LoadDependentFriction, Effect::FrictionDrift],
        build: honing_stroke,
    },
];

/// A gantry over a water basin on rack and pinion, with a scale: wind-up of its gear, bellows that
/// pump more air one way, and a loop that lags by its velocity over its gain, as older path
/// controls have it.
fn waterjet_gantry(draw: &mut Draw, presence: Presence) -> Rig {
    let (motor, bridge) = (draw.near(90.0), draw.near(65.0));
    let stiffness = draw.near(6.0e6);
    let [first, last, viscous] = [draw.near(60.0), draw.near(90.0), draw.near(140.0)];
    let asymmetry = presence.size_of(Effect::ViscousAsymmetry, draw.near(0.45));
    let soft = Train::one(motor, first, viscous).then(
        Joint::stiff(stiffness, 5.0e3),
        bridge,
        last,
        viscous,
    );
    let bolted = Train::one(motor + bridge, first + last, 2.0 * viscous);
    let is_soft = presence.has(Effect::Compliance);
    let mut train = if is_soft { soft } else { bolted };
    for drag in &mut train.drags {
        drag.forward *= 1.0 + asymmetry;
        drag.backward *= 1.0 - asymmetry;
    }
    let mut controller = Controller::cascade(motor + bridge, 7.0, 30.0, 1.0e-3);
    if let Control::Cascade { feedforward, .. } = &mut controller.law {
        *feedforward = false;
    }
    let mut rig = rig(Kind::Linear, train, controller, 2.0e-7);
    rig.sensing.load = Some(Encoder::of(1.0e-6, Rounding::Nearest));
    rig.noisy(3.0);
    rig.know("compliance_stiffness", stiffness, "N/m");
    rig.know("viscous_asymmetry", 2.0 * asymmetry * viscous, "N s/m");
    rig.moved(
        draw,
        Room::about(0.35, (0.8, 4.0), 26.0),
        [Room::waves, Room::circles],
        13.0,
    );
    rig
}

/// The bridge of a glass cutter on an iron-core motor: it cogs over the pitch of its magnets and
/// over the sixth of it that its teeth make, and its rails bind toward both ends. At 2 kHz, under
/// state feedback.
fn glass_cutting_bridge(draw: &mut Draw, presence: Presence) -> Rig {
    let mass = draw.near(38.0);
    let magnets = presence.size_of(Effect::TorqueRipple, draw.near(14.0));
    let teeth = presence.size_of(Effect::TorqueRipple, draw.near(6.0));
    let bowl = presence.size_of(Effect::PositionDependentFriction, draw.near(2.4));
    let mut train = Train::one(mass, draw.near(24.0), draw.near(45.0));
    train.surfaces[0].scales.push(Scale::Bowl(bowl));
    for (amplitude, period) in [(magnets, 0.048), (teeth, 0.008)] {
        let cogging = Field::Cogging {
            amplitude,
            waves: TAU / period,
            phase: draw.between(0.0, TAU),
        };
        train.fields.push((0, cogging));
    }
    let controller = Controller::state_feedback(mass, 11.0, 5.0e-4);
    let mut rig = rig(Kind::Linear, train, controller, 5.0e-8);
    rig.noisy(1.0);
    rig.know("torque_ripple_amplitude", magnets, "N");
    rig.know("torque_ripple_period", 0.048, "m");
    rig.moved(
        draw,
        Room::about(0.75, (1.0, 5.0), 18.0),
        [Room::weaving, Room::points],
        9.0,
    );
    rig
}

/// The head of a bandsaw, which is let down through a throttle and lifted freely, and of which the
/// counterweight carries too little. A coarse scale, at 500 Hz.
fn bandsaw_head(draw: &mut Draw, presence: Presence) -> Rig {
    let (mass, viscous) = (draw.near(120.0), draw.near(1300.0));
    let asymmetry = presence.size_of(Effect::ViscousAsymmetry, draw.near(0.5));
    let weight = presence.size_of(Effect::Offset, draw.near(0.15) * mass * GRAVITY_M_S2);
    let mut train = Train::one(mass, draw.near(95.0), viscous);
    train.drags[0] = Drag {
        forward: viscous * (1.0 - asymmetry),
        backward: viscous * (1.0 + asymmetry),
        ..Drag::default()
    };
    train.fields.push((0, Field::Constant(-weight)));
    let mut controller = Controller::pid(mass, 4.0, 2.0e-3);
    controller.filter_share = 0.3;
    let mut rig = rig(Kind::Linear, train, controller, 2.0e-6);
    rig.base.retain(|effect| *effect != Effect::Offset);
    rig.noisy(2.0);
    rig.know("viscous_asymmetry", -asymmetry * viscous, "N s/m");
    rig.know("offset", weight, "N");
    rig.moved(
        draw,
        Room::about(0.16, (0.14, 0.9), 40.0),
        [Room::strokes, Room::jogs],
        20.0,
    );
    rig
}

/// The stroke of a honing machine, whose stones are pressed on by a wedge: what drives them rubs,
/// and the cold honing oil rubs more. Under a velocity loop alone, without a recorded setpoint; the
/// amplifier's sensor picks up mains.
fn honing_stroke(draw: &mut Draw, presence: Presence) -> Rig {
    let (mass, coulomb) = (draw.near(45.0), draw.near(60.0));
    let share = presence.size_of(Effect::LoadDependentFriction, draw.near(0.16) / coulomb);
    let surplus = presence.size_of(Effect::FrictionDrift, draw.near(0.6));
    let mut train = Train::one(mass, coulomb, draw.near(90.0));
    train.surfaces[0].scales.extend([
        Scale::Load(share),
        Scale::WarmUp {
            surplus,
            time_constant_s: draw.near(6.0),
        },
    ]);
    let controller = Controller::velocity(mass, 30.0, 5.0e-4);
    let mut rig = rig(Kind::Linear, train, controller, 5.0e-8);
    rig.sensing.reference = false;
    rig.sensing.effort.noise = Noise {
        white: 1.2,
        pink: 0.0,
        mains: 1.5,
    };
    rig.know("load_dependent_friction", share * coulomb, "");
    rig.know("friction_drift_gain", surplus, "");
    rig.moved(
        draw,
        Room::about(0.12, (0.7, 9.0), 18.0),
        [Room::strokes, Room::waves],
        10.0,
    );
    rig
}
