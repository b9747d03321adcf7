//! Interpolation of setpoints that come every n cycles: the cubic of Catmull and Rom ("A class of
//! local interpolating splines", 1974).
//!
//! Between the setpoints p1 and p2 the position is the cubic with the tangents (p2 − p0) / 2 and
//! (p3 − p1) / 2 at its ends:
//!
//! ```text
//! p(u) = p1 + m1 u + (3 h − 2 m1 − m2) u² + (m1 + m2 − 2 h) u³      h = p2 − p1      u = i / n
//! ```
//!
//! It passes through every setpoint, position and velocity are continuous, and constant
//! acceleration is reproduced exactly (so the radius of a circle is wrong by (ω n T)⁴ only). It
//! needs p3 before it may leave p1: the delay is 2 n − 1 cycles.

use fixed::types::I56F8;

/// Most cycles from setpoint to setpoint.
pub(super) const MOST_CYCLES: u8 = 20;

/// 2²⁴ / n, to nearest, for n = 0 (nothing), 1, 2…: there is no division in the cycle.
const SHARE: [i64; 21] = [
    0, 16_777_216, 8_388_608, 5_592_405, 4_194_304, 3_355_443, 2_796_203, 2_396_745, 2_097_152,
    1_864_135, 1_677_722, 1_525_201, 1_398_101, 1_290_555, 1_198_373, 1_118_481, 1_048_576,
    986_895, 932_068, 883_011, 838_861,
];

const ONE: i64 = 1 << 24;

/// Memory of the interpolation: two ends of the present piece with their tangents, and the setpoint
/// behind it.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Interpolation {
    from: i64,
    to: i64,
    behind: i64,
    tangent_from: i64,
    tangent_to: i64,
}

impl Interpolation {
    pub(super) fn at_rest(position: I56F8) -> Self {
        let bits = position.to_bits();
        Self {
            from: bits,
            to: bits,
            behind: bits,
            tangent_from: 0,
            tangent_to: 0,
        }
    }

    /// The next piece begins, and a setpoint came.
    pub(super) fn push(&mut self, setpoint: I56F8) {
        self.from = self.to;
        self.to = self.behind;
        self.behind = setpoint.to_bits();
        self.tangent_from = self.tangent_to;
        self.tangent_to = self.behind.wrapping_sub(self.from).wrapping_shr(1);
    }

    /// The newest setpoint was off by so much: tangents that are in use stay.
    pub(super) fn correct(&mut self, by: i64) {
        self.behind = self.behind.wrapping_add(by);
    }

    /// Position of the cycle `phase` (1…n) of the piece.
    pub(super) fn position(&self, phase: u8, cycles: u8) -> I56F8 {
        if phase >= cycles {
            return I56F8::from_bits(self.to);
        }
        let share = SHARE
            .get(usize::from(cycles))
            .map_or(0, |share| share.wrapping_mul(i64::from(phase)));
        let way = self.to.wrapping_sub(self.from);
        let [first, last] = [self.tangent_from, self.tangent_to];
        let cubic = first.wrapping_add(last).wrapping_sub(way.wrapping_mul(2));
        let square = way
            .wrapping_mul(3)
            .wrapping_sub(first.wrapping_mul(2))
            .wrapping_sub(last);
        let inner = times(cubic, share).wrapping_add(square);
        let outer = times(inner, share).wrapping_add(first);
        I56F8::from_bits(self.from.wrapping_add(times(outer, share)))
    }
}

/// Rounded to nearest; ways beyond 2.7 m from setpoint to setpoint are cut, so that 37 times 25
/// bits stay within 64.
fn times(way: i64, share: i64) -> i64 {
    let way = way.clamp(-(1 << 36), 1 << 36);
    way.wrapping_mul(share)
        .wrapping_add(ONE / 2)
        .wrapping_shr(24)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_shares_are_the_quotients() {
        for (n, share) in (1_i64..).zip(&SHARE[1..]) {
            assert!((share * n - ONE).abs() <= n / 2 + 1, "n {n}");
        }
    }

    #[test]
    fn constant_acceleration_is_reproduced_to_a_bit() {
        let parabola = |t: i64| 1000 * t * t / 64 - 77 * t;
        let mut piece = Interpolation::at_rest(I56F8::from_bits(0));
        (-1..3).for_each(|knot| piece.push(I56F8::from_bits(parabola(8 * knot))));
        for phase in 1..=8 {
            let got = piece.position(phase, 8).to_bits();
            assert!(
                (got - parabola(i64::from(phase))).abs() <= 2,
                "{phase}: {got}"
            );
        }
    }
}
