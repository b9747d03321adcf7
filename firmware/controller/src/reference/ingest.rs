//! Ingest: which setpoints are believed.
//!
//! A setpoint is compared with the *extrapolation* of the track at constant acceleration. What lies
//! off it by no more than `step` is believed at once. What lies farther off is a step of
//! acceleration or an outlier, and the next setpoint tells which. With the deviations d1 and d2 of
//! the two setpoints from the track extrapolated over both (one cycle between them):
//!
//! | what happened | d1 | d2 | believed: d2 − 3 d1 | wrong: d2 |
//! |---|---|---|---|---|
//! | acceleration stepped by s | s | 3 s | 0 | 3 s |
//! | velocity stepped by V | V | 2 V | −V | 2 V |
//! | the first setpoint is wrong by e | e | 0 | −3 e | 0 |
//! | the position shifted by J | J | J | −2 J | J |
//!
//! The last two columns are the jumps of acceleration that would be left; the smaller wins among
//! what the axis can do. A setpoint that is not believed is replaced by its extrapolation, and the
//! next one is judged in the same way: a shifted position is refused again and again, and that is
//! the caller's fault to latch. Until the decision the track goes on along its extrapolation; both
//! fall before the setpoint is due.
//!
//! After a hole of m − 1 cycles a step of acceleration anywhere in it leaves d2 ≈ 2 d1. A deviation
//! d1 within `step` is shared out as a constant step would: velocity 2 d1 / (m + 1), acceleration 2
//! d1 / (m (m + 1)). A larger one waits for d2, which tells the velocity d2 − d1 itself. Where the
//! setpoint that would decide is lost, what the axis can do is believed: a step is more likely than
//! a second thing that went wrong.

use fixed::types::I56F8;

use super::track::{Track, Way, limited, moved, way, within};

/// What the axis can do between two setpoints.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bounds {
    /// Jump of acceleration that needs no confirmation.
    pub(super) step: Way,
    /// Acceleration that is possible.
    pub(super) acceleration: Way,
}

/// Memory of the ingest.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ingest {
    /// The believed track at the newest setpoint.
    pub(super) track: Track,
    /// How far the newest setpoint lies off the track, while that is not decided.
    doubt: Option<Way>,
    /// Setpoints in a row that the track did without, before the newest or with it.
    hole: u8,
    /// Setpoints to come that are taken as they are: a track needs three for its acceleration.
    to_adopt: u8,
    refusals: u16,
}

/// What the setpoints of a cycle did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Taken {
    /// The newest setpoint but one was believed only now.
    pub(super) revised: Option<Revision>,
    /// Change of acceleration that the newest setpoint brought.
    pub(super) jerk: Way,
    /// The newest setpoint is not part of the track: it is lost, or not decided.
    pub(super) extrapolated: bool,
    /// It is lost.
    pub(super) bridged: bool,
    /// The one before it was refused.
    pub(super) refused: bool,
}

/// A setpoint that was believed late.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Revision {
    /// The track at that setpoint.
    pub(super) track: Track,
    /// How far its position moved.
    pub(super) by: Way,
}

/// Position, velocity and acceleration make three.
const ADOPTED: u8 = 3;

/// The longest hole that refusals alone make. Nothing longer is needed to come back after a wrong
/// setpoint that fell on a step of acceleration, and a shift of 60 µm stays out of reach of an axis
/// of 5 m/s² at 1 kHz.
const REFUSED_HOLE: u8 = 3;

impl Ingest {
    pub(super) const fn at(track: Track) -> Self {
        Self {
            track,
            doubt: None,
            hole: 0,
            to_adopt: ADOPTED,
            refusals: 0,
        }
    }

    /// Setpoints in a row that were refused.
    pub(super) const fn refusals(&self) -> u16 {
        self.refusals
    }

    /// Nothing stands between the newest setpoint and the one before it.
    pub(super) const fn is_settled(&self) -> bool {
        self.doubt.is_none() && self.hole == 0 && self.to_adopt == 0
    }

    /// No setpoint came since the start.
    pub(super) const fn is_waiting(&self) -> bool {
        self.to_adopt == ADOPTED
    }

    /// The plain case: the next setpoint continues a settled track within `step`.
    pub(super) fn continued(&self, step: Way, next: I56F8, velocity: Way) -> Option<Track> {
        let candidate = self.track.moved_there(next, velocity);
        let jump = candidate
            .acceleration
            .saturating_sub(self.track.acceleration);
        (self.is_settled() && within(jump, step)).then_some(candidate)
    }

    /// A setpoint that came late fills the hole that it left, at once or once the next one has
    /// confirmed it.
    pub(super) fn late(&mut self, bounds: Bounds, position: I56F8) -> Option<Revision> {
        if self.hole == 0 || self.doubt.is_some() || self.is_waiting() {
            return None;
        }
        self.hole = self.hole.saturating_sub(1);
        let deviation = way(self.track.position, position);
        if within(deviation, bounds.step) {
            return Some(self.revised(deviation));
        }
        self.doubt = Some(deviation);
        None
    }

    /// The next setpoint, or none; `judged` is off while nobody follows.
    pub(super) fn take(&mut self, bounds: Bounds, judged: bool, next: Option<I56F8>) -> Taken {
        let doubt = self.doubt.take();
        let revised = doubt.and_then(|first| self.decide(bounds, judged, first, next));
        let before = self.track.acceleration;
        let confirmed = match next {
            Some(next) => self.advance(bounds, judged, next),
            None => self.bridge(),
        };
        Taken {
            revised,
            jerk: self.track.acceleration.saturating_sub(before),
            extrapolated: !confirmed,
            bridged: next.is_none(),
            refused: doubt.is_some() && revised.is_none(),
        }
    }

    fn decide(
        &mut self,
        bounds: Bounds,
        judged: bool,
        first: Way,
        next: Option<I56F8>,
    ) -> Option<Revision> {
        let second = next.map(|next| way(self.track.ahead().position, next));
        // Where the next one is lost, a step is more likely than a second thing that went wrong.
        let is_believed = match second {
            None => self.is_possible(bounds, self.hole.saturating_add(1), first),
            Some(second) => self.is_believable(bounds, first, second),
        };
        if judged && !is_believed {
            // However many are refused: what the axis can reach does not grow with them for ever.
            self.hole = self.hole.max(self.hole.saturating_add(1).min(REFUSED_HOLE));
            self.refusals = self.refusals.saturating_add(1);
            return None;
        }
        match second.filter(|_| self.hole > 0) {
            None => self.believe(first),
            Some(second) => self.believe_both(bounds, first, second),
        }
        Some(Revision {
            track: self.track,
            by: first,
        })
    }

    fn revised(&mut self, by: Way) -> Revision {
        self.believe(by);
        Revision {
            track: self.track,
            by,
        }
    }

    /// The table of the module's head: where both are possible, a setpoint is believed that leaves
    /// clearly less.
    fn is_believable(&self, bounds: Bounds, first: Way, second: Way) -> bool {
        let cycles = self.hole.saturating_add(1);
        let between = second.saturating_sub(first).saturating_sub(first);
        let left = if self.hole == 0 {
            between.saturating_sub(first)
        } else {
            between
        };
        let goes_on = self.hole > 0
            || within(
                self.track.acceleration.saturating_add(between),
                bounds.acceleration,
            );
        let believed = self.is_possible(bounds, cycles, first) && goes_on;
        let otherwise = self.hole > 0
            || within(
                self.track.acceleration.saturating_add(second),
                bounds.acceleration,
            );
        believed
            && !(otherwise
                && left.saturating_abs().saturating_add(bounds.step) >= second.saturating_abs())
    }

    /// Whether the axis can be off its extrapolation by so much after so many cycles: |a T + d| ≤
    /// limit · T with T = m (m + 1) / 2.
    fn is_possible(&self, bounds: Bounds, cycles: u8, deviation: Way) -> bool {
        let cycles = i32::from(cycles);
        let times = cycles
            .saturating_mul(cycles.saturating_add(1))
            .wrapping_shr(1);
        let way = self
            .track
            .acceleration
            .saturating_mul_int(times)
            .saturating_add(deviation);
        within(way, bounds.acceleration.saturating_mul_int(times))
    }

    fn advance(&mut self, bounds: Bounds, judged: bool, next: I56F8) -> bool {
        if self.to_adopt > 0 {
            self.adopt(next);
            return true;
        }
        let expected = self.track.ahead();
        let deviation = way(expected.position, next);
        let is_plausible = within(deviation, bounds.step)
            || !judged && self.is_possible(bounds, self.hole.saturating_add(1), deviation);
        if !is_plausible && !judged {
            // Nobody follows, so the setpoint may begin anew anywhere.
            *self = Self::at(self.track);
            self.adopt(next);
            return true;
        }
        self.track = expected;
        if is_plausible {
            self.believe(deviation);
        } else {
            self.doubt = Some(deviation);
        }
        is_plausible
    }

    /// The track goes on without a setpoint.
    fn bridge(&mut self) -> bool {
        self.track = self.track.ahead();
        self.hole = self.hole.saturating_add(1);
        false
    }

    /// The newest setpoint is part of the track.
    fn believe(&mut self, deviation: Way) {
        let [velocity, acceleration] = shares(self.hole, deviation);
        self.track = Track {
            position: moved(self.track.position, deviation),
            velocity: self.track.velocity.saturating_add(velocity),
            acceleration: self.track.acceleration.saturating_add(acceleration),
        };
        self.hole = 0;
        self.refusals = 0;
    }

    /// The newest setpoint after a hole of m − 1 cycles and the one that follows it are part of the
    /// track. The way between them is a velocity, the way over the hole a mean velocity, (m + 1) /
    /// 2 cycles earlier; the acceleration is their difference over that time.
    fn believe_both(&mut self, bounds: Bounds, first: Way, second: Way) {
        let cycles = i32::from(self.hole).saturating_add(1);
        let velocity = second.saturating_sub(first);
        let difference = velocity
            .saturating_mul_int(cycles)
            .saturating_sub(first)
            .saturating_mul_int(2);
        let share = difference
            .checked_div_int(cycles.saturating_mul(cycles.saturating_add(1)))
            .unwrap_or_default();
        let acceleration = limited(
            self.track.acceleration.saturating_add(share),
            bounds.acceleration,
        );
        let next_velocity = self
            .track
            .velocity
            .saturating_add(self.track.acceleration)
            .saturating_add(velocity);
        self.track = Track {
            position: moved(self.track.position, first),
            velocity: next_velocity.saturating_sub(acceleration),
            acceleration,
        };
        self.hole = 0;
        self.refusals = 0;
    }

    /// The first three setpoints: position, then velocity, then acceleration.
    fn adopt(&mut self, next: I56F8) {
        let moved = self.track.moved_to(next);
        self.track = match self.to_adopt {
            ADOPTED => Track {
                position: next,
                ..Track::default()
            },
            2 => Track {
                acceleration: Way::ZERO,
                ..moved
            },
            _ => moved,
        };
        self.to_adopt = self.to_adopt.saturating_sub(1);
        self.hole = 0;
    }
}

/// Parts of a deviation that are velocity and acceleration, after a hole of so many cycles.
fn shares(hole: u8, deviation: Way) -> [Way; 2] {
    let [velocity, acceleration]: [i64; 2] = match hole {
        0 => return [deviation; 2],
        // 2 / (m + 1) and 2 / (m (m + 1)) with m = hole + 1, times 2¹⁶.
        1 => [43_691, 21_845],
        2 => [32_768, 10_923],
        3 => [26_214, 6_554],
        4 => [21_845, 4_369],
        // A longer hole tells little: half of what five cycles would.
        _ => [10_923, 2_185],
    };
    // 32 bits times 17 bits cannot wrap in 64; the share is below one, so it fits back.
    [velocity, acceleration].map(|share| {
        let bits = i64::from(deviation.to_bits())
            .wrapping_mul(share)
            .wrapping_shr(16);
        Way::from_bits(i32::try_from(bits).unwrap_or(0))
    })
}
