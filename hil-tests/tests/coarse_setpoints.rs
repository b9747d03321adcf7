//! Setpoints in whole micrometres on circles of R 100 mm: what they cost in torque and in radius,
//! with the setpoint filter of the drive (2115h).
//!
//! The same circle runs twice on the two axes of the reference machine without noise: with fine
//! setpoints (39 pm) and with setpoints rounded to 1 µm, filtered on both axes alike. The filter is
//! a delay of `2ⁿ − 1` cycles and no deformation of a path that is slow against it, so the fine run
//! is compared that much later. Its radius is smaller by `1 − (ω · 2ⁿ)² / 12` (the response of the
//! triangle at the circle's ω): 8 nm at F 500, 0.12 µm at F 2000.

use hil_tests::golden::{self, Measured, row};
use hil_tests::rig::{enabled, quiet_reference, set};
use servo::objects::Parameter;
use workbench::network::master::AxisCycle;
use workbench::trajectory::{Circle, Move};

const RADIUS_M: f64 = 0.1;
const PERIOD_S: f64 = 1.0e-3;
/// rms of the torque difference, N, and error of the mean radius, µm: issue 7.
const TORQUE_N: f64 = 50.0;
const RADIUS_UM: f64 = 1.0;
/// Delay of the filter, cycles.
const LONGEST_DELAY: usize = 8;
/// Logarithm of its length: a delay of 7 cycles.
const FILTER: i32 = 3;

/// Forces and table positions of both axes over part of a circle.
fn turn(feed_mm_min: f64, coarse: bool, filter: i32, cycles: usize) -> Vec<[AxisCycle; 2]> {
    let machine = quiet_reference();
    let circle = Circle {
        radius_m: RADIUS_M,
        feed_m_per_s: feed_mm_min / 6.0e4,
        turns: 1,
        counter_clockwise: true,
    };
    let mut master = enabled(&machine).unwrap();
    (0..2).for_each(|axis| set(&mut master, axis, &[(Parameter::SetpointFilter, filter)]).unwrap());
    let rounded = |at: [f64; 2]| {
        if coarse {
            at.map(|x| (x * 1.0e6).round() * 1.0e-6)
        } else {
            at
        }
    };
    let approach = Move::new(&[0.0, 0.0], &circle.at(0.0), 0.25, 2.5);
    let settle = (approach.duration_s() / PERIOD_S) as usize + 500;
    for cycle in 0..settle {
        let at = approach.at(PERIOD_S * cycle as f64);
        master.cycle(&rounded([at[0], at[1]])).unwrap();
    }
    let seen = (0..cycles).map(|cycle| {
        master
            .cycle(&rounded(circle.at(PERIOD_S * (cycle + 1) as f64)))
            .unwrap();
        [master.axis(0), master.axis(1)]
    });
    let seen = seen.collect();
    master.expect_enabled().unwrap();
    seen
}

fn mean_radius_m(points: &[[AxisCycle; 2]]) -> f64 {
    let radius = |[x, y]: &[AxisCycle; 2]| x.truth.unwrap().table_m.hypot(y.truth.unwrap().table_m);
    points.iter().map(radius).sum::<f64>() / points.len() as f64
}

/// Differences of a coarse run from the fine one: rms of the torque of each axis, N, and mean
/// radius, µm.
fn differences(feed_mm_min: f64, filter: i32) -> ([f64; 2], f64) {
    let circle = Circle {
        radius_m: RADIUS_M,
        feed_m_per_s: feed_mm_min / 6.0e4,
        turns: 1,
        counter_clockwise: true,
    };
    let omega = circle.feed_m_per_s / RADIUS_M;
    // The smooth start is over; then a whole turn, or a part of it where that is long.
    let begin = (std::f64::consts::PI / omega / PERIOD_S) as usize;
    let measured = ((std::f64::consts::TAU / omega / PERIOD_S) as usize).min(LONGEST);
    let delay = if filter == 0 {
        0
    } else {
        (1_usize << filter) - 1
    };
    let [fine, coarse] = [(false, 0), (true, filter)]
        .map(|(coarse, filter)| turn(feed_mm_min, coarse, filter, begin + measured + delay));
    let pairs = || {
        coarse[begin + delay..]
            .iter()
            .zip(&fine[begin..begin + measured])
    };
    let rms = [0, 1].map(|axis| {
        let squares =
            pairs().map(|(coarse, fine)| (coarse[axis].force_n - fine[axis].force_n).powi(2));
        (squares.sum::<f64>() / measured as f64).sqrt()
    });
    let radius =
        mean_radius_m(&coarse[begin + delay..]) - mean_radius_m(&fine[begin..begin + measured]);
    (rms, 1.0e6 * radius)
}

/// Cycles of a slow turn that are looked at: at F 100 the 20 s around the reversal of Y.
const LONGEST: usize = 20_000;

#[test]
fn whole_micrometres_cost_at_most_fifty_newtons_and_a_micrometre_of_radius() {
    let feeds = [
        ("F 2000", 2000.0, true),
        ("F 500", 500.0, true),
        ("F 100", 100.0, false),
    ];
    let feeds = scope::Scope::now().rows("feeds", &feeds, 1, 3);
    let mut rows: Vec<Measured> = Vec::new();
    for (name, feed, is_bound) in feeds {
        for filter in [2, FILTER] {
            let ([x, y], radius) = differences(*feed, filter);
            rows.push(row(
                format!("{name}, filter 2^{filter}, torque X"),
                x,
                "N rms",
            ));
            rows.push(row(
                format!("{name}, filter 2^{filter}, torque Y"),
                y,
                "N rms",
            ));
            rows.push(row(
                format!("{name}, filter 2^{filter}, radius"),
                radius,
                "um",
            ));
            let keeps = x.max(y) <= TORQUE_N && radius.abs() <= RADIUS_UM;
            assert!(
                keeps || !is_bound || filter != FILTER,
                "{name}: {x} N, {y} N, {radius} um"
            );
        }
    }
    golden::check_some(
        "coarse-setpoints",
        &rows,
        &feeds.iter().map(|(name, ..)| *name).collect::<Vec<_>>(),
    );
}

#[test]
fn the_delay_of_the_filter_is_at_most_eight_cycles() {
    assert!((3..=LONGEST_DELAY).contains(&((1 << FILTER) - 1)));
}
