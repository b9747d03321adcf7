//! The four reversals of a circle, and the window in which each is looked at.

use std::f64::consts::{FRAC_PI_2, TAU};

/// The four reversals in the order they are passed: angle travelled, axis, name.
pub const REVERSALS: [(f64, usize, &str); 4] = [
    (FRAC_PI_2, 0, "X at its far end"),
    (2.0 * FRAC_PI_2, 1, "Y at its far end"),
    (3.0 * FRAC_PI_2, 0, "X at its near end"),
    (0.0, 1, "Y at its near end"),
];

/// Half width of the window about a reversal, rad.
#[must_use]
pub fn window_rad(radius_m: f64, backlash_m: f64) -> f64 {
    (15.0_f64.to_radians()).max(1.5 * (2.0 * backlash_m / radius_m).sqrt())
}

/// Distance of two angles, 0…π.
#[must_use]
pub fn apart(a: f64, b: f64) -> f64 {
    let turn = (a - b).rem_euclid(TAU);
    turn.min(TAU - turn)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_are_apart_by_the_shorter_way_round() {
        assert!((apart(0.1, TAU - 0.1) - 0.2).abs() < 1.0e-12);
        assert!((apart(9.0 * TAU, FRAC_PI_2) - FRAC_PI_2).abs() < 1.0e-12);
    }

    #[test]
    fn a_gap_widens_the_window_only_where_it_is_large_for_the_radius() {
        let least = 15.0_f64.to_radians();
        assert!((window_rad(0.1, 10.0e-6) - least).abs() < 1.0e-12);
        assert!((window_rad(0.001, 0.5e-3) - 1.5).abs() < 1.0e-12);
    }
}
