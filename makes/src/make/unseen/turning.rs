//! Large things that turn slowly: a segment erector, a revolving stage, a welding positioner.
//!
//! What sits off the axis pulls with m·g·r·sin x, once per turn. A worm rubs with what it carries
//! (Niemann and Winter, Maschinenelemente III, 1986).

use std::f64::consts::TAU;

use crate::control::Controller;
use crate::control::pi::{Pi, Shape};
use crate::draw::Draw;
use crate::make::{Make, Presence, rig};
use crate::mechanics::field::Field;
use crate::mechanics::friction::{Law, Scale, Stribeck, Surface};
use crate::mechanics::train::Train;
use crate::motion::Room;
use crate::rig::{EffortColumn, Kind, Rig};
use crate::truth::Effect;

/// The family.
pub const MAKES: &[Make] = &[
    Make {
        name: "segment-erector",
        hides: &[Effect::TorqueRipple, Effect::Stribeck, Effect::LoggedLate],
        build: segment_erector,
    },
    Make {
        name: "revolving-stage",
        hides: &[Effect::PositionDependentFriction, Effect::TorqueSaturation],
        build: revolving_stage,
    },
    Make {
        name: "welding-positioner",
        hides: &[
            Effect::LoadDependentFriction,
            Effect::Delay,
            Effect::PositionDependentFriction,
        ],
        build: welding_positioner,
    },
];

/// The erector of a tunnel-boring machine, which turns segments of the lining into their place: a
/// gripper of tonnes pulls once per turn, of which the travel is one; seals grip at creeping speed;
/// the PLC's trace at 250 Hz shows the torque some cycles late.
fn segment_erector(draw: &mut Draw, presence: Presence) -> Rig {
    let (inertia, coulomb) = (draw.near(2.2e4), draw.near(3200.0));
    let moment = presence.size_of(Effect::TorqueRipple, draw.near(5000.0));
    let excess = presence.size_of(Effect::Stribeck, draw.near(1.0));
    let late_s = presence.size_of(Effect::LoggedLate, draw.near(0.016));
    let mut train = Train::one(inertia, coulomb, draw.near(3000.0));
    train.surfaces[0].law = Law::Rigid {
        coulomb,
        stribeck: Some(Stribeck {
            excess,
            velocity: draw.near(0.025),
            exponent: 1.0,
        }),
    };
    let gripper = Field::Cogging {
        amplitude: moment,
        waves: 1.0,
        phase: draw.between(0.0, TAU),
    };
    train.fields.push((0, gripper));
    let controller = Controller::pid(inertia, 3.0, 1.0e-3);
    let mut rig = rig(Kind::Rotary, train, controller, TAU / 67_108_864.0);
    rig.logs_current(4);
    rig.sensing.effort.late_s = late_s;
    rig.noisy(60.0);
    rig.know("torque_ripple_amplitude", moment, "N m");
    rig.know("torque_ripple_order", 1.0, "1/rev");
    rig.know("stribeck_excess", excess * coulomb, "N m");
    rig.know("logged_late", late_s, "s");
    rig.moved(
        draw,
        Room::about(3.1, (0.7, 0.7), 80.0),
        [Room::tracking, Room::workshop],
        40.0,
    );
    rig
}

/// A theatre's revolving stage on friction wheels, at 500 Hz with a gain that is scheduled: one
/// joint of its rail is dirty, and the motors saturate when all of them start it. Their current is
/// recorded.
fn revolving_stage(draw: &mut Draw, presence: Presence) -> Rig {
    let inertia = draw.near(9.0e4);
    let droop = presence.size_of(Effect::TorqueSaturation, draw.near(1.2e-5));
    let dirt = Scale::Bump {
        centre: draw.between(-0.4, 0.4),
        width: draw.near(0.35),
        share: presence.size_of(Effect::PositionDependentFriction, draw.near(1.0)),
    };
    let mut train = Train::one(inertia, draw.near(2500.0), draw.near(2200.0));
    train.surfaces[0].scales.push(dirt);
    let shape = Shape::Scheduled {
        extra: 0.6,
        knee: 0.1,
    };
    let loops = Pi::of(inertia, 1.5, 8.0, shape);
    let controller = Controller::pi(loops, 2.0e-3);
    let mut rig = rig(Kind::Rotary, train, controller, TAU / 33_554_432.0);
    rig.drive.droop = droop;
    rig.column = EffortColumn::Current(1.0 / 60.0);
    rig.noisy(60.0);
    rig.know("torque_saturation", droop * 60.0, "1/A");
    rig.moved(
        draw,
        Room::about(1.2, (0.4, 0.25), 60.0),
        [Room::weaving, Room::points],
        30.0,
    );
    rig
}

/// Friction of the earth cable's brush over that of the worm.
const BRUSH_SHARE: f64 = 0.8;

/// A positioner that turns a frame under a welding robot, on a worm: its flanks rub with what they
/// carry, a fieldbus takes most of a millisecond, and the earth cable's brush rubs more toward one
/// end. The drive's velocity is recorded beside the rest.
fn welding_positioner(draw: &mut Draw, presence: Presence) -> Rig {
    let (inertia, coulomb) = (draw.near(9.0), draw.near(9.0));
    let share = presence.size_of(Effect::LoadDependentFriction, draw.near(0.18) / coulomb);
    let slope = presence.size_of(Effect::PositionDependentFriction, draw.near(0.4));
    let delay_s = presence.size_of(Effect::Delay, 8.5e-4);
    let mut train = Train::one(inertia, 0.0, draw.near(6.0));
    train.surfaces[0].law = Law::coulomb(coulomb);
    train.surfaces[0].scales.push(Scale::Load(share));
    let brush = Surface::new(0, Law::coulomb(BRUSH_SHARE * coulomb));
    train
        .surfaces
        .push(brush.with(Scale::Slope(slope / BRUSH_SHARE)));
    let controller = Controller::state_feedback(inertia, 6.0, 1.0e-3);
    let mut rig = rig(Kind::Rotary, train, controller, TAU / 8_388_608.0);
    rig.drive.dead_time_s = delay_s;
    rig.sensing.velocity = Some(1.0e-5);
    rig.noisy(0.5);
    rig.know("load_dependent_friction", share * coulomb, "");
    rig.know("delay", delay_s, "s");
    let of_all = slope / (1.0 + BRUSH_SHARE);
    rig.know("position_dependent_friction_linear", of_all, "1/rad");
    rig.moved(
        draw,
        Room::about(1.6, (2.4, 18.0), 26.0),
        [Room::jogs, Room::weaving],
        13.0,
    );
    rig
}
