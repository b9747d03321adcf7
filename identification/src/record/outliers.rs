//! Outliers: rows whose effort or position nothing in the motion answers. They are found before any
//! filter, because a low-pass spreads one bad row over twenty good ones.
//!
//! Two questions are asked of a row, in this order.
//!
//! **Does it stand out?** ([`excursion`]) It leaves what the rows on either side allow, and comes
//! back within five rows. A step does not come back: a Coulomb reversal, a step of torque and a
//! stiction release are none of these. Neither is a kink of the path, where a body meets another.
//!
//! **Could it have happened?** ([`balance`]) A controller with feedforward makes impulses of one
//! row where its setpoint has a corner, and they are real: the axis answers with a step of its
//! velocity. So the momentum about the row is balanced, `Σ u dt = M Δv + friction`, with the row
//! and without it. Where it balances only without, the effort was not there. A position is no
//! motion where the largest effort about it cannot move the mass so far in the time.
//!
//! What fails both is replaced on a line between its neighbours and marked like a hole, so that no
//! fit sees it. What cannot be judged is kept: where the mass is not known, or the row is too small
//! for the noise of the balance.

mod balance;
mod excursion;

use std::ops::Range;

use crate::record::outliers::balance::Balance;
use crate::record::outliers::excursion::{Excursion, excursions};
use crate::record::time_base::Rows;

/// More rows than this share stand out by the nature of the axis or of its drive, and are no
/// outliers. It is half of what the scale of an excursion leaves above it.
const MOST: f64 = 0.005;

/// The outliers of one column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Outliers {
    /// Column, in words.
    pub column: &'static str,
    /// How many there are: a run of rows is one.
    pub count: usize,
    /// Whether they were left out: they were not where there are too many.
    pub left_out: bool,
}

impl Outliers {
    /// In one sentence.
    pub(crate) fn words(&self, what: &str) -> String {
        let Self { column, count, .. } = self;
        let s = if *count == 1 { "" } else { "s" };
        let what_is_done = if self.left_out {
            "left out: effort and motion do not go together there"
        } else {
            "are too many to be left out: effort and motion do not go together there; check the sensor and the log"
        };
        format!("{count} outlier{s} in the {column} {what_is_done} ({what} record)")
    }
}

/// Which column of the rows.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Column {
    Position,
    Load,
    Effort,
}

/// Both positions first, because the balance of the effort stands on them.
const COLUMNS: [Column; 3] = [Column::Position, Column::Load, Column::Effort];

impl Column {
    const fn words(self) -> &'static str {
        match self {
            Self::Position => "position",
            Self::Load => "load position",
            Self::Effort => "effort",
        }
    }

    fn of(self, rows: &Rows) -> Option<&[f64]> {
        match self {
            Self::Position => Some(&rows.position),
            Self::Load => rows.load.as_deref(),
            Self::Effort => Some(&rows.effort),
        }
    }

    fn of_mut(self, rows: &mut Rows) -> Option<&mut Vec<f64>> {
        match self {
            Self::Position => Some(&mut rows.position),
            Self::Load => rows.load.as_mut(),
            Self::Effort => Some(&mut rows.effort),
        }
    }
}

/// Finds the outliers of a file's rows, bridges them and marks them. What was found, by column.
pub(crate) fn leave_out(rows: &mut Rows, moving_velocity: f64) -> Vec<Outliers> {
    let standing_out = COLUMNS.map(|column| {
        let values = column.of(rows);
        values.map_or_else(Vec::new, |values| excursions(&rows.time_s, values))
    });
    if standing_out.iter().all(Vec::is_empty) {
        return Vec::new();
    }
    let mut found = [const { Vec::new() }; 3];
    let mut mended = rows.clone();
    // A bad effort lets a bad position look possible: so once more, with the effort mended.
    for _ in 0..2 {
        for ((column, excursions), found) in COLUMNS.into_iter().zip(&standing_out).zip(&mut found)
        {
            let more = impossible(
                &mended,
                column,
                excursions,
                found,
                (&standing_out, moving_velocity),
            );
            mend(&mut mended, column, &more);
            found.extend(more);
        }
    }
    let pairs = COLUMNS.into_iter().zip(found);
    pairs
        .filter_map(|(column, runs)| said(rows, column, &runs))
        .collect()
}

/// The excursions of a column that cannot have happened and were not found before.
fn impossible(
    rows: &Rows,
    column: Column,
    excursions: &[Excursion],
    known: &[Range<usize>],
    (standing_out, moving_velocity): (&[Vec<Excursion>; 3], f64),
) -> Vec<Range<usize>> {
    let open = |one: &&Excursion| !known.contains(&one.rows);
    if !excursions.iter().any(|one| open(&one)) {
        return Vec::new();
    }
    let balance = Balance::of(rows, &standing_out.concat(), moving_velocity);
    let cannot = |one: &&Excursion| match column {
        Column::Effort => balance.has_no_such_effort(rows, one),
        Column::Position | Column::Load => balance.has_no_such_motion(rows, one),
    };
    let open = excursions.iter().filter(open).filter(cannot);
    open.map(|one| one.rows.clone()).collect()
}

/// Puts runs of rows of a column on lines between their neighbours.
fn mend(rows: &mut Rows, column: Column, runs: &[Range<usize>]) {
    let time_s = std::mem::take(&mut rows.time_s);
    if let Some(values) = column.of_mut(rows) {
        for run in runs {
            let (before, after) = (run.start - 1, run.end);
            let slope = (values[after] - values[before]) / (time_s[after] - time_s[before]);
            for row in run.clone() {
                values[row] = values[before] + slope * (time_s[row] - time_s[before]);
            }
        }
    }
    rows.time_s = time_s;
}

/// What is said of the outliers of a column, which are bridged and marked if they are few.
fn said(rows: &mut Rows, column: Column, runs: &[Range<usize>]) -> Option<Outliers> {
    let of_runs: usize = runs.iter().map(Range::len).sum();
    let left_out = of_runs as f64 <= MOST * rows.time_s.len() as f64;
    if left_out {
        mend(rows, column, runs);
        for run in runs {
            rows.left_out[run.clone()].fill(true);
        }
    }
    let count = runs.len();
    (count > 0).then_some(Outliers {
        column: column.words(),
        count,
        left_out,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const ROWS: usize = 8000;
    const PERIOD_S: f64 = 1.0e-3;

    /// A triangle with corners, where the feedforward gives an impulse of one row; with rests.
    fn setpoint(row: usize) -> f64 {
        let t = row as f64 * PERIOD_S;
        let turn = t.rem_euclid(2.0);
        0.03 * (turn.min(2.0 - turn) - 0.1).clamp(0.0, 0.7)
    }

    /// 60 kg with 40 N and 150 N s/m under a controller with feedforward, sampled at 1 kHz by an
    /// encoder of 0.1 µm.
    fn axis() -> Rows {
        let (mut x, mut v, mut sum) = (0.0, 0.0_f64, 0.0);
        let (mut position, mut effort) = (Vec::new(), Vec::new());
        let count = |x: f64| 1.0e-7 * (x / 1.0e-7).round();
        let mut last = 0.0;
        for row in 0..ROWS {
            let [before, at, after] = [row.max(1) - 1, row, row + 1].map(setpoint);
            let velocity = (count(x) - last) / PERIOD_S;
            last = count(x);
            let lag = at - last;
            sum += lag * PERIOD_S;
            let ahead = 60.0 * (after - 2.0 * at + before) / PERIOD_S.powi(2);
            let u = ahead
                + 4.0e5 * lag
                + 4.0e6 * sum
                + 6000.0 * ((after - before) / (2.0 * PERIOD_S) - velocity);
            position.push(last);
            effort.push(u + 0.5 * (row as f64 * 12.9898).sin());
            for _ in 0..10 {
                let friction = 40.0 * (v / 1.0e-4).tanh() + 150.0 * v;
                v += 1.0e-4 * (u - friction) / 60.0;
                x += 1.0e-4 * v;
            }
        }
        Rows {
            time_s: (0..ROWS).map(|row| PERIOD_S * row as f64).collect(),
            load: Some(position.iter().map(|x| x - 2.0e-5).collect()),
            velocity: None,
            reference: None,
            left_out: vec![false; ROWS],
            position,
            effort,
        }
    }

    fn found(rows: &mut Rows) -> Vec<(&'static str, usize)> {
        let outliers = leave_out(rows, 1.0e-3);
        assert!(outliers.iter().all(|one| one.left_out));
        outliers.iter().map(|one| (one.column, one.count)).collect()
    }

    #[test]
    fn impulses_that_the_axis_answers_are_no_outliers() {
        let mut rows = axis();
        let standing_out = excursions(&rows.time_s, &rows.effort);
        assert!(standing_out.len() >= 8, "{standing_out:?}");
        assert_eq!(found(&mut rows), []);
        assert!(!rows.left_out.contains(&true));
    }

    #[test]
    fn spikes_in_each_column_are_counted_bridged_and_marked() {
        let clean = axis();
        let mut rows = axis();
        for (place, run) in [(1300, 1), (2300, 2), (3350, 3), (5350, 5)] {
            rows.effort[place..place + run]
                .iter_mut()
                .for_each(|u| *u += 800.0);
        }
        for (place, run) in [(1450, 1), (3250, 4)] {
            rows.position[place..place + run]
                .iter_mut()
                .for_each(|x| *x -= 2.0e-3);
        }
        if let Some(load) = &mut rows.load {
            load[4400] += 1.0e-3;
        }
        let wanted = [("position", 2), ("load position", 1), ("effort", 4)];
        assert_eq!(found(&mut rows), wanted);
        let marked: usize = rows.left_out.iter().filter(|marked| **marked).count();
        assert_eq!(marked, 1 + 2 + 3 + 5 + 1 + 4 + 1);
        let pairs = rows.position.iter().zip(&clean.position);
        assert!(
            pairs
                .into_iter()
                .all(|(x, clean)| (x - clean).abs() < 1.0e-6)
        );
        let pairs = rows.effort.iter().zip(&clean.effort);
        assert!(pairs.into_iter().all(|(u, clean)| (u - clean).abs() < 10.0));
    }

    #[test]
    fn a_spike_beside_a_reversal_is_found() {
        // The axis stands from 800 ms to 1200 ms and goes the other way then.
        for row in [1200 + 30, 1200 + 45, 800 - 20] {
            let mut rows = axis();
            rows.effort[row] -= 2000.0;
            assert_eq!(found(&mut rows), [("effort", 1)], "{row}");
            assert!(rows.left_out[row]);
        }
    }

    #[test]
    fn what_stands_out_too_often_is_said_and_kept() {
        let mut rows = axis();
        (100..7900)
            .step_by(130)
            .for_each(|row| rows.position[row] += 2.0e-3);
        let outliers = leave_out(&mut rows, 1.0e-3);
        assert!(
            !outliers[0].left_out && outliers[0].count > 50,
            "{outliers:?}"
        );
        assert!(rows.position[100] > axis().position[100] + 1.9e-3);
        assert!(!rows.left_out.contains(&true));
        assert!(
            outliers[0]
                .words("training")
                .contains("too many to be left out")
        );
    }

    #[test]
    fn an_axis_of_unknown_mass_keeps_its_rows() {
        let mut rows = axis();
        rows.position
            .iter_mut()
            .zip(&rows.time_s)
            .for_each(|(x, t)| *x = 0.02 * t);
        rows.position[4000] += 1.0e-3;
        assert_eq!(found(&mut rows), []);
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(16))]

        #[test]
        fn quantised_and_coarse_records_have_no_outliers(
            quantum in 0.1..20.0_f64, count_um in 0.1..5.0_f64,
        ) {
            let mut rows = axis();
            rows.effort.iter_mut().for_each(|u| *u = quantum * (*u / quantum).round());
            let count = 1.0e-6 * count_um;
            rows.position.iter_mut().for_each(|x| *x = count * (*x / count).round());
            prop_assert_eq!(found(&mut rows), []);
        }
    }
}
