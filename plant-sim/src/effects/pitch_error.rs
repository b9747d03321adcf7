//! A load scale that is off by a sine of the table position: A sin(2π x / p).

use std::f64::consts::TAU;

use axis_model::PitchError;

use super::Simulated;

impl Simulated for PitchError {
    fn scale_error_m(&self, table_m: f64) -> f64 {
        self.amplitude * (TAU * table_m / self.period).sin()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_scale_is_off_by_the_amplitude_after_a_quarter_of_the_period() {
        let pitch = PitchError {
            amplitude: 3.0e-6,
            period: 0.004,
        };
        assert_eq!(pitch.scale_error_m(0.0), 0.0);
        assert!((pitch.scale_error_m(0.001) - 3.0e-6).abs() < 1.0e-15);
        assert!((pitch.scale_error_m(0.003) + 3.0e-6).abs() < 1.0e-15);
    }
}
