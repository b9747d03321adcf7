//! How the motor goes across a gap: while the torque behind it goes through a band about zero.
//!
//! ```text
//! torque ─▶ share x of the band, −1 to 1 ─▶ x (3 − x²) / 2 of half the gap
//! ```
//!
//! At both flanks the motor begins and ends gently, so that it takes a torque that acts in time and
//! does not hit the other flank. The band is narrower where the table is slow, for then the motor
//! has more time: what is transmitted within it is not, while the flanks are apart, and a table on
//! its presliding springs stands beside its setpoint by that.

use fixed::types::{I4F28, I8F24, I20F12};

use crate::units::{Coarse, Velocity, narrowed, way_by};

/// A gap behind the motor.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Gap {
    /// Half of it, 10 nm; zero: none.
    pub half: I20F12,
    /// One over that.
    pub per_half: I8F24,
    /// Way per torque within the band where that is widest, 10 nm per µN·m.
    pub per_torque: I4F28,
    /// One over the velocity of the table from which on it is that wide; in proportion below, an
    /// eighth at least. Zero: at any velocity.
    pub per_velocity: I8F24,
}

impl Gap {
    pub(super) fn is_there(&self) -> bool {
        self.half > I20F12::ZERO
    }

    /// Where the motor stands beside the middle of it.
    pub(super) fn across(&self, torque: Coarse, velocity: Velocity) -> Velocity {
        let wide = way_by(self.per_torque, torque);
        let way = wide.scaled(self.times_narrower(velocity));
        self.eased(way.limited(Velocity(self.half)))
    }

    fn times_narrower(&self, velocity: Velocity) -> I8F24 {
        if self.per_velocity > I8F24::ZERO {
            one_over(velocity.size().over(self.per_velocity))
        } else {
            I8F24::ONE
        }
    }

    fn eased(&self, way: Velocity) -> Velocity {
        const ONE_AND_A_HALF: I8F24 = I8F24::from_bits(3 << 23);
        let share = way.over(self.per_half);
        // 16.48 bits: one bit less is half of it.
        let half_square = narrowed::<25>(share.wide_mul(share).to_bits());
        way.scaled(ONE_AND_A_HALF.saturating_sub(I8F24::from_bits(half_square)))
    }
}

const EIGHTH: I8F24 = I8F24::from_bits(1 << 21);
const QUARTER: I8F24 = I8F24::from_bits(1 << 22);
const HALF: I8F24 = I8F24::from_bits(1 << 23);
const THREE: I8F24 = I8F24::from_bits(3 << 24);
const SIX: I8F24 = I8F24::from_bits(6 << 24);
const EIGHT: I8F24 = I8F24::from_bits(8 << 24);
const TWELVE: I8F24 = I8F24::from_bits(12 << 24);

/// One over a share, straight between powers of two: 1 to 8, and at most an eighth too much.
fn one_over(share: I8F24) -> I8F24 {
    let falling = |from: I8F24, doublings: u32| {
        let fall = share.to_bits().wrapping_shl(doublings);
        from.wrapping_sub(I8F24::from_bits(fall))
    };
    if share >= I8F24::ONE {
        I8F24::ONE
    } else if share >= HALF {
        falling(THREE, 1)
    } else if share >= QUARTER {
        falling(SIX, 3)
    } else if share >= EIGHTH {
        falling(TWELVE, 5)
    } else {
        EIGHT
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HALF_GAP: f64 = 250.0;

    fn gap(per_velocity: f64) -> Gap {
        Gap {
            half: I20F12::from_num(HALF_GAP),
            per_half: I8F24::from_num(1.0 / HALF_GAP),
            per_torque: I4F28::from_num(HALF_GAP / 1.0e5),
            per_velocity: I8F24::from_num(per_velocity),
        }
    }

    fn across(gap: &Gap, torque: f64, velocity: f64) -> f64 {
        let velocity = Velocity(I20F12::from_num(velocity));
        gap.across(Coarse::from_num(torque), velocity)
            .0
            .to_num::<f64>()
    }

    #[test]
    fn the_motor_goes_from_flank_to_flank_without_a_kink() {
        for share in [-2.0, -1.0, -0.4, 0.0, 0.1, 0.7, 1.0, 50.0_f64] {
            let of_band = share.clamp(-1.0, 1.0);
            let wanted = HALF_GAP * 0.5 * of_band * (3.0 - of_band * of_band);
            let way = across(&gap(0.0), share * 1.0e5, 0.0);
            assert!((way - wanted).abs() < 0.01, "{share}: {way} for {wanted}");
        }
    }

    #[test]
    fn a_band_is_narrower_where_the_table_is_slow_and_an_eighth_at_least() {
        let own = gap(1.0 / 200.0);
        for (velocity, narrower) in [
            (0.0, 8.0),
            (20.0, 8.0),
            (25.0, 8.0),
            (-50.0, 4.0),
            (75.0, 3.0),
            (100.0, 2.0),
            (-150.0, 1.5),
            (200.0, 1.0),
            (5.0e5, 1.0),
        ] {
            let (slow, fast) = (
                across(&own, 1.0e4, velocity),
                across(&own, narrower * 1.0e4, 200.0),
            );
            assert!((slow - fast).abs() < 0.02, "{velocity}: {slow} for {fast}");
        }
    }

    #[test]
    fn one_over_a_share_is_at_most_an_eighth_too_much_and_never_rises() {
        let mut before = 8.0;
        for thousandth in 125..1100 {
            let share = f64::from(thousandth) / 1000.0;
            let own: f64 = one_over(I8F24::from_num(share)).to_num();
            let exact = (1.0 / share).max(1.0);
            assert!(
                (exact - 1.0e-6..1.126 * exact).contains(&own),
                "{share}: {own}"
            );
            assert!(own <= before + 1.0e-6, "{share}: {own} after {before}");
            before = own;
        }
    }
}
