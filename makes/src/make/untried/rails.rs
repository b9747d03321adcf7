//! Rails: what moves their blades, what carries a wagon across.
//!
//! A crank moves the mass of its slide by r·sin x per angle, so that the shaft feels the mean of
//! its inertia and a wave of two per turn (Wittenburg, Dynamics of Multibody Systems, 2008).

use std::f64::consts::TAU;

use crate::control::Controller;
use crate::draw::Draw;
use crate::make::{Make, Presence, rig};
use crate::mechanics::friction::Scale;
use crate::mechanics::inertia::Inertia;
use crate::mechanics::train::Train;
use crate::motion::Room;
use crate::rig::{EffortColumn, Kind, Rig};
use crate::truth::Effect;

/// The family.
pub const MAKES: &[Make] = &[
    Make {
        name: "point-machine",
        hides: &[
            Effect::PositionDependentInertia,
            Effect::CoulombAsymmetry,
            Effect::Delay,
        ],
        build: point_machine,
    },
    Make {
        name: "rail-traverser",
        hides: &[Effect::Payload],
        build: rail_traverser,
    },
];

/// The crank that moves the blades of a set of points, on its test stand: their mass comes and goes
/// twice a turn, their chairs are laid a little uphill one way, and the safe bus lets a command act
/// after its second telegram. No constant torque is declared.
fn point_machine(draw: &mut Draw, presence: Presence) -> Rig {
    let (inertia, coulomb) = (draw.near(3.2), draw.near(14.0));
    let share = presence.size_of(Effect::PositionDependentInertia, draw.near(0.3));
    let asymmetry = presence.size_of(Effect::CoulombAsymmetry, draw.near(0.3));
    let delay_s = presence.size_of(Effect::Delay, draw.near(2.6e-3));
    let mut train = Train::one(inertia, coulomb, draw.near(3.0));
    train.inertias[0] = Inertia::Harmonic {
        mean: inertia,
        share,
        waves: 2.0,
        phase: draw.between(0.0, TAU),
    };
    train.surfaces[0].scales.push(Scale::Direction(-asymmetry));
    let controller = Controller::pid(inertia, 5.0, 1.0e-3);
    let mut rig = rig(Kind::Rotary, train, controller, TAU / 16_777_216.0);
    rig.drive.dead_time_s = delay_s;
    rig.base.retain(|effect| *effect != Effect::Offset);
    rig.noisy(0.3);
    rig.know("position_dependent_inertia", share * inertia, "kg m2");
    rig.know("coulomb_asymmetry", -asymmetry * coulomb, "N m");
    rig.know("delay", delay_s, "s");
    rig.moved(
        draw,
        Room::about(2.8, (5.0, 32.0), 26.0),
        [Room::seek, Room::packets],
        14.0,
    );
    rig
}

/// Force of the traverser's motors per ampere, N/A.
const TRAVERSER_N_PER_A: f64 = 150.0;

/// The traverser of a railway workshop at 250 Hz: nine tonnes, and two thirds as much more when a
/// wagon has been drawn onto it. Rails and wheels roll alike with either. The current is recorded.
fn rail_traverser(draw: &mut Draw, presence: Presence) -> Rig {
    let empty = draw.near(9.0e3);
    let wagon = presence.size_of(Effect::Payload, draw.near(6.0e3));
    let mut train = Train::one(empty, draw.near(900.0), draw.near(1500.0));
    train.inertias[0] = Inertia::Payload {
        empty,
        loaded: empty + wagon,
        at_s: vec![draw.between(9.0, 13.0)],
    };
    let controller = Controller::cascade(empty, 1.0, 5.5, 4.0e-3);
    let mut rig = rig(Kind::Linear, train, controller, 1.0e-6);
    rig.column = EffortColumn::Current(1.0 / TRAVERSER_N_PER_A);
    rig.noisy(25.0);
    rig.know("payload", wagon / TRAVERSER_N_PER_A, "A s2/m");
    rig.moved(
        draw,
        Room::about(5.0, (1.3, 0.5), 72.0),
        [Room::seek, Room::raster],
        50.0,
    );
    rig
}
