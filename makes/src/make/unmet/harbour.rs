//! Harbours: a gangway that is drawn out, a gate of a lock, what pushes crates off a quay.
//!
//! A rack has play in its pinion (Nordin and Gutman, Automatica 38, 2002). Water drags with
//! velocity squared, F = ½ρ·C·A·v² (Newman, Marine Hydrodynamics, 1977, ch. 2), and an orifice that
//! a check valve bypasses is open one way only (Merritt, Hydraulic Control Systems, 1967, ch. 3).

use crate::control::Controller;
use crate::draw::Draw;
use crate::make::{Make, Presence, rig};
use crate::mechanics::field::Drag;
use crate::mechanics::friction::Scale;
use crate::mechanics::inertia::Inertia;
use crate::mechanics::joint::Joint;
use crate::mechanics::train::Train;
use crate::motion::Room;
use crate::rig::{EffortColumn, Kind, Rig};
use crate::sensing::{Encoder, Rounding};
use crate::truth::Effect;

/// The family.
pub const MAKES: &[Make] = &[
    Make {
        name: "gangway-telescope",
        hides: &[Effect::Backlash, Effect::ViscousAsymmetry],
        build: gangway_telescope,
    },
    Make {
        name: "lock-gate",
        hides: &[Effect::Compliance, Effect::QuadraticDrag],
        build: lock_gate,
    },
    Make {
        name: "crate-pusher",
        hides: &[Effect::Payload, Effect::LoadDependentFriction],
        build: crate_pusher,
    },
];

/// The inner tube of a gangway to a ship, on a rack at 500 Hz: play of more than a millimetre, and
/// a damper that is throttled on the way out. A scale lies along the tube, wind-up is declared.
fn gangway_telescope(draw: &mut Draw, presence: Presence) -> Rig {
    let (motor, tube) = (draw.near(400.0), draw.near(900.0));
    let (stiffness, viscous) = (draw.near(1.2e8), draw.near(1500.0));
    let gap = presence.size_of(Effect::Backlash, draw.near(1.5e-3));
    let asymmetry = presence.size_of(Effect::ViscousAsymmetry, draw.near(0.45));
    let joint = Joint {
        gap,
        ..Joint::stiff(stiffness, 8.0e4)
    };
    let mut train =
        Train::one(motor, draw.near(90.0), 0.0).then(joint, tube, draw.near(210.0), viscous);
    train.drags[1] = Drag {
        forward: viscous * (1.0 + asymmetry),
        backward: viscous * (1.0 - asymmetry),
        ..Drag::viscous(1, 0.0)
    };
    let controller = Controller::cascade(motor + tube, 1.5, 8.0, 2.0e-3);
    let mut rig = rig(Kind::Linear, train, controller, 1.0e-6);
    rig.sensing.load = Some(Encoder::of(2.0e-5, Rounding::Nearest));
    rig.declare(Effect::Compliance);
    rig.noisy(8.0);
    rig.know("backlash_gap", gap, "m");
    rig.know("compliance_stiffness", stiffness, "N/m");
    rig.know("viscous_asymmetry", asymmetry * viscous, "N s/m");
    rig.moved(
        draw,
        Room::about(1.2, (0.5, 0.8), 46.0),
        [Room::points, Room::packets],
        24.0,
    );
    rig
}

/// A leaf of a lock's gate and its rack, at 250 Hz: the springs of the strut give way by a tenth of
/// a millimetre, and the leaf drags in the water that it takes along. A wire tells where it stands.
fn lock_gate(draw: &mut Draw, presence: Presence) -> Rig {
    let (drive, leaf) = (draw.near(2500.0), draw.near(6000.0));
    let stiffness = draw.near(2.0e7);
    let [first, last, viscous] = [draw.near(400.0), draw.near(700.0), draw.near(600.0)];
    let quadratic = presence.size_of(Effect::QuadraticDrag, draw.near(7.0e3));
    let soft =
        Train::one(drive, first, viscous).then(Joint::stiff(stiffness, 6.0e4), leaf, last, viscous);
    let bolted = Train::one(drive + leaf, first + last, 2.0 * viscous);
    let is_soft = presence.has(Effect::Compliance);
    let mut train = if is_soft { soft } else { bolted };
    let in_water = train.load();
    train.drags[in_water].quadratic = quadratic;
    let controller = Controller::cascade(drive + leaf, 0.6, 3.2, 4.0e-3);
    let mut rig = rig(Kind::Linear, train, controller, 2.0e-7);
    rig.sensing.load = Some(Encoder::of(2.0e-6, Rounding::Nearest));
    rig.noisy(20.0);
    rig.know("compliance_stiffness", stiffness, "N/m");
    rig.know("quadratic_drag", quadratic, "N s2/m2");
    rig.moved(
        draw,
        Room::about(2.0, (0.5, 0.3), 80.0),
        [Room::seek, Room::points],
        44.0,
    );
    rig
}

/// Force of the pusher's motor per ampere, N/A.
const PUSHER_N_PER_A: f64 = 25.0;

/// What pushes crates with fish off a quay, under an observer of the disturbance: after a third of
/// the record it takes a full crate along on its rollers, and its nut rubs with what it pushes.
fn crate_pusher(draw: &mut Draw, presence: Presence) -> Rig {
    let (empty, coulomb) = (draw.near(90.0), draw.near(60.0));
    let share = presence.size_of(Effect::LoadDependentFriction, draw.near(0.17) / coulomb);
    let fish = presence.size_of(Effect::Payload, draw.near(50.0));
    let mut train = Train::one(empty, coulomb, draw.near(90.0));
    train.surfaces[0].scales.push(Scale::Load(share));
    train.inertias[0] = Inertia::Payload {
        empty,
        loaded: empty + fish,
        at_s: vec![draw.between(8.0, 10.0)],
    };
    let controller = Controller::rejecting(empty, 5.0, 1.0e-3);
    let mut rig = rig(Kind::Linear, train, controller, 1.0e-7);
    rig.column = EffortColumn::Current(1.0 / PUSHER_N_PER_A);
    rig.noisy(1.5);
    rig.know("load_dependent_friction", share * coulomb, "");
    rig.know("payload", fish / PUSHER_N_PER_A, "A s2/m");
    rig.moved(
        draw,
        Room::about(0.6, (0.9, 4.0), 30.0),
        [Room::jogs, Room::errands],
        20.0,
    );
    rig
}
