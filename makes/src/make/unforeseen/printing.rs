//! Printers: a squeegee over a screen, the drum that plates are set on, a roller that spreads ink.
//!
//! A blade that is pressed on one way and lifted the other rubs by direction. A felt that is out of
//! round presses by its angle. Ink warms in its roller train and its rollers run in with it
//! (Kipphan, Handbook of Print Media, 2001, ch. 2).

use std::f64::consts::TAU;

use crate::control::Controller;
use crate::draw::Draw;
use crate::make::{Make, Presence, rig};
use crate::mechanics::field::Field;
use crate::mechanics::friction::Scale;
use crate::mechanics::train::Train;
use crate::motion::Room;
use crate::rig::{Kind, Rig};
use crate::sensing::Noise;
use crate::truth::Effect;

/// The family.
pub const MAKES: &[Make] = &[
    Make {
        name: "screen-squeegee",
        hides: &[Effect::CoulombAsymmetry, Effect::Delay],
        build: screen_squeegee,
    },
    Make {
        name: "plate-setter-drum",
        hides: &[Effect::TorqueRipple, Effect::PositionDependentFriction],
        build: plate_setter_drum,
    },
    Make {
        name: "ink-oscillator",
        hides: &[Effect::FrictionDrift, Effect::LoggedLate],
        build: ink_oscillator,
    },
];

/// The carriage of a screen printer under a lead compensator: the squeegee is pressed on when it
/// prints and lifted when it floods, and a command waits for three cycles of the line's bus. Rows
/// come with jitter, and no constant force is declared.
fn screen_squeegee(draw: &mut Draw, presence: Presence) -> Rig {
    let (mass, coulomb) = (draw.near(24.0), draw.near(45.0));
    let asymmetry = presence.size_of(Effect::CoulombAsymmetry, draw.near(0.3));
    let delay_s = presence.size_of(Effect::Delay, draw.near(3.0e-3));
    let mut train = Train::one(mass, coulomb, draw.near(60.0));
    train.surfaces[0].scales.push(Scale::Direction(asymmetry));
    let controller = Controller::lead(mass, 7.0, 1.0e-3);
    let mut rig = rig(Kind::Linear, train, controller, 2.0e-7);
    rig.base.retain(|effect| *effect != Effect::Offset);
    rig.drive.dead_time_s = delay_s;
    rig.sensing.stamps.jitter_s = 5.0e-5;
    rig.noisy(0.8);
    rig.know("coulomb_asymmetry", asymmetry * coulomb, "N");
    rig.know("delay", delay_s, "s");
    rig.moved(
        draw,
        Room::about(0.4, (0.9, 8.0), 26.0),
        [Room::shifts, Room::points],
        14.0,
    );
    rig
}

/// The drum that a printing plate is clamped on, at 1.25 kHz: its motor without a gear cogs twelve
/// times a turn, and the felt that cleans it is out of round.
fn plate_setter_drum(draw: &mut Draw, presence: Presence) -> Rig {
    let inertia = draw.near(0.8);
    let amplitude = presence.size_of(Effect::TorqueRipple, draw.near(0.9));
    let felt = Scale::Wavy {
        share: presence.size_of(Effect::PositionDependentFriction, draw.near(0.5)),
        waves: 1.0,
        phase: draw.between(0.0, TAU),
    };
    let mut train = Train::one(inertia, draw.near(3.5), draw.near(0.6));
    train.surfaces[0].scales.push(felt);
    let cogging = Field::Cogging {
        amplitude,
        waves: 12.0,
        phase: draw.between(0.0, TAU),
    };
    train.fields.push((0, cogging));
    let controller = Controller::state_feedback(inertia, 9.0, 8.0e-4);
    let mut rig = rig(Kind::Rotary, train, controller, TAU / 16_777_216.0);
    rig.noisy(0.05);
    rig.know("torque_ripple_amplitude", amplitude, "N m");
    rig.know("torque_ripple_order", 12.0, "1/rev");
    rig.moved(
        draw,
        Room::about(2.7, (5.0, 30.0), 24.0),
        [Room::raster, Room::strokes],
        12.0,
    );
    rig
}

/// A roller that goes to and fro to spread tacky ink, at 500 Hz: its journals run in, and the
/// drive's current, with mains in it, comes three rows late over the press's network.
fn ink_oscillator(draw: &mut Draw, presence: Presence) -> Rig {
    let mass = draw.near(70.0);
    let surplus = presence.size_of(Effect::FrictionDrift, draw.near(0.8));
    let time_constant_s = draw.near(9.0);
    let late_s = presence.size_of(Effect::LoggedLate, draw.near(6.0e-3));
    let mut train = Train::one(mass, draw.near(90.0), draw.near(350.0));
    train.surfaces[0].scales.push(Scale::WarmUp {
        surplus,
        time_constant_s,
    });
    let controller = Controller::pid(mass, 7.5, 2.0e-3);
    let mut rig = rig(Kind::Linear, train, controller, 5.0e-8);
    rig.logs_current(1);
    rig.sensing.effort.late_s = late_s;
    rig.sensing.effort.noise = Noise {
        white: 1.5,
        pink: 0.0,
        mains: 1.0,
    };
    rig.know("friction_drift_gain", surplus, "");
    rig.know("friction_drift_time_constant", time_constant_s, "s");
    rig.know("logged_late", late_s, "s");
    rig.moved(
        draw,
        Room::about(0.06, (0.3, 3.5), 32.0),
        [Room::strokes, Room::swells],
        16.0,
    );
    rig
}
