//! Joints and mounts: rotary axes of robots, telescopes and boats.
//!
//! A strain-wave gear winds up and errs twice per turn of its wave generator (Tuttle and Seering
//! 1996); a cable in a sheath rubs by what presses it into its bends, T = T₀·exp(μφ) (Euler's
//! capstan).

use std::f64::consts::TAU;

use crate::control::Controller;
use crate::control::pi::{Pi, Shape};
use crate::draw::Draw;
use crate::make::{Make, Presence, rig};
use crate::mechanics::field::Field;
use crate::mechanics::friction::Scale;
use crate::mechanics::inertia::Inertia;
use crate::mechanics::joint::{Joint, Stiffness};
use crate::mechanics::train::Train;
use crate::motion::Room;
use crate::rig::{Kind, Rig};
use crate::sensing::{Encoder, Rounding, Wave};
use crate::truth::Effect;

/// The family.
pub const MAKES: &[Make] = &[
    Make {
        name: "strain-wave-joint",
        hides: &[Effect::Compliance, Effect::PitchError],
        build: strain_wave_joint,
    },
    Make {
        name: "eccentric-turret",
        hides: &[Effect::TorqueRipple],
        build: eccentric_turret,
    },
    Make {
        name: "telescope-mount",
        hides: &[Effect::Backlash],
        build: telescope_mount,
    },
    Make {
        name: "five-bar-crank",
        hides: &[Effect::PositionDependentInertia],
        build: five_bar_crank,
    },
    Make {
        name: "bowden-elbow",
        hides: &[Effect::PositionDependentFriction],
        build: bowden_elbow,
    },
    Make {
        name: "rudder-fin",
        hides: &[Effect::QuadraticDrag, Effect::LoggedLate],
        build: rudder_fin,
    },
];

/// Teeth that a wave generator passes per turn of the joint.
const GEAR_RATIO: f64 = 100.0;

/// A robot's shoulder on a strain-wave gear, with an encoder on either side. The gear stiffens by
/// some percent at its usual torque, which one stiffness cannot say; what that leaves is less than
/// a count of the joint's encoder. Its error of transmission has two waves per turn of the motor,
/// two hundred per turn of the joint.
fn strain_wave_joint(draw: &mut Draw, presence: Presence) -> Rig {
    let (motor, arm) = (draw.near(1.2), draw.near(2.0));
    let stiffness = draw.near(5.0e4);
    let [first, last, viscous] = [draw.near(9.0), draw.near(4.0), draw.near(9.0)];
    let gear = Joint {
        stiffness: Stiffness::Hardening {
            stiffness,
            knee: 1.5e-3,
        },
        ..Joint::stiff(stiffness, 40.0)
    };
    let soft = Train::one(motor, first, viscous).then(gear, arm, last, 0.2 * viscous);
    let bolted = Train::one(motor + arm, first + last, 1.2 * viscous);
    let controller = Controller::cascade(motor + arm, 2.0, 11.0, 1.0e-3);
    let counts = 65_536.0 * GEAR_RATIO;
    let mut rig = rig(
        Kind::Rotary,
        presence.or(soft, bolted),
        controller,
        TAU / counts,
    );
    let wave = Wave {
        amplitude: presence.size(draw.near(3.0e-4)),
        period: TAU / (2.0 * GEAR_RATIO),
        phase: draw.between(0.0, TAU),
    };
    rig.sensing.load = Some(Encoder::of(TAU / 131_072.0, Rounding::Nearest).with(wave));
    rig.noisy(0.3);
    rig.know("compliance_stiffness", stiffness, "N m/rad");
    rig.know("pitch_error_amplitude", wave.amplitude, "rad");
    rig.know("pitch_error_period", wave.period, "rad");
    rig.moved(
        draw,
        Room::about(1.3, (1.2, 8.0), 24.0),
        [Room::points, Room::waves],
        12.0,
    );
    rig
}

/// A turret that turns in a vertical plane with one heavy tool: m·g·r·sin x, once per turn, on an
/// axis that is balanced otherwise. At 400 Hz and over two turns.
fn eccentric_turret(draw: &mut Draw, presence: Presence) -> Rig {
    let inertia = draw.near(0.8);
    let moment = presence.size(draw.near(5.0));
    let mut train = Train::one(inertia, draw.near(3.0), draw.near(1.2));
    let weight = Field::Cogging {
        amplitude: moment,
        waves: 1.0,
        phase: draw.between(0.0, TAU),
    };
    train.fields.push((0, weight));
    let controller = Controller::pid(inertia, 8.0, 2.5e-3);
    let mut rig = rig(Kind::Rotary, train, controller, TAU / 4_194_304.0);
    rig.noisy(0.06);
    rig.know("torque_ripple_amplitude", moment, "N m");
    rig.know("torque_ripple_order", 1.0, "1/rev");
    rig.moved(
        draw,
        Room::about(7.0, (4.0, 12.0), 50.0),
        [Room::workshop, Room::points],
        25.0,
    );
    rig
}

/// The right ascension of a telescope: a worm wheel with play of a minute of arc or so, encoders
/// on worm and tube, the wind-up declared. The tube's bearings hold it while the worm crosses.
fn telescope_mount(draw: &mut Draw, presence: Presence) -> Rig {
    let (worm, tube) = (draw.near(40.0), draw.near(60.0));
    let gap = presence.size(draw.near(3.0e-4));
    let stiffness = draw.near(1.0e7);
    let gear = Joint {
        gap,
        ..Joint::stiff(stiffness, 6000.0)
    };
    let train = Train::one(worm, draw.near(12.0), draw.near(20.0)).then(
        gear,
        tube,
        draw.near(28.0),
        draw.near(15.0),
    );
    let controller = Controller::cascade(worm + tube, 2.0, 12.0, 1.0e-3);
    let mut rig = rig(Kind::Rotary, train, controller, TAU / 67_108_864.0);
    rig.sensing.load = Some(Encoder::of(TAU / 16_777_216.0, Rounding::Nearest));
    rig.declare(Effect::Compliance);
    rig.noisy(0.4);
    rig.know("backlash_gap", gap, "rad");
    rig.know("compliance_stiffness", stiffness, "N m/rad");
    rig.moved(
        draw,
        Room::about(1.0, (0.6, 1.0), 30.0),
        [Room::jogs, Room::points],
        15.0,
    );
    rig
}

/// A crank of a planar five-bar robot at 2 kHz: what it feels of rods and gripper goes with the
/// fold of the rods, J(x) = J₀·(1 + s·cos(2x + φ)), of which the working range shows less than two
/// thirds of a wave. No weight acts in the plane.
fn five_bar_crank(draw: &mut Draw, presence: Presence) -> Rig {
    let inertia = draw.near(0.06);
    let share = presence.size(draw.near(0.35));
    let mut train = Train::one(inertia, draw.near(0.5), draw.near(0.08));
    train.inertias[0] = Inertia::Harmonic {
        mean: inertia,
        share,
        waves: 2.0,
        phase: draw.between(0.3, 1.0),
    };
    let controller = Controller::state_feedback(inertia, 14.0, 5.0e-4);
    let mut rig = rig(Kind::Rotary, train, controller, TAU / 8_388_608.0);
    rig.noisy(0.03);
    rig.know("position_dependent_inertia", share * inertia, "kg m2");
    rig.moved(
        draw,
        Room::about(1.0, (8.0, 120.0), 16.0),
        [Room::points, Room::jogs],
        8.0,
    );
    rig
}

/// The elbow of an exoskeleton behind a Bowden cable: the sheath bends with the elbow, and friction
/// grows with the angle, here as the square (1 + kx)² that stands for the capstan's exponential.
/// Rows come with jitter of 60 µs, and their stamps say when.
fn bowden_elbow(draw: &mut Draw, presence: Presence) -> Rig {
    let inertia = draw.near(0.05);
    let slope = presence.size(draw.near(0.33));
    let mut train = Train::one(inertia, draw.near(0.7), draw.near(0.12));
    train.surfaces[0]
        .scales
        .extend([Scale::Slope(slope), Scale::Slope(slope)]);
    let controller = Controller::pid(inertia, 9.0, 1.0e-3);
    let mut rig = rig(Kind::Rotary, train, controller, TAU / 4_194_304.0);
    rig.logs_current(1);
    rig.sensing.stamps.jitter_s = 6.0e-5;
    rig.noisy(0.01);
    rig.know("position_dependent_friction_linear", 2.0 * slope, "1/rad");
    rig.moved(
        draw,
        Room::about(1.2, (3.0, 20.0), 26.0),
        [Room::waves, Room::workshop],
        13.0,
    );
    rig
}

/// The fin of a diving robot: water drags with velocity squared, and the current comes up the
/// tether some milliseconds after it flowed, at 250 Hz. The controller works by increments.
fn rudder_fin(draw: &mut Draw, presence: Presence) -> Rig {
    let inertia = draw.near(0.02);
    let quadratic = presence.size(draw.near(0.06));
    let late_s = presence.size(draw.near(5.0e-3));
    let mut train = Train::one(inertia, draw.near(0.25), draw.near(0.05));
    train.drags[0].quadratic = quadratic;
    let loops = Pi::of(inertia, 3.0, 18.0, Shape::VelocityForm(6.0));
    let controller = Controller::pi(loops, 1.0e-3);
    let mut rig = rig(Kind::Rotary, train, controller, TAU / 8_388_608.0);
    rig.logs_current(4);
    rig.sensing.effort.late_s = late_s;
    rig.noisy(6.0e-3);
    rig.know("quadratic_drag", quadratic, "N m s2/rad2");
    rig.know("logged_late", late_s, "s");
    rig.moved(
        draw,
        Room::about(1.2, (4.0, 40.0), 60.0),
        [Room::points, Room::workshop],
        25.0,
    );
    rig
}
