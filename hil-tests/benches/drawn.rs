//! What the model of friction leaves on machines that nobody chose: `cargo bench -p hil-tests
//! --bench drawn [-- MACHINES [FIRST]]`.
//!
//! A machine is the reference machine with its masses, screw, friction, Stribeck fall, presliding
//! and current lag each drawn between half and one and a half times; every third has Maxwell slip
//! of 4 to 12 uneven elements for its bristle, and a Stribeck fall that lags. Its loop gains are in
//! proportion to its own inertia. Machines from 101 on have more at once: friction that differs by
//! direction, a ripple of 30 N, and every third of them a gap of 3 to 8 µm inside the loop; of
//! these one that oscillates is drawn again.
//!
//! It is commissioned as a user would: loops first, records, identification, model, and the model
//! refined by the drives. The table has the largest burst, µm, without → with the model of what the
//! machine file says → with the model of its records → refined, at R 100 F 500, 2000 and 8000, what
//! identification named, and what was told of the loops.

use std::ops::RangeInclusive;

use axis_model::TorqueRipple;
use hil_tests::rig::circle;
use hil_tests::{exact, on_all_cores};
use plant_sim::Machine;
use plant_sim::friction::Law;
use plant_sim::machine::MachineAxis;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, Uniform};
use workbench::circle_test;
use workbench::commissioning::feeds::less_percent;
use workbench::commissioning::fitness;
use workbench::commissioning::identified_axes;
use workbench::compensation::AxisCompensation;
use workbench::session::Stand;
use workbench::tuning;

/// Machines.
const MACHINES: u64 = 12;
/// Each quantity is the reference machine's times a number from here.
const SPREAD: RangeInclusive<f64> = 0.5..=1.5;
/// Every so many machines the friction has another structure.
const OTHER_STRUCTURE: u64 = 3;
/// Ways from rest after which elements slip, m.
const WAYS_M: (f64, f64) = (2.0e-6, 4.0e-5);
/// Lag of the Stribeck fall beside them, s: without one elements chatter on it.
const LAG_S: f64 = 3.0e-3;
/// Machines from this seed on have more than friction, masses and screw.
const WITH_MORE: u64 = 101;
/// Of those every so many have a gap, of so many metres.
const WITH_GAP: u64 = 3;
const GAP_M: RangeInclusive<f64> = 3.0e-6..=8.0e-6;
/// Friction differs by direction by so much at most.
const ASYMMETRY: RangeInclusive<f64> = -0.15..=0.15;
const RIPPLE_N: f64 = 30.0;
/// From one draw of a machine to the next.
const REDRAWN: u64 = 10_000;

/// Radius of the circles, mm.
const RADIUS_MM: f64 = 100.0;
/// Their feeds, mm/min.
const FEEDS: [f64; 3] = [500.0, 2000.0, 8000.0];

fn main() {
    let mut arguments = std::env::args().skip(1).filter(|text| text != "--bench");
    let mut number = |usual: u64| {
        let text = arguments.next();
        text.and_then(|text| text.parse().ok()).unwrap_or(usual)
    };
    let (machines, first) = (number(MACHINES), number(1));
    let numbers: Vec<u64> = (first..first + machines).collect();
    println!("| machine | friction | F 500 | F 2000 | F 8000 | named | loops |");
    println!("|---|---|---|---|---|---|---|");
    for line in on_all_cores(&numbers, |number| of_number(*number)) {
        println!("{line}");
    }
}

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
fn drawn(number: u64, draw: u64) -> Machine {
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

fn of_number(number: u64) -> String {
    let mut draw = 0;
    loop {
        let machine = drawn(number, draw);
        let stand = Stand::in_process(&machine);
        let loops = fitness::oscillations(&stand);
        let is_unfit = match &loops {
            Ok(found) => found.iter().any(fitness::Oscillation::is_unfit),
            Err(_) => true,
        };
        let oscillates = is_unfit || loops.as_ref().is_ok_and(|found| !found.is_empty());
        if oscillates && number >= WITH_MORE {
            draw += 1;
            continue;
        }
        let called = called(&machine.axes[0], draw);
        let told = match &loops {
            Ok(found) => told(found),
            Err(failure) => failure.to_string(),
        };
        if is_unfit {
            return format!("| {number} | {called} | not commissioned | | | | {told} |");
        }
        let (named, models) = commissioned(&stand);
        let [slow, usual, fast] = FEEDS.map(|feed| cell(&stand, feed, &models));
        return format!("| {number} | {called} | {slow} | {usual} | {fast} | {named} | {told} |");
    }
}

/// What a machine has.
fn called(axis: &MachineAxis, draw: u64) -> String {
    let mut words = match &axis.actual.law {
        Law::MaxwellSlip { share, .. } => format!("Maxwell slip, {} elements", share.len()),
        _ => "LuGre".into(),
    };
    let gap_um = 1.0e6 * axis.actual.mechanics.backlash_m;
    if gap_um > 0.0 {
        words += &format!(", gap {gap_um:.1} µm");
    }
    if draw > 0 {
        words += &format!(", draw {}", draw + 1);
    }
    words
}

fn told(loops: &[fitness::Oscillation]) -> String {
    let each = loops.iter().map(|own| {
        let (hz, um) = (own.frequency_hz, own.amplitude_um);
        let at = own.creeping_m_per_s;
        let at = at.map_or(String::new(), |at| format!(" at {:.1} mm/s", 1.0e3 * at));
        format!("{}: {hz:.0} Hz, {um:.1} µm{at}", own.axis)
    });
    each.collect::<Vec<_>>().join("; ")
}

/// What was named on the first axis, and the models of both: exact, of the records, and refined.
fn commissioned(stand: &Stand<'_>) -> (String, Vec<Vec<AxisCompensation>>) {
    let folder = tempfile::tempdir().expect("a temporary folder can be made");
    identified_axes::record(stand, folder.path()).expect("the axes can be recorded");
    let results = identified_axes::identify(stand, folder.path()).expect("records can be fitted");
    let report = &results[0].report;
    let named = format!("{} ({})", report.found.join(", "), report.verdict);
    let usual = circle(RADIUS_MM, FEEDS[1]);
    let model = tuning::model(stand, &usual, &results).expect("the circle can be run");
    let refined = model.as_ref().and_then(|model| {
        let refined = tuning::self_tuning::refined(stand, &usual, model);
        refined.expect("the circles can be run")
    });
    let (axes, period_s) = (stand.machine.axes.iter(), stand.machine.period_s);
    let mut models = vec![axes.map(|axis| exact::model(axis, period_s)).collect()];
    models.extend(
        model
            .into_iter()
            .chain(refined)
            .map(|tuned| tuned.compensation),
    );
    (named, models)
}

fn cell(stand: &Stand<'_>, feed: f64, models: &[Vec<AxisCompensation>]) -> String {
    let burst_um = |compensation: &[AxisCompensation]| {
        let run = circle_test::run(stand, &circle(RADIUS_MM, feed), compensation, None);
        run.map(|run| run.report.figures.peak_max_um)
    };
    let none = match burst_um(&stand.uncompensated()) {
        Ok(none_um) => none_um,
        Err(failure) => return failure.to_string(),
    };
    let with = models.iter().map(|model| match burst_um(model) {
        Ok(um) => format!(" → {um:.2} ({:.1} %)", less_percent(none, um)),
        Err(failure) => format!(" → {failure}"),
    });
    format!("{none:.1}{}", with.collect::<String>())
}
