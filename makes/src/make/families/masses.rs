//! Masses: a motor and what hangs on it by a belt or a rod that gives way.
//!
//! M₁ a₁ = F − k·δ − c·δ', M₂ a₂ = k·δ + c·δ'. Beside a scale at the load both masses can be told;
//! at the motor alone they show by the swing of the load before a motor that stands, k/M₂, and by
//! that of both, k/M₁ + k/M₂ (Leonhard, Control of Electrical Drives, 2001, ch. 7).

use std::f64::consts::TAU;

use crate::control::Controller;
use crate::control::pi::{Pi, Shape};
use crate::draw::Draw;
use crate::make::{Make, Presence, rig};
use crate::mechanics::joint::Joint;
use crate::mechanics::train::Train;
use crate::motion::Room;
use crate::rig::{Kind, Rig};
use crate::sensing::{Encoder, Rounding, Wave};
use crate::truth::Effect;

/// The family.
pub const MAKES: &[Make] = &[
    Make {
        name: "tile-glazer",
        hides: &[Effect::Compliance, Effect::PitchError],
        build: tile_glazer,
    },
    Make {
        name: "soil-auger",
        hides: &[Effect::Compliance],
        build: soil_auger,
    },
];

/// Travel of the glazer's bell per turn of its pulley, m.
const GLAZER_TURN_M: f64 = 0.12;
/// And per turn of the gear before it, m: 17 teeth to 46.
const GLAZER_GEAR_M: f64 = GLAZER_TURN_M * 17.0 / 46.0;

/// The bell that pours glaze on tiles, on a long belt at 1 kHz: the belt gives way, and the bell's
/// tape sees the pulley wobble and the gear before it. Motor and bell rub on their own.
fn tile_glazer(draw: &mut Draw, presence: Presence) -> Rig {
    let (motor, bell) = (draw.near(9.0), draw.near(21.0));
    let (stiffness, damping) = (draw.near(2.2e5), draw.near(130.0));
    let [first, last] = [draw.near(14.0), draw.near(26.0)];
    let [fast, slow] = [draw.near(30.0), draw.near(45.0)];
    let belt = Joint::stiff(stiffness, damping);
    let soft = Train::one(motor, first, fast).then(belt, bell, last, slow);
    let bolted = Train::one(motor + bell, first + last, fast + slow);
    let is_soft = presence.has(Effect::Compliance);
    let train = if is_soft { soft } else { bolted };
    let mut wobbles = |amplitude: f64, period: f64| Wave {
        amplitude: presence.size_of(Effect::PitchError, draw.near(amplitude)),
        period,
        phase: draw.between(0.0, TAU),
    };
    let [turn, gear] = [
        wobbles(6.0e-5, GLAZER_TURN_M),
        wobbles(3.0e-5, GLAZER_GEAR_M),
    ];
    let controller = Controller::cascade(motor + bell, 1.2, 6.0, 1.0e-3);
    let mut rig = rig(Kind::Linear, train, controller, 1.0e-6);
    let tape = Encoder::of(1.0e-6, Rounding::Nearest);
    rig.sensing.load = Some(tape.with(turn).with(gear));
    rig.stated.lead_m_per_rev = Some(GLAZER_TURN_M);
    rig.noisy(0.5);
    rig.know("motor_inertia", motor, "N s2/m");
    rig.know("compliance_stiffness", stiffness, "N/m");
    rig.know("compliance_damping", damping, "N s/m");
    rig.know("pitch_error_amplitude", turn.amplitude, "m");
    rig.know("pitch_error_period", turn.period, "m");
    rig.know("second_pitch_error_amplitude", gear.amplitude, "m");
    rig.know("second_pitch_error_period", gear.period, "m");
    rig.moved(
        draw,
        Room::about(0.6, (1.0, 8.0), 28.0),
        [Room::points, Room::strokes],
        16.0,
    );
    rig
}

/// The head of an auger that takes samples of soil, at 500 Hz: a string of rods that winds up, with
/// the bit on its end, of which nothing is measured. By the motor alone.
fn soil_auger(draw: &mut Draw, presence: Presence) -> Rig {
    let (head, bit) = (draw.near(0.9), draw.near(0.7));
    let (stiffness, damping) = (draw.near(2600.0), draw.near(2.5));
    let [first, last] = [draw.near(3.0), draw.near(2.0)];
    let [fast, slow] = [draw.near(1.2), draw.near(0.8)];
    let rods = Joint::stiff(stiffness, damping);
    let soft = Train::one(head, first, fast).then(rods, bit, last, slow);
    let bolted = Train::one(head + bit, first + last, fast + slow);
    let is_soft = presence.has(Effect::Compliance);
    let train = if is_soft { soft } else { bolted };
    let loops = Pi::of(head + bit, 0.7, 3.5, Shape::BackCalculation(300.0));
    let mut rig = rig(
        Kind::Rotary,
        train,
        Controller::pi(loops, 2.0e-3),
        TAU / 8_388_608.0,
    );
    rig.noisy(0.1);
    rig.know("motor_inertia", head, "N m s2/rad");
    rig.know("compliance_stiffness", stiffness, "N m/rad");
    rig.know("compliance_damping", damping, "N m s/rad");
    rig.moved(
        draw,
        Room::about(6.0, (7.0, 60.0), 30.0),
        [Room::workshop, Room::jogs],
        16.0,
    );
    rig
}
