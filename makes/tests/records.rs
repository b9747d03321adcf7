//! What holds of every record, whatever is judged on it.

use makes::draw::Draw;
use makes::make::{Form, Presence, all};
use makes::motion::Motion;
use makes::outside::OUTSIDE;
use makes::rig::{Kind, Rig};
use makes::table::Table;
use scope::{Scope, on_all_cores};

fn rms(values: impl Iterator<Item = f64>) -> f64 {
    let (count, sum) = values.fold((0.0, 0.0), |(n, s), v| (n + 1.0, s + v * v));
    (sum / f64::max(count, 1.0)).sqrt()
}

#[test]
fn every_controller_follows() {
    for make in all() {
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
    let makes = all();
    let rows = Scope::now().rows("makes", &makes, 4, 12);
    let changed = on_all_cores(rows, |make| {
        let table = |presence| training(&make.rig(presence, 1));
        change(&table(Presence::Present), &table(Presence::Absent))
    });
    for (make, changed) in rows.iter().zip(changed) {
        assert!(changed > 0.02, "{}: {:.2} %", make.name, 100.0 * changed);
    }
}

#[test]
fn every_disturbance_outside_the_list_changes_the_record() {
    let rows = Scope::now().rows("disturbances", OUTSIDE, 4, 12);
    let changed = on_all_cores(rows, |outside| {
        change(&training(&outside.rig(1)), &training(&outside.good_rig(1)))
    });
    for (outside, changed) in rows.iter().zip(changed) {
        assert!(changed > 0.05, "{}: {:.2} %", outside.name, 100.0 * changed);
    }
}

#[test]
fn a_record_is_what_its_dataset_file_says() {
    for make in all() {
        let mut rig = make.rig(Presence::Present, 1);
        rig.training.1 = 2.0;
        rig.validation.1 = 1.0;
        let table = rig.table(&rig.training, &mut Draw::of("table", 1));
        let unit = if rig.kind == Kind::Linear { "m" } else { "rad" };
        let position = table.column(&format!("position_{unit}")).expect(make.name);
        let count = rig.sensing.motor.resolution;
        let off = |x: &f64| (x / count - (x / count).round()).abs();
        assert!(position.iter().all(|x| off(x) < 1.0e-3), "{}", make.name);
        assert_eq!(
            table.column("time_s").map(|t| t[1]),
            Some(rig.row_s()),
            "{}",
            make.name
        );
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
