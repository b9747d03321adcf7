//! The sliding curve, and the lag with which it follows the velocity.

use crate::lag::lag_share;
use crate::ranges::ranged;

ranged! {
    /// Parameters of the sliding curve `g(v)`, which all laws share: `Fc + (Fs − Fc) exp(−|v /
    /// vs|^p)`, in newtons.
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct Sliding {
        /// Coulomb friction Fc.
        pub coulomb_n: f64 [0.0 => 1.0e6],
        /// Breakaway friction Fs, not below Fc; equal to it where there is no Stribeck fall.
        pub static_n: f64 [0.0 => 1.0e6],
        /// Stribeck velocity vs.
        pub stribeck_velocity_m_per_s: f64 [1.0e-6 => 1.0],
        /// Exponent p of the fall: 2 with Gauss, 1 with Tustin, ½ with Bo and Pavelescu
        /// (Armstrong-Hélouvry, Dupont, Canudas de Wit 1994).
        #[serde(default = "gaussian")]
        pub stribeck_exponent: f64 [0.5 => 2.0],
        /// Time in which 63 % of a change of the fall has come: frictional lag (Lampaert,
        /// Al-Bender, Swevers 2003; Hess and Soom 1990). Zero where the fall follows at once.
        #[serde(default)]
        pub stribeck_lag_s: f64 [0.0 => 0.1],
        /// By how much longer it lags at rest, as a share: (Fs − Fc)/Fc with generalised Maxwell
        /// slip, whose lag goes with the level (Lampaert, Al-Bender, Swevers 2003).
        #[serde(default)]
        pub stribeck_lag_growth: f64 [0.0 => 4.0],
        /// Viscous friction Fv.
        pub viscous_n_s_per_m: f64 [0.0 => 1.0e7],
        /// Relative difference of Coulomb friction by direction: Fc (1 ± a) for positive and
        /// negative motion. Friction has to stay friction: a tenth is left.
        #[serde(default)]
        pub coulomb_asymmetry: f64 [-0.9 => 0.9],
        /// Relative difference of viscous friction by direction.
        #[serde(default)]
        pub viscous_asymmetry: f64 [-0.9 => 0.9],
        /// Quadratic drag q v |v|.
        #[serde(default)]
        pub quadratic_drag_n_s2_per_m2: f64 [0.0 => 1.0e7],
    }
}

/// Of exp(−x) no number is left from 745.2 on, and getting there takes longest.
const NOTHING_LEFT: f64 = 746.0;
/// … and ten times it changes no digit of 1 from 39.8 on: half of the last one is 2⁻⁵⁴ at least.
const FALLEN: f64 = 40.0;

impl Sliding {
    /// Coulomb friction alone. The Stribeck velocity matters only where there is a fall.
    #[must_use]
    pub const fn dry(coulomb_n: f64) -> Self {
        Self {
            coulomb_n,
            static_n: coulomb_n,
            stribeck_velocity_m_per_s: 1.0e-3,
            stribeck_exponent: gaussian(),
            stribeck_lag_s: 0.0,
            stribeck_lag_growth: 0.0,
            viscous_n_s_per_m: 0.0,
            coulomb_asymmetry: 0.0,
            viscous_asymmetry: 0.0,
            quadratic_drag_n_s2_per_m2: 0.0,
        }
    }

    /// Friction at steady sliding without the viscous part, for a direction of `v`; never negative.
    #[must_use]
    pub fn level_n(&self, v: f64) -> f64 {
        let excess = self.static_n - self.coulomb_n;
        let left = if excess == 0.0 {
            0.0
        } else {
            let gone = if excess <= 10.0 * self.coulomb_n {
                FALLEN
            } else {
                NOTHING_LEFT
            };
            left_of(self.power(v), gone)
        };
        self.level_with_n(left, v)
    }

    /// The same where a share of the excess is left.
    fn level_with_n(&self, left: f64, v: f64) -> f64 {
        let fall = (self.static_n - self.coulomb_n) * left;
        (self.coulomb_n + fall) * (1.0 + self.coulomb_asymmetry * sign(v))
    }

    /// Share of the excess that is left in the end, at a velocity.
    fn left(&self, v: f64) -> f64 {
        if self.static_n == self.coulomb_n {
            0.0
        } else {
            left_of(self.power(v), NOTHING_LEFT)
        }
    }

    /// |v / vs|^p, the square as a product.
    fn power(&self, v: f64) -> f64 {
        let ratio = v / self.stribeck_velocity_m_per_s;
        if self.stribeck_exponent == gaussian() {
            ratio * ratio
        } else {
            ratio.abs().powf(self.stribeck_exponent)
        }
    }

    /// Viscous coefficient at a velocity, quadratic drag included as `q |v|`.
    #[must_use]
    pub fn viscous_n_s_per_m(&self, v: f64) -> f64 {
        self.viscous_n_s_per_m * (1.0 + self.viscous_asymmetry * sign(v))
            + self.quadratic_drag_n_s2_per_m2 * v.abs()
    }
}

/// exp(−power), none from a power on that takes everything.
fn left_of(power: f64, gone: f64) -> f64 {
    if power > gone { 0.0 } else { (-power).exp() }
}

/// Exponent of a fall of which none is stated.
pub(crate) const fn gaussian() -> f64 {
    2.0
}

pub(super) fn sign(v: f64) -> f64 {
    f64::from(u8::from(v > 0.0)) - f64::from(u8::from(v < 0.0))
}

/// What is left of the excess, where it lags: `τ ṡ = exp(−|v / vs|^p) − s`, exact for constant
/// velocity. At rest all of it is there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Fall(f64);

impl Default for Fall {
    fn default() -> Self {
        Self(1.0)
    }
}

impl Fall {
    /// After a sub-step at a velocity.
    #[must_use]
    pub(super) fn after(self, sliding: &Sliding, v: f64, dt_s: f64) -> Self {
        if sliding.stribeck_lag_s == 0.0 {
            return self;
        }
        let goes_to = sliding.left(v);
        let lag_s = sliding.stribeck_lag_s * (1.0 + sliding.stribeck_lag_growth * goes_to);
        Self(self.0 + lag_share(dt_s, lag_s) * (goes_to - self.0))
    }
}

/// The sliding curve at a moment.
#[derive(Clone, Copy)]
pub(super) struct Curve<'a> {
    /// Its parameters.
    pub sliding: &'a Sliding,
    /// What is left of its excess, where that lags.
    pub fall: Fall,
}

impl Curve<'_> {
    /// Whether its fall lags: what a velocity makes is another level every time then.
    pub(super) fn lags(&self) -> bool {
        self.sliding.stribeck_lag_s != 0.0
    }

    /// Friction without the viscous part, for a direction of `v`.
    pub(super) fn level_n(&self, v: f64) -> f64 {
        if self.lags() {
            self.sliding.level_with_n(self.fall.0, v)
        } else {
            self.sliding.level_n(v)
        }
    }

    /// As [`Sliding::viscous_n_s_per_m`].
    pub(super) fn viscous_n_s_per_m(&self, v: f64) -> f64 {
        self.sliding.viscous_n_s_per_m(v)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LAGGING: Sliding = Sliding {
        static_n: 150.0,
        stribeck_velocity_m_per_s: 1.0e-2,
        stribeck_lag_s: 5.0e-3,
        ..Sliding::dry(100.0)
    };

    /// Level after so many sub-steps in all of 5 ms at a velocity, from a state.
    fn after(fall: &mut Fall, v: f64, steps: u32) -> f64 {
        for _ in 0..steps {
            *fall = fall.after(&LAGGING, v, 5.0e-3 / f64::from(steps));
        }
        let curve = Curve {
            sliding: &LAGGING,
            fall: *fall,
        };
        curve.level_n(v)
    }

    #[test]
    fn a_fall_that_lags_has_come_by_63_percent_after_its_lag_both_ways() {
        let e = std::f64::consts::E;
        for steps in [1, 20] {
            let mut fall = Fall::default();
            let gone = after(&mut fall, 1.0, steps);
            assert!((gone - (100.0 + 50.0 / e)).abs() < 1.0e-9, "{gone}");
            let back = after(&mut fall, 0.0, steps);
            assert!(
                (back - (150.0 - 50.0 / e * (1.0 - 1.0 / e))).abs() < 1.0e-9,
                "{back}"
            );
        }
    }

    #[test]
    fn a_lag_that_goes_with_the_level_is_longer_at_rest_and_the_same_where_friction_has_fallen() {
        let growing = Sliding {
            stribeck_lag_growth: 0.5,
            ..LAGGING
        };
        let left_after = |from: f64, v: f64, time_s: f64| Fall(from).after(&growing, v, time_s).0;
        let e = std::f64::consts::E;
        assert!((left_after(1.0, 1.0, 5.0e-3) - 1.0 / e).abs() < 1.0e-12);
        assert!((left_after(0.0, 0.0, 7.5e-3) - (1.0 - 1.0 / e)).abs() < 1.0e-12);
    }

    #[test]
    fn a_fall_that_is_not_asked_for_is_below_the_last_digit() {
        for excess in [1.0, 0.5, 7.0, 10.0, 300.0] {
            let sliding = Sliding {
                coulomb_n: 37.0,
                static_n: 37.0 * (1.0 + excess),
                ..LAGGING
            };
            for step in 0..4000 {
                // Powers up to 160, of which none is asked for beyond 40.
                let v = 1.0e-2 * 3.16e-3 * f64::from(step);
                let whole = sliding.level_with_n((-sliding.power(v)).exp(), v);
                assert_eq!(sliding.level_n(v), whole, "{excess} at {v}");
            }
        }
    }

    #[test]
    fn without_a_lag_the_level_is_that_of_the_velocity() {
        let sliding = Sliding {
            stribeck_lag_s: 0.0,
            ..LAGGING
        };
        let fall = Fall::default().after(&sliding, 1.0, 1.0);
        let curve = Curve {
            sliding: &sliding,
            fall,
        };
        for v in [0.0, 1.0e-2, -3.0e-2] {
            assert_eq!(curve.level_n(v), sliding.level_n(v));
        }
    }
}
