//! Opticians: a delay line for light, a lathe for contact lenses, an engine that rules gratings.
//!
//! Rolling elements give way before they roll (Lampaert, Swevers and Al-Bender, IEEE TAC 47, 2002).
//! The error of a ruling engine's screw repeats with every turn and shows as ghosts in the grating
//! (Harrison and Stroke, J. Opt. Soc. Am. 45, 1955).

use std::f64::consts::TAU;

use crate::control::Controller;
use crate::draw::Draw;
use crate::drive::ConstantRipple;
use crate::make::{Make, Presence, rig};
use crate::mechanics::field::Field;
use crate::mechanics::friction::Law;
use crate::mechanics::joint::Joint;
use crate::mechanics::train::Train;
use crate::motion::Room;
use crate::rig::{EffortColumn, Kind, Rig};
use crate::sensing::{Encoder, Rounding, Wave};
use crate::truth::Effect;

/// The family.
pub const MAKES: &[Make] = &[
    Make {
        name: "delay-line",
        hides: &[Effect::TorqueConstantRipple, Effect::Presliding],
        build: delay_line,
    },
    Make {
        name: "lens-lathe",
        hides: &[Effect::TorqueRipple, Effect::LoggedLate],
        build: lens_lathe,
    },
    Make {
        name: "ruling-engine",
        hides: &[Effect::PitchError],
        build: ruling_engine,
    },
];

/// Pitch of the delay line's magnets, m.
const DELAY_LINE_PITCH_M: f64 = 0.032;
/// Its force per ampere, N/A.
const DELAY_LINE_N_PER_A: f64 = 7.5;

/// The cart with the mirrors of an interferometer's delay line, at 4 kHz: its motor is uneven over
/// a pair of magnets, and its rollers give way over some hundredths of a millimetre. In amperes.
fn delay_line(draw: &mut Draw, presence: Presence) -> Rig {
    let (mass, coulomb) = (draw.near(2.4), draw.near(2.2));
    let deflection = draw.near(4.0e-5);
    let wave = ConstantRipple {
        share: presence.size_of(Effect::TorqueConstantRipple, draw.near(0.08)),
        waves: TAU / DELAY_LINE_PITCH_M,
        phase: draw.between(0.0, TAU),
    };
    let rollers = Law::maxwell_slip(coulomb, deflection, 8);
    let mut train = Train::one(mass, coulomb, draw.near(5.0));
    if presence.has(Effect::Presliding) {
        train.surfaces[0].law = rollers.clone();
    }
    let controller = Controller::lead(mass, 16.0, 2.5e-4);
    let mut rig = rig(Kind::Linear, train, controller, 1.0e-9);
    rig.column = EffortColumn::Current(1.0 / DELAY_LINE_N_PER_A);
    rig.drive.ripple = Some(wave);
    rig.sensing.motor.rounding = Rounding::Nearest;
    rig.noisy(0.03);
    rig.know("torque_constant_ripple", wave.share, "");
    rig.know("torque_constant_ripple_period", DELAY_LINE_PITCH_M, "m");
    let shown = presence.size_of(Effect::Presliding, rollers.deflection());
    rig.know("presliding_deflection", shown, "m");
    rig.moved(
        draw,
        Room::about(0.12, (0.4, 6.0), 14.0),
        [Room::seek, Room::jogs],
        8.0,
    );
    rig
}

/// Way from tooth to tooth of the lens lathe's motor, m.
const LENS_LATHE_TOOTH_M: f64 = 0.004;

/// The slide that leads a diamond over a contact lens, at 8 kHz: its short motor with iron cogs
/// over every tooth, and the current in the log, at 2 kHz, is a filter's delay old.
fn lens_lathe(draw: &mut Draw, presence: Presence) -> Rig {
    let mass = draw.near(1.1);
    let amplitude = presence.size_of(Effect::TorqueRipple, draw.near(0.5));
    let late_s = presence.size_of(Effect::LoggedLate, draw.near(1.0e-3));
    let mut train = Train::one(mass, draw.near(0.9), draw.near(6.0));
    let teeth = Field::Cogging {
        amplitude,
        waves: TAU / LENS_LATHE_TOOTH_M,
        phase: draw.between(0.0, TAU),
    };
    train.fields.push((0, teeth));
    let controller = Controller::state_feedback(mass, 24.0, 1.25e-4);
    let mut rig = rig(Kind::Linear, train, controller, 1.0e-9);
    rig.sensing.motor.rounding = Rounding::Nearest;
    rig.logs_current(4);
    rig.sensing.effort.late_s = late_s;
    rig.noisy(0.03);
    rig.know("torque_ripple_amplitude", amplitude, "N");
    rig.know("torque_ripple_period", LENS_LATHE_TOOTH_M, "m");
    rig.know("logged_late", late_s, "s");
    rig.moved(
        draw,
        Room::about(0.009, (0.15, 14.0), 11.0),
        [Room::circles, Room::swells],
        6.0,
    );
    rig
}

/// Travel of the ruling engine per turn of its screw, m.
const RULING_LEAD_M: f64 = 0.002;

/// The screw of an engine that rules gratings, under a sliding mode at 2 kHz: an interferometer
/// watches the blank, and the screw errs by half a micrometre with every turn. Wind-up is declared.
fn ruling_engine(draw: &mut Draw, presence: Presence) -> Rig {
    let (screw, blank) = (draw.near(30.0), draw.near(15.0));
    let stiffness = draw.near(4.0e7);
    let wave = Wave {
        amplitude: presence.size_of(Effect::PitchError, draw.near(5.0e-7)),
        period: RULING_LEAD_M,
        phase: draw.between(0.0, TAU),
    };
    let train = Train::one(screw, draw.near(6.0), draw.near(90.0)).then(
        Joint::stiff(stiffness, 6.0e3),
        blank,
        draw.near(9.0),
        draw.near(120.0),
    );
    let controller = Controller::sliding(screw + blank, 14.0, 250.0, 5.0e-4);
    let mut rig = rig(Kind::Linear, train, controller, 2.0e-9);
    rig.sensing.load = Some(Encoder::of(1.0e-8, Rounding::Nearest).with(wave));
    rig.column = EffortColumn::Torque(RULING_LEAD_M / TAU);
    rig.stated.lead_m_per_rev = Some(RULING_LEAD_M);
    rig.declare(Effect::Compliance);
    rig.noisy(0.1);
    rig.know("compliance_stiffness", stiffness, "N/m");
    rig.know("pitch_error_amplitude", wave.amplitude, "m");
    rig.know("pitch_error_period", wave.period, "m");
    rig.moved(
        draw,
        Room::about(0.015, (0.02, 0.25), 22.0),
        [Room::raster, Room::errands],
        14.0,
    );
    rig
}
