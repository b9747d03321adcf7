//! What a ballbar shows of a reference circle: reversal bursts, and the figures of ISO 230-4.
//!
//! Deviation is that of the table's true position; where no instrument sees it (over a cable), that
//! of the load scale. All figures in µm.
//!
//! - burst at a reversal: largest |radial deviation − median| within ±max(15°, 1.5·√(2·gap/R)) of
//!   it, mean of the turns;
//! - circular deviation G: smallest separation of two circles about the least-squares centre that
//!   enclose the path of all turns;
//! - radial deviations Fmax and Fmin: from the nominal radius about the nominal centre;
//! - circular hysteresis H: largest difference of the radii of a clockwise and a counter-clockwise
//!   path;
//! - step of an axis: width between the two directions of table − motor at equal motor position;
//! - ellipse: second harmonic of the deviation outside the bursts, from different gains of the
//!   axes.

use std::f64::consts::{FRAC_PI_2, TAU};

use serde::Serialize;

/// One sample of a circle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Angle travelled, rad, from X = 0, Y = −R.
    pub angle_rad: f64,
    /// Table, m.
    pub table_m: [f64; 2],
    /// Motors at the table, m.
    pub motor_m: [f64; 2],
    /// Setpoint, m.
    pub reference_m: [f64; 2],
}

/// The four reversals in the order they are passed: angle travelled, axis, name.
pub const REVERSALS: [(f64, usize, &str); 4] = [
    (FRAC_PI_2, 0, "X at its far end"),
    (2.0 * FRAC_PI_2, 1, "Y at its far end"),
    (3.0 * FRAC_PI_2, 0, "X at its near end"),
    (0.0, 1, "Y at its near end"),
];

/// Figures of one circle.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CircleFigures {
    /// Burst at each reversal, in the order of [`REVERSALS`].
    pub peak_um: [f64; 4],
    /// Largest of them.
    pub peak_max_um: f64,
    /// Circular deviation G.
    pub circular_deviation_g_um: f64,
    /// Circular hysteresis H; `None` where only one direction was run.
    pub circular_hysteresis_h_um: Option<f64>,
    /// Largest radial deviation.
    pub radial_deviation_fmax_um: f64,
    /// Smallest radial deviation.
    pub radial_deviation_fmin_um: f64,
    /// Step of X and Y.
    pub step_um: [f64; 2],
    /// Amplitude of the ellipse.
    pub ellipse_um: f64,
    /// Median radial deviation.
    pub median_um: f64,
}

/// Figures of the turns that count.
///
/// `backlash_m` widens the window about the reversals. An empty path gives zeros.
#[must_use]
pub fn figures(points: &[Point], radius_m: f64, backlash_m: f64, from_rad: f64) -> CircleFigures {
    let deviation: Vec<f64> = points
        .iter()
        .map(|point| radial_um(point, radius_m))
        .collect();
    let median_um = median(&deviation);
    let window = window_rad(radius_m, backlash_m);
    let peak_um =
        REVERSALS.map(|(at, ..)| burst(points, &deviation, median_um, at, window, from_rad));
    CircleFigures {
        peak_um,
        peak_max_um: peak_um.into_iter().fold(0.0, f64::max),
        circular_deviation_g_um: circular_deviation(points),
        circular_hysteresis_h_um: None,
        radial_deviation_fmax_um: deviation.iter().copied().fold(f64::NEG_INFINITY, f64::max),
        radial_deviation_fmin_um: deviation.iter().copied().fold(f64::INFINITY, f64::min),
        step_um: [0, 1].map(|axis| step_um(points, axis, radius_m)),
        ellipse_um: ellipse_um(points, &deviation, window),
        median_um,
    }
}

/// Half width of the window about a reversal, rad.
#[must_use]
pub fn window_rad(radius_m: f64, backlash_m: f64) -> f64 {
    (15.0_f64.to_radians()).max(1.5 * (2.0 * backlash_m / radius_m).sqrt())
}

/// Radial deviation of a point, µm.
#[must_use]
pub fn radial_um(point: &Point, radius_m: f64) -> f64 {
    (point.table_m[0].hypot(point.table_m[1]) - radius_m) * 1.0e6
}

fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.get(sorted.len() / 2).copied().unwrap_or(0.0)
}

/// Distance of two angles, 0…π.
fn apart(a: f64, b: f64) -> f64 {
    let turn = (a - b).rem_euclid(TAU);
    turn.min(TAU - turn)
}

/// Mean over the turns of the largest deviation in the window. A diverged run has no burst but
/// `NaN`, so that it never looks perfect.
fn burst(
    points: &[Point],
    deviation: &[f64],
    median_um: f64,
    at: f64,
    window: f64,
    from_rad: f64,
) -> f64 {
    let mut largest: Vec<f64> = Vec::new();
    for (point, deviation) in points.iter().zip(deviation) {
        if apart(point.angle_rad, at) > window {
            continue;
        }
        // Turns counted so that a window is never cut in two: from the middle between reversals.
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a few turns, never negative"
        )]
        let turn = ((point.angle_rad - from_rad).max(0.0) / TAU) as usize;
        if largest.len() <= turn {
            largest.resize(turn + 1, 0.0);
        }
        let size = (deviation - median_um).abs();
        // `max` would drop a NaN.
        if size.is_nan() || size > largest[turn] {
            largest[turn] = size;
        }
    }
    if largest.is_empty() {
        0.0
    } else {
        largest.iter().sum::<f64>() / largest.len() as f64
    }
}

fn circular_deviation(points: &[Point]) -> f64 {
    let Some(center) = least_squares_center(points) else {
        return 0.0;
    };
    let radii = points
        .iter()
        .map(|point| (point.table_m[0] - center[0]).hypot(point.table_m[1] - center[1]));
    let (low, high) = radii.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), r| {
        (low.min(r), high.max(r))
    });
    (high - low) * 1.0e6
}

/// Least-squares circle by the linear (Kåsa) fit: x² + y² = 2 a x + 2 b y + c.
fn least_squares_center(points: &[Point]) -> Option<[f64; 2]> {
    let count = points.len() as f64;
    let mean = |value: &dyn Fn(&Point) -> f64| points.iter().map(value).sum::<f64>() / count;
    let (mx, my) = (mean(&|p| p.table_m[0]), mean(&|p| p.table_m[1]));
    let mut sums = [0.0; 5];
    for point in points {
        let (x, y) = (point.table_m[0] - mx, point.table_m[1] - my);
        let square = x * x + y * y;
        for (sum, value) in sums
            .iter_mut()
            .zip([x * x, x * y, y * y, x * square, y * square])
        {
            *sum += value;
        }
    }
    let [xx, xy, yy, xs, ys] = sums;
    let determinant = xx * yy - xy * xy;
    (determinant > 0.0).then(|| {
        [
            mx + 0.5 * (xs * yy - ys * xy) / determinant,
            my + 0.5 * (ys * xx - xs * xy) / determinant,
        ]
    })
}

const STEP_BINS: usize = 20;

/// Width between the directions of table − motor, by bins of motor position away from the ends
/// (there the gap is being crossed).
fn step_um(points: &[Point], axis: usize, radius_m: f64) -> f64 {
    let mut bins = vec![[(0.0, 0_u32); 2]; STEP_BINS];
    for pair in points.windows(2) {
        let point = &pair[1];
        let along = point.motor_m[axis] / radius_m + 0.5;
        if !(0.0..1.0).contains(&along) {
            continue;
        }
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "0 to 19"
        )]
        let bin = (along * STEP_BINS as f64) as usize;
        let forward = usize::from(point.reference_m[axis] >= pair[0].reference_m[axis]);
        let (sum, count) = &mut bins[bin.min(STEP_BINS - 1)][forward];
        *sum += point.table_m[axis] - point.motor_m[axis];
        *count += 1;
    }
    let width = |[back, forth]: &[(f64, u32); 2]| {
        (back.1 > 0 && forth.1 > 0)
            .then(|| (back.0 / f64::from(back.1) - forth.0 / f64::from(forth.1)) * 1.0e6)
    };
    median(&bins.iter().filter_map(width).collect::<Vec<_>>())
}

/// Amplitude of cos 2θ and sin 2θ by projection, window by window symmetric so that the harmonics
/// stay orthogonal.
fn ellipse_um(points: &[Point], deviation: &[f64], window: f64) -> f64 {
    let quiet = |angle: f64| REVERSALS.iter().all(|(at, ..)| apart(angle, *at) > window);
    let mut sums = [0.0; 6];
    for (point, deviation) in points
        .iter()
        .zip(deviation)
        .filter(|(point, _)| quiet(point.angle_rad))
    {
        let (sin, cos) = (2.0 * point.angle_rad).sin_cos();
        for (sum, value) in sums.iter_mut().zip([
            1.0,
            *deviation,
            cos * deviation,
            sin * deviation,
            cos * cos,
            sin * sin,
        ]) {
            *sum += value;
        }
    }
    let [_, _, cos, sin, cos_cos, sin_sin] = sums;
    if cos_cos > 0.0 && sin_sin > 0.0 {
        (cos / cos_cos).hypot(sin / sin_sin)
    } else {
        0.0
    }
}

/// Circular hysteresis H, µm: largest difference of the mean radii of the two directions at equal
/// place on the circle.
#[must_use]
pub fn hysteresis_um(counter_clockwise: &[Point], clockwise: &[Point], radius_m: f64) -> f64 {
    const BINS: usize = 720;
    let profile = |points: &[Point]| {
        let mut bins = vec![(0.0, 0_u32); BINS];
        for point in points {
            let place = point.table_m[1].atan2(point.table_m[0]).rem_euclid(TAU) / TAU;
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "0 to 719"
            )]
            let bin = &mut bins[((place * BINS as f64) as usize).min(BINS - 1)];
            *bin = (bin.0 + radial_um(point, radius_m), bin.1 + 1);
        }
        bins
    };
    let (a, b) = (profile(counter_clockwise), profile(clockwise));
    let both = a.iter().zip(&b).filter(|(a, b)| a.1 > 0 && b.1 > 0);
    both.map(|(a, b)| (a.0 / f64::from(a.1) - b.0 / f64::from(b.1)).abs())
        .fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trajectory::MEASURE_FROM_RAD;

    fn path(shape: impl Fn(f64) -> f64) -> Vec<Point> {
        (0..60_000)
            .map(|i| {
                let angle = MEASURE_FROM_RAD + 6.0 * std::f64::consts::PI * f64::from(i) / 60_000.0;
                let radius = 0.1 + shape(angle) * 1.0e-6;
                let at = [radius * angle.sin(), -radius * angle.cos()];
                Point {
                    angle_rad: angle,
                    table_m: at,
                    motor_m: at,
                    reference_m: at,
                }
            })
            .collect()
    }

    #[test]
    fn a_perfect_circle_has_no_deviation() {
        let figures = figures(&path(|_| 0.0), 0.1, 0.0, MEASURE_FROM_RAD);
        assert!(figures.peak_max_um < 1.0e-6 && figures.circular_deviation_g_um < 1.0e-6);
    }

    #[test]
    fn a_burst_is_found_at_its_reversal_and_nowhere_else() {
        let bump = |angle: f64| 12.0 * (-(apart(angle, FRAC_PI_2 + 0.05) / 0.02).powi(2)).exp();
        let figures = figures(&path(bump), 0.1, 0.0, MEASURE_FROM_RAD);
        assert!(
            (figures.peak_um[0] - 12.0).abs() < 0.01,
            "{:?}",
            figures.peak_um
        );
        assert!(figures.peak_um[1..].iter().all(|peak| *peak < 0.01));
        assert!(
            (figures.circular_deviation_g_um - 12.0).abs() < 0.5
                && (figures.radial_deviation_fmax_um - 12.0).abs() < 0.01
        );
    }

    #[test]
    fn an_ellipse_is_told_apart_from_bursts() {
        let figures = figures(
            &path(|angle| 3.0 * (2.0 * angle).cos()),
            0.1,
            0.0,
            MEASURE_FROM_RAD,
        );
        assert!(
            (figures.ellipse_um - 3.0).abs() < 0.01,
            "{}",
            figures.ellipse_um
        );
    }
}
