//! The force acts later by a time; the axis keeps the old one until then, at most for a cycle.

use axis_model::Delay;

use super::Simulated;

impl Simulated for Delay {
    fn delay_s(&self) -> f64 {
        self.delay
    }
}
