//! Out of doors: a bridge that swings, a brush for solar panels, a floor in a pool.
//!
//! A bridge rolls on a ring of rollers of which some carry more than others. Bristles that lean
//! rub more against their lean than with it. A plate in water drags with velocity squared (Newman,
//! Marine Hydrodynamics, 1977, ch. 2).

use std::f64::consts::TAU;

use crate::control::Controller;
use crate::control::pi::{Pi, Shape};
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
        name: "swing-bridge",
        hides: &[Effect::PositionDependentFriction],
        build: swing_bridge,
    },
    Make {
        name: "panel-brush",
        hides: &[Effect::CoulombAsymmetry],
        build: panel_brush,
    },
    Make {
        name: "pool-floor",
        hides: &[Effect::QuadraticDrag],
        build: pool_floor,
    },
];

/// A bridge for walkers that swings open over a canal, at 250 Hz: its ring of rollers is uneven, so
/// that friction comes and goes nine times in a turn. Rows come with jitter.
fn swing_bridge(draw: &mut Draw, presence: Presence) -> Rig {
    let inertia = draw.near(4.0e6);
    let ring = Scale::Wavy {
        share: presence.size_of(Effect::PositionDependentFriction, draw.near(0.35)),
        waves: 9.0,
        phase: draw.between(0.0, TAU),
    };
    let mut train = Train::one(inertia, draw.near(2.0e4), draw.near(1.2e5));
    train.surfaces[0].scales.push(ring);
    let controller = Controller::cascade(inertia, 0.5, 2.5, 4.0e-3);
    let mut rig = rig(Kind::Rotary, train, controller, TAU / 268_435_456.0);
    rig.sensing.stamps.jitter_s = 3.0e-4;
    rig.noisy(500.0);
    rig.moved(
        draw,
        Room::about(0.6, (0.07, 0.03), 76.0),
        [Room::shifts, Room::points],
        40.0,
    );
    rig
}

/// The carriage of a machine that brushes solar panels, at 500 Hz with a gain that is higher at
/// rest: its bristles lean, and rub more on the way up the row. Rumble of the brush is 1/f noise.
/// No constant force is declared, and no setpoint is recorded.
fn panel_brush(draw: &mut Draw, presence: Presence) -> Rig {
    let (mass, coulomb) = (draw.near(60.0), draw.near(48.0));
    let asymmetry = presence.size_of(Effect::CoulombAsymmetry, -draw.near(0.25));
    let mut train = Train::one(mass, coulomb, draw.near(70.0));
    train.surfaces[0].scales.push(Scale::Direction(asymmetry));
    let shape = Shape::Scheduled {
        extra: 0.7,
        knee: 0.15,
    };
    let loops = Pi::of(mass, 2.6, 13.0, shape);
    let mut rig = rig(Kind::Linear, train, Controller::pi(loops, 2.0e-3), 2.0e-7);
    rig.base.retain(|effect| *effect != Effect::Offset);
    rig.sensing.reference = false;
    rig.sensing.effort.noise = Noise {
        white: 1.0,
        pink: 1.0,
        mains: 0.0,
    };
    rig.know("coulomb_asymmetry", asymmetry * coulomb, "N");
    rig.moved(
        draw,
        Room::about(1.4, (1.1, 2.5), 38.0),
        [Room::circles, Room::packets],
        20.0,
    );
    rig
}

/// The floor of a swimming pool that is lifted and lowered, at 250 Hz: floats carry nearly all of
/// it, and water drags at it with velocity squared. The drive records its velocity.
fn pool_floor(draw: &mut Draw, presence: Presence) -> Rig {
    let mass = draw.near(2800.0);
    let quadratic = presence.size_of(Effect::QuadraticDrag, draw.near(9.0e3));
    let mut train = Train::one(mass, draw.near(420.0), draw.near(1500.0));
    train.drags[0].quadratic = quadratic;
    train.fields.push((0, Field::Constant(-draw.near(500.0))));
    let controller = Controller::state_feedback(mass, 2.0, 4.0e-3);
    let mut rig = rig(Kind::Linear, train, controller, 2.0e-7);
    rig.sensing.velocity = Some(1.0e-5);
    rig.noisy(20.0);
    rig.know("quadratic_drag", quadratic, "N s2/m2");
    rig.moved(
        draw,
        Room::about(0.7, (0.45, 0.6), 52.0),
        [Room::swells, Room::ladder],
        28.0,
    );
    rig
}
