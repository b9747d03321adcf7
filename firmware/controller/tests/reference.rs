//! The reference stage at 1 kHz on an axis of 0.5 m/s and 5 m/s²: what passes, what is bridged,
//! what is refused, and that the limits hold.

use controller::reference::{
    Mode, Ramp, Reference, ReferenceConfig, ReferenceInput, ReferenceState,
};
use controller::units::{Position, Velocity};
use fixed::types::{I20F12, I56F8};
use proptest::prelude::*;

/// 1 kHz: one count is 10 nm, 10 µm/s, 10 mm/s², 10 m/s³.
const COUNT_M: f64 = 1.0e-8;
const PERIOD_S: f64 = 1.0e-3;
/// 39 pm.
const BIT_M: f64 = COUNT_M / 256.0;

fn per_cycle(counts: f64) -> Velocity {
    Velocity(I20F12::from_num(counts))
}

fn config() -> ReferenceConfig {
    ReferenceConfig {
        velocity_limit: per_cycle(50_000.0),
        acceleration_limit: per_cycle(500.0),
        step: per_cycle(50.0),
        position_min: Position::from_counts(-100_000_000),
        position_max: Position::from_counts(100_000_000),
        quick_stop: Ramp {
            deceleration: per_cycle(500.0),
            jerk: per_cycle(100.0),
        },
        slow_down: Ramp {
            deceleration: per_cycle(250.0),
            jerk: per_cycle(10.0),
        },
        filter_log2: 0,
        setpoint_cycles: 1,
        middle: ReferenceConfig::NOWHERE,
    }
}

fn setpoint(metres: f64) -> Position {
    Position(I56F8::saturating_from_num(metres / COUNT_M * 256.0) / 256)
}

fn fine(metres: f64) -> Position {
    Position::from_fine_counts((metres / BIT_M).round() as i64)
}

fn metres(position: Position) -> f64 {
    position.0.to_num::<f64>() * COUNT_M
}

fn previewed(preview: Option<Position>) -> ReferenceInput {
    ReferenceInput {
        preview,
        ..ReferenceInput::default()
    }
}

/// Steps along a path from rest at cycle 0; `sent` may change or lose the setpoint of a cycle.
fn run(
    config: &ReferenceConfig,
    cycles: u32,
    sent: impl Fn(u32) -> Option<Position>,
) -> Vec<Reference> {
    let start = sent(0).unwrap_or_default();
    let mut state = ReferenceState::at(start, Velocity::ZERO);
    (0..cycles)
        .map(|cycle| state.step(config, &previewed(sent(cycle + 1))))
        .collect()
}

/// Rest for 20 cycles, then up at `acceleration` for 40 cycles, with a jerk of 50 m/s³ where
/// `smooth`.
fn start_of_motion(cycle: u32, acceleration: f64, jerk: f64) -> f64 {
    let t = (f64::from(cycle) - 20.0).max(0.0) * PERIOD_S;
    let rise = if jerk > 0.0 { acceleration / jerk } else { 0.0 };
    if t < rise {
        return jerk * t.powi(3) / 6.0;
    }
    let after = t - rise;
    let (x, v) = (jerk * rise.powi(3) / 6.0, 0.5 * jerk * rise * rise);
    x + v * after + 0.5 * acceleration * after * after
}

#[test]
fn fine_setpoints_within_the_limits_pass_bit_for_bit_and_in_time() {
    for (acceleration, jerk) in [(5.0, 50.0), (5.0, 0.0), (-5.0, 0.0), (0.3, 0.0)] {
        let at = |cycle| fine(start_of_motion(cycle, acceleration, jerk));
        for (cycle, reference) in run(&config(), 110, |cycle| Some(at(cycle)))
            .iter()
            .enumerate()
        {
            let cycle = cycle as u32;
            assert_eq!(
                reference.position,
                at(cycle),
                "a {acceleration}, cycle {cycle}"
            );
            assert!(
                !reference.limited
                    && !reference.refused
                    && !reference.bridged
                    && !reference.overrun
            );
        }
    }
}

#[test]
fn the_acceleration_is_that_of_the_middle_of_the_torques_cycle() {
    let references = run(&config(), 100, |cycle| {
        Some(fine(start_of_motion(cycle, 5.0, 50.0)))
    });
    // From cycle 20 on the acceleration is 50 m/s³ (t − 0.02 s).
    for (cycle, reference) in references.iter().enumerate().take(100).skip(24) {
        let wanted = 50.0 * (cycle as f64 + 1.5 - 20.0) * PERIOD_S;
        let got = reference.acceleration.0.to_num::<f64>() * COUNT_M / PERIOD_S / PERIOD_S;
        // Second differences of bits: 2 bits, 2.5 times one and 1.5 times the other at most.
        assert!(
            (got - wanted).abs() < 8.0 * BIT_M * 1.0e6,
            "cycle {cycle}: {got} {wanted}"
        );
    }
}

#[test]
fn a_step_of_acceleration_is_fed_forward_one_cycle_later_and_not_extrapolated() {
    let references = run(&config(), 60, |cycle| {
        Some(fine(start_of_motion(cycle, 5.0, 0.0)))
    });
    let accelerations: Vec<f64> = references
        .iter()
        .map(|r| r.acceleration.0.to_num())
        .collect();
    // x(21) = 2.5 µm is the first that moves: the second differences centred on 20 and on 21 are
    // 250 and 500 counts, each confirmed a cycle later.
    assert_eq!(
        accelerations[18..24]
            .iter()
            .map(|a| a.round())
            .collect::<Vec<_>>(),
        [0.0, 0.0, 0.0, 250.0, 500.0, 500.0]
    );
}

/// Where the wrong setpoint goes, and what is left of it in the commanded path, µm.
fn largest_deviation(base: impl Fn(u32) -> f64, wrong: u32, by_m: f64) -> (f64, u32, u16) {
    let sent = |cycle| fine(base(cycle) + if cycle == wrong { by_m } else { 0.0 });
    let mut state = ReferenceState::at(sent(0), Velocity::ZERO);
    let (mut largest, mut refused, mut in_a_row) = (0.0_f64, 0, 0);
    for cycle in 0..100 {
        let reference = state.step(&config(), &previewed(Some(sent(cycle + 1))));
        if cycle < 40 {
            // A path that moves from the first cycle on is caught up first.
            continue;
        }
        largest = largest.max(1.0e6 * (metres(reference.position) - base(cycle)).abs());
        refused += u32::from(reference.refused);
        in_a_row = in_a_row.max(state.refusals());
        assert!(!reference.limited && !reference.overrun, "cycle {cycle}");
    }
    (largest, refused, in_a_row)
}

#[test]
fn one_wrong_setpoint_is_refused_whichever_its_sign_and_size() {
    let paths: [(&str, &dyn Fn(u32) -> f64); 5] = [
        ("rest", &|_| 0.0),
        ("50 mm/s", &|cycle| 50.0e-3 * PERIOD_S * f64::from(cycle)),
        ("up at the limit", &|cycle| start_of_motion(cycle, 5.0, 0.0)),
        ("down at the limit", &|cycle| {
            start_of_motion(cycle, -5.0, 0.0)
        }),
        ("jerk of 50 m/s3", &|cycle| {
            start_of_motion(cycle, 5.0, 50.0)
        }),
    ];
    for (name, path) in paths {
        for by_um in [1.0, 3.0, 4.9, 10.0, 100.0, 5000.0] {
            for sign in [-1.0, 1.0] {
                let (deviation, refused, in_a_row) =
                    largest_deviation(path, 50, sign * 1.0e-6 * by_um);
                assert_eq!((refused, in_a_row), (1, 0), "{name}, {sign} {by_um} µm");
                assert!(
                    deviation < 0.06,
                    "{name}, {sign} {by_um} µm: {deviation} µm"
                );
            }
        }
    }
}

#[test]
fn below_the_step_a_wrong_setpoint_passes_as_it_is() {
    let (deviation, refused, _) = largest_deviation(|_| 0.0, 50, 0.45e-6);
    assert!(
        refused == 0 && (0.44..0.46).contains(&deviation),
        "{deviation} µm"
    );
}

#[test]
fn a_wrong_setpoint_never_reaches_the_feedforward_and_never_turns_the_direction() {
    let base = |cycle: u32| 1.0e-3 * PERIOD_S * f64::from(cycle);
    for by in [-10.0e-6, 10.0e-6] {
        for reference in run(&config(), 100, |cycle| {
            Some(fine(base(cycle) + if cycle == 50 { by } else { 0.0 }))
        }) {
            assert!(
                reference.acceleration.0.to_num::<f64>().abs() < 0.1,
                "{:?}",
                reference.acceleration
            );
            assert!(
                reference.next_velocity > Velocity::ZERO || reference.velocity == Velocity::ZERO
            );
        }
    }
}

#[test]
fn a_shifted_path_is_refused_again_and_again() {
    for shift_um in [2.0, 10.0, 40.0, 1000.0] {
        let sent = |cycle: u32| fine(if cycle < 50 { 0.0 } else { 1.0e-6 * shift_um });
        let mut state = ReferenceState::at(sent(0), Velocity::ZERO);
        for cycle in 0..150 {
            let reference = state.step(&config(), &previewed(Some(sent(cycle + 1))));
            assert_eq!(metres(reference.position), 0.0, "{shift_um} µm");
        }
        assert_eq!(state.refusals(), 100, "{shift_um} µm");
    }
}

#[test]
fn steps_of_acceleration_and_velocity_that_the_axis_can_do_are_believed() {
    let steps: [(&str, &dyn Fn(f64) -> f64); 4] = [
        ("0 to 5 m/s2", &|t| 2.5 * t * t),
        ("0 to −5 m/s2", &|t| -2.5 * t * t),
        ("velocity of 4 mm/s", &|t| 4.0e-3 * t),
        ("velocity of −1 mm/s", &|t| -1.0e-3 * t),
    ];
    for (name, path) in steps {
        let at = |cycle: u32| fine(path((f64::from(cycle) - 30.0).max(0.0) * PERIOD_S));
        for (cycle, reference) in run(&config(), 90, |cycle| Some(at(cycle)))
            .iter()
            .enumerate()
        {
            assert_eq!(
                reference.position,
                at(cycle as u32),
                "{name}, cycle {cycle}"
            );
            assert!(!reference.refused, "{name}, cycle {cycle}");
        }
    }
}

/// Largest deviation of the commanded path and largest jump of its velocity beyond that of the path
/// itself, with some setpoints lost.
fn with_holes(base: impl Fn(u32) -> f64, lost: std::ops::Range<u32>) -> (f64, f64) {
    let references = run(&config(), 120, |cycle| {
        (!lost.contains(&cycle)).then(|| fine(base(cycle)))
    });
    let mut worst = (0.0_f64, 0.0_f64);
    for (cycle, reference) in references.iter().enumerate().skip(1) {
        let cycle = cycle as u32;
        let velocity = (base(cycle) - base(cycle - 1)) / COUNT_M;
        worst.0 = worst
            .0
            .max(1.0e9 * (metres(reference.position) - base(cycle)).abs());
        worst.1 = worst
            .1
            .max((reference.velocity.0.to_num::<f64>() - velocity).abs());
        assert_eq!(
            reference.bridged,
            lost.contains(&(cycle + 1)),
            "cycle {cycle}"
        );
        assert!(!reference.refused);
    }
    worst
}

#[test]
fn lost_setpoints_are_carried_on_with_the_acceleration() {
    let smooth = |cycle| start_of_motion(cycle, 5.0, 50.0);
    let steady = |cycle| start_of_motion(cycle, 5.0, 0.0);
    // A jerk of 50 m/s³ is 50 nm per cycle³: 1, 4, 10 of it after 1, 2, 3 cycles; velocity in
    // counts of 10 nm per cycle.
    for (lost, wanted_nm) in [(1, 50.0), (2, 200.0), (3, 500.0)] {
        let (deviation_nm, velocity) = with_holes(smooth, 50..50 + lost);
        assert!(
            (deviation_nm - wanted_nm).abs() < 3.0,
            "{lost} lost: {deviation_nm} nm"
        );
        assert!(
            velocity < 0.11 * wanted_nm,
            "{lost} lost: {velocity} counts per cycle"
        );
        let (deviation_nm, velocity) = with_holes(steady, 50..50 + lost);
        assert!(
            deviation_nm < 1.0 && velocity < 0.1,
            "{lost} lost at constant acceleration: {deviation_nm} nm, {velocity}"
        );
    }
}

#[test]
fn a_hole_at_a_step_of_acceleration_is_caught_up_within_the_limits() {
    let base = |cycle| start_of_motion(cycle, 4.0, 0.0);
    let references = run(&config(), 120, |cycle| {
        (cycle != 21).then(|| fine(base(cycle)))
    });
    let deviation =
        |cycle: u32| 1.0e6 * (metres(references[cycle as usize].position) - base(cycle)).abs();
    let worst = (0..120).map(deviation).fold(0.0, f64::max);
    assert!((1.9..12.0).contains(&worst), "{worst} µm");
    assert!(
        deviation(60) == 0.0 || deviation(60) < 1.0e-3,
        "{} µm",
        deviation(60)
    );
}

/// A velocity, then `acceleration` for 60 cycles from `begin` on (in cycles, fractions too), then
/// the velocity that it came to.
fn sudden(cycle: u32, velocity: f64, acceleration: f64, begin: f64) -> f64 {
    let after = |begin: f64| (f64::from(cycle) - begin).max(0.0) * PERIOD_S;
    velocity * f64::from(cycle) * PERIOD_S
        + 0.5 * acceleration * (after(begin).powi(2) - after(begin + 60.0).powi(2))
}

/// The largest deviation, and that which is left at the end, µm, over a step of 5 m/s² and its end
/// with any one setpoint near them lost; refusals in a row.
fn lost_at_a_step(config: &ReferenceConfig) -> (f64, f64, u16) {
    let (mut worst, mut left, mut refusals) = (0.0_f64, 0.0_f64, 0);
    for (velocity, acceleration, begin) in [
        (0.0, 5.0, 50.0),
        (0.05, 5.0, 50.25),
        (0.05, -5.0, 50.5),
        (-0.05, 5.0, 50.75),
    ] {
        let base = |cycle| sudden(cycle, velocity, acceleration, begin);
        for lost in (46..56).chain(106..116) {
            let mut state = ReferenceState::at(fine(base(0)), Velocity::ZERO);
            for cycle in 0..400 {
                let preview = (cycle + 1 != lost).then(|| fine(base(cycle + 1)));
                let reference = state.step(config, &previewed(preview));
                // A path that moves from the first cycle on is caught up first.
                let off = if cycle < 40 {
                    0.0
                } else {
                    1.0e6 * (metres(reference.position) - base(cycle)).abs()
                };
                (worst, refusals) = (worst.max(off), refusals.max(state.refusals()));
                left = if cycle > 350 { left.max(off) } else { 0.0 };
            }
        }
    }
    (worst, left, refusals)
}

#[test]
fn a_setpoint_lost_at_a_step_of_acceleration_is_caught_up_and_nothing_is_refused() {
    let with_reserve = ReferenceConfig {
        acceleration_limit: per_cycle(625.0),
        ..config()
    };
    let (worst, left, refusals) = lost_at_a_step(&with_reserve);
    assert!(
        (7.0..8.0).contains(&worst) && left < 1.0e-3 && refusals == 0,
        "{worst} µm, {left} µm, {refusals}"
    );
    // A path that takes all that the axis may leaves nothing to catch up with before it ends: three
    // quarters of a cycle's speed, for 60 cycles.
    let (worst, left, refusals) = lost_at_a_step(&config());
    assert!(
        (220.0..228.0).contains(&worst) && left < 1.0e-3 && refusals == 0,
        "{worst} µm, {left} µm, {refusals}"
    );
}

#[test]
fn a_late_setpoint_fills_its_hole() {
    let base = |cycle| start_of_motion(cycle, 5.0, 50.0);
    let mut state = ReferenceState::at(fine(0.0), Velocity::ZERO);
    for cycle in 0..100 {
        let preview = (cycle + 1 != 60).then(|| fine(base(cycle + 1)));
        let present = (cycle == 60).then(|| fine(base(60)));
        let reference = state.step(
            &config(),
            &ReferenceInput {
                present,
                preview,
                mode: Mode::Follow,
            },
        );
        assert_eq!(reference.position, fine(base(cycle)), "cycle {cycle}");
    }
}

/// Cycles, way in mm, largest deceleration and jerk in counts, of a ramp from a speed.
fn ramp(mode: Mode, velocity: f64) -> (u32, f64, f64, f64) {
    let mut state = ReferenceState::at(Position::default(), per_cycle(velocity));
    let (mut velocity, mut acceleration, mut worst, mut cycles) =
        (velocity, 0.0_f64, (0.0_f64, 0.0_f64), 0);
    loop {
        let reference = state.step(
            &config(),
            &ReferenceInput {
                mode,
                ..ReferenceInput::default()
            },
        );
        let next: f64 = reference.next_velocity.0.to_num();
        let change = next - velocity;
        worst = (
            worst.0.max(change.abs()),
            worst.1.max((change - acceleration).abs()),
        );
        (velocity, acceleration, cycles) = (next, change, cycles + 1);
        if reference.standing {
            return (cycles, 1.0e3 * metres(reference.position), worst.0, worst.1);
        }
    }
}

#[test]
fn a_ramp_takes_the_way_of_the_closed_form() {
    // v² / 2 a + v a / 2 j, as 0.4 m/s at 5 m/s² and 1000 m/s³: 16 + 1 mm; at 2.5 m/s² and 100
    // m/s³: 32 + 5 mm. v / a + a / j: 85 and 185 ms. The change begins with the very next cycle, in
    // whole steps of the jerk: one cycle's way less.
    for (mode, velocity, way_mm, cycles, deceleration, jerk) in [
        (Mode::QuickStop, 40_000.0, 17.0, 85, 500.0, 100.0),
        (Mode::QuickStop, -40_000.0, -17.0, 85, 500.0, 100.0),
        (Mode::SlowDown, 40_000.0, 37.0, 185, 250.0, 10.0),
        // Too slow for the whole deceleration: v √(v / j).
        (Mode::SlowDown, 1000.0, 0.1, 20, 100.0, 10.0),
    ] {
        let (took, way, largest, change) = ramp(mode, velocity);
        let way_mm = way_mm - 1.0e-5 * velocity;
        assert!(
            (way - way_mm).abs() < 0.002 * way_mm.abs() + 0.002,
            "{mode:?} {velocity}: {way} mm"
        );
        assert!(
            took.abs_diff(cycles) <= 3,
            "{mode:?} {velocity}: {took} cycles"
        );
        assert!(
            largest <= deceleration + 0.1 && change <= 1.125 * jerk + 0.1,
            "{mode:?} {velocity}: {largest} {change}"
        );
    }
}

#[test]
fn a_ramp_leads_an_acceleration_down_first_and_never_turns_round() {
    let at = |cycle| fine(start_of_motion(cycle, 4.0, 50.0));
    let mut state = ReferenceState::at(at(0), Velocity::ZERO);
    let (mut before, mut standing) = (None, false);
    for cycle in 0..400 {
        let mode = if cycle < 150 {
            Mode::Follow
        } else {
            Mode::SlowDown
        };
        let reference = state.step(
            &config(),
            &ReferenceInput {
                mode,
                ..previewed(Some(at(cycle + 1)))
            },
        );
        let change: f64 = (reference.next_velocity.0 - reference.velocity.0).to_num();
        if let Some(before) = before.filter(|_| cycle > 150) {
            assert!(
                (change - before) <= 11.5 && (change - before) >= -11.5,
                "cycle {cycle}: {before} {change}"
            );
        }
        assert!(reference.next_velocity >= Velocity::ZERO);
        before = Some(change);
        standing = reference.standing;
    }
    assert!(standing);
}

#[test]
fn a_halt_that_is_released_chases_the_setpoint_and_passes_it_bit_for_bit_again() {
    let at = |cycle: u32| fine(0.02 * f64::from(cycle) * PERIOD_S);
    let mut state = ReferenceState::at(at(0), Velocity::ZERO);
    let mut caught_up = None;
    for cycle in 0..2000 {
        let mode = if (300..600).contains(&cycle) {
            Mode::SlowDown
        } else {
            Mode::Follow
        };
        let reference = state.step(
            &config(),
            &ReferenceInput {
                mode,
                ..previewed(Some(at(cycle + 1)))
            },
        );
        if cycle >= 600 && !reference.limited {
            caught_up.get_or_insert(cycle);
        }
        if caught_up.is_some_and(|since| cycle > since) {
            assert_eq!(reference.position, at(cycle), "cycle {cycle}");
        }
    }
    // 6 mm behind: √(4 s / a) up and down with half the acceleration is 69 ms, plus the 20 mm/s of
    // the setpoint.
    assert!(matches!(caught_up, Some(660..=760)), "{caught_up:?}");
}

#[test]
fn the_triangle_delays_by_its_length_and_smooths_whole_micrometres() {
    let config = ReferenceConfig {
        filter_log2: 3,
        ..config()
    };
    let path = |cycle: f64| 0.05 * (std::f64::consts::TAU * 0.053 * cycle * PERIOD_S).sin();
    let micrometres =
        |cycle: u32| Position::from_counts((path(f64::from(cycle)) * 1.0e6).round() as i64 * 100);
    let references = run(&config, 20_000, |cycle| Some(micrometres(cycle)));
    let mut squares = 0.0;
    for (cycle, reference) in references.iter().enumerate().skip(2000) {
        let cycle = cycle as f64;
        let error = metres(reference.position) - path(cycle - 7.0);
        assert!(error.abs() < 0.501e-6, "cycle {cycle}: {error} m");
        assert!(!reference.refused && !reference.limited, "cycle {cycle}");
        let omega = std::f64::consts::TAU * 0.053;
        let wanted = -omega * omega * path(cycle - 7.0);
        squares += (reference.acceleration.0.to_num::<f64>() * 0.01 - wanted).powi(2);
    }
    let rms = (squares / 18_000.0_f64).sqrt();
    // A rounding of 1 µm is 0.29 µm rms; (1, −2, 1) / 64 leaves √6 / 64 of it: 11 mm/s² where
    // errors are independent.
    assert!((0.004..0.02).contains(&rms), "{rms} m/s²");
}

#[test]
fn with_the_filter_on_a_wrong_setpoint_of_ten_micrometres_is_refused_too() {
    let config = ReferenceConfig {
        filter_log2: 3,
        ..config()
    };
    for by in [-10.0e-6, 10.0e-6] {
        let at = |cycle: u32| {
            (0.04321 * f64::from(cycle)).round() * 1.0e-6 + if cycle == 50 { by } else { 0.0 }
        };
        let (bad, good) = (
            run(&config, 100, |cycle| Some(setpoint(at(cycle)))),
            run(&config, 100, |cycle| {
                Some(setpoint(at(cycle) - if cycle == 50 { by } else { 0.0 }))
            }),
        );
        let deviations = bad
            .iter()
            .zip(&good)
            .map(|(bad, good)| (metres(bad.position) - metres(good.position)).abs());
        assert!(deviations.fold(0.0, f64::max) < 0.3e-6);
        assert_eq!(bad.iter().filter(|reference| reference.refused).count(), 1);
    }
}

/// A smooth path sampled every n cycles; deviation from the path 2 n − 1 cycles ago, and the
/// largest change of acceleration from cycle to cycle.
fn interpolated(cycles: u8) -> (f64, f64) {
    let config = ReferenceConfig {
        setpoint_cycles: cycles,
        ..config()
    };
    let path = |cycle: f64| 0.01 * (std::f64::consts::TAU * 2.0 * cycle * PERIOD_S).cos();
    let mut state = ReferenceState::at(fine(path(0.0)), Velocity::ZERO);
    let (mut deviation, mut jump, mut before) = (0.0_f64, 0.0_f64, None);
    for cycle in 0..3000_u32 {
        let due = (cycle + 1) % u32::from(cycles) == 0;
        assert!(
            cycle < 30 || state.expects_setpoint(&config) == due,
            "cycle {cycle}"
        );
        let preview = due.then(|| fine(path(f64::from(cycle + 1))));
        let reference = state.step(&config, &previewed(preview));
        let change: f64 = (reference.next_velocity.0 - reference.velocity.0).to_num();
        if cycle > 500 {
            let wanted = path(f64::from(cycle) - 2.0 * f64::from(cycles) + 1.0);
            deviation = deviation.max((metres(reference.position) - wanted).abs());
            jump = jump.max(before.map_or(0.0, |before: f64| (change - before).abs()));
            assert!(
                !reference.refused && !reference.bridged && !reference.limited,
                "n {cycles}, cycle {cycle}: {reference:?}"
            );
        }
        before = Some(change);
    }
    (1.0e6 * deviation, jump * 0.01)
}

#[test]
fn coarse_setpoints_in_time_are_interpolated_smoothly() {
    // The path itself: 0.13 m/s, 1.6 m/s², 20 m/s³ (0.02 m/s² per cycle). Catmull and Rom leave up
    // to (ω n T)⁴ / 100 or so of the amplitude.
    for (cycles, deviation_um, jump) in [
        (2, 0.01, 0.06),
        (4, 0.1, 0.1),
        (8, 1.0, 0.2),
        (20, 30.0, 0.5),
    ] {
        let (deviation, change) = interpolated(cycles);
        assert!(deviation < deviation_um, "n {cycles}: {deviation} µm");
        assert!(change < jump, "n {cycles}: {change} m/s² per cycle");
    }
}

#[test]
fn a_lost_coarse_setpoint_is_bridged_and_the_path_goes_on() {
    let config = ReferenceConfig {
        setpoint_cycles: 4,
        ..config()
    };
    let path = |cycle: f64| 0.01 * (std::f64::consts::TAU * 2.0 * cycle * PERIOD_S).cos();
    let mut state = ReferenceState::at(fine(path(0.0)), Velocity::ZERO);
    let mut worst = 0.0_f64;
    for cycle in 0..1200_u32 {
        let is_sent = (cycle + 1) % 4 == 0 && cycle + 1 != 800;
        let preview = is_sent.then(|| fine(path(f64::from(cycle + 1))));
        let reference = state.step(&config, &previewed(preview));
        assert!(
            cycle < 500 || reference.bridged == (cycle + 1 == 800),
            "cycle {cycle}"
        );
        worst = if cycle > 500 {
            worst.max((metres(reference.position) - path(f64::from(cycle) - 7.0)).abs())
        } else {
            worst
        };
    }
    assert!(worst < 2.0e-6, "{worst} m");
}

#[test]
fn the_track_brakes_before_the_end_of_its_travel_and_comes_back_with_the_setpoint() {
    let travel = ReferenceConfig {
        position_max: fine(0.02),
        ..config()
    };
    // 0.3 m/s into the end at 20 mm, past it, and back.
    let at = |cycle: u32| {
        let t = (f64::from(cycle) - 20.0).max(0.0) * PERIOD_S;
        fine(0.025 * (1.0 - (std::f64::consts::TAU * 1.5 * t).cos()))
    };
    let references = run(&travel, 1400, |cycle| Some(at(cycle)));
    let highest = references
        .iter()
        .map(|reference| metres(reference.position))
        .fold(0.0, f64::max);
    assert!((0.0199..=0.02).contains(&highest), "{highest} m");
    for (cycle, pair) in references.windows(2).enumerate() {
        let change: f64 = (pair[1].velocity.0 - pair[0].velocity.0).to_num();
        assert!(
            change.abs() <= 500.0 + 0.05 && !pair[0].overrun,
            "cycle {cycle}: {change}"
        );
    }
    let passed = |cycle: usize| references[cycle].position == at(cycle as u32);
    assert!(
        passed(50) && !passed(350) && passed(670),
        "there, held back, and there again"
    );
}

#[test]
fn an_extrapolated_stop_does_not_turn_the_direction() {
    // Up to 0.1 m/s from cycle 20 on, down to rest from cycle 60 to 80, both at 5 m/s²; one
    // setpoint about the stop is lost.
    let ramp =
        |cycle: u32, from: f64| 2.5 * ((f64::from(cycle) - from).max(0.0) * PERIOD_S).powi(2);
    let at =
        |cycle| fine(ramp(cycle, 20.0) - ramp(cycle, 40.0) - ramp(cycle, 60.0) + ramp(cycle, 80.0));
    for lost in 76..86 {
        for (cycle, reference) in run(&config(), 100, |cycle| (cycle != lost).then(|| at(cycle)))
            .iter()
            .enumerate()
        {
            assert!(
                reference.next_velocity >= Velocity::ZERO,
                "lost {lost}, cycle {cycle}"
            );
        }
    }
}

/// Ticks of the properties.
fn ticks() -> u32 {
    match std::env::var("QUADRANT_SCOPE").as_deref() {
        Ok("certify") => 1_000_000,
        _ => 30_000,
    }
}

const TICKS_PER_CASE: usize = 500;

#[derive(Clone, Debug)]
enum Event {
    /// The setpoint jumps there, 10 nm.
    Jump(i64),
    /// The setpoint goes on at this velocity, counts per cycle.
    Velocity(i64),
    Lost(u8),
    Late,
    Mode(u8),
    /// Limits: velocity, acceleration, travel.
    Limits(i32, i32, i32),
    Setpoints(u8, u8),
}

fn event() -> impl Strategy<Value = Event> {
    prop_oneof![
        2 => (-3_000_000_i64..3_000_000).prop_map(Event::Jump),
        1 => any::<i64>().prop_map(Event::Jump),
        6 => (-80_000_i64..80_000).prop_map(Event::Velocity),
        4 => (1_u8..30).prop_map(Event::Lost),
        2 => Just(Event::Late),
        4 => (0_u8..6).prop_map(Event::Mode),
        2 => (1000_i32..60_000, 50_i32..1000, 10_000_i32..2_000_000).prop_map(|(v, a, x)| Event::Limits(v, a, x)),
        1 => (0_u8..4, 1_u8..6).prop_map(|(n, cycles)| Event::Setpoints(n, cycles)),
    ]
}

/// The same where the middle of the travel is known.
fn amid(config: ReferenceConfig) -> ReferenceConfig {
    let [v, a] =
        [config.velocity_limit, config.acceleration_limit].map(|limit| limit.0.to_num::<f64>());
    let braking = ((v + 1.0 / 256.0).powi(2) / (2.0 * a)).round() as i32;
    let middle = ReferenceConfig::middle_of([config.position_min, config.position_max], braking);
    ReferenceConfig { middle, ..config }
}

struct Storm {
    config: ReferenceConfig,
    state: ReferenceState,
    target: i64,
    velocity: i64,
    lost: u8,
    late: bool,
    mode: Mode,
}

impl Storm {
    fn new() -> Self {
        let state = ReferenceState::at(Position::default(), Velocity::ZERO);
        let travel = Position::from_counts(1_000_000);
        let config = ReferenceConfig {
            position_max: travel,
            position_min: Position::from_counts(-1_000_000),
            ..config()
        };
        Self {
            config: amid(config),
            state,
            target: 0,
            velocity: 0,
            lost: 0,
            late: false,
            mode: Mode::Follow,
        }
    }

    fn take(&mut self, event: &Event) {
        match *event {
            Event::Jump(to) => self.target = to,
            Event::Velocity(velocity) => self.velocity = velocity,
            Event::Lost(cycles) => self.lost = cycles,
            Event::Late => self.late = true,
            Event::Mode(0) => self.mode = Mode::QuickStop,
            Event::Mode(1) => self.mode = Mode::SlowDown,
            Event::Mode(_) => self.mode = Mode::Follow,
            Event::Limits(velocity, acceleration, travel) => {
                self.config.velocity_limit = Velocity(I20F12::from_num(velocity));
                self.config.acceleration_limit = Velocity(I20F12::from_num(acceleration));
                self.config.position_max = Position::from_counts(i64::from(travel));
                self.config.position_min = Position::from_counts(-i64::from(travel));
                self.config = amid(self.config);
            }
            Event::Setpoints(log2, cycles) => {
                self.config.filter_log2 = log2;
                self.config.setpoint_cycles = if cycles > 3 { cycles } else { 1 };
            }
        }
    }

    fn step(&mut self) -> Reference {
        let before = Position::from_counts(self.target);
        self.target = self.target.saturating_add(self.velocity);
        let is_lost = self.lost > 0;
        self.lost = self.lost.saturating_sub(1);
        let due = self.state.expects_setpoint(&self.config);
        let preview = (due && !is_lost).then(|| Position::from_counts(self.target));
        let present = std::mem::take(&mut self.late).then_some(before);
        self.state.step(
            &self.config,
            &ReferenceInput {
                present,
                preview,
                mode: self.mode,
            },
        )
    }
}

/// Follows the commanded track from outside.
#[derive(Default)]
struct Watch {
    position: f64,
    velocity: f64,
    /// How far beyond a position limit the track may still be on its way to rest.
    overrun_ends: f64,
}

impl Watch {
    /// Rounding: one bit in velocity, twelve in acceleration.
    fn check(
        &mut self,
        reference: &Reference,
        config: &ReferenceConfig,
        limits_changed: bool,
    ) -> Result<(), String> {
        let (position, next): (f64, f64) = (
            reference.position.0.to_num(),
            reference.next_velocity.0.to_num(),
        );
        let velocity: f64 = reference.velocity.0.to_num();
        let (limit, acceleration): (f64, f64) = (
            config.velocity_limit.0.to_num(),
            config.acceleration_limit.0.to_num(),
        );
        let (bit, max): (f64, f64) = (1.0 / 256.0, config.position_max.0.to_num());
        if limits_changed {
            self.overrun_ends = position.abs() + velocity * velocity / (2.0 * acceleration) + 1.0;
        }
        let ahead = position + next;
        let change = (next - velocity).abs();
        let is_slower = next.abs() <= velocity.abs() - acceleration + 13.0 * bit || next == 0.0;
        let allowed = max.max(
            self.overrun_ends
                .min(f64::max(position.abs(), self.overrun_ends)),
        );
        if change > acceleration + 12.5 * bit
            && !(reference.bridged || reference.next_velocity == Velocity::ZERO)
        {
            return Err(format!("acceleration {change} of {acceleration}"));
        }
        if next.abs() > limit + 1.5 * bit && !(reference.overrun && is_slower) {
            return Err(format!("velocity {next} of {limit}"));
        }
        if ahead.abs() > allowed + 1.0 {
            return Err(format!(
                "position {ahead} of {max}, overrun to {}",
                self.overrun_ends
            ));
        }
        if (self.position + velocity - position).abs() > 0.5 * bit {
            return Err(format!(
                "position {position} is not {} + {velocity}",
                self.position
            ));
        }
        if (velocity - self.velocity).abs() > acceleration + 12.5 * bit && !limits_changed {
            return Err(format!(
                "acceleration {} of {acceleration}",
                velocity - self.velocity
            ));
        }
        (self.position, self.velocity) = (position, velocity);
        Ok(())
    }
}

#[test]
fn whatever_comes_the_commanded_track_keeps_its_limits() {
    let cases = ticks() / TICKS_PER_CASE as u32;
    let events = proptest::collection::vec((event(), 1_usize..40), TICKS_PER_CASE / 20);
    let settings = ProptestConfig {
        cases,
        failure_persistence: None,
        ..ProptestConfig::default()
    };
    let mut runner = proptest::test_runner::TestRunner::new(settings);
    let result = runner.run(&events, |events| {
        let (mut storm, mut watch) = (Storm::new(), Watch::default());
        for (event, cycles) in events {
            storm.take(&event);
            let mut limits_changed = matches!(event, Event::Limits(..));
            for cycle in 0..cycles {
                let reference = storm.step();
                let checked = watch.check(&reference, &storm.config, limits_changed);
                limits_changed = false;
                prop_assert!(
                    checked.is_ok(),
                    "{event:?}, cycle {cycle}: {}",
                    checked.unwrap_err()
                );
            }
        }
        Ok(())
    });
    assert!(result.is_ok(), "{}", result.unwrap_err());
}
