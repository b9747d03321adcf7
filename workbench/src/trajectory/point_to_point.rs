//! Motion from one position to another, all axes together.

use super::smoothstep::smoothstep;

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
        let share = smoothstep(u);
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
