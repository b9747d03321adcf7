//! The pulse over the acceleration at the reversal.

use serde::{Deserialize, Serialize};
use servo::objects::Parameter;

use super::{Pulse, Wrong, check_pulse, expect};

/// Accelerations at which the drive has a pulse.
pub const POINTS: usize = Parameter::ADAPTIVE_TIME.len();
/// Each is so many times the one before.
const STEP: f64 = 4.0;

/// The drive's table of pulses, in SI units.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Adaptive {
    /// Acceleration of the first point; of each other four times that of the one before.
    pub acceleration_m_per_s2: f64,
    /// Height where the axis turns towards positive position, as a velocity at the table.
    pub forward_m_per_s: [f64; POINTS],
    /// And where it turns towards negative position.
    pub backward_m_per_s: [f64; POINTS],
    /// `T_comp`.
    pub time_constant_s: [f64; POINTS],
    /// Time from the reversal to the start of the pulse.
    pub start_delay_s: [f64; POINTS],
}

impl Adaptive {
    /// No pulse anywhere.
    pub const OFF: Self = Self {
        // R 100 mm at 100 mm/min; the last one is R 10 mm at 8000 mm/min.
        acceleration_m_per_s2: 2.8e-5,
        forward_m_per_s: [0.0; POINTS],
        backward_m_per_s: [0.0; POINTS],
        time_constant_s: [1.0e-3; POINTS],
        start_delay_s: [0.0; POINTS],
    };

    /// Accelerations of all points.
    #[must_use]
    pub fn accelerations_m_per_s2(&self) -> [f64; POINTS] {
        let mut acceleration = self.acceleration_m_per_s2 / STEP;
        [0.0; POINTS].map(|_| {
            acceleration *= STEP;
            acceleration
        })
    }

    /// Whether no reversal has a pulse.
    #[must_use]
    pub fn is_off(&self) -> bool {
        let mut heights = self.forward_m_per_s.iter().chain(&self.backward_m_per_s);
        heights.all(|height| *height == 0.0)
    }

    pub(super) fn check(&self) -> Result<(), Wrong> {
        let first = self.acceleration_m_per_s2;
        expect(
            (1.0e-6..=1.0e3).contains(&first),
            Wrong("acceleration_m_per_s2", "1e-6 to 1e3 m/s2", first),
        )?;
        for (key, heights) in [
            ("forward_m_per_s", self.forward_m_per_s),
            ("backward_m_per_s", self.backward_m_per_s),
        ] {
            let wrong = heights.into_iter().find(|height| !height.is_finite());
            wrong.map_or(Ok(()), |height| {
                Err(Wrong(key, "a finite velocity", height))
            })?;
        }
        for (time_constant_s, start_delay_s) in
            self.time_constant_s.into_iter().zip(self.start_delay_s)
        {
            check_pulse(Pulse {
                height_m_per_s: 0.0,
                time_constant_s,
                start_delay_s,
            })?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_points_reach_from_slow_circles_to_fast_ones() {
        let all = Adaptive::OFF.accelerations_m_per_s2();
        let of = |radius_m: f64, feed_mm_min: f64| (feed_mm_min / 6.0e4).powi(2) / radius_m;
        assert!((all[0] / of(0.1, 100.0) - 1.0).abs() < 0.02);
        assert!((all[8] / of(0.01, 8000.0) - 1.0).abs() < 0.05);
        assert!((all[4] / all[3] - 4.0).abs() < 1.0e-12);
        assert!(Adaptive::OFF.is_off());
    }

    #[test]
    fn a_point_that_makes_no_sense_is_refused_by_its_key() {
        let with = |change: fn(&mut Adaptive)| {
            let mut adaptive = Adaptive::OFF;
            change(&mut adaptive);
            adaptive.check().unwrap_err().0
        };
        assert_eq!(Adaptive::OFF.check().map_err(|wrong| wrong.0), Ok(()));
        for (wrong, key) in [
            (
                with(|own| own.acceleration_m_per_s2 = 0.0),
                "acceleration_m_per_s2",
            ),
            (
                with(|own| own.backward_m_per_s[3] = f64::NAN),
                "backward_m_per_s",
            ),
            (with(|own| own.time_constant_s[8] = 0.0), "time_constant_s"),
            (with(|own| own.start_delay_s[0] = -1.0), "start_delay_s"),
        ] {
            assert_eq!(wrong, key);
        }
    }
}
