//! Feeds of machine tools and of a printer: screws and racks, vertical and horizontal.
//!
//! Friction of screws and seals falls with speed (Armstrong-Hélouvry, Control of Machines with
//! Friction, 1991, ch. 2), rises with the load of a flank and is larger while the oil is cold.

use std::f64::consts::TAU;

use crate::control::Controller;
use crate::control::pi::{Pi, Shape};
use crate::draw::Draw;
use crate::make::{Make, Presence, rig};
use crate::mechanics::field::Field;
use crate::mechanics::friction::{Law, Scale, Stribeck, Surface};
use crate::mechanics::train::Train;
use crate::motion::Room;
use crate::rig::{EffortColumn, Kind, Rig};
use crate::sensing::Noise;
use crate::truth::Effect;

/// The family.
pub const MAKES: &[Make] = &[
    Make {
        name: "wire-saw-feed",
        hides: &[Effect::FrictionDrift],
        build: wire_saw_feed,
    },
    Make {
        name: "preloaded-pinions",
        hides: &[Effect::LoadDependentFriction],
        build: preloaded_pinions,
    },
    Make {
        name: "printer-lift",
        hides: &[Effect::Stribeck],
        build: printer_lift,
    },
    Make {
        name: "cross-slide",
        hides: &[Effect::CoulombAsymmetry, Effect::Stribeck],
        build: cross_slide,
    },
];

/// Standard gravity, m/s².
const GRAVITY_M_S2: f64 = 9.806_65;

/// The feed of a wire saw: an ingot is lowered through wires at a few millimetres per second and
/// raised again. The slurry on its covers is stiff while it is cold. Torque of the motor is
/// recorded at 500 Hz; the integral is led back at the limit, which a cold rapid up reaches. One
/// row in two hundred is lost.
fn wire_saw_feed(draw: &mut Draw, presence: Presence) -> Rig {
    let (mass, coulomb, viscous) = (draw.near(180.0), draw.near(130.0), draw.near(1800.0));
    let surplus = draw.near(0.55);
    let time_constant_s = draw.near(15.0);
    let weight = 0.15 * mass * GRAVITY_M_S2;
    let mut train = Train::one(mass, coulomb, viscous);
    train.fields.push((0, Field::Constant(-weight)));
    train.surfaces[0].scales.push(Scale::WarmUp {
        surplus: presence.size(surplus),
        time_constant_s,
    });
    let rapid = Room::about(0.06, (0.06, 0.6), 60.0);
    let most = coulomb * (1.0 + surplus) + weight + viscous * 0.06 + mass * 0.6;
    let loops = Pi::of(mass, 3.0, 18.0, Shape::BackCalculation(0.95 * most));
    let mut rig = rig(Kind::Linear, train, Controller::pi(loops, 2.0e-3), 2.0e-8);
    rig.column = EffortColumn::Torque(0.005 / TAU);
    rig.stated.lead_m_per_rev = Some(0.005);
    rig.sensing.stamps.lost_share = 0.005;
    rig.noisy(1.5);
    rig.know("friction_drift_gain", presence.size(surplus), "");
    rig.know("friction_drift_time_constant", time_constant_s, "s");
    rig.moved(draw, rapid, [Room::workshop, Room::points], 25.0);
    rig
}

/// A gantry on a rack with two pinions that press against opposite flanks: no play, and friction
/// of the flanks that grows with the force they carry, F = Fc + μ|u|. Driven briskly, so that
/// braking turns the force over.
fn preloaded_pinions(draw: &mut Draw, presence: Presence) -> Rig {
    let (mass, coulomb) = (draw.near(420.0), draw.near(240.0));
    let share = presence.size(draw.near(0.15) / coulomb);
    let mut train = Train::one(mass, 0.0, draw.near(350.0));
    train.surfaces[0] = Surface::new(0, Law::coulomb(coulomb)).with(Scale::Load(share));
    let controller = Controller::cascade(mass, 5.0, 28.0, 5.0e-4);
    let mut rig = rig(Kind::Linear, train, controller, 2.0e-8);
    rig.column = EffortColumn::Current(1.0 / 210.0);
    rig.logs_current(2);
    rig.noisy(6.0);
    rig.know("load_dependent_friction", share * coulomb, "");
    rig.moved(
        draw,
        Room::about(0.6, (1.4, 5.0), 26.0),
        [Room::jogs, Room::points],
        12.0,
    );
    rig
}

/// The lift of a 3D printer's bed on a lead screw of four starts, at 800 Hz: a plastic nut that
/// sticks, with friction that falls as 1/(1 + (v/vs)²), under the weight of the bed.
fn printer_lift(draw: &mut Draw, presence: Presence) -> Rig {
    let (bed, reflected) = (draw.near(1.4), draw.near(3.0));
    let (mass, coulomb) = (bed + reflected, draw.near(9.0));
    let excess = presence.size(draw.near(0.8));
    let mut train = Train::one(mass, coulomb, draw.near(70.0));
    train.fields.push((0, Field::Constant(-bed * GRAVITY_M_S2)));
    let film = Scale::Film(excess, draw.near(0.006));
    train.surfaces[0].scales.push(film);
    let controller = Controller::cascade(mass, 5.0, 25.0, 1.25e-3);
    let mut rig = rig(Kind::Linear, train, controller, 2.0e-7);
    rig.column = EffortColumn::Current(1.0 / 39.0);
    rig.noisy(0.08);
    rig.know("stribeck_excess", excess * coulomb / 39.0, "A");
    rig.moved(
        draw,
        Room::about(0.08, (0.1, 1.0), 32.0),
        [Room::workshop, Room::jogs],
        16.0,
    );
    rig
}

/// The cross slide of a lathe under new wipers, at 625 Hz: their lips drag more toward the spindle
/// than away from it and grip at rest. No constant force is declared. The current sensor has 1/f
/// noise.
fn cross_slide(draw: &mut Draw, presence: Presence) -> Rig {
    let (mass, coulomb) = (draw.near(75.0), draw.near(95.0));
    let asymmetry = presence.size(draw.near(0.22));
    let excess = presence.size(draw.near(0.5));
    let mut train = Train::one(mass, coulomb, draw.near(420.0));
    train.surfaces[0].law = Law::Rigid {
        coulomb,
        stribeck: Some(Stribeck {
            excess,
            velocity: draw.near(0.009),
            exponent: 2.0,
        }),
    };
    train.surfaces[0].scales.push(Scale::Direction(-asymmetry));
    let controller = Controller::cascade(mass, 4.0, 24.0, 1.6e-3);
    let mut rig = rig(Kind::Linear, train, controller, 1.0e-7);
    rig.base.retain(|effect| *effect != Effect::Offset);
    rig.sensing.effort.noise = Noise {
        white: 0.5,
        pink: 0.8,
        mains: 0.0,
    };
    rig.know("coulomb_asymmetry", -asymmetry * coulomb, "N");
    rig.know("stribeck_excess", excess * coulomb, "N");
    rig.moved(
        draw,
        Room::about(0.09, (0.15, 1.5), 40.0),
        [Room::workshop, Room::circles],
        18.0,
    );
    rig
}
