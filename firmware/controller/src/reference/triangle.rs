//! The triangular filter for coarse setpoints: two moving averages of N = 2ⁿ cycles, one after the
//! other.
//!
//! ```text
//! s += x − x[N]      t += s − s[N]      y = t / N²
//! ```
//!
//! Its delay is N − 1 cycles for every frequency, its gain on a circle 1 − (ω N T)² / 12. Of the
//! rounding of whole µm its second difference leaves that of three values N cycles apart, over N².
//! With 7 cycles the reference axis had 19 N rms at R 100 F 500, 11 N at F 2000 and 44 N at F 100
//! (2026-11-21, the torque's difference from that of fine setpoints).

use fixed::types::I56F8;

/// Longest average: 16 cycles.
const LONGEST: usize = 16;
const LARGEST_LOG2: u8 = 4;

/// Memory of the filter.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Triangle {
    log2: u8,
    place: u8,
    positions: [i64; LONGEST],
    sums: [i64; LONGEST],
    sum: i64,
    double_sum: i64,
}

impl Triangle {
    /// Takes a position; gives the filtered one. Positions within ±2⁵⁴ bits: 256 of them stay
    /// within 64 bits.
    pub(super) fn step(&mut self, log2: u8, position: I56F8) -> I56F8 {
        let log2 = log2.min(LARGEST_LOG2);
        if log2 != self.log2 {
            *self = Self::at_rest(log2, position);
        }
        let place = usize::from(self.place);
        let (Some(oldest), Some(oldest_sum)) =
            (self.positions.get_mut(place), self.sums.get_mut(place))
        else {
            return position;
        };
        let newest = position.to_bits();
        self.sum = self
            .sum
            .wrapping_add(newest)
            .wrapping_sub(core::mem::replace(oldest, newest));
        self.double_sum = self
            .double_sum
            .wrapping_add(self.sum)
            .wrapping_sub(core::mem::replace(oldest_sum, self.sum));
        self.place =
            self.place.wrapping_add(1) & 1_u8.wrapping_shl(u32::from(log2)).wrapping_sub(1);
        I56F8::from_bits(rounded(self.double_sum, log2))
    }

    /// The newest position was off by so much (39 pm).
    pub(super) fn correct(&mut self, by: i64) {
        let newest = usize::from(
            self.place.wrapping_sub(1) & 1_u8.wrapping_shl(u32::from(self.log2)).wrapping_sub(1),
        );
        if let (Some(position), Some(sum)) =
            (self.positions.get_mut(newest), self.sums.get_mut(newest))
        {
            *position = position.wrapping_add(by);
            *sum = sum.wrapping_add(by);
            self.sum = self.sum.wrapping_add(by);
            self.double_sum = self.double_sum.wrapping_add(by);
        }
    }

    fn at_rest(log2: u8, position: I56F8) -> Self {
        let bits = position.to_bits();
        let sum = bits.wrapping_shl(u32::from(log2));
        let double_sum = sum.wrapping_shl(u32::from(log2));
        Self {
            log2,
            place: 0,
            positions: [bits; LONGEST],
            sums: [sum; LONGEST],
            sum,
            double_sum,
        }
    }
}

/// Divided by N², to nearest.
fn rounded(double_sum: i64, log2: u8) -> i64 {
    let shift = u32::from(log2).wrapping_mul(2);
    let half = 1_i64.wrapping_shl(shift).wrapping_shr(1);
    double_sum.wrapping_add(half).wrapping_shr(shift)
}
