//! Clock tree and CAN bit timing of the B-G431B-ESC1, and the latency contract of a board, as plain
//! numbers.
//!
//! The board leaf turns them into register codes; linking is not booting, so what can be checked
//! without the board is checked here, when the program is compiled and by tests on the host.
//! Limits: STM32G431 datasheet DS12589 table 36 (PLL), RM0440 §44.3 (FDCAN bit timing).
#![no_std]
#![forbid(unsafe_code)]

pub mod contract;

/// Crystal on the board, Hz.
pub const HSE_HZ: u32 = 8_000_000;
/// PLL input divider M.
pub const PLL_M: u32 = 2;
/// PLL multiplier N.
pub const PLL_N: u32 = 85;
/// PLL divider R: system clock.
pub const PLL_R: u32 = 2;
/// PLL divider Q: FDCAN.
pub const PLL_Q: u32 = 2;

/// PLL input, Hz.
pub const PLL_INPUT_HZ: u32 = HSE_HZ / PLL_M;
/// VCO, Hz.
pub const VCO_HZ: u32 = PLL_INPUT_HZ * PLL_N;
/// System clock, Hz.
pub const SYSTEM_HZ: u32 = VCO_HZ / PLL_R;
/// FDCAN kernel clock, Hz.
pub const FDCAN_HZ: u32 = VCO_HZ / PLL_Q;

/// One CAN bit: a sync quantum, `segment_1` quanta up to the sample point, `segment_2` after it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BitTiming {
    /// Clocks per quantum.
    pub prescaler: u16,
    /// Propagation and phase segment 1, quanta.
    pub segment_1: u8,
    /// Phase segment 2, quanta.
    pub segment_2: u8,
    /// Synchronisation jump width, quanta.
    pub jump_width: u8,
}

impl BitTiming {
    /// Quanta per bit.
    #[must_use]
    pub const fn quanta(self) -> u32 {
        1 + self.segment_1 as u32 + self.segment_2 as u32
    }

    /// Whether a clock gives exactly this bit rate.
    #[must_use]
    pub const fn gives(self, clock_hz: u32, bit_rate: u32) -> bool {
        self.prescaler as u32 * self.quanta() * bit_rate == clock_hz
    }

    /// Sample point, per mille of the bit.
    #[must_use]
    pub const fn sample_point_per_mille(self) -> u32 {
        1000 * (1 + self.segment_1 as u32) / self.quanta()
    }
}

/// 1 Mbit/s: 10 clocks a quantum, 17 quanta. CiA 301 recommends the sample point at 87.5 %.
pub const ONE_MEGABIT: BitTiming = BitTiming {
    prescaler: 10,
    segment_1: 14,
    segment_2: 2,
    jump_width: 2,
};

const _: () = {
    assert!(PLL_INPUT_HZ >= 2_660_000 && PLL_INPUT_HZ <= 16_000_000);
    assert!(VCO_HZ >= 96_000_000 && VCO_HZ <= 344_000_000);
    assert!(SYSTEM_HZ == 170_000_000);
    assert!(ONE_MEGABIT.gives(FDCAN_HZ, 1_000_000));
    assert!(ONE_MEGABIT.jump_width <= ONE_MEGABIT.segment_2);
};

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_clock_tree_gives_170_mhz_from_the_crystal() {
        assert_eq!(
            (PLL_INPUT_HZ, VCO_HZ, SYSTEM_HZ, FDCAN_HZ),
            (4_000_000, 340_000_000, 170_000_000, 170_000_000)
        );
    }

    #[test]
    fn one_megabit_is_exact_and_sampled_near_seven_eighths() {
        assert!(ONE_MEGABIT.gives(FDCAN_HZ, 1_000_000));
        assert!(!ONE_MEGABIT.gives(FDCAN_HZ, 999_999));
        assert_eq!(ONE_MEGABIT.sample_point_per_mille(), 882);
    }
}
