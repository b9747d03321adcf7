//! Circular deviation G and circular hysteresis H of ISO 230-4: how round the path is.

use std::f64::consts::TAU;

use super::point::{Point, radial_um};

/// Circular deviation G, µm: separation of the circles about the least-squares centre that enclose
/// the path. ISO 230-4:2022 defines it by the centre of the smallest separation and lets that of
/// the least-squares circle stand for it; ours is never smaller. `NaN` where there is no circle,
/// so that nothing passes for it.
#[must_use]
pub fn circular_deviation_um(points: &[Point]) -> f64 {
    enclosed(points).map_or(f64::NAN, |(_, [low, high])| (high - low) * 1.0e6)
}

/// Least-squares centre of a path, m, and the radii about it of the circles that enclose it, m.
fn enclosed(points: &[Point]) -> Option<([f64; 2], [f64; 2])> {
    let center = least_squares_center(points)?;
    let radii = points
        .iter()
        .map(|point| (point.table_m[0] - center[0]).hypot(point.table_m[1] - center[1]));
    let (low, high) = radii.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), r| {
        (low.min(r), high.max(r))
    });
    Some((center, [low, high]))
}

/// The zone of a path: its middle, m, and the mean of the radii of the circles that enclose it, m.
#[must_use]
pub fn zone_m(points: &[Point]) -> Option<([f64; 2], f64)> {
    let (center, [low, high]) = enclosed(points)?;
    Some((center, 0.5 * (low + high)))
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

    fn circle_about(center_m: [f64; 2]) -> Vec<Point> {
        let point = |i: u32| {
            let angle_rad = TAU * f64::from(i) / 3600.0;
            let (sin, cos) = angle_rad.sin_cos();
            let at = [center_m[0] + 0.1 * sin, center_m[1] - 0.1 * cos];
            Point {
                angle_rad,
                table_m: at,
                motor_m: at,
                reference_m: at,
            }
        };
        (0..3600).map(point).collect()
    }

    #[test]
    fn a_round_path_beside_the_nominal_centre_is_round_all_the_same() {
        let beside = circle_about([3.0e-6, -2.0e-6]);
        assert!(circular_deviation_um(&beside) < 1.0e-6);
        let [x_m, y_m] = least_squares_center(&beside).unwrap();
        assert!((x_m - 3.0e-6).abs() < 1.0e-12 && (y_m + 2.0e-6).abs() < 1.0e-12);
    }

    #[test]
    fn a_path_without_points_has_no_centre_and_no_deviation() {
        assert_eq!(least_squares_center(&[]), None);
        assert!(circular_deviation_um(&[]).is_nan());
    }
}
