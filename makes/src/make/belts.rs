//! Belt and rack axes: long, light or very heavy, soft.
//!
//! The stiffness of a belt depends on where the carriage stands, EA·(1/l + 1/(L − l)).

use crate::control::{Controller, Sensor};
use crate::draw::Draw;
use crate::make::{Make, Presence, rig};
use crate::mechanics::field::Drag;
use crate::mechanics::friction::Scale;
use crate::mechanics::inertia::Inertia;
use crate::mechanics::joint::{Joint, Stiffness};
use crate::mechanics::train::Train;
use crate::motion::Room;
use crate::rig::{Kind, Rig};
use crate::sensing::{Encoder, Rounding};
use crate::truth::Effect;

/// The family.
pub const MAKES: &[Make] = &[
    Make {
        name: "belt-gantry",
        hides: &[Effect::Compliance],
        build: belt_gantry,
    },
    Make {
        name: "gripper-belt",
        hides: &[Effect::Payload],
        build: gripper_belt,
    },
    Make {
        name: "rack-portal",
        hides: &[Effect::Backlash, Effect::Compliance],
        build: rack_portal,
    },
    Make {
        name: "crane-trolley",
        hides: &[Effect::Payload, Effect::ViscousAsymmetry],
        build: crane_trolley,
    },
    Make {
        name: "tunnel-traverse",
        hides: &[Effect::QuadraticDrag],
        build: tunnel_traverse,
    },
    Make {
        name: "skewed-gantry",
        hides: &[Effect::PositionDependentFriction, Effect::ViscousAsymmetry],
        build: skewed_gantry,
    },
];

/// A laser cutter's carriage on a belt of 2 m, with a linear scale on the carriage. The stiffness
/// varies by a tenth over the travel; a model with one stiffness has to live with that.
fn belt_gantry(draw: &mut Draw, presence: Presence) -> Rig {
    let (pulley, carriage) = (draw.near(4.0), draw.near(7.0));
    let strain_stiffness_n = draw.near(9.0e5);
    let [first, last, viscous] = [draw.near(8.0), draw.near(14.0), draw.near(20.0)];
    let belt = Stiffness::Belt {
        strain_stiffness_n,
        length_m: 2.0,
        strand_m: 1.0,
    };
    let joint = Joint {
        stiffness: belt,
        ..Joint::stiff(0.0, 250.0)
    };
    let soft = Train::one(pulley, first, viscous).then(joint, carriage, last, viscous);
    let bolted = Train::one(pulley + carriage, first + last, 2.0 * viscous);
    let controller = Controller::cascade(pulley + carriage, 3.0, 16.0, 5.0e-4);
    let mut rig = rig(Kind::Linear, presence.or(soft, bolted), controller, 1.0e-6);
    rig.sensing.load = Some(Encoder::of(1.0e-6, Rounding::Nearest));
    rig.noisy(0.3);
    rig.know("compliance_stiffness", belt.at(0.0), "N/m");
    rig.moved(
        draw,
        Room::about(0.3, (0.8, 6.0), 15.0),
        [Room::points, Room::circles],
        8.0,
    );
    rig
}

/// A picker that takes up a part in the middle of the record and puts it down later: inertia is
/// one number at a time, and another one at another.
fn gripper_belt(draw: &mut Draw, presence: Presence) -> Rig {
    let empty = draw.near(3.0);
    let part = presence.size(draw.near(1.4));
    let mut train = Train::one(empty, draw.near(6.0), draw.near(9.0));
    train.inertias[0] = Inertia::Payload {
        empty,
        loaded: empty + part,
        at_s: vec![draw.between(7.0, 9.0), draw.between(16.0, 18.0)],
    };
    let mut rig = rig(
        Kind::Linear,
        train,
        Controller::pid(empty, 12.0, 1.0e-3),
        2.0e-6,
    );
    rig.noisy(0.15);
    rig.know("payload", part, "kg");
    rig.moved(
        draw,
        Room::about(0.25, (1.0, 8.0), 25.0),
        [Room::points, Room::workshop],
        14.0,
    );
    rig
}

/// A portal of two tonnes on rack and pinion, with scale: a gap of a tenth of a millimetre beside
/// the wind-up of gear and pinion, neither of them declared.
fn rack_portal(draw: &mut Draw, presence: Presence) -> Rig {
    let (motor, portal) = (draw.near(700.0), draw.near(1300.0));
    let gap = draw.near(90.0e-6);
    let stiffness = draw.near(6.0e7);
    let [first, last, viscous] = [draw.near(120.0), draw.near(420.0), draw.near(900.0)];
    let joint = Joint {
        gap,
        ..Joint::stiff(stiffness, 8.0e4)
    };
    let loose = Train::one(motor, first, viscous).then(joint, portal, last, viscous);
    let bolted = Train::one(motor + portal, first + last, 2.0 * viscous);
    let mut controller = Controller::cascade(motor + portal, 2.0, 12.0, 2.0e-3);
    controller.sensor = Sensor::Motor;
    let mut rig = rig(Kind::Linear, presence.or(loose, bolted), controller, 1.0e-6);
    rig.sensing.load = Some(Encoder::of(1.0e-6, Rounding::Nearest));
    rig.noisy(6.0);
    rig.know("backlash_gap", presence.size(gap), "m");
    rig.know("compliance_stiffness", stiffness, "N/m");
    rig.moved(
        draw,
        Room::about(0.6, (0.5, 1.2), 50.0),
        [Room::workshop, Room::points],
        24.0,
    );
    rig
}

/// A trolley of two tonnes at 250 Hz that is loaded for a part of the record, on a track that runs
/// lighter one way. Slow, heavy, coarse.
fn crane_trolley(draw: &mut Draw, presence: Presence) -> Rig {
    let (empty, viscous) = (draw.near(1300.0), draw.near(1500.0));
    let load = presence.size(draw.near(700.0));
    let asymmetry = presence.size(draw.near(0.3));
    let mut train = Train::one(empty, draw.near(260.0), viscous);
    train.inertias[0] = Inertia::Payload {
        empty,
        loaded: empty + load,
        at_s: vec![draw.between(18.0, 22.0)],
    };
    train.drags[0] = Drag {
        forward: viscous * (1.0 + asymmetry),
        backward: viscous * (1.0 - asymmetry),
        ..Drag::default()
    };
    let controller = Controller::cascade(empty, 1.2, 7.0, 4.0e-3);
    let mut rig = rig(Kind::Linear, train, controller, 5.0e-6);
    rig.noisy(6.0);
    rig.know("payload", load, "kg");
    rig.know("viscous_asymmetry", asymmetry * viscous, "N s/m");
    rig.moved(
        draw,
        Room::about(1.0, (0.6, 0.8), 60.0),
        [Room::points, Room::jogs],
        35.0,
    );
    rig
}

/// A sensor carriage across a wind tunnel: drag with velocity squared beside light friction.
fn tunnel_traverse(draw: &mut Draw, presence: Presence) -> Rig {
    let mass = draw.near(9.0);
    let quadratic = presence.size(draw.near(14.0));
    let mut train = Train::one(mass, draw.near(11.0), draw.near(6.0));
    train.drags[0].quadratic = quadratic;
    let controller = Controller::state_feedback(mass, 8.0, 1.0e-3);
    let mut rig = rig(Kind::Linear, train, controller, 1.0e-6);
    rig.noisy(0.3);
    rig.know("quadratic_drag", quadratic, "N s2/m2");
    rig.moved(
        draw,
        Room::about(0.8, (1.6, 8.0), 24.0),
        [Room::workshop, Room::points],
        12.0,
    );
    rig
}

/// A gantry that is pulled at one side: it binds more toward one end, and its brushes drag more
/// one way. Its encoder cuts off at two micrometres.
fn skewed_gantry(draw: &mut Draw, presence: Presence) -> Rig {
    let (mass, viscous) = (draw.near(45.0), draw.near(120.0));
    let slope = presence.size(draw.near(0.9));
    let asymmetry = presence.size(draw.near(0.35));
    let mut train = Train::one(mass, draw.near(38.0), viscous);
    train.surfaces[0].scales.push(Scale::Slope(slope));
    train.drags[0] = Drag {
        forward: viscous * (1.0 - asymmetry),
        backward: viscous * (1.0 + asymmetry),
        ..Drag::default()
    };
    let controller = Controller::cascade(mass, 4.0, 20.0, 1.0e-3);
    let mut rig = rig(Kind::Linear, train, controller, 2.0e-6);
    rig.noisy(0.8);
    rig.know("position_dependent_friction_linear", slope, "1/m");
    rig.know("viscous_asymmetry", -asymmetry * viscous, "N s/m");
    rig.moved(
        draw,
        Room::about(0.4, (0.7, 3.0), 28.0),
        [Room::circles, Room::workshop],
        14.0,
    );
    rig
}
