//! A load behind a gap, along a measured motor path.
//!
//! The motor pushes the load at one side of the gap. When the motor slows down harder than friction
//! slows the load, the load leaves it and coasts: `dv/dt = −(c + d |v|) sign v`, with the Coulomb
//! and the viscous deceleration c and d. It coasts until it rests or meets a side again. There it
//! takes the motor's velocity and rebounds by Newton's law ([`gap`](crate::simulate::gap), which
//! also says why there are two models of a gap): stiff flanks are far from inelastic.
//!
//! One step is one row of the record. Units: m or rad, s.

pub(crate) mod on_bristle;

use std::cmp::Ordering;

use crate::simulate::gap::{Side, rebound};

/// A gap and the load behind it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Behind {
    /// Width of the gap.
    pub gap: f64,
    /// Deceleration by Coulomb friction alone.
    pub coulomb: f64,
    /// Deceleration by viscous friction, per velocity, 1/s.
    pub viscous: f64,
    /// Coefficient of restitution, 0 to 1.
    pub restitution: f64,
}

/// Where the load stands at a row.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Load {
    x: f64,
    v: f64,
    /// Where the motor pushed it over the last interval.
    pushed: Option<Side>,
}

/// The measured path of the motor.
#[derive(Clone, Copy)]
struct Path<'a> {
    motor: &'a [f64],
    period_s: f64,
}

impl Path<'_> {
    /// Position; the motor rests after the last row.
    fn at(&self, row: usize) -> f64 {
        self.motor[row.min(self.motor.len() - 1)]
    }

    /// Mean velocity from a row to the next.
    fn velocity(&self, row: usize) -> f64 {
        (self.at(row + 1) - self.at(row)) / self.period_s
    }
}

impl Behind {
    /// Motor − load at each row, −gap/2…gap/2; the load starts at rest in the middle.
    #[must_use]
    pub(crate) fn follow(&self, motor: &[f64], period_s: f64) -> Vec<f64> {
        let path = Path { motor, period_s };
        let mut load = Load {
            x: motor.first().copied().unwrap_or(0.0),
            ..Load::default()
        };
        let rows = 0..motor.len();
        rows.map(|row| {
            let lag = path.at(row) - load.x;
            load = self.after(load, &path, row);
            lag
        })
        .collect()
    }

    /// The load at the next row.
    fn after(&self, load: Load, path: &Path<'_>, row: usize) -> Load {
        let (coasting, slower) = self.coasted(load, path.period_s);
        let next = path.at(row + 1);
        let x = coasting
            .max(next - 0.5 * self.gap)
            .min(next + 0.5 * self.gap);
        let pushed = match x.partial_cmp(&coasting) {
            Some(Ordering::Greater) => Some(Side::Ahead),
            Some(Ordering::Less) => Some(Side::Behind),
            Some(Ordering::Equal) | None => None,
        };
        let v = pushed.map_or(slower, |side| self.hit(load, side, path, row));
        Load { x, v, pushed }
    }

    /// Position and velocity after a period under friction alone.
    fn coasted(&self, load: Load, period_s: f64) -> (f64, f64) {
        let deceleration = self.coulomb + self.viscous * load.v.abs();
        let slower = load.v.signum() * (load.v.abs() - deceleration * period_s).max(0.0);
        let coasting_s = if slower == 0.0 {
            load.v.abs() / deceleration.max(f64::MIN_POSITIVE)
        } else {
            period_s
        };
        let x = load.x + 0.5 * (load.v + slower) * coasting_s.min(period_s);
        (x, slower)
    }

    /// Velocity after an interval in which the motor pushes or hits the load.
    fn hit(&self, load: Load, side: Side, path: &Path<'_>, row: usize) -> f64 {
        // A load that is pushed has the motor's velocity at the row; one that is hit, that after
        // the impact, which the next interval shows.
        let before = path.velocity(row.saturating_sub(1));
        let closing = (side.sign() * (before - load.v)).max(0.0);
        let after = path.velocity(row + 1);
        let common = if load.pushed == Some(side) {
            0.5 * (path.velocity(row) + after)
        } else {
            after
        };
        common + side.sign() * rebound(self.restitution, closing)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(value: f64, wanted: f64) {
        assert!((value - wanted).abs() < 1.0e-12, "{value}, not {wanted}");
    }

    /// A gap of 1 and friction that leaves 0.1 a row.
    const WIDE: Behind = Behind {
        gap: 1.0,
        coulomb: 0.1,
        viscous: 0.0,
        restitution: 0.0,
    };

    #[test]
    fn under_high_friction_the_load_waits_while_the_motor_crosses_the_gap() {
        let path = [0.0, 1.0, 2.0, 3.0, 2.5, 2.0, 1.0, 0.0];
        let behind = Behind {
            coulomb: 1.0e6,
            ..WIDE
        };
        let lag = behind.follow(&path, 1.0);
        let wanted = [0.0, 0.5, 0.5, 0.5, 0.0, -0.5, -0.5, -0.5];
        assert!(
            lag.iter()
                .zip(wanted)
                .all(|(lag, wanted)| (lag - wanted).abs() < 1.0e-5),
            "{lag:?}"
        );
    }

    #[test]
    fn a_coasting_load_slows_down_by_coulomb_and_viscous_friction() {
        let behind = Behind {
            viscous: 0.05,
            ..WIDE
        };
        for sign in [1.0, -1.0] {
            // (0.1 + 0.05·2)·0.5 = 0.1 less; the mean of 2 and 1.9 over half a second.
            let load = Load {
                x: 3.0,
                v: sign * 2.0,
                pushed: None,
            };
            let (x, v) = behind.coasted(load, 0.5);
            near(x, 3.0 + sign * 0.975);
            near(v, sign * 1.9);
        }
    }

    #[test]
    fn a_coasting_load_comes_to_rest_after_v2_over_2a_within_the_row() {
        let load = Load {
            v: 0.04,
            ..Load::default()
        };
        let (x, v) = WIDE.coasted(load, 1.0);
        near(x, 0.04 * 0.04 / 0.2);
        assert_eq!(v, 0.0);
        let (x, _) = Behind {
            coulomb: 0.0,
            ..WIDE
        }
        .coasted(Load::default(), 1.0);
        assert_eq!(x, 0.0, "at rest without friction");
    }

    #[test]
    fn a_load_that_is_hit_takes_the_velocity_that_the_motor_shows_next_and_rebounds() {
        for sign in [1.0, -1.0] {
            let positions = [0.0, 2.0, 5.0, 9.0].map(|x| sign * x);
            let path = Path {
                motor: &positions,
                period_s: 1.0,
            };
            let behind = Behind {
                restitution: 0.5,
                ..WIDE
            };
            let load = Load {
                v: sign * 1.0,
                ..Load::default()
            };
            // Before 2, now 3, next 4; closing 1.
            let side = Side::of(sign);
            near(behind.hit(load, side, &path, 1), sign * 4.5);
            // In the first row the motor had no other velocity than it has: 2, then 3.
            near(behind.hit(load, side, &path, 0), sign * 3.5);
            // A load that was pushed there has the mean of 3 and 4 at the row.
            let pushed = Load {
                pushed: Some(side),
                ..load
            };
            near(behind.hit(pushed, side, &path, 1), sign * 4.0);
            // A load that is faster than the motor is not thrown.
            let faster = Load {
                v: sign * 3.0,
                ..load
            };
            near(behind.hit(faster, side, &path, 1), sign * 4.0);
            // After the last row the motor rests.
            near(behind.hit(faster, side, &path, 2), 0.0);
        }
    }

    #[test]
    fn the_load_stays_within_half_a_gap_and_remembers_where_it_was_pushed() {
        for sign in [1.0, -1.0] {
            let positions = [0.0, 2.0, 4.0].map(|x| sign * x);
            let path = Path {
                motor: &positions,
                period_s: 1.0,
            };
            let load = WIDE.after(Load::default(), &path, 0);
            near(load.x, sign * 1.5);
            near(load.v, sign * 2.0);
            assert_eq!(load.pushed, Some(Side::of(sign)));
            let free = WIDE.after(
                Load::default(),
                &Path {
                    motor: &[0.0, 0.4],
                    ..path
                },
                0,
            );
            assert_eq!(free, Load::default(), "the motor is within the gap");
        }
    }

    /// The motor speeds up to 10 mm/s within 0.2 s and stops within 10 ms; friction slows the load
    /// by 0.1 m/s² only.
    fn coasting(restitution: f64) -> Vec<f64> {
        let mut x = 0.0;
        let velocity = |row: i32| {
            (5.0e-5 * f64::from(row))
                .min(0.01)
                .min(1.0e-3 * f64::from(310 - row))
                .max(0.0)
        };
        let path: Vec<f64> = (0..330)
            .map(|row| {
                x += 1.0e-3 * velocity(row);
                x
            })
            .collect();
        Behind {
            gap: 4.0e-6,
            coulomb: 0.1,
            viscous: 0.0,
            restitution,
        }
        .follow(&path, 1.0e-3)
    }

    #[test]
    fn under_low_friction_it_coasts_to_the_other_side() {
        let lag = coasting(0.0);
        near(lag[290], 2.0e-6);
        near(lag[329], -2.0e-6);
    }

    #[test]
    fn an_elastic_load_rebounds_from_the_far_side() {
        let lag = coasting(0.9);
        let furthest = lag[300..]
            .iter()
            .fold(f64::INFINITY, |least, lag| least.min(*lag));
        assert!(
            (furthest + 2.0e-6).abs() < 1.0e-12 && lag[329] > furthest + 0.1e-6,
            "{furthest} {}",
            lag[329]
        );
    }
}
