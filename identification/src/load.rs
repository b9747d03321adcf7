//! A load behind a gap, along a measured motor path.
//!
//! The motor pushes the load at one side of the gap; when the motor slows down harder than friction slows the load, the load leaves it and coasts,
//! decelerated by friction alone, until it rests or meets a side again. There it takes the motor's velocity and rebounds with a coefficient of
//! restitution (Newton's impact law): stiff flanks are far from inelastic.

/// A gap and the load behind it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Behind {
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
pub struct Load {
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
    pub fn follow(&self, motor: &[f64], period_s: f64) -> Load {
        let rows = motor.len();
        let [lag, velocity] = [(); 2].map(|()| Vec::with_capacity(rows));
        let mut load = Load { lag, velocity, contact: Vec::with_capacity(rows) };
        let at = |row: usize| motor[row.min(rows - 1)];
        let motor_velocity = |row: usize| (at(row + 1) - at(row)) / period_s;
        let (mut x, mut v) = (motor.first().copied().unwrap_or(0.0), 0.0_f64);
        for row in 0..rows {
            load.lag.push(at(row) - x);
            let deceleration = self.coulomb + self.viscous * v.abs();
            let slower = v.signum() * (v.abs() - deceleration * period_s).max(0.0);
            let coasting = x + 0.5 * (v + slower) * period_s;
            let next = at(row + 1);
            let pushed = coasting.max(next - 0.5 * self.gap).min(next + 0.5 * self.gap);
            let side = f64::from(i8::from(pushed > coasting) - i8::from(pushed < coasting));
            load.velocity.push((pushed - x) / period_s);
            load.contact.push(side != 0.0);
            v = if side == 0.0 {
                slower
            } else {
                let closing = (side * (motor_velocity(row.saturating_sub(1)) - v)).max(0.0);
                motor_velocity(row + 1) + side * self.restitution * closing
            };
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
        let behind = Behind { gap: 1.0, coulomb: 1.0e6, ..Behind::default() };
        assert_eq!(behind.follow(&path, 1.0).lag, [0.0, 0.5, 0.5, 0.5, 0.0, -0.5, -0.5, -0.5]);
    }

    /// The motor stops within one row; the load goes on at 1 mm/s, slowed by 0.1 m/s²: 5 µm of way over a gap of 4 µm.
    fn coasting(restitution: f64) -> Load {
        let path: Vec<f64> = (0..100).map(|row| 1.0e-6 * f64::from(row.min(50))).collect();
        Behind { gap: 4.0e-6, coulomb: 0.1, viscous: 0.0, restitution }.follow(&path, 1.0e-3)
    }

    #[test]
    fn under_low_friction_it_coasts_to_the_other_side() {
        let load = coasting(0.0);
        assert!((load.lag[50] - 2.0e-6).abs() < 1.0e-12, "{}", load.lag[50]);
        assert!((load.lag[99] + 2.0e-6).abs() < 1.0e-12, "{}", load.lag[99]);
    }

    #[test]
    fn an_elastic_load_rebounds_from_the_far_side() {
        // v² = 1 − 0.8 at the far side: 0.45 mm/s, back over v²/2d = 1 µm.
        let lag = coasting(1.0).lag;
        let end = lag[99];
        assert!((-1.1e-6..-0.8e-6).contains(&end), "{end}");
    }
}
