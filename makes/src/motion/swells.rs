//! Motions with soft ramps, swells of two waves, and doublets of effort.
//!
//! A soft ramp changes velocity by ½(1 − cos), as smoothing filters of path controls make it
//! (Biagiotti and Melchiorri, Trajectory Planning for Automatic Machines and Robots, 2008, ch. 3).
//! A sea of two waves is the least that does not repeat itself from crest to crest (Newman, Marine
//! Hydrodynamics, 1977, ch. 6). A doublet pushes one way and as long the other, as pilots do to
//! identify an aircraft (Jategaonkar, Flight Vehicle System Identification, 2006, ch. 2).

use std::f64::consts::{PI, TAU};

use crate::draw::Draw;
use crate::motion::{Leg, Pace, Path, Room, Setpoint, Shape, swung};

/// Two waves of amplitude·(1 − cos), side by side: amplitudes and whole cycles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Waves {
    amplitudes: [f64; 2],
    cycles: [f64; 2],
}

impl Waves {
    /// After a time of so many.
    pub(super) fn at(&self, t: f64, duration_s: f64) -> Setpoint {
        let wave = |n: usize| swung(self.amplitudes[n], TAU * self.cycles[n] / duration_s, t);
        let (slow, fast) = (wave(0), wave(1));
        Setpoint {
            position: slow.position + fast.position,
            velocity: slow.velocity + fast.velocity,
            acceleration: slow.acceleration + fast.acceleration,
        }
    }

    /// Time in which they are no faster than a pace, s.
    fn duration_s(&self, pace: Pace) -> f64 {
        let sum = |power: i32| -> f64 {
            let each = self.amplitudes.iter().zip(self.cycles);
            each.map(|(a, n)| a * (TAU * n).powi(power)).sum()
        };
        (sum(1) / pace.velocity).max((sum(2) / pace.acceleration).sqrt())
    }
}

impl Leg {
    /// Velocity rises by ½(1 − cos) in the time of a ramp, stays, and falls as it rose.
    pub(super) fn soft_ramps(&self, t: f64, ramp_s: f64) -> Setpoint {
        let peak = (self.to - self.from) / (self.duration_s - ramp_s);
        let left = self.duration_s - t;
        let ramp = |t: f64| {
            let angle = PI * t / ramp_s;
            let way = 0.5 * peak * (t - ramp_s / PI * libm::sin(angle));
            let velocity = 0.5 * peak * (1.0 - libm::cos(angle));
            (way, velocity, 0.5 * peak * PI / ramp_s * libm::sin(angle))
        };
        if t < ramp_s {
            let (way, velocity, acceleration) = ramp(t);
            Setpoint {
                position: self.from + way,
                velocity,
                acceleration,
            }
        } else if left < ramp_s {
            let (way, velocity, acceleration) = ramp(left);
            Setpoint {
                position: self.to - way,
                velocity,
                acceleration: -acceleration,
            }
        } else {
            Setpoint {
                position: self.from + peak * (t - 0.5 * ramp_s),
                velocity: peak,
                acceleration: 0.0,
            }
        }
    }
}

impl Path {
    /// With soft ramps of velocity; without a plateau where the way is short.
    #[must_use]
    pub fn soft_ramps(self, to: f64, pace: Pace) -> Self {
        let way = (to - self.end()).abs();
        let shortest = (2.0 * pace.acceleration * way / PI).sqrt();
        let peak = pace.velocity.min(shortest);
        let ramp_s = 0.5 * PI * peak / pace.acceleration;
        let duration_s = if way > 0.0 { ramp_s + way / peak } else { 0.0 };
        self.leg(to, duration_s, Shape::SoftRamps(ramp_s))
    }

    /// Two waves on top of each other, no faster than the pace; upward of where it stands.
    #[must_use]
    pub fn two_waves(self, amplitudes: [f64; 2], cycles: [u32; 2], pace: Pace) -> Self {
        let here = self.end();
        let waves = Waves {
            amplitudes,
            cycles: cycles.map(f64::from),
        };
        self.leg(here, waves.duration_s(pace), Shape::TwoWaves(waves))
    }
}

impl Room {
    /// Up and down by turns with soft ramps, at speeds down to a fifteenth of the pace, evenly in
    /// their logarithm; slow ways are short and gentle, and every third time it waits for a moment.
    #[must_use]
    pub fn shifts(&self, draw: &mut Draw) -> Path {
        self.filled(|path, turn| {
            let share = libm::pow(15.0, -draw.between(0.0, 1.0));
            let reach = (self.high - self.low) * share;
            let side = if turn % 2 == 0 { self.high } else { self.low };
            let wish = (side - path.end()) * draw.between(0.3, 1.0);
            let to = path.end() + wish.clamp(-reach, reach);
            let pace = Pace {
                velocity: self.pace.velocity * share,
                acceleration: self.pace.acceleration * share.sqrt(),
            };
            let path = path.soft_ramps(to, pace);
            if turn % 3 == 2 {
                path.rest(draw.between(0.15, 0.4))
            } else {
                path
            }
        })
    }

    /// Seas of two waves, high and low, at drawn places.
    #[must_use]
    pub fn swells(&self, draw: &mut Draw) -> Path {
        let width = self.high - self.low;
        self.filled(|path, turn| {
            let height = width * draw.between(0.1, 0.8);
            let share = draw.between(0.25, 0.6);
            let amplitudes = [0.5 * (1.0 - share) * height, 0.5 * share * height];
            let cycles = [[2, 5], [3, 7], [2, 3]][turn % 3];
            let trough = self.low + draw.between(0.0, 1.0) * (width - height);
            let pace = self.pace.times(draw.between(0.3, 1.0));
            let path = path.soft_ramps(trough, self.pace.times(0.6));
            path.two_waves(amplitudes, cycles, pace)
        })
    }
}

/// Sign of a doublet and of its mirror: it gets up to speed and stops, one way and the other.
pub(super) fn doublet(time_s: f64, each_s: f64) -> (u64, f64) {
    let step = (time_s / each_s).floor() as u64;
    let sign = [1.0, -1.0, -1.0, 1.0][(step % 4) as usize];
    (step / 4, sign)
}

#[cfg(test)]
mod tests {
    use super::super::Programme;
    use super::super::tests::{ROOM, assert_keeps_to_its_room, turns, worst};
    use super::*;

    fn programmes() -> [Path; 2] {
        let mut draw = Draw::of("swells", 1);
        [ROOM.shifts(&mut draw), ROOM.swells(&mut draw)]
    }

    #[test]
    fn a_motion_keeps_to_its_room_and_its_pace_and_lasts() {
        assert_keeps_to_its_room(&programmes());
    }

    #[test]
    fn velocity_is_the_derivative_of_position_and_acceleration_that_of_velocity() {
        for path in programmes() {
            let (velocity, _, kinks) = worst(&path);
            assert!(velocity < 3.0e-5 && kinks < 0.01, "{velocity} {kinks}");
        }
    }

    #[test]
    fn every_motion_turns_round_often() {
        for path in programmes() {
            let (turns, moving) = turns(&path);
            assert!(turns >= 6 && moving > 0.7, "{turns} {moving}");
        }
    }

    #[test]
    fn soft_ramps_have_their_largest_acceleration_halfway_up() {
        let pace = Pace {
            velocity: 0.2,
            acceleration: 2.0,
        };
        let path = Path::from(0.0).soft_ramps(0.3, pace);
        // ½π · 0.2/2
        let ramp_s = 0.157_079_632_679;
        let half = path.at(0.5 * ramp_s);
        assert!((half.acceleration - 2.0).abs() < 1.0e-9 && (half.velocity - 0.1).abs() < 1.0e-9);
        assert!((path.end_s() - (1.5 + ramp_s)).abs() < 1.0e-9);
    }

    #[test]
    fn doublets_leave_neither_speed_nor_way_to_a_free_body() {
        let doublets = Programme::Doublets(2.0, 0.5, 7);
        let (mut velocity, mut position) = (0.0, 0.0);
        for k in 0..8000 {
            velocity += doublets.at((f64::from(k) + 0.5) * 1.0e-3) * 1.0e-3;
            position += velocity * 1.0e-3;
        }
        assert!(velocity.abs() < 1.0e-9 && position.abs() < 2.0e-3);
        assert_ne!(doublets.at(0.1), doublets.at(2.1));
        assert_eq!(doublets.at(-0.1), 0.0);
    }
}
