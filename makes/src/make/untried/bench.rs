//! Eyes and cells: what stands on the bench of an optician or of a laboratory.
//!
//! Small preloaded bearings give way like a spring before they roll (Bouc and Wen's law, or
//! Maxwell's slip: Al-Bender and Swevers, IEEE Control Systems 28, 2008). A greased guide has less
//! friction the faster it slides (Stribeck, VDI-Z. 46, 1902).

use std::f64::consts::TAU;

use crate::control::Controller;
use crate::draw::Draw;
use crate::drive::ConstantRipple;
use crate::make::{Make, Presence, rig};
use crate::mechanics::friction::{Law, Stribeck};
use crate::mechanics::train::Train;
use crate::motion::Room;
use crate::rig::{EffortColumn, Kind, Rig};
use crate::sensing::Rounding;
use crate::truth::Effect;

/// The family.
pub const MAKES: &[Make] = &[
    Make {
        name: "phoropter-wheel",
        hides: &[Effect::Presliding, Effect::TorqueConstantRipple],
        build: phoropter_wheel,
    },
    Make {
        name: "plate-shuttle",
        hides: &[Effect::Stribeck, Effect::Delay],
        build: plate_shuttle,
    },
    Make {
        name: "cell-manipulator",
        hides: &[Effect::Presliding],
        build: cell_manipulator,
    },
];

/// Torque of the phoropter's motor per ampere, N m/A.
const PHOROPTER_NM_PER_A: f64 = 0.02;

/// A wheel of lenses before an eye, at 2 kHz: thin bearings give way over several milliradians
/// before they roll, and a motor of seven pole pairs is uneven. In amperes.
fn phoropter_wheel(draw: &mut Draw, presence: Presence) -> Rig {
    let (inertia, coulomb) = (draw.near(3.0e-5), draw.near(4.0e-3));
    let deflection = draw.near(8.0e-3);
    let wave = ConstantRipple {
        share: presence.size_of(Effect::TorqueConstantRipple, draw.near(0.1)),
        waves: 7.0,
        phase: draw.between(0.0, TAU),
    };
    let mut train = Train::one(inertia, coulomb, draw.near(2.0e-4));
    if presence.has(Effect::Presliding) {
        train.surfaces[0].law = Law::BoucWen {
            coulomb,
            stiffness: coulomb / deflection,
            exponent: 1.0,
        };
    }
    let controller = Controller::state_feedback(inertia, 12.0, 5.0e-4);
    let mut rig = rig(Kind::Rotary, train, controller, TAU / 8_388_608.0);
    rig.column = EffortColumn::Current(1.0 / PHOROPTER_NM_PER_A);
    rig.drive.ripple = Some(wave);
    rig.noisy(4.0e-5);
    let shown = presence.size_of(Effect::Presliding, deflection);
    rig.know("presliding_deflection", shown, "rad");
    rig.know("torque_constant_ripple", wave.share, "");
    rig.know("torque_constant_ripple_order", 7.0, "1/rev");
    rig.moved(
        draw,
        Room::about(4.0, (15.0, 220.0), 18.0),
        [Room::seek, Room::errands],
        9.0,
    );
    rig
}

/// A shuttle for titre plates on a greased guide under a lead compensator, behind a gateway that
/// passes a command on after two cycles: it sticks more than it slides.
fn plate_shuttle(draw: &mut Draw, presence: Presence) -> Rig {
    let (mass, coulomb) = (draw.near(2.2), draw.near(3.0));
    let excess = presence.size_of(Effect::Stribeck, draw.near(0.8));
    let delay_s = presence.size_of(Effect::Delay, draw.near(2.0e-3));
    let mut train = Train::one(mass, coulomb, draw.near(4.0));
    train.surfaces[0].law = Law::Rigid {
        coulomb,
        stribeck: Some(Stribeck {
            excess,
            velocity: draw.near(0.015),
            exponent: 2.0,
        }),
    };
    let controller = Controller::lead(mass, 8.0, 1.0e-3);
    let mut rig = rig(Kind::Linear, train, controller, 5.0e-8);
    rig.drive.dead_time_s = delay_s;
    rig.noisy(0.05);
    rig.know("stribeck_excess", excess * coulomb, "N");
    rig.know("delay", delay_s, "s");
    rig.moved(
        draw,
        Room::about(0.12, (0.5, 8.0), 26.0),
        [Room::errands, Room::ladder],
        14.0,
    );
    rig
}

/// A manipulator that holds a pipette to a cell, at 8 kHz under an observer of the disturbance: its
/// crossed rollers bend by micrometres before they roll.
fn cell_manipulator(draw: &mut Draw, presence: Presence) -> Rig {
    let (mass, coulomb) = (draw.near(0.35), draw.near(0.6));
    let deflection = draw.near(9.0e-6);
    let rollers = Law::maxwell_slip(coulomb, deflection, 12);
    let mut train = Train::one(mass, coulomb, draw.near(3.0));
    if presence.has(Effect::Presliding) {
        train.surfaces[0].law = rollers.clone();
    }
    let controller = Controller::rejecting(mass, 18.0, 1.25e-4);
    let mut rig = rig(Kind::Linear, train, controller, 1.0e-9);
    rig.sensing.motor.rounding = Rounding::Nearest;
    rig.noisy(4.0e-3);
    let shown = presence.size_of(Effect::Presliding, rollers.deflection());
    rig.know("presliding_deflection", shown, "m");
    rig.moved(
        draw,
        Room::about(2.0e-3, (0.02, 1.0), 9.0),
        [Room::seek, Room::jogs],
        5.0,
    );
    rig
}
