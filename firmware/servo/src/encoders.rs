//! From feedback frames to positions: unwrapping, plausibility, and prediction where a feedback is missing.

use controller::units::{Position, PositionError, Velocity, WayPerIncrement};
use protocol::message::Feedback;
use protocol::weight::LoadIncrements24;

/// Position of both encoders in one cycle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Measured {
    /// Motor encoder, as a position at the table.
    pub motor: Position,
    /// Load scale.
    pub load: Position,
}

/// What the encoders did so far.
#[derive(Clone, Copy, Debug, Default)]
pub struct Encoders {
    track: Option<Track>,
}

#[derive(Clone, Copy, Debug)]
struct Track {
    at: Measured,
    load_counts: i64,
    load_raw: LoadIncrements24,
    motor_velocity: Velocity,
    load_velocity: Velocity,
    good: Measured,
    predicted_cycles: u16,
}

impl Encoders {
    /// The last accepted or predicted position; `None` before the first feedback.
    #[must_use]
    pub fn position(&self) -> Option<Measured> {
        self.track.map(|track| track.at)
    }

    /// Takes a feedback; `None` where it differs from the expected way by more than `limit` (times the cycles since the last good one).
    pub fn accept(&mut self, feedback: Feedback, way: WayPerIncrement, limit: PositionError) -> Option<Measured> {
        let motor = way.times(feedback.motor.0);
        let next = match self.track {
            None => Track::first(motor, feedback.load),
            Some(track) => track.next(motor, feedback.load, limit)?,
        };
        self.track = Some(next);
        Some(next.at)
    }

    /// The axis goes on as it moved: the position for a cycle without feedback.
    pub fn predict(&mut self) -> Option<Measured> {
        let track = self.track.as_mut()?;
        track.at.motor = track.at.motor.after(track.motor_velocity);
        track.at.load = track.at.load.after(track.load_velocity);
        track.predicted_cycles = track.predicted_cycles.saturating_add(1);
        Some(track.at)
    }
}

impl Track {
    /// The load scale tells only its low 24 bits: it is taken to stand nearest to the motor encoder.
    fn first(motor: Position, load: LoadIncrements24) -> Self {
        let motor_counts: i64 = motor.0.to_num();
        let near = LoadIncrements24::from_counts(motor_counts);
        let load_counts = motor_counts.saturating_add(i64::from(near.step_to(load)));
        let at = Measured { motor, load: Position::from_counts(load_counts) };
        Self {
            at,
            good: at,
            load_counts,
            load_raw: load,
            motor_velocity: Velocity::ZERO,
            load_velocity: Velocity::ZERO,
            predicted_cycles: 0,
        }
    }

    fn next(self, motor: Position, load: LoadIncrements24, limit: PositionError) -> Option<Self> {
        let load_counts = self.load_counts.saturating_add(i64::from(self.load_raw.step_to(load)));
        let at = Measured { motor, load: Position::from_counts(load_counts) };
        let cycles = self.predicted_cycles.saturating_add(1);
        // After predicted cycles `self.at` has moved on with the old velocity, so one more step of it is what we expect.
        let expected =
            Measured { motor: self.at.motor.after(self.motor_velocity), load: self.at.load.after(self.load_velocity) };
        let allowed = times(limit, cycles);
        let plausible = motor.error_from(expected.motor).magnitude() <= allowed
            && at.load.error_from(expected.load).magnitude() <= allowed;
        plausible.then(|| Self {
            at,
            load_counts,
            load_raw: load,
            good: at,
            motor_velocity: motor.velocity_since(self.good.motor, cycles),
            load_velocity: at.load.velocity_since(self.good.load, cycles),
            predicted_cycles: 0,
        })
    }
}

fn times(limit: PositionError, cycles: u16) -> PositionError {
    PositionError(limit.0.saturating_mul_int(i32::from(cycles)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use protocol::SyncCounter;
    use protocol::weight::MotorIncrements;

    const WAY: WayPerIncrement = WayPerIncrement { whole: 1, fraction: 0 };

    fn limit() -> PositionError {
        PositionError(fixed::types::I24F8::from_num(1000))
    }

    fn feedback(position: i32) -> Feedback {
        let load = LoadIncrements24::from_counts(i64::from(position));
        Feedback { motor: MotorIncrements(position), load, counter: SyncCounter::FIRST }
    }

    fn taken(encoders: &mut Encoders, position: i32) -> Option<i64> {
        encoders.accept(feedback(position), WAY, limit()).map(|at| at.load.0.to_num())
    }

    #[test]
    fn the_load_scale_is_unwrapped_beyond_its_24_bits() {
        let mut encoders = Encoders::default();
        for step in 0..40_000 {
            assert_eq!(taken(&mut encoders, 16_000_000 + step * 900), Some(i64::from(16_000_000 + step * 900)));
        }
    }

    #[test]
    fn a_jump_is_refused_and_the_prediction_bridges_it() {
        let mut encoders = Encoders::default();
        assert!(taken(&mut encoders, 0).is_some() && taken(&mut encoders, 500).is_some());
        assert_eq!(taken(&mut encoders, 90_000), None);
        let predicted: i64 = encoders.predict().unwrap().motor.0.to_num();
        assert_eq!(predicted, 1000);
        assert_eq!(taken(&mut encoders, 1500), Some(1500));
    }
}
