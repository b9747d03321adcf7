//! Foundries: a ladle that pours, what sprays a die, the shaft under a mould that oscillates.
//!
//! A gear winds up and has play (Nordin and Gutman, Automatica 38, 2002). Iron that saturates gives
//! u/(1 + k|u|). An eccentric moves its table by r·sin x per angle, so that inertia has a wave of
//! two per turn (Wittenburg, Dynamics of Multibody Systems, 2008).

use std::f64::consts::TAU;

use crate::control::Controller;
use crate::draw::Draw;
use crate::make::{Make, Presence, rig};
use crate::mechanics::inertia::Inertia;
use crate::mechanics::joint::Joint;
use crate::mechanics::train::Train;
use crate::motion::Room;
use crate::rig::{Kind, Rig};
use crate::sensing::{Encoder, Rounding};
use crate::truth::Effect;

/// The family.
pub const MAKES: &[Make] = &[
    Make {
        name: "ladle-tilt",
        hides: &[Effect::Backlash, Effect::Compliance],
        build: ladle_tilt,
    },
    Make {
        name: "die-sprayer",
        hides: &[Effect::Delay, Effect::TorqueSaturation],
        build: die_sprayer,
    },
    Make {
        name: "mould-oscillator",
        hides: &[Effect::PositionDependentInertia, Effect::LoggedLate],
        build: mould_oscillator,
    },
];

/// How many times as stiff the ladle's shaft is where it is not soft.
const FIRM: f64 = 20.0;

/// Gear and ladle: bolted together; or with a shaft between them, soft or firm, with play or none.
fn ladle_train(draw: &mut Draw, presence: Presence, stiffness: f64, gap: f64) -> Train {
    let (gear, ladle) = (draw.near(600.0), draw.near(1400.0));
    let [first, last] = [draw.near(60.0), draw.near(220.0)];
    let [fast, slow] = [draw.near(60.0), draw.near(120.0)];
    if presence == Presence::Absent {
        return Train::one(gear + ladle, first + last, fast + slow);
    }
    let is_soft = presence.has(Effect::Compliance);
    let stiffness = if is_soft { stiffness } else { FIRM * stiffness };
    let reduced = gear * ladle / (gear + ladle);
    // A seventh of critical damping.
    let damping = 0.3 * (stiffness * reduced).sqrt();
    let joint = Joint {
        gap,
        ..Joint::stiff(stiffness, damping)
    };
    Train::one(gear, first, fast).then(joint, ladle, last, slow)
}

/// The trunnions of a balanced ladle behind a gear with a tenth of a degree of play, on a shaft
/// that is long and thin. Encoders sit on gear and ladle.
fn ladle_tilt(draw: &mut Draw, presence: Presence) -> Rig {
    let stiffness = draw.near(3.0e6);
    let gap = presence.size_of(Effect::Backlash, draw.near(2.5e-3));
    let train = ladle_train(draw, presence, stiffness, gap);
    let controller = Controller::cascade(train.inertia(), 0.8, 4.0, 1.0e-3);
    let mut rig = rig(Kind::Rotary, train, controller, TAU / 33_554_432.0);
    rig.sensing.load = Some(Encoder::of(TAU / 1_048_576.0, Rounding::Nearest));
    rig.noisy(5.0);
    rig.know("backlash_gap", gap, "rad");
    rig.know("compliance_stiffness", stiffness, "N m/rad");
    rig.moved(
        draw,
        Room::about(0.9, (0.6, 1.0), 40.0),
        [Room::jogs, Room::circles],
        20.0,
    );
    rig
}

/// The arm that sprays a die between two shots: a safe bus lets a command act three cycles later,
/// and the motor, chosen small for the heat, saturates.
fn die_sprayer(draw: &mut Draw, presence: Presence) -> Rig {
    let mass = draw.near(55.0);
    let delay_s = presence.size_of(Effect::Delay, draw.near(3.0e-3));
    let droop = presence.size_of(Effect::TorqueSaturation, draw.near(3.5e-4));
    let train = Train::one(mass, draw.near(45.0), draw.near(70.0));
    let controller = Controller::pid(mass, 6.0, 1.0e-3);
    let mut rig = rig(Kind::Linear, train, controller, 1.0e-7);
    rig.drive.dead_time_s = delay_s;
    rig.drive.droop = droop;
    rig.noisy(1.5);
    rig.know("delay", delay_s, "s");
    rig.know("torque_saturation", droop, "1/N");
    rig.moved(
        draw,
        Room::about(0.6, (1.6, 10.0), 26.0),
        [Room::jogs, Room::seek],
        14.0,
    );
    rig
}

/// The eccentric shaft under the mould of a caster, with springs that take its weight, at 2 kHz:
/// the mould moves twice a turn, and the drive's current comes some cycles late over the bus of the
/// plant, at 1 kHz.
fn mould_oscillator(draw: &mut Draw, presence: Presence) -> Rig {
    let inertia = draw.near(40.0);
    let share = presence.size_of(Effect::PositionDependentInertia, draw.near(0.25));
    let late_s = presence.size_of(Effect::LoggedLate, draw.near(5.0e-3));
    let mut train = Train::one(inertia, draw.near(60.0), draw.near(12.0));
    train.inertias[0] = Inertia::Harmonic {
        mean: inertia,
        share,
        waves: 2.0,
        phase: draw.between(0.0, TAU),
    };
    let controller = Controller::lead(inertia, 7.0, 5.0e-4);
    let mut rig = rig(Kind::Rotary, train, controller, TAU / 16_777_216.0);
    rig.logs_current(2);
    rig.sensing.effort.late_s = late_s;
    rig.noisy(3.0);
    rig.know("position_dependent_inertia", share * inertia, "kg m2");
    rig.know("logged_late", late_s, "s");
    rig.moved(
        draw,
        Room::about(2.5, (6.0, 30.0), 26.0),
        [Room::waves, Room::circles],
        14.0,
    );
    rig
}
