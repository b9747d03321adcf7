//! A load behind a gap, along a measured motor path.
//!
//! The motor pushes the load at one side of the gap; when the motor slows down harder than friction
//! slows the load, the load leaves it and coasts, decelerated by friction alone, until it rests or
//! meets a side again. There it takes the motor's velocity and rebounds with a coefficient of
//! restitution (Newton's impact law): stiff flanks are far from inelastic.

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

/// Motion of the load over each interval between two rows.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Load {
    /// Motor − load at each row, −gap/2…gap/2.
    pub lag: Vec<f64>,
    /// Mean velocity from each row to the next.
    pub velocity: Vec<f64>,
    /// Whether the motor touches it within the interval.
    pub contact: Vec<bool>,
}

impl Behind {
    /// The load's motion.
    #[must_use]
    pub(crate) fn follow(&self, motor: &[f64], period_s: f64) -> Load {
        let rows = motor.len();
        let [lag, velocity] = [(); 2].map(|()| Vec::with_capacity(rows));
        let mut load = Load {
            lag,
            velocity,
            contact: Vec::with_capacity(rows),
        };
        let at = |row: usize| motor[row.min(rows - 1)];
        let motor_velocity = |row: usize| (at(row + 1) - at(row)) / period_s;
        let (mut x, mut v, mut pushing) = (motor.first().copied().unwrap_or(0.0), 0.0_f64, 0.0_f64);
        for row in 0..rows {
            load.lag.push(at(row) - x);
            let deceleration = self.coulomb + self.viscous * v.abs();
            let slower = v.signum() * (v.abs() - deceleration * period_s).max(0.0);
            let coasting_s = if slower == 0.0 {
                v.abs() / deceleration.max(f64::MIN_POSITIVE)
            } else {
                period_s
            };
            let coasting = x + 0.5 * (v + slower) * coasting_s.min(period_s);
            let next = at(row + 1);
            let pushed = coasting
                .max(next - 0.5 * self.gap)
                .min(next + 0.5 * self.gap);
            let side = f64::from(i8::from(pushed > coasting) - i8::from(pushed < coasting));
            load.velocity.push((pushed - x) / period_s);
            load.contact.push(side != 0.0);
            v = if side == 0.0 {
                slower
            } else {
                // A load that is pushed has the motor's velocity at the row; one that is hit, that
                // after the impact, which the next interval shows.
                let closing = (side * (motor_velocity(row.saturating_sub(1)) - v)).max(0.0);
                let after = motor_velocity(row + 1);
                let common = if pushing == side {
                    0.5 * (motor_velocity(row) + after)
                } else {
                    after
                };
                common + side * self.restitution * closing
            };
            pushing = side;
            x = pushed;
        }
        load
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn under_high_friction_the_load_waits_while_the_motor_crosses_the_gap() {
        let path = [0.0, 1.0, 2.0, 3.0, 2.5, 2.0, 1.0, 0.0];
        let behind = Behind {
            gap: 1.0,
            coulomb: 1.0e6,
            ..Behind::default()
        };
        let lag = behind.follow(&path, 1.0).lag;
        let wanted = [0.0, 0.5, 0.5, 0.5, 0.0, -0.5, -0.5, -0.5];
        assert!(
            lag.iter()
                .zip(wanted)
                .all(|(lag, wanted)| (lag - wanted).abs() < 1.0e-5),
            "{lag:?}"
        );
    }

    /// The motor speeds up to 10 mm/s within 0.2 s and stops within 10 ms; friction slows the load
    /// by 0.1 m/s² only.
    fn coasting(restitution: f64) -> Load {
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
        let load = coasting(0.0);
        assert!(
            (load.lag[290] - 2.0e-6).abs() < 1.0e-12,
            "{}",
            load.lag[290]
        );
        assert!(
            (load.lag[329] + 2.0e-6).abs() < 1.0e-12,
            "{}",
            load.lag[329]
        );
    }

    #[test]
    fn an_elastic_load_rebounds_from_the_far_side() {
        let lag = coasting(0.9).lag;
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
