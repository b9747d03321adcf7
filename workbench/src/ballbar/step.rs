//! The step of an axis: how far table and motor are apart between its two directions.

use super::median::median;
use super::point::Point;

const STEP_BINS: usize = 20;

/// Width between the directions of table − motor, by bins of motor position away from the ends
/// (there the gap is being crossed).
pub(super) fn step_um(points: &[Point], axis: usize, radius_m: f64) -> f64 {
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

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;

    #[test]
    fn a_table_that_hangs_behind_its_motor_by_half_a_gap_shows_the_gap_as_the_step_of_its_axis() {
        let (radius_m, gap_m) = (0.1, 10.0e-6);
        let point = |i: u32| {
            let angle_rad = TAU * f64::from(i) / 5000.0;
            let motor_m = [radius_m * angle_rad.sin(), -radius_m * angle_rad.cos()];
            let behind = 0.5 * gap_m * angle_rad.cos().signum();
            Point {
                angle_rad,
                table_m: [motor_m[0] - behind, motor_m[1]],
                motor_m,
                reference_m: motor_m,
            }
        };
        let points: Vec<Point> = (0..10_000).map(point).collect();
        let [x_um, y_um] = [0, 1].map(|axis| step_um(&points, axis, radius_m));
        assert!((x_um - 10.0).abs() < 1.0e-3, "{x_um}");
        assert!(y_um.abs() < 1.0e-6, "{y_um}");
    }
}
