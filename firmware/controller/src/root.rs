//! Integer square root, for every braking curve `v = √(2 a s)` of the drive.
//!
//! Digit by digit (Crenshaw, "Math Toolkit for Real-Time Programming", 2000, ch. 4): `u64::isqrt`
//! of the core library divides, and a 64-bit division is a call of hundreds of cycles on a
//! Cortex-M4.

/// The whole part of the root; begins at its first digit.
pub(crate) fn root(square: u64) -> u32 {
    let digits = 64_u32
        .wrapping_sub(square.leading_zeros())
        .wrapping_add(1)
        .wrapping_shr(1);
    let (mut rest, mut root) = (square, 0_u64);
    for digit in (0..digits).rev() {
        let bit = 1_u64.wrapping_shl(digit.wrapping_mul(2));
        let trial = root | bit;
        root = root.wrapping_shr(1);
        if rest >= trial {
            rest = rest.wrapping_sub(trial);
            root |= bit;
        }
    }
    u32::try_from(root).unwrap_or(u32::MAX)
}

/// The same of 32 bits: 64-bit shifts are calls on a Cortex-M4.
pub(crate) fn short_root(square: u32) -> u32 {
    let (mut rest, mut root) = (square, 0_u32);
    let mut bit = 1_u32 << 30;
    while bit > 0 {
        let trial = root | bit;
        root = root.wrapping_shr(1);
        if rest >= trial {
            rest = rest.wrapping_sub(trial);
            root |= bit;
        }
        bit = bit.wrapping_shr(2);
    }
    root
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn the_root_is_that_of_the_core_library(square in any::<u64>()) {
            prop_assert_eq!(u64::from(root(square)), square.isqrt());
        }

        #[test]
        fn the_short_root_is_that_of_the_core_library(square in any::<u32>(), shift in 0..32_u32) {
            let square = square >> shift;
            prop_assert_eq!(short_root(square), square.isqrt());
        }
    }
}
