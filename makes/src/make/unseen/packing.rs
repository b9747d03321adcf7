//! Bottles and labels: steps of one pitch, all day.

use std::f64::consts::TAU;

use crate::control::Controller;
use crate::control::pi::{Pi, Shape};
use crate::draw::Draw;
use crate::drive::ConstantRipple;
use crate::make::{Make, Presence, rig};
use crate::mechanics::field::Drag;
use crate::mechanics::friction::{Law, Scale};
use crate::mechanics::joint::Joint;
use crate::mechanics::train::Train;
use crate::motion::{Motion, Programme, Room};
use crate::rig::{EffortColumn, Kind, Rig};
use crate::sensing::Noise;
use crate::truth::Effect;

/// The family.
pub const MAKES: &[Make] = &[
    Make {
        name: "bottle-star-wheel",
        hides: &[Effect::Backlash],
        build: bottle_star_wheel,
    },
    Make {
        name: "label-roller",
        hides: &[Effect::Presliding, Effect::ViscousAsymmetry],
        build: label_roller,
    },
    Make {
        name: "capping-chuck",
        hides: &[Effect::TorqueConstantRipple, Effect::CoulombAsymmetry],
        build: capping_chuck,
    },
];

/// The star wheel of a bottling line behind a bevel gear with play, and the only encoder is the
/// motor's: the wheel, which is most of the inertia, runs ahead whenever it is braked.
fn bottle_star_wheel(draw: &mut Draw, presence: Presence) -> Rig {
    let (motor, wheel) = (draw.near(0.02), draw.near(0.05));
    let joint = Joint {
        gap: presence.size_of(Effect::Backlash, draw.near(8.0e-3)),
        ..Joint::stiff(draw.near(2.0e4), 6.0)
    };
    let train = Train::one(motor, draw.near(0.25), draw.near(0.02)).then(
        joint,
        wheel,
        draw.near(0.5),
        draw.near(0.03),
    );
    let loops = Pi::of(motor + wheel, 3.0, 16.0, Shape::VelocityForm(20.0));
    let controller = Controller::pi(loops, 1.0e-3);
    let mut rig = rig(Kind::Rotary, train, controller, TAU / 8_388_608.0);
    rig.noisy(0.02);
    rig.know("backlash_gap", joint.gap, "rad");
    rig.moved(
        draw,
        Room::about(3.0, (6.0, 45.0), 28.0),
        [Room::index, Room::jogs],
        14.0,
    );
    rig
}

/// The roller of a labeller on the test bench, without a loop, under sines of torque: its web of
/// paper clings to it by Dahl's law over some milliradians, and its scraper drags more one way.
fn label_roller(draw: &mut Draw, presence: Presence) -> Rig {
    let (inertia, coulomb, viscous) = (draw.near(9.0e-5), draw.near(0.012), draw.near(8.0e-4));
    let deflection = draw.near(8.0e-3);
    let asymmetry = presence.size_of(Effect::ViscousAsymmetry, draw.near(0.4));
    let mut train = Train::one(inertia, coulomb, viscous);
    let web = Law::Dahl {
        coulomb,
        stiffness: coulomb / deflection,
    };
    if presence.has(Effect::Presliding) {
        train.surfaces[0].law = web;
    }
    train.drags[0] = Drag {
        forward: viscous * (1.0 + asymmetry),
        backward: viscous * (1.0 - asymmetry),
        ..Drag::default()
    };
    let mut rig = rig(
        Kind::Rotary,
        train,
        Controller::open(1.0e-3),
        TAU / 1_048_576.0,
    );
    rig.sensing.reference = false;
    rig.noisy(2.0e-4);
    let shown = presence.size_of(Effect::Presliding, deflection);
    rig.know("presliding_deflection", shown, "rad");
    rig.know("viscous_asymmetry", asymmetry * viscous, "N m s/rad");
    let sines = |lowest_hz, lines| Motion::Effort(Programme::Multisine(0.024, lowest_hz, lines));
    rig.training = (sines(0.31, 24), 26.0);
    rig.validation = (sines(0.43, 14), 13.0);
    rig
}

/// A chuck that screws caps on: its magnets are uneven four times a turn, and its clutch plates
/// drag more the way in which they are wound. No constant torque is declared; one row in a hundred
/// is lost on the line's network, and mains are in the current.
fn capping_chuck(draw: &mut Draw, presence: Presence) -> Rig {
    let (inertia, coulomb) = (draw.near(2.5e-3), draw.near(0.12));
    let asymmetry = presence.size_of(Effect::CoulombAsymmetry, draw.near(0.3));
    let wave = ConstantRipple {
        share: presence.size_of(Effect::TorqueConstantRipple, draw.near(0.1)),
        waves: 4.0,
        phase: draw.between(0.0, TAU),
    };
    let mut train = Train::one(inertia, coulomb, draw.near(4.0e-3));
    train.surfaces[0].scales.push(Scale::Direction(-asymmetry));
    let shape = Shape::Scheduled {
        extra: 0.5,
        knee: 3.0,
    };
    let loops = Pi::of(inertia, 5.0, 26.0, shape);
    let mut rig = rig(
        Kind::Rotary,
        train,
        Controller::pi(loops, 1.0e-3),
        TAU / 4_194_304.0,
    );
    rig.column = EffortColumn::Current(1.0 / 0.11);
    rig.drive.ripple = Some(wave);
    rig.base.retain(|effect| *effect != Effect::Offset);
    rig.sensing.stamps.lost_share = 0.01;
    rig.sensing.effort.noise = Noise {
        white: 2.0e-3,
        pink: 0.0,
        mains: 3.0e-3,
    };
    let asymmetry_a = asymmetry * coulomb / 0.11;
    rig.know("torque_constant_ripple", wave.share, "");
    rig.know("torque_constant_ripple_order", 4.0, "1/rev");
    rig.know("coulomb_asymmetry", -asymmetry_a, "A");
    rig.moved(
        draw,
        Room::about(8.0, (18.0, 130.0), 28.0),
        [Room::points, Room::index],
        14.0,
    );
    rig
}
