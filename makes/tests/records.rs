//! What holds of every record, whatever is judged on it.

mod common;

use common::{some_of, some_outside};
use makes::draw::Draw;
use makes::make::{
    Form, Make, Presence, all, families, held_back, unexpected, unforeseen, unmet, unseen,
    unsought, untried,
};
use makes::motion::Motion;
use makes::outside::OUTSIDE;
use makes::outside::held_back::HELD_BACK;
use makes::outside::unexpected::UNEXPECTED;
use makes::outside::unforeseen::UNFORESEEN;
use makes::outside::unmet::UNMET;
use makes::outside::unseen::UNSEEN;
use makes::outside::unsought::UNSOUGHT;
use makes::outside::untried::UNTRIED;
use makes::rig::{Kind, Rig};
use makes::sensing::Stamps;
use makes::table::Table;
use makes::truth::Effect;
use makes::written_apart;
use scope::{Scope, on_all_cores};

/// Those that are held back with them.
fn every_make() -> Vec<Make> {
    let apart = written_apart().into_iter().flat_map(|apart| apart.makes);
    all().into_iter().chain(apart).collect()
}

fn rms(values: impl Iterator<Item = f64>) -> f64 {
    let (count, sum) = values.fold((0.0, 0.0), |(n, s), v| (n + 1.0, s + v * v));
    (sum / f64::max(count, 1.0)).sqrt()
}

#[test]
fn every_controller_follows() {
    for make in every_make() {
        let rig = make.rig(Presence::Present, 1);
        if !matches!(rig.training.0, Motion::Path(_)) || !rig.sensing.reference {
            continue;
        }
        let trace = rig.run(&(rig.validation.0.clone(), rig.validation.1.min(4.0)));
        let way = |v: &[f64]| {
            v.iter().copied().fold(f64::MIN, f64::max) - v.iter().copied().fold(f64::MAX, f64::min)
        };
        let off = rms(trace.reference.iter().zip(&trace.motor).map(|(r, x)| r - x));
        let share = off / way(&trace.reference);
        assert!(
            share < 0.02,
            "{}: {:.2} % of the way",
            make.name,
            100.0 * share
        );
    }
}

/// Acceleration of the motor over twenty rows: an axis without a loop shows an effect there.
fn bends(table: &Table) -> Option<Vec<f64>> {
    let motor = &table.columns[table.place("position_")?].values;
    let bend = |w: &[f64]| w[40] - 2.0 * w[20] + w[0];
    Some(motor.windows(41).map(bend).collect())
}

/// Largest relative change of a column (for the load scale: of motor − load) between two tables.
fn change(with: &Table, without: &Table) -> f64 {
    let load = |t: &Table| -> Option<Vec<f64>> {
        let (motor, load) = (t.place("position_")?, t.place("load_position_")?);
        let pairs = t.columns[motor].values.iter().zip(&t.columns[load].values);
        Some(pairs.map(|(m, l)| m - l).collect())
    };
    let share = |a: &[f64], b: &[f64]| {
        let mean = b.iter().sum::<f64>() / b.len() as f64;
        rms(a.iter().zip(b).map(|(a, b)| a - b)) / rms(b.iter().map(|b| b - mean)).max(1.0e-9)
    };
    let columns = with.columns.iter().zip(&without.columns);
    let each = columns.map(|(a, b)| share(&a.values, &b.values));
    let bent = bends(with).zip(bends(without)).map(|(a, b)| share(&a, &b));
    let between = load(with).zip(load(without)).map(|(a, b)| share(&a, &b));
    each.chain(between).chain(bent).fold(0.0, f64::max)
}

/// The training record of a rig; noise is the same for all.
fn training(rig: &Rig) -> Table {
    rig.table(&rig.training, &mut Draw::of("same", 1))
}

#[test]
fn every_hidden_effect_changes_the_record() {
    let rows = some_of(|_| true);
    let changed = on_all_cores(&rows, |make| {
        let table = |presence| training(&make.rig(presence, 1));
        change(&table(Presence::Present), &table(Presence::Absent))
    });
    for (make, changed) in rows.iter().zip(changed) {
        assert!(changed > 0.02, "{}: {:.2} %", make.name, 100.0 * changed);
    }
}

#[test]
fn every_disturbance_outside_the_list_changes_the_record() {
    let scope = Scope::now();
    let some = scope.rows("disturbances", OUTSIDE, 4, 6);
    let rows = [some.to_vec(), some_outside()].concat();
    let changed = on_all_cores(&rows, |outside| {
        change(&training(&outside.rig(1)), &training(&outside.good_rig(1)))
    });
    for (outside, changed) in rows.iter().zip(changed) {
        assert!(changed > 0.05, "{}: {:.2} %", outside.name, 100.0 * changed);
    }
}

#[test]
fn a_record_is_what_its_dataset_file_says() {
    for make in every_make() {
        let mut rig = make.rig(Presence::Present, 1);
        rig.training.1 = 2.0;
        rig.validation.1 = 1.0;
        let table = rig.table(&rig.training, &mut Draw::of("table", 1));
        let unit = if rig.kind == Kind::Linear { "m" } else { "rad" };
        let position = table.column(&format!("position_{unit}")).expect(make.name);
        let count = rig.sensing.motor.resolution;
        let off = |x: &f64| (x / count - (x / count).round()).abs();
        assert!(position.iter().all(|x| off(x) < 1.0e-3), "{}", make.name);
        let times = table.column("time_s").expect(make.name);
        if rig.sensing.stamps == Stamps::default() {
            assert_eq!(times[1], rig.row_s(), "{}", make.name);
        } else {
            // Jitter and lost rows leave the mean.
            let mean = times[times.len() - 1] / (times.len() - 1) as f64;
            assert!((mean / rig.row_s() - 1.0).abs() < 0.02, "{}", make.name);
        }
        assert!(table.column(rig.column.name()).is_some(), "{}", make.name);
    }
}

#[test]
fn a_record_is_the_same_every_time_and_another_one_for_another_seed() {
    let make = all()[0];
    let csv = |seed: u64| make.entry(Form::Empty, seed).train.csv();
    assert_eq!(csv(1), csv(1));
    assert_ne!(csv(1), csv(2));
}

#[test]
fn another_day_has_the_training_record_of_the_hidden_form_and_another_validation() {
    let make = all()[0];
    let (hidden, other) = (make.entry(Form::Hidden, 1), make.entry(Form::AnotherDay, 1));
    assert_eq!(hidden.train, other.train);
    assert_ne!(hidden.validate, other.validate);
    assert_eq!(make.entry(Form::Declared, 1).train, hidden.train);
}

#[test]
fn there_are_makes_enough_and_every_listed_effect_has_two() {
    let makes = all();
    assert!(makes.len() >= 28);
    for effect in makes.iter().flat_map(|make| make.hides) {
        let with = makes
            .iter()
            .filter(|make| make.hides.contains(effect))
            .count();
        assert!(with >= 2, "{effect:?}");
    }
}

/// What may be lacking, by the interface.
#[rustfmt::skip]
const NAMES: [Effect; 19] = [
    Effect::Offset, Effect::CoulombAsymmetry, Effect::ViscousAsymmetry, Effect::Stribeck,
    Effect::Presliding, Effect::Backlash, Effect::Compliance, Effect::TorqueRipple,
    Effect::PitchError, Effect::PositionDependentFriction, Effect::FrictionDrift,
    Effect::QuadraticDrag, Effect::TorqueSaturation, Effect::Delay, Effect::Payload,
    Effect::PositionDependentInertia, Effect::LoadDependentFriction,
    Effect::TorqueConstantRipple, Effect::LoggedLate,
];

#[test]
fn a_third_of_the_makes_is_held_back_and_hides_every_name() {
    let makes = held_back();
    let hidden = |effect: &Effect| makes.iter().any(|make| make.hides.contains(effect));
    for effect in NAMES {
        assert!(hidden(&effect), "{effect:?}");
    }
    let several = makes.iter().filter(|make| make.hides.len() > 1).count();
    assert!(several >= 3 && HELD_BACK.len() >= 4);
    let (ours, theirs) = (makes.len() + HELD_BACK.len(), all().len());
    assert!(3 * ours >= ours + theirs, "{ours} {theirs}");
}

#[test]
fn the_unseen_makes_hide_every_name_twice_and_no_make_has_a_name_of_another_table() {
    let makes = unseen();
    let hidden = |effect: &Effect| makes.iter().filter(|m| m.hides.contains(effect)).count();
    for effect in NAMES {
        assert!(hidden(&effect) >= 2, "{effect:?}");
    }
    assert!(makes.len() >= 20 && UNSEEN.len() >= 8);
    assert!(makes.iter().all(|make| (1..=3).contains(&make.hides.len())));
    let of_makes = every_make().into_iter().map(|make| make.name);
    let of_outside = written_apart().map(|apart| apart.outside).concat();
    let of_outside = OUTSIDE
        .iter()
        .chain(&of_outside)
        .map(|outside| outside.name);
    let names: Vec<&str> = of_makes.chain(of_outside).collect();
    let different: std::collections::BTreeSet<_> = names.iter().collect();
    assert_eq!(different.len(), names.len());
}

#[test]
fn the_untried_makes_hide_every_name_of_an_effect_twice() {
    let makes = untried();
    let hidden = |effect: &Effect| makes.iter().filter(|m| m.hides.contains(effect)).count();
    // A constant force is a term of the model rather than an effect: it has been hidden enough.
    for effect in NAMES.iter().filter(|effect| **effect != Effect::Offset) {
        assert_eq!(hidden(effect), 2, "{effect:?}");
    }
    assert!(makes.len() == 20 && UNTRIED.len() == 6);
    assert!(makes.iter().all(|make| (1..=3).contains(&make.hides.len())));
}

#[test]
fn the_unmet_makes_hide_every_name_of_an_effect_and_gaps_and_their_like_twice() {
    let makes = unmet();
    let hidden = |effect: &Effect| makes.iter().filter(|m| m.hides.contains(effect)).count();
    for effect in NAMES.iter().filter(|effect| **effect != Effect::Offset) {
        assert!(hidden(effect) >= 1, "{effect:?}");
    }
    for effect in [
        Effect::Backlash,
        Effect::Compliance,
        Effect::Presliding,
        Effect::Stribeck,
    ] {
        assert!(hidden(&effect) >= 2, "{effect:?}");
    }
    assert!(makes.len() == 14 && UNMET.len() == 5);
    assert!(makes.iter().all(|make| (1..=3).contains(&make.hides.len())));
}

#[test]
fn the_unforeseen_makes_hide_every_name_of_an_effect_one_two_or_three_at_once() {
    let makes = unforeseen();
    let hidden = |effect: &Effect| makes.iter().filter(|m| m.hides.contains(effect)).count();
    for effect in NAMES.iter().filter(|effect| **effect != Effect::Offset) {
        assert!(hidden(effect) >= 1, "{effect:?}");
    }
    assert!(makes.len() == 20 && UNFORESEEN.len() == 5);
    for count in 1..=3 {
        let with = makes.iter().filter(|make| make.hides.len() == count);
        assert!(with.count() >= 2, "{count}");
    }
}

/// Of makes most hide one effect, the others two or three, and together they hide every name.
fn assert_most_hide_one_and_together_every_name(makes: &[Make]) {
    for effect in NAMES {
        let hidden = makes.iter().any(|make| make.hides.contains(&effect));
        assert!(hidden, "{effect:?}");
    }
    assert!(makes.iter().all(|make| (1..=3).contains(&make.hides.len())));
    let several = makes.iter().filter(|make| make.hides.len() > 1).count();
    assert!((5..=6).contains(&several), "{several}");
}

#[test]
fn most_of_the_unexpected_makes_hide_one_effect_and_together_they_hide_every_name() {
    let makes = unexpected();
    assert_most_hide_one_and_together_every_name(&makes);
    assert!(makes.len() == 16 && UNEXPECTED.len() == 4);
}

#[test]
fn most_of_the_unsought_makes_hide_one_effect_and_together_they_hide_every_name() {
    let makes = unsought();
    assert_most_hide_one_and_together_every_name(&makes);
    assert!(makes.len() == 14 && UNSOUGHT.len() == 4);
}

#[test]
fn the_families_are_ten_makes_of_friction_waves_and_masses() {
    let makes = families();
    let hidden = |effect: &Effect| makes.iter().filter(|m| m.hides.contains(effect)).count();
    for effect in [
        Effect::Stribeck,
        Effect::Presliding,
        Effect::PositionDependentFriction,
        Effect::TorqueRipple,
        Effect::PitchError,
        Effect::Compliance,
    ] {
        assert!(hidden(&effect) >= 2, "{effect:?}");
    }
    assert_eq!(makes.len(), 10);
}

#[test]
fn no_two_records_have_one_name() {
    let recipes = makes::recipes(1);
    let names: std::collections::BTreeSet<_> = recipes.iter().map(|r| (r.table, &r.name)).collect();
    assert_eq!(names.len(), recipes.len());
}
