//! A constant force against positive motion, on the table.

use axis_model::Offset;

use super::{Instant, Simulated};

impl Simulated for Offset {
    fn table_n(&self, _: &Instant) -> f64 {
        -self.offset
    }
}
