//! What holds still: tailstock, clamp, valve.
//!
//! Lip seals grip at rest and let go by the root of velocity (Bo and Pavelescu, Wear 82, 1982). A
//! toggle moves its platen by a way that its angle changes, and its inertia goes with the square of
//! that (Wittenburg 2008). A key in its groove has play (Nordin and Gutman, Automatica 38, 2002).

use std::f64::consts::TAU;

use crate::control::Controller;
use crate::control::pi::{Pi, Shape};
use crate::draw::Draw;
use crate::make::{Make, Presence, rig};
use crate::mechanics::friction::{Law, Scale, Stribeck};
use crate::mechanics::inertia::Inertia;
use crate::mechanics::joint::Joint;
use crate::mechanics::train::Train;
use crate::motion::Room;
use crate::rig::{EffortColumn, Kind, Rig};
use crate::sensing::{Encoder, Noise, Rounding};
use crate::truth::Effect;

/// The family.
pub const MAKES: &[Make] = &[
    Make {
        name: "tailstock-quill",
        hides: &[Effect::Stribeck, Effect::CoulombAsymmetry],
        build: tailstock_quill,
    },
    Make {
        name: "toggle-platen",
        hides: &[Effect::PositionDependentInertia],
        build: toggle_platen,
    },
    Make {
        name: "penstock-valve",
        hides: &[Effect::Backlash, Effect::PositionDependentFriction],
        build: penstock_valve,
    },
];

/// Travel of the quill per turn of its motor, m.
const QUILL_LEAD_M: f64 = 0.004;

/// The quill of a tailstock between its seals: exponent one half, and one lip drags more than the
/// other. The motor's torque is recorded, at 1 kHz; no constant force is declared.
fn tailstock_quill(draw: &mut Draw, presence: Presence) -> Rig {
    let (mass, coulomb) = (draw.near(60.0), draw.near(110.0));
    let excess = presence.size_of(Effect::Stribeck, draw.near(0.9));
    let asymmetry = presence.size_of(Effect::CoulombAsymmetry, draw.near(0.2));
    let mut train = Train::one(mass, coulomb, draw.near(500.0));
    train.surfaces[0].law = Law::Rigid {
        coulomb,
        stribeck: Some(Stribeck {
            excess,
            velocity: draw.near(0.006),
            exponent: 0.5,
        }),
    };
    train.surfaces[0].scales.push(Scale::Direction(asymmetry));
    let loops = Pi::of(mass, 5.0, 28.0, Shape::VelocityForm(900.0));
    let controller = Controller::pi(loops, 1.0e-3);
    let per_force = QUILL_LEAD_M / TAU;
    let mut rig = rig(Kind::Linear, train, controller, 2.0e-8);
    rig.column = EffortColumn::Torque(per_force);
    rig.stated.lead_m_per_rev = Some(QUILL_LEAD_M);
    rig.base.retain(|effect| *effect != Effect::Offset);
    rig.noisy(1.2);
    rig.know("stribeck_excess", excess * coulomb * per_force, "N m");
    let asymmetry_nm = asymmetry * coulomb * per_force;
    rig.know("coulomb_asymmetry", asymmetry_nm, "N m");
    rig.moved(
        draw,
        Room::about(0.06, (0.12, 1.2), 28.0),
        [Room::ladder, Room::workshop],
        14.0,
    );
    rig
}

/// The platen of an injection moulder on its toggle, at 800 Hz under a lead compensator: what the
/// crosshead feels of it goes with the toggle's stretch, of which the travel shows half a wave.
fn toggle_platen(draw: &mut Draw, presence: Presence) -> Rig {
    let mass = draw.near(300.0);
    let share = presence.size_of(Effect::PositionDependentInertia, draw.near(0.35));
    let mut train = Train::one(mass, draw.near(240.0), draw.near(380.0));
    train.inertias[0] = Inertia::Harmonic {
        mean: mass,
        share,
        waves: TAU / 0.9,
        phase: draw.between(0.6, 1.6),
    };
    let controller = Controller::lead(mass, 7.0, 1.25e-3);
    let mut rig = rig(Kind::Linear, train, controller, 1.0e-7);
    rig.noisy(6.0);
    rig.know("position_dependent_inertia", share * mass, "kg");
    rig.moved(
        draw,
        Room::about(0.24, (0.8, 5.0), 28.0),
        [Room::points, Room::strokes],
        14.0,
    );
    rig
}

/// A butterfly valve in a penstock, at 500 Hz: its stem turns in a worn keyway, and its seat grips
/// about the closed place. Encoders sit on gear and stem, wind-up is declared, 1/f noise comes from
/// the shunt.
fn penstock_valve(draw: &mut Draw, presence: Presence) -> Rig {
    let (gear, disc) = (draw.near(0.8), draw.near(1.5));
    let stiffness = draw.near(3.0e5);
    let gap = presence.size_of(Effect::Backlash, draw.near(2.5e-3));
    let seat = Scale::Bump {
        centre: draw.between(-0.45, -0.35),
        width: draw.near(0.3),
        share: presence.size_of(Effect::PositionDependentFriction, draw.near(1.0)),
    };
    let joint = Joint {
        gap,
        ..Joint::stiff(stiffness, 250.0)
    };
    let mut train = Train::one(gear, draw.near(2.5), draw.near(2.0)).then(
        joint,
        disc,
        draw.near(9.0),
        draw.near(3.0),
    );
    train.surfaces[1].scales.push(seat);
    let controller = Controller::cascade(gear + disc, 2.0, 12.0, 2.0e-3);
    let mut rig = rig(Kind::Rotary, train, controller, TAU / 8_388_608.0);
    rig.sensing.load = Some(Encoder::of(TAU / 524_288.0, Rounding::Nearest));
    rig.declare(Effect::Compliance);
    rig.sensing.effort.noise = Noise {
        white: 0.08,
        pink: 0.1,
        mains: 0.0,
    };
    rig.know("backlash_gap", gap, "rad");
    rig.know("compliance_stiffness", stiffness, "N m/rad");
    rig.moved(
        draw,
        Room::about(0.75, (1.0, 5.0), 40.0),
        [Room::jogs, Room::workshop],
        20.0,
    );
    rig
}
