//! Stores: a shuttle in the cold, shelves that roll.
//!
//! Grease at minus twenty-five degrees gives way as it is worked (Lugt, Grease Lubrication in
//! Rolling Bearings, 2013). Links of a chain pull unevenly as they come onto their wheel (Shigley's
//! Mechanical Engineering Design, 2011, ch. 17), and a worm rubs with what it drives.

use std::f64::consts::TAU;

use crate::control::Controller;
use crate::control::pi::{Pi, Shape};
use crate::draw::Draw;
use crate::make::{Make, Presence, rig};
use crate::mechanics::field::Field;
use crate::mechanics::friction::Scale;
use crate::mechanics::inertia::Inertia;
use crate::mechanics::train::Train;
use crate::motion::Room;
use crate::rig::{EffortColumn, Kind, Rig};
use crate::truth::Effect;

/// The family.
pub const MAKES: &[Make] = &[
    Make {
        name: "freezer-shuttle",
        hides: &[Effect::FrictionDrift, Effect::Payload],
        build: freezer_shuttle,
    },
    Make {
        name: "mobile-shelf",
        hides: &[Effect::LoadDependentFriction, Effect::TorqueRipple],
        build: mobile_shelf,
    },
];

/// Force of the shuttle's motor per ampere, N/A.
const FREEZER_N_PER_A: f64 = 35.0;

/// A shuttle that fetches pallets in a deep-freeze store, at 250 Hz: the grease of its wheels is
/// stiff at the start, and it couples a trolley with a pallet on wheels of its own. The current is
/// recorded, and every two-hundred-and-fiftieth row is lost by radio.
fn freezer_shuttle(draw: &mut Draw, presence: Presence) -> Rig {
    let empty = draw.near(240.0);
    let pallet = presence.size_of(Effect::Payload, draw.near(110.0));
    let surplus = presence.size_of(Effect::FrictionDrift, draw.near(0.8));
    let time_constant_s = draw.near(11.0);
    let mut train = Train::one(empty, draw.near(70.0), draw.near(55.0));
    train.inertias[0] = Inertia::Payload {
        empty,
        loaded: empty + pallet,
        at_s: vec![draw.between(11.0, 14.0)],
    };
    train.surfaces[0].scales.push(Scale::WarmUp {
        surplus,
        time_constant_s,
    });
    let controller = Controller::cascade(empty, 1.3, 6.5, 4.0e-3);
    let mut rig = rig(Kind::Linear, train, controller, 5.0e-7);
    rig.column = EffortColumn::Current(1.0 / FREEZER_N_PER_A);
    rig.sensing.stamps.lost_share = 0.004;
    rig.noisy(3.0);
    rig.know("payload", pallet / FREEZER_N_PER_A, "A s2/m");
    rig.know("friction_drift_gain", surplus, "");
    rig.know("friction_drift_time_constant", time_constant_s, "s");
    rig.moved(
        draw,
        Room::about(1.9, (1.4, 1.3), 48.0),
        [Room::points, Room::raster],
        26.0,
    );
    rig
}

/// Pitch of the chain that moves the shelf, m.
const SHELF_CHAIN_M: f64 = 0.0762;

/// A row of an archive's shelves, three tonnes, on a chain and a worm, at 500 Hz under a controller
/// in velocity form: the worm takes a fifth of what it drives, and every link of the chain pulls
/// once.
fn mobile_shelf(draw: &mut Draw, presence: Presence) -> Rig {
    let (mass, coulomb) = (draw.near(3200.0), draw.near(260.0));
    let share = presence.size_of(Effect::LoadDependentFriction, draw.near(0.18) / coulomb);
    let amplitude = presence.size_of(Effect::TorqueRipple, draw.near(70.0));
    let mut train = Train::one(mass, coulomb, draw.near(900.0));
    train.surfaces[0].scales.push(Scale::Load(share));
    let links = Field::Cogging {
        amplitude,
        waves: TAU / SHELF_CHAIN_M,
        phase: draw.between(0.0, TAU),
    };
    train.fields.push((0, links));
    let loops = Pi::of(mass, 1.0, 5.0, Shape::VelocityForm(9.0e3));
    let mut rig = rig(Kind::Linear, train, Controller::pi(loops, 2.0e-3), 5.0e-7);
    rig.noisy(12.0);
    rig.know("load_dependent_friction", share * coulomb, "");
    rig.know("torque_ripple_amplitude", amplitude, "N");
    rig.know("torque_ripple_period", SHELF_CHAIN_M, "m");
    rig.moved(
        draw,
        Room::about(1.0, (0.4, 0.5), 46.0),
        [Room::seek, Room::jogs],
        25.0,
    );
    rig
}
