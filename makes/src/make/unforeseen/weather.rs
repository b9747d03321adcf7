//! Wind and weather: a blade of a turbine that is pitched, a fin that steadies a ship, the shaft
//! that lifts a tram's pantograph.
//!
//! A bearing that carries more rubs more (Harris, Rolling Bearing Analysis, 2001, ch. 14), a pinion
//! has play in its ring (Nordin and Gutman, Automatica 38, 2002). Water drags with velocity squared
//! (Newman, Marine Hydrodynamics, 1977, ch. 2). What a linkage feels of its arms goes with its
//! angle (Wittenburg, Dynamics of Multibody Systems, 2008).

use std::f64::consts::TAU;

use crate::control::Controller;
use crate::draw::Draw;
use crate::make::{Make, Presence, rig};
use crate::mechanics::field::Drag;
use crate::mechanics::friction::Scale;
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
        name: "blade-pitch",
        hides: &[Effect::Backlash, Effect::LoadDependentFriction],
        build: blade_pitch,
    },
    Make {
        name: "fin-stabiliser",
        hides: &[Effect::QuadraticDrag, Effect::Delay],
        build: fin_stabiliser,
    },
    Make {
        name: "pantograph-shaft",
        hides: &[Effect::PositionDependentInertia, Effect::ViscousAsymmetry],
        build: pantograph_shaft,
    },
];

/// A blade of a wind turbine on its ring, at 500 Hz with the rotor parked: the pinion has a tenth
/// of a degree of play, and the ring's bearing rubs with what it is turned by. Encoders sit on gear
/// and blade, wind-up is declared.
fn blade_pitch(draw: &mut Draw, presence: Presence) -> Rig {
    let (gear, blade) = (draw.near(1500.0), draw.near(2600.0));
    let (stiffness, coulomb) = (draw.near(1.2e8), draw.near(300.0));
    let gap = presence.size_of(Effect::Backlash, draw.near(1.6e-3));
    let share = presence.size_of(Effect::LoadDependentFriction, draw.near(0.2) / coulomb);
    let joint = Joint {
        gap,
        ..Joint::stiff(stiffness, 1.0e5)
    };
    let mut train = Train::one(gear, draw.near(150.0), draw.near(200.0)).then(
        joint,
        blade,
        coulomb,
        draw.near(500.0),
    );
    train.surfaces[1].scales.push(Scale::Load(share));
    let controller = Controller::cascade(gear + blade, 1.2, 6.0, 2.0e-3);
    let mut rig = rig(Kind::Rotary, train, controller, TAU / 33_554_432.0);
    rig.sensing.load = Some(Encoder::of(TAU / 524_288.0, Rounding::Nearest));
    rig.declare(Effect::Compliance);
    rig.noisy(6.0);
    rig.know("compliance_stiffness", stiffness, "N m/rad");
    rig.know("backlash_gap", gap, "rad");
    rig.know("load_dependent_friction", share * coulomb, "");
    rig.moved(
        draw,
        Room::about(0.5, (0.3, 1.2), 48.0),
        [Room::packets, Room::shifts],
        26.0,
    );
    rig
}

/// A fin that steadies a ship against its rolling, at 500 Hz: water drags with velocity squared,
/// and a command reaches the drive on the far side of the hull some cycles later.
fn fin_stabiliser(draw: &mut Draw, presence: Presence) -> Rig {
    let inertia = draw.near(260.0);
    let quadratic = presence.size_of(Effect::QuadraticDrag, draw.near(450.0));
    let delay_s = presence.size_of(Effect::Delay, draw.near(8.0e-3));
    let mut train = Train::one(inertia, draw.near(90.0), draw.near(160.0));
    train.drags[0].quadratic = quadratic;
    let controller = Controller::pid(inertia, 2.5, 2.0e-3);
    let mut rig = rig(Kind::Rotary, train, controller, TAU / 8_388_608.0);
    rig.drive.dead_time_s = delay_s;
    rig.noisy(3.0);
    rig.know("quadratic_drag", quadratic, "N m s2/rad2");
    rig.know("delay", delay_s, "s");
    rig.moved(
        draw,
        Room::about(0.45, (0.9, 3.0), 40.0),
        [Room::swells, Room::packets],
        22.0,
    );
    rig
}

/// The shaft at the foot of a tram's pantograph, whose springs carry its weight, under an observer
/// of the disturbance: its arms unfold with its angle, and a damper brakes it on the way down.
fn pantograph_shaft(draw: &mut Draw, presence: Presence) -> Rig {
    let (inertia, viscous) = (draw.near(14.0), draw.near(16.0));
    let share = presence.size_of(Effect::PositionDependentInertia, draw.near(0.3));
    let asymmetry = presence.size_of(Effect::ViscousAsymmetry, -draw.near(0.5));
    let mut train = Train::one(inertia, draw.near(12.0), viscous);
    train.inertias[0] = Inertia::Harmonic {
        mean: inertia,
        share,
        waves: 2.0,
        phase: draw.between(0.0, TAU),
    };
    train.drags[0] = Drag {
        forward: viscous * (1.0 + asymmetry),
        backward: viscous * (1.0 - asymmetry),
        ..Drag::default()
    };
    let controller = Controller::rejecting(inertia, 5.0, 1.0e-3);
    let mut rig = rig(Kind::Rotary, train, controller, TAU / 16_777_216.0);
    rig.noisy(0.6);
    rig.know("position_dependent_inertia", share * inertia, "kg m2");
    rig.know("viscous_asymmetry", asymmetry * viscous, "N m s/rad");
    rig.moved(
        draw,
        Room::about(1.1, (1.8, 9.0), 26.0),
        [Room::weaving, Room::seek],
        14.0,
    );
    rig
}
