//! Maxwell-slip elements: springs that slip at a level.
//!
//! What an element remembers is how far it is bent. A way adds to that as it is, so that a way
//! there and back leaves no trace, and a factor on its level is one on the way after which it
//! slips.

use fixed::types::{I20F12, U3F29, U17F15};

use super::path::Path;
use crate::units::{Coarse, Velocity, narrowed};

/// Elements of the model.
pub const ELEMENTS: usize = 10;

/// Ways after which they slip, 10 nm.
pub type SlipWays = [U17F15; ELEMENTS];

/// Their torques per way, level over way: µN·m with [`STIFFNESS_BITS`] fractional bits per 2⁻¹² of
/// 10 nm.
pub type Stiffnesses = [i32; ELEMENTS];

/// Fractional bits of a stiffness: 2⁷ µN·m per 2⁻¹² of 10 nm at most.
pub const STIFFNESS_BITS: u32 = 24;

/// The elements of both sides of the screw.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Elements {
    /// Ways after which they slip.
    pub ways: SlipWays,
    /// Their stiffnesses; the sum of their levels, stiffness times way, is the Coulomb torque.
    pub stiffnesses: Stiffnesses,
    /// What of them is the table's, and winds the screw up.
    pub of_table: Stiffnesses,
}

/// Friction of both sides of the screw, and what of it is the table's.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Force {
    pub(super) all: Coarse,
    pub(super) table: Coarse,
}

/// How far an element is bent, 10 nm.
pub(super) type Bend = I20F12;

/// How far all elements are bent.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Bends([Bend; ELEMENTS]);

impl Bends {
    /// They take a path, with a factor on their levels.
    pub(super) fn take(&mut self, ways: &SlipWays, path: &Path, factor: U3F29) {
        match path.back {
            None => self.go(ways, path.on, factor),
            Some(back) => self.turn(ways, [path.on, back], factor),
        }
    }

    fn go(&mut self, ways: &SlipWays, way: Velocity, factor: U3F29) {
        for (bend, slips_after) in self.0.iter_mut().zip(ways) {
            *bend = within(bend.saturating_add(way.0), limit(*slips_after, factor));
        }
    }

    /// Apart: inlined beside the other, limits would be kept from one to the other on a stack.
    #[inline(never)]
    fn turn(&mut self, ways: &SlipWays, [on, back]: [Velocity; 2], factor: U3F29) {
        for (bend, slips_after) in self.0.iter_mut().zip(ways) {
            let limit = limit(*slips_after, factor);
            let there = within(bend.saturating_add(on.0), limit);
            *bend = within(there.saturating_add(back.0), limit);
        }
    }

    /// Their torque with such stiffnesses, saturated. That of one is below 2⁵⁵.
    fn torque(&self, stiffnesses: &Stiffnesses) -> Coarse {
        let each = self.0.iter().zip(stiffnesses);
        let sum = each.fold(0_i64, |sum, (bend, stiffness)| {
            sum.wrapping_add(i64::from(*stiffness).wrapping_mul(i64::from(bend.to_bits())))
        });
        Coarse::from_bits(narrowed::<{ STIFFNESS_BITS - Coarse::FRAC_NBITS }>(sum))
    }

    /// What they hold.
    pub(super) fn force(&self, elements: &Elements) -> Force {
        Force {
            all: self.torque(&elements.stiffnesses),
            table: self.torque(&elements.of_table),
        }
    }
}

/// How far an element is bent at most.
fn limit(way: U17F15, factor: U3F29) -> Bend {
    // 17.15 times 3.29 bits, of which 12 fractional ones stay: the upper half of the product. A way
    // within 1.3 mm times less than 8 leaves the sign free up to a factor of 4.
    Bend::wrapping_from_num(way.wide_mul(factor))
}

/// Cut at the limit, and on the other side at 2⁻¹² beyond it: saturation does so in four
/// instructions on a Cortex-M4, where minimum and maximum take seven.
fn within(bend: Bend, limit: Bend) -> Bend {
    let beyond = Bend::MAX.wrapping_sub(limit);
    bend.saturating_add(beyond)
        .saturating_sub(beyond)
        .saturating_sub(beyond)
        .saturating_add(beyond)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_bend_is_cut_at_its_limit(bend in any::<i32>(), limit in 0..i32::MAX) {
            let cut = within(Bend::from_bits(bend), Bend::from_bits(limit)).to_bits();
            prop_assert_eq!(cut, bend.clamp(-limit - 1, limit));
        }
    }
}
