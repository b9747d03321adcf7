//! Ships and basins: what turns or runs in water or over it.
//!
//! A body in water drags with velocity squared, F = ½ρ·C·A·v² (Morison's second term; Newman,
//! Marine Hydrodynamics, 1977, ch. 2), and takes some water along, which is inertia. A scraper that
//! trails slides more easily than one that is pushed.

use std::f64::consts::TAU;

use crate::control::Controller;
use crate::draw::Draw;
use crate::make::{Make, Presence, rig};
use crate::mechanics::friction::Scale;
use crate::mechanics::train::Train;
use crate::motion::Room;
use crate::rig::{Kind, Rig};
use crate::truth::Effect;

/// The family.
pub const MAKES: &[Make] = &[
    Make {
        name: "azimuth-pod",
        hides: &[
            Effect::QuadraticDrag,
            Effect::FrictionDrift,
            Effect::LoggedLate,
        ],
        build: azimuth_pod,
    },
    Make {
        name: "towing-carriage",
        hides: &[Effect::CoulombAsymmetry, Effect::QuadraticDrag],
        build: towing_carriage,
    },
];

/// The steering of a ferry's pod, fifteen tonnes times a square metre with the water it takes
/// along: the strut drags broadside, the slewing seal is stiff until it is warm, and the ship's
/// network brings the torque some cycles late, at 250 Hz.
fn azimuth_pod(draw: &mut Draw, presence: Presence) -> Rig {
    let inertia = draw.near(1.5e4);
    let quadratic = presence.size_of(Effect::QuadraticDrag, draw.near(8.0e3));
    let surplus = presence.size_of(Effect::FrictionDrift, draw.near(0.7));
    let late_s = presence.size_of(Effect::LoggedLate, draw.near(0.018));
    let mut train = Train::one(inertia, draw.near(3500.0), draw.near(2500.0));
    train.drags[0].quadratic = quadratic;
    train.surfaces[0].scales.push(Scale::WarmUp {
        surplus,
        time_constant_s: draw.near(13.0),
    });
    let controller = Controller::pid(inertia, 3.0, 1.0e-3);
    let mut rig = rig(Kind::Rotary, train, controller, TAU / 67_108_864.0);
    rig.logs_current(4);
    rig.sensing.effort.late_s = late_s;
    rig.noisy(40.0);
    rig.know("quadratic_drag", quadratic, "N m s2/rad2");
    rig.know("friction_drift_gain", surplus, "");
    rig.know("logged_late", late_s, "s");
    rig.moved(
        draw,
        Room::about(1.4, (0.9, 0.9), 72.0),
        [Room::errands, Room::seek],
        36.0,
    );
    rig
}

/// The carriage over a basin for model ships, at 500 Hz under an observer of the disturbance: the
/// model drags in the water, the scrapers before its wheels rub more on the way out. No constant
/// force is declared.
fn towing_carriage(draw: &mut Draw, presence: Presence) -> Rig {
    let (mass, coulomb) = (draw.near(900.0), draw.near(160.0));
    let asymmetry = presence.size_of(Effect::CoulombAsymmetry, draw.near(0.35));
    let quadratic = presence.size_of(Effect::QuadraticDrag, draw.near(190.0));
    let mut train = Train::one(mass, coulomb, draw.near(70.0));
    train.surfaces[0].scales.push(Scale::Direction(asymmetry));
    train.drags[0].quadratic = quadratic;
    let controller = Controller::rejecting(mass, 2.5, 2.0e-3);
    let mut rig = rig(Kind::Linear, train, controller, 2.0e-7);
    rig.base.retain(|effect| *effect != Effect::Offset);
    rig.noisy(4.0);
    rig.know("coulomb_asymmetry", asymmetry * coulomb, "N");
    rig.know("quadratic_drag", quadratic, "N s2/m2");
    rig.moved(
        draw,
        Room::about(6.0, (2.4, 0.9), 60.0),
        [Room::packets, Room::errands],
        36.0,
    );
    rig
}
