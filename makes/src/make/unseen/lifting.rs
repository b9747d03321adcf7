//! Loads that are hooked on and put down: flies of a theatre, a mast, a slewing jib.
//!
//! Inertia comes with what hangs on it: friction of sheaves, a weight where nothing balances it
//! (Shapiro and Shapiro, Cranes and Derricks, 2011).

use std::f64::consts::TAU;

use crate::control::Controller;
use crate::control::pi::{Pi, Shape};
use crate::draw::Draw;
use crate::drive::CurrentLoop;
use crate::make::unseen::GRAVITY_M_S2;
use crate::make::{Make, Presence, rig};
use crate::mechanics::field::Field;
use crate::mechanics::friction::{Law, Scale, Stribeck};
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
        name: "theatre-fly",
        hides: &[Effect::Payload, Effect::Stribeck],
        build: theatre_fly,
    },
    Make {
        name: "pallet-mast",
        hides: &[Effect::Payload, Effect::TorqueRipple],
        build: pallet_mast,
    },
    Make {
        name: "slewing-jib",
        hides: &[Effect::Backlash],
        build: slewing_jib,
    },
];

/// A counterweighted fly bar at 500 Hz: scenery is hung on and as much weight is put on the
/// arbor, so that inertia and the friction of the sheaves grow and no force is left over. Its rope
/// guides stick at low speed. The integral is led back at the limit.
fn theatre_fly(draw: &mut Draw, presence: Presence) -> Rig {
    let (empty, coulomb) = (draw.near(160.0), draw.near(110.0));
    let scenery = presence.size_of(Effect::Payload, draw.near(110.0));
    let sheaves = presence.size_of(Effect::Payload, draw.near(0.35));
    let excess = presence.size_of(Effect::Stribeck, draw.near(0.7));
    let hung_s = [draw.between(13.0, 16.0), draw.between(31.0, 34.0)];
    let mut train = Train::one(empty, coulomb, draw.near(60.0));
    train.inertias[0] = Inertia::Payload {
        empty,
        loaded: empty + scenery,
        at_s: hung_s.to_vec(),
    };
    train.surfaces[0].law = Law::Rigid {
        coulomb,
        stribeck: Some(Stribeck {
            excess,
            velocity: draw.near(0.05),
            exponent: 2.0,
        }),
    };
    let with_scenery = Scale::During(sheaves, hung_s[0], hung_s[1]);
    train.surfaces[0].scales.push(with_scenery);
    let loops = Pi::of(empty, 2.5, 14.0, Shape::BackCalculation(2500.0));
    let mut rig = rig(Kind::Linear, train, Controller::pi(loops, 2.0e-3), 5.0e-7);
    rig.noisy(2.0);
    rig.know("payload", scenery, "kg");
    rig.know("stribeck_excess", excess * coulomb, "N");
    rig.moved(
        draw,
        Room::about(0.8, (0.9, 1.8), 48.0),
        [Room::workshop, Room::points],
        24.0,
    );
    rig
}

/// The fork of a stacker crane on a chain: a pallet brings its mass and its weight, and the
/// sprocket runs out once per turn, of which the travel has two or three. The carriage's own weight
/// is declared.
fn pallet_mast(draw: &mut Draw, presence: Presence) -> Rig {
    let (carriage, reflected) = (draw.near(70.0), draw.near(140.0));
    let empty = carriage + reflected;
    let pallet = presence.size_of(Effect::Payload, draw.near(45.0));
    let runout = presence.size_of(Effect::TorqueRipple, draw.near(55.0));
    let at_s = draw.between(11.0, 15.0);
    let mut train = Train::one(empty, draw.near(130.0), draw.near(240.0));
    train.inertias[0] = Inertia::Payload {
        empty,
        loaded: empty + pallet,
        at_s: vec![at_s],
    };
    let hangs = Field::Step {
        force: -pallet * GRAVITY_M_S2,
        at_s,
    };
    let sprocket = Field::Cogging {
        amplitude: runout,
        waves: TAU / 0.38,
        phase: draw.between(0.0, TAU),
    };
    let weight = Field::Constant(-carriage * GRAVITY_M_S2);
    train
        .fields
        .extend([(0, weight), (0, hangs), (0, sprocket)]);
    let controller = Controller::state_feedback(empty, 5.0, 1.0e-3);
    let mut rig = rig(Kind::Linear, train, controller, 1.0e-7);
    rig.stated.lead_m_per_rev = Some(0.38);
    rig.noisy(3.0);
    rig.know("payload", pallet, "kg");
    rig.know("torque_ripple_amplitude", runout, "N");
    rig.know("torque_ripple_period", 0.38, "m");
    rig.moved(
        draw,
        Room::about(0.5, (0.8, 3.0), 36.0),
        [Room::points, Room::workshop],
        16.0,
    );
    rig
}

/// Slewing gear of a harbour crane, at 250 Hz: play of a milliradian between pinion and ring, with
/// encoders on both and the wind-up declared. The converter is slow, and the file says how slow.
fn slewing_jib(draw: &mut Draw, presence: Presence) -> Rig {
    let (motor, jib) = (draw.near(9.0e3), draw.near(2.6e4));
    let stiffness = draw.near(6.0e8);
    let gap = presence.size_of(Effect::Backlash, draw.near(1.2e-3));
    let ring = Joint {
        gap,
        ..Joint::stiff(stiffness, 3.0e6)
    };
    let train = Train::one(motor, draw.near(400.0), draw.near(600.0)).then(
        ring,
        jib,
        draw.near(1600.0),
        draw.near(900.0),
    );
    let controller = Controller::cascade(motor + jib, 0.5, 2.6, 4.0e-3);
    let mut rig = rig(Kind::Rotary, train, controller, TAU / 67_108_864.0);
    rig.drive.current_loop = CurrentLoop::First(3.0e-3);
    rig.stated.effort_lag_s = Some(3.0e-3);
    rig.sensing.load = Some(Encoder::of(TAU / 4_194_304.0, Rounding::Nearest));
    rig.declare(Effect::Compliance);
    rig.noisy(25.0);
    rig.know("backlash_gap", gap, "rad");
    rig.know("compliance_stiffness", stiffness, "N m/rad");
    rig.moved(
        draw,
        Room::about(0.6, (0.35, 0.2), 76.0),
        [Room::points, Room::jogs],
        36.0,
    );
    rig
}
