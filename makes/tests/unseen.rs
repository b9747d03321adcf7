//! Each effect of an unseen make shows in its record by itself: nobody can be asked for the name of
//! what drowns in noise.
//!
//! Over windows of two milliseconds or a row the recorded effort is compared with inertia, viscous
//! friction and whatever else is declared of Coulomb friction and a constant force, by the true
//! motion of the run. What these leave on the machine with one effect alone is put beside what they
//! leave on the machine without any. An effect between motor and load shows in their distance.

use makes::draw::Draw;
use makes::make::{Make, Presence, unseen};
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

fn seen(rig: &Rig) -> Seen {
    let trace = rig.run(&rig.training);
    let table = rig.table(&rig.training, &mut Draw::of("unseen", 1));
    let per_effort = rig.column.per_effort();
    let recorded = table.column(rig.column.name()).expect("an effort");
    let effort: Vec<f64> = recorded.iter().map(|e| e / per_effort).collect();
    Seen {
        left: left(&windows(rig, &trace, &table, &effort)),
        effort: deviation(&effort),
        counts: counts(rig, &table),
    }
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

/// Rows of what is declared, and the effort.
fn windows(rig: &Rig, trace: &Trace, table: &Table, effort: &[f64]) -> Vec<Vec<f64>> {
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
    rows.filter_map(window).collect()
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

fn left(rows: &[Vec<f64>]) -> f64 {
    let width = rows[0].len() - 1;
    let columns = DMatrix::from_fn(rows.len(), width, |row, column| rows[row][column]);
    let effort = DVector::from_iterator(rows.len(), rows.iter().map(|row| row[width]));
    let found = columns.clone().svd(true, true).solve(&effort, 1.0e-14);
    let found = found.expect("both sides of the decomposition were asked for");
    (&effort - columns * found).norm() / (rows.len() as f64).sqrt()
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

    fn is_clear(&self) -> bool {
        let in_effort = self.of_left > SHARE_OF_LEFT && self.of_effort > SHARE_OF_EFFORT;
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
    let some = Scope::now().spread("unseen makes, effect by effect", &makes, 1, 6);
    let all = on_all_cores(&some, |make| each_alone(make));
    for (make, each) in some.iter().zip(all) {
        for (effect, shown) in make.hides.iter().zip(each) {
            println!("{} {effect:?}: {shown:?}", make.name);
            assert!(shown.is_clear(), "{} {effect:?}: {shown:?}", make.name);
        }
    }
}
