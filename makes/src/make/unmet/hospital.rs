//! Hospitals: a ring that turns about a patient, a couch, a leaf that shapes a beam.
//!
//! Brushes on slip rings run in (Holm, Electric Contacts, 1967). Flanks of a thread rub with what
//! they carry (Olofsson and Ekerfors, Wear 155, 1992). A contact gives way before it slides (Dahl,
//! Aerospace report TOR-158, 1968).

use std::f64::consts::TAU;

use crate::control::Controller;
use crate::control::pi::{Pi, Shape};
use crate::draw::Draw;
use crate::drive::ConstantRipple;
use crate::make::{Make, Presence, rig};
use crate::mechanics::friction::{Law, Scale};
use crate::mechanics::train::Train;
use crate::motion::Room;
use crate::rig::{EffortColumn, Kind, Rig};
use crate::truth::Effect;

/// The family.
pub const MAKES: &[Make] = &[
    Make {
        name: "tomograph-ring",
        hides: &[Effect::FrictionDrift, Effect::TorqueConstantRipple],
        build: tomograph_ring,
    },
    Make {
        name: "patient-couch",
        hides: &[
            Effect::LoadDependentFriction,
            Effect::PositionDependentFriction,
        ],
        build: patient_couch,
    },
    Make {
        name: "collimator-leaf",
        hides: &[Effect::Presliding],
        build: collimator_leaf,
    },
];

/// Pole pairs of the tomograph's ring motor.
const RING_POLE_PAIRS: f64 = 24.0;
/// Its torque per ampere, N m/A.
const RING_NM_PER_A: f64 = 6.5;

/// The ring of a tomograph on a direct drive at 2 kHz, every second row kept: the brushes of its
/// slip rings run in, and its pole pairs are uneven. The current is recorded.
fn tomograph_ring(draw: &mut Draw, presence: Presence) -> Rig {
    let inertia = draw.near(95.0);
    let surplus = presence.size_of(Effect::FrictionDrift, draw.near(0.7));
    let time_constant_s = draw.near(12.0);
    let wave = ConstantRipple {
        share: presence.size_of(Effect::TorqueConstantRipple, draw.near(0.07)),
        waves: RING_POLE_PAIRS,
        phase: draw.between(0.0, TAU),
    };
    let mut train = Train::one(inertia, draw.near(40.0), draw.near(9.0));
    train.surfaces[0].scales.push(Scale::WarmUp {
        surplus,
        time_constant_s,
    });
    let controller = Controller::state_feedback(inertia, 5.0, 5.0e-4);
    let mut rig = rig(Kind::Rotary, train, controller, TAU / 67_108_864.0);
    rig.column = EffortColumn::Current(1.0 / RING_NM_PER_A);
    rig.drive.ripple = Some(wave);
    rig.logs_current(2);
    rig.noisy(1.5);
    rig.know("friction_drift_gain", surplus, "");
    rig.know("friction_drift_time_constant", time_constant_s, "s");
    rig.know("torque_constant_ripple", wave.share, "");
    rig.know("torque_constant_ripple_order", RING_POLE_PAIRS, "1/rev");
    rig.moved(
        draw,
        Room::about(3.0, (2.5, 5.0), 40.0),
        [Room::waves, Room::raster],
        22.0,
    );
    rig
}

/// Travel of the couch per turn of its screw, m.
const COUCH_LEAD_M: f64 = 0.02;

/// A couch on a trapezoidal thread, at 500 Hz: the flanks take a fifth of what drives it, and the
/// way is worn where most patients are brought to. The motor's torque is recorded.
fn patient_couch(draw: &mut Draw, presence: Presence) -> Rig {
    let (mass, coulomb) = (draw.near(320.0), draw.near(130.0));
    let share = presence.size_of(Effect::LoadDependentFriction, draw.near(0.2) / coulomb);
    let worn = Scale::Bump {
        centre: draw.between(-0.1, 0.1),
        width: draw.near(0.12),
        share: presence.size_of(Effect::PositionDependentFriction, draw.near(0.8)),
    };
    let mut train = Train::one(mass, coulomb, draw.near(260.0));
    train.surfaces[0].scales.extend([Scale::Load(share), worn]);
    let shape = Shape::Scheduled {
        extra: 0.4,
        knee: 0.08,
    };
    let loops = Pi::of(mass, 2.5, 13.0, shape);
    let mut rig = rig(Kind::Linear, train, Controller::pi(loops, 2.0e-3), 1.0e-7);
    rig.column = EffortColumn::Torque(COUCH_LEAD_M / TAU);
    rig.stated.lead_m_per_rev = Some(COUCH_LEAD_M);
    rig.noisy(3.0);
    rig.know("load_dependent_friction", share * coulomb, "");
    rig.moved(
        draw,
        Room::about(0.35, (0.3, 1.8), 38.0),
        [Room::errands, Room::jogs],
        20.0,
    );
    rig
}

/// A tungsten leaf that shapes the beam of an accelerator, at 4 kHz: its plastic nut gives way over
/// a hundredth of a millimetre before it slides. No setpoint is recorded.
fn collimator_leaf(draw: &mut Draw, presence: Presence) -> Rig {
    let (mass, coulomb) = (draw.near(0.9), draw.near(5.0));
    let deflection = draw.near(1.2e-5);
    let mut train = Train::one(mass, coulomb, draw.near(12.0));
    if presence.has(Effect::Presliding) {
        train.surfaces[0].law = Law::Dahl {
            coulomb,
            stiffness: coulomb / deflection,
        };
    }
    let controller = Controller::pid(mass, 12.0, 2.5e-4);
    let mut rig = rig(Kind::Linear, train, controller, 5.0e-9);
    rig.sensing.reference = false;
    rig.noisy(0.03);
    let shown = presence.size_of(Effect::Presliding, deflection);
    rig.know("presliding_deflection", shown, "m");
    rig.moved(
        draw,
        Room::about(0.02, (0.04, 1.0), 14.0),
        [Room::tracking, Room::jogs],
        8.0,
    );
    rig
}
