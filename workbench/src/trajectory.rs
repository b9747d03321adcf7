//! Reference trajectories: functions of the cycle, within the limits of the axes.

pub mod sine_bursts;

use std::f64::consts::{PI, TAU};

/// Reference circle in X and Y: from X = 0, Y = −R, counter-clockwise (or clockwise), with a smooth
/// start over the first quarter turn and a smooth stop over the last one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Circle {
    /// Radius, m.
    pub radius_m: f64,
    /// Path velocity, m/s.
    pub feed_m_per_s: f64,
    /// Full turns that count.
    pub turns: u32,
    /// Counter-clockwise seen from above, X to the right and Y upwards.
    pub counter_clockwise: bool,
}

/// Angle of the smooth start and of the smooth stop.
const RAMP_RAD: f64 = PI / 2.0;
/// The turns that count begin here: after the first half turn, and away from a reversal by an
/// eighth.
pub const MEASURE_FROM_RAD: f64 = 1.25 * PI;

impl Circle {
    /// Angle travelled at which the turns that count end.
    #[must_use]
    pub fn measure_to_rad(&self) -> f64 {
        MEASURE_FROM_RAD + TAU * f64::from(self.turns)
    }

    fn omega(&self) -> f64 {
        self.feed_m_per_s / self.radius_m
    }

    /// A quintic ramp from rest to ω takes twice the time of the same angle at full speed.
    fn ramp_s(&self) -> f64 {
        2.0 * RAMP_RAD / self.omega()
    }

    fn end_rad(&self) -> f64 {
        self.measure_to_rad() + 0.25 * PI + RAMP_RAD
    }

    /// Duration of the whole run, s.
    #[must_use]
    pub fn duration_s(&self) -> f64 {
        2.0 * self.ramp_s() + (self.end_rad() - 2.0 * RAMP_RAD) / self.omega()
    }

    /// Angle travelled at a time, rad.
    #[must_use]
    pub fn angle_rad(&self, time_s: f64) -> f64 {
        let (ramp, total) = (self.ramp_s(), self.duration_s());
        if time_s >= total - ramp {
            return self.end_rad()
                - self.omega() * ramp * smooth_area(((total - time_s) / ramp).clamp(0.0, 1.0));
        }
        if time_s <= ramp {
            return self.omega() * ramp * smooth_area((time_s / ramp).clamp(0.0, 1.0));
        }
        RAMP_RAD + self.omega() * (time_s - ramp)
    }

    /// Setpoint of X and Y at a time, m.
    #[must_use]
    pub fn at(&self, time_s: f64) -> [f64; 2] {
        let angle = self.angle_rad(time_s);
        let sense = if self.counter_clockwise { 1.0 } else { -1.0 };
        [
            sense * self.radius_m * angle.sin(),
            -self.radius_m * angle.cos(),
        ]
    }
}

/// ∫ of the smoothstep `10 u³ − 15 u⁴ + 6 u⁵` from 0 to `u`.
fn smooth_area(u: f64) -> f64 {
    u.powi(4) * (2.5 - 3.0 * u + u * u)
}

/// Point-to-point motion of several axes with a quintic profile, all arriving together.
#[derive(Clone, Debug, PartialEq)]
pub struct Move {
    from: Vec<f64>,
    to: Vec<f64>,
    duration_s: f64,
}

impl Move {
    /// A motion within a velocity and an acceleration limit.
    #[must_use]
    pub fn new(
        from: &[f64],
        to: &[f64],
        velocity_m_per_s: f64,
        acceleration_m_per_s2: f64,
    ) -> Self {
        let longest = from
            .iter()
            .zip(to)
            .map(|(from, to)| (to - from).abs())
            .fold(0.0, f64::max);
        // The quintic's peak velocity is 15/8 of the mean, its peak acceleration 10/√3 · s/T².
        let by_velocity = 1.875 * longest / velocity_m_per_s;
        let by_acceleration = (10.0 / 3.0_f64.sqrt() * longest / acceleration_m_per_s2).sqrt();
        Self {
            from: from.to_vec(),
            to: to.to_vec(),
            duration_s: by_velocity.max(by_acceleration).max(0.01),
        }
    }

    /// Duration, s.
    #[must_use]
    pub const fn duration_s(&self) -> f64 {
        self.duration_s
    }

    /// Setpoints at a time, m.
    #[must_use]
    pub fn at(&self, time_s: f64) -> Vec<f64> {
        let u = (time_s / self.duration_s).clamp(0.0, 1.0);
        let share = u.powi(3) * (10.0 - 15.0 * u + 6.0 * u * u);
        self.from
            .iter()
            .zip(&self.to)
            .map(|(from, to)| from + share * (to - from))
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_circle_starts_and_stops_at_rest_and_runs_at_its_feed_between() {
        let circle = Circle {
            radius_m: 0.1,
            feed_m_per_s: 2.0 / 60.0,
            turns: 3,
            counter_clockwise: true,
        };
        let speed = |t: f64| {
            let ([x0, y0], [x1, y1]) = (circle.at(t - 5.0e-4), circle.at(t + 5.0e-4));
            (x1 - x0).hypot(y1 - y0) / 1.0e-3
        };
        assert!(speed(0.001) < 1.0e-6 && speed(circle.duration_s() - 0.001) < 1.0e-6);
        for part in [0.3, 0.5, 0.8] {
            assert!((speed(part * circle.duration_s()) / circle.feed_m_per_s - 1.0).abs() < 1.0e-6);
        }
        assert!((circle.angle_rad(circle.duration_s()) - circle.end_rad()).abs() < 1.0e-9);
        let ramp = circle.ramp_s();
        assert!(
            (circle.angle_rad(ramp) - RAMP_RAD).abs() < 1.0e-9,
            "{}",
            circle.angle_rad(ramp)
        );
    }

    #[test]
    fn a_move_keeps_its_limits() {
        let path = Move::new(&[0.0], &[-0.1], 0.25, 2.5);
        let at = |t: f64| path.at(t)[0];
        let dt = 1.0e-4;
        let steps = (path.duration_s() / dt) as usize;
        for i in 1..steps {
            let t = dt * i as f64;
            assert!(((at(t + dt) - at(t - dt)) / (2.0 * dt)).abs() <= 0.25 + 1.0e-6);
            assert!(((at(t + dt) - 2.0 * at(t) + at(t - dt)) / (dt * dt)).abs() <= 2.5 + 1.0e-2);
        }
    }
}
