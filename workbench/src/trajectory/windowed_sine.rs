//! A sine that comes in and goes out smoothly.
//!
//! It passes every velocity up to its peak and reverses with its peak acceleration.

use std::f64::consts::TAU;

use super::smoothstep::smoothstep;

/// Window that brings a sine in and out, periods: as many half waves go one way as the other.
const WINDOW: f64 = 0.75;

/// A sine about a position, from rest to rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct WindowedSine {
    /// Position about which it goes, m.
    pub centre_m: f64,
    /// Peak velocity, m/s.
    pub velocity_m_per_s: f64,
    /// Peak acceleration, m/s².
    pub acceleration_m_per_s2: f64,
    /// Periods at full amplitude.
    pub periods: f64,
    /// Where it goes first: 1 or −1.
    pub direction: f64,
}

impl WindowedSine {
    /// v = ω A, a = ω v.
    fn omega(&self) -> f64 {
        self.acceleration_m_per_s2 / self.velocity_m_per_s
    }

    /// From the centre to the point of reversal, m.
    #[must_use]
    pub(super) fn amplitude_m(&self) -> f64 {
        self.velocity_m_per_s / self.omega()
    }

    /// Of one period, s.
    #[must_use]
    pub(super) fn period_s(&self) -> f64 {
        TAU / self.omega()
    }

    /// With both windows, s.
    #[must_use]
    pub(super) fn duration_s(&self) -> f64 {
        (self.periods + 2.0 * WINDOW) * self.period_s()
    }

    /// Setpoint at a time since its start, m.
    #[must_use]
    pub(super) fn at(&self, time_s: f64) -> f64 {
        let left_s = self.duration_s() - time_s;
        let window =
            smooth(time_s / self.period_s() / WINDOW) * smooth(left_s / self.period_s() / WINDOW);
        self.centre_m + self.direction * self.amplitude_m() * window * (self.omega() * time_s).sin()
    }
}

fn smooth(u: f64) -> f64 {
    smoothstep(u.clamp(0.0, 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    const SINE: WindowedSine = WindowedSine {
        centre_m: 0.05,
        velocity_m_per_s: 0.1,
        acceleration_m_per_s2: 1.0,
        periods: 3.0,
        direction: 1.0,
    };

    #[test]
    fn it_begins_and_ends_at_its_centre_and_has_its_amplitude_between() {
        let end = SINE.duration_s();
        assert_eq!((SINE.at(0.0), SINE.at(end)), (0.05, 0.05));
        let middle = (0..1000).map(|row| SINE.at(end * f64::from(row) / 1000.0));
        let furthest = middle.fold(0.0, f64::max);
        assert!((furthest - 0.06).abs() < 1.0e-5, "{furthest}");
    }
}
