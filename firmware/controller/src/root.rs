//! Integer square root, for every braking curve `v = √(2 a s)` of the drive.
//!
//! Digit by digit (Crenshaw, "Math Toolkit for Real-Time Programming", 2000, ch. 4): `u64::isqrt` of the core library divides, and a 64-bit division is a
//! call of hundreds of cycles on a Cortex-M4.

/// The whole part of the root.
pub(crate) fn root(square: u64) -> u32 {
    let (mut rest, mut root) = (square, 0_u64);
    for digit in (0..32_u32).rev() {
        let bit = 1_u64.wrapping_shl(digit.wrapping_mul(2));
        let trial = root.saturating_add(bit);
        root = root.wrapping_shr(1);
        if rest >= trial {
            rest = rest.saturating_sub(trial);
            root = root.saturating_add(bit);
        }
    }
    u32::try_from(root).unwrap_or(u32::MAX)
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
    }
}
