//! Errors of the load's scale that are periodic in the position: what motor − load has of them.
//!
//! Two derivatives make a force of it: 3 µm over a lead of 10 mm are 0.06 m/s² at 0.225 m/s, beside
//! the inertia of a load of 300 kg 18 N that never were. They look like a ripple of the motor.

use std::f64::consts::TAU;

/// One of them: `cos · cos(2πkx) + sin · sin(2πkx)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ScaleError {
    /// Wave number k, one over a length.
    pub per_length: f64,
    /// Part of the cosine, a length.
    pub cos: f64,
    /// Part of the sine, a length.
    pub sin: f64,
}

impl ScaleError {
    /// At a position of the motor.
    #[must_use]
    fn at(&self, x: f64) -> f64 {
        let (sin, cos) = (TAU * self.per_length * x).sin_cos();
        self.cos * cos + self.sin * sin
    }
}

/// All of them at positions of the motor.
#[must_use]
pub(crate) fn along(errors: &[ScaleError], positions: &[f64]) -> Vec<f64> {
    let at = |x: &f64| errors.iter().map(|error| error.at(*x)).sum();
    positions.iter().map(at).collect()
}
