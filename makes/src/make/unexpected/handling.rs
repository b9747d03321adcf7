//! Handling: a disc of tools, a head that picks parts, an arm that puts up cartons, the elbow of a
//! robot.
//!
//! A disc with heavy tools on one side is a pendulum. The wave generator of a strain-wave gear
//! pulls twice in every turn of its motor (Tuttle and Seering, IEEE Trans. Robot. Autom. 12, 1996).
//! What a crank moves goes with its angle (Wittenburg, Dynamics of Multibody Systems, 2008), and a
//! sheet of board drags in air with velocity squared.

use std::f64::consts::TAU;

use crate::control::Controller;
use crate::control::pi::{Pi, Shape};
use crate::draw::Draw;
use crate::drive::ConstantRipple;
use crate::make::{Make, Presence, rig};
use crate::mechanics::field::Field;
use crate::mechanics::friction::{Law, Stribeck};
use crate::mechanics::inertia::Inertia;
use crate::mechanics::train::Train;
use crate::motion::{Motion, Programme, Room};
use crate::rig::{EffortColumn, Kind, Rig};
use crate::sensing::Noise;
use crate::truth::Effect;

/// The family.
pub const MAKES: &[Make] = &[
    Make {
        name: "tool-disc",
        hides: &[Effect::TorqueRipple],
        build: tool_disc,
    },
    Make {
        name: "pick-head",
        hides: &[Effect::TorqueConstantRipple],
        build: pick_head,
    },
    Make {
        name: "carton-arm",
        hides: &[Effect::PositionDependentInertia, Effect::QuadraticDrag],
        build: carton_arm,
    },
    Make {
        name: "cobot-elbow",
        hides: &[Effect::Stribeck, Effect::TorqueRipple, Effect::LoggedLate],
        build: cobot_elbow,
    },
];

/// The upright disc that holds the tools of a milling machine, at 400 Hz with a gain that is higher
/// at rest: heavy tools hang on one side of it. Its encoder is coarse, and mains is in its log.
fn tool_disc(draw: &mut Draw, presence: Presence) -> Rig {
    let inertia = draw.near(38.0);
    let amplitude = presence.size_of(Effect::TorqueRipple, draw.near(24.0));
    let mut train = Train::one(inertia, draw.near(26.0), draw.near(14.0));
    let tools = Field::Cogging {
        amplitude,
        waves: 1.0,
        phase: draw.between(0.0, TAU),
    };
    train.fields.push((0, tools));
    let shape = Shape::Scheduled {
        extra: 1.0,
        knee: 0.3,
    };
    let loops = Pi::of(inertia, 1.4, 7.0, shape);
    let controller = Controller::pi(loops, 2.5e-3);
    let mut rig = rig(Kind::Rotary, train, controller, TAU / 1_048_576.0);
    rig.sensing.effort.noise = Noise {
        white: 0.6,
        pink: 0.0,
        mains: 0.6,
    };
    rig.know("torque_ripple_amplitude", amplitude, "N m");
    rig.know("torque_ripple_order", 1.0, "1/rev");
    rig.moved(
        draw,
        Room::about(9.0, (2.6, 4.5), 42.0),
        [Room::index, Room::points],
        32.0,
    );
    rig
}

/// Way from one pair of magnets to the next under the picking head, m.
const PICK_PITCH_M: f64 = 0.024;
/// Its force per ampere, N/A.
const PICK_N_PER_A: f64 = 22.0;

/// The head that picks parts off their tapes, on its linear motor without a loop, at 4 kHz: its
/// drive excites it with many sines at once, and its magnets are uneven. In amperes.
fn pick_head(draw: &mut Draw, presence: Presence) -> Rig {
    let mass = draw.near(1.9);
    let wave = ConstantRipple {
        share: presence.size_of(Effect::TorqueConstantRipple, draw.near(0.09)),
        waves: TAU / PICK_PITCH_M,
        phase: draw.between(0.0, TAU),
    };
    let train = Train::one(mass, draw.near(2.2), draw.near(9.0));
    let controller = Controller::open(2.5e-4);
    let mut rig = rig(Kind::Linear, train, controller, 1.0e-7);
    rig.column = EffortColumn::Current(1.0 / PICK_N_PER_A);
    rig.drive.ripple = Some(wave);
    rig.noisy(0.15);
    rig.know("torque_constant_ripple", wave.share, "");
    rig.know("torque_constant_ripple_period", PICK_PITCH_M, "m");
    let sines = |lowest_hz, lines| Motion::Effort(Programme::Multisine(12.0, lowest_hz, lines));
    rig.training = (sines(0.37, 30), 9.5);
    rig.validation = (sines(0.53, 18), 5.5);
    rig
}

/// Torque per ampere of the carton arm, N m/A.
const CARTON_NM_PER_A: f64 = 1.6;

/// The arm that puts up cartons, at 800 Hz under a lead compensator: its crank stretches once a
/// turn, and the sheet that it swings drags in the air. In amperes.
fn carton_arm(draw: &mut Draw, presence: Presence) -> Rig {
    let inertia = draw.near(0.9);
    let share = presence.size_of(Effect::PositionDependentInertia, draw.near(0.25));
    let quadratic = presence.size_of(Effect::QuadraticDrag, draw.near(0.14));
    let mut train = Train::one(inertia, draw.near(2.2), draw.near(0.4));
    train.inertias[0] = Inertia::Harmonic {
        mean: inertia,
        share,
        waves: 1.0,
        phase: draw.between(0.0, TAU),
    };
    train.drags[0].quadratic = quadratic;
    let controller = Controller::lead(inertia, 8.0, 1.25e-3);
    let mut rig = rig(Kind::Rotary, train, controller, TAU / 8_388_608.0);
    rig.column = EffortColumn::Current(1.0 / CARTON_NM_PER_A);
    rig.noisy(0.1);
    let share_a = share * inertia / CARTON_NM_PER_A;
    rig.know("position_dependent_inertia", share_a, "A s2/rad");
    rig.know("quadratic_drag", quadratic / CARTON_NM_PER_A, "A s2/rad2");
    rig.moved(
        draw,
        Room::about(7.0, (7.0, 32.0), 26.0),
        [Room::points, Room::shifts],
        14.0,
    );
    rig
}

/// Turns of the elbow's motor for one of the elbow.
const ELBOW_RATIO: f64 = 50.0;
/// Its torque per ampere, behind the gear, N m/A.
const ELBOW_NM_PER_A: f64 = 9.0;

/// The elbow of a robot that works beside people, swung in the plane: its seals grip at low speed,
/// its strain-wave gear pulls twice in every turn of the motor, and the current, at 500 Hz, is some
/// rows old when it is logged.
fn cobot_elbow(draw: &mut Draw, presence: Presence) -> Rig {
    let (inertia, coulomb) = (draw.near(1.6), draw.near(8.0));
    let excess = presence.size_of(Effect::Stribeck, draw.near(0.6));
    let amplitude = presence.size_of(Effect::TorqueRipple, draw.near(1.5));
    let late_s = presence.size_of(Effect::LoggedLate, draw.near(5.0e-3));
    let mut train = Train::one(inertia, coulomb, draw.near(11.0));
    train.surfaces[0].law = Law::Rigid {
        coulomb,
        stribeck: Some(Stribeck {
            excess,
            velocity: draw.near(0.09),
            exponent: 2.0,
        }),
    };
    let generator = Field::Cogging {
        amplitude,
        waves: 2.0 * ELBOW_RATIO,
        phase: draw.between(0.0, TAU),
    };
    train.fields.push((0, generator));
    let controller = Controller::cascade(inertia, 3.0, 15.0, 1.0e-3);
    let mut rig = rig(Kind::Rotary, train, controller, TAU / 26_214_400.0);
    rig.column = EffortColumn::Current(1.0 / ELBOW_NM_PER_A);
    rig.logs_current(2);
    rig.sensing.effort.late_s = late_s;
    rig.noisy(0.12);
    rig.know("stribeck_excess", excess * coulomb / ELBOW_NM_PER_A, "A");
    rig.know("torque_ripple_amplitude", amplitude / ELBOW_NM_PER_A, "A");
    rig.know("torque_ripple_order", 2.0 * ELBOW_RATIO, "1/rev");
    rig.know("logged_late", late_s, "s");
    rig.moved(
        draw,
        Room::about(1.2, (1.6, 8.0), 28.0),
        [Room::errands, Room::jogs],
        15.0,
    );
    rig
}
