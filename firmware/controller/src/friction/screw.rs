//! How much farther than the table the motor stands: wind-up of the screw, and the gap.

use fixed::types::{I4F28, I20F12};

use super::coarse;
use crate::units::{Acceleration, AccelerationGain, Torque, Velocity};

/// What is between motor and table.
///
/// The screw is wound up by what it transmits, `F / K`. A gap is crossed where that changes sign:
/// the motor stands half of it farther on the side of the force, and goes across within a band of
/// the force about zero. Wind-up is that of friction; a gap goes by the acceleration of the table
/// as well.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Screw {
    /// Wind-up per torque, 10 nm per µN·m.
    pub compliance: I4F28,
    /// Half the gap, 10 nm; zero: none.
    pub half_gap: I20F12,
    /// Way across it per torque within the band, 10 nm per µN·m.
    pub gap_per_torque: I4F28,
    /// Torque per acceleration of the table.
    pub table_inertia: AccelerationGain,
    /// Across a gap the motor gets torque for no more acceleration than the axis may have.
    pub acceleration_limit: Velocity,
}

impl Screw {
    /// An acceleration of the motor beside that of the table, within the limit where it crosses a
    /// gap.
    pub(super) fn within_limit(&self, acceleration: Velocity) -> Velocity {
        if self.half_gap > I20F12::ZERO {
            acceleration.limited(self.acceleration_limit)
        } else {
            acceleration
        }
    }

    /// The way at a torque of friction of the table and an acceleration.
    pub(super) fn way(&self, friction: Torque, acceleration: Acceleration) -> Velocity {
        let wound = wound_by(self.compliance, friction);
        if self.half_gap <= I20F12::ZERO {
            return Velocity(wound);
        }
        let transmitted = friction.plus(self.table_inertia.times(acceleration));
        let across = Velocity(wound_by(self.gap_per_torque, transmitted));
        Velocity(wound).plus(across.limited(Velocity(self.half_gap)))
    }
}

/// 30.2 bits times 4.28 bits are 34.30 bits, exact.
fn wound_by(per_torque: I4F28, torque: Torque) -> I20F12 {
    I20F12::saturating_from_num(coarse(torque).wide_mul(per_torque))
}
