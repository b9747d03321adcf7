//! Friction that is a smooth function of the table position: factor 1 + k x + q x².

use axis_model::PositionDependentFriction;

use super::{Instant, Simulated};

impl Simulated for PositionDependentFriction {
    fn friction_factor(&self, at: &Instant) -> f64 {
        let curved = self.quadratic.unwrap_or(0.0) * at.table_m * at.table_m;
        1.0 + self.linear * at.table_m + curved
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_factor_is_one_at_zero_and_a_parabola_about_it() {
        let friction = PositionDependentFriction {
            linear: 0.8,
            quadratic: Some(-2.0),
        };
        let factor = |table_m| {
            friction.friction_factor(&Instant {
                table_m,
                ..Instant::default()
            })
        };
        assert_eq!(factor(0.0), 1.0);
        assert!((factor(0.1) - 1.06).abs() < 1.0e-12 && (factor(-0.1) - 0.90).abs() < 1.0e-12);
    }
}
