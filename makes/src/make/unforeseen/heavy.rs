//! Open pits and stages: the slewing gear of a reclaimer, a wagon that carries scenery.
//!
//! A pinion has play in its ring (Nordin and Gutman, Automatica 38, 2002), and rollers under
//! hundreds of tonnes grip at creeping speed (Armstrong-Hélouvry, Dupont and Canudas de Wit,
//! Automatica 30, 1994). Friction of the wagon's wheels is that of its bearings, which scenery on
//! castors of its own does not press on.

use std::f64::consts::TAU;

use crate::control::Controller;
use crate::draw::Draw;
use crate::make::{Make, Presence, rig};
use crate::mechanics::friction::{Law, Stribeck};
use crate::mechanics::inertia::Inertia;
use crate::mechanics::joint::Joint;
use crate::mechanics::train::Train;
use crate::motion::Room;
use crate::rig::{Kind, Rig};
use crate::sensing::{Encoder, Rounding, Stamps};
use crate::truth::Effect;

/// The family.
pub const MAKES: &[Make] = &[
    Make {
        name: "reclaimer-slew",
        hides: &[Effect::Backlash, Effect::Stribeck],
        build: reclaimer_slew,
    },
    Make {
        name: "stage-wagon",
        hides: &[Effect::Payload],
        build: stage_wagon,
    },
];

/// The slewing gear of a bucket-wheel reclaimer, at 250 Hz: its pinions have play, and the ring of
/// rollers grips at creeping speed. Encoders sit on gear and boom, wind-up is declared.
fn reclaimer_slew(draw: &mut Draw, presence: Presence) -> Rig {
    let (gear, boom) = (draw.near(1.6e5), draw.near(3.2e5));
    let (stiffness, coulomb) = (draw.near(2.0e9), draw.near(4.5e3));
    let gap = presence.size_of(Effect::Backlash, draw.near(1.2e-3));
    let excess = presence.size_of(Effect::Stribeck, draw.near(0.8));
    let joint = Joint {
        gap,
        ..Joint::stiff(stiffness, 5.0e6)
    };
    let mut train = Train::one(gear, draw.near(1.2e3), draw.near(8.0e3)).then(
        joint,
        boom,
        coulomb,
        draw.near(1.5e4),
    );
    train.surfaces[1].law = Law::Rigid {
        coulomb,
        stribeck: Some(Stribeck {
            excess,
            velocity: draw.near(0.012),
            exponent: 2.0,
        }),
    };
    let controller = Controller::cascade(gear + boom, 0.6, 3.0, 4.0e-3);
    let mut rig = rig(Kind::Rotary, train, controller, TAU / 134_217_728.0);
    rig.sensing.load = Some(Encoder::of(TAU / 2_097_152.0, Rounding::Nearest));
    rig.declare(Effect::Compliance);
    rig.noisy(120.0);
    rig.know("compliance_stiffness", stiffness, "N m/rad");
    rig.know("backlash_gap", gap, "rad");
    rig.know("stribeck_excess", excess * coulomb, "N m");
    rig.moved(
        draw,
        Room::about(0.5, (0.16, 0.12), 90.0),
        [Room::errands, Room::seek],
        48.0,
    );
    rig
}

/// A wagon of a theatre's side stage, at 250 Hz: it is coupled to scenery on castors and pulls it
/// along from then on. Its encoder counts two micrometres, and every two-hundredth row is lost on
/// the house's network.
fn stage_wagon(draw: &mut Draw, presence: Presence) -> Rig {
    let empty = draw.near(650.0);
    let scenery = presence.size_of(Effect::Payload, draw.near(260.0));
    let mut train = Train::one(empty, draw.near(150.0), draw.near(180.0));
    train.inertias[0] = Inertia::Payload {
        empty,
        loaded: empty + scenery,
        at_s: vec![draw.between(12.0, 15.0)],
    };
    let controller = Controller::cascade(empty, 1.0, 5.0, 4.0e-3);
    let mut rig = rig(Kind::Linear, train, controller, 2.0e-6);
    rig.sensing.stamps = Stamps {
        lost_share: 0.005,
        ..Stamps::default()
    };
    rig.noisy(3.0);
    rig.know("payload", scenery, "kg");
    rig.moved(
        draw,
        Room::about(2.2, (0.9, 0.7), 60.0),
        [Room::shifts, Room::waves],
        34.0,
    );
    rig
}
