//! Bad records: good ones that something has happened to.
//!
//! Each is refused or `unexplained`, with its likely cause. At most five are of a kind. The good
//! record is an axis with two encoders and its compliance declared, or a rotary one; the other axis
//! is of the same kind and rate, with other masses and another motion.

use crate::bench::{rotary, scaled};
use crate::draw::Draw;
use crate::entry::{Entry, truth};
use crate::rig::Rig;
use crate::table::Table;
use crate::truth::{Effect, Verdict};

/// What happened.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    /// Two columns have each other's names.
    Swapped,
    /// A column is rows off.
    Shifted,
    /// A clock goes wrong.
    Clock,
    /// Records were put end to end.
    Concatenated,
    /// A unit factor.
    Unit,
    /// A unit factor in one of the two records.
    UnitOfOne,
    /// A sign.
    Sign,
    /// Cut off.
    Clipped,
    /// Sampled again.
    Resampled,
    /// Rows twice, or not at all.
    Duplicated,
    /// A column of another axis.
    OtherAxis,
    /// A column stands still.
    Frozen,
}

/// A bad record.
#[derive(Clone, Copy, Debug)]
pub struct Spoilt {
    /// Its name.
    pub name: &'static str,
    /// Its kind.
    pub kind: Kind,
    /// The likely cause.
    pub cause: &'static str,
    /// A name of the list that is right as well: a shift of a row or so is a delay.
    pub or_named: Option<Effect>,
    good: fn(&mut Draw) -> Rig,
    spoil: fn(&mut Entry, &Entry),
}

impl Spoilt {
    const fn rotary(mut self) -> Self {
        self.good = rotary;
        self
    }

    const fn or(mut self, effect: Effect) -> Self {
        self.or_named = Some(effect);
        self
    }

    /// The record of a seed.
    #[must_use]
    pub fn entry(&self, seed: u64) -> Entry {
        let mut entry = self.good_entry("this", seed);
        let other = self.good_entry("other", seed);
        (self.spoil)(&mut entry, &other);
        entry.truth.effects = self.or_named.into_iter().collect();
        entry.truth.verdict = Verdict::RefusedOrUnexplained;
        entry.truth.or_unexplained = true;
        entry.truth.cause = self.cause.into();
        entry
    }

    /// What it was before.
    #[must_use]
    pub fn good_entry(&self, which: &str, seed: u64) -> Entry {
        let rig = (self.good)(&mut Draw::of(which, seed));
        let truth = truth(self.name, "spoilt", &rig, &rig.base, &[]);
        Entry::of(self.name, &rig, truth, seed)
    }
}

const fn of(
    kind: Kind,
    name: &'static str,
    cause: &'static str,
    spoil: fn(&mut Entry, &Entry),
) -> Spoilt {
    Spoilt {
        name,
        kind,
        cause,
        or_named: None,
        good: scaled,
        spoil,
    }
}

/// Columns by the beginning of their names.
const TIME: &str = "time_s";
const REFERENCE: &str = "reference_";
const POSITION: &str = "position_";
const LOAD: &str = "load_position_";
const EFFORT: [&str; 3] = ["force_n", "torque_nm", "current_a"];

/// All of them.
#[rustfmt::skip]
pub const SPOILT: &[Spoilt] = &[
    of(Kind::Swapped, "swap-reference-position", "columns reference and position are swapped", |e, _| both(e, |t| swap(t, place(t, REFERENCE), place(t, POSITION)))),
    of(Kind::Swapped, "swap-position-load", "columns position and load position are swapped", |e, _| both(e, |t| swap(t, place(t, POSITION), place(t, LOAD)))),
    of(Kind::Swapped, "swap-reference-load", "columns reference and load position are swapped", |e, _| both(e, |t| swap(t, place(t, REFERENCE), place(t, LOAD)))),
    of(Kind::Swapped, "swap-position-effort", "columns position and effort are swapped", |e, _| both(e, |t| swap(t, place(t, POSITION), effort(t)))),
    of(Kind::Swapped, "swap-reference-effort", "columns reference and effort are swapped", |e, _| both(e, |t| swap(t, place(t, REFERENCE), effort(t)))),

    of(Kind::Shifted, "effort-late-1", "effort is one row late", |e, _| both(e, |t| shift(t, effort(t), 1))).or(Effect::LoggedLate),
    of(Kind::Shifted, "effort-early-1", "effort is one row early", |e, _| both(e, |t| shift(t, effort(t), -1))).or(Effect::Delay),
    of(Kind::Shifted, "effort-late-5", "effort is five rows late", |e, _| both(e, |t| shift(t, effort(t), 5))).or(Effect::LoggedLate),
    of(Kind::Shifted, "effort-late-50", "effort is fifty rows late", |e, _| both(e, |t| shift(t, effort(t), 50))).or(Effect::LoggedLate),
    of(Kind::Shifted, "load-late-5", "load position is five rows late", |e, _| both(e, |t| shift(t, place(t, LOAD), 5))),

    of(Kind::Clock, "effort-clock-fast", "the clock of the effort goes one percent fast", |e, _| both(e, |t| stretch(t, effort(t), 1.01))).rotary(),
    of(Kind::Clock, "effort-clock-slow", "the clock of the effort goes one percent slow", |e, _| both(e, |t| stretch(t, effort(t), 0.99))),
    of(Kind::Clock, "time-in-milliseconds", "time is in milliseconds", |e, _| both(e, |t| scale(t, place(t, TIME), 1000.0))),
    of(Kind::Clock, "time-doubled", "time goes at half the stated rate", |e, _| both(e, |t| scale(t, place(t, TIME), 2.0))),
    of(Kind::Clock, "load-clock-slow", "the clock of the load position goes slow", |e, _| both(e, |t| stretch(t, place(t, LOAD), 0.998))),

    of(Kind::Concatenated, "two-axes", "records of two axes end to end", |e, other| append(&mut e.train, &other.train)).rotary(),
    of(Kind::Concatenated, "two-axes-linear", "records of two axes end to end", |e, other| append(&mut e.train, &other.train)),
    of(Kind::Concatenated, "two-runs", "one run twice, end to end", |e, _| { let again = e.train.clone(); append(&mut e.train, &again); }),
    of(Kind::Concatenated, "forty-runs", "forty copies of half a second", |e, _| copies(&mut e.train, 500, 40)).rotary(),
    of(Kind::Concatenated, "backwards", "the second half runs backwards in time", |e, _| backwards(&mut e.train)),

    of(Kind::Unit, "position-in-millimetres", "position is in millimetres", |e, _| both(e, |t| scale(t, place(t, POSITION), 1000.0))),
    of(Kind::Unit, "load-in-millimetres", "load position is in millimetres", |e, _| both(e, |t| scale(t, place(t, LOAD), 1000.0))),
    of(Kind::Unit, "position-in-turns", "position is in turns, setpoint in radians", |e, _| both(e, |t| scale(t, place(t, POSITION), 1.0 / std::f64::consts::TAU))).rotary(),
    of(Kind::Unit, "position-by-lead", "position is in radians of the motor, not in metres", |e, _| both(e, |t| scale(t, place(t, POSITION), std::f64::consts::TAU / 0.01))),
    of(Kind::Unit, "load-by-gear", "load position lacks the gear ratio", |e, _| both(e, |t| scale(t, place(t, LOAD), 0.2))),

    of(Kind::UnitOfOne, "validation-effort-kilo", "effort of the validation record is off by a thousand", |e, _| validation(e, |t| scale(t, effort(t), 1000.0))),
    of(Kind::UnitOfOne, "validation-effort-by-2pi", "effort of the validation record is off by 2 pi", |e, _| validation(e, |t| scale(t, effort(t), std::f64::consts::TAU))).rotary(),
    of(Kind::UnitOfOne, "half-effort-by-lead", "effort changes its unit in mid-record", |e, _| scale_half(&mut e.train, 0.01)),
    of(Kind::UnitOfOne, "validation-position-by-gear", "positions of the validation record lack the gear ratio", |e, _| validation(e, |t| [POSITION, LOAD, REFERENCE].iter().for_each(|c| scale(t, place(t, c), 5.0)))),

    of(Kind::Sign, "effort-negative", "effort has the other sign", |e, _| both(e, |t| scale(t, effort(t), -1.0))),
    of(Kind::Sign, "position-negative", "position has the other sign", |e, _| both(e, |t| scale(t, place(t, POSITION), -1.0))).rotary(),
    of(Kind::Sign, "load-negative", "load position has the other sign", |e, _| both(e, |t| scale(t, place(t, LOAD), -1.0))),
    of(Kind::Sign, "reference-negative", "setpoint has the other sign", |e, _| both(e, |t| scale(t, place(t, REFERENCE), -1.0))),
    of(Kind::Sign, "validation-effort-negative", "effort of the validation record has the other sign", |e, _| validation(e, |t| scale(t, effort(t), -1.0))),

    of(Kind::Clipped, "effort-clipped", "effort is cut off at a third of its peak", |e, _| both(e, |t| clip(t, effort(t), -0.33, 0.33))),
    of(Kind::Clipped, "effort-rectified", "negative efforts are missing", |e, _| both(e, |t| clip(t, effort(t), 0.0, 1.0))).rotary(),
    of(Kind::Clipped, "position-clipped", "position is cut off in mid-range", |e, _| both(e, |t| clip(t, place(t, POSITION), -0.4, 0.4))),
    of(Kind::Clipped, "position-wrapped", "position wraps around", |e, _| both(e, |t| wrap(t, place(t, POSITION), 1.0))).rotary(),

    of(Kind::Resampled, "effort-held", "effort is sampled at 20 Hz and held", |e, _| both(e, |t| hold(t, effort(t), 50))),
    of(Kind::Resampled, "position-held", "position is sampled at 50 Hz and held", |e, _| both(e, |t| hold(t, place(t, POSITION), 20))),
    of(Kind::Resampled, "position-lines", "position is interpolated from 10 Hz", |e, _| both(e, |t| lines(t, place(t, POSITION), 100))).rotary(),
    of(Kind::Resampled, "effort-averaged", "effort is a mean of the last fifty rows", |e, _| both(e, |t| average(t, effort(t), 50))),
    of(Kind::Resampled, "load-held", "load position is sampled at 25 Hz and held", |e, _| both(e, |t| hold(t, place(t, LOAD), 40))),

    of(Kind::Duplicated, "rows-twice", "every row stands twice, with its time", |e, _| both(e, |t| twice(t, 1))),
    of(Kind::Duplicated, "tenth-row-twice", "every tenth row stands twice and time was counted anew", |e, _| both(e, |t| { twice(t, 10); count_time(t); })),
    of(Kind::Duplicated, "block-twice", "two seconds stand twice and time was counted anew", |e, _| repeat_block(&mut e.train)),
    of(Kind::Duplicated, "rows-missing", "every seventh row is missing and time was counted anew", |e, _| both(e, |t| { keep(t, |row| row % 7 != 3); count_time(t); })).rotary(),

    of(Kind::OtherAxis, "other-reference", "the setpoint is another axis'", |e, other| take(e, other, REFERENCE)),
    of(Kind::OtherAxis, "other-position", "the position is another axis'", |e, other| take(e, other, POSITION)),
    of(Kind::OtherAxis, "other-load", "the load position is another axis'", |e, other| take(e, other, LOAD)),
    of(Kind::OtherAxis, "other-effort", "the effort is another axis'", |e, other| take(e, other, EFFORT[1])).rotary(),
    of(Kind::OtherAxis, "other-validation", "the validation record is another axis'", |e, other| e.validate = other.validate.clone()),

    of(Kind::Frozen, "effort-frozen", "effort stands still from the middle on", |e, _| training(e, |t| freeze(t, effort(t)))),
    of(Kind::Frozen, "position-frozen", "position stands still from the middle on", |e, _| training(e, |t| freeze(t, place(t, POSITION)))),
    of(Kind::Frozen, "load-frozen", "load position stands still from the middle on", |e, _| training(e, |t| freeze(t, place(t, LOAD)))),
];

fn both(entry: &mut Entry, spoil: impl Fn(&mut Table)) {
    training(entry, &spoil);
    validation(entry, &spoil);
}

fn training(entry: &mut Entry, spoil: impl Fn(&mut Table)) {
    spoil(&mut entry.train);
}

fn validation(entry: &mut Entry, spoil: impl Fn(&mut Table)) {
    spoil(&mut entry.validate);
}

/// Place of a column; the good records have those that are asked for.
fn place(table: &Table, name: &str) -> usize {
    table.place(name).expect("a good record has this column")
}

fn effort(table: &Table) -> usize {
    let mut places = EFFORT.iter().filter_map(|name| table.place(name));
    places.next().expect("a good record has an effort")
}

fn swap(table: &mut Table, a: usize, b: usize) {
    let values = std::mem::take(&mut table.columns[a].values);
    table.columns[a].values = std::mem::replace(&mut table.columns[b].values, values);
    let decimals = table.columns[a].decimals.max(table.columns[b].decimals);
    table.columns[a].decimals = decimals;
    table.columns[b].decimals = decimals;
}

/// Later by so many rows; the first or last value stands where there is none.
fn shift(table: &mut Table, column: usize, rows: isize) {
    let old = table.columns[column].values.clone();
    let last = old.len() as isize - 1;
    for (row, value) in table.columns[column].values.iter_mut().enumerate() {
        *value = old[(row as isize - rows).clamp(0, last) as usize];
    }
}

fn scale(table: &mut Table, column: usize, factor: f64) {
    table.columns[column]
        .values
        .iter_mut()
        .for_each(|value| *value *= factor);
}

/// Read with a clock that goes so much faster.
fn stretch(table: &mut Table, column: usize, factor: f64) {
    let old = table.columns[column].values.clone();
    for (row, value) in table.columns[column].values.iter_mut().enumerate() {
        let at = (row as f64 * factor).round() as usize;
        *value = old[at.min(old.len() - 1)];
    }
}

/// End to end; time goes on.
fn append(table: &mut Table, next: &Table) {
    let time = place(table, TIME);
    let stamps = &table.columns[time].values;
    let (rows, step) = (stamps.len(), stamps[1] - stamps[0]);
    let begin = stamps[rows - 1] + step - next.columns[time].values[0];
    for (column, more) in table.columns.iter_mut().zip(&next.columns) {
        let is_time = column.name == TIME;
        let offset = if is_time { begin } else { 0.0 };
        column
            .values
            .extend(more.values.iter().map(|value| value + offset));
    }
}

fn copies(table: &mut Table, rows: usize, count: usize) {
    // From three seconds on the axis moves.
    keep(table, |row| (3000..3000 + rows).contains(&row));
    let one = table.clone();
    (1..count).for_each(|_| append(table, &one));
    count_time(table);
}

fn backwards(table: &mut Table) {
    let middle = table.rows() / 2;
    for column in table
        .columns
        .iter_mut()
        .filter(|column| column.name != TIME)
    {
        column.values[middle..].reverse();
    }
}

fn scale_half(table: &mut Table, factor: f64) {
    let column = effort(table);
    let middle = table.rows() / 2;
    let values = &mut table.columns[column].values[middle..];
    for value in values {
        *value *= factor;
    }
}

/// Cut off at shares of the largest value.
fn clip(table: &mut Table, column: usize, low: f64, high: f64) {
    let values = &mut table.columns[column].values;
    let most = values.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
    for value in values {
        *value = value.clamp(low * most, high * most);
    }
}

fn wrap(table: &mut Table, column: usize, range: f64) {
    let values = &mut table.columns[column].values;
    for value in values {
        *value -= range * (*value / range).round();
    }
}

fn hold(table: &mut Table, column: usize, rows: usize) {
    let old = table.columns[column].values.clone();
    for (row, value) in table.columns[column].values.iter_mut().enumerate() {
        *value = old[row - row % rows];
    }
}

fn lines(table: &mut Table, column: usize, rows: usize) {
    let old = table.columns[column].values.clone();
    for (row, value) in table.columns[column].values.iter_mut().enumerate() {
        let (from, share) = (row - row % rows, (row % rows) as f64 / rows as f64);
        let to = (from + rows).min(old.len() - 1);
        *value = old[from] + share * (old[to] - old[from]);
    }
}

fn average(table: &mut Table, column: usize, rows: usize) {
    let old = table.columns[column].values.clone();
    for (row, value) in table.columns[column].values.iter_mut().enumerate() {
        let part = &old[(row + 1).saturating_sub(rows)..=row];
        *value = part.iter().sum::<f64>() / part.len() as f64;
    }
}

/// Every n-th row twice.
fn twice(table: &mut Table, every: usize) {
    for column in &mut table.columns {
        let old = std::mem::take(&mut column.values);
        for (row, value) in old.into_iter().enumerate() {
            let times = if row % every == 0 { 2 } else { 1 };
            column.values.extend(std::iter::repeat_n(value, times));
        }
    }
}

fn keep(table: &mut Table, wanted: impl Fn(usize) -> bool) {
    for column in &mut table.columns {
        let mut row = 0;
        column.values.retain(|_| {
            row += 1;
            wanted(row - 1)
        });
    }
}

/// Even stamps of a millisecond from zero.
fn count_time(table: &mut Table) {
    let time = place(table, TIME);
    for (row, value) in table.columns[time].values.iter_mut().enumerate() {
        *value = row as f64 * 1.0e-3;
    }
}

fn repeat_block(table: &mut Table) {
    let mut block = table.clone();
    keep(&mut block, |row| (5000..7000).contains(&row));
    let mut rest = table.clone();
    keep(table, |row| row < 7000);
    keep(&mut rest, |row| row >= 7000);
    append(table, &block);
    append(table, &rest);
    count_time(table);
}

/// A column of another axis, in both records.
fn take(entry: &mut Entry, other: &Entry, name: &str) {
    for (table, from) in [
        (&mut entry.train, &other.train),
        (&mut entry.validate, &other.validate),
    ] {
        let column = place(table, name);
        let rows = table.rows().min(from.rows());
        keep(table, |row| row < rows);
        let values = &from.columns[place(from, name)].values[..rows];
        table.columns[column].values = values.to_vec();
    }
}

fn freeze(table: &mut Table, column: usize) {
    let middle = table.rows() / 2;
    let values = &mut table.columns[column].values;
    let stuck = values[middle];
    values[middle..].fill(stuck);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::table::Column;
    use std::collections::{BTreeMap, BTreeSet};

    /// Two columns of ten rows: time, and the row as effort.
    fn table() -> Table {
        let column = |name: &str, step: f64| Column {
            name: name.into(),
            decimals: 3,
            values: (0..10).map(|row| step * f64::from(row)).collect(),
        };
        Table {
            columns: vec![column("time_s", 1.0e-3), column("force_n", 1.0)],
        }
    }

    fn after(spoil: impl Fn(&mut Table)) -> Vec<f64> {
        let mut table = table();
        spoil(&mut table);
        table.columns[1].values.clone()
    }

    #[test]
    fn there_are_forty_and_more_and_at_most_five_of_a_kind() {
        assert!(SPOILT.len() >= 40);
        let mut kinds = BTreeMap::new();
        for bad in SPOILT {
            *kinds.entry(bad.kind).or_insert(0) += 1;
        }
        assert!(kinds.values().all(|count| *count <= 5), "{kinds:?}");
        let names: BTreeSet<&str> = SPOILT.iter().map(|bad| bad.name).collect();
        assert_eq!(names.len(), SPOILT.len());
    }

    #[test]
    fn a_shift_moves_later_and_a_negative_one_earlier() {
        assert_eq!(after(|t| shift(t, 1, 2))[5], 3.0);
        assert_eq!(after(|t| shift(t, 1, -2))[5], 7.0);
        assert_eq!(after(|t| shift(t, 1, 2))[0], 0.0);
    }

    #[test]
    fn a_held_column_has_steps_and_lines_go_through_them() {
        assert_eq!(after(|t| hold(t, 1, 4))[7], 4.0);
        assert_eq!(after(|t| lines(t, 1, 4))[6], 6.0);
        assert_eq!(after(|t| average(t, 1, 3))[6], 5.0);
        assert_eq!(after(|t| stretch(t, 1, 0.5))[8], 4.0);
    }

    #[test]
    fn rows_stand_twice_or_are_gone() {
        assert_eq!(after(|t| twice(t, 1))[..4], [0.0, 0.0, 1.0, 1.0]);
        assert_eq!(
            after(|t| keep(t, |row| row % 2 == 1)),
            [1.0, 3.0, 5.0, 7.0, 9.0]
        );
    }

    #[test]
    fn what_is_appended_goes_on_in_time() {
        let mut table = table();
        append(&mut table, &super::tests::table());
        let time = table.column("time_s").unwrap();
        assert!(
            time.windows(2)
                .all(|pair| (pair[1] - pair[0] - 1.0e-3).abs() < 1.0e-9)
        );
        assert_eq!(table.column("force_n").unwrap()[10], 0.0);
    }

    #[test]
    fn cuts_and_wraps_are_at_their_limits() {
        assert_eq!(after(|t| clip(t, 1, 0.0, 0.5))[9], 4.5);
        assert_eq!(after(|t| wrap(t, 1, 4.0))[3], -1.0);
        assert_eq!(after(|t| freeze(t, 1))[9], 5.0);
    }

    #[test]
    fn every_bad_record_differs_from_its_good_one() {
        for bad in SPOILT.iter().step_by(9) {
            let (entry, good) = (bad.entry(1), bad.good_entry("this", 1));
            let same = entry.train == good.train && entry.validate == good.validate;
            assert!(!same, "{}", bad.name);
        }
    }
}
