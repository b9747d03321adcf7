//! A gap between motor and load: its two sides and the impact law.
//!
//! Two models stand on this file, because they know different things:
//! - [`axis`](crate::simulate::axis) simulates both bodies from the effort. The motor's path is not
//!   known: the load throws it back, and the contact may have to let go.
//! - [`load`](crate::simulate::load) knows the motor's path, because it was measured. Only the load
//!   moves freely, and the motor is as heavy as you like.
//!
//! They share Newton's impact law: two bodies that close in at a velocity w part at `e w`, where e
//! is the coefficient of restitution (0: they stay together, 1: no energy is lost). The pair loses
//! `½ μ (1 − e²) w²` with the reduced mass `μ = m₁ m₂/(m₁ + m₂)`.

/// The side of the gap at which motor and load touch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Side {
    /// The motor is ahead and pushes towards positive positions.
    Ahead,
    /// The motor is behind and pushes towards negative positions.
    Behind,
}

impl Side {
    /// The side of a lag, motor − load.
    #[inline]
    #[must_use]
    pub(crate) fn of(lag: f64) -> Self {
        if lag.is_sign_negative() {
            Self::Behind
        } else {
            Self::Ahead
        }
    }

    /// Direction in which the motor pushes: 1 or −1.
    #[inline]
    #[must_use]
    pub(crate) const fn sign(self) -> f64 {
        match self {
            Self::Ahead => 1.0,
            Self::Behind => -1.0,
        }
    }
}

/// Newton's impact law: the velocity at which two bodies part that closed in at another.
#[inline]
#[must_use]
pub(crate) fn rebound(restitution: f64, closing: f64) -> f64 {
    restitution * closing
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_motor_that_is_ahead_pushes_forwards() {
        for (lag, side, sign) in [(2.0, Side::Ahead, 1.0), (-2.0, Side::Behind, -1.0)] {
            assert_eq!((Side::of(lag), side.sign()), (side, sign));
        }
    }

    #[test]
    fn bodies_part_at_the_restitutions_share_of_their_closing_velocity() {
        assert_eq!(rebound(0.25, 8.0), 2.0);
        assert_eq!(rebound(0.0, 8.0), 0.0);
    }
}
