//! What the identification finds on seeded records with known hidden effects: the confusion matrix of `docs/identification.md`.

use std::collections::{BTreeMap, BTreeSet};

use hil_tests::golden::{self, row};
use hil_tests::records::Hidden::{
    Backlash, Compliance, CubicDrag, Delay, FrictionDrift, Hum, PitchError, PositionDependentFriction, Presliding,
    QuadraticDrag, Spring, Stribeck, TorqueRipple, TorqueSaturation, ViscousAsymmetry,
};
use hil_tests::records::{self, Plan};
use identification::report::Report;
use identification::{Dataset, identify};

/// Noise levels of the recorded effort, N.
const NOISE_N: [f64; 3] = [1.5, 4.0, 9.0];

/// Records with nothing hidden.
const EMPTY: usize = 20;

fn plans() -> Vec<Plan> {
    let empty = (0..EMPTY).map(|_| (vec![], false));
    let single = [
        (vec![ViscousAsymmetry(0.10)], false),
        (vec![ViscousAsymmetry(-0.25)], false),
        (vec![Stribeck(1.3, 3.0e-3)], false),
        (vec![Stribeck(1.6, 6.0e-3)], false),
        (vec![Presliding(4.0e-6)], false),
        (vec![Presliding(12.0e-6)], false),
        (vec![Presliding(8.0e-6)], true),
        (vec![Backlash(12.0e-6)], true),
        (vec![Backlash(40.0e-6)], true),
        (vec![Backlash(20.0e-6)], false),
        (vec![Backlash(45.0e-6)], false),
        (vec![Compliance(4.0e7)], true),
        (vec![Compliance(1.2e8)], true),
        (vec![TorqueRipple(8.0, 6.0)], false),
        (vec![TorqueRipple(25.0, 2.0)], false),
        (vec![PitchError(1.5e-6, 0.010)], true),
        (vec![PitchError(5.0e-6, 0.020)], true),
        (vec![PositionDependentFriction(1.0)], false),
        (vec![PositionDependentFriction(-2.0)], false),
        (vec![FrictionDrift(0.2, 8.0)], false),
        (vec![FrictionDrift(0.4, 15.0)], false),
        (vec![QuadraticDrag(600.0)], false),
        (vec![QuadraticDrag(1500.0)], false),
        (vec![TorqueSaturation(0.05)], false),
        (vec![TorqueSaturation(0.12)], false),
        (vec![Delay(0.5e-3)], false),
        (vec![Delay(0.9e-3)], false),
    ];
    let pairs = [
        (vec![Stribeck(1.5, 4.0e-3), TorqueRipple(15.0, 6.0)], false),
        (vec![ViscousAsymmetry(0.2), FrictionDrift(0.3, 10.0)], false),
        (vec![PositionDependentFriction(1.5), TorqueRipple(20.0, 3.0)], false),
        (vec![QuadraticDrag(1000.0), Stribeck(1.4, 5.0e-3)], false),
        (vec![Backlash(20.0e-6), TorqueRipple(15.0, 6.0)], true),
        (vec![Delay(0.6e-3), ViscousAsymmetry(-0.2)], false),
        (vec![PitchError(3.0e-6, 0.010), Stribeck(1.4, 4.0e-3)], true),
        (vec![Compliance(6.0e7), FrictionDrift(0.3, 8.0)], true),
        (vec![Presliding(8.0e-6), Stribeck(1.4, 4.0e-3)], false),
        (vec![Presliding(6.0e-6), TorqueRipple(12.0, 4.0)], false),
        (vec![TorqueSaturation(0.10), ViscousAsymmetry(0.2)], false),
        (vec![Backlash(30.0e-6), FrictionDrift(0.3, 12.0)], true),
    ];
    let outside = [
        (vec![Spring(400.0)], false),
        (vec![Spring(-150.0)], true),
        (vec![Hum(12.0, 0.7)], false),
        (vec![Hum(20.0, 3.0)], true),
        (vec![CubicDrag(12_000.0)], false),
        (vec![Spring(300.0), Hum(10.0, 1.3)], false),
    ];
    let all = empty.chain(single).chain(pairs).chain(outside);
    all.enumerate()
        .map(|(index, (hidden, load_scale))| Plan {
            load_scale: load_scale || (hidden.is_empty() && index % 2 == 0),
            hidden,
            noise_n: NOISE_N[index % NOISE_N.len()],
            seed: 1000 + index as u64,
            ..Plan::default()
        })
        .collect()
}

/// Names that a report gives, with `unexplained` where it says so.
fn names(report: &Report) -> BTreeSet<String> {
    let unexplained = (report.verdict == "unexplained").then(|| "unexplained".to_owned());
    report.found.iter().cloned().chain(unexplained).collect()
}

fn identified(plan: &Plan, declared: Option<Vec<String>>) -> Report {
    let folder = tempfile::tempdir().unwrap();
    records::write(folder.path(), plan).unwrap();
    let dataset = Dataset::read(folder.path(), None, declared).unwrap();
    identify(&dataset, &mut |_| ()).unwrap().report
}

/// Runs a function over a list on two threads, in order.
fn on_two_threads<A: Sync, B: Send>(list: &[A], run: impl Fn(&A) -> B + Sync) -> Vec<B> {
    let half = list.len().div_ceil(2);
    let (front, back) = list.split_at(half);
    let all = |part: &[A]| part.iter().map(&run).collect::<Vec<B>>();
    std::thread::scope(|scope| {
        let back = scope.spawn(|| all(back));
        let mut out = all(front);
        out.extend(back.join().unwrap());
        out
    })
}

fn text(names: &BTreeSet<String>) -> String {
    if names.is_empty() { "nothing".into() } else { names.iter().cloned().collect::<Vec<_>>().join(", ") }
}

#[test]
fn hidden_effects_are_named_and_nothing_else() {
    let plans = plans();
    let came = on_two_threads(&plans, |plan| names(&identified(plan, None)));
    let mut matrix: BTreeMap<(String, String), usize> = BTreeMap::new();
    let (mut exact, mut false_alarms, mut missed_structure) = (0, 0, 0);
    for (plan, came) in plans.iter().zip(&came) {
        let wanted: BTreeSet<String> = plan.hidden.iter().map(|hidden| hidden.name().to_owned()).collect();
        exact += usize::from(wanted == *came);
        false_alarms += usize::from(wanted.is_empty() && !came.is_empty());
        missed_structure += usize::from(wanted.contains("unexplained") && !came.contains("unexplained"));
        if wanted != *came {
            println!("not exact: {:?}, noise {} N, seed {}: {}", plan.hidden, plan.noise_n, plan.seed, text(came));
        }
        *matrix.entry((text(&wanted), text(came))).or_default() += 1;
    }
    println!("| hidden | named | records |\n|---|---|---|");
    matrix.iter().for_each(|((wanted, came), count)| println!("| {wanted} | {came} | {count} |"));
    println!("{exact} of {} exact, {false_alarms} false alarms on {} empty records", plans.len(), EMPTY);
    assert_eq!((false_alarms, missed_structure), (0, 0));
    assert!(exact * 100 >= plans.len() * 95, "{exact} of {}", plans.len());
    let share = 100.0 * exact as f64 / plans.len() as f64;
    golden::check("identification", &[row("records", plans.len() as f64, ""), row("named exactly", share, "%")]);
}

/// Force error on the validation record against a fit that is told the truth: at most 1.1 times.
#[test]
fn errors_are_near_those_of_the_true_structure() {
    let plans: Vec<Plan> = plans().into_iter().filter(|plan| plan.seed % 3 == 0 && !plan.hidden.is_empty()).collect();
    let named = |plan: &Plan| !plan.hidden.iter().any(|hidden| hidden.name() == "unexplained");
    let plans: Vec<Plan> = plans.into_iter().filter(named).collect();
    let errors = on_two_threads(&plans, |plan| {
        let base = ["inertia", "viscous", "coulomb", "offset"].map(String::from);
        let truth = base.into_iter().chain(plan.hidden.iter().map(|hidden| hidden.name().to_owned())).collect();
        let (told, found) = (identified(plan, Some(truth)), identified(plan, None));
        (told.validate.force_error_before_percent, found.validate.force_error_after_percent)
    });
    for (plan, (told, found)) in plans.iter().zip(errors) {
        println!("{:?}: told {told:.3} %, found {found:.3} %", plan.hidden);
        assert!(found <= 1.1 * told, "{plan:?}: {found} against {told}");
    }
}

/// A gap inside the loop with Coulomb friction, and an axis with presliding whose friction is chosen so that it makes the same burst on the circle.
fn look_alikes(seed: u64) -> [Plan; 2] {
    let gap = Plan { hidden: vec![Backlash(8.0e-6 + 1.0e-6 * seed as f64)], load_loop: true, seed, ..Plan::default() };
    let wanted = records::burst_m(&gap);
    let bristle = |friction_factor: f64| Plan {
        hidden: vec![Presliding(4.0e-6 + 0.5e-6 * seed as f64)],
        friction_factor,
        ..gap.clone()
    };
    let (mut low, mut high) = (0.1, 10.0);
    for _ in 0..12 {
        let middle = f64::sqrt(low * high);
        if records::burst_m(&bristle(middle)) < wanted { low = middle } else { high = middle }
    }
    let bristle = bristle(f64::sqrt(low * high));
    let ratio = records::burst_m(&bristle) / wanted;
    assert!((0.9..1.1).contains(&ratio), "seed {seed}: bursts differ by {ratio}");
    [gap, bristle]
}

#[test]
fn a_gap_and_presliding_with_equal_bursts_are_told_apart() {
    let pairs: Vec<[Plan; 2]> = on_two_threads(&(1..=20).collect::<Vec<u64>>(), |seed| look_alikes(*seed));
    let mut counts = Vec::new();
    for load_scale in [true, false] {
        let right = on_two_threads(&pairs, |pair| {
            pair.iter().all(|plan| {
                let plan = Plan { load_scale, ..plan.clone() };
                let came = names(&identified(&plan, None));
                let right = came.iter().eq([plan.hidden[0].name()]);
                if !right {
                    println!("{:?} load scale {load_scale} seed {}: {}", plan.hidden, plan.seed, text(&came));
                }
                right
            })
        });
        counts.push(right.into_iter().filter(|right| *right).count());
    }
    println!("told apart: {} of 20 with two columns, {} of 20 with the motor's alone", counts[0], counts[1]);
    assert!(counts[0] == 20 && counts[1] >= 19, "{counts:?}");
}
