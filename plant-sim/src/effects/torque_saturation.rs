//! The delivered force falls behind the commanded one: u / (1 + k |u|).

use axis_model::TorqueSaturation;

use super::Simulated;

impl Simulated for TorqueSaturation {
    fn delivered_n(&self, commanded_n: f64) -> f64 {
        commanded_n / (1.0 + self.torque_saturation * commanded_n.abs())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tenth_is_lost_where_the_force_is_a_ninth_of_one_over_k() {
        let saturation = TorqueSaturation {
            torque_saturation: 1.0e-4,
        };
        let delivered_n = 1.0e4 / 9.0 * 0.9;
        assert!((saturation.delivered_n(1.0e4 / 9.0) - delivered_n).abs() < 1.0e-9);
        assert!((saturation.delivered_n(-1.0e4 / 9.0) + delivered_n).abs() < 1.0e-9);
    }
}
