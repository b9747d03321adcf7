//! Waves: several of them at once, of the motor's pull and of the pitch.
//!
//! Magnets pull with the poles and with the slots, and a drum with a weight once or a few times a
//! turn (Proca et al., IEEE Trans. Magn. 39, 2003). A screw errs with every turn, and its rolled
//! thread with every turn of the roll (Slocum, Precision Machine Design, 1992, ch. 10).

use std::f64::consts::TAU;

use crate::control::Controller;
use crate::draw::Draw;
use crate::make::{Make, Presence, rig};
use crate::mechanics::field::Field;
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
        name: "film-scanner",
        hides: &[Effect::PositionDependentFriction, Effect::TorqueRipple],
        build: film_scanner,
    },
    Make {
        name: "pinning-drum",
        hides: &[Effect::TorqueRipple],
        build: pinning_drum,
    },
    Make {
        name: "jig-borer",
        hides: &[Effect::PitchError, Effect::Stribeck],
        build: jig_borer,
    },
];

/// Pulls a train's motor by a wave about so large, and says how large.
fn pulled(
    train: &mut Train,
    (amplitude, waves): (f64, f64),
    draw: &mut Draw,
    presence: Presence,
) -> f64 {
    let amplitude = presence.size_of(Effect::TorqueRipple, draw.near(amplitude));
    let wave = Field::Cogging {
        amplitude,
        waves,
        phase: draw.between(0.0, TAU),
    };
    train.fields.push((0, wave));
    amplitude
}

/// Pitch of the scanner's magnets, m.
const SCANNER_PITCH_M: f64 = 0.024;
/// Distance of its slots, m: five for every four magnets.
const SCANNER_SLOT_M: f64 = 0.0192;

/// The gate of a film scanner on a linear motor, at 4 kHz: it is pulled by the magnets and by the
/// slots, and its felt presses more toward both ends.
fn film_scanner(draw: &mut Draw, presence: Presence) -> Rig {
    let (mass, coulomb) = (draw.near(0.24), draw.near(0.5));
    let bowl = presence.size_of(Effect::PositionDependentFriction, draw.near(380.0));
    let mut train = Train::one(mass, coulomb, draw.near(0.7));
    train.surfaces[0].scales.push(Scale::Bowl(bowl));
    let mut pull =
        |amplitude, period| pulled(&mut train, (amplitude, TAU / period), draw, presence);
    let of_magnets = pull(0.3, SCANNER_PITCH_M);
    let of_slots = pull(0.17, SCANNER_SLOT_M);
    let controller = Controller::state_feedback(mass, 14.0, 2.5e-4);
    let mut rig = rig(Kind::Linear, train, controller, 2.0e-8);
    rig.sensing.motor.rounding = Rounding::Nearest;
    rig.noisy(6.0e-3);
    rig.know("torque_ripple_amplitude", of_magnets, "N");
    rig.know("torque_ripple_period", SCANNER_PITCH_M, "m");
    rig.know("second_torque_ripple_amplitude", of_slots, "N");
    rig.know("second_torque_ripple_period", SCANNER_SLOT_M, "m");
    rig.moved(
        draw,
        Room::about(0.06, (0.5, 9.0), 14.0),
        [Room::circles, Room::raster],
        8.0,
    );
    rig
}

/// Waves of the drum's weight a turn: two of them within its travel.
const DRUM_LOBES: f64 = 3.0;
/// Waves of its motor's slots a turn.
const DRUM_SLOTS: f64 = 24.0;

/// The drum on which a music box's cylinder gets its pins, at 1 kHz under a sliding mode: three
/// clamps weigh on it, and its motor's slots pull. In torque of millinewton metres.
fn pinning_drum(draw: &mut Draw, presence: Presence) -> Rig {
    let inertia = draw.near(6.0e-6);
    let mut train = Train::one(inertia, draw.near(8.0e-4), draw.near(2.0e-5));
    let mut pull = |amplitude, waves| pulled(&mut train, (amplitude, waves), draw, presence);
    let of_clamps = pull(4.0e-4, DRUM_LOBES);
    let of_slots = pull(2.5e-4, DRUM_SLOTS);
    let controller = Controller::sliding(inertia, 16.0, 0.02, 5.0e-4);
    let mut rig = rig(Kind::Rotary, train, controller, TAU / 4_194_304.0);
    rig.sensing.steps_per_row = 2 * rig.steps_per_tick;
    rig.sensing.effort.quantum = 1.0e-6;
    rig.noisy(1.0e-5);
    rig.know("torque_ripple_amplitude", of_clamps, "N m");
    rig.know("torque_ripple_order", DRUM_LOBES, "1/rev");
    rig.know("second_torque_ripple_amplitude", of_slots, "N m");
    rig.know("second_torque_ripple_order", DRUM_SLOTS, "1/rev");
    rig.moved(
        draw,
        Room::about(2.1, (9.0, 120.0), 20.0),
        [Room::workshop, Room::waves],
        11.0,
    );
    rig
}

/// Travel of the jig borer per turn of its screw, m.
const BORER_LEAD_M: f64 = 0.006;
/// Way per turn of the roll that formed its thread, m.
const BORER_ROLL_M: f64 = 0.0138;

/// The table of a jig borer with a glass scale, at 1 kHz: its pitch wobbles with the screw and with
/// the roll that formed it, and its ways stick while the screw's bearings do not. The wind-up is
/// declared.
fn jig_borer(draw: &mut Draw, presence: Presence) -> Rig {
    let (screw, table) = (draw.near(120.0), draw.near(260.0));
    let (bearings, coulomb) = (draw.near(35.0), draw.near(110.0));
    let stiffness = draw.near(1.6e8);
    let excess = presence.size_of(Effect::Stribeck, draw.near(0.8));
    let mut train = Train::one(screw, bearings, draw.near(180.0)).then(
        Joint::stiff(stiffness, 4.0e4),
        table,
        coulomb,
        draw.near(320.0),
    );
    train.surfaces[1].law = Law::Rigid {
        coulomb,
        stribeck: Some(Stribeck {
            excess,
            velocity: draw.near(0.01),
            exponent: 0.8,
        }),
    };
    let mut wobbles = |amplitude: f64, period: f64| Wave {
        amplitude: presence.size_of(Effect::PitchError, draw.near(amplitude)),
        period,
        phase: draw.between(0.0, TAU),
    };
    let [turn, roll] = [wobbles(3.0e-6, BORER_LEAD_M), wobbles(1.8e-6, BORER_ROLL_M)];
    let controller = Controller::cascade(screw + table, 5.0, 28.0, 1.0e-3);
    let mut rig = rig(Kind::Linear, train, controller, 2.0e-8);
    let scale = Encoder::of(5.0e-8, Rounding::Nearest);
    rig.sensing.load = Some(scale.with(turn).with(roll));
    rig.column = EffortColumn::Torque(BORER_LEAD_M / TAU);
    rig.stated.lead_m_per_rev = Some(BORER_LEAD_M);
    rig.declare(Effect::Compliance);
    rig.noisy(1.5);
    let per = BORER_LEAD_M / TAU;
    rig.know("compliance_stiffness", stiffness, "N/m");
    rig.know("stribeck_excess", excess * coulomb * per, "N m");
    rig.know("pitch_error_amplitude", turn.amplitude, "m");
    rig.know("pitch_error_period", turn.period, "m");
    rig.know("second_pitch_error_amplitude", roll.amplitude, "m");
    rig.know("second_pitch_error_period", roll.period, "m");
    rig.moved(
        draw,
        Room::about(0.1, (0.2, 1.5), 30.0),
        [Room::errands, Room::swells],
        18.0,
    );
    rig
}
