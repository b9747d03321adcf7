//! The pulses of a parameter set.

use controller::pulse::{POINTS, Point, PulseConfig, Schedule, Shape};

use super::{COUNTS_PER_M, MICROS, Q32, Reading};
use crate::objects::Parameter;
use crate::parameters::SetError;
use crate::physical::Fraction;

/// The acceleration at a reversal is the mean of about so long: short beside a fast circle's turn,
/// long beside the resolution of a slow one.
const MEAN_US: u64 = 16_000;

impl Reading<'_> {
    pub(super) fn pulse(&self) -> Result<PulseConfig, SetError> {
        Ok(PulseConfig {
            shape: Shape {
                amplitude: self.motion(Parameter::PulseHeight, 1)?,
                decay: self.decay(Parameter::PulseTime),
                start_delay_cycles: self.whole_cycles(Parameter::PulseStartDelay)?,
            },
            schedule: self.schedule()?,
            shortest_way: self.length(Parameter::PulseShortestWay, 1)?,
            stop_cycles: self.whole_cycles(Parameter::PulseStop)?.max(1),
        })
    }

    /// Pulses over the acceleration; without any height there are none.
    fn schedule(&self) -> Result<Option<Schedule>, SetError> {
        let heights = [Parameter::ADAPTIVE_FORWARD, Parameter::ADAPTIVE_BACKWARD];
        let says = |place: &Parameter| self.steps(*place) > 0;
        if !heights.iter().flatten().any(says) {
            return Ok(None);
        }
        let cycles = Fraction::new(&[MEAN_US], &[self.period_us]).and_then(Fraction::nearest);
        let mean_log2 = cycles.and_then(u64::checked_ilog2).unwrap_or(0);
        let mean_log2 = u8::try_from(mean_log2).unwrap_or(0);
        let first = self.first_acceleration()?;
        let schedule = Schedule::new(first, mean_log2, self.points()?);
        let too_small = SetError::TooSmall(Parameter::AdaptiveFirst);
        schedule.ok_or(too_small).map(Some)
    }

    /// In counts per cycle² with 32 fractional bits. Below 2³¹ · 2²⁹ · 2²⁷ · 2³².
    fn first_acceleration(&self) -> Result<u64, SetError> {
        let first = Parameter::AdaptiveFirst;
        let (steps, period_us) = (self.steps(first), self.period_us);
        let numerator = [steps, period_us, period_us, COUNTS_PER_M, Q32];
        let denominator = [first.unit().per_si, MICROS, MICROS];
        let acceleration = Fraction::new(&numerator, &denominator).and_then(Fraction::nearest);
        acceleration.ok_or(SetError::TooLarge(first))
    }

    fn points(&self) -> Result<[Point; POINTS], SetError> {
        let mut points = [Point::default(); POINTS];
        let heights = Parameter::ADAPTIVE_FORWARD
            .into_iter()
            .zip(Parameter::ADAPTIVE_BACKWARD);
        let times = Parameter::ADAPTIVE_TIME
            .into_iter()
            .zip(Parameter::ADAPTIVE_DELAY);
        for (point, ((forward, backward), (time, delay))) in
            points.iter_mut().zip(heights.zip(times))
        {
            *point = Point {
                forward: self.motion(forward, 1)?,
                backward: self.motion(backward, 1)?,
                decay: self.decay(time),
                start_delay_cycles: self.whole_cycles(delay)?,
            };
        }
        Ok(points)
    }
}

#[cfg(test)]
mod tests {
    use controller::units::Velocity;
    use fixed::types::{I2F30, I20F12};

    use super::*;
    use crate::parameters::ParameterSet;

    fn pulse(set: &ParameterSet) -> PulseConfig {
        Reading::of(set).pulse().unwrap()
    }

    #[test]
    fn the_points_of_a_table_are_in_machine_units_of_its_cycle_time() {
        let mut set = ParameterSet::default();
        set.set(Parameter::CyclePeriod, 500);
        // 1 mm/s from 3 mm/s² on, 20 ms, 5 ms: at 2 kHz 50 counts, 40 cycles and 10.
        set.set(Parameter::AdaptiveFirst, 3_000);
        for place in Parameter::ADAPTIVE_FORWARD {
            set.set(place, 1_000_000);
        }
        for place in Parameter::ADAPTIVE_BACKWARD {
            set.set(place, -2_000_000);
        }
        for place in Parameter::ADAPTIVE_TIME {
            set.set(place, 20_000_000);
        }
        for place in Parameter::ADAPTIVE_DELAY {
            set.set(place, 5_000);
        }
        let got = pulse(&set).schedule.unwrap();
        let point = Point {
            forward: Velocity(I20F12::from_num(50)),
            backward: Velocity(I20F12::from_num(-100)),
            decay: I2F30::from_num((-1.0_f64 / 40.0).exp()),
            start_delay_cycles: 10,
        };
        // 3 mm/s² are 0.075 counts per cycle²; 16 ms are 32 cycles.
        let first = (0.075 * 2.0_f64.powi(32)).round() as u64;
        assert_eq!(Some(got), Schedule::new(first, 5, [point; POINTS]));
    }

    #[test]
    fn a_table_without_a_height_is_none() {
        let mut set = ParameterSet::default();
        for place in Parameter::ADAPTIVE_TIME {
            set.set(place, 20_000_000);
        }
        assert_eq!(pulse(&set).schedule, None);
        set.set(Parameter::AdaptiveBackward9, 1_000_000);
        assert!(pulse(&set).schedule.is_some());
    }
}
