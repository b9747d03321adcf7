//! Timber and paper: a log's carriage, a reel of paper, a press for beams.
//!
//! A screw that is rolled badly wobbles once per turn (Slocum, Precision Machine Design, 1992, ch.
//! 10). Flanks of a thread rub with what they carry (Olofsson and Ekerfors, Wear 155, 1992).

use std::f64::consts::TAU;

use crate::control::Controller;
use crate::control::pi::{Pi, Shape};
use crate::draw::Draw;
use crate::drive::CurrentLoop;
use crate::make::{Make, Presence, rig};
use crate::mechanics::field::{Drag, Field};
use crate::mechanics::friction::Scale;
use crate::mechanics::joint::Joint;
use crate::mechanics::train::Train;
use crate::motion::Room;
use crate::rig::{EffortColumn, Kind, Rig};
use crate::sensing::{Encoder, Rounding, Wave};
use crate::truth::Effect;

/// The family.
pub const MAKES: &[Make] = &[
    Make {
        name: "log-carriage",
        hides: &[
            Effect::PitchError,
            Effect::ViscousAsymmetry,
            Effect::TorqueRipple,
        ],
        build: log_carriage,
    },
    Make {
        name: "reel-spool",
        hides: &[Effect::Compliance],
        build: reel_spool,
    },
    Make {
        name: "glulam-press",
        hides: &[Effect::LoadDependentFriction],
        build: glulam_press,
    },
];

/// Travel of the log carriage per turn of its screw, m.
const LOG_LEAD_M: f64 = 0.04;

/// The carriage of a sawmill on a steep screw of 40 mm with a scale beside the log: the pitch
/// wobbles, the motor pulls unevenly four times a turn, and a check valve throttles the damper on
/// the way back only half as much. The screw's wind-up is declared, the controller is in the file.
fn log_carriage(draw: &mut Draw, presence: Presence) -> Rig {
    let (screw, carriage) = (draw.near(260.0), draw.near(500.0));
    let (stiffness, viscous) = (draw.near(1.5e8), draw.near(800.0));
    let asymmetry = presence.size_of(Effect::ViscousAsymmetry, draw.near(0.4));
    let pull = presence.size_of(Effect::TorqueRipple, draw.near(70.0));
    let poles = Field::Cogging {
        amplitude: pull,
        waves: TAU * 4.0 / LOG_LEAD_M,
        phase: draw.between(0.0, TAU),
    };
    let joint = Joint::stiff(stiffness, 2.5e4);
    let mut train =
        Train::one(screw, draw.near(60.0), 0.0).then(joint, carriage, draw.near(150.0), viscous);
    train.drags[1] = Drag {
        forward: viscous * (1.0 + asymmetry),
        backward: viscous * (1.0 - asymmetry),
        ..Drag::viscous(1, 0.0)
    };
    train.fields.push((0, poles));
    let wave = Wave {
        amplitude: presence.size_of(Effect::PitchError, draw.near(4.0e-5)),
        period: LOG_LEAD_M,
        phase: draw.between(0.0, TAU),
    };
    let controller = Controller::cascade(screw + carriage, 4.0, 22.0, 1.0e-3);
    let mut rig = rig(Kind::Linear, train, controller, 1.0e-7);
    rig.sensing.load = Some(Encoder::of(1.0e-6, Rounding::Nearest).with(wave));
    rig.stated.lead_m_per_rev = Some(LOG_LEAD_M);
    rig.stated.controller = true;
    rig.declare(Effect::Compliance);
    rig.noisy(6.0);
    rig.know("compliance_stiffness", stiffness, "N/m");
    rig.know("pitch_error_amplitude", wave.amplitude, "m");
    rig.know("pitch_error_period", wave.period, "m");
    rig.know("viscous_asymmetry", asymmetry * viscous, "N s/m");
    rig.know("torque_ripple_amplitude", pull, "N");
    rig.know("torque_ripple_period", LOG_LEAD_M / 4.0, "m");
    rig.moved(
        draw,
        Room::about(1.2, (0.9, 3.0), 30.0),
        [Room::seek, Room::errands],
        16.0,
    );
    rig
}

/// The shaft of a paper reel between its drive and the far end of the spool, where the web's
/// length is counted: it winds up by most of a milliradian. The current loop is of second order,
/// and what it measures is recorded.
fn reel_spool(draw: &mut Draw, presence: Presence) -> Rig {
    let (drive, spool) = (draw.near(26.0), draw.near(60.0));
    let stiffness = draw.near(9.0e5);
    let [first, last, viscous] = [draw.near(35.0), draw.near(60.0), draw.near(16.0)];
    let soft = Train::one(drive, first, viscous).then(
        Joint::stiff(stiffness, 800.0),
        spool,
        last,
        viscous,
    );
    let bolted = Train::one(drive + spool, first + last, 2.0 * viscous);
    let is_soft = presence.has(Effect::Compliance);
    let train = if is_soft { soft } else { bolted };
    let controller = Controller::cascade(drive + spool, 1.2, 6.0, 1.0e-3);
    let mut rig = rig(Kind::Rotary, train, controller, TAU / 33_554_432.0);
    rig.drive.current_loop = CurrentLoop::Second(300.0, 0.8);
    rig.logs_current(1);
    rig.sensing.load = Some(Encoder::of(TAU / 524_288.0, Rounding::Nearest));
    rig.noisy(3.0);
    rig.know("compliance_stiffness", stiffness, "N m/rad");
    rig.moved(
        draw,
        Room::about(12.0, (8.0, 14.0), 26.0),
        [Room::packets, Room::errands],
        13.0,
    );
    rig
}

/// Travel of the press per turn of its screw, m.
const PRESS_LEAD_M: f64 = 0.012;

/// The jaw of a press for glued beams, empty, on a trapezoidal thread: its flanks take a sixth of
/// what drives it. The motor's torque is recorded; the controller works by increments.
fn glulam_press(draw: &mut Draw, presence: Presence) -> Rig {
    let (mass, coulomb) = (draw.near(400.0), draw.near(220.0));
    let share = presence.size_of(Effect::LoadDependentFriction, draw.near(0.17) / coulomb);
    let mut train = Train::one(mass, coulomb, draw.near(350.0));
    train.surfaces[0].scales.push(Scale::Load(share));
    let loops = Pi::of(mass, 4.0, 22.0, Shape::VelocityForm(9.0e3));
    let controller = Controller::pi(loops, 1.0e-3);
    let mut rig = rig(Kind::Linear, train, controller, 5.0e-8);
    rig.column = EffortColumn::Torque(PRESS_LEAD_M / TAU);
    rig.stated.lead_m_per_rev = Some(PRESS_LEAD_M);
    rig.noisy(8.0);
    rig.know("load_dependent_friction", share * coulomb, "");
    rig.moved(
        draw,
        Room::about(0.25, (0.4, 6.0), 26.0),
        [Room::packets, Room::jogs],
        13.0,
    );
    rig
}
