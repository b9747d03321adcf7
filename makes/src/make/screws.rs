//! Screw axes: a servo motor turns a screw, a nut carries a table.
//!
//! Positions are counted at the table. The screw's wind-up is F/K (Altintas et al., CIRP Annals
//! 60, 2011), its friction falls with speed as the nut's film builds up.

use std::f64::consts::TAU;

use crate::control::{Controller, Sensor};
use crate::draw::Draw;
use crate::drive::CurrentLoop;
use crate::make::{Make, Presence, rig};
use crate::mechanics::friction::{Law, Scale, Stribeck, Surface};
use crate::mechanics::joint::Joint;
use crate::mechanics::train::Train;
use crate::motion::Room;
use crate::rig::{EffortColumn, Kind, Rig};
use crate::sensing::{Encoder, Rounding, Wave};
use crate::truth::Effect;

/// The family.
pub const MAKES: &[Make] = &[
    Make {
        name: "tustin-screw",
        hides: &[Effect::Stribeck],
        build: tustin_screw,
    },
    Make {
        name: "seal-screw",
        hides: &[Effect::Stribeck],
        build: seal_screw,
    },
    Make {
        name: "warm-screw",
        hides: &[Effect::FrictionDrift],
        build: warm_screw,
    },
    Make {
        name: "worn-way",
        hides: &[Effect::PositionDependentFriction],
        build: worn_way,
    },
    Make {
        name: "scaled-screw",
        hides: &[Effect::PitchError],
        build: scaled_screw,
    },
    Make {
        name: "three-body-screw",
        hides: &[Effect::Compliance],
        build: three_body_screw,
    },
    Make {
        name: "gapped-screw",
        hides: &[Effect::Backlash],
        build: gapped_screw,
    },
    Make {
        name: "trapezoidal-nut",
        hides: &[Effect::LoadDependentFriction],
        build: trapezoidal_nut,
    },
];

fn room(half_m: f64, duration_s: f64) -> Room {
    Room::about(half_m, (0.25, 2.5), duration_s)
}

fn falling(excess: f64, velocity: f64, exponent: f64, coulomb: f64) -> Law {
    let stribeck = Stribeck {
        excess,
        velocity,
        exponent,
    };
    Law::Rigid {
        coulomb,
        stribeck: Some(stribeck),
    }
}

/// A small milling axis under a PID loop without cascade. Its friction falls by Tustin's
/// exponential, exponent one: the tail reaches far into the feeds, where Gauss's has long ended.
fn tustin_screw(draw: &mut Draw, presence: Presence) -> Rig {
    let (mass, coulomb) = (draw.near(60.0), draw.near(45.0));
    let excess = presence.size(draw.near(0.5));
    let mut train = Train::one(mass, coulomb, draw.near(180.0));
    train.surfaces[0].law = falling(excess, draw.near(0.015), 1.0, coulomb);
    let mut rig = rig(
        Kind::Linear,
        train,
        Controller::pid(mass, 16.0, 1.0e-3),
        1.0e-7,
    );
    rig.noisy(1.0);
    rig.know("stribeck_excess", excess * coulomb, "N");
    rig.moved(
        draw,
        room(0.12, 26.0),
        [Room::workshop, Room::circles],
        12.0,
    );
    rig
}

/// A table under lip seals: Bo and Pavelescu's exponent of a half, steep at first and long after
/// (Wear 82, 1982). Motor torque is recorded, at 500 Hz, on an axis counted in metres.
fn seal_screw(draw: &mut Draw, presence: Presence) -> Rig {
    let (mass, coulomb) = (draw.near(150.0), draw.near(90.0));
    let excess = presence.size(draw.near(0.9));
    let mut train = Train::one(mass, coulomb, draw.near(400.0));
    train.surfaces[0].law = falling(excess, draw.near(0.01), 0.5, coulomb);
    let controller = Controller::cascade(mass, 4.0, 22.0, 2.0e-3);
    let mut rig = rig(Kind::Linear, train, controller, 1.0e-7);
    rig.column = EffortColumn::Torque(0.016 / TAU);
    rig.stated.lead_m_per_rev = Some(0.016);
    rig.noisy(2.0);
    rig.know("stribeck_excess", excess * coulomb * 0.016 / TAU, "N m");
    rig.moved(draw, room(0.15, 45.0), [Room::jogs, Room::points], 20.0);
    rig
}

/// A heavy grease-packed axis that warms up within the record, at 500 Hz and with a controller
/// that the file states.
fn warm_screw(draw: &mut Draw, presence: Presence) -> Rig {
    let (mass, coulomb) = (draw.near(320.0), draw.near(210.0));
    let surplus = presence.size(draw.near(0.45));
    let time_constant_s = draw.near(11.0);
    let mut train = Train::one(mass, coulomb, draw.near(900.0));
    train.surfaces[0].scales.push(Scale::WarmUp {
        surplus,
        time_constant_s,
    });
    let controller = Controller::cascade(mass, 4.0, 24.0, 2.0e-3);
    let mut rig = rig(Kind::Linear, train, controller, 2.0e-7);
    rig.stated.controller = true;
    rig.noisy(3.0);
    rig.know("friction_drift_gain", surplus, "");
    rig.know("friction_drift_time_constant", time_constant_s, "s");
    rig.moved(draw, room(0.2, 50.0), [Room::points, Room::workshop], 25.0);
    rig
}

/// An old lathe's slideway, worn in front of the chuck: a bump of friction over 60 mm, neither a
/// line nor a parabola.
fn worn_way(draw: &mut Draw, presence: Presence) -> Rig {
    let (mass, coulomb) = (draw.near(240.0), draw.near(160.0));
    let bump = Scale::Bump {
        centre: draw.between(-0.02, 0.02),
        width: draw.near(0.09),
        share: presence.size(draw.near(0.6)),
    };
    let mut train = Train::one(mass, coulomb, draw.near(700.0));
    train.surfaces[0].scales.push(bump);
    let controller = Controller::cascade(mass, 5.0, 28.0, 1.0e-3);
    let mut rig = rig(Kind::Linear, train, controller, 5.0e-7);
    rig.noisy(2.5);
    rig.moved(draw, room(0.18, 28.0), [Room::waves, Room::points], 14.0);
    rig
}

/// A screw with a glass scale: the nut's pitch wobbles by some micrometres over a turn, and the
/// wind-up is declared. The loop is closed on the motor.
fn scaled_screw(draw: &mut Draw, presence: Presence) -> Rig {
    let (motor, table) = (draw.near(140.0), draw.near(110.0));
    let stiffness = draw.near(9.0e7);
    let wave = Wave {
        amplitude: presence.size(draw.near(4.0e-6)),
        period: 0.01,
        phase: draw.between(0.0, TAU),
    };
    let train = Train::one(motor, draw.near(30.0), 150.0).then(
        Joint::stiff(stiffness, 3.0e4),
        table,
        draw.near(70.0),
        draw.near(200.0),
    );
    let controller = Controller::cascade(motor + table, 5.0, 30.0, 1.0e-3);
    let mut rig = rig(Kind::Linear, train, controller, 1.0e-7);
    rig.sensing.load = Some(Encoder::of(1.0e-7, Rounding::Nearest).with(wave));
    rig.stated.lead_m_per_rev = Some(0.01);
    rig.declare(Effect::Compliance);
    rig.noisy(1.5);
    rig.know("compliance_stiffness", stiffness, "N/m");
    rig.know("pitch_error_amplitude", wave.amplitude, "m");
    rig.know("pitch_error_period", wave.period, "m");
    rig.moved(
        draw,
        room(0.12, 24.0),
        [Room::workshop, Room::circles],
        12.0,
    );
    rig
}

/// Motor, screw and table: two joints in a row, whose compliances add. Without the effect the
/// table is bolted to the motor.
fn three_body_screw(draw: &mut Draw, presence: Presence) -> Rig {
    let [motor, screw, table] = [draw.near(70.0), draw.near(25.0), draw.near(80.0)];
    let [coupling, nut] = [draw.near(6.0e7), draw.near(4.0e7)];
    let [first, last, viscous] = [draw.near(15.0), draw.near(60.0), draw.near(90.0)];
    let long = Train::one(motor, first, viscous)
        .then(Joint::stiff(coupling, 1.5e4), screw, 5.0, viscous)
        .then(Joint::stiff(nut, 1.5e4), table, last, viscous);
    let short = Train::one(motor + screw + table, first + 5.0 + last, 3.0 * viscous);
    let controller = Controller::cascade(motor + screw + table, 5.0, 30.0, 1.0e-3);
    let mut rig = rig(Kind::Linear, presence.or(long, short), controller, 5.0e-8);
    rig.sensing.load = Some(Encoder::of(5.0e-8, Rounding::Nearest));
    rig.noisy(1.0);
    rig.know(
        "compliance_stiffness",
        coupling * nut / (coupling + nut),
        "N/m",
    );
    rig.moved(draw, room(0.1, 24.0), [Room::points, Room::waves], 12.0);
    rig
}

/// A retrofitted machine: single nut with a gap behind a soft screw, closed on its glass scale, so
/// that the gap is inside the loop. The compliance is declared.
fn gapped_screw(draw: &mut Draw, presence: Presence) -> Rig {
    let (motor, table) = (draw.near(180.0), draw.near(160.0));
    let gap = presence.size(draw.near(14.0e-6));
    let stiffness = draw.near(8.0e7);
    let joint = Joint {
        gap,
        ..Joint::stiff(stiffness, 4.0e4)
    };
    let train = Train::one(motor, draw.near(40.0), 300.0).then(
        joint,
        table,
        draw.near(120.0),
        draw.near(300.0),
    );
    let mut controller = Controller::cascade(motor + table, 3.0, 22.0, 1.0e-3);
    controller.sensor = Sensor::Load;
    let mut rig = rig(Kind::Linear, train, controller, 1.0e-7);
    rig.sensing.load = Some(Encoder::of(2.0e-7, Rounding::Nearest));
    rig.declare(Effect::Compliance);
    rig.noisy(2.0);
    rig.know("backlash_gap", gap, "m");
    rig.know("compliance_stiffness", stiffness, "N/m");
    rig.moved(draw, room(0.12, 28.0), [Room::workshop, Room::points], 14.0);
    rig
}

/// A press with a trapezoidal thread: friction of the flanks grows with the force that they carry
/// (Olofsson and Ekerfors, Wear 155, 1992). The drive's current is recorded, in amperes, behind a
/// current loop of second order.
fn trapezoidal_nut(draw: &mut Draw, presence: Presence) -> Rig {
    let (mass, coulomb) = (draw.near(90.0), draw.near(40.0));
    let share = presence.size(draw.near(0.15) / coulomb);
    let mut train = Train::one(mass, 0.0, draw.near(120.0));
    train.surfaces[0] = Surface::new(0, Law::coulomb(coulomb)).with(Scale::Load(share));
    let controller = Controller::cascade(mass, 6.0, 35.0, 1.25e-4);
    let mut rig = rig(Kind::Linear, train, controller, 2.0e-7);
    rig.drive.current_loop = CurrentLoop::Second(600.0, 0.7);
    rig.column = EffortColumn::Current(1.0 / 85.0);
    rig.logs_current(8);
    rig.noisy(1.0);
    rig.know("load_dependent_friction", share * coulomb, "");
    // While friction is more than inertia the drive never turns over, and friction that grows
    // with load is then the same force as more of everything: this axis is brisk.
    let brisk = Room::about(0.15, (0.25, 5.0), 26.0);
    rig.moved(draw, brisk, [Room::jogs, Room::workshop], 12.0);
    rig
}
