//! Wafers, dies and lenses: little friction, fine scales, high rates.
//!
//! Elements of Maxwell slip need not be even: here the first ones slip within a tenth of the whole
//! deflection (Al-Bender, Lampaert and Swevers, IEEE TAC 50, 2005).

use std::f64::consts::TAU;

use crate::control::Controller;
use crate::control::pi::{Pi, Shape};
use crate::draw::Draw;
use crate::drive::{ConstantRipple, CurrentLoop};
use crate::make::unseen::GRAVITY_M_S2;
use crate::make::{Make, Presence, rig};
use crate::mechanics::field::Field;
use crate::mechanics::friction::{Element, Law};
use crate::mechanics::train::Train;
use crate::motion::Room;
use crate::rig::{Kind, Rig};
use crate::sensing::Rounding;
use crate::truth::Effect;

/// The family.
pub const MAKES: &[Make] = &[
    Make {
        name: "chuck-pin-lift",
        hides: &[Effect::Presliding, Effect::Offset],
        build: chuck_pin_lift,
    },
    Make {
        name: "die-bonder",
        hides: &[
            Effect::TorqueSaturation,
            Effect::Delay,
            Effect::TorqueConstantRipple,
        ],
        build: die_bonder,
    },
    Make {
        name: "lens-barrel",
        hides: &[Effect::Presliding],
        build: lens_barrel,
    },
];

/// Ten elements of one limit; the k-th slips at (k/10)² of the deflection.
fn uneven_elements(coulomb: f64, deflection: f64) -> Law {
    let limit = coulomb / 10.0;
    let element = |k: i32| Element {
        stiffness: limit / (deflection * f64::from(k * k) / 100.0),
        limit,
    };
    Law::MaxwellSlip {
        elements: (1..=10).map(element).collect(),
    }
}

/// The pins that lift a wafer off its chuck, at 4 kHz: crossed rollers give way over a good ten
/// micrometres, and the spring that should carry the pins' weight carries too little of it.
fn chuck_pin_lift(draw: &mut Draw, presence: Presence) -> Rig {
    let (mass, coulomb) = (draw.near(3.0), draw.near(5.0));
    let deflection = draw.near(14.0e-6);
    let weight = presence.size_of(Effect::Offset, draw.near(0.3) * mass * GRAVITY_M_S2);
    let has_rollers = presence.has(Effect::Presliding);
    let rollers = uneven_elements(coulomb, deflection);
    let mut train = Train::one(mass, coulomb, draw.near(14.0));
    if has_rollers {
        train.surfaces[0].law = rollers.clone();
    }
    train.fields.push((0, Field::Constant(-weight)));
    let controller = Controller::pid(mass, 26.0, 2.5e-4);
    let mut rig = rig(Kind::Linear, train, controller, 2.0e-9);
    rig.sensing.motor.rounding = Rounding::Nearest;
    rig.base.retain(|effect| *effect != Effect::Offset);
    rig.noisy(0.03);
    let shown = presence.size_of(Effect::Presliding, rollers.deflection());
    rig.know("presliding_deflection", shown, "m");
    rig.know("offset", weight, "N");
    rig.moved(
        draw,
        Room::about(4.0e-3, (0.04, 0.8), 12.0),
        [Room::jogs, Room::strokes],
        6.0,
    );
    rig
}

/// The head of a die bonder at 8 kHz, which does little else than accelerate: iron saturates,
/// magnets are uneven over a pole pair of 30 mm, and the amplifier's own cycles are a good half of
/// a millisecond. A lead compensator closes the loop.
fn die_bonder(draw: &mut Draw, presence: Presence) -> Rig {
    let mass = draw.near(1.1);
    let droop = presence.size_of(Effect::TorqueSaturation, draw.near(3.5e-3));
    let delay_s = presence.size_of(Effect::Delay, draw.near(6.0e-4));
    let wave = ConstantRipple {
        share: presence.size_of(Effect::TorqueConstantRipple, draw.near(0.08)),
        waves: TAU / 0.03,
        phase: draw.between(0.0, TAU),
    };
    let train = Train::one(mass, draw.near(2.0), draw.near(5.0));
    let controller = Controller::lead(mass, 20.0, 1.25e-4);
    let mut rig = rig(Kind::Linear, train, controller, 2.0e-8);
    rig.drive.droop = droop;
    rig.drive.dead_time_s = delay_s;
    rig.drive.ripple = Some(wave);
    rig.noisy(0.4);
    rig.know("torque_saturation", droop, "1/N");
    rig.know("delay", delay_s, "s");
    rig.know("torque_constant_ripple", wave.share, "");
    rig.know("torque_constant_ripple_period", 0.03, "m");
    rig.moved(
        draw,
        Room::about(0.05, (1.1, 55.0), 9.0),
        [Room::points, Room::weaving],
        5.0,
    );
    rig
}

/// The focus ring of a cinema lens in its helicoid: grease that yields by Dahl's law over several
/// milliradians before it flows. A cheap controller in velocity form, a current loop of second
/// order, and nobody has written down the encoder's resolution.
fn lens_barrel(draw: &mut Draw, presence: Presence) -> Rig {
    let (inertia, coulomb) = (draw.near(2.0e-4), draw.near(0.03));
    let deflection = draw.near(5.0e-3);
    let grease = Law::Dahl {
        coulomb,
        stiffness: coulomb / deflection,
    };
    let mut train = Train::one(inertia, coulomb, draw.near(2.5e-3));
    if presence.has(Effect::Presliding) {
        train.surfaces[0].law = grease;
    }
    let loops = Pi::of(inertia, 4.0, 22.0, Shape::VelocityForm(0.5));
    let controller = Controller::pi(loops, 1.0e-3);
    let mut rig = rig(Kind::Rotary, train, controller, TAU / 2_097_152.0);
    rig.drive.current_loop = CurrentLoop::Second(900.0, 0.7);
    rig.stated.resolution = false;
    rig.noisy(4.0e-4);
    let shown = presence.size_of(Effect::Presliding, deflection);
    rig.know("presliding_deflection", shown, "rad");
    rig.moved(
        draw,
        Room::about(1.6, (5.0, 60.0), 26.0),
        [Room::tracking, Room::points],
        13.0,
    );
    rig
}
