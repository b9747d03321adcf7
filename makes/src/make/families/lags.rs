//! Lags: guides and seals whose friction needs some milliseconds to follow the velocity.
//!
//! A film of oil has to be squeezed out before friction rises and drawn in before it falls (Hess
//! and Soom, ASME J. Tribology 112, 1990), and asperities bend before they slip: generalised
//! Maxwell slip (Lampaert, Al-Bender and Swevers, IEEE PhysCon, 2003). The fall has an exponent
//! between one and two (Armstrong-Hélouvry, Dupont and Canudas de Wit, Automatica 30, 1994).

use std::f64::consts::TAU;

use crate::control::Controller;
use crate::control::pi::{Pi, Shape};
use crate::draw::Draw;
use crate::make::{Make, Presence, rig};
use crate::mechanics::friction::{Law, Stribeck};
use crate::mechanics::joint::Joint;
use crate::mechanics::train::Train;
use crate::motion::Room;
use crate::rig::{EffortColumn, Kind, Rig};
use crate::sensing::{Encoder, Rounding};
use crate::truth::Effect;

/// The family.
pub const MAKES: &[Make] = &[
    Make {
        name: "knife-grinder",
        hides: &[Effect::Presliding, Effect::Stribeck],
        build: knife_grinder,
    },
    Make {
        name: "marble-router",
        hides: &[Effect::Presliding, Effect::Stribeck],
        build: marble_router,
    },
    Make {
        name: "sausage-filler",
        hides: &[Effect::Stribeck],
        build: sausage_filler,
    },
];

/// Elements of a surface.
const ELEMENTS: usize = 10;
/// Deflection of a surface without presliding, as a share of that with it.
const RIGID: f64 = 0.01;

/// A surface that bends before it slips and whose friction falls and lags: what of it is there.
fn surface(presence: Presence, coulomb: f64, fall: Stribeck, lag_s: f64, deflection: f64) -> Law {
    let bends = presence.has(Effect::Presliding);
    if !bends && !presence.has(Effect::Stribeck) {
        return Law::coulomb(coulomb);
    }
    let reach = if bends {
        deflection
    } else {
        RIGID * deflection
    };
    Law::generalised_maxwell_slip(coulomb, Some(fall), lag_s, reach, ELEMENTS)
}

/// States a fall and its lag; one that is not there has none.
fn know_fall(rig: &mut Rig, excess: f64, unit: &str, lag_s: f64) {
    rig.know("stribeck_excess", excess, unit);
    let is_there = excess != 0.0;
    rig.know("stribeck_lag", if is_there { lag_s } else { 0.0 }, "s");
}

/// The cross slide of a grinder for planer knives, at 2 kHz: its oiled flat ways bend by tens of
/// micrometres before they slip, and their oil is four milliseconds behind. By the motor alone.
fn knife_grinder(draw: &mut Draw, presence: Presence) -> Rig {
    let (mass, coulomb) = (draw.near(38.0), draw.near(55.0));
    let (deflection, lag_s) = (draw.near(3.0e-5), draw.near(4.0e-3));
    let fall = Stribeck {
        excess: presence.size_of(Effect::Stribeck, draw.near(0.6)),
        velocity: draw.near(0.012),
        exponent: 1.5,
    };
    let ways = surface(presence, coulomb, fall, lag_s, deflection);
    let shown = presence.size_of(Effect::Presliding, ways.deflection());
    let mut train = Train::one(mass, coulomb, draw.near(140.0));
    train.surfaces[0].law = ways;
    let controller = Controller::cascade(mass, 6.0, 34.0, 5.0e-4);
    let mut rig = rig(Kind::Linear, train, controller, 1.0e-8);
    rig.noisy(0.6);
    rig.know("presliding_deflection", shown, "m");
    know_fall(&mut rig, fall.excess * coulomb, "N", lag_s);
    rig.moved(
        draw,
        Room::about(0.03, (0.12, 0.8), 24.0),
        [Room::errands, Room::shifts],
        13.0,
    );
    rig
}

/// The bridge of a router for marble on its screws, at 500 Hz with a scale beside it: box ways that
/// bend by a tenth of a millimetre and stick, and whose oil is fifteen milliseconds behind, while
/// the screw's bearings rub as they always do. The wind-up is declared.
fn marble_router(draw: &mut Draw, presence: Presence) -> Rig {
    let (screw, bridge) = (draw.near(700.0), draw.near(1200.0));
    let (bearings, coulomb) = (draw.near(160.0), draw.near(650.0));
    let (deflection, lag_s) = (draw.near(1.2e-4), draw.near(1.5e-2));
    let stiffness = draw.near(2.5e8);
    let fall = Stribeck {
        excess: presence.size_of(Effect::Stribeck, draw.near(0.7)),
        velocity: draw.near(0.02),
        exponent: 1.2,
    };
    let ways = surface(presence, coulomb, fall, lag_s, deflection);
    let shown = presence.size_of(Effect::Presliding, ways.deflection());
    let mut train = Train::one(screw, bearings, draw.near(500.0)).then(
        Joint::stiff(stiffness, 1.5e5),
        bridge,
        coulomb,
        draw.near(1500.0),
    );
    train.surfaces[1].law = ways;
    let controller = Controller::cascade(screw + bridge, 3.0, 16.0, 2.0e-3);
    let mut rig = rig(Kind::Linear, train, controller, 5.0e-8);
    rig.sensing.load = Some(Encoder::of(1.0e-7, Rounding::Nearest));
    rig.declare(Effect::Compliance);
    rig.noisy(8.0);
    rig.know("compliance_stiffness", stiffness, "N/m");
    rig.know("presliding_deflection", shown, "m");
    know_fall(&mut rig, fall.excess * coulomb, "N", lag_s);
    rig.moved(
        draw,
        Room::about(0.25, (0.3, 1.2), 44.0),
        [Room::errands, Room::strokes],
        24.0,
    );
    rig
}

/// Travel of the filler's piston per turn of its screw, m.
const FILLER_LEAD_M: f64 = 0.02;

/// The piston of a sausage filler, at 250 Hz with the increments of a PI loop: lips of rubber on a
/// film of fat stick at rest, and the film is sixteen milliseconds behind. In torque of the motor.
fn sausage_filler(draw: &mut Draw, presence: Presence) -> Rig {
    let (mass, coulomb) = (draw.near(420.0), draw.near(380.0));
    let lag_s = draw.near(1.6e-2);
    let fall = Stribeck {
        excess: presence.size_of(Effect::Stribeck, draw.near(0.8)),
        velocity: draw.near(0.03),
        exponent: 1.4,
    };
    let mut train = Train::one(mass, coulomb, draw.near(900.0));
    train.surfaces[0].law = surface(presence, coulomb, fall, lag_s, 2.0e-5);
    let loops = Pi::of(mass, 1.6, 8.0, Shape::VelocityForm(6000.0));
    let mut rig = rig(Kind::Linear, train, Controller::pi(loops, 4.0e-3), 2.0e-7);
    let per = FILLER_LEAD_M / TAU;
    rig.column = EffortColumn::Torque(per);
    rig.stated.lead_m_per_rev = Some(FILLER_LEAD_M);
    rig.noisy(4.0);
    know_fall(&mut rig, fall.excess * coulomb * per, "N m", lag_s);
    rig.moved(
        draw,
        Room::about(0.2, (0.25, 1.2), 60.0),
        [Room::errands, Room::ladder],
        32.0,
    );
    rig
}
