//! How much farther than the table the motor stands: wind-up of the screw, and the gap.

use fixed::types::{I4F28, I20F12};

use crate::units::{Acceleration, AccelerationGain, Coarse, Velocity, narrowed};

/// What is between motor and table.
///
/// The screw is wound up by what it transmits, `F / K`. A gap is crossed where that changes sign:
/// the motor stands half of it farther on the side of the force, and goes across within a band of
/// the force about zero. Wind-up is that of friction; a gap goes by what accelerates the table and
/// by its weight as well.
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
    /// Constant torque of the table, µN·m; below 2²⁸.
    pub table_micro_nm: i32,
    /// Across a gap the motor gets torque for no more acceleration than the axis may have.
    pub acceleration_limit: Velocity,
}

impl Screw {
    fn has_gap(&self) -> bool {
        self.half_gap > I20F12::ZERO
    }

    /// An acceleration of the motor beside that of the table, within the limit where it crosses a
    /// gap.
    pub(super) fn within_limit(&self, acceleration: Velocity) -> Velocity {
        if self.has_gap() {
            acceleration.limited(self.acceleration_limit)
        } else {
            acceleration
        }
    }

    /// What it transmits beside friction, where that counts.
    pub(super) fn beside_friction(&self, acceleration: Acceleration) -> Coarse {
        if self.has_gap() {
            let constant = Coarse::wrapping_from_num(self.table_micro_nm);
            constant.saturating_add(self.table_inertia.coarse(acceleration))
        } else {
            Coarse::ZERO
        }
    }

    /// The way at a torque of friction of the table and what is transmitted beside it.
    pub(super) fn way(&self, friction: Coarse, beside: Coarse) -> Velocity {
        let wound = wound_by(self.compliance, friction);
        if !self.has_gap() {
            return wound;
        }
        let across = wound_by(self.gap_per_torque, friction.saturating_add(beside));
        wound.plus(across.limited(Velocity(self.half_gap)))
    }
}

/// 30.2 bits times 4.28 bits are 34.30 bits, of which 12 fractional ones stay.
fn wound_by(per_torque: I4F28, torque: Coarse) -> Velocity {
    let product = per_torque.wide_mul(torque).to_bits();
    Velocity(I20F12::from_bits(narrowed::<18>(product)))
}
