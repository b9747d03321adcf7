//! Setpoints: paths made of legs, and efforts for axes without a loop.
//!
//! A leg goes from one place to another and stands at both ends. Its shape is a trapezoid of
//! velocity, the polynomial of least jerk (Flash and Hogan, J. Neuroscience 5, 1985), half a turn
//! of a circle, whole cycles of a sine, a cycloid, a way with a sine on top, the polynomial of
//! least snap, a packet of waves, soft ramps of velocity, or two waves at once.

mod habits;
mod swells;
mod trades;

use std::f64::consts::{PI, TAU};

use crate::draw::Draw;
use crate::motion::habits::{least_snap, packet};
use crate::motion::swells::{Waves, doublet};
use crate::motion::trades::{cycloid, schroeder};

/// What is wanted at a time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Setpoint {
    /// Position.
    pub position: f64,
    /// Velocity.
    pub velocity: f64,
    /// Acceleration.
    pub acceleration: f64,
}

/// Shape of a leg.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Shape {
    Rest,
    /// Time of acceleration, s.
    Trapezoid(f64),
    LeastJerk,
    HalfCircle,
    /// Amplitude and whole cycles.
    Sine(f64, f64),
    Cycloid,
    /// Amplitude and whole cycles of the sine on top of least jerk.
    Weave(f64, f64),
    LeastSnap,
    /// Amplitude and whole cycles.
    Packet(f64, f64),
    /// Time of a ramp, s.
    SoftRamps(f64),
    TwoWaves(Waves),
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Leg {
    start_s: f64,
    duration_s: f64,
    from: f64,
    to: f64,
    shape: Shape,
}

/// Speed and acceleration that a leg may have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pace {
    /// Largest velocity.
    pub velocity: f64,
    /// Largest acceleration.
    pub acceleration: f64,
}

impl Pace {
    /// So many times as fast, with the same acceleration.
    #[must_use]
    pub fn times(self, factor: f64) -> Self {
        Self {
            velocity: self.velocity * factor,
            ..self
        }
    }
}

/// A path: legs one after the other.
#[derive(Clone, Debug, PartialEq)]
pub struct Path {
    legs: Vec<Leg>,
    start: f64,
}

impl Path {
    /// Stands at a place.
    #[must_use]
    pub fn from(start: f64) -> Self {
        Self {
            legs: Vec::new(),
            start,
        }
    }

    /// When it ends, s.
    #[must_use]
    pub fn end_s(&self) -> f64 {
        self.legs
            .last()
            .map_or(0.0, |leg| leg.start_s + leg.duration_s)
    }

    /// Where it ends.
    #[must_use]
    pub fn end(&self) -> f64 {
        self.legs.last().map_or(self.start, |leg| leg.to)
    }

    fn leg(mut self, to: f64, duration_s: f64, shape: Shape) -> Self {
        if duration_s > 0.0 {
            let (start_s, from) = (self.end_s(), self.end());
            self.legs.push(Leg {
                start_s,
                duration_s,
                from,
                to,
                shape,
            });
        }
        self
    }

    /// Stands for a time, s.
    #[must_use]
    pub fn rest(self, duration_s: f64) -> Self {
        let here = self.end();
        self.leg(here, duration_s, Shape::Rest)
    }

    /// By a trapezoid of velocity; a triangle where the way is short.
    #[must_use]
    pub fn trapezoid(self, to: f64, pace: Pace) -> Self {
        let way = (to - self.end()).abs();
        let ramp_s = (pace.velocity / pace.acceleration).min((way / pace.acceleration).sqrt());
        let peak = ramp_s * pace.acceleration;
        let duration_s = if way > 0.0 { ramp_s + way / peak } else { 0.0 };
        self.leg(to, duration_s, Shape::Trapezoid(ramp_s))
    }

    /// With least jerk: peak velocity 15/8 way/time, peak acceleration 10/√3 way/time².
    #[must_use]
    pub fn least_jerk(self, to: f64, pace: Pace) -> Self {
        let way = (to - self.end()).abs();
        let by_velocity = 1.875 * way / pace.velocity;
        let by_acceleration = (10.0 / 3.0_f64.sqrt() * way / pace.acceleration).sqrt();
        self.leg(to, by_velocity.max(by_acceleration), Shape::LeastJerk)
    }

    /// As an axis moves on half a turn of a circle: ½(1 − cos); the pace is that of the feed.
    #[must_use]
    pub fn half_circle(self, to: f64, pace: Pace) -> Self {
        let radius = 0.5 * (to - self.end()).abs();
        let by_acceleration = PI * (radius / pace.acceleration).sqrt();
        let duration_s = (PI * radius / pace.velocity).max(by_acceleration);
        self.leg(to, duration_s, Shape::HalfCircle)
    }

    /// Whole cycles of amplitude·(1 − cos).
    #[must_use]
    pub fn sine(self, amplitude: f64, frequency_hz: f64, cycles: u32) -> Self {
        let here = self.end();
        let cycles = f64::from(cycles);
        self.leg(here, cycles / frequency_hz, Shape::Sine(amplitude, cycles))
    }

    /// What is wanted at a time; before the start and after the end it stands.
    #[must_use]
    pub fn at(&self, time_s: f64) -> Setpoint {
        let next = self.legs.partition_point(|leg| leg.start_s <= time_s);
        let Some(leg) = next.checked_sub(1).map(|index| self.legs[index]) else {
            return standing(self.start);
        };
        let into_s = time_s - leg.start_s;
        if into_s >= leg.duration_s {
            standing(leg.to)
        } else {
            leg.at(into_s)
        }
    }
}

fn standing(position: f64) -> Setpoint {
    Setpoint {
        position,
        ..Setpoint::default()
    }
}

impl Leg {
    fn at(&self, t: f64) -> Setpoint {
        let (way, duration) = (self.to - self.from, self.duration_s);
        let share = |s: [f64; 3]| Setpoint {
            position: self.from + way * s[0],
            velocity: way * s[1] / duration,
            acceleration: way * s[2] / (duration * duration),
        };
        match self.shape {
            Shape::Rest => standing(self.from),
            Shape::Trapezoid(ramp_s) => self.trapezoid(t, ramp_s),
            Shape::LeastJerk => share(least_jerk(t / duration)),
            Shape::HalfCircle => {
                let angle = PI * t / duration;
                let (sin, cos) = (libm::sin(angle), libm::cos(angle));
                share([0.5 * (1.0 - cos), 0.5 * PI * sin, 0.5 * PI * PI * cos])
            }
            Shape::Sine(amplitude, cycles) => {
                let wave = swung(amplitude, TAU * cycles / duration, t);
                Setpoint {
                    position: self.from + wave.position,
                    ..wave
                }
            }
            Shape::Cycloid => share(cycloid(t / duration)),
            Shape::LeastSnap => share(least_snap(t / duration)),
            Shape::SoftRamps(ramp_s) => self.soft_ramps(t, ramp_s),
            Shape::TwoWaves(waves) => {
                let wave = waves.at(t, duration);
                Setpoint {
                    position: self.from + wave.position,
                    ..wave
                }
            }
            Shape::Packet(amplitude, cycles) => {
                let wave = packet(amplitude, cycles, t, duration);
                Setpoint {
                    position: self.from + wave.position,
                    ..wave
                }
            }
            Shape::Weave(amplitude, cycles) => {
                let way = share(least_jerk(t / duration));
                let wave = swung(amplitude, TAU * cycles / duration, t);
                Setpoint {
                    position: way.position + wave.position,
                    velocity: way.velocity + wave.velocity,
                    acceleration: way.acceleration + wave.acceleration,
                }
            }
        }
    }

    fn trapezoid(&self, t: f64, ramp_s: f64) -> Setpoint {
        let way = self.to - self.from;
        let peak = way / (self.duration_s - ramp_s);
        let bend = peak / ramp_s;
        let left = self.duration_s - t;
        let (position, velocity, acceleration) = if t < ramp_s {
            (self.from + 0.5 * bend * t * t, bend * t, bend)
        } else if left < ramp_s {
            (self.to - 0.5 * bend * left * left, bend * left, -bend)
        } else {
            (self.from + peak * (t - 0.5 * ramp_s), peak, 0.0)
        };
        Setpoint {
            position,
            velocity,
            acceleration,
        }
    }
}

/// amplitude·(1 − cos w t).
fn swung(amplitude: f64, w: f64, t: f64) -> Setpoint {
    Setpoint {
        position: amplitude * (1.0 - libm::cos(w * t)),
        velocity: amplitude * w * libm::sin(w * t),
        acceleration: amplitude * w * w * libm::cos(w * t),
    }
}

/// 10 s³ − 15 s⁴ + 6 s⁵ and its derivatives.
fn least_jerk(s: f64) -> [f64; 3] {
    let position = s * s * s * (10.0 + s * (6.0 * s - 15.0));
    let velocity = 30.0 * s * s * (1.0 - s) * (1.0 - s);
    let acceleration = 60.0 * s * (1.0 - s) * (1.0 - 2.0 * s);
    [position, velocity, acceleration]
}

/// Where a programme moves, and how.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Room {
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
    /// Fastest.
    pub pace: Pace,
    /// How long, s.
    pub duration_s: f64,
}

impl Room {
    /// About the middle, with the pace (velocity, acceleration).
    #[must_use]
    pub const fn about(half: f64, (velocity, acceleration): (f64, f64), duration_s: f64) -> Self {
        Self {
            low: -half,
            high: half,
            pace: Pace {
                velocity,
                acceleration,
            },
            duration_s,
        }
    }

    fn place(&self, draw: &mut Draw) -> f64 {
        draw.between(self.low, self.high)
    }

    fn start(&self) -> Path {
        Path::from(0.5 * (self.low + self.high)).rest(0.4)
    }

    /// The same for another time.
    #[must_use]
    pub fn lasting(self, duration_s: f64) -> Self {
        Self { duration_s, ..self }
    }

    /// Legs until the time is over.
    fn filled(&self, mut add: impl FnMut(Path, usize) -> Path) -> Path {
        let mut path = self.start();
        for turn in 0.. {
            if path.end_s() >= self.duration_s {
                break;
            }
            path = add(path, turn);
        }
        path
    }

    /// As in a workshop: rapids, feeds, creeping, rests, by turns and to drawn places.
    #[must_use]
    pub fn workshop(&self, draw: &mut Draw) -> Path {
        self.filled(|path, turn| {
            let to = self.place(draw);
            match turn % 5 {
                0 => path.trapezoid(to, self.pace),
                1 => path.least_jerk(to, self.pace.times(0.5)),
                2 => path.trapezoid(to, self.pace.times(0.15)).rest(0.3),
                3 => self.creep(path, draw),
                _ => path.least_jerk(to, self.pace),
            }
        })
    }

    /// A hundredth to a thirtieth of the pace, for a second or so.
    fn creep(&self, path: Path, draw: &mut Draw) -> Path {
        let velocity = self.pace.velocity * draw.between(0.01, 0.03);
        let inward = (0.5 * (self.low + self.high) - path.end()).signum();
        let to = path.end() + inward * velocity * draw.between(0.6, 1.4);
        let slow = Pace {
            velocity,
            ..self.pace
        };
        path.trapezoid(to, slow)
    }

    /// From point to point, with short rests.
    #[must_use]
    pub fn points(&self, draw: &mut Draw) -> Path {
        self.filled(|path, _| {
            let to = self.place(draw);
            let pace = self.pace.times(draw.between(0.1, 1.0));
            path.least_jerk(to, pace).rest(draw.between(0.05, 0.25))
        })
    }

    /// Sines of drawn amplitude and frequency between moves to drawn places.
    #[must_use]
    pub fn waves(&self, draw: &mut Draw) -> Path {
        let reach = 0.2 * (self.high - self.low);
        self.filled(|path, _| {
            let amplitude = reach * draw.between(0.2, 1.0);
            let by_velocity = self.pace.velocity / (TAU * amplitude);
            let by_acceleration = (self.pace.acceleration / amplitude).sqrt() / TAU;
            let frequency_hz = by_velocity.min(by_acceleration) * draw.between(0.2, 1.0);
            let to = self.low + draw.between(0.1, 0.5) * (self.high - self.low);
            path.trapezoid(to, self.pace)
                .sine(amplitude, frequency_hz, 2)
        })
    }

    /// Halves of circles, there and back, at drawn feeds.
    #[must_use]
    pub fn circles(&self, draw: &mut Draw) -> Path {
        self.filled(|path, turn| {
            let side = if turn % 2 == 0 { self.high } else { self.low };
            let middle = 0.5 * (self.low + self.high);
            let to = middle + (side - middle) * draw.between(0.3, 1.0);
            let path = path.half_circle(to, self.pace.times(draw.between(0.05, 1.0)));
            if turn % 4 == 3 { path.rest(0.3) } else { path }
        })
    }

    /// Short steps up and down, as from a jog key, with now and then a long way.
    #[must_use]
    pub fn jogs(&self, draw: &mut Draw) -> Path {
        let reach = 0.15 * (self.high - self.low);
        self.filled(|path, turn| {
            let far = turn % 6 == 5;
            let wish = path.end() + reach * draw.between(-1.0, 1.0);
            let to = if far {
                self.place(draw)
            } else {
                wish.clamp(self.low, self.high)
            };
            path.trapezoid(to, self.pace.times(draw.between(0.05, 1.0)))
                .rest(if turn % 3 == 0 { 0.2 } else { 0.0 })
        })
    }
}

/// Effort over time for an axis without a loop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Programme {
    /// Frequency rises evenly from one to the other: amplitude, Hz, Hz, period of the sweep, s.
    Chirp(f64, f64, f64, f64),
    /// A plateau of drawn size, one after the other: amplitude and time of each, s.
    Steps(f64, f64, u64),
    /// Sines side by side of one amplitude and of frequencies f, 2f, … nf: deviation of the whole,
    /// f in Hz, n.
    Multisine(f64, f64, u32),
    /// A push one way, two the other and one back, of drawn size: amplitude, time of each, s, and
    /// the seed of the sizes.
    Doublets(f64, f64, u64),
}

impl Programme {
    /// Effort at a time, s.
    #[must_use]
    pub fn at(&self, time_s: f64) -> f64 {
        if time_s < 0.0 {
            return 0.0;
        }
        match *self {
            Self::Chirp(amplitude, from_hz, to_hz, sweep_s) => {
                let t = time_s % sweep_s;
                let turns = from_hz * t + 0.5 * (to_hz - from_hz) * t * t / sweep_s;
                amplitude * libm::sin(TAU * turns)
            }
            Self::Multisine(deviation, lowest_hz, lines) => {
                deviation * schroeder(TAU * lowest_hz * time_s, lines)
            }
            Self::Doublets(amplitude, each_s, seed) => {
                let (turn, sign) = doublet(time_s, each_s);
                amplitude * sign * Draw::of("doublets", seed ^ turn).between(0.25, 1.0)
            }
            Self::Steps(amplitude, each_s, seed) => {
                let step = (time_s / each_s).floor() as u64;
                let size = Draw::of("steps", seed ^ (step / 2)).between(0.35, 1.0);
                // Each size in both directions, so that the axis does not run away.
                if step.is_multiple_of(2) {
                    amplitude * size
                } else {
                    -amplitude * size
                }
            }
        }
    }
}

/// What an axis is asked to do.
#[derive(Clone, Debug, PartialEq)]
pub enum Motion {
    /// To follow a path.
    Path(Path),
    /// To apply an effort.
    Effort(Programme),
}

#[cfg(test)]
mod tests {
    use super::*;

    const PACE: Pace = Pace {
        velocity: 0.3,
        acceleration: 2.0,
    };
    pub(super) const ROOM: Room = Room {
        low: -0.2,
        high: 0.3,
        pace: PACE,
        duration_s: 20.0,
    };

    /// Largest differences of velocity and acceleration from their difference quotients, and the
    /// share of times at which the latter is a kink.
    pub(super) fn worst(path: &Path) -> (f64, f64, f64) {
        let step = 1.0e-5;
        let off = |k: usize| {
            let t = k as f64 * 1.0e-3;
            let (a, b, c) = (path.at(t - step), path.at(t), path.at(t + step));
            let velocity = (c.position - a.position) / (2.0 * step) - b.velocity;
            let acceleration = (c.velocity - a.velocity) / (2.0 * step) - b.acceleration;
            (velocity.abs(), acceleration.abs())
        };
        let count = (path.end_s() / 1.0e-3) as usize;
        let off: Vec<(f64, f64)> = (0..count).map(off).collect();
        let kinks = off.iter().filter(|o| o.1 > 1.0e-3).count();
        let (velocity, acceleration) = off
            .iter()
            .fold((0.0_f64, 0.0_f64), |m, o| (o.0.max(m.0), o.1.max(m.1)));
        (velocity, acceleration, kinks as f64 / count as f64)
    }

    /// How often a motion of 20 s turns round, and the share of it in which it moves.
    pub(super) fn turns(path: &Path) -> (usize, f64) {
        let at = |k: i32| path.at(f64::from(k) * 1.0e-3).velocity;
        let moving: Vec<f64> = (0..20_000).map(at).filter(|v| v.abs() > 1.0e-6).collect();
        let turns = moving.windows(2).filter(|v| v[0] * v[1] < 0.0).count();
        (turns, moving.len() as f64 / 20_000.0)
    }

    fn programmes() -> Vec<Path> {
        let mut draw = Draw::of("motion", 1);
        vec![
            ROOM.workshop(&mut draw),
            ROOM.points(&mut draw),
            ROOM.waves(&mut draw),
            ROOM.circles(&mut draw),
            ROOM.jogs(&mut draw),
        ]
    }

    #[test]
    fn velocity_is_the_derivative_of_position_and_acceleration_that_of_velocity() {
        for path in programmes() {
            let (velocity, _, kinks) = worst(&path);
            // A kink of 2 m/s² within 10 µs on either side.
            assert!(velocity < 3.0e-5 && kinks < 0.02, "{velocity} {kinks}");
        }
    }

    /// Whatever is made for [`ROOM`] stays within it, within its pace, and lasts.
    pub(super) fn assert_keeps_to_its_room(programmes: &[Path]) {
        for (n, path) in programmes.iter().enumerate() {
            assert!(path.end_s() >= 20.0, "{n}");
            for k in 0..20_000 {
                let at = path.at(f64::from(k) * 1.0e-3);
                assert!((-0.201..=0.301).contains(&at.position), "{n} {at:?}");
                assert!(at.velocity.abs() <= 0.3001, "{n} {at:?}");
                assert!(at.acceleration.abs() <= 2.0001, "{n} {at:?}");
            }
        }
    }

    #[test]
    fn a_programme_keeps_to_its_room_and_its_pace_and_lasts() {
        assert_keeps_to_its_room(&programmes());
    }

    #[test]
    fn a_short_way_is_a_triangle() {
        let path = Path::from(0.0).trapezoid(0.01, PACE);
        let peak = path.at(0.5 * path.end_s());
        assert!((peak.velocity - (2.0 * 0.01_f64).sqrt()).abs() < 1.0e-9);
    }

    #[test]
    fn effort_steps_come_in_pairs_of_both_signs() {
        let steps = Programme::Steps(2.0, 0.5, 7);
        assert_eq!(steps.at(0.2), -steps.at(0.7));
        assert_ne!(steps.at(0.2), steps.at(1.2));
        assert_eq!(steps.at(-1.0), 0.0);
    }

    #[test]
    fn a_chirp_ends_at_its_upper_frequency() {
        let chirp = Programme::Chirp(1.0, 1.0, 5.0, 10.0);
        let crossings = |from: i32| {
            let at = |k: i32| chirp.at(f64::from(k) * 1.0e-3);
            (from..from + 1000)
                .filter(|k| at(*k) * at(k + 1) < 0.0)
                .count()
        };
        assert!((2..=3).contains(&crossings(1)) && (9..=10).contains(&crossings(8998)));
    }
}
