//! Motions as people and waves have them: packets of a swell, lines of a raster, seeking, errands.
//!
//! Least snap is the polynomial of seventh order that stands still up to its jerk (Mellinger and
//! Kumar, ICRA 2011). A packet is a sine under sin², which begins and ends without a step of
//! acceleration (von Hann's window).

use std::f64::consts::{PI, TAU};

use crate::draw::Draw;
use crate::motion::{Pace, Path, Room, Setpoint, Shape};

/// Largest velocity of least snap: 35/16.
const SNAP_VELOCITY: f64 = 2.1875;
/// Largest acceleration of least snap: 84·√5/25.
const SNAP_ACCELERATION: f64 = 7.513_188_404_399_293;

/// 35 s⁴ − 84 s⁵ + 70 s⁶ − 20 s⁷ and its derivatives.
pub(super) fn least_snap(s: f64) -> [f64; 3] {
    let rest = 1.0 - s;
    let position = s * s * s * s * (35.0 + s * (s * (70.0 - 20.0 * s) - 84.0));
    let velocity = 140.0 * s * s * s * rest * rest * rest;
    [position, velocity, 420.0 * s * s * rest * rest * (rest - s)]
}

/// amplitude·sin²(πt/T)·sin(2πn t/T) after a time, T the duration.
pub(super) fn packet(amplitude: f64, cycles: f64, t: f64, duration_s: f64) -> Setpoint {
    let (slow, w) = (PI / duration_s, TAU * cycles / duration_s);
    let (sin, cos) = (libm::sin(slow * t), libm::cos(slow * t));
    let window = [
        sin * sin,
        2.0 * slow * sin * cos,
        2.0 * slow * slow * (cos * cos - sin * sin),
    ];
    let wave = [libm::sin(w * t), w * libm::cos(w * t)];
    Setpoint {
        position: amplitude * window[0] * wave[0],
        velocity: amplitude * (window[1] * wave[0] + window[0] * wave[1]),
        acceleration: amplitude
            * (window[2] * wave[0] + 2.0 * window[1] * wave[1] - w * w * window[0] * wave[0]),
    }
}

impl Path {
    /// With least snap: peak velocity 35/16 way/time, peak acceleration 84·√5/25 way/time².
    #[must_use]
    pub fn least_snap(self, to: f64, pace: Pace) -> Self {
        let way = (to - self.end()).abs();
        let by_velocity = SNAP_VELOCITY * way / pace.velocity;
        let by_acceleration = (SNAP_ACCELERATION * way / pace.acceleration).sqrt();
        self.leg(to, by_velocity.max(by_acceleration), Shape::LeastSnap)
    }

    /// A packet of waves to either side of where it stands, no faster than the pace.
    #[must_use]
    pub fn packet(self, amplitude: f64, cycles: u32, pace: Pace) -> Self {
        let (here, cycles) = (self.end(), f64::from(cycles));
        let w = TAU * cycles;
        let by_velocity = amplitude * (w + PI) / pace.velocity;
        let steepest = w * w + TAU * w + 2.0 * PI * PI;
        let by_acceleration = (amplitude * steepest / pace.acceleration).sqrt();
        let shape = Shape::Packet(amplitude, cycles);
        self.leg(here, by_velocity.max(by_acceleration), shape)
    }
}

impl Room {
    /// Packets of a swell about drawn places, quick and slow; as high as leaves both velocity and
    /// acceleration something to do.
    #[must_use]
    pub fn packets(&self, draw: &mut Draw) -> Path {
        let width = self.high - self.low;
        self.filled(|path, turn| {
            let pace = self.pace.times(draw.between(0.25, 1.0));
            let run_up = pace.velocity * pace.velocity / pace.acceleration;
            let amplitude = (run_up * draw.between(0.5, 3.0)).min(0.35 * width);
            let side = draw.between(amplitude, width - amplitude);
            let cycles = [2, 4, 3][turn % 3];
            let path = path.least_snap(self.low + side, self.pace.times(0.7));
            path.packet(amplitude, cycles, pace)
        })
    }

    /// Lines at one speed, each of them followed by a quick way back; every fourth time another
    /// field of lines is begun, and on every other one the lines go the other way.
    #[must_use]
    pub fn raster(&self, draw: &mut Draw) -> Path {
        let (mut ends, mut feed) = ([self.low, self.high], self.pace);
        self.filled(|path, line| {
            if line % 4 == 0 {
                feed = self.pace.times(draw.between(0.08, 0.6));
                // Lines take three seconds at most, and no more than the room is wide.
                let widest = (self.high - self.low).min(3.0 * feed.velocity);
                let length = widest * draw.between(0.5, 1.0);
                let from = draw.between(self.low, self.high - length);
                ends = [from, from + length];
                if line % 8 == 4 {
                    ends.reverse();
                }
            }
            let [from, to] = ends;
            path.least_snap(from, self.pace).trapezoid(to, feed)
        })
    }

    /// Something is sought: past it, back past it by less, and so on until it is found.
    #[must_use]
    pub fn seek(&self, draw: &mut Draw) -> Path {
        let (mut found, mut off) = (0.0, 0.0);
        self.filled(|path, turn| {
            let step = turn % 6;
            if step == 0 {
                found = self.place(draw);
                off = path.end() - found;
            }
            off *= -draw.between(0.45, 0.75);
            let to = (found + off).clamp(self.low, self.high);
            // Closer by, it goes slower.
            let pace = self.pace.times(libm::exp2(-0.6 * step as f64));
            let path = path.least_snap(to, pace);
            if step == 5 { path.rest(0.15) } else { path }
        })
    }

    /// Up and down by turns, at all speeds from a thirtieth of the pace on, evenly in their
    /// logarithm; ways are as short as leaves time to get up to their speed. Every fifth one is a
    /// hurry to another place, and hardly ever does it wait.
    #[must_use]
    pub fn errands(&self, draw: &mut Draw) -> Path {
        self.filled(|path, turn| {
            if turn % 5 == 4 {
                return path.least_snap(self.place(draw), self.pace).rest(0.1);
            }
            let pace = self.pace.times(libm::pow(30.0, -draw.between(0.0, 1.0)));
            let run_up = pace.velocity * pace.velocity / pace.acceleration;
            let reach = 0.6 * pace.velocity + 1.6 * run_up;
            let side = if turn % 2 == 0 { self.high } else { self.low };
            let wish = (side - path.end()) * draw.between(0.2, 1.0);
            let to = path.end() + wish.clamp(-reach, reach);
            path.least_snap(to, pace)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{ROOM, assert_keeps_to_its_room, turns, worst};
    use super::*;

    fn programmes() -> [Path; 4] {
        let mut draw = Draw::of("habits", 1);
        [
            ROOM.packets(&mut draw),
            ROOM.raster(&mut draw),
            ROOM.seek(&mut draw),
            ROOM.errands(&mut draw),
        ]
    }

    #[test]
    fn a_motion_keeps_to_its_room_and_its_pace_and_lasts() {
        assert_keeps_to_its_room(&programmes());
    }

    #[test]
    fn velocity_is_the_derivative_of_position_and_acceleration_that_of_velocity() {
        for (n, path) in programmes().iter().enumerate() {
            let (velocity, acceleration, _) = worst(path);
            assert!(velocity < 3.0e-5, "{n} {velocity}");
            // Lines of a raster are trapezoids.
            assert!(n == 1 || acceleration < 1.0e-2, "{n} {acceleration}");
        }
    }

    #[test]
    fn every_motion_turns_round_often_and_hardly_waits() {
        for (n, path) in programmes().iter().enumerate() {
            let (turns, moving) = turns(path);
            assert!(turns >= 6 && moving > 0.8, "{n}: {turns} {moving}");
        }
    }

    #[test]
    fn least_snap_reaches_its_largest_velocity_and_acceleration() {
        let most = |row: usize| {
            let each = (0..=1000).map(|k| least_snap(f64::from(k) * 1.0e-3)[row].abs());
            each.fold(0.0, f64::max)
        };
        assert!((most(1) - SNAP_VELOCITY).abs() < 1.0e-5, "{}", most(1));
        assert!((most(2) - SNAP_ACCELERATION).abs() < 1.0e-4, "{}", most(2));
    }
}
