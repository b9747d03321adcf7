//! The motion of a record: sums of sines, slow moves and fast ones, with rests between them.

use std::f64::consts::TAU;

use super::PERIOD_S;
use super::draws::Draws;

/// Furthest from the middle, m.
const REACH_M: f64 = 0.14;
/// Longest way of a slow move, m.
const SLOW_REACH_M: f64 = 0.02;
/// Acceleration of slow moves, m/s².
const SLOW_ACCELERATION_M_PER_S2: f64 = 0.3;
/// Largest slope of [`smooth`]: a smoothed change takes this much longer than a ramp.
const LONGER_BY: f64 = 1.875;

/// Positions of a motion, one for each row.
pub(super) fn path(rows: usize, draws: &mut Draws) -> Vec<f64> {
    let mut path = vec![0.0; rows_of(draws.between(0.2, 0.6))];
    while path.len() < rows {
        let here = last(&path);
        path.extend(piece(here, draws));
        let rest = rows_of(draws.between(0.02, 0.3));
        path.extend(std::iter::repeat_n(last(&path), rest));
    }
    path.truncate(rows);
    path
}

fn last(path: &[f64]) -> f64 {
    path.last().copied().unwrap_or(0.0)
}

const fn rows_of(duration_s: f64) -> usize {
    (duration_s / PERIOD_S) as usize
}

/// A third sines, a quarter slow moves, the rest fast ones.
fn piece(here: f64, draws: &mut Draws) -> Vec<f64> {
    let kind = draws.between(0.0, 3.0);
    if kind < 1.0 {
        sines(here, draws)
    } else if kind < 1.7 {
        slow(here, draws)
    } else {
        trapezoid(here, draws)
    }
}

/// Two sines in a smooth window; back to where it began.
fn sines(here: f64, draws: &mut Draws) -> Vec<f64> {
    let duration_s = draws.between(2.0, 4.0);
    let hz = [draws.between(0.4, 0.9), draws.between(1.0, 3.0)];
    let speed = [draws.between(0.02, 0.15), draws.between(0.005, 0.05)];
    let phase = draws.between(0.0, TAU);
    let position = |row: usize| {
        let t = PERIOD_S * row as f64;
        let window = smooth(2.0 * t) * smooth(2.0 * (duration_s - t));
        let part =
            |i: usize, phase: f64| speed[i] / (TAU * hz[i]) * (TAU * hz[i] * t + phase).sin();
        here + window * (part(0, 0.0) + part(1, phase))
    };
    (0..rows_of(duration_s)).map(position).collect()
}

/// Slow moves there and back.
fn slow(here: f64, draws: &mut Draws) -> Vec<f64> {
    let velocity = 1.0e-3 * 10.0_f64.powf(draws.between(0.2, 1.3));
    let way = (velocity * draws.between(0.4, 1.2)).min(SLOW_REACH_M);
    let there = here + if here > 0.0 { -way } else { way };
    [
        ramp(here, there, velocity, SLOW_ACCELERATION_M_PER_S2),
        ramp(there, here, velocity, SLOW_ACCELERATION_M_PER_S2),
    ]
    .concat()
}

/// A fast move elsewhere.
fn trapezoid(here: f64, draws: &mut Draws) -> Vec<f64> {
    let target = draws.between(-REACH_M, REACH_M);
    let velocity = draws.between(0.05, 0.30);
    ramp(here, target, velocity, draws.between(0.5, 3.0))
}

/// A move with a limited velocity and acceleration, smoothed.
fn ramp(from: f64, to: f64, velocity: f64, acceleration: f64) -> Vec<f64> {
    let way = (to - from).abs();
    let velocity = velocity.min((way * acceleration).sqrt());
    if way == 0.0 {
        return Vec::new();
    }
    let speeding_s = LONGER_BY * velocity / acceleration;
    let duration_s = way / velocity + speeding_s;
    let mut x = 0.0;
    let position = |row: usize| {
        let t = PERIOD_S * row as f64;
        x += PERIOD_S * velocity * smooth(t / speeding_s) * smooth((duration_s - t) / speeding_s);
        from + (to - from).signum() * x.min(way)
    };
    (0..=rows_of(duration_s)).map(position).collect()
}

/// From 0 at 0 to 1 at 1 with slope and curvature zero at both ends.
fn smooth(u: f64) -> f64 {
    let u = u.clamp(0.0, 1.0);
    u.powi(3) * (10.0 - 15.0 * u + 6.0 * u * u)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_motion_stays_on_the_table_and_below_half_a_metre_per_second() {
        for seed in 1..=20 {
            let path = path(30_000, &mut Draws::of(seed));
            assert_eq!(path.len(), 30_000);
            let furthest = path.iter().fold(0.0_f64, |far, x| far.max(x.abs()));
            let steps = path.windows(2).map(|pair| (pair[1] - pair[0]).abs());
            let fastest = steps.fold(0.0, f64::max) / PERIOD_S;
            assert!(
                (0.05..0.25).contains(&furthest),
                "seed {seed}: {furthest} m"
            );
            assert!((0.05..0.5).contains(&fastest), "seed {seed}: {fastest} m/s");
        }
    }

    #[test]
    fn a_ramp_ends_where_it_should_within_its_limits() {
        let ramp = ramp(0.01, -0.05, 0.2, 2.0);
        assert!((last(&ramp) + 0.05).abs() < 1.0e-4, "{}", last(&ramp));
        let velocity: Vec<f64> = ramp.windows(2).map(|x| (x[1] - x[0]) / PERIOD_S).collect();
        let fastest = velocity.iter().fold(0.0_f64, |v, x| v.max(-x));
        assert!((0.19..=0.2001).contains(&fastest), "{fastest} m/s");
        let steps = velocity.windows(2).map(|v| (v[1] - v[0]).abs() / PERIOD_S);
        let hardest = steps.fold(0.0, f64::max);
        assert!((1.8..2.1).contains(&hardest), "{hardest} m/s²");
    }
}
