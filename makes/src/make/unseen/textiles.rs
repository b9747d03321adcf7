//! Cloth: sewing, winding, warping.
//!
//! A crank puts the mass of its slide into the shaft's inertia with sin² (Wittenburg 2008). A
//! balloon of yarn drags with velocity squared (Padfield, Proc. R. Soc. A 245, 1958). A band brake
//! holds more in the sense in which its band tightens itself, by Euler's capstan.

use std::f64::consts::TAU;

use crate::control::Controller;
use crate::control::pi::{Pi, Shape};
use crate::draw::Draw;
use crate::make::{Make, Presence, rig};
use crate::mechanics::friction::Scale;
use crate::mechanics::inertia::Inertia;
use crate::mechanics::joint::Joint;
use crate::mechanics::train::Train;
use crate::motion::Room;
use crate::rig::{EffortColumn, Kind, Rig};
use crate::sensing::{Encoder, Rounding, Wave};
use crate::truth::Effect;

/// The family.
pub const MAKES: &[Make] = &[
    Make {
        name: "needle-bar-shaft",
        hides: &[
            Effect::PositionDependentInertia,
            Effect::FrictionDrift,
            Effect::LoggedLate,
        ],
        build: needle_bar_shaft,
    },
    Make {
        name: "yarn-traverse",
        hides: &[Effect::PitchError, Effect::QuadraticDrag],
        build: yarn_traverse,
    },
    Make {
        name: "warp-beam",
        hides: &[Effect::CoulombAsymmetry, Effect::FrictionDrift],
        build: warp_beam,
    },
];

/// The main shaft of a sewing machine: needle bar and take-up lever are a sixth of its inertia,
/// twice a turn, the oil of its sleeves is stiff in the morning, and the amperes come over a serial
/// line some milliseconds late.
fn needle_bar_shaft(draw: &mut Draw, presence: Presence) -> Rig {
    let inertia = draw.near(6.0e-5);
    let share = presence.size_of(Effect::PositionDependentInertia, draw.near(0.18));
    let surplus = presence.size_of(Effect::FrictionDrift, draw.near(0.7));
    let late_s = presence.size_of(Effect::LoggedLate, draw.near(6.0e-3));
    let mut train = Train::one(inertia, draw.near(0.012), draw.near(1.2e-4));
    train.inertias[0] = Inertia::Harmonic {
        mean: inertia,
        share,
        waves: 2.0,
        phase: draw.between(0.0, TAU),
    };
    train.surfaces[0].scales.push(Scale::WarmUp {
        surplus,
        time_constant_s: draw.near(6.0),
    });
    let controller = Controller::pid(inertia, 12.0, 1.25e-4);
    let mut rig = rig(Kind::Rotary, train, controller, TAU / 1_048_576.0);
    rig.column = EffortColumn::Current(1.0 / 0.045);
    rig.logs_current(8);
    rig.sensing.effort.late_s = late_s;
    rig.noisy(2.5e-4);
    let share_a = share * inertia / 0.045;
    rig.know("position_dependent_inertia", share_a, "A s2/rad");
    rig.know("friction_drift_gain", surplus, "");
    rig.know("logged_late", late_s, "s");
    rig.moved(
        draw,
        Room::about(15.0, (40.0, 500.0), 25.0),
        [Room::strokes, Room::index],
        12.0,
    );
    rig
}

/// The guide of a cross winder on a toothed belt, at 2 kHz under a sliding mode: the balloon of
/// yarn drags with velocity squared, and every tooth of the belt sits a little off on its pulley.
/// The belt's stretch is declared.
fn yarn_traverse(draw: &mut Draw, presence: Presence) -> Rig {
    let (pulley, guide) = (draw.near(1.2), draw.near(0.9));
    let stiffness = draw.near(4.0e5);
    let quadratic = presence.size_of(Effect::QuadraticDrag, draw.near(3.0));
    let mut train = Train::one(pulley, draw.near(3.0), draw.near(2.0)).then(
        Joint::stiff(stiffness, 90.0),
        guide,
        draw.near(4.0),
        draw.near(1.0),
    );
    train.drags[1].quadratic = quadratic;
    let wave = Wave {
        amplitude: presence.size_of(Effect::PitchError, draw.near(3.0e-5)),
        period: 0.005,
        phase: draw.between(0.0, TAU),
    };
    let controller = Controller::sliding(pulley + guide, 11.0, 90.0, 5.0e-4);
    let mut rig = rig(Kind::Linear, train, controller, 1.0e-7);
    rig.sensing.load = Some(Encoder::of(1.0e-6, Rounding::Nearest).with(wave));
    rig.declare(Effect::Compliance);
    rig.noisy(0.25);
    rig.know("compliance_stiffness", stiffness, "N/m");
    rig.know("pitch_error_amplitude", wave.amplitude, "m");
    rig.know("pitch_error_period", wave.period, "m");
    rig.know("quadratic_drag", quadratic, "N s2/m2");
    rig.moved(
        draw,
        Room::about(0.35, (2.6, 18.0), 16.0),
        [Room::strokes, Room::points],
        8.0,
    );
    rig
}

/// The let-off of a warp beam at 250 Hz: its band brake holds more against unwinding, and holds
/// more and more as its lining warms. No constant torque is declared. The integral is led back at
/// the limit.
fn warp_beam(draw: &mut Draw, presence: Presence) -> Rig {
    let (inertia, coulomb) = (draw.near(12.0), draw.near(25.0));
    let asymmetry = presence.size_of(Effect::CoulombAsymmetry, draw.near(0.25));
    let surplus = presence.size_of(Effect::FrictionDrift, -draw.near(0.4));
    let mut train = Train::one(inertia, coulomb, draw.near(5.0));
    train.surfaces[0].scales.extend([
        Scale::Direction(asymmetry),
        Scale::WarmUp {
            surplus,
            time_constant_s: draw.near(14.0),
        },
    ]);
    let loops = Pi::of(inertia, 1.2, 7.0, Shape::BackCalculation(140.0));
    let controller = Controller::pi(loops, 4.0e-3);
    let mut rig = rig(Kind::Rotary, train, controller, TAU / 1_048_576.0);
    rig.base.retain(|effect| *effect != Effect::Offset);
    rig.noisy(0.6);
    rig.know("coulomb_asymmetry", asymmetry * coulomb, "N m");
    rig.know("friction_drift_gain", surplus, "");
    rig.moved(
        draw,
        Room::about(2.5, (1.6, 3.0), 66.0),
        [Room::ladder, Room::jogs],
        30.0,
    );
    rig
}
