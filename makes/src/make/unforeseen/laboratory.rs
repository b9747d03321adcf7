//! Clinics and clean rooms: a syringe that doses, a chuck that spins resist out, an arm that
//! dresses a polishing pad.
//!
//! A seal has less friction the faster it slides (Stribeck, VDI-Z. 46, 1902), and what is pressed
//! through an orifice resists with velocity squared (Merritt, Hydraulic Control Systems, 1967, ch.
//! 3). A disc in air drags with velocity squared where the flow is turbulent (Schlichting,
//! Boundary-Layer Theory, 1979, ch. 21).

use std::f64::consts::TAU;

use crate::control::Controller;
use crate::draw::Draw;
use crate::drive::ConstantRipple;
use crate::make::{Make, Presence, rig};
use crate::mechanics::friction::{Law, Scale, Stribeck};
use crate::mechanics::train::Train;
use crate::motion::{Motion, Programme, Room};
use crate::rig::{EffortColumn, Kind, Rig};
use crate::truth::Effect;

/// The family.
pub const MAKES: &[Make] = &[
    Make {
        name: "contrast-syringe",
        hides: &[Effect::Stribeck, Effect::QuadraticDrag],
        build: contrast_syringe,
    },
    Make {
        name: "spin-coater",
        hides: &[Effect::QuadraticDrag, Effect::FrictionDrift],
        build: spin_coater,
    },
    Make {
        name: "pad-dresser",
        hides: &[
            Effect::Stribeck,
            Effect::TorqueConstantRipple,
            Effect::Delay,
        ],
        build: pad_dresser,
    },
];

/// The plunger of an injector of contrast medium: its seal sticks by Tustin's law, and the cannula
/// resists with velocity squared. The drive records its velocity.
fn contrast_syringe(draw: &mut Draw, presence: Presence) -> Rig {
    let (mass, coulomb) = (draw.near(0.4), draw.near(2.2));
    let excess = presence.size_of(Effect::Stribeck, draw.near(0.9));
    let quadratic = presence.size_of(Effect::QuadraticDrag, draw.near(160.0));
    let mut train = Train::one(mass, coulomb, draw.near(8.0));
    train.surfaces[0].law = Law::Rigid {
        coulomb,
        stribeck: Some(Stribeck {
            excess,
            velocity: draw.near(0.004),
            exponent: 1.0,
        }),
    };
    train.drags[0].quadratic = quadratic;
    let controller = Controller::state_feedback(mass, 14.0, 1.0e-3);
    let mut rig = rig(Kind::Linear, train, controller, 2.0e-7);
    rig.sensing.velocity = Some(1.0e-5);
    rig.noisy(0.03);
    rig.know("stribeck_excess", excess * coulomb, "N");
    rig.know("quadratic_drag", quadratic, "N s2/m2");
    rig.moved(
        draw,
        Room::about(0.03, (0.13, 2.5), 22.0),
        [Room::ladder, Room::shifts],
        14.0,
    );
    rig
}

/// The chuck of a spin coater on its maker's test bench, without a loop under doublets of torque,
/// at 2 kHz: air drags at the wafer with velocity squared, and the seal of its shaft warms up.
fn spin_coater(draw: &mut Draw, presence: Presence) -> Rig {
    let inertia = draw.near(8.0e-4);
    let quadratic = presence.size_of(Effect::QuadraticDrag, draw.near(2.0e-6));
    let surplus = presence.size_of(Effect::FrictionDrift, draw.near(0.9));
    let time_constant_s = draw.near(9.0);
    let mut train = Train::one(inertia, draw.near(0.012), draw.near(6.0e-5));
    train.surfaces[0].scales.push(Scale::WarmUp {
        surplus,
        time_constant_s,
    });
    train.drags[0].quadratic = quadratic;
    let controller = Controller::open(5.0e-4);
    let mut rig = rig(Kind::Rotary, train, controller, TAU / 1_048_576.0);
    rig.noisy(6.0e-4);
    rig.know("quadratic_drag", quadratic, "N m s2/rad2");
    rig.know("friction_drift_gain", surplus, "");
    rig.know("friction_drift_time_constant", time_constant_s, "s");
    let doublets = |seed| Motion::Effort(Programme::Doublets(0.1, 1.2, seed));
    rig.training = (doublets(21), 30.0);
    rig.validation = (doublets(34), 18.0);
    rig
}

/// Pole pairs of the dresser's motor.
const DRESSER_POLE_PAIRS: f64 = 22.0;
/// Its torque per ampere, N m/A.
const DRESSER_NM_PER_A: f64 = 2.8;

/// The arm that sweeps a diamond disc over a polishing pad: slurry carries it the more the faster
/// it sweeps, its pole pairs are uneven, and a command waits for some cycles. In
/// amperes, in steps of ten milliamperes.
fn pad_dresser(draw: &mut Draw, presence: Presence) -> Rig {
    let (inertia, coulomb) = (draw.near(1.8), draw.near(6.0));
    let excess = presence.size_of(Effect::Stribeck, draw.near(0.8));
    let delay_s = presence.size_of(Effect::Delay, draw.near(5.0e-3));
    let wave = ConstantRipple {
        share: presence.size_of(Effect::TorqueConstantRipple, draw.near(0.08)),
        waves: DRESSER_POLE_PAIRS,
        phase: draw.between(0.0, TAU),
    };
    let mut train = Train::one(inertia, coulomb, draw.near(4.0));
    train.surfaces[0].law = Law::Rigid {
        coulomb,
        stribeck: Some(Stribeck {
            excess,
            velocity: draw.near(0.06),
            exponent: 2.0,
        }),
    };
    let controller = Controller::cascade(inertia, 2.8, 14.0, 1.0e-3);
    let mut rig = rig(Kind::Rotary, train, controller, TAU / 16_777_216.0);
    rig.column = EffortColumn::Current(1.0 / DRESSER_NM_PER_A);
    rig.drive.dead_time_s = delay_s;
    rig.drive.ripple = Some(wave);
    rig.noisy(0.06);
    rig.sensing.effort.quantum = 0.01 * DRESSER_NM_PER_A;
    let excess_a = excess * coulomb / DRESSER_NM_PER_A;
    rig.know("stribeck_excess", excess_a, "A");
    rig.know("torque_constant_ripple", wave.share, "");
    rig.know("torque_constant_ripple_order", DRESSER_POLE_PAIRS, "1/rev");
    rig.know("delay", delay_s, "s");
    rig.moved(
        draw,
        Room::about(0.6, (1.4, 11.0), 26.0),
        [Room::errands, Room::strokes],
        14.0,
    );
    rig
}
