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
