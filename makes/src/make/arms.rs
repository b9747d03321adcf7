//! Cranks and arms: inertia that is a function of the angle.
//!
//! J(x) a + ½ J'(x) v² (Wittenburg 2008): the second term is there at constant speed.

use std::f64::consts::TAU;

use crate::control::Controller;
use crate::draw::Draw;
use crate::drive::ConstantRipple;
use crate::make::{Make, Presence, rig};
use crate::mechanics::friction::Scale;
use crate::mechanics::inertia::Inertia;
use crate::mechanics::train::Train;
use crate::motion::Room;
use crate::rig::{Kind, Rig};
use crate::truth::Effect;

/// The family.
pub const MAKES: &[Make] = &[
    Make {
        name: "crank-press",
        hides: &[Effect::PositionDependentInertia],
        build: crank_press,
    },
    Make {
        name: "scara-arm",
        hides: &[Effect::PositionDependentInertia, Effect::FrictionDrift],
        build: scara_arm,
    },
    Make {
        name: "skewed-rotor",
        hides: &[Effect::TorqueConstantRipple],
        build: skewed_rotor,
    },
];

/// A crank drive under a velocity loop alone, without a recorded setpoint: the slide's mass goes
/// into the crank's inertia with sin², twice a turn.
fn crank_press(draw: &mut Draw, presence: Presence) -> Rig {
    let inertia = draw.near(1.1);
    let share = presence.size(draw.near(0.3));
    let mut train = Train::one(inertia, draw.near(3.5), draw.near(0.9));
    train.inertias[0] = Inertia::Harmonic {
        mean: inertia,
        share,
        waves: 2.0,
        phase: draw.between(0.0, TAU),
    };
    let controller = Controller::velocity(inertia, 18.0, 1.0e-3);
    let mut rig = rig(Kind::Rotary, train, controller, TAU / 1_048_576.0);
    rig.sensing.reference = false;
    rig.noisy(0.05);
    rig.know("position_dependent_inertia", share * inertia, "kg m2");
    rig.moved(
        draw,
        Room::about(9.0, (8.0, 25.0), 26.0),
        [Room::points, Room::waves],
        12.0,
    );
    rig
}

/// The first joint of a SCARA: the second link folds with it, the gear grease warms up. An
/// eccentric brake gives inertia over the angle of the first joint, once a turn.
fn scara_arm(draw: &mut Draw, presence: Presence) -> Rig {
    let inertia = draw.near(0.35);
    let share = presence.size(draw.near(0.35));
    let surplus = presence.size(draw.near(0.6));
    let mut train = Train::one(inertia, draw.near(2.2), draw.near(0.7));
    train.inertias[0] = Inertia::Harmonic {
        mean: inertia,
        share,
        waves: 1.0,
        phase: draw.between(0.0, TAU),
    };
    train.surfaces[0].scales.push(Scale::WarmUp {
        surplus,
        time_constant_s: draw.near(9.0),
    });
    let mut rig = rig(
        Kind::Rotary,
        train,
        Controller::pid(inertia, 12.0, 1.0e-3),
        TAU / 524_288.0,
    );
    rig.noisy(0.03);
    rig.know("position_dependent_inertia", share * inertia, "kg m2");
    rig.know("friction_drift_gain", surplus, "");
    rig.moved(
        draw,
        Room::about(2.4, (4.0, 20.0), 28.0),
        [Room::points, Room::workshop],
        14.0,
    );
    rig
}

/// A brushless motor whose rotor is not skewed: its torque constant varies six times per turn.
fn skewed_rotor(draw: &mut Draw, presence: Presence) -> Rig {
    let inertia = draw.near(4.0e-3);
    let wave = ConstantRipple {
        share: draw.near(0.08),
        waves: 6.0,
        phase: draw.between(0.0, TAU),
    };
    let train = Train::one(inertia, draw.near(0.06), draw.near(2.0e-3));
    let controller = Controller::cascade(inertia, 6.0, 35.0, 1.0e-3);
    let mut rig = rig(Kind::Rotary, train, controller, TAU / 131_072.0);
    rig.drive.ripple = presence.or(Some(wave), None);
    rig.noisy(1.0e-3);
    rig.know("torque_constant_ripple", presence.size(wave.share), "");
    rig.know("torque_constant_ripple_order", 6.0, "1/rev");
    rig.moved(
        draw,
        Room::about(5.0, (15.0, 150.0), 25.0),
        [Room::waves, Room::points],
        12.0,
    );
    rig
}
