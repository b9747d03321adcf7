//! Bus load from the frame table, with worst-case bit stuffing.
//!
//! Classic frame, 11-bit identifier, `n` data bytes: `47 + 8n` bits with the interframe space, and
//! one stuff bit for every four of the `34 + 8n` bits that are stuffed (Davis, Burns, Bril,
//! Lukkien, "Controller Area Network schedulability analysis: refuted, revisited and revised",
//! 2007, eq. 1). CAN FD (ISO 11898-1:2015): 17 arbitration bits up to BRS with 4 stuff bits, 12
//! bits from ACK to the interframe space at the nominal rate; ESI, DLC and data with one stuff bit
//! in four, stuff count 4, CRC 17 with 6 fixed stuff bits and the CRC delimiter at the data rate.

use crate::table::{FRAMES, FrameSpec, Rate, Sender};

/// Frame format and bit rates of a bus.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BusFormat {
    /// Classic CAN.
    Classic {
        /// Bit rate in bit/s.
        bit_rate: u32,
    },
    /// CAN FD with bit rate switching.
    Fd {
        /// Arbitration bit rate in bit/s.
        nominal_rate: u32,
        /// Data bit rate in bit/s.
        data_rate: u32,
    },
}

/// A clock-paced run above this load is refused.
pub const CLOCK_PACED_LIMIT_PER_MILLE: u32 = 800;

impl BusFormat {
    /// Longest time of one frame with `length` data bytes, in nanoseconds, rounded up.
    #[must_use]
    pub fn frame_time_ns(self, length: u8) -> u64 {
        let length = u64::from(length.min(8));
        match self {
            Self::Classic { bit_rate } => bits_ns(classic_bits(length), bit_rate),
            Self::Fd {
                nominal_rate,
                data_rate,
            } => bits_ns(FD_NOMINAL_BITS, nominal_rate)
                .saturating_add(bits_ns(fd_data_bits(length), data_rate)),
        }
    }
}

const FD_NOMINAL_BITS: u64 = 17 + 4 + 12;

const fn classic_bits(length: u64) -> u64 {
    let stuffed = length
        .saturating_mul(8)
        .saturating_add(33)
        .saturating_div(4);
    length
        .saturating_mul(8)
        .saturating_add(47)
        .saturating_add(stuffed)
}

const fn fd_data_bits(length: u64) -> u64 {
    let plain = length.saturating_mul(8).saturating_add(5);
    plain
        .saturating_add(plain.saturating_div(4))
        .saturating_add(4 + 17 + 6 + 1)
}

const fn bits_ns(bits: u64, rate: u32) -> u64 {
    let rate = if rate == 0 { 1 } else { rate };
    bits.saturating_mul(1_000_000_000).div_ceil(widen(rate))
}

#[expect(
    clippy::as_conversions,
    reason = "u32 to u64 is lossless; From is not const"
)]
const fn widen(value: u32) -> u64 {
    value as u64
}

/// Cyclic load of a bus in per mille of its capacity.
///
/// `axes` on this bus, `cycle_ns` the SYNC period. SYNC is counted once, all other cyclic frames
/// once per axis.
#[must_use]
pub fn cyclic_load_per_mille(format: BusFormat, axes: u8, cycle_ns: u64) -> u32 {
    let busy_ns = FRAMES.iter().fold(0_u64, |sum, frame| {
        sum.saturating_add(share_ns(format, frame, axes))
    });
    let per_mille = busy_ns.saturating_mul(1000).checked_div(cycle_ns);
    per_mille
        .and_then(|load| u32::try_from(load).ok())
        .unwrap_or(u32::MAX)
}

fn share_ns(format: BusFormat, frame: &FrameSpec, axes: u8) -> u64 {
    let Rate::EveryCycles(cycles) = frame.rate else {
        return 0;
    };
    let times = if frame.sender == Sender::Workbench && frame.length == 1 {
        1
    } else {
        u64::from(axes)
    };
    let each_time = format.frame_time_ns(frame.length).saturating_mul(times);
    each_time.checked_div(u64::from(cycles)).unwrap_or(u64::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;

    const MEGABIT: BusFormat = BusFormat::Classic {
        bit_rate: 1_000_000,
    };
    const FD: BusFormat = BusFormat::Fd {
        nominal_rate: 1_000_000,
        data_rate: 5_000_000,
    };

    #[test]
    fn the_longest_classic_frame_has_135_bits() {
        // Davis et al. 2007, table 1: 8 data bytes, 11-bit identifier: 135 bit times.
        assert_eq!(MEGABIT.frame_time_ns(8), 135_000);
        assert_eq!(MEGABIT.frame_time_ns(0), 55_000);
    }

    #[test]
    fn loads_of_the_usual_layouts() {
        // Per mille, with status and plant status in every tenth cycle: one axis at 1 kHz stays
        // below 65 %.
        assert_eq!(cyclic_load_per_mille(MEGABIT, 1, 1_000_000), 488);
        assert_eq!(cyclic_load_per_mille(MEGABIT, 2, 2_000_000), 455);
        assert_eq!(cyclic_load_per_mille(MEGABIT, 2, 1_000_000), 911);
        assert_eq!(cyclic_load_per_mille(FD, 2, 500_000), 793);
    }
}
