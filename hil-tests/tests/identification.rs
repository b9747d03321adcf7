//! What the identification finds on seeded records with known hidden effects: the confusion matrix
//! of `docs/identification.md`.

use std::collections::{BTreeMap, BTreeSet};

use hil_tests::golden::{self, row};
use hil_tests::plans::{EMPTY, plans};
use hil_tests::records::Hidden::{Backlash, Presliding};
use hil_tests::records::{self, Plan};
use hil_tests::{Scope, on_all_cores};
use identification::{Dataset, Report, identify};

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

fn text(names: &BTreeSet<String>) -> String {
    if names.is_empty() {
        "nothing".into()
    } else {
        names.iter().cloned().collect::<Vec<_>>().join(", ")
    }
}

/// What a record is an example of.
fn kind(plan: &Plan) -> &'static str {
    match plan.hidden[..] {
        [] => "nothing",
        [hidden] => hidden.name(),
        _ => "several",
    }
}

/// The records of the scope: one with one effect; one of each kind; all.
fn chosen() -> Vec<Plan> {
    let (all, mut seen) = (plans(), BTreeSet::new());
    let one_of_each = all
        .iter()
        .filter(|plan| seen.insert(kind(plan)))
        .cloned()
        .collect();
    let single = all
        .iter()
        .filter(|plan| plan.hidden.len() == 1)
        .take(1)
        .cloned()
        .collect();
    let (count, some) = (all.len(), Scope::now().pick(single, one_of_each, all));
    println!(
        "seeded records: {} of {count} (scope {:?})",
        some.len(),
        Scope::now()
    );
    some
}

#[test]
fn hidden_effects_are_named_and_nothing_else() {
    let plans = chosen();
    let came = on_all_cores(&plans, |plan| names(&identified(plan, None)));
    let mut matrix: BTreeMap<(String, String), usize> = BTreeMap::new();
    let (mut exact, mut false_alarms, mut missed_structure) = (0, 0, 0);
    for (plan, came) in plans.iter().zip(&came) {
        let wanted: BTreeSet<String> = plan
            .hidden
            .iter()
            .map(|hidden| hidden.name().to_owned())
            .collect();
        exact += usize::from(wanted == *came);
        false_alarms += usize::from(wanted.is_empty() && !came.is_empty());
        missed_structure +=
            usize::from(wanted.contains("unexplained") && !came.contains("unexplained"));
        if wanted != *came {
            println!(
                "not exact: {:?}, noise {} N, seed {}: {}",
                plan.hidden,
                plan.noise_n,
                plan.seed,
                text(came)
            );
        }
        *matrix.entry((text(&wanted), text(came))).or_default() += 1;
    }
    println!("| hidden | named | records |\n|---|---|---|");
    for ((wanted, came), count) in &matrix {
        println!("| {wanted} | {came} | {count} |");
    }
    let empty = plans.iter().filter(|plan| plan.hidden.is_empty()).count();
    println!(
        "{exact} of {} exact, {false_alarms} false alarms on {empty} empty records",
        plans.len()
    );
    assert_eq!((false_alarms, missed_structure), (0, 0));
    if !Scope::now().is_complete() {
        assert_eq!(
            exact,
            plans.len(),
            "the records of this scope are those that are named exactly"
        );
        return;
    }
    assert_eq!(empty, EMPTY);
    assert!(
        exact * 100 >= plans.len() * 95,
        "{exact} of {}",
        plans.len()
    );
    let share = 100.0 * exact as f64 / plans.len() as f64;
    golden::check(
        "identification",
        &[
            row("records", plans.len() as f64, ""),
            row("named exactly", share, "%"),
        ],
    );
}

/// Force error on the validation record against a fit that is told the truth: at most 1.1 times.
#[test]
fn errors_are_near_those_of_the_true_structure() {
    let named = |plan: &Plan| {
        !plan.hidden.is_empty()
            && plan
                .hidden
                .iter()
                .all(|hidden| hidden.name() != "unexplained")
    };
    let plans: Vec<Plan> = plans()
        .into_iter()
        .filter(|plan| plan.seed % 4 == 0 && named(plan))
        .collect();
    let plans = Scope::now().spread("errors beside the true structure", &plans, 1, 2);
    let errors = on_all_cores(&plans, |plan| {
        let base = ["inertia", "viscous", "coulomb", "offset"].map(String::from);
        let truth = base
            .into_iter()
            .chain(plan.hidden.iter().map(|hidden| hidden.name().to_owned()))
            .collect();
        let (told, found) = (identified(plan, Some(truth)), identified(plan, None));
        (
            told.validate.force_error_before_percent,
            found.validate.force_error_after_percent,
        )
    });
    for (plan, (told, found)) in plans.iter().zip(errors) {
        println!("{:?}: told {told:.3} %, found {found:.3} %", plan.hidden);
        assert!(found <= 1.1 * told, "{plan:?}: {found} against {told}");
    }
}

/// A gap inside the loop with Coulomb friction, and an axis with presliding whose friction is
/// chosen so that it makes the same burst on the circle.
fn look_alikes(seed: u64) -> [Plan; 2] {
    let gap = Plan {
        hidden: vec![Backlash(8.0e-6 + 1.0e-6 * seed as f64)],
        load_loop: true,
        seed,
        ..Plan::default()
    };
    let wanted = records::burst_m(&gap);
    let bristle = |friction_factor: f64| Plan {
        hidden: vec![Presliding(4.0e-6 + 0.5e-6 * seed as f64)],
        friction_factor,
        ..gap.clone()
    };
    let (mut low, mut high) = (0.1, 10.0);
    for _ in 0..12 {
        let middle = f64::sqrt(low * high);
        if records::burst_m(&bristle(middle)) < wanted {
            low = middle;
        } else {
            high = middle;
        }
    }
    let bristle = bristle(f64::sqrt(low * high));
    let ratio = records::burst_m(&bristle) / wanted;
    assert!(
        (0.9..1.1).contains(&ratio),
        "seed {seed}: bursts differ by {ratio}"
    );
    [gap, bristle]
}

/// How many pairs are told apart, with the load scale or without.
fn told_apart(pairs: &[[Plan; 2]], load_scale: bool) -> usize {
    let right = on_all_cores(pairs.as_flattened(), |plan| {
        let came = names(&identified(
            &Plan {
                load_scale,
                ..plan.clone()
            },
            None,
        ));
        let right = came.iter().eq([plan.hidden[0].name()]);
        if !right {
            println!(
                "{:?} load scale {load_scale} seed {}: {}",
                plan.hidden,
                plan.seed,
                text(&came)
            );
        }
        right
    });
    right
        .chunks(2)
        .filter(|pair| pair.iter().all(|right| *right))
        .count()
}

#[test]
fn a_gap_and_presliding_with_equal_bursts_are_told_apart() {
    let seeds: Vec<u64> = (1..=20).collect();
    let pairs = on_all_cores(Scope::now().rows("look-alikes", &seeds, 1, 1), |seed| {
        look_alikes(*seed)
    });
    // With the load scale every pair, with the motor's position alone one in twenty may be missed.
    for (load_scale, misses) in Scope::now().rows("positions", &[(true, 0), (false, 1)], 1, 2) {
        let right = told_apart(&pairs, *load_scale);
        println!(
            "told apart: {right} of {}, load scale {load_scale}",
            pairs.len()
        );
        assert!(
            right + Scope::now().pick(0, 0, *misses) >= pairs.len(),
            "{right}, load scale {load_scale}"
        );
    }
}
