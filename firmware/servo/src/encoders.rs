//! From feedback frames to positions: unwrapping, plausibility, and prediction where a feedback is
//! missing.
//!
//! The motor encoder counts modulo 2³² and is unwrapped over any way. The load scale tells its low
//! 24 bits of 10 nm (0.168 m); where it stands is told by the motor and by their relation, a
//! parameter (2103h), and how well the two agree is measured, not assumed. A missing feedback is
//! predicted with the last velocity and the acceleration of the reference, which is what the axis
//! is doing if the loop does its work.

use controller::PositionSource;
use controller::units::{Acceleration, Position, PositionError, Velocity, WayPerIncrement};
use protocol::message::Feedback;
use protocol::weight::{LoadIncrements24, MotorIncrements};

use crate::settings::Relation;

/// Position of both encoders in one cycle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Measured {
    /// Motor encoder, as a position at the table.
    pub motor: Position,
    /// Load scale.
    pub load: Position,
}

impl Measured {
    /// The encoder that closes the loop.
    #[must_use]
    pub const fn of(&self, source: PositionSource) -> Position {
        match source {
            PositionSource::Motor => self.motor,
            PositionSource::Load => self.load,
        }
    }
}

/// What the encoders are judged by.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Encoding {
    /// Way per motor increment.
    pub way: WayPerIncrement,
    /// Where the scale stands when the motor stands at zero.
    pub relation: Relation,
    /// Way by which a feedback may differ from the expected one, per cycle.
    pub jump: PositionError,
    /// Which encoder closes the loop.
    pub source: PositionSource,
}

/// The encoder that closes the loop, or the motor's, jumped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Implausible;

/// What the encoders did so far.
#[derive(Clone, Copy, Debug, Default)]
pub struct Encoders {
    track: Option<Track>,
    scale_warnings: u32,
}

#[derive(Clone, Copy, Debug)]
struct Track {
    motor: Followed,
    load: Followed,
    raw: Raw,
    /// Load − motor, beyond their relation.
    relation_error: PositionError,
}

/// One encoder, as far as it has been followed.
#[derive(Clone, Copy, Debug)]
struct Followed {
    at: Position,
    velocity: Velocity,
    /// Cycles since the last reading.
    predicted_cycles: u16,
    /// The last position that was read, where that is longer ago.
    good: Position,
}

/// Raw counts of the last good feedback, the counts from which the motor's position is counted, and
/// where the load scale stood.
#[derive(Clone, Copy, Debug)]
struct Raw {
    base_counts: i32,
    base: Position,
    load: LoadIncrements24,
    load_at: Position,
}

impl Encoders {
    /// The last accepted or predicted position; `None` before the first feedback.
    #[must_use]
    pub fn position(&self) -> Option<Measured> {
        self.track.as_ref().map(Track::at)
    }

    /// Velocity of the encoder that closes the loop.
    #[must_use]
    pub fn velocity(&self, source: PositionSource) -> Velocity {
        self.track.map_or(Velocity::ZERO, |track| match source {
            PositionSource::Motor => track.motor.velocity,
            PositionSource::Load => track.load.velocity,
        })
    }

    /// Readings of a load scale that the loop does not need and that cannot be true.
    #[must_use]
    pub const fn scale_warnings(&self) -> u32 {
        self.scale_warnings
    }

    /// Whether scale and motor stand as their relation says; false before the first feedback.
    #[must_use]
    pub fn relation_holds(&self, relation: Relation) -> bool {
        self.track
            .is_some_and(|track| !track.relation_error.is_beyond(relation.window))
    }

    /// Takes a feedback.
    ///
    /// # Errors
    /// [`Implausible`] where it differs from the expected way by more than the limit, times the
    /// cycles since the last good one. A scale that does not close the loop is predicted instead
    /// and counted.
    pub fn accept(
        &mut self,
        feedback: Feedback,
        encoding: &Encoding,
    ) -> Result<Measured, Implausible> {
        let Some(track) = &mut self.track else {
            return Ok(self.track.insert(Track::first(feedback, encoding)).at());
        };
        let scale_is_true = track.take(feedback, encoding)?;
        if !scale_is_true {
            self.scale_warnings = self.scale_warnings.saturating_add(1);
        }
        Ok(track.at())
    }

    /// The axis goes on as it moved and as the reference accelerates: the position for a cycle
    /// without feedback.
    pub fn predict(&mut self, acceleration: Acceleration) -> Option<Measured> {
        let track = self.track.as_mut()?;
        let change = Velocity(acceleration.0);
        track.motor.go_on(change);
        track.load.go_on(change);
        Some(track.at())
    }

    /// Forgets where the axis was; the count of warnings stays.
    pub const fn forget(&mut self) {
        self.track = None;
    }
}

/// The motor's position is counted from a base that follows when it is this far away, so that the
/// difference never wraps.
const REBASE_AT: i32 = 1 << 30;

impl Raw {
    fn motor_position(&self, counts: MotorIncrements, way: WayPerIncrement) -> Position {
        let since = counts.0.wrapping_sub(self.base_counts);
        self.base.moved(way.times(since))
    }

    /// The base follows a position that is far away.
    fn rebase(&mut self, counts: MotorIncrements, position: Position) {
        let since = counts.0.wrapping_sub(self.base_counts);
        if since.unsigned_abs() > REBASE_AT.unsigned_abs() {
            self.base = position;
            self.base_counts = counts.0;
        }
    }
}

impl Followed {
    const fn standing(at: Position) -> Self {
        Self {
            at,
            velocity: Velocity::ZERO,
            predicted_cycles: 0,
            good: at,
        }
    }

    /// The velocity since the last good position, where the axis can have reached this one; `jump`
    /// is what it may be beside what was expected, for each cycle since then.
    fn reached(&self, position: Position, jump: PositionError) -> Option<Velocity> {
        if self.predicted_cycles == 0 {
            // The last position was good, and this is the way since then. No axis goes beyond the
            // range of a way in a cycle, 84 mm.
            let way = position.exact_error_from(self.at)?;
            let off = way.minus(self.velocity.way_lossy());
            return (!off.is_beyond(jump)).then(|| way.in_a_cycle());
        }
        let way = position.error_from(self.at);
        let off = way.minus(self.velocity.way_lossy());
        let cycles = self.predicted_cycles.saturating_add(1);
        let allowed = PositionError(jump.0.saturating_mul_int(i32::from(cycles)));
        // Both may be at the end of their range.
        (off.magnitude() <= allowed).then(|| position.velocity_since(self.good, cycles))
    }

    const fn take(&mut self, position: Position, velocity: Velocity) {
        self.at = position;
        self.velocity = velocity;
        self.predicted_cycles = 0;
    }

    /// A cycle without a reading.
    fn go_on(&mut self, change: Velocity) {
        if self.predicted_cycles == 0 {
            self.good = self.at;
        }
        self.velocity = self.velocity.plus(change);
        self.at = self.at.after(self.velocity);
        self.predicted_cycles = self.predicted_cycles.saturating_add(1);
    }
}

impl Track {
    /// The load scale is taken to stand nearest to where the relation expects it; how far off that
    /// is, is remembered.
    fn first(feedback: Feedback, encoding: &Encoding) -> Self {
        let motor = encoding.way.times(feedback.motor.0);
        let (load_counts, relation_error) = near_relation(motor, feedback.load, encoding.relation);
        let raw = Raw {
            base_counts: feedback.motor.0,
            base: motor,
            load: feedback.load,
            load_at: Position::from_counts(load_counts),
        };
        Self {
            motor: Followed::standing(motor),
            load: Followed::standing(raw.load_at),
            raw,
            relation_error,
        }
    }

    const fn at(&self) -> Measured {
        Measured {
            motor: self.motor.at,
            load: self.load.at,
        }
    }

    /// Takes a feedback; tells whether the load scale's reading is true. Nothing changes where it
    /// is implausible.
    fn take(&mut self, feedback: Feedback, encoding: &Encoding) -> Result<bool, Implausible> {
        let raw = &mut self.raw;
        let motor = raw.motor_position(feedback.motor, encoding.way);
        let load = raw.load_at.moved_by_counts(raw.load.step_to(feedback.load));
        let velocity = self.motor.reached(motor, encoding.jump);
        let load_velocity = self.load.reached(load, encoding.jump);
        let velocity = velocity.ok_or(Implausible)?;
        if load_velocity.is_none() && encoding.source == PositionSource::Load {
            return Err(Implausible);
        }
        raw.rebase(feedback.motor, motor);
        self.motor.take(motor, velocity);
        match load_velocity {
            Some(velocity) => {
                raw.load = feedback.load;
                raw.load_at = load;
                self.load.take(load, velocity);
            }
            None => self.load.go_on(Velocity::ZERO),
        }
        Ok(load_velocity.is_some())
    }
}

/// The scale's counts nearest to where motor and relation expect it, and how far from there.
fn near_relation(
    motor: Position,
    load: LoadIncrements24,
    relation: Relation,
) -> (i64, PositionError) {
    let motor_counts: i64 = motor.0.to_num();
    let expected = motor_counts.saturating_add(i64::from(relation.offset));
    let off = LoadIncrements24::from_counts(expected).step_to(load);
    let error = Position::from_counts(i64::from(off)).error_from(Position::default());
    (expected.saturating_add(i64::from(off)), error)
}

#[cfg(test)]
mod tests {
    use super::*;
    use fixed::types::{I20F12, I24F8};
    use protocol::SyncCounter;

    fn encoding(source: PositionSource) -> Encoding {
        Encoding {
            way: WayPerIncrement {
                whole: 1,
                fraction: 0,
            },
            relation: Relation {
                offset: 0,
                window: window(100_000),
            },
            jump: window(1000),
            source,
        }
    }

    fn window(counts: i32) -> PositionError {
        PositionError(I24F8::from_num(counts))
    }

    fn feedback(motor: i32, load: i64) -> Feedback {
        let load = LoadIncrements24::from_counts(load);
        Feedback {
            motor: MotorIncrements(motor),
            load,
            counter: SyncCounter::FIRST,
        }
    }

    fn taken(encoders: &mut Encoders, motor: i32, load: i64) -> Option<(i64, i64)> {
        let at = encoders
            .accept(feedback(motor, load), &encoding(PositionSource::Load))
            .ok()?;
        Some((at.motor.0.to_num(), at.load.0.to_num()))
    }

    #[test]
    fn motor_and_scale_are_unwrapped_over_any_way() {
        let mut encoders = Encoders::default();
        for step in 0..6_000_000_i64 {
            let counts = 900 * step;
            let motor = i32::from_le_bytes(counts.to_le_bytes()[..4].try_into().unwrap());
            assert_eq!(taken(&mut encoders, motor, counts), Some((counts, counts)));
        }
    }

    #[test]
    fn a_jump_is_refused_and_the_prediction_bridges_it() {
        let mut encoders = Encoders::default();
        assert!(taken(&mut encoders, 0, 0).is_some() && taken(&mut encoders, 500, 500).is_some());
        assert_eq!(taken(&mut encoders, 90_000, 90_000), None);
        let predicted: i64 = encoders
            .predict(Acceleration::default())
            .unwrap()
            .motor
            .0
            .to_num();
        assert_eq!(predicted, 1000);
        assert_eq!(taken(&mut encoders, 1500, 1500), Some((1500, 1500)));
    }

    #[test]
    fn a_prediction_goes_on_with_the_acceleration_of_the_reference() {
        let mut encoders = Encoders::default();
        taken(&mut encoders, 0, 0);
        taken(&mut encoders, 500, 500);
        let acceleration = Acceleration(I20F12::from_num(20));
        let ways: Vec<i64> = (0..3)
            .map(|_| encoders.predict(acceleration).unwrap().load.0.to_num())
            .collect();
        assert_eq!(ways, [1020, 1560, 2120]);
    }

    #[test]
    fn a_scale_that_stands_elsewhere_than_its_relation_says_is_noticed_and_with_it_is_right() {
        let at_100_mm = feedback(0, 10_000_000);
        let mut encoders = Encoders::default();
        encoders
            .accept(at_100_mm, &encoding(PositionSource::Load))
            .unwrap();
        assert!(!encoders.relation_holds(encoding(PositionSource::Load).relation));
        let related = Encoding {
            relation: Relation {
                offset: 10_000_000,
                window: window(100),
            },
            ..encoding(PositionSource::Load)
        };
        let mut encoders = Encoders::default();
        let at = encoders.accept(at_100_mm, &related).unwrap();
        assert_eq!(at.load.0.to_num::<i64>(), 10_000_000);
        assert!(encoders.relation_holds(related.relation));
    }

    #[test]
    fn an_implausible_scale_trips_no_loop_on_the_motor_and_is_counted() {
        let mut encoders = Encoders::default();
        let motor = encoding(PositionSource::Motor);
        for (counts, scale) in [(0, 0), (500, 500), (1000, 900_000), (1500, 1500)] {
            let at = encoders.accept(feedback(counts, scale), &motor).unwrap();
            assert_eq!(at.load.0.to_num::<i32>(), counts);
        }
        assert_eq!(encoders.scale_warnings(), 1);
        assert_eq!(
            taken(&mut encoders, 2000, 900_000),
            None,
            "a loop on the scale does not take it"
        );
    }

    /// A scale that slipped while the axis moved is taken up once what it may have gone since is
    /// beyond every range, on either side.
    #[test]
    fn a_scale_that_slipped_far_is_taken_up_again_both_ways() {
        let motor = encoding(PositionSource::Motor);
        let cycles = [1, -1].map(|way| {
            let mut encoders = Encoders::default();
            for (counts, scale) in [(0, 0), (500, 500), (1000, 1000)] {
                let moved = feedback(way * counts, i64::from(way * scale));
                encoders.accept(moved, &motor).unwrap();
            }
            let slipped = feedback(way * 1000, i64::from(way) * (1000 - 5_000_000));
            let refused = |encoders: &mut Encoders| {
                let before = encoders.scale_warnings();
                encoders.accept(slipped, &motor).unwrap();
                encoders.scale_warnings() > before
            };
            (0..20_000).position(|_| !refused(&mut encoders))
        });
        assert_eq!(cycles, [Some(8388), Some(8388)]);
    }
}
