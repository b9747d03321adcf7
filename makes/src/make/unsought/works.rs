//! Works: a rod that pulls crystals, the blade of a slit for X-rays, the crank that draws cans.
//!
//! Bristles bend before they slip (Canudas de Wit and others, IEEE TAC 40, 1995). What a crank
//! moves goes with its angle (Wittenburg, Dynamics of Multibody Systems, 2008), and its plain
//! bearings swim up with speed (Stribeck, VDI-Z. 46, 1902).

use std::f64::consts::TAU;

use crate::control::Controller;
use crate::draw::Draw;
use crate::make::{Make, Presence, rig};
use crate::mechanics::field::Field;
use crate::mechanics::friction::{Law, Stribeck};
use crate::mechanics::inertia::Inertia;
use crate::mechanics::train::Train;
use crate::motion::Room;
use crate::rig::{EffortColumn, Kind, Rig};
use crate::sensing::{Noise, Rounding};
use crate::truth::Effect;

/// The family.
pub const MAKES: &[Make] = &[
    Make {
        name: "crystal-puller",
        hides: &[Effect::Offset],
        build: crystal_puller,
    },
    Make {
        name: "slit-blade",
        hides: &[Effect::Presliding, Effect::LoggedLate],
        build: slit_blade,
    },
    Make {
        name: "body-maker",
        hides: &[
            Effect::PositionDependentInertia,
            Effect::Stribeck,
            Effect::Delay,
        ],
        build: body_maker,
    },
];

/// The rod that pulls a crystal out of its melt, cold and empty, under a sliding mode: the vacuum
/// below it draws it down. No constant force is declared.
fn crystal_puller(draw: &mut Draw, presence: Presence) -> Rig {
    let mass = draw.near(18.0);
    let vacuum = presence.size_of(Effect::Offset, draw.near(45.0));
    let mut train = Train::one(mass, draw.near(14.0), draw.near(110.0));
    train.fields.push((0, Field::Constant(-vacuum)));
    let controller = Controller::sliding(mass, 12.0, 600.0, 1.0e-3);
    let mut rig = rig(Kind::Linear, train, controller, 1.0e-8);
    rig.base.retain(|effect| *effect != Effect::Offset);
    rig.sensing.effort.noise = Noise {
        white: 0.3,
        pink: 0.2,
        mains: 0.0,
    };
    rig.know("offset", vacuum, "N");
    rig.moved(
        draw,
        Room::about(0.12, (0.1, 0.8), 26.0),
        [Room::waves, Room::index],
        14.0,
    );
    rig
}

/// A blade of a slit before a beam of X-rays, at 8 kHz with an observer of the disturbance: its
/// rollers bend by some micrometres before they roll. The current is logged at 2 kHz, by a filter's
/// delay late.
fn slit_blade(draw: &mut Draw, presence: Presence) -> Rig {
    let (mass, coulomb) = (draw.near(3.2), draw.near(2.6));
    let deflection = draw.near(1.2e-5);
    let late_s = presence.size_of(Effect::LoggedLate, draw.near(1.5e-3));
    let mut train = Train::one(mass, coulomb, draw.near(9.0));
    if presence.has(Effect::Presliding) {
        let stiffness = coulomb / deflection;
        train.surfaces[0].law = Law::LuGre {
            coulomb,
            stribeck: None,
            stiffness,
            micro_damping: 0.6 * (stiffness * mass).sqrt(),
            fade_velocity: 2.0e-3,
        };
    }
    let controller = Controller::rejecting(mass, 15.0, 1.25e-4);
    let mut rig = rig(Kind::Linear, train, controller, 1.0e-9);
    rig.sensing.motor.rounding = Rounding::Nearest;
    rig.logs_current(4);
    rig.sensing.effort.late_s = late_s;
    rig.noisy(0.03);
    let shown = presence.size_of(Effect::Presliding, deflection);
    rig.know("presliding_deflection", shown, "m");
    rig.know("logged_late", late_s, "s");
    rig.moved(
        draw,
        Room::about(4.0e-3, (0.05, 2.5), 11.0),
        [Room::packets, Room::seek],
        7.0,
    );
    rig
}

/// Torque of the body maker's motor per ampere, N m/A.
const BODY_MAKER_NM_PER_A: f64 = 0.5;

/// The crank of a machine that draws cans, without its ram's tools, at 2.5 kHz: ram and rod come
/// and go twice a turn, its plain bearings swim up with speed, and a command waits for some cycles.
/// In amperes.
fn body_maker(draw: &mut Draw, presence: Presence) -> Rig {
    let (inertia, coulomb) = (draw.near(0.06), draw.near(0.9));
    let share = presence.size_of(Effect::PositionDependentInertia, draw.near(0.15));
    let excess = presence.size_of(Effect::Stribeck, draw.near(0.8));
    let delay_s = presence.size_of(Effect::Delay, draw.near(2.4e-3));
    let mut train = Train::one(inertia, coulomb, draw.near(0.03));
    train.inertias[0] = Inertia::Harmonic {
        mean: inertia,
        share,
        waves: 2.0,
        phase: draw.between(0.0, TAU),
    };
    train.surfaces[0].law = Law::Rigid {
        coulomb,
        stribeck: Some(Stribeck {
            excess,
            velocity: draw.near(1.2),
            exponent: 2.0,
        }),
    };
    let controller = Controller::pid(inertia, 7.0, 4.0e-4);
    let mut rig = rig(Kind::Rotary, train, controller, TAU / 16_777_216.0);
    rig.column = EffortColumn::Current(1.0 / BODY_MAKER_NM_PER_A);
    rig.drive.dead_time_s = delay_s;
    rig.noisy(0.03);
    let share_a = share * inertia / BODY_MAKER_NM_PER_A;
    rig.know("position_dependent_inertia", share_a, "A s2/rad");
    rig.know(
        "stribeck_excess",
        excess * coulomb / BODY_MAKER_NM_PER_A,
        "A",
    );
    rig.know("delay", delay_s, "s");
    rig.moved(
        draw,
        Room::about(6.0, (16.0, 130.0), 18.0),
        [Room::errands, Room::jogs],
        10.0,
    );
    rig
}
