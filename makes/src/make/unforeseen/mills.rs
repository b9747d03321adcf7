//! Mills: the back gauge of a paper guillotine, a lathe that peels veneer, the guide bar of a warp
//! knitter, a piston that deposits chocolate.
//!
//! A screw errs with every turn and winds up under its load (Slocum, Precision Machine Design,
//! 1992, ch. 10). Iron that saturates gives u/(1 + k|u|). Chocolate resists by what it is drawn or
//! pressed through, and a lip of rubber is sheared before it slides (Bouc and Wen's law).

use std::f64::consts::TAU;

use crate::control::Controller;
use crate::control::pi::{Pi, Shape};
use crate::draw::Draw;
use crate::make::{Make, Presence, rig};
use crate::mechanics::field::{Drag, Field};
use crate::mechanics::friction::{Law, Scale};
use crate::mechanics::joint::Joint;
use crate::mechanics::train::Train;
use crate::motion::Room;
use crate::rig::{EffortColumn, Kind, Rig};
use crate::sensing::{Encoder, Rounding, Wave};
use crate::truth::Effect;

/// The family.
pub const MAKES: &[Make] = &[
    Make {
        name: "back-gauge",
        hides: &[Effect::PitchError, Effect::Compliance],
        build: back_gauge,
    },
    Make {
        name: "veneer-lathe",
        hides: &[Effect::TorqueSaturation, Effect::LoadDependentFriction],
        build: veneer_lathe,
    },
    Make {
        name: "guide-bar",
        hides: &[Effect::TorqueSaturation, Effect::TorqueRipple],
        build: guide_bar,
    },
    Make {
        name: "chocolate-piston",
        hides: &[
            Effect::ViscousAsymmetry,
            Effect::Presliding,
            Effect::FrictionDrift,
        ],
        build: chocolate_piston,
    },
];

/// Travel of the back gauge per turn of its screw, m.
const GAUGE_LEAD_M: f64 = 0.008;

/// The back gauge of a guillotine that pushes reams of paper, at 800 Hz: a long screw whose pitch
/// wobbles and that winds up. A glass scale lies beside it; the motor's torque is recorded.
fn back_gauge(draw: &mut Draw, presence: Presence) -> Rig {
    let (screw, gauge) = (draw.near(60.0), draw.near(75.0));
    let stiffness = draw.near(9.0e6);
    let [first, last] = [draw.near(35.0), draw.near(60.0)];
    let [fast, slow] = [draw.near(90.0), draw.near(110.0)];
    let wave = Wave {
        amplitude: presence.size_of(Effect::PitchError, draw.near(1.8e-5)),
        period: GAUGE_LEAD_M,
        phase: draw.between(0.0, TAU),
    };
    let soft =
        Train::one(screw, first, fast).then(Joint::stiff(stiffness, 4.0e3), gauge, last, slow);
    let bolted = Train::one(screw + gauge, first + last, fast + slow);
    let is_soft = presence.has(Effect::Compliance);
    let train = if is_soft { soft } else { bolted };
    let controller = Controller::cascade(screw + gauge, 4.0, 20.0, 1.25e-3);
    let mut rig = rig(Kind::Linear, train, controller, 5.0e-8);
    rig.sensing.load = Some(Encoder::of(5.0e-7, Rounding::Nearest).with(wave));
    rig.column = EffortColumn::Torque(GAUGE_LEAD_M / TAU);
    rig.stated.lead_m_per_rev = Some(GAUGE_LEAD_M);
    rig.noisy(0.6);
    rig.know("compliance_stiffness", stiffness, "N/m");
    rig.know("pitch_error_amplitude", wave.amplitude, "m");
    rig.know("pitch_error_period", wave.period, "m");
    rig.moved(
        draw,
        Room::about(0.28, (0.4, 4.0), 24.0),
        [Room::index, Room::errands],
        13.0,
    );
    rig
}

/// The carriage that leads the knife of a veneer lathe to its log, at 400 Hz under a controller in
/// velocity form: its motors saturate under two tonnes, and its dovetails rub with what moves them.
fn veneer_lathe(draw: &mut Draw, presence: Presence) -> Rig {
    let (mass, coulomb) = (draw.near(2100.0), draw.near(800.0));
    let droop = presence.size_of(Effect::TorqueSaturation, draw.near(3.0e-5));
    let share = presence.size_of(Effect::LoadDependentFriction, draw.near(0.2) / coulomb);
    let mut train = Train::one(mass, coulomb, draw.near(1400.0));
    train.surfaces[0].scales.push(Scale::Load(share));
    let loops = Pi::of(mass, 2.0, 11.0, Shape::VelocityForm(2.0e4));
    let mut rig = rig(Kind::Linear, train, Controller::pi(loops, 2.5e-3), 1.0e-7);
    rig.drive.droop = droop;
    rig.noisy(15.0);
    rig.know("torque_saturation", droop, "1/N");
    rig.know("load_dependent_friction", share * coulomb, "");
    rig.moved(
        draw,
        Room::about(0.5, (0.7, 2.2), 34.0),
        [Room::seek, Room::errands],
        18.0,
    );
    rig
}

/// Way from magnet to magnet of the guide bar's motor, m.
const GUIDE_BAR_PITCH_M: f64 = 0.012;

/// The bar that shogs the guides of a warp knitter from needle to needle, at 4 kHz under a lead
/// compensator: its linear motor saturates, and its magnets pull unevenly.
fn guide_bar(draw: &mut Draw, presence: Presence) -> Rig {
    let mass = draw.near(12.0);
    let droop = presence.size_of(Effect::TorqueSaturation, draw.near(3.0e-4));
    let amplitude = presence.size_of(Effect::TorqueRipple, draw.near(11.0));
    let mut train = Train::one(mass, draw.near(9.0), draw.near(35.0));
    let magnets = Field::Cogging {
        amplitude,
        waves: TAU / GUIDE_BAR_PITCH_M,
        phase: draw.between(0.0, TAU),
    };
    train.fields.push((0, magnets));
    let controller = Controller::lead(mass, 15.0, 2.5e-4);
    let mut rig = rig(Kind::Linear, train, controller, 1.0e-8);
    rig.drive.droop = droop;
    rig.noisy(1.2);
    rig.know("torque_saturation", droop, "1/N");
    rig.know("torque_ripple_amplitude", amplitude, "N");
    rig.know("torque_ripple_period", GUIDE_BAR_PITCH_M, "m");
    rig.moved(
        draw,
        Room::about(0.03, (0.6, 32.0), 12.0),
        [Room::index, Room::shifts],
        7.0,
    );
    rig
}

/// The piston of a machine that deposits chocolate, under an observer of the disturbance: it is
/// pressed through nozzles and drawn through a wide port, its lips are sheared before they slide,
/// and they warm.
fn chocolate_piston(draw: &mut Draw, presence: Presence) -> Rig {
    let (mass, coulomb, viscous) = (draw.near(26.0), draw.near(55.0), draw.near(380.0));
    let asymmetry = presence.size_of(Effect::ViscousAsymmetry, draw.near(0.4));
    let deflection = draw.near(8.0e-5);
    let surplus = presence.size_of(Effect::FrictionDrift, draw.near(0.8));
    let time_constant_s = draw.near(9.0);
    let mut train = Train::one(mass, coulomb, viscous);
    if presence.has(Effect::Presliding) {
        train.surfaces[0].law = Law::BoucWen {
            coulomb,
            stiffness: coulomb / deflection,
            exponent: 1.0,
        };
    }
    train.surfaces[0].scales.push(Scale::WarmUp {
        surplus,
        time_constant_s,
    });
    train.drags[0] = Drag {
        forward: viscous * (1.0 + asymmetry),
        backward: viscous * (1.0 - asymmetry),
        ..Drag::default()
    };
    let controller = Controller::rejecting(mass, 16.0, 1.0e-3);
    let mut rig = rig(Kind::Linear, train, controller, 1.0e-8);
    rig.noisy(0.8);
    rig.know("viscous_asymmetry", asymmetry * viscous, "N s/m");
    let shown = presence.size_of(Effect::Presliding, deflection);
    rig.know("presliding_deflection", shown, "m");
    rig.know("friction_drift_gain", surplus, "");
    rig.know("friction_drift_time_constant", time_constant_s, "s");
    rig.moved(
        draw,
        Room::about(0.06, (0.25, 4.0), 28.0),
        [Room::errands, Room::jogs],
        15.0,
    );
    rig
}
