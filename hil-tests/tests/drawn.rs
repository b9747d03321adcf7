//! Machines that nobody chose, commissioned as a user would, and how much of their burst is gone:
//! with the model of their records on faster circles in every test, with that refined by the drives
//! at every feed in the whole.

use hil_tests::drawn::{Commissioned, Drawn, FEEDS, UNLIKE_SIDES, WITH_MORE, left};
use hil_tests::{Scope, on_all_cores};
use workbench::session::Stand;

/// Machines of a set; every third one has Maxwell slip, and another every third one a gap. In the
/// whole there is a second set, whose motor's friction is unlike the table's.
const MACHINES: u64 = 12;
/// Those of every test: the first one with a gap.
const FEW: [u64; 2] = [WITH_MORE + 2, WITH_MORE + 3];
/// A burst that is smaller is none, µm.
const NOTHING_UM: f64 = 0.5;

/// What is gone of the burst at the worst, and in the median of all cells, %.
struct Bound {
    worst: f64,
    median: f64,
}

/// As wanted.
const WITHOUT_GAP: Bound = Bound {
    worst: 90.0,
    median: 97.0,
};
/// Wanted are 65 and 80; 86.6 and 97.1 are there, and 87.1 and 95.8 in the second set (`--bench
/// drawn`, 2026-11-29).
const WITH_GAP: Bound = Bound {
    worst: 82.0,
    median: 95.0,
};

/// A machine that was commissioned: whether it has a gap, and what is left at each feed, µm and %
/// less than without.
struct Left {
    number: u64,
    has_gap: bool,
    cells: Vec<(f64, f64)>,
}

#[test]
fn on_machines_that_nobody_chose_the_model_of_records_takes_most_of_the_burst() {
    let numbers: Vec<u64> = if Scope::now().is_complete() {
        let sets = [WITH_MORE, UNLIKE_SIDES].into_iter();
        sets.flat_map(|first| first..first + MACHINES).collect()
    } else {
        FEW.to_vec()
    };
    let all = on_all_cores(&numbers, |number| of_number(*number));
    for (has_gap, bound) in [(false, WITHOUT_GAP), (true, WITH_GAP)] {
        let machines = all.iter().filter(|own| own.has_gap == has_gap);
        let mut cells: Vec<f64> = Vec::new();
        for own in machines {
            println!("{}: {:.2?} (µm, % less)", own.number, own.cells);
            for (left_um, less) in &own.cells {
                let holds = *less >= bound.worst || *left_um <= NOTHING_UM;
                assert!(holds, "{}: {left_um} µm, {less} % less", own.number);
                cells.push(*less);
            }
        }
        cells.sort_by(f64::total_cmp);
        let median = cells[cells.len() / 2];
        if Scope::now().is_complete() {
            assert!(median >= bound.median, "gap: {has_gap}, {median} %");
        }
    }
}

fn of_number(number: u64) -> Left {
    let own = Drawn::of_number(number);
    let stand = Stand::in_process(&own.machine);
    let whole = Scope::now().is_complete();
    let models = Commissioned::of(&stand, whole).models;
    let model = models.last().expect("a model is made of its records");
    let feeds = if whole { &FEEDS[..] } else { &FEEDS[1..] };
    Left {
        number,
        has_gap: own.machine.axes[0].actual.mechanics.backlash_m > 0.0,
        cells: left(&stand, feeds, model).expect("the circles can be run"),
    }
}
