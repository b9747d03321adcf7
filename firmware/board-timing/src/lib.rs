//! Clock trees and CAN bit timing of the boards, and the latency contract of a board, as plain
//! numbers.
//!
//! The board leaf turns them into register codes; linking is not booting, so what can be checked
//! without the board is checked here, when the program is compiled and by tests on the host.
//! Limits: STM32G431 datasheet DS12589 table 36 (PLL; that of the STM32G474 is taken to be the
//! same), RM0440 §44.3 (FDCAN bit timing).
#![no_std]
#![forbid(unsafe_code)]

pub mod contract;

/// Crystal and PLL of a board.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ClockTree {
    /// Crystal, Hz.
    pub crystal_hz: u32,
    /// PLL input divider M.
    pub pll_m: u32,
    /// PLL multiplier N.
    pub pll_n: u32,
    /// PLL divider R: system clock.
    pub pll_r: u32,
    /// PLL divider Q: FDCAN.
    pub pll_q: u32,
}

impl ClockTree {
    const fn of(crystal_hz: u32, pll_m: u32) -> Self {
        Self {
            crystal_hz,
            pll_m,
            pll_n: 85,
            pll_r: 2,
            pll_q: 2,
        }
    }

    /// PLL input, Hz.
    #[must_use]
    pub const fn pll_input_hz(self) -> u32 {
        self.crystal_hz / self.pll_m
    }

    /// VCO, Hz.
    #[must_use]
    pub const fn vco_hz(self) -> u32 {
        self.pll_input_hz() * self.pll_n
    }

    /// System clock, Hz.
    #[must_use]
    pub const fn system_hz(self) -> u32 {
        self.vco_hz() / self.pll_r
    }

    /// FDCAN kernel clock, Hz.
    #[must_use]
    pub const fn fdcan_hz(self) -> u32 {
        self.vco_hz() / self.pll_q
    }

    const fn is_within_limits(self) -> bool {
        self.pll_input_hz() >= 2_660_000
            && self.pll_input_hz() <= 16_000_000
            && self.vco_hz() >= 96_000_000
            && self.vco_hz() <= 344_000_000
            && self.system_hz() == SYSTEM_HZ
            && self.fdcan_hz() == FDCAN_HZ
            && self.crystal_hz.is_multiple_of(self.pll_m)
    }
}

/// ST's B-G431B-ESC1, crystal of 8 MHz.
pub const B_G431B_ESC1: ClockTree = ClockTree::of(8_000_000, 2);
/// ST's NUCLEO-G474RE, crystal of 24 MHz.
pub const NUCLEO_G474RE: ClockTree = ClockTree::of(24_000_000, 6);

/// System clock of all boards, Hz.
pub const SYSTEM_HZ: u32 = 170_000_000;
/// FDCAN kernel clock of all boards, Hz.
pub const FDCAN_HZ: u32 = 170_000_000;

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
    assert!(B_G431B_ESC1.is_within_limits());
    assert!(NUCLEO_G474RE.is_within_limits());
    assert!(ONE_MEGABIT.gives(FDCAN_HZ, 1_000_000));
    assert!(ONE_MEGABIT.jump_width <= ONE_MEGABIT.segment_2);
};

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_clock_trees_give_170_mhz_from_their_crystals() {
        for tree in [B_G431B_ESC1, NUCLEO_G474RE] {
            assert_eq!(
                (tree.pll_input_hz(), tree.vco_hz()),
                (4_000_000, 340_000_000)
            );
            assert_eq!(
                (tree.system_hz(), tree.fdcan_hz()),
                (170_000_000, 170_000_000)
            );
        }
        assert!(!ClockTree::of(25_000_000, 6).is_within_limits());
    }

    #[test]
    fn one_megabit_is_exact_and_sampled_near_seven_eighths() {
        assert!(ONE_MEGABIT.gives(FDCAN_HZ, 1_000_000));
        assert!(!ONE_MEGABIT.gives(FDCAN_HZ, 999_999));
        assert_eq!(ONE_MEGABIT.sample_point_per_mille(), 882);
    }
}
