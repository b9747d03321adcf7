//! The quintic smoothstep: from 0 to 1 over 0 ≤ u ≤ 1, at rest and without acceleration at both
//! ends.

/// `10 u³ − 15 u⁴ + 6 u⁵`.
pub(super) fn smoothstep(u: f64) -> f64 {
    u.powi(3) * (10.0 - 15.0 * u + 6.0 * u * u)
}

/// Its integral from 0 to `u`.
pub(super) fn smoothstep_area(u: f64) -> f64 {
    u.powi(4) * (2.5 - 3.0 * u + u * u)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_step_leads_from_0_to_1_and_is_symmetric_about_its_middle() {
        assert_eq!((smoothstep(0.0), smoothstep(1.0)), (0.0, 1.0));
        for u in [0.1, 0.25, 0.5] {
            assert!((smoothstep(u) + smoothstep(1.0 - u) - 1.0).abs() < 1.0e-15);
        }
    }

    #[test]
    fn the_area_is_the_integral_of_the_step() {
        let du = 1.0e-4;
        let mut sum = 0.0;
        for i in 0..10_000 {
            sum += du * smoothstep((f64::from(i) + 0.5) * du);
            let area = smoothstep_area(f64::from(i + 1) * du);
            assert!((sum - area).abs() < 1.0e-8, "{i}: {sum} {area}");
        }
    }
}
