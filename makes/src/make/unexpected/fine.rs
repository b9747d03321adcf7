//! Small axes: the piston of a burette, the slider of a camera, the focuser of a telescope.
//!
//! A seal of rubber gives way before it slides (Dahl, Aerospace report TOR-158, 1968). A nut grips
//! at creeping speed (Armstrong-Hélouvry, Dupont and Canudas de Wit, Automatica 30, 1994), and cold
//! grease gets thinner while it is worked.

use crate::control::Controller;
use crate::draw::Draw;
use crate::make::{Make, Presence, rig};
use crate::mechanics::friction::{Law, Scale, Stribeck};
use crate::mechanics::train::Train;
use crate::motion::Room;
use crate::rig::{Kind, Rig};
use crate::sensing::Noise;
use crate::truth::Effect;

/// The family.
pub const MAKES: &[Make] = &[
    Make {
        name: "titration-piston",
        hides: &[Effect::Presliding],
        build: titration_piston,
    },
    Make {
        name: "camera-slider",
        hides: &[Effect::LoggedLate],
        build: camera_slider,
    },
    Make {
        name: "mirror-focuser",
        hides: &[Effect::Stribeck, Effect::FrictionDrift],
        build: mirror_focuser,
    },
];

/// The piston of a burette that titrates: its seal gives way by some hundredths of a millimetre
/// before it slides. Mains is in its log.
fn titration_piston(draw: &mut Draw, presence: Presence) -> Rig {
    let (mass, coulomb) = (draw.near(0.6), draw.near(5.0));
    let deflection = draw.near(7.0e-5);
    let mut train = Train::one(mass, coulomb, draw.near(30.0));
    if presence.has(Effect::Presliding) {
        train.surfaces[0].law = Law::Dahl {
            coulomb,
            stiffness: coulomb / deflection,
        };
    }
    let controller = Controller::pid(mass, 26.0, 1.0e-3);
    let mut rig = rig(Kind::Linear, train, controller, 1.0e-8);
    rig.sensing.effort.noise = Noise {
        white: 0.03,
        pink: 0.0,
        mains: 0.03,
    };
    let shown = presence.size_of(Effect::Presliding, deflection);
    rig.know("presliding_deflection", shown, "m");
    rig.moved(
        draw,
        Room::about(0.015, (0.04, 1.2), 24.0),
        [Room::errands, Room::strokes],
        13.0,
    );
    rig
}

/// A slider that leads a camera past its subject, logged at 250 Hz over a wire of its own: rows
/// come with jitter, and the current in them is three of them old. Its belt's encoder is coarse.
fn camera_slider(draw: &mut Draw, presence: Presence) -> Rig {
    let mass = draw.near(6.0);
    let late_s = presence.size_of(Effect::LoggedLate, draw.near(0.012));
    let train = Train::one(mass, draw.near(7.0), draw.near(12.0));
    let controller = Controller::cascade(mass, 2.6, 13.0, 1.0e-3);
    let mut rig = rig(Kind::Linear, train, controller, 2.0e-6);
    rig.logs_current(4);
    rig.sensing.effort.late_s = late_s;
    rig.sensing.stamps.jitter_s = 2.0e-4;
    rig.noisy(0.25);
    rig.know("logged_late", late_s, "s");
    rig.moved(
        draw,
        Room::about(0.45, (0.6, 2.2), 40.0),
        [Room::jogs, Room::waves],
        22.0,
    );
    rig
}

/// What shifts the second mirror of a telescope, at 250 Hz: the nut of its screw grips at creeping
/// speed, and its grease is cold at the start of the night.
fn mirror_focuser(draw: &mut Draw, presence: Presence) -> Rig {
    let (mass, coulomb) = (draw.near(40.0), draw.near(26.0));
    let excess = presence.size_of(Effect::Stribeck, draw.near(0.6));
    let surplus = presence.size_of(Effect::FrictionDrift, draw.near(0.7));
    let time_constant_s = draw.near(10.0);
    let mut train = Train::one(mass, coulomb, draw.near(500.0));
    train.surfaces[0].law = Law::Rigid {
        coulomb,
        stribeck: Some(Stribeck {
            excess,
            velocity: draw.near(4.0e-3),
            exponent: 2.0,
        }),
    };
    train.surfaces[0].scales.push(Scale::WarmUp {
        surplus,
        time_constant_s,
    });
    let controller = Controller::cascade(mass, 2.2, 11.0, 4.0e-3);
    let mut rig = rig(Kind::Linear, train, controller, 2.0e-8);
    rig.noisy(0.3);
    rig.know("stribeck_excess", excess * coulomb, "N");
    rig.know("friction_drift_gain", surplus, "");
    rig.know("friction_drift_time_constant", time_constant_s, "s");
    rig.moved(
        draw,
        Room::about(0.03, (0.03, 0.3), 40.0),
        [Room::shifts, Room::points],
        22.0,
    );
    rig
}
