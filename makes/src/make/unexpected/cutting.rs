//! Machine tools: the quill of a die sinker, the table of a gear hobber, of a planer and of a
//! machining centre.
//!
//! A worm has play in its wheel (Nordin and Gutman, Automatica 38, 2002) and errs with each of its
//! turns (Slocum, Precision Machine Design, 1992, ch. 10). Boxways rub with what presses on them,
//! and their pockets carry oil in one direction better than in the other. Covers of steel plates
//! are drawn apart and pushed together again, plate by plate.

use std::f64::consts::TAU;

use crate::control::Controller;
use crate::control::pi::{Pi, Shape};
use crate::draw::Draw;
use crate::make::{Make, Presence, rig};
use crate::mechanics::field::{Drag, Field};
use crate::mechanics::friction::Scale;
use crate::mechanics::joint::Joint;
use crate::mechanics::train::Train;
use crate::motion::Room;
use crate::rig::{EffortColumn, Kind, Rig};
use crate::sensing::{Encoder, Noise, Rounding, Wave};
use crate::truth::Effect;

/// The family.
pub const MAKES: &[Make] = &[
    Make {
        name: "erosion-quill",
        hides: &[Effect::Offset],
        build: erosion_quill,
    },
    Make {
        name: "hobbing-table",
        hides: &[Effect::Backlash, Effect::PitchError],
        build: hobbing_table,
    },
    Make {
        name: "planer-table",
        hides: &[Effect::ViscousAsymmetry, Effect::LoadDependentFriction],
        build: planer_table,
    },
    Make {
        name: "covered-table",
        hides: &[Effect::PositionDependentFriction],
        build: covered_table,
    },
];

/// The quill of a die sinker, at 2 kHz: it stands upright, and the cylinder that should carry its
/// electrode carries a part of it only. No constant force is declared.
fn erosion_quill(draw: &mut Draw, presence: Presence) -> Rig {
    let mass = draw.near(14.0);
    let weight = presence.size_of(Effect::Offset, draw.near(52.0));
    let mut train = Train::one(mass, draw.near(16.0), draw.near(60.0));
    train.fields.push((0, Field::Constant(-weight)));
    let controller = Controller::state_feedback(mass, 13.0, 5.0e-4);
    let mut rig = rig(Kind::Linear, train, controller, 1.0e-8);
    rig.sensing.motor.rounding = Rounding::Nearest;
    rig.base.retain(|effect| *effect != Effect::Offset);
    rig.noisy(0.3);
    rig.know("offset", weight, "N");
    rig.moved(
        draw,
        Room::about(0.03, (0.14, 2.4), 14.0),
        [Room::jogs, Room::packets],
        8.0,
    );
    rig
}

/// Teeth of the hobber's worm wheel; its worm has one start.
const HOBBER_TEETH: f64 = 24.0;

/// The table of a gear hobber on its worm, at 500 Hz under a controller in velocity form: the worm
/// has play in its wheel and errs with each of its turns. Encoders sit on worm and table, wind-up
/// is declared.
fn hobbing_table(draw: &mut Draw, presence: Presence) -> Rig {
    let (worm, table) = (draw.near(22.0), draw.near(60.0));
    let stiffness = draw.near(6.0e6);
    let gap = presence.size_of(Effect::Backlash, draw.near(4.0e-4));
    let wave = Wave {
        amplitude: presence.size_of(Effect::PitchError, draw.near(1.2e-4)),
        period: TAU / HOBBER_TEETH,
        phase: draw.between(0.0, TAU),
    };
    let joint = Joint {
        gap,
        ..Joint::stiff(stiffness, 2.0e3)
    };
    let train = Train::one(worm, draw.near(18.0), draw.near(20.0)).then(
        joint,
        table,
        draw.near(60.0),
        draw.near(25.0),
    );
    let loops = Pi::of(worm + table, 1.4, 7.0, Shape::VelocityForm(2.0e3));
    let mut rig = rig(
        Kind::Rotary,
        train,
        Controller::pi(loops, 2.0e-3),
        TAU / 33_554_432.0,
    );
    rig.sensing.load = Some(Encoder::of(TAU / 4_194_304.0, Rounding::Nearest).with(wave));
    rig.declare(Effect::Compliance);
    rig.noisy(0.5);
    rig.know("compliance_stiffness", stiffness, "N m/rad");
    rig.know("backlash_gap", gap, "rad");
    rig.know("pitch_error_amplitude", wave.amplitude, "rad");
    rig.know("pitch_error_period", wave.period, "rad");
    rig.moved(
        draw,
        Room::about(1.1, (0.8, 2.2), 40.0),
        [Room::shifts, Room::circles],
        22.0,
    );
    rig
}

/// The table of a planer on boxways, two and a half tonnes, at 250 Hz: the pockets of its ways
/// carry oil on the way out better than on the way back, and what drives it presses it on them.
/// Noise of the hall is 1/f noise.
fn planer_table(draw: &mut Draw, presence: Presence) -> Rig {
    let (mass, coulomb, viscous) = (draw.near(2500.0), draw.near(600.0), draw.near(1900.0));
    let asymmetry = presence.size_of(Effect::ViscousAsymmetry, -draw.near(0.35));
    let share = presence.size_of(Effect::LoadDependentFriction, draw.near(0.2) / coulomb);
    let mut train = Train::one(mass, coulomb, viscous);
    train.surfaces[0].scales.push(Scale::Load(share));
    train.drags[0] = Drag {
        forward: viscous * (1.0 + asymmetry),
        backward: viscous * (1.0 - asymmetry),
        ..Drag::default()
    };
    let controller = Controller::cascade(mass, 1.0, 5.0, 4.0e-3);
    let mut rig = rig(Kind::Linear, train, controller, 5.0e-7);
    rig.sensing.effort.noise = Noise {
        white: 10.0,
        pink: 12.0,
        mains: 0.0,
    };
    rig.know("viscous_asymmetry", asymmetry * viscous, "N s/m");
    rig.know("load_dependent_friction", share * coulomb, "");
    rig.moved(
        draw,
        Room::about(1.2, (0.8, 1.1), 48.0),
        [Room::shifts, Room::points],
        28.0,
    );
    rig
}

/// Travel of the covered table per turn of its screw, m.
const COVERED_LEAD_M: f64 = 0.016;

/// The table of a machining centre between covers of steel plates, which rub the more of them are
/// drawn apart. It has a scale, and wind-up of its screw is declared; the motor's torque is
/// recorded.
fn covered_table(draw: &mut Draw, presence: Presence) -> Rig {
    let (screw, table) = (draw.near(110.0), draw.near(380.0));
    let stiffness = draw.near(8.0e7);
    let [first, last] = [draw.near(45.0), draw.near(160.0)];
    let slope = presence.size_of(Effect::PositionDependentFriction, draw.near(1.1));
    let mut train = Train::one(screw, first, draw.near(300.0)).then(
        Joint::stiff(stiffness, 2.5e4),
        table,
        last,
        draw.near(450.0),
    );
    train.surfaces[1].scales.push(Scale::Slope(slope));
    let controller = Controller::cascade(screw + table, 2.4, 12.0, 1.0e-3);
    let mut rig = rig(Kind::Linear, train, controller, 2.0e-8);
    rig.sensing.load = Some(Encoder::of(1.0e-7, Rounding::Nearest));
    rig.column = EffortColumn::Torque(COVERED_LEAD_M / TAU);
    rig.stated.lead_m_per_rev = Some(COVERED_LEAD_M);
    rig.declare(Effect::Compliance);
    rig.noisy(4.0);
    rig.know("compliance_stiffness", stiffness, "N/m");
    let of_both = slope * last / (first + last);
    rig.know("position_dependent_friction_linear", of_both, "1/m");
    rig.moved(
        draw,
        Room::about(0.4, (0.6, 3.0), 24.0),
        [Room::errands, Room::shifts],
        13.0,
    );
    rig
}
