//! Machines that nobody chose, drawn by a number, and what is left on them after they were
//! commissioned.
//!
//! A machine is the reference machine with its masses, screw, friction, Stribeck fall, presliding
//! and current lag each drawn between half and one and a half times; every third has Maxwell slip
//! of 4 to 12 uneven elements for its bristle, and a Stribeck fall that lags. Its loop gains are in
//! proportion to its own inertia. Machines from [`WITH_MORE`] on have more at once: friction that
//! differs by direction, a ripple of 30 N, a part of the friction on the motor's side with a
//! presliding of its own, and every third of them a gap of 3 to 8 µm inside the loop. Of these one
//! whose loops oscillate without any compensation, also while it creeps, is drawn again. From
//! [`UNLIKE_SIDES`] on the motor's friction has a rise at rest and a velocity over which that falls
//! of its own, and on every second machine the other structure.

use std::ops::RangeInclusive;

use axis_model::TorqueRipple;
use plant_sim::friction::{Law, Sliding};
use plant_sim::machine::MachineAxis;
use plant_sim::{Machine, MotorSide};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, Uniform};
use workbench::circle_test;
use workbench::commissioning::feeds::less_percent;
use workbench::commissioning::fitness::{self, Oscillation};
use workbench::commissioning::identified_axes;
use workbench::compensation::AxisCompensation;
use workbench::error::Failure;
use workbench::session::Stand;
use workbench::tuning;

use crate::exact;
use crate::rig::circle;

/// Each quantity is the reference machine's times a number from here.
const SPREAD: RangeInclusive<f64> = 0.5..=1.5;
/// Every so many machines the friction has another structure.
const OTHER_STRUCTURE: u64 = 3;
/// Ways from rest after which elements slip, m.
const WAYS_M: (f64, f64) = (2.0e-6, 4.0e-5);
/// Lag of the Stribeck fall beside them, s: without one elements chatter on it.
const LAG_S: f64 = 3.0e-3;
/// Machines from this number on have more than friction, masses and screw.
pub const WITH_MORE: u64 = 101;
/// Of those every so many have a gap, of so many metres.
const WITH_GAP: u64 = 3;
const GAP_M: RangeInclusive<f64> = 3.0e-6..=8.0e-6;
/// Friction differs by direction by so much at most.
const ASYMMETRY: RangeInclusive<f64> = -0.15..=0.15;
const RIPPLE_N: f64 = 30.0;
/// Share of the friction that is on the motor's side.
const ON_MOTOR: RangeInclusive<f64> = 0.15..=0.45;
/// Machines from this number on have friction of both sides that rises and falls otherwise.
pub const UNLIKE_SIDES: u64 = 201;
/// Of those every so many have the other structure on one side only.
const UNLIKE_STRUCTURE: u64 = 2;
/// Rise of the motor's friction at rest, in that of the table's.
const UNLIKE_RISE: RangeInclusive<f64> = 0.0..=1.8;
/// From one draw of a machine to the next.
const REDRAWN: u64 = 10_000;

/// Radius of the circles, mm.
const RADIUS_MM: f64 = 100.0;
/// Their feeds, mm/min.
pub const FEEDS: [f64; 3] = [500.0, 2000.0, 8000.0];

/// Numbers of one machine.
struct Draw(ChaCha8Rng);

impl Draw {
    fn between(&mut self, range: RangeInclusive<f64>) -> f64 {
        let range = Uniform::try_from(range).expect("the range is not empty");
        range.sample(&mut self.0)
    }

    fn spread(&mut self, value: &mut f64) {
        *value *= self.between(SPREAD);
    }
}

/// The machine of a number, `draw` draws later.
fn drawn_later(number: u64, draw: u64) -> Machine {
    let seed = number + REDRAWN * draw;
    let mut machine = Machine::reference();
    machine.seed = seed;
    let mut axis = machine.axes[0].clone();
    let mut draw = Draw(ChaCha8Rng::seed_from_u64(seed));
    spread(&mut axis, &mut draw);
    if number.is_multiple_of(OTHER_STRUCTURE) {
        axis.actual.law = slip(axis.actual.sliding.coulomb_n, &mut draw);
        axis.actual.sliding.stribeck_lag_s = LAG_S * draw.between(SPREAD);
    }
    if number >= WITH_MORE {
        add_more(&mut axis, &mut draw);
        if number % WITH_GAP == 1 {
            axis.actual.mechanics.backlash_m = draw.between(GAP_M);
        }
        share_out(&mut axis, &mut draw);
    }
    if number >= UNLIKE_SIDES {
        make_unlike(
            &mut axis,
            number.is_multiple_of(UNLIKE_STRUCTURE),
            &mut draw,
        );
    }
    for (place, name) in ["X", "Y"].into_iter().enumerate() {
        machine.axes[place] = MachineAxis {
            name: name.into(),
            ..axis.clone()
        };
    }
    machine
}

/// Friction that differs by direction, and a ripple of the torque.
fn add_more(axis: &mut MachineAxis, draw: &mut Draw) {
    axis.actual.sliding.coulomb_asymmetry = draw.between(ASYMMETRY);
    axis.actual.sliding.viscous_asymmetry = draw.between(ASYMMETRY);
    let ripple = TorqueRipple {
        amplitude: RIPPLE_N,
        order: Some(draw.between(1.0..=8.99).floor()),
        period: None,
        phase: Some(draw.between(0.0..=6.0)),
    };
    let added = axis.actual.effects.add(ripple);
    added.expect("the plant has a ripple");
}

/// Gives a part of the friction to the motor's side, with a presliding of its own.
fn share_out(axis: &mut MachineAxis, draw: &mut Draw) {
    let actual = &mut axis.actual;
    let share = draw.between(ON_MOTOR);
    let part = |whole: &Sliding, share: f64| Sliding {
        coulomb_n: share * whole.coulomb_n,
        static_n: share * whole.static_n,
        viscous_n_s_per_m: share * whole.viscous_n_s_per_m,
        ..*whole
    };
    let sliding = part(&actual.sliding, share);
    let law = match &actual.law {
        Law::MaxwellSlip { .. } => slip(sliding.coulomb_n, draw),
        law => softened(law, share * draw.between(SPREAD)),
    };
    actual.sliding = part(&actual.sliding, 1.0 - share);
    actual.law = softened(&actual.law, 1.0 - share);
    actual.motor_side = Some(MotorSide { sliding, law });
}

/// Gives the motor's friction a rise, a fall and, where asked for, a structure of its own.
fn make_unlike(axis: &mut MachineAxis, is_other_structure: bool, draw: &mut Draw) {
    let Some(motor) = &mut axis.actual.motor_side else {
        return;
    };
    let sliding = &mut motor.sliding;
    let excess_n = sliding.static_n - sliding.coulomb_n;
    sliding.static_n = sliding.coulomb_n + draw.between(UNLIKE_RISE) * excess_n;
    draw.spread(&mut sliding.stribeck_velocity_m_per_s);
    if is_other_structure {
        let is_slip = matches!(motor.law, Law::MaxwellSlip { .. });
        (sliding.stribeck_lag_s, motor.law) = if is_slip {
            (0.0, usual_bristle(sliding.coulomb_n, draw))
        } else {
            (LAG_S * draw.between(SPREAD), slip(sliding.coulomb_n, draw))
        };
    }
}

/// The reference machine's bristle for another level, and softer or stiffer.
fn usual_bristle(level_n: f64, draw: &mut Draw) -> Law {
    let usual = &Machine::reference().axes[0].actual;
    softened(
        &usual.law,
        level_n / usual.sliding.coulomb_n * draw.between(SPREAD),
    )
}

/// A law with its stiffness and damping times a factor.
fn softened(law: &Law, factor: f64) -> Law {
    match law.clone() {
        Law::Coulomb => Law::Coulomb,
        Law::LuGre {
            bristle_stiffness_n_per_m,
            bristle_damping_n_s_per_m,
        } => Law::LuGre {
            bristle_stiffness_n_per_m: factor * bristle_stiffness_n_per_m,
            bristle_damping_n_s_per_m: factor * bristle_damping_n_s_per_m,
        },
        Law::MaxwellSlip {
            stiffness_n_per_m,
            share,
        } => Law::MaxwellSlip {
            stiffness_n_per_m: stiffness_n_per_m.iter().map(|own| factor * own).collect(),
            share,
        },
    }
}

fn spread(axis: &mut MachineAxis, draw: &mut Draw) {
    let actual = &mut axis.actual;
    let (mechanics, sliding) = (&mut actual.mechanics, &mut actual.sliding);
    let mut excess_n = sliding.static_n - sliding.coulomb_n;
    for value in [
        &mut mechanics.motor_inertia_kg,
        &mut mechanics.table_mass_kg,
        &mut mechanics.screw_stiffness_n_per_m,
        &mut mechanics.screw_damping_n_s_per_m,
        &mut sliding.coulomb_n,
        &mut excess_n,
        &mut sliding.stribeck_velocity_m_per_s,
        &mut sliding.viscous_n_s_per_m,
        &mut actual.current_loop_time_constant_s,
    ] {
        draw.spread(value);
    }
    sliding.static_n = sliding.coulomb_n + excess_n;
    if let Law::LuGre {
        bristle_stiffness_n_per_m,
        bristle_damping_n_s_per_m,
    } = &mut actual.law
    {
        draw.spread(bristle_stiffness_n_per_m);
        draw.spread(bristle_damping_n_s_per_m);
    }
}

/// Maxwell slip with shares that have nothing to do with each other.
fn slip(level_n: f64, draw: &mut Draw) -> Law {
    let count = draw.between(4.0..=12.99) as usize;
    let weights: Vec<f64> = (0..count).map(|_| draw.between(0.05..=1.0)).collect();
    let all: f64 = weights.iter().sum();
    let share: Vec<f64> = weights.iter().map(|weight| weight / all).collect();
    let (shortest, longest) = WAYS_M;
    let stiffness = share.iter().enumerate().map(|(place, share)| {
        let even = shortest * (longest / shortest).powf(place as f64 / (count - 1) as f64);
        share * level_n / (even * draw.between(0.8..=1.2))
    });
    Law::MaxwellSlip {
        stiffness_n_per_m: stiffness.collect(),
        share,
    }
}

/// A machine that was drawn, and what its loops do without any compensation.
#[derive(Debug)]
pub struct Drawn {
    /// The machine.
    pub machine: Machine,
    /// So many were drawn again before it.
    pub redrawn: u64,
    /// Oscillations, or why the axes cannot be moved.
    pub loops: Result<Vec<Oscillation>, Failure>,
}

impl Drawn {
    /// The machine of a number.
    #[must_use]
    pub fn of_number(number: u64) -> Self {
        let mut redrawn = 0;
        loop {
            let machine = drawn_later(number, redrawn);
            let loops = fitness::oscillations(&Stand::in_process(&machine));
            let own = Self {
                machine,
                redrawn,
                loops,
            };
            if number < WITH_MORE || !own.oscillates() {
                return own;
            }
            redrawn += 1;
        }
    }

    /// Axes that cannot be moved are no reason to draw again: they are told.
    fn oscillates(&self) -> bool {
        self.loops.as_ref().is_ok_and(|found| !found.is_empty())
    }

    /// Whether it is not commissioned at all.
    #[must_use]
    pub fn is_unfit(&self) -> bool {
        let loops = self.loops.as_ref();
        loops.map_or(true, |found| found.iter().any(Oscillation::is_unfit))
    }
}

/// A machine that was commissioned as a user would: records, identification, model, and the model
/// refined by the drives.
#[derive(Debug)]
pub struct Commissioned {
    /// What was named on the first axis, and the verdict.
    pub named: String,
    /// Models of the records, then refined.
    pub models: Vec<Vec<AxisCompensation>>,
}

impl Commissioned {
    /// Commissions a machine; the drives refine the model where they are asked to.
    ///
    /// # Panics
    /// Where an axis cannot be recorded, a record not be fitted or a circle not be run.
    #[must_use]
    pub fn of(stand: &Stand<'_>, refine: bool) -> Self {
        let folder = tempfile::tempdir().expect("a temporary folder can be made");
        identified_axes::record(stand, folder.path()).expect("the axes can be recorded");
        let results = identified_axes::identify(stand, folder.path());
        let results = results.expect("records can be fitted");
        let report = &results[0].report;
        let usual = circle(RADIUS_MM, FEEDS[1]);
        let model = tuning::model(stand, &usual, &results).expect("the circle can be run");
        let refined = model.as_ref().filter(|_| refine).and_then(|model| {
            let refined = tuning::self_tuning::refined(stand, &usual, model);
            refined.expect("the circles can be run")
        });
        let models = model.into_iter().chain(refined);
        Self {
            named: format!("{} ({})", report.found.join(", "), report.verdict),
            models: models.map(|tuned| tuned.compensation).collect(),
        }
    }
}

/// Models of what the machine file says.
#[must_use]
pub fn exact(machine: &Machine) -> Vec<AxisCompensation> {
    let axes = machine.axes.iter();
    axes.map(|axis| exact::model(axis, machine.period_s))
        .collect()
}

/// The largest burst at a feed with a compensation, µm.
///
/// # Errors
/// Where the circle breaks off.
pub fn burst_um(
    stand: &Stand<'_>,
    feed: f64,
    compensation: &[AxisCompensation],
) -> Result<f64, Failure> {
    let run = circle_test::run(stand, &circle(RADIUS_MM, feed), compensation, None)?;
    Ok(run.report.figures.peak_max_um)
}

/// What is left with a compensation at some feeds: µm, and % less than without.
///
/// # Errors
/// Where a circle breaks off.
pub fn left(
    stand: &Stand<'_>,
    feeds: &[f64],
    compensation: &[AxisCompensation],
) -> Result<Vec<(f64, f64)>, Failure> {
    let cell = |feed: &f64| {
        let none_um = burst_um(stand, *feed, &stand.uncompensated())?;
        let left_um = burst_um(stand, *feed, compensation)?;
        Ok((left_um, less_percent(none_um, left_um)))
    };
    feeds.iter().map(cell).collect()
}
