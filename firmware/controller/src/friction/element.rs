//! A Maxwell-slip element.

use fixed::types::{I3F29, I8F24, I35F29};

use crate::units::Velocity;

/// A spring that slips at a level.
///
/// What it remembers is its strain: torque over level, so that all elements have one limit, the
/// factor on the levels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Element {
    /// Strain per way of 10 nm: one over the way after which it slips.
    pub per_way: I8F24,
    /// Level at which it slips, µN·m; below 2²⁸.
    pub level_micro_nm: i32,
    /// What of it is the table's, and winds the screw up.
    pub table_micro_nm: i32,
}

/// Torque over level.
pub(super) type Strain = I3F29;

impl Element {
    /// Its strain after a way.
    pub(super) fn moved(self, strain: Strain, way: Velocity, limit: Strain) -> Strain {
        // 20.12 times 8.24 bits: 28.36 bits, exact; 29 of the fractional ones stay.
        let bent = way.0.wide_mul(self.per_way).to_bits().wrapping_shr(7);
        let sum = bent.wrapping_add(i64::from(strain.to_bits()));
        let limit = i64::from(limit.to_bits());
        let kept = sum.min(limit).max(limit.wrapping_neg());
        // Within the limits: nothing is lost.
        Strain::wrapping_from_num(I35F29::from_bits(kept))
    }

    /// Its torque and what of it is the table's, µN·m with 29 fractional bits: below 2⁵⁹, so that
    /// ten of them have room.
    pub(super) fn torque(self, strain: Strain) -> [i64; 2] {
        let of = |level: i32| i64::from(level).wrapping_mul(i64::from(strain.to_bits()));
        [of(self.level_micro_nm), of(self.table_micro_nm)]
    }
}

/// The limit of all strains at a factor on the levels: below 4.
pub(super) fn limit(factor: I8F24) -> Strain {
    Strain::saturating_from_num(factor)
}
