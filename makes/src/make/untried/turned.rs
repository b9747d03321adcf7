//! What turns finely: a mirror after the sun, a lathe that engraves.
//!
//! A worm wheel that is cut off its middle errs once per tooth of it, and its worm has play in it
//! (Smith, Gear Noise and Vibration, 2003; Nordin and Gutman, Automatica 38, 2002).

use std::f64::consts::TAU;

use crate::control::Controller;
use crate::draw::Draw;
use crate::make::{Make, Presence, rig};
use crate::mechanics::friction::{Law, Stribeck};
use crate::mechanics::joint::Joint;
use crate::mechanics::train::Train;
use crate::motion::Room;
use crate::rig::{Kind, Rig};
use crate::sensing::{Encoder, Rounding, Wave};
use crate::truth::Effect;

/// The family.
pub const MAKES: &[Make] = &[
    Make {
        name: "rose-engine",
        hides: &[Effect::PitchError, Effect::Backlash],
        build: rose_engine,
    },
    Make {
        name: "coelostat",
        hides: &[Effect::Stribeck],
        build: coelostat,
    },
];

/// Teeth of the rose engine's worm wheel.
const ROSE_TEETH: f64 = 90.0;

/// The spindle of a lathe that engraves dials, on a worm wheel of ninety teeth: it errs with every
/// tooth and has play. Encoders sit on worm and spindle, wind-up is declared.
fn rose_engine(draw: &mut Draw, presence: Presence) -> Rig {
    let (worm, spindle) = (draw.near(0.5), draw.near(0.9));
    let stiffness = draw.near(2.0e5);
    let gap = presence.size_of(Effect::Backlash, draw.near(7.0e-4));
    let joint = Joint {
        gap,
        ..Joint::stiff(stiffness, 160.0)
    };
    let train = Train::one(worm, draw.near(1.5), draw.near(0.8)).then(
        joint,
        spindle,
        draw.near(5.0),
        draw.near(1.2),
    );
    let wave = Wave {
        amplitude: presence.size_of(Effect::PitchError, draw.near(2.0e-4)),
        period: TAU / ROSE_TEETH,
        phase: draw.between(0.0, TAU),
    };
    let controller = Controller::cascade(worm + spindle, 3.0, 16.0, 1.0e-3);
    let mut rig = rig(Kind::Rotary, train, controller, TAU / 33_554_432.0);
    rig.sensing.load = Some(Encoder::of(TAU / 1_048_576.0, Rounding::Nearest).with(wave));
    rig.declare(Effect::Compliance);
    rig.noisy(0.1);
    rig.know("backlash_gap", gap, "rad");
    rig.know("compliance_stiffness", stiffness, "N m/rad");
    rig.know("pitch_error_amplitude", wave.amplitude, "rad");
    rig.know("pitch_error_period", wave.period, "rad");
    rig.moved(
        draw,
        Room::about(1.5, (2.5, 10.0), 26.0),
        [Room::circles, Room::packets],
        14.0,
    );
    rig
}

/// The mirror of a coelostat that leads the sun into a laboratory, at 250 Hz: its plain bearings
/// grip at the speed of the sky and let go when it turns to another target.
fn coelostat(draw: &mut Draw, presence: Presence) -> Rig {
    let (inertia, coulomb) = (draw.near(90.0), draw.near(12.0));
    let excess = presence.size_of(Effect::Stribeck, draw.near(0.9));
    let mut train = Train::one(inertia, coulomb, draw.near(24.0));
    train.surfaces[0].law = Law::Rigid {
        coulomb,
        stribeck: Some(Stribeck {
            excess,
            velocity: draw.near(0.012),
            exponent: 1.3,
        }),
    };
    let controller = Controller::cascade(inertia, 0.9, 5.0, 4.0e-3);
    let mut rig = rig(Kind::Rotary, train, controller, TAU / 67_108_864.0);
    rig.noisy(0.3);
    rig.know("stribeck_excess", excess * coulomb, "N m");
    rig.moved(
        draw,
        Room::about(1.0, (0.25, 0.3), 64.0),
        [Room::tracking, Room::ladder],
        34.0,
    );
    rig
}
