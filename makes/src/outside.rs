//! Disturbances outside the list: none of these is ever explained.
//!
//! The first eight are those that earlier trials met. Five of them have a name by now; here they
//! come in another shape than the name's equation, so that the name and `unexplained` are both
//! right. The rest has no name at all.

pub mod held_back;
pub mod unexpected;
pub mod unforeseen;
pub mod unmet;
pub mod unseen;
pub mod unsought;
pub mod untried;

use std::f64::consts::TAU;

use crate::bench::{fast, plain, rotary, scaled};
use crate::draw::Draw;
use crate::drive::{ConstantRipple, Flaw};
use crate::entry::{Entry, truth};
use crate::mechanics::field::Field;
use crate::mechanics::friction::{Law, Scale, Surface};
use crate::mechanics::inertia::Inertia;
use crate::mechanics::joint::Joint;
use crate::rig::Rig;
use crate::sensing::Wave;
use crate::truth::{Effect, Verdict};

/// A disturbance.
#[derive(Clone, Copy, Debug)]
pub struct Outside {
    /// Its name.
    pub name: &'static str,
    /// The name of the list that is right as well.
    pub or_named: Option<Effect>,
    /// What is wrong, in words.
    pub cause: &'static str,
    good: fn(&mut Draw) -> Rig,
    disturb: fn(&mut Rig, &mut Draw),
}

const fn of(
    name: &'static str,
    cause: &'static str,
    good: fn(&mut Draw) -> Rig,
    disturb: fn(&mut Rig, &mut Draw),
) -> Outside {
    Outside {
        name,
        or_named: None,
        cause,
        good,
        disturb,
    }
}

impl Outside {
    const fn or(mut self, effect: Effect) -> Self {
        self.or_named = Some(effect);
        self
    }

    /// The rig of a seed.
    #[must_use]
    pub fn rig(&self, seed: u64) -> Rig {
        let mut draw = Draw::of(self.name, seed);
        let mut rig = (self.good)(&mut draw);
        (self.disturb)(&mut rig, &mut draw);
        rig
    }

    /// The same axis without the disturbance.
    #[must_use]
    pub fn good_rig(&self, seed: u64) -> Rig {
        (self.good)(&mut Draw::of(self.name, seed))
    }

    /// The record of a seed.
    #[must_use]
    pub fn entry(&self, seed: u64) -> Entry {
        let rig = self.rig(seed);
        let lacking: Vec<Effect> = self.or_named.into_iter().collect();
        let mut truth = truth(self.name, "outside", &rig, &rig.base, &lacking);
        truth.verdict = Verdict::Unexplained;
        truth.or_unexplained = true;
        truth.cause = self.cause.into();
        Entry::of(self.name, &rig, truth, seed)
    }
}

/// All of them.
#[rustfmt::skip]
pub const OUTSIDE: &[Outside] = &[
    of("parts-by-turns", "inertia changes four times", plain, parts_by_turns).or(Effect::Payload),
    of("loaded-gib", "friction grows with load, one way only", plain, loaded_gib).or(Effect::LoadDependentFriction),
    of("uneven-crank", "inertia over position, steep", rotary, uneven_crank).or(Effect::PositionDependentInertia),
    of("weak-magnets", "the torque constant varies over position", plain, weak_magnets).or(Effect::TorqueConstantRipple),
    of("late-log", "effort is logged three milliseconds late", fast, late_log).or(Effect::LoggedLate),
    of("early-log", "effort is logged two milliseconds early", fast, early_log).or(Effect::Delay),
    of("cubic-drag", "drag grows with the cube of velocity", plain, cubic_drag),
    of("spring", "a spring in the working range", plain, spring),
    of("end-stop", "a buffer is touched at one end", plain, end_stop),
    of("cable-chain", "friction goes with position times direction", plain, cable_chain),
    of("slipping-coupling", "a coupling slips at high load", scaled, slipping_coupling),
    of("wobbling-encoder", "the motor's encoder is eccentric", plain, wobbling_encoder),
    of("drifting-clocks", "clocks of effort and position part", fast, drifting_clocks),
    of("latch", "a magnet holds the axis in the middle", plain, latch),
    of("neighbour", "a force over time comes from elsewhere", plain, neighbour),
    of("dragging-brake", "friction is higher for some seconds", plain, dragging_brake),
    of("stronger-drive", "the drive gives more from a time on", plain, stronger_drive),
    of("dead-zone", "small commands deliver nothing", plain, dead_zone),
    of("lopsided-bridge", "effort is larger in one direction", plain, lopsided_bridge),
    of("tilted", "the axis is tilted from a time on", plain, tilted),
    of("swinging-load", "a load swings at a few hertz", plain, swinging_load),
];

fn parts_by_turns(rig: &mut Rig, _: &mut Draw) {
    let empty = rig.train.inertia();
    rig.train.inertias[0] = Inertia::Payload {
        empty,
        loaded: 1.4 * empty,
        at_s: vec![4.0, 9.0, 15.0, 21.0],
    };
}

/// The load presses on the gib in one direction of motion and lifts off in the other.
fn loaded_gib(rig: &mut Rig, _: &mut Draw) {
    let coulomb = rig.train.coulomb();
    let surface = Surface::new(0, Law::coulomb(coulomb));
    rig.train.surfaces[0] = surface.with(Scale::Load(0.006)).with(Scale::Direction(0.4));
}

fn uneven_crank(rig: &mut Rig, draw: &mut Draw) {
    rig.train.inertias[0] = Inertia::Harmonic {
        mean: rig.train.inertia(),
        share: 0.5,
        waves: 3.0,
        phase: draw.between(0.0, TAU),
    };
}

fn weak_magnets(rig: &mut Rig, draw: &mut Draw) {
    rig.drive.ripple = Some(ConstantRipple {
        share: 0.12,
        waves: TAU / 0.032,
        phase: draw.between(0.0, TAU),
    });
}

fn late_log(rig: &mut Rig, _: &mut Draw) {
    rig.sensing.effort.late_s = 3.0e-3;
}

fn early_log(rig: &mut Rig, _: &mut Draw) {
    rig.sensing.effort.late_s = -2.0e-3;
}

fn cubic_drag(rig: &mut Rig, draw: &mut Draw) {
    rig.train.drags[0].cubic = draw.near(3500.0);
}

/// Where it is slack is off the middle, as a hose's is.
fn spring(rig: &mut Rig, draw: &mut Draw) {
    let stiffness = draw.near(450.0);
    let slack = Field::Spring {
        stiffness,
        rest: 0.03,
    };
    rig.train.fields.push((0, slack));
}

fn end_stop(rig: &mut Rig, draw: &mut Draw) {
    let stop = Field::Stop {
        at: 0.09,
        stiffness: draw.near(3000.0),
    };
    rig.train.fields.push((0, stop));
}

fn cable_chain(rig: &mut Rig, draw: &mut Draw) {
    rig.train.surfaces[0]
        .scales
        .push(Scale::Chain(draw.near(4.0)));
}

/// The scale at the load sees it; the compliance is declared.
fn slipping_coupling(rig: &mut Rig, draw: &mut Draw) {
    rig.train.joints[0].slips_at = Some(draw.near(140.0));
}

/// Twenty micrometres over a turn of the screw, without a scale at the load to compare with.
fn wobbling_encoder(rig: &mut Rig, draw: &mut Draw) {
    rig.stated.lead_m_per_rev = Some(0.01);
    rig.sensing.motor = rig.sensing.motor.clone().with(Wave {
        amplitude: 2.0e-5,
        period: 0.01,
        phase: draw.between(0.0, TAU),
    });
}

/// Three parts in ten thousand: eight milliseconds at the end.
fn drifting_clocks(rig: &mut Rig, _: &mut Draw) {
    rig.sensing.effort.clock_share = 3.0e-4;
}

fn latch(rig: &mut Rig, draw: &mut Draw) {
    let magnet = Field::Latch {
        at: 0.02,
        width: 0.012,
        depth: draw.near(45.0),
    };
    rig.train.fields.push((0, magnet));
}

fn neighbour(rig: &mut Rig, draw: &mut Draw) {
    let hum = Field::Hum {
        amplitude: draw.near(18.0),
        frequency_hz: 3.7,
    };
    rig.train.fields.push((0, hum));
}

fn dragging_brake(rig: &mut Rig, draw: &mut Draw) {
    let drag = Scale::During(draw.near(0.8), 6.0, 15.0);
    rig.train.surfaces[0].scales.push(drag);
}

fn stronger_drive(rig: &mut Rig, draw: &mut Draw) {
    rig.drive.flaw = Some(Flaw::Stronger(draw.near(0.25), 13.0));
}

fn dead_zone(rig: &mut Rig, draw: &mut Draw) {
    rig.drive.flaw = Some(Flaw::DeadZone(draw.near(25.0)));
}

fn lopsided_bridge(rig: &mut Rig, draw: &mut Draw) {
    rig.drive.flaw = Some(Flaw::Lopsided(draw.near(0.15)));
}

fn tilted(rig: &mut Rig, draw: &mut Draw) {
    let weight = Field::Step {
        force: -draw.near(40.0),
        at_s: 9.0,
    };
    rig.train.fields.push((0, weight));
}

/// A crane's load, a whip of a robot: soft joint, no scale, below the filter's corner.
fn swinging_load(rig: &mut Rig, _: &mut Draw) {
    let swinging = 0.3 * rig.train.inertia();
    // 2.5 Hz
    let stiffness = swinging * (TAU * 2.5) * (TAU * 2.5);
    rig.train = rig.train.clone().then(
        Joint::stiff(stiffness, 0.03 * stiffness / 15.7),
        swinging,
        0.0,
        0.0,
    );
}
