//! A Maxwell-slip element.

use fixed::types::{I8F24, I40F24};

use super::path::Path;
use crate::units::{Velocity, VelocityGain};

/// A spring that slips at a level.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Element {
    /// Torque per way, until it slips.
    pub stiffness: VelocityGain,
    /// Level at which it slips, µN·m; below 2²⁸.
    pub level_micro_nm: i32,
}

impl Element {
    /// Its torque after a path.
    pub(super) fn passed(self, torque: I40F24, path: &Path, factor: I8F24) -> I40F24 {
        let on = self.moved(torque, path.on, factor);
        path.back.map_or(on, |back| self.moved(on, back, factor))
    }

    fn moved(self, torque: I40F24, way: Velocity, factor: I8F24) -> I40F24 {
        // A level is below 2²⁸, a factor below 2³¹ bits: their product has 24 fractional bits.
        let level = I40F24::from_bits(
            i64::from(self.level_micro_nm).wrapping_mul(i64::from(factor.to_bits())),
        );
        let sprung = torque.saturating_add(self.stiffness.times(way).0);
        sprung.min(level).max(level.saturating_neg())
    }
}
