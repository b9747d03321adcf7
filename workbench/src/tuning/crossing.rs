//! How a gap is crossed: while the force behind it goes through a band about zero.
//!
//! A narrow band is crossed where the gap is, but within it the motor has to go from one flank to
//! the other: after a reversal at an acceleration a the table is `x₀` on when its friction is zero,
//! at the velocity `√(2 a x₀)`, and takes `Δx` from one end of the band to the other. A motor that
//! may be accelerated by A crosses a gap g meanwhile where `Δx² ≥ 8 a x₀ g / A`.

use crate::compensation::Model;

/// The band goes to this share of the table's friction to either side, or farther. Within a
/// fiftieth the machine 106 of `--bench drawn` was left 20 µm at F 8000 (2.9 within a tenth),
/// within a third the others half as much again (2026-11-27).
const NARROWEST: f64 = 0.2;
/// No farther than to this share of what the friction comes to: beyond, the gap would not be
/// crossed altogether.
const WIDEST: f64 = 0.9;
const STEP: f64 = 0.02;
/// The reversal that a motor is to follow: R 100 mm at F 8000 mm/min, and what of its acceleration
/// it may take for that. Faster ones stay with what the limit leaves.
const REVERSAL_M_PER_S2: f64 = 0.178;
const SHARE: f64 = 0.6;

/// Force to either side within which a gap is crossed, N, by a motor that may be accelerated so.
#[must_use]
pub(super) fn band_n(model: &Model, limit_m_per_s2: f64) -> f64 {
    let all_n = model.table_n();
    let mut share = NARROWEST;
    while share < WIDEST && !has_time(model, share * all_n, limit_m_per_s2) {
        share += STEP;
    }
    // What is transmitted has to come to both ends of it.
    let comes_to_n = all_n - model.table_force_n.abs();
    (share * all_n).min(WIDEST * comes_to_n.max(0.0))
}

/// Whether a band is wide enough after reversals of either direction: a constant force lets one be
/// crossed early and the other one late.
fn has_time(model: &Model, band_n: f64, limit_m_per_s2: f64) -> bool {
    [-1.0, 1.0].into_iter().all(|direction| {
        let zero_n = direction * model.table_force_n;
        let [begin_m, end_m] = [band_n, -band_n].map(|off_n| way_m(model, off_n - zero_n));
        let (middle_m, over_m) = (0.5 * (begin_m + end_m), end_m - begin_m);
        let wanted_m2 = 8.0 * REVERSAL_M_PER_S2 * middle_m * model.gap_m / (SHARE * limit_m_per_s2);
        over_m * over_m >= wanted_m2
    })
}

/// Friction of the table at a way from rest.
fn table_n(model: &Model, way_m: f64) -> f64 {
    let springs = model
        .level_n
        .iter()
        .zip(&model.slip_m)
        .zip(&model.motor_share);
    springs
        .map(|((level_n, slip_m), of_motor)| level_n * (1.0 - of_motor) * (way_m / slip_m).min(1.0))
        .sum()
}

/// The way after a reversal at which friction of the table has come from all of it to a force, by
/// Masing's rule.
fn way_m(model: &Model, force_n: f64) -> f64 {
    let all_n = model.table_n();
    let farthest_m = 2.0
        * model
            .slip_m
            .iter()
            .fold(0.0, |most: f64, own| most.max(*own));
    let (mut near_m, mut far_m) = (0.0, farthest_m);
    for _ in 0..60 {
        let middle_m = 0.5 * (near_m + far_m);
        if all_n - 2.0 * table_n(model, 0.5 * middle_m) > force_n {
            near_m = middle_m;
        } else {
            far_m = middle_m;
        }
    }
    far_m
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One spring of 400 N that slips after 10 µm, a tenth of it at the motor.
    fn spring(gap_m: f64) -> Model {
        let mut model = Model {
            gap_m,
            ..Model::OFF
        };
        model.level_n[0] = 400.0;
        model.motor_share[0] = 0.1;
        model
    }

    #[test]
    fn the_way_after_a_reversal_is_masings() {
        // 360 N of the table: half of twice 10 µm to zero, three quarters to half the other way.
        for (force_n, wanted_m) in [(0.0, 1.0e-5), (-180.0, 1.5e-5), (180.0, 5.0e-6)] {
            let way_m = way_m(&spring(0.0), force_n);
            assert!((way_m - wanted_m).abs() < 1.0e-10, "{force_n}: {way_m}");
        }
    }

    #[test]
    fn a_wide_gap_is_crossed_within_a_wide_band_and_a_strong_motor_needs_less() {
        // Δx = share · 20 µm; 8 a x₀ g / (0.6 A) = (8.7 µm)² at 5 m/s² and 16 µm.
        let share = |gap_m: f64, limit: f64| band_n(&spring(gap_m), limit) / 360.0;
        assert!((share(1.0e-6, 5.0) - NARROWEST).abs() < 1.0e-9);
        let wide = share(1.6e-5, 5.0);
        assert!((0.43..0.46).contains(&wide), "{wide}");
        assert!(share(1.6e-5, 20.0) < 0.6 * wide);
        assert!(share(1.0e-3, 1.0) <= WIDEST);
        let mut heavy = spring(1.6e-5);
        heavy.table_force_n = -300.0;
        assert!(band_n(&heavy, 5.0) <= WIDEST * 60.0 + 1.0e-9);
    }
}
