//! Each effect of an unseen make shows in its record by itself: nobody can be asked for the name of
//! what drowns in noise.
//!
//! Over windows of two milliseconds or a row the recorded effort is compared with inertia, viscous
//! friction and whatever else is declared of Coulomb friction and a constant force, by the true
//! motion of the run. What these leave on the machine with one effect alone is put beside what they
//! leave on the machine without any. An effect between motor and load shows in their distance.
//!
//! Of a make of a later table (untried, unmet, unforeseen, unexpected, unsought, families) more is
//! asked: an effect shows in the validation record as in the training record, what is left with it
//! is half as much again as what is left without it, and no two effects of a make leave the same.

use makes::draw::Draw;
use makes::make::{
    Make, Presence, families, unexpected, unforeseen, unmet, unseen, unsought, untried,
};
use makes::motion::Motion;
use makes::rig::Rig;
use makes::sensing::{Source, Trace};
use makes::table::Table;
use makes::truth::Effect;
use nalgebra::{DMatrix, DVector};
use scope::{Scope, on_all_cores};

/// Windows, s: as short as a delay of a millisecond needs them.
const WINDOW_S: f64 = 2.0e-3;
/// A window in which it stands still says nothing of friction: share of the largest velocity.
const STANDS: f64 = 1.0e-3;
/// An effect takes this share of what is left without its name.
const SHARE_OF_LEFT: f64 = 0.05;
/// And so much of the effort's deviation.
const SHARE_OF_EFFORT: f64 = 0.005;
/// Growth of the distance between motor and load, in counts of the load's scale.
const COUNTS: f64 = 5.0;

/// An effect of a make of a later table takes this share of what is left without its name: a factor
/// of one and a half.
const UNTRIED_SHARE_OF_LEFT: f64 = 1.0 / 3.0;
/// Cosine of what two effects of a make leave.
const ALIKE: f64 = 0.75;

/// What a record leaves of its declared model, the effort, and the distance of motor and load.
#[derive(Clone, Copy, Debug)]
struct Seen {
    left: f64,
    effort: f64,
    counts: f64,
}

fn deviation(values: &[f64]) -> f64 {
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    let square = |v: &f64| (v - mean) * (v - mean);
    (values.iter().map(square).sum::<f64>() / values.len() as f64).sqrt()
}

/// What is seen in the record of a motion, and what each of its windows leaves.
fn seen_of(rig: &Rig, motion: &(Motion, f64)) -> (Seen, Vec<Option<f64>>) {
    let trace = rig.run(motion);
    let table = rig.table(motion, &mut Draw::of("unseen", 1));
    let per_effort = rig.column.per_effort();
    let recorded = table.column(rig.column.name()).expect("an effort");
    let effort: Vec<f64> = recorded.iter().map(|e| e / per_effort).collect();
    let windows = windows(rig, &trace, &table, &effort);
    let rows: Vec<Vec<f64>> = windows.iter().flatten().cloned().collect();
    let (left, remains) = left(&rows);
    let mut remains = remains.into_iter();
    let each = windows
        .iter()
        .map(|row| row.as_ref().and_then(|_| remains.next()));
    let seen = Seen {
        left,
        effort: deviation(&effort),
        counts: counts(rig, &table),
    };
    (seen, each.collect())
}

fn seen(rig: &Rig) -> Seen {
    seen_of(rig, &rig.training).0
}

fn counts(rig: &Rig, table: &Table) -> f64 {
    let unit = rig.kind.position_unit();
    let column = |name: &str| table.column(&format!("{name}_{unit}"));
    let (Some(motor), Some(load), Some(scale)) = (
        column("position"),
        column("load_position"),
        &rig.sensing.load,
    ) else {
        return 0.0;
    };
    let between: Vec<f64> = motor.iter().zip(load).map(|(m, l)| m - l).collect();
    deviation(&between) / scale.resolution
}

/// Rows of what is declared, and the effort; nothing where it stands still.
fn windows(rig: &Rig, trace: &Trace, table: &Table, effort: &[f64]) -> Vec<Option<Vec<f64>>> {
    let times = table.column("time_s").expect("a time");
    let steps: Vec<usize> = times
        .iter()
        .map(|t| (t / trace.step_s).round() as usize)
        .collect();
    let count = ((WINDOW_S / rig.row_s()).round() as usize).max(1);
    let fastest = trace.velocity.iter().fold(0.0_f64, |m, v| v.abs().max(m));
    let window = |row: usize| {
        let (from, to) = (steps[row], steps[row + count]);
        let velocities = &trace.velocity[from..to];
        let mean = |of: fn(f64) -> f64| {
            velocities.iter().map(|v| of(*v)).sum::<f64>() / velocities.len() as f64
        };
        let time_s = (to - from) as f64 * trace.step_s;
        let mut columns = vec![
            (trace.velocity[to] - trace.velocity[from]) / time_s,
            mean(|v| v),
        ];
        let has = |effect| rig.base.contains(&effect);
        columns.extend(has(Effect::Coulomb).then(|| mean(sign)));
        columns.extend(has(Effect::Offset).then_some(1.0));
        columns.push(held(rig.sensing.effort.source, &effort[row..=row + count]));
        (mean(f64::abs) > STANDS * fastest).then_some(columns)
    };
    let rows = (0..steps.len() - count).step_by(count);
    rows.map(window).collect()
}

fn sign(velocity: f64) -> f64 {
    if velocity == 0.0 {
        0.0
    } else {
        velocity.signum()
    }
}

/// Mean effort from the first row to the last: a command holds, a current is a value of its time.
fn held(source: Source, rows: &[f64]) -> f64 {
    let count = (rows.len() - 1) as f64;
    let held = rows[..rows.len() - 1].iter().sum::<f64>() / count;
    match source {
        Source::Command => held,
        Source::Current => held + 0.5 * (rows[rows.len() - 1] - rows[0]) / count,
    }
}

/// Deviation of what is left of the effort, and what is left of each row.
fn left(rows: &[Vec<f64>]) -> (f64, Vec<f64>) {
    let width = rows[0].len() - 1;
    let columns = DMatrix::from_fn(rows.len(), width, |row, column| rows[row][column]);
    let effort = DVector::from_iterator(rows.len(), rows.iter().map(|row| row[width]));
    let found = columns.clone().svd(true, true).solve(&effort, 1.0e-14);
    let found = found.expect("both sides of the decomposition were asked for");
    let remains = &effort - columns * found;
    let left = remains.norm() / (rows.len() as f64).sqrt();
    (left, remains.iter().copied().collect())
}

/// How much of an effect shows: of what is left with it, of the effort, and in counts.
#[derive(Debug)]
struct Shown {
    of_left: f64,
    of_effort: f64,
    counts: f64,
}

impl Shown {
    fn of(alone: Seen, without: Seen) -> Self {
        let grown = |now: f64, before: f64| (now * now - before * before).max(0.0).sqrt();
        Self {
            of_left: 1.0 - without.left / alone.left,
            of_effort: grown(alone.left, without.left) / alone.effort,
            counts: grown(alone.counts, without.counts),
        }
    }

    fn is_clear(&self, share_of_left: f64) -> bool {
        let in_effort = self.of_left > share_of_left && self.of_effort > SHARE_OF_EFFORT;
        in_effort || self.counts > COUNTS
    }
}

fn each_alone(make: &Make) -> Vec<Shown> {
    let without = seen(&make.rig(Presence::Absent, 1));
    let alone = |effect: &Effect| seen(&make.rig(Presence::Only(*effect), 1));
    let hides = make.hides.iter();
    hides.map(|e| Shown::of(alone(e), without)).collect()
}

#[test]
fn each_effect_of_an_unseen_make_shows_by_itself() {
    let makes = unseen();
    let some = Scope::now().spread("unseen makes, effect by effect", &makes, 1, 2);
    let all = on_all_cores(&some, |make| each_alone(make));
    for (make, each) in some.iter().zip(all) {
        for (effect, shown) in make.hides.iter().zip(each) {
            println!("{} {effect:?}: {shown:?}", make.name);
            assert!(
                shown.is_clear(SHARE_OF_LEFT),
                "{} {effect:?}: {shown:?}",
                make.name
            );
        }
    }
}

/// Cosine of what two records leave, window by window; windows that only one of them has are left
/// out.
fn cosine(a: &[Option<f64>], b: &[Option<f64>]) -> f64 {
    let pairs: Vec<(f64, f64)> = a.iter().zip(b).filter_map(|(a, b)| a.zip(*b)).collect();
    let sum = |of: fn(&(f64, f64)) -> f64| pairs.iter().map(of).sum::<f64>();
    sum(|(a, b)| a * b) / (sum(|(a, _)| a * a) * sum(|(_, b)| b * b)).sqrt()
}

/// What each effect of a make shows alone, and how alike two of them are at most.
fn shown_and_alike(make: &Make, motion: fn(&Rig) -> &(Motion, f64)) -> (Vec<Shown>, f64) {
    let seen = |presence| {
        let rig = make.rig(presence, 1);
        seen_of(&rig, motion(&rig))
    };
    let (without, _) = seen(Presence::Absent);
    let alone: Vec<_> = make
        .hides
        .iter()
        .map(|e| seen(Presence::Only(*e)))
        .collect();
    let shown = alone.iter().map(|(alone, _)| Shown::of(*alone, without));
    let others = |n: usize| alone[n + 1..].iter().map(|(_, each)| each);
    let alike = alone.iter().enumerate().flat_map(|(n, (_, each))| {
        others(n)
            .map(|other| cosine(each, other).abs())
            .collect::<Vec<_>>()
    });
    (shown.collect(), alike.fold(0.0, f64::max))
}

/// Asks of makes of a table that each effect shows in both records and is like no other.
fn assert_each_shows_in_both_records_and_is_like_no_other(table: &str, makes: &[Make]) {
    let rows = format!("{table} makes, effect by effect");
    let some = Scope::now().spread(&rows, makes, 1, 2);
    let all = on_all_cores(&some, |make| {
        [
            shown_and_alike(make, |rig| &rig.training),
            shown_and_alike(make, |rig| &rig.validation),
        ]
    });
    for (make, records) in some.iter().zip(all) {
        for (shown, alike) in records {
            println!("{}: cosine {alike:.2}", make.name);
            assert!(alike < ALIKE, "{}: {alike}", make.name);
            for (effect, shown) in make.hides.iter().zip(shown) {
                println!("  {effect:?}: {shown:?}");
                let is_clear = shown.is_clear(UNTRIED_SHARE_OF_LEFT);
                assert!(is_clear, "{} {effect:?}: {shown:?}", make.name);
            }
        }
    }
}

#[test]
fn each_effect_of_an_untried_make_shows_in_both_records_and_is_like_no_other() {
    assert_each_shows_in_both_records_and_is_like_no_other("untried", &untried());
}

#[test]
fn each_effect_of_an_unmet_make_shows_in_both_records_and_is_like_no_other() {
    assert_each_shows_in_both_records_and_is_like_no_other("unmet", &unmet());
}

#[test]
fn each_effect_of_an_unforeseen_make_shows_in_both_records_and_is_like_no_other() {
    assert_each_shows_in_both_records_and_is_like_no_other("unforeseen", &unforeseen());
}

#[test]
fn each_effect_of_an_unexpected_make_shows_in_both_records_and_is_like_no_other() {
    assert_each_shows_in_both_records_and_is_like_no_other("unexpected", &unexpected());
}

#[test]
fn each_effect_of_an_unsought_make_shows_in_both_records_and_is_like_no_other() {
    assert_each_shows_in_both_records_and_is_like_no_other("unsought", &unsought());
}

#[test]
fn each_effect_of_a_make_of_the_families_shows_in_both_records_and_is_like_no_other() {
    assert_each_shows_in_both_records_and_is_like_no_other("families", &families());
}
