//! The reference stage: from setpoints as they come, or do not, to what the law follows.
//!
//! ```text
//! setpoint k+1 ─▶ ingest ─▶ interpolation ─▶ triangle ─▶ follow within limits ─▶ x, v, a of k
//!                (believed?)  (every n cycles)  (coarse)    ramp to standstill ─┘
//! ```
//!
//! **Timing.** Feedback k is sampled at SYNC k; torque k acts from SYNC k + 1 to k + 2; setpoint
//! k + 1 is known when torque k is computed. So there are three times in one [`Reference`]:
//! - position x(k) and velocity x(k) − x(k−1) are in time with the encoders and their difference:
//!   they make the errors;
//! - the next velocity x(k+1) − x(k) tells a reversal one cycle ahead;
//! - the acceleration is that of the middle of the torque's cycle, k + 1.5. The newest one that is
//!   known is the second difference centred on k, so `a = a(k) + 1.5 (a(k) − a(k−1))`. A change
//!   above `step` is a step and no jerk: then it stays a(k), and until the next setpoint has
//!   confirmed it a(k−1).
//!
//! **Fine setpoints pass** bit for bit and without delay. What is lost is carried on with the
//! acceleration (a jerk of 50 m/s³ makes that wrong by 50 nm a cycle); what lies off the path is
//! decided one cycle later, before it is due (`ingest`).
//!
//! **Limits.** Whatever comes in, the commanded track keeps velocity, acceleration and position
//! limits (`follow`). Where two of them conflict, acceleration holds: after a velocity or position
//! limit was lowered in motion the overrun is at most v² / 2 a, and `overrun` says so.
//!
//! **Ramps** start from the commanded position, velocity and acceleration (`ramp`).
//!
//! ```
//! use controller::reference::{Mode, Ramp, ReferenceConfig, ReferenceInput, ReferenceState};
//! use controller::units::{Position, Velocity};
//! use fixed::types::I20F12;
//!
//! // 0.5 m/s, 5 m/s² and ±1 m at 1 kHz, in 10 nm per cycle and per cycle².
//! let per_cycle = |counts: i32| Velocity(I20F12::from_num(counts));
//! let ramp = Ramp { deceleration: per_cycle(500), jerk: per_cycle(100) };
//! let config = ReferenceConfig {
//!     velocity_limit: per_cycle(50_000),
//!     acceleration_limit: per_cycle(500),
//!     step: per_cycle(50),
//!     position_min: Position::from_counts(-100_000_000),
//!     position_max: Position::from_counts(100_000_000),
//!     quick_stop: ramp,
//!     slow_down: ramp,
//!     filter_log2: 0,
//!     setpoint_cycles: 1,
//!     middle: ReferenceConfig::NOWHERE,
//! };
//! // 100 counts per cycle; the setpoint of cycle 8 is lost.
//! let mut stage = ReferenceState::at(Position::from_counts(0), per_cycle(100));
//! for cycle in 0..12 {
//!     let preview = (cycle + 1 != 8).then(|| Position::from_counts(100 * (cycle + 1)));
//!     let input = ReferenceInput { present: None, preview, mode: Mode::Follow };
//!     let reference = stage.step(&config, &input);
//!     assert_eq!(reference.position, Position::from_counts(100 * cycle));
//!     assert_eq!(reference.bridged, cycle + 1 == 8);
//! }
//! ```

mod follow;
mod ingest;
mod interpolate;
mod ramp;
mod track;
mod triangle;

use fixed::types::I56F8;

use crate::units::{Acceleration, Position, Velocity};
use follow::{LONGEST_COUNTS, Limits, Target, follow};
use ingest::{Bounds, Ingest, Revision, Taken};
use interpolate::{Interpolation, MOST_CYCLES};
use track::{
    Track, Way, acceleration_of, exact_way, on_the_axis, velocity_of, way, way_of, within,
};
use triangle::Triangle;

/// A ramp to standstill.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Ramp {
    /// Change of velocity per cycle; at most the acceleration limit.
    pub deceleration: Velocity,
    /// Change of the deceleration per cycle; zero: no limit.
    pub jerk: Velocity,
}

/// Limits of the axis, and how setpoints come.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ReferenceConfig {
    /// Velocity limit of the axis.
    pub velocity_limit: Velocity,
    /// Change of velocity per cycle that the axis can do.
    pub acceleration_limit: Velocity,
    /// Change of acceleration within one cycle above which it is a step and no jerk.
    pub step: Velocity,
    /// Lower end of the travel.
    pub position_min: Position,
    /// Upper end of the travel.
    pub position_max: Position,
    /// Ramp of a quick stop and of faults.
    pub quick_stop: Ramp,
    /// Ramp of disable, shutdown and halt.
    pub slow_down: Ramp,
    /// 0: setpoints are fine; n: two moving averages of 2ⁿ cycles, delay 2ⁿ − 1 cycles; at most 4.
    pub filter_log2: u8,
    /// Setpoints come every 1 to 20 cycles.
    pub setpoint_cycles: u8,
    /// Where an axis within its velocity limit stops before it comes to an end of the travel
    /// ([`Self::middle_of`]): there a cycle does not look. [`Self::NOWHERE`] is right of any axis.
    pub middle: [Position; 2],
}

impl ReferenceConfig {
    /// No position lies between these.
    pub const NOWHERE: [Position; 2] = [Position(I56F8::MAX), Position(I56F8::MIN)];

    /// The travel without the way at both ends that a braking from the velocity limit takes, in
    /// whole counts of 10 nm: at least `v² / 2 a`, with v a bit above the limit. Nowhere where
    /// that is beyond 10 m: no look goes farther.
    #[must_use]
    pub fn middle_of([min, max]: [Position; 2], braking_counts: i32) -> [Position; 2] {
        if braking_counts >= LONGEST_COUNTS {
            return Self::NOWHERE;
        }
        let way = I56F8::from(braking_counts.saturating_add(ROUNDING_COUNTS));
        [
            Position(min.0.saturating_add(way)),
            Position(max.0.saturating_sub(way)),
        ]
    }
}

/// What is left is rounded down to whole counts, and a braking way to nearest.
const ROUNDING_COUNTS: i32 = 2;

/// What the commanded track does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Mode {
    /// It follows the setpoints.
    #[default]
    Follow,
    /// It comes to rest on the quick-stop ramp.
    QuickStop,
    /// It comes to rest on the slow-down ramp.
    SlowDown,
}

/// What comes in, once per cycle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ReferenceInput {
    /// Setpoint of this cycle, where it came late.
    pub present: Option<Position>,
    /// Setpoint of the next cycle.
    pub preview: Option<Position>,
    /// What the commanded track does.
    pub mode: Mode,
}

/// What the law follows in cycle k.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[expect(
    clippy::struct_excessive_bools,
    reason = "what is true of one cycle, each apart"
)]
pub struct Reference {
    /// Of cycle k, in time with its feedback.
    pub position: Position,
    /// x(k) − x(k−1), in time with the difference of the encoders.
    pub velocity: Velocity,
    /// x(k+1) − x(k), commanded. Where x(k+1) is only extrapolated it does not turn round: zero
    /// instead.
    pub next_velocity: Velocity,
    /// Of the middle of the cycle in which the torque acts.
    pub acceleration: Acceleration,
    /// Change of acceleration per cycle that went into it.
    pub jerk: Acceleration,
    /// Nothing moves, in this cycle and in the next.
    pub standing: bool,
    /// Limits keep the commanded track off the setpoint, or it is still on its way back.
    pub limited: bool,
    /// A velocity or position limit is passed, because acceleration does not let it be kept.
    pub overrun: bool,
    /// A setpoint was refused.
    pub refused: bool,
    /// The next cycle goes without a setpoint.
    pub bridged: bool,
}

/// Memory of the stage.
#[derive(Clone, Copy, Debug)]
pub struct ReferenceState {
    ingest: Ingest,
    interpolation: Interpolation,
    triangle: Triangle,
    /// Cycles from setpoint to setpoint that the track counts with.
    cycles: u8,
    /// Cycles since the last one.
    phase: u8,
    /// The setpoint as filter and interpolation leave it.
    smooth: I56F8,
    commanded: Track,
    caught_up: bool,
    /// Velocity before the setpoints that are missing or in doubt at present.
    before_extrapolation: Option<Way>,
}

impl Default for ReferenceState {
    fn default() -> Self {
        Self::at(Position::default(), Velocity::ZERO)
    }
}

impl ReferenceState {
    /// The commanded track begins here; setpoints are judged after the first three.
    #[must_use]
    pub fn at(position: Position, velocity: Velocity) -> Self {
        let position = on_the_axis(position);
        let track = Track {
            position,
            velocity: way_of(velocity),
            acceleration: Way::ZERO,
        };
        Self {
            ingest: Ingest::at(track),
            interpolation: Interpolation::at_rest(position),
            triangle: Triangle::default(),
            cycles: 1,
            phase: 1,
            smooth: position,
            commanded: track,
            caught_up: false,
            before_extrapolation: None,
        }
    }

    /// Position of the commanded track in the coming cycle.
    #[must_use]
    pub const fn position(&self) -> Position {
        Position(self.commanded.position)
    }

    /// Velocity of the commanded track up to the coming cycle.
    #[must_use]
    pub fn velocity(&self) -> Velocity {
        velocity_of(self.commanded.velocity)
    }

    /// Setpoints refused in a row.
    #[must_use]
    pub const fn refusals(&self) -> u16 {
        self.ingest.refusals()
    }

    /// Whether a preview is due in the coming cycle.
    #[must_use]
    pub fn expects_setpoint(&self, config: &ReferenceConfig) -> bool {
        self.phase >= self.cycles || cycles_of(config) != self.cycles
    }

    /// One cycle.
    pub fn step(&mut self, config: &ReferenceConfig, input: &ReferenceInput) -> Reference {
        self.passed(config, input)
            .unwrap_or_else(|| self.planned(config, input))
    }

    /// The plain case: a fine setpoint that continues the path within the limits.
    fn passed(&mut self, config: &ReferenceConfig, input: &ReferenceInput) -> Option<Reference> {
        let preview = input.preview?;
        if !(is_plain(config) && self.caught_up && input.mode == Mode::Follow) {
            return None;
        }
        // Where the commanded track passes setpoints, it stands on the believed one.
        let velocity = exact_way(self.commanded.position, preview.0)?;
        let target = self
            .ingest
            .continued(way_of(config.step), preview.0, velocity)?;
        let next = self.commanded.moved_there(preview.0, velocity);
        if !limits_of(config).allow(&next) {
            return None;
        }
        let acceleration = self.ingest.track.acceleration;
        self.ingest.track = target;
        let now = core::mem::replace(&mut self.commanded, next);
        Some(referenced(
            &now,
            &next,
            target.acceleration,
            target.acceleration.saturating_sub(acceleration),
        ))
    }

    /// Every other case; apart, so that the plain one keeps its registers (60 instructions on a
    /// Cortex-M4).
    #[inline(never)]
    fn planned(&mut self, config: &ReferenceConfig, input: &ReferenceInput) -> Reference {
        let limits = limits_of(config);
        let (target, taken) = self.plan(config, input);
        if let (true, Some(revised)) = (self.caught_up && is_plain(config), taken.revised) {
            self.correct_commanded(&limits, revised.track);
        }
        let now = self.commanded;
        let next = self.advance(config, &limits, input.mode, target);
        self.commanded = next;
        let [acceleration, jerk] = self.acceleration_and_jerk(config, &now, &next, &taken);
        let mut reference = referenced(&now, &next, acceleration, jerk);
        let confirmed = self.confirmed_velocity(taken.extrapolated, now.velocity);
        if is_plain(config) && taken.extrapolated && turns_round(confirmed, next.velocity) {
            reference.next_velocity = Velocity::ZERO;
        }
        reference.limited = !self.caught_up && input.mode == Mode::Follow;
        reference.overrun = limits.is_overrun(&next);
        reference.refused = taken.refused;
        reference.bridged = taken.bridged;
        reference
    }

    /// The last velocity that setpoints confirmed.
    fn confirmed_velocity(&mut self, is_extrapolated: bool, now: Way) -> Way {
        let confirmed = self.before_extrapolation.unwrap_or(now);
        self.before_extrapolation = is_extrapolated.then_some(confirmed);
        confirmed
    }

    /// The commanded track one cycle on.
    fn advance(
        &mut self,
        config: &ReferenceConfig,
        limits: &Limits,
        mode: Mode,
        target: Target,
    ) -> Track {
        let ramp = match mode {
            Mode::Follow => {
                let (next, caught_up) = follow(limits, self.commanded, target, self.caught_up);
                self.caught_up = caught_up;
                return next;
            }
            Mode::QuickStop => config.quick_stop,
            Mode::SlowDown => config.slow_down,
        };
        self.caught_up = false;
        let deceleration = way_of(ramp.deceleration).min(limits.acceleration);
        let velocity = ramp::next_velocity(
            self.commanded,
            deceleration,
            way_of(ramp.jerk),
            limits.velocity,
        );
        limits.nearest(self.commanded, velocity)
    }

    /// The setpoint of this cycle was believed only now: the commanded track takes the last step
    /// again. Its position is not out yet.
    fn correct_commanded(&mut self, limits: &Limits, revised: Track) {
        let target = Target {
            position: revised.position,
            velocity: revised.velocity,
        };
        (self.commanded, self.caught_up) = follow(limits, self.commanded.before(), target, true);
    }

    /// The setpoint of the next cycle, as it is or interpolated and filtered.
    fn plan(&mut self, config: &ReferenceConfig, input: &ReferenceInput) -> (Target, Taken) {
        self.restart_where_setpoints_come_otherwise(cycles_of(config));
        let taken = self.take(config, input);
        let track = self.ingest.track;
        if is_plain(config) {
            self.smooth = track.position;
            return (
                Target {
                    position: track.position,
                    velocity: track.velocity,
                },
                taken,
            );
        }
        let position = if self.cycles > 1 {
            self.interpolation.position(self.phase, self.cycles)
        } else {
            track.position
        };
        let position = if config.filter_log2 > 0 {
            self.triangle.step(config.filter_log2, position)
        } else {
            position
        };
        let velocity = way(self.smooth, position);
        self.smooth = position;
        (Target { position, velocity }, taken)
    }

    /// The track counts velocity from setpoint to setpoint: another rate begins with another track.
    fn restart_where_setpoints_come_otherwise(&mut self, cycles: u8) {
        if cycles != self.cycles {
            self.cycles = cycles;
            self.phase = cycles;
            self.ingest = Ingest::at(Track {
                velocity: Way::ZERO,
                acceleration: Way::ZERO,
                ..self.ingest.track
            });
            self.interpolation = Interpolation::at_rest(self.ingest.track.position);
        }
    }

    /// What the setpoints of this cycle do to the track, the interpolation and the filter.
    fn take(&mut self, config: &ReferenceConfig, input: &ReferenceInput) -> Taken {
        let bounds = bounds_of(config);
        let late = input
            .present
            .and_then(|present| self.ingest.late(bounds, on_the_axis(present)));
        let mut taken = Taken::default();
        if self.is_setpoint_due(input.preview) {
            taken = self.ingest.take(
                bounds,
                input.mode == Mode::Follow,
                input.preview.map(on_the_axis),
            );
            self.phase = 0;
        }
        taken.revised = taken.revised.or(late);
        self.hand_on(taken.revised);
        self.phase = self.phase.saturating_add(1);
        taken
    }

    /// Before the first setpoint nobody knows when they come.
    fn is_setpoint_due(&self, preview: Option<Position>) -> bool {
        let before_the_first = self.cycles > 1 && self.ingest.is_waiting() && preview.is_none();
        self.phase >= self.cycles && !before_the_first
    }

    /// The newest setpoint to the interpolation; what the one before was off to whoever has it.
    fn hand_on(&mut self, revised: Option<Revision>) {
        let by = revised.map_or(0, |revision| i64::from(revision.by.to_bits()));
        if self.cycles == 1 {
            return self.triangle.correct(by);
        }
        self.interpolation.correct(by);
        if self.phase == 0 {
            self.interpolation.push(self.ingest.track.position);
        }
    }

    /// Of the believed track where setpoints pass, else of the commanded one. Filtered positions
    /// are as late as the filter anyway, and their jerk is mostly rounding.
    fn acceleration_and_jerk(
        &self,
        config: &ReferenceConfig,
        now: &Track,
        next: &Track,
        taken: &Taken,
    ) -> [Way; 2] {
        let (acceleration, jerk, is_known) = if is_plain(config) && self.caught_up {
            (
                self.ingest.track.acceleration,
                taken.jerk,
                !taken.extrapolated,
            )
        } else {
            let jerk = next.acceleration.saturating_sub(now.acceleration);
            (next.acceleration, jerk, config.filter_log2 == 0)
        };
        let is_jerk = is_known && within(jerk, way_of(config.step));
        [acceleration, if is_jerk { jerk } else { Way::ZERO }]
    }
}

/// Fine setpoints in every cycle: they pass as they are.
fn is_plain(config: &ReferenceConfig) -> bool {
    config.filter_log2 == 0 && config.setpoint_cycles <= 1
}

fn cycles_of(config: &ReferenceConfig) -> u8 {
    config.setpoint_cycles.clamp(1, MOST_CYCLES)
}

fn limits_of(config: &ReferenceConfig) -> Limits {
    Limits {
        velocity: way_of(config.velocity_limit),
        acceleration: way_of(config.acceleration_limit),
        position_min: config.position_min.0,
        position_max: config.position_max.0,
        middle: config.middle.map(|position| position.0),
    }
}

/// What is a jump, and what is impossible, from setpoint to setpoint: both grow with the square of
/// their distance.
///
/// With the filter on, setpoints may be rounded to whole µm: that makes a second difference wrong
/// by (1 + 2 + 1) / 2 = 2 µm, its change by (1 + 3 + 3 + 1) / 2 = 4 µm. The acceleration may pass
/// its limit by a sixteenth, and by rounding to 39 pm: what the limits then cut is no reason to
/// disbelieve a setpoint.
fn bounds_of(config: &ReferenceConfig) -> Bounds {
    let cycles = i32::from(cycles_of(config));
    let square = cycles.saturating_mul(cycles);
    let quantum = if config.filter_log2 > 0 {
        MICROMETRE
    } else {
        Way::DELTA
    };
    let limit = way_of(config.acceleration_limit);
    let tolerance = Way::from_bits(limit.to_bits().wrapping_shr(4))
        .saturating_add(quantum.saturating_mul_int(2));
    Bounds {
        step: way_of(config.step)
            .saturating_mul_int(square)
            .saturating_add(quantum.saturating_mul_int(4)),
        acceleration: limit
            .saturating_mul_int(square)
            .saturating_add(tolerance.saturating_mul_int(square)),
    }
}

/// In 10 nm.
const MICROMETRE: Way = Way::from_bits(100 << 8);

fn turns_round(now: Way, next: Way) -> bool {
    next > Way::ZERO && now <= Way::ZERO || next < Way::ZERO && now >= Way::ZERO
}

/// Position and velocities of a cycle. The acceleration is brought from the cycle to the middle of
/// the one in which the torque acts, one and a half later.
#[expect(
    clippy::inline_always,
    reason = "a call passes 32 bytes through memory twice: 50 instructions of the plain case"
)]
#[inline(always)]
fn referenced(now: &Track, next: &Track, acceleration: Way, jerk: Way) -> Reference {
    let half = Way::from_bits(jerk.to_bits().wrapping_shr(1));
    Reference {
        position: Position(now.position),
        velocity: velocity_of(now.velocity),
        next_velocity: velocity_of(next.velocity),
        acceleration: acceleration_of(acceleration.saturating_add(jerk).saturating_add(half)),
        jerk: acceleration_of(jerk),
        standing: now.velocity == Way::ZERO && next.velocity == Way::ZERO,
        limited: false,
        overrun: false,
        refused: false,
        bridged: false,
    }
}
