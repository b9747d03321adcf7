//! Halls: where ham is sliced, carpets are tufted and an orchestra is lifted, and domes.
//!
//! Grease carries the more the faster it slides (Stribeck, VDI-Z. 46, 1902; Armstrong-Hélouvry,
//! Dupont and Canudas de Wit, Automatica 30, 1994). Small preloaded bearings give way before they
//! roll (Lampaert, Swevers and Al-Bender, IEEE TAC 47, 2002). A screw errs with every turn (Slocum,
//! Precision Machine Design, 1992, ch. 10).

use std::f64::consts::TAU;

use crate::control::Controller;
use crate::control::pi::{Pi, Shape};
use crate::draw::Draw;
use crate::make::{Make, Presence, rig};
use crate::mechanics::field::{Drag, Field};
use crate::mechanics::friction::{Law, Scale, Stribeck};
use crate::mechanics::joint::Joint;
use crate::mechanics::train::Train;
use crate::motion::Room;
use crate::rig::{EffortColumn, Kind, Rig};
use crate::sensing::{Encoder, Rounding, Wave};
use crate::truth::Effect;

/// The family.
pub const MAKES: &[Make] = &[
    Make {
        name: "ham-slicer",
        hides: &[Effect::Stribeck, Effect::ViscousAsymmetry, Effect::Delay],
        build: ham_slicer,
    },
    Make {
        name: "tufting-shift",
        hides: &[Effect::TorqueRipple, Effect::FrictionDrift],
        build: tufting_shift,
    },
    Make {
        name: "orchestra-lift",
        hides: &[Effect::PitchError, Effect::PositionDependentFriction],
        build: orchestra_lift,
    },
    Make {
        name: "fibre-positioner",
        hides: &[Effect::Presliding, Effect::TorqueRipple],
        build: fibre_positioner,
    },
    Make {
        name: "dome-shutter",
        hides: &[Effect::Stribeck, Effect::CoulombAsymmetry],
        build: dome_shutter,
    },
];

/// The carriage that leads a ham to the blade, at 2 kHz: its greased bars grip when it is slow, a
/// damper holds it back on the way to the blade, and a command waits for some cycles.
fn ham_slicer(draw: &mut Draw, presence: Presence) -> Rig {
    let (mass, coulomb, viscous) = (draw.near(14.0), draw.near(22.0), draw.near(60.0));
    let asymmetry = presence.size_of(Effect::ViscousAsymmetry, draw.near(0.4));
    let excess = presence.size_of(Effect::Stribeck, draw.near(0.7));
    let delay_s = presence.size_of(Effect::Delay, draw.near(2.5e-3));
    let mut train = Train::one(mass, coulomb, viscous);
    train.surfaces[0].law = Law::Rigid {
        coulomb,
        stribeck: Some(Stribeck {
            excess,
            velocity: draw.near(0.04),
            exponent: 2.0,
        }),
    };
    train.drags[0] = Drag {
        forward: viscous * (1.0 + asymmetry),
        backward: viscous * (1.0 - asymmetry),
        ..Drag::default()
    };
    let loops = Pi::of(mass, 4.0, 20.0, Shape::BackCalculation(900.0));
    let mut rig = rig(Kind::Linear, train, Controller::pi(loops, 5.0e-4), 5.0e-8);
    rig.drive.dead_time_s = delay_s;
    rig.noisy(0.5);
    rig.know("stribeck_excess", excess * coulomb, "N");
    rig.know("viscous_asymmetry", asymmetry * viscous, "N s/m");
    rig.know("delay", delay_s, "s");
    rig.moved(
        draw,
        Room::about(0.25, (0.8, 10.0), 22.0),
        [Room::ladder, Room::errands],
        12.0,
    );
    rig
}

/// Travel of the tufting machine's needle bar per turn of its screw, m.
const TUFTING_LEAD_M: f64 = 0.01;

/// The screw that shifts the needle bar of a tufting machine, under a sliding mode: its motor pulls
/// unevenly twice a turn, and its guides are stiff until they are warm. In torque of the motor.
fn tufting_shift(draw: &mut Draw, presence: Presence) -> Rig {
    let mass = draw.near(28.0);
    let amplitude = presence.size_of(Effect::TorqueRipple, draw.near(13.0));
    let surplus = presence.size_of(Effect::FrictionDrift, draw.near(0.8));
    let time_constant_s = draw.near(8.0);
    let mut train = Train::one(mass, draw.near(45.0), draw.near(110.0));
    train.surfaces[0].scales.push(Scale::WarmUp {
        surplus,
        time_constant_s,
    });
    let poles = Field::Cogging {
        amplitude,
        waves: TAU * 2.0 / TUFTING_LEAD_M,
        phase: draw.between(0.0, TAU),
    };
    train.fields.push((0, poles));
    let controller = Controller::sliding(mass, 9.0, 450.0, 5.0e-4);
    let mut rig = rig(Kind::Linear, train, controller, 2.0e-8);
    rig.column = EffortColumn::Torque(TUFTING_LEAD_M / TAU);
    rig.stated.lead_m_per_rev = Some(TUFTING_LEAD_M);
    rig.noisy(1.0);
    rig.know(
        "torque_ripple_amplitude",
        amplitude * TUFTING_LEAD_M / TAU,
        "N m",
    );
    rig.know("torque_ripple_period", TUFTING_LEAD_M / 2.0, "m");
    rig.know("friction_drift_gain", surplus, "");
    rig.know("friction_drift_time_constant", time_constant_s, "s");
    rig.moved(
        draw,
        Room::about(0.05, (0.2, 4.0), 24.0),
        [Room::index, Room::jogs],
        12.0,
    );
    rig
}

/// Travel of the orchestra's lift per turn of its spindles, m.
const ORCHESTRA_LEAD_M: f64 = 0.03;

/// The lift of an orchestra pit on its spindles, balanced but for a rest, at 400 Hz: the pitch
/// wobbles, and the guides bind toward both ends. A scale stands beside it, wind-up is declared.
fn orchestra_lift(draw: &mut Draw, presence: Presence) -> Rig {
    let (spindles, platform) = (draw.near(2500.0), draw.near(1500.0));
    let stiffness = draw.near(1.5e8);
    let bowl = presence.size_of(Effect::PositionDependentFriction, draw.near(1.1));
    let wave = Wave {
        amplitude: presence.size_of(Effect::PitchError, draw.near(7.0e-5)),
        period: ORCHESTRA_LEAD_M,
        phase: draw.between(0.0, TAU),
    };
    let mut train = Train::one(spindles, draw.near(250.0), draw.near(500.0)).then(
        Joint::stiff(stiffness, 1.1e5),
        platform,
        draw.near(500.0),
        draw.near(700.0),
    );
    train.surfaces[1].scales.push(Scale::Bowl(bowl));
    train.fields.push((1, Field::Constant(-draw.near(600.0))));
    let controller = Controller::cascade(spindles + platform, 1.2, 6.0, 2.5e-3);
    let mut rig = rig(Kind::Linear, train, controller, 2.0e-7);
    rig.sensing.load = Some(Encoder::of(5.0e-6, Rounding::Nearest).with(wave));
    rig.stated.lead_m_per_rev = Some(ORCHESTRA_LEAD_M);
    rig.declare(Effect::Compliance);
    rig.noisy(15.0);
    rig.know("compliance_stiffness", stiffness, "N/m");
    rig.know("pitch_error_amplitude", wave.amplitude, "m");
    rig.know("pitch_error_period", wave.period, "m");
    rig.moved(
        draw,
        Room::about(1.1, (0.5, 0.6), 56.0),
        [Room::points, Room::weaving],
        32.0,
    );
    rig
}

/// Torque of the positioner's motor per ampere, N m/A.
const POSITIONER_NM_PER_A: f64 = 0.006;

/// The motor that brings a fibre to the image of a star, at 8 kHz under an observer of the
/// disturbance: its tiny bearings give way over some milliradians before they roll, and its teeth
/// pull six times a turn. In amperes.
fn fibre_positioner(draw: &mut Draw, presence: Presence) -> Rig {
    let (inertia, coulomb) = (draw.near(2.0e-6), draw.near(2.5e-4));
    let deflection = draw.near(4.0e-3);
    let amplitude = presence.size_of(Effect::TorqueRipple, draw.near(7.0e-5));
    let rollers = Law::maxwell_slip(coulomb, deflection, 10);
    let mut train = Train::one(inertia, coulomb, draw.near(1.0e-5));
    if presence.has(Effect::Presliding) {
        train.surfaces[0].law = rollers.clone();
    }
    let teeth = Field::Cogging {
        amplitude,
        waves: 6.0,
        phase: draw.between(0.0, TAU),
    };
    train.fields.push((0, teeth));
    let controller = Controller::rejecting(inertia, 18.0, 1.25e-4);
    let mut rig = rig(Kind::Rotary, train, controller, TAU / 16_777_216.0);
    rig.column = EffortColumn::Current(1.0 / POSITIONER_NM_PER_A);
    rig.sensing.motor.rounding = Rounding::Nearest;
    rig.noisy(4.0e-6);
    let shown = presence.size_of(Effect::Presliding, rollers.deflection());
    rig.know("presliding_deflection", shown, "rad");
    rig.know(
        "torque_ripple_amplitude",
        amplitude / POSITIONER_NM_PER_A,
        "A",
    );
    rig.know("torque_ripple_order", 6.0, "1/rev");
    rig.moved(
        draw,
        Room::about(2.5, (8.0, 300.0), 9.0),
        [Room::errands, Room::seek],
        5.0,
    );
    rig
}

/// The shutter of an observatory's dome on its rails, at 250 Hz: its wheels stick before they roll,
/// and the seal rubs more on the way shut. No constant force is declared.
fn dome_shutter(draw: &mut Draw, presence: Presence) -> Rig {
    let (mass, coulomb) = (draw.near(1400.0), draw.near(450.0));
    let excess = presence.size_of(Effect::Stribeck, draw.near(0.7));
    let asymmetry = presence.size_of(Effect::CoulombAsymmetry, draw.near(0.25));
    let mut train = Train::one(mass, coulomb, draw.near(500.0));
    train.surfaces[0].law = Law::Rigid {
        coulomb,
        stribeck: Some(Stribeck {
            excess,
            velocity: draw.near(0.03),
            exponent: 1.0,
        }),
    };
    train.surfaces[0].scales.push(Scale::Direction(asymmetry));
    let controller = Controller::cascade(mass, 1.0, 5.0, 4.0e-3);
    let mut rig = rig(Kind::Linear, train, controller, 2.0e-7);
    rig.base.retain(|effect| *effect != Effect::Offset);
    rig.noisy(8.0);
    rig.know("stribeck_excess", excess * coulomb, "N");
    rig.know("coulomb_asymmetry", asymmetry * coulomb, "N");
    rig.moved(
        draw,
        Room::about(1.5, (0.4, 0.4), 64.0),
        [Room::errands, Room::ladder],
        34.0,
    );
    rig
}
