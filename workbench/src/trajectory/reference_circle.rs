//! The reference circle of a ballbar test, with a smooth start and stop.

use std::f64::consts::{PI, TAU};

use super::smoothstep::smoothstep_area;

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
                - self.omega() * ramp * smoothstep_area(((total - time_s) / ramp).clamp(0.0, 1.0));
        }
        if time_s <= ramp {
            return self.omega() * ramp * smoothstep_area((time_s / ramp).clamp(0.0, 1.0));
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
}
