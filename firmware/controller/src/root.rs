//! Integer square root, for every braking curve `v = √(2 a s)` of the drive.
//!
//! Without a division (the core library's `u64::isqrt` divides, and a 64-bit division is a call of
//! hundreds of cycles on a Cortex-M4) and without a loop over digits: one over the root by Newton's
//! method, `y ← y (3 − x y²) / 2` with x in [1/4, 1), twice from a parabola that is off by
//! 2.4 %, then a step of Newton's method for the root itself and the last bit by comparison.
//! Some 80 instructions with the call, where 32 digits took 450.

use crate::units::{lower, upper};

/// The whole part of the root.
pub(crate) fn root(square: u64) -> u32 {
    if square == 0 {
        return 0;
    }
    let places = square.leading_zeros() & !1;
    normal_root(square.wrapping_shl(places)).wrapping_shr(places.wrapping_shr(1))
}

/// The whole part of the root of 32 bits, in fewer instructions.
pub(crate) fn root_of_word(square: u32) -> u32 {
    if square == 0 {
        return 0;
    }
    let places = square.leading_zeros() & !1;
    let x = square.wrapping_shl(places);
    let y = newton(newton(start(x), x), x);
    // √x = x y, 30 bits of the root, to nearest of the 16 that are asked for.
    let near = upper_product(x, y).wrapping_add(1 << 13).wrapping_shr(14);
    let root = near.min(0xFFFF).wrapping_shr(places.wrapping_shr(1));
    root.wrapping_sub(u32::from(root.wrapping_mul(root) > square))
}

/// The parabola `2.6708 − 3.2854 x + 1.6386 x²`, in 2⁻³⁰.
const PARABOLA: [u32; 3] = [2_867_787_662, 3_527_624_809, 1_759_398_851];
/// Three in 2⁻²⁸.
const THREE: u32 = 3 << 28;

/// The root of what has one of its two upper bits.
fn normal_root(square: u64) -> u32 {
    let x = upper_word(square);
    let y = newton(newton(start(x), x), x);
    // √x = x y, two bits short of the root.
    let short = upper_product(x, y).min((1 << 30) - 1);
    let near = short.wrapping_shl(2);
    // What is left of the square is below 2⁴⁶; times y over two roots, which is y 2⁻³³.
    let left = square.wrapping_sub(product(near, near)).cast_signed();
    let step = product_signed(
        lower(left.wrapping_shr(15)),
        y.wrapping_shr(1).cast_signed(),
    );
    exact(
        square,
        near.saturating_add_signed(lower(step.wrapping_shr(47))),
    )
}

/// One over the root, in 2⁻³⁰, to 2.4 %.
fn start(x: u32) -> u32 {
    let [level, slope, curve] = PARABOLA;
    level
        .wrapping_sub(upper_product(slope, x))
        .wrapping_add(upper_product(curve, upper_product(x, x)))
}

/// The same nearer.
fn newton(y: u32, x: u32) -> u32 {
    // x y² is about one, in 2⁻²⁸.
    let one = upper_product(upper_product(y, y), x);
    upper_product(y, THREE.wrapping_sub(one).wrapping_shl(2)).wrapping_shl(1)
}

/// The whole root beside one that is off by one at most.
fn exact(square: u64, near: u32) -> u32 {
    let left = square.wrapping_sub(product(near, near)).cast_signed();
    if left < 0 {
        return near.wrapping_sub(1);
    }
    let two_roots = i64::from(near).wrapping_mul(2);
    near.wrapping_add(u32::from(left > two_roots))
}

fn product(one: u32, other: u32) -> u64 {
    u64::from(one).wrapping_mul(u64::from(other))
}

fn product_signed(one: i32, other: i32) -> i64 {
    i64::from(one).wrapping_mul(i64::from(other))
}

/// The upper word of a product.
fn upper_product(one: u32, other: u32) -> u32 {
    upper_word(product(one, other))
}

fn upper_word(wide: u64) -> u32 {
    upper(wide.cast_signed()).cast_unsigned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn is_exact(square: u64) {
        assert_eq!(u64::from(root(square)), square.isqrt(), "{square}");
    }

    #[test]
    fn the_root_is_exact_about_the_squares_of_powers_of_two_and_of_the_largest() {
        for bits in 0..32_u32 {
            for root in [1_u64 << bits, (1 << bits) + 1, (2 << bits) - 1] {
                let root = root.min(u64::from(u32::MAX));
                (0..3).for_each(|off| is_exact(root * root + off));
                is_exact(root * root - 1);
                is_exact(root * root + 2 * root);
            }
        }
        (0..1000).for_each(|off| is_exact(u64::MAX - off));
        (0..10_000).for_each(is_exact);
    }

    proptest! {
        #[test]
        fn the_root_is_that_of_the_core_library(square in any::<u64>(), shift in 0..64_u32) {
            is_exact(square >> shift);
        }

        #[test]
        fn the_root_of_a_word_is_that_of_the_core_library(square in any::<u32>(), shift in 0..32_u32) {
            let square = square >> shift;
            assert_eq!(root_of_word(square), square.isqrt());
            let whole = square.isqrt();
            assert_eq!(root_of_word(whole * whole), whole);
            assert_eq!(root_of_word((whole * whole).saturating_sub(1)), (whole * whole).saturating_sub(1).isqrt());
        }

        /// Where the last bit is decided.
        #[test]
        fn the_root_is_exact_about_squares(root in any::<u32>(), shift in 0..32_u32) {
            let root = u64::from(root >> shift).max(1);
            is_exact(root * root);
            is_exact(root * root - 1);
            is_exact(root * root + 2 * root);
        }
    }
}
