//! How much farther than the table the motor stands: wind-up of the screw, and the gap.

use fixed::types::I4F28;

use super::gap::Gap;
use crate::units::{Acceleration, AccelerationGain, Coarse, Velocity, way_by};

/// What is between motor and table.
///
/// The screw is wound up by what it transmits, `F / K`. A gap is crossed where that changes sign:
/// the motor stands half of it farther on the side of the force, and goes across within a band of
/// the force about zero ([`Gap`]). Wind-up is that of friction; a gap goes by what accelerates the
/// table and by its weight as well.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Screw {
    /// Wind-up per torque, 10 nm per µN·m.
    pub compliance: I4F28,
    /// The gap.
    pub gap: Gap,
    /// Torque per acceleration of the table.
    pub table_inertia: AccelerationGain,
    /// Constant torque of the table, µN·m; below 2²⁸.
    pub table_micro_nm: i32,
    /// Across a gap the motor gets torque for no more acceleration than the axis may have.
    pub acceleration_limit: Velocity,
}

impl Screw {
    /// An acceleration of the motor beside that of the table, within the limit where it crosses a
    /// gap.
    pub(super) fn within_limit(&self, acceleration: Velocity) -> Velocity {
        if self.gap.is_there() {
            acceleration.limited(self.acceleration_limit)
        } else {
            acceleration
        }
    }

    /// What it transmits beside friction, where that counts.
    pub(super) fn beside_friction(&self, acceleration: Acceleration) -> Coarse {
        if self.gap.is_there() {
            let constant = Coarse::wrapping_from_num(self.table_micro_nm);
            constant.saturating_add(self.table_inertia.coarse(acceleration))
        } else {
            Coarse::ZERO
        }
    }

    /// The way at a torque of friction of the table and what is transmitted beside it, where the
    /// table goes at a velocity.
    pub(super) fn way(&self, friction: Coarse, beside: Coarse, velocity: Velocity) -> Velocity {
        let wound = way_by(self.compliance, friction);
        if !self.gap.is_there() {
            return wound;
        }
        let torque = friction.saturating_add(beside);
        wound.plus(self.gap.across(torque, velocity))
    }
}
