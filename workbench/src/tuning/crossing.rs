//! How a gap is crossed: while the force behind it goes through a band about zero.
//!
//! A narrow band is crossed where the gap is, but within it the motor has to go from one flank to
//! the other: after a reversal at an acceleration a the table is `x₀` on when its friction is zero,
//! at the velocity `√(2 a x₀)`, and takes `Δx` from one end of the band to the other. A motor that
//! may be accelerated by A crosses a gap g meanwhile gently where `Δx² ≥ 12 a x₀ g / A`.
//!
//! After slower reversals it has more time, and the drive makes the band narrower in proportion to
//! the velocity of the table.

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
const SHARE: f64 = 0.9;
/// The band is as wide from this share of the velocity on that the table has after that reversal
/// where the crossing begins. With a little more than all of it (1.04) the band is narrower there
/// already, and a copy of the reference machine without Stribeck fall behind a gap of 30 µm was
/// left 4.3 µm at R 100 F 8000 for 1.6; with two thirds of it copies with gaps of 20 to 40 µm were
/// left 1.5 to 1.6 times as much at F 2000 (2026-11-28).
const WIDE_FROM: f64 = 0.85;

/// Where a gap is crossed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Crossing {
    /// Force within which it is crossed, to either side, N.
    pub(super) force_n: f64,
    /// Velocity of the table from which on it is that force, m/s.
    pub(super) velocity_m_per_s: f64,
}

impl Crossing {
    /// By a motor that may be accelerated so.
    #[must_use]
    pub(super) fn of(model: &Model, limit_m_per_s2: f64) -> Self {
        let force_n = band_n(model, limit_m_per_s2).max(1.0);
        let begins_m = ends_m(model, force_n).map(|[begin_m, _]| begin_m);
        let begins_m = begins_m.into_iter().fold(f64::INFINITY, f64::min);
        Self {
            force_n,
            velocity_m_per_s: WIDE_FROM * (2.0 * REVERSAL_M_PER_S2 * begins_m).sqrt(),
        }
    }
}

fn band_n(model: &Model, limit_m_per_s2: f64) -> f64 {
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
    ends_m(model, band_n).into_iter().all(|[begin_m, end_m]| {
        let (middle_m, over_m) = (0.5 * (begin_m + end_m), end_m - begin_m);
        let wanted_m2 =
            12.0 * REVERSAL_M_PER_S2 * middle_m * model.gap_m / (SHARE * limit_m_per_s2);
        over_m * over_m >= wanted_m2
    })
}

/// Ways after reversals of either direction at which a band begins and ends.
fn ends_m(model: &Model, band_n: f64) -> [[f64; 2]; 2] {
    [-1.0, 1.0].map(|direction| {
        let zero_n = direction * model.table_force_n;
        [band_n, -band_n].map(|off_n| way_m(model, off_n - zero_n))
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
    fn a_band_is_as_wide_before_the_reversal_begins_to_cross() {
        // 360 N of the table; a fifth of it is two fifths of 20 µm on.
        let own = Crossing::of(&spring(1.0e-6), 5.0);
        assert!((own.force_n - 72.0).abs() < 1.0e-9, "{own:?}");
        let begins_m_per_s = (2.0 * REVERSAL_M_PER_S2 * 8.0e-6_f64).sqrt();
        let wanted = WIDE_FROM * begins_m_per_s;
        assert!((own.velocity_m_per_s - wanted).abs() < 1.0e-9, "{own:?}");
        let mut heavy = spring(1.0e-6);
        heavy.table_force_n = 200.0;
        assert!(Crossing::of(&heavy, 5.0).velocity_m_per_s < own.velocity_m_per_s);
    }

    #[test]
    fn a_wide_gap_is_crossed_within_a_wide_band_and_a_strong_motor_needs_less() {
        // Δx = share · 20 µm; 12 a x₀ g / (0.9 A) = (8.7 µm)² at 5 m/s² and 16 µm.
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
